# SPDX-License-Identifier: GPL-3.0-or-later
"""Editing: from a character's changed request to its mesh and bones, in place. Animation, materials, modifiers, shape keys,
sculpting and selection stay. A change happens as a whole or not at all."""

import bpy

from .. import library
from ..state import requests as stored_requests
from ..state.properties import updates_suspended
from . import carry, character, material, mesh, rig

_MODES = ("OBJECT", "POSE")


def refusal(owner, context):
    """Why a character cannot be changed now, in a sentence; None when it can."""
    surface = character.mesh_of(owner)
    if owner.library is not None or owner.data.library is not None:
        origin = (owner.library or owner.data.library).filepath
        return f"{owner.name} is linked from {origin}: use Make Local to change it"
    if owner.override_library is not None or owner.data.override_library is not None:
        return f"{owner.name} is a library override: use Make Local to change it"
    if surface is None:
        return f"{owner.name} has no body mesh: delete it, or duplicate the armature together with its mesh"
    if surface.library is not None or surface.data.library is not None or surface.override_library is not None:
        return f"{surface.name} is linked: use Make Local to change it"
    mode = next((mode for mode in (context.mode, owner.mode, surface.mode) if mode not in _MODES), None)
    if mode is not None:
        return f"Leave {mode.replace('_', ' ').lower()} mode: characters change in object and pose mode"
    if context.view_layer.objects.get(owner.name) is not owner:
        return f"{owner.name} is outside the view layer: include its collection to change it"
    missing = rig.missing_joints(owner)
    if missing:
        return f"{owner.name} has lost the bones of {', '.join(missing)}: undo that, or add a new character"
    if rig.is_transformed(owner):
        return (
            f"{owner.name}: a scale, rotation or place was applied to its bones. Undo that; the object's own may be what it likes"
        )
    return None


def follow(owner, context, names):
    """After a user's change of a character's properties: a body for it and, where they are edited together, for the other
    selected characters, which take the values of ``names``. What is wrong is kept in each one's ``error``; its body stays."""
    owners = [owner]
    if context.scene.anthronet_edit_together and owner == character.active(context):
        owners = character.selected(context)
    with updates_suspended():
        for other in owners[1:]:
            for name in names:
                setattr(other.anthronet, name, getattr(owner.anthronet, name))
    _regenerate(owners, context)


def _regenerate(owners, context):
    ready = []
    for owner in owners:
        try:
            _refuse(owner, context)
            ready.append((owner, character.body(owner)))
        except library.failures() as error:
            owner.anthronet.error = str(error)
    try:
        _commit(ready, context)
        for owner, body in ready:
            owner.anthronet.set_report(body)
    except library.failures() as error:
        for owner, _ in ready:
            owner.anthronet.error = str(error)


def change(requests, context, forget_sculpting=False):
    """Gives characters other requests: pairs of a character and its request. All bodies are made before anything changes.
    Raises what a request or a character has against it."""
    ready = []
    for owner, request in requests:
        _refuse(owner, context)
        stored_requests.check_storable(request)
        ready.append((owner, library.model().generate(request)))
    _commit(ready, context, forget_sculpting)
    for (owner, request), (_, body) in zip(requests, ready):
        owner.anthronet.set_request(request)
        owner.anthronet.set_report(body)


def _refuse(owner, context):
    reason = refusal(owner, context)
    if reason:
        raise ValueError(reason)


def _commit(ready, context, forget_sculpting=False):
    """Gives characters bodies. All that can fail comes before the first vertex moves."""
    if not ready:
        return
    places = []
    for owner, body in ready:
        settings, surface = owner.anthronet, character.mesh_of(owner)
        places.append((surface, mesh.positions(body, int(settings.lod), settings.accessories)))
        mesh.check(surface.data, places[-1][1])
    for owner, _ in ready:
        _own_data(owner)
    rig.move([owner for owner, _ in ready], [body for _, body in ready], context.view_layer)
    for surface, place in places:
        _own_data(surface)
        mesh.move(surface.data, place, forget_sculpting)


def _own_data(ob):
    """Gives an object its data alone: a linked duplicate would change with it."""
    if ob.data.users - ob.data.use_fake_user > 1:
        ob.data = ob.data.copy()


def rebuild(owner, context):
    """Gives a character a new mesh, of another level of detail or with other parts. What was made on the old one is carried
    over as far as vertices correspond (:mod:`carry`)."""
    settings = owner.anthronet
    try:
        _refuse(owner, context)
        body = character.body(owner)
        names = [bone.name for bone in rig.joint_order(owner, body)]
        surface = character.mesh_of(owner)
        old = surface.data
        data = mesh.new(body, int(settings.lod), settings.accessories, names, old.name)
        carried = carry.read(body, surface)
        surface.data = data
        carry.write(body, surface, carried)
        material.set_tone(surface, settings.skin_tone)
        if old.users == 0:
            name = old.name
            bpy.data.meshes.remove(old)
            data.name = name
        settings.error = ""
        # What is shown: a measure that did not hold at the old level may hold now.
        settings.set_report(body)
    except library.failures() as error:
        settings.error = str(error)
    context.view_layer.update()
