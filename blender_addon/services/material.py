# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, shared by all characters of a colour."""

from functools import lru_cache

import bpy

_SKIN = "Body"


def find_or_new(part, color=None):
    """The material of a part of the library's mesh, in its colour or another (linear red, green, blue, alpha)."""
    color = tuple(float(c) for c in (part.base_color if color is None else color))
    return _find_or_new("Skin" if part.name == _SKIN else part.name, color, part.roughness, part.double_sided)


def _find_or_new(title, color, roughness, double_sided):
    key = f"{title} " + " ".join(f"{c:.4f}" for c in color)
    for material in bpy.data.materials:
        if material.get("anthronet") == key and material.library is None:
            return material
    material = bpy.data.materials.new(f"AnthroNet {title}")
    material["anthronet"] = key
    material.use_nodes = True
    material.use_backface_culling = not double_sided
    material.diffuse_color = color
    shader = material.node_tree.nodes.get("Principled BSDF")
    if shader:
        shader.inputs["Base Color"].default_value = color
        shader.inputs["Roughness"].default_value = roughness
        if title == "Skin":
            shader.inputs["IOR"].default_value = 1.4
    return material


def set_tone(mesh_object, step):
    """Gives a character the skin of a step of the Monk scale, unless its skin material is the user's own."""
    if mesh_object is None or not mesh_object.material_slots:
        return
    slot = mesh_object.material_slots[0]
    if slot.material is not None and "anthronet" not in slot.material:
        return
    color, roughness = _tone(step)
    mesh_object.data.materials[0] = _find_or_new("Skin", color, roughness, False)


@lru_cache(maxsize=None)
def _tone(step):
    from .. import library

    # The library knows the colours; the smallest mesh that carries one is asked for it.
    body = library.model().generate(library.anthronet().Request())
    part = body.mesh(lod=3, body_only=True, skin_tone=step).parts[0]
    return tuple(float(c) for c in part.base_color), part.roughness
