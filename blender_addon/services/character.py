# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters: an armature object that holds the request, and its child with the mesh.

Presets that users have saved call :func:`active` of this module by name."""

import bpy

from .. import library
from ..state.properties import updates_suspended
from ..state.requests import check_storable
from . import armature, material, mesh

#: Custom property of the mesh object of a character.
_MESH_OBJECT = "anthronet_body"
#: Name of the modifier that subdivides the posed mesh in renders.
_FINE_MODIFIER = "Fine in Renders"


def containing(ob):
    """The armature object of the character that an object belongs to; None for any other object."""
    while ob is not None:
        if ob.anthronet.is_character:
            return ob
        ob = ob.parent
    return None


def active(context):
    """The armature object of the active character; None if there is none."""
    # A context without a window, such as a script's timer has, has no attribute ``object``.
    return containing(getattr(context, "object", None))


def selected(context):
    """The armature objects of all characters that have a selected object, the active one first."""
    objects = [getattr(context, "object", None), *getattr(context, "selected_objects", ())]
    return list(dict.fromkeys(rig for rig in map(containing, objects) if rig is not None))


def mesh_object(rig):
    """The mesh object of a character; None if there is none. Searches all objects of the file."""
    return next((ob for ob in rig.children if ob.type == "MESH" and _MESH_OBJECT in ob), None)


def generate_body(rig):
    """The body that the request of a character describes."""
    return library.model().generate(rig.anthronet.request())


def create(context, people, *, lod, accessories=True, convention="blender", skin_tones=None, name="AnthroNet"):
    """Creates characters in the active collection and returns their armature objects; after an error none of them is left.

    ``people``: tuples of body, request and location. ``convention``: how bones are named. ``skin_tones``: a step of the Monk
    Skin Tone scale for each."""
    for _, request, _ in people:
        check_storable(request)
    created = []
    try:
        rigs = armature.create([body for body, _, _ in people], convention, context, name, created)
        view = context.space_data
        in_local_view = view is not None and view.type == "VIEW_3D" and view.local_view is not None
        for index, (rig, (body, request, location)) in enumerate(zip(rigs, people)):
            skin_tone = skin_tones[index] if skin_tones else 0
            rig.location = location
            rig.show_in_front = True
            child = _create_mesh_object(context, rig, body, lod, accessories, convention, created)
            material.set_skin_tone(child, skin_tone)
            if in_local_view:
                for ob in (rig, child):
                    ob.local_view_set(view, True)
            settings = rig.anthronet
            settings.set_request(request)
            settings.set_report(body)
            with updates_suspended():
                settings.is_character = True
                settings.lod = str(lod)
                settings.accessories = accessories
                settings.joint_names = convention.upper()
                settings.skin_tone = skin_tone
    except Exception:
        for ob in reversed(created):
            data = ob.data
            bpy.data.objects.remove(ob)
            (bpy.data.meshes if isinstance(data, bpy.types.Mesh) else bpy.data.armatures).remove(data)
        raise
    return rigs


def _create_mesh_object(context, rig, body, lod, accessories, convention, created):
    name = f"{rig.name} Body"
    bone_names = body.joint_names(convention)
    ob = bpy.data.objects.new(name, mesh.create(body, lod, accessories, bone_names, name))
    created.append(ob)
    ob[_MESH_OBJECT] = True
    context.collection.objects.link(ob)
    ob.parent = rig
    ob.modifiers.new("Armature", "ARMATURE").object = rig
    return ob


def select_only(context, rig):
    """Makes a character's armature object the only selected object and the active one."""
    for ob in context.selected_objects:
        ob.select_set(False)
    rig.select_set(True)
    context.view_layer.objects.active = rig


def measure_mesh(rig):
    """Measures the mesh of a character as it is now, sculpted or not. ValueError if that is not possible."""
    ob = mesh_object(rig)
    if ob is None:
        raise ValueError(f"{rig.name} has no body mesh to measure")
    if ob.mode == "EDIT":
        raise ValueError(f"{ob.name}: leave edit mode to measure it")
    model = library.model()
    count = model.vertex_count(int(rig.anthronet.lod))
    if len(ob.data.vertices) < count:
        raise ValueError(f"{ob.name}: expected at least {count} vertices, the mesh has {len(ob.data.vertices)}")
    return model.measure(mesh.body_positions(ob.data, count), space="blender")


def is_sculpted(rig):
    """Whether a user moved vertices of the character's mesh."""
    ob = mesh_object(rig)
    return ob is not None and mesh.is_sculpted(ob.data)


def set_fine_render(rig, enabled):
    """Adds or removes the modifier that subdivides the posed mesh in renders."""
    ob = mesh_object(rig)
    if ob is None:
        return
    modifier = ob.modifiers.get(_FINE_MODIFIER)
    if enabled and modifier is None:
        modifier = ob.modifiers.new(_FINE_MODIFIER, "SUBSURF")
        modifier.levels, modifier.render_levels = 0, 1
    elif not enabled and modifier is not None:
        ob.modifiers.remove(modifier)


def make_local(rig):
    """Makes objects, mesh and armature of a linked or overridden character local to this file. RuntimeError if Blender does not
    allow it."""
    # The mesh object first: a data-block that a linked one still uses would be copied instead.
    objects = [ob for ob in (mesh_object(rig), rig) if ob is not None]
    for ob in objects:
        for block in (ob, ob.data):
            if block.library is not None or block.override_library is not None:
                block.make_local(clear_liboverride=True)
    for ob in objects:
        if ob.library is not None or ob.data.library is not None or ob.override_library is not None:
            raise RuntimeError(f"{ob.name} stays linked, because something else in this file uses it from its library")
