# SPDX-License-Identifier: GPL-3.0-or-later
"""Regenerating characters in place after their requests changed: animation, materials, modifiers, shape keys, sculpting and
selection are kept. A change is applied completely or not at all."""

import bpy

from .. import library
from ..state.properties import updates_suspended
from ..state.requests import check_storable
from . import armature, character, material, mesh, mesh_transfer

_MODES = ("OBJECT", "POSE")


def reason_not_editable(rig, context):
    """Why a character cannot be changed now, as a sentence for the user; None if it can."""
    child = character.mesh_object(rig)
    if rig.library is not None or rig.data.library is not None:
        origin = (rig.library or rig.data.library).filepath
        return f"{rig.name} is linked from {origin}: use Make Local to change it"
    if rig.override_library is not None or rig.data.override_library is not None:
        return f"{rig.name} is a library override: use Make Local to change it"
    if child is None:
        return f"{rig.name} has no body mesh: delete it, or duplicate the armature together with its mesh"
    if child.library is not None or child.data.library is not None or child.override_library is not None:
        return f"{child.name} is linked: use Make Local to change it"
    mode = next((mode for mode in (context.mode, rig.mode, child.mode) if mode not in _MODES), None)
    if mode is not None:
        return f"Leave {mode.replace('_', ' ').lower()} mode: characters can be changed in object mode and pose mode"
    if context.view_layer.objects.get(rig.name) is not rig:
        return f"{rig.name} is not in the view layer: include its collection to change the character"
    missing = armature.missing_joints(rig)
    if missing:
        return (
            f"{rig.name}: the bones of these joints were deleted: {', '.join(missing)}. "
            "Undo that, or add a new character"
        )
    if armature.has_applied_transform(rig):
        return (
            f"{rig.name}: a location, rotation or scale was applied to the bones. Undo that: transforms of the object "
            "itself need not be applied"
        )
    return None


def check_editable(rig, context):
    """ValueError with the reason if a character cannot be changed now."""
    reason = reason_not_editable(rig, context)
    if reason:
        raise ValueError(reason)


def apply_property_change(rig, context, names):
    """Regenerates a character after the named properties of it changed. With *Edit Selected Together* the other selected
    characters get the same values. Errors are stored in the property ``error`` of each character, whose body then stays."""
    rigs = [rig]
    if context.scene.anthronet_edit_together and rig == character.active(context):
        rigs = character.selected(context)
    with updates_suspended():
        for other in rigs[1:]:
            for name in names:
                setattr(other.anthronet, name, getattr(rig.anthronet, name))
    bodies = []
    for one in rigs:
        try:
            check_editable(one, context)
            bodies.append((one, character.generate_body(one)))
        except library.failures() as error:
            one.anthronet.error = str(error)
    try:
        _apply_bodies(bodies, context)
        for one, body in bodies:
            one.anthronet.set_report(body)
    except library.failures() as error:
        for one, _ in bodies:
            one.anthronet.error = str(error)


def apply_requests(requests, context, discard_sculpting=False):
    """Gives characters other requests. ``requests``: pairs of armature object and request. If any of them fails, raises the
    error and changes none."""
    bodies = []
    for rig, request in requests:
        check_editable(rig, context)
        check_storable(request)
        bodies.append((rig, library.model().generate(request)))
    _apply_bodies(bodies, context, discard_sculpting)
    for (rig, request), (_, body) in zip(requests, bodies):
        rig.anthronet.set_request(request)
        rig.anthronet.set_report(body)


def _apply_bodies(bodies, context, discard_sculpting=False):
    """Moves bones and vertices of characters. ``bodies``: pairs of armature object and body. Everything that can fail comes
    before the first vertex moves."""
    if not bodies:
        return
    meshes = []
    for rig, body in bodies:
        settings, child = rig.anthronet, character.mesh_object(rig)
        positions = mesh.generated_positions(body, int(settings.lod), settings.accessories)
        mesh.check_vertex_count(child.data, positions)
        meshes.append((child, positions))
    for rig, _ in bodies:
        _make_data_single_user(rig)
    armature.set_rest_pose([rig for rig, _ in bodies], [body for _, body in bodies], context.view_layer)
    for child, positions in meshes:
        _make_data_single_user(child)
        mesh.set_positions(child.data, positions, discard_sculpting)


def _make_data_single_user(ob):
    """Copies the data of an object if linked duplicates share it, which would change as well otherwise."""
    if ob.data.users - ob.data.use_fake_user > 1:
        ob.data = ob.data.copy()


def rebuild_mesh(rig, context):
    """Gives a character a new mesh after its level of detail or its parts changed, and transfers the user's work to it
    (:mod:`mesh_transfer`). Errors are stored in the property ``error``."""
    settings = rig.anthronet
    try:
        check_editable(rig, context)
        body = character.generate_body(rig)
        bone_names = [bone.name for bone in armature.pose_bones(rig, body)]
        child = character.mesh_object(rig)
        old = child.data
        new = mesh.create(body, int(settings.lod), settings.accessories, bone_names, old.name)
        snapshot = mesh_transfer.take_snapshot(body, child)
        child.data = new
        mesh_transfer.restore_snapshot(body, child, snapshot)
        material.set_skin_tone(child, settings.skin_tone)
        if old.users == 0:
            name = old.name
            bpy.data.meshes.remove(old)
            new.name = name
        settings.error = ""
        # An earlier measure that was rejected may be possible now.
        settings.set_report(body)
    except library.failures() as error:
        settings.error = str(error)
    context.view_layer.update()
