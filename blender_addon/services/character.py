# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters: an armature's object that holds the request, and the mesh's object below it."""

import bpy

from .. import library
from ..state.properties import updates_suspended
from ..state.requests import check_storable
from . import material, mesh, rig

_MESH = "anthronet_body"
_FINE = "Fine in Renders"


def of(ob):
    """The character that an object belongs to: its armature's object; None for any other object."""
    while ob is not None:
        if ob.anthronet.is_character:
            return ob
        ob = ob.parent
    return None


def active(context):
    """The character of the active object; None for none."""
    # Without a window, as in a timer of a script, the context has no object.
    return of(getattr(context, "object", None))


def selected(context):
    """The characters of all selected objects, each once, the active one first."""
    objects = [getattr(context, "object", None), *getattr(context, "selected_objects", ())]
    return list(dict.fromkeys(found for found in map(of, objects) if found is not None))


def mesh_of(character):
    """The object of a character's mesh; None when there is none. Looks at all objects of the file."""
    return next((ob for ob in character.children if ob.type == "MESH" and _MESH in ob), None)


def body(character):
    """The body that a character's request describes."""
    return library.model().generate(character.anthronet.request())


def add(context, people, *, lod, accessories=True, names="blender", tones=None, name="AnthroNet"):
    """New characters in the scene's active collection: their armatures' objects. ``people`` are triples of a body, the
    request that it came of and a place, ``tones`` their steps of the skin tone scale. All or none."""
    bodies = [body for body, _, _ in people]
    for _, request, _ in people:
        check_storable(request)
    made = []
    try:
        rigs = rig.new(bodies, names, context, name, made)
        view = context.space_data
        local_view = view is not None and view.type == "VIEW_3D" and view.local_view is not None
        for number, (owner, (body, request, place)) in enumerate(zip(rigs, people)):
            tone = tones[number] if tones else 0
            owner.location = place
            owner.show_in_front = True
            surface = _add_surface(context, owner, body, lod, accessories, names, made)
            material.set_tone(surface, tone)
            if local_view:
                for ob in (owner, surface):
                    ob.local_view_set(view, True)
            settings = owner.anthronet
            settings.set_request(request)
            settings.set_report(body)
            with updates_suspended():
                settings.is_character = True
                settings.lod = str(lod)
                settings.accessories = accessories
                settings.joint_names = names.upper()
                settings.skin_tone = tone
    except Exception:
        for ob in reversed(made):
            data = ob.data
            bpy.data.objects.remove(ob)
            (bpy.data.meshes if isinstance(data, bpy.types.Mesh) else bpy.data.armatures).remove(data)
        raise
    return rigs


def _add_surface(context, owner, body, lod, accessories, names, made):
    title = f"{owner.name} Body"
    bone_names = body.joint_names(names)
    surface = bpy.data.objects.new(title, mesh.new(body, lod, accessories, bone_names, title))
    made.append(surface)
    surface[_MESH] = True
    context.collection.objects.link(surface)
    surface.parent = owner
    surface.modifiers.new("Armature", "ARMATURE").object = owner
    return surface


def select_only(context, character):
    """Makes a character the one selected and active object."""
    for ob in context.selected_objects:
        ob.select_set(False)
    character.select_set(True)
    context.view_layer.objects.active = character


def measured(character):
    """The measures of a character's mesh as it is now. ValueError where that is no body of the library's."""
    surface = mesh_of(character)
    if surface is None:
        raise ValueError(f"{character.name}: has no body mesh to measure")
    if surface.mode == "EDIT":
        raise ValueError(f"{surface.name}: leave edit mode to measure it")
    model = library.model()
    count = model.vertex_count(int(character.anthronet.lod))
    if len(surface.data.vertices) < count:
        raise ValueError(
            f"{surface.name}: expected at least {count} vertices, the mesh has {len(surface.data.vertices)}"
        )
    return model.measure(mesh.body_positions(surface.data, count), space="blender")


def is_sculpted(character):
    """Whether a user moved vertices of the character's mesh."""
    surface = mesh_of(character)
    return surface is not None and mesh.is_sculpted(surface.data)


def set_fine_render(character, fine):
    """Adds or removes the subdivision of the posed surface in renders."""
    surface = mesh_of(character)
    if surface is None:
        return
    found = surface.modifiers.get(_FINE)
    if fine and found is None:
        found = surface.modifiers.new(_FINE, "SUBSURF")
        found.levels, found.render_levels = 0, 1
    elif not fine and found is not None:
        surface.modifiers.remove(found)


def make_local(character):
    """Makes a linked or overridden character the file's own: its objects, mesh and armature. RuntimeError where Blender
    does not let it."""
    # Users before what they use: what a linked block uses is copied instead.
    surface = mesh_of(character)
    for ob in filter(None, (surface, character)):
        for block in (ob, ob.data):
            if block.library is not None or block.override_library is not None:
                block.make_local(clear_liboverride=True)
    for ob in filter(None, (surface, character)):
        if ob.library is not None or ob.data.library is not None or ob.override_library is not None:
            raise RuntimeError(f"{ob.name}: Blender keeps it linked, as something else in this file uses it from there")
