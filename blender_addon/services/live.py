# SPDX-License-Identifier: GPL-3.0-or-later
"""Editing: from a character's changed request to its mesh and bones, in place. Animation, materials, modifiers, shape keys,
sculpting and selection stay."""

from .. import library
from . import character, material, mesh, rig


def regenerate(owner, context):
    """Gives a character the body of its request. What is wrong with the request is kept in ``error``, and the body stays."""
    settings = owner.anthronet
    try:
        apply(owner, library.model().generate(settings.request()), context)
    except library.failures() as error:
        settings.error = str(error)
        return False
    return True


def apply(owner, body, context):
    """Gives a character a body."""
    settings = owner.anthronet
    surface = character.mesh_of(owner)
    if surface is not None:
        mesh.move(surface.data, mesh.positions(body, int(settings.lod), settings.accessories))
    rig.move([owner], [body], context.view_layer)
    settings.set_report(body)


def rebuild(owner, context):
    """Gives a character a new mesh, of another level of detail or with other parts. What was sculpted is lost."""
    settings = owner.anthronet
    surface = character.mesh_of(owner)
    if surface is None:
        return
    try:
        body = library.model().generate(settings.request())
        names = [bone.name for bone in rig.joint_order(owner, body)]
        old = surface.data
        data = mesh.new(body, int(settings.lod), settings.accessories, names, old.name)
        surface.data = data
        material.set_tone(surface, settings.skin_tone)
        if old.users == 0:
            import bpy

            bpy.data.meshes.remove(old)
        settings.error = ""
    except library.failures() as error:
        settings.error = str(error)
    context.view_layer.update()
