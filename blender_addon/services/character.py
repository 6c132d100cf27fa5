# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters: an armature's object that holds the request, and the mesh's object below it."""

import bpy

from .. import library, properties
from . import material, mesh, rig

_MESH = "anthronet_body"


def of(ob):
    """The character that an object belongs to: its armature's object; None for any other object."""
    while ob is not None:
        if ob.anthronet.is_character:
            return ob
        ob = ob.parent
    return None


def active(context):
    """The character of the active object; None for none."""
    return of(context.object)


def selected(context):
    """The characters of all selected objects, each once, the active one first."""
    objects = [context.object, *context.selected_objects]
    return list(dict.fromkeys(found for found in map(of, objects) if found is not None))


def mesh_of(character):
    """The object of a character's mesh; None when it was deleted."""
    return next((ob for ob in character.children if ob.type == "MESH" and _MESH in ob), None)


def add(context, body, request, *, lod, accessories, names, skin_tone, location, name="AnthroNet"):
    """A new character in the scene's active collection; its armature's object."""
    collection, view_layer = context.collection, context.view_layer
    character = rig.new(body, names, collection, view_layer, name)
    character.location = location
    data = mesh.new(body, lod, accessories, body.joint_names(names), f"{name} Body")
    surface = bpy.data.objects.new(f"{name} Body", data)
    surface[_MESH] = True
    collection.objects.link(surface)
    surface.parent = character
    for bone_name in body.joint_names(names):
        surface.vertex_groups.new(name=bone_name)
    modifier = surface.modifiers.new("Armature", "ARMATURE")
    modifier.object = character
    modifier.use_deform_preserve_volume = False
    character.show_in_front = True
    settings = character.anthronet
    settings.set_request(request)
    settings.set_report(body)
    with properties.silent():
        settings.is_character = True
        settings.lod = str(lod)
        settings.accessories = accessories
        settings.joint_names = names.upper()
        settings.skin_tone = skin_tone
    if skin_tone:
        material.set_tone(surface, skin_tone)
    return character


def select_only(context, character):
    """Makes a character the one selected and active object."""
    for ob in context.selected_objects:
        ob.select_set(False)
    character.select_set(True)
    context.view_layer.objects.active = character


def measured(character):
    """The measures of a character's mesh as it is now."""
    surface = mesh_of(character)
    if surface is None:
        raise ValueError(f"{character.name}: has no body mesh to measure")
    model = library.model()
    count = model.vertex_count(int(character.anthronet.lod))
    if len(surface.data.vertices) < count:
        raise ValueError(f"{surface.name}: expected at least {count} vertices, the mesh has {len(surface.data.vertices)}")
    return model.measure(mesh.body_positions(surface.data, count), space="blender")


def is_sculpted(character):
    """Whether a user moved vertices of the character's mesh."""
    surface = mesh_of(character)
    return surface is not None and mesh.is_sculpted(surface.data)
