# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, shared by all characters of a colour. A material that somebody edited is theirs: it is neither replaced nor
given to others."""

import zlib
from functools import lru_cache

import bpy

from .. import library

_SKIN = "Body"
#: On materials: what they were made for, and what they were like then.
_KEY, _STATE = "anthronet", "anthronet_state"


def find_or_new(part, color=None):
    """The material of a part of the library's mesh, in its colour or another (linear red, green, blue, alpha)."""
    color = tuple(float(c) for c in (part.base_color if color is None else color))
    return _find_or_new("Skin" if part.name == _SKIN else part.name, color, part.roughness, part.double_sided)


def _find_or_new(title, color, roughness, double_sided):
    key = f"{title} " + " ".join(f"{c:.4f}" for c in color)
    for material in bpy.data.materials:
        if material.get(_KEY) == key and material.library is None and is_ours(material):
            return material
    material = bpy.data.materials.new(f"AnthroNet {title}")
    material.use_nodes = True
    material.use_backface_culling = not double_sided
    material.diffuse_color = color
    shader = material.node_tree.nodes.get("Principled BSDF")
    if shader:
        shader.inputs["Base Color"].default_value = color
        shader.inputs["Roughness"].default_value = roughness
        if title == "Skin":
            shader.inputs["IOR"].default_value = 1.4
    material[_KEY] = key
    material[_STATE] = _state(material)
    return material


def is_ours(material):
    """Whether a material is as the extension made it. One that was edited is the user's."""
    return _KEY in material and material.get(_STATE) == _state(material)


def _state(material):
    """What an edit of a material would change, as a number."""
    told = [tuple(material.diffuse_color), material.use_backface_culling]
    for node in material.node_tree.nodes if material.node_tree else ():
        told.append(node.bl_idname)
        for socket in node.inputs:
            value = getattr(socket, "default_value", None)
            told.append(tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value)
    told.append(len(material.node_tree.links) if material.node_tree else 0)
    # ID properties hold 31 bits.
    return zlib.crc32(repr(told).encode()) & 0x7FFFFFFF


def set_tone(mesh_object, step):
    """Gives a character the skin of a step of the Monk scale, unless its skin material is the user's own; whether it did."""
    if mesh_object is None or not mesh_object.material_slots:
        return False
    slot = mesh_object.material_slots[0]
    if slot.material is not None and not is_ours(slot.material):
        return False
    color, roughness = _tone(step)
    found = _find_or_new("Skin", color, roughness, False)
    if slot.material != found:
        mesh_object.data.materials[0] = found
    return True


@lru_cache(maxsize=None)
def _tone(step):
    # The library knows the colours; the smallest mesh that carries one is asked for it.
    body = library.model().generate(library.anthronet().Request())
    part = body.mesh(lod=3, body_only=True, skin_tone=step).parts[0]
    return tuple(float(c) for c in part.base_color), part.roughness
