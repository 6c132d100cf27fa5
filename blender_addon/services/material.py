# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, shared by all characters that have the same colour.

Once a user edits a material it is the user's: the extension neither replaces it nor assigns it to other characters."""

import zlib
from functools import lru_cache

import bpy

from .. import library

#: The library's name of the part that has the skin.
_BODY_PART = "Body"
#: Custom properties of a material: what it was created for, and a checksum of its settings at that time.
_KEY, _CHECKSUM = "anthronet", "anthronet_state"


def for_part(part):
    """The material of a part of a library mesh; a new one if there is none."""
    color = tuple(float(component) for component in part.base_color)
    return _find_or_create("Skin" if part.name == _BODY_PART else part.name, color, part.roughness, part.double_sided)


def _find_or_create(name, color, roughness, double_sided):
    """``color``: linear red, green, blue, alpha."""
    key = f"{name} " + " ".join(f"{component:.4f}" for component in color)
    for material in bpy.data.materials:
        if material.get(_KEY) == key and material.library is None and is_unedited(material):
            return material
    material = bpy.data.materials.new(f"AnthroNet {name}")
    material.use_nodes = True
    material.use_backface_culling = not double_sided
    material.diffuse_color = color
    shader = material.node_tree.nodes.get("Principled BSDF")
    if shader:
        shader.inputs["Base Color"].default_value = color
        shader.inputs["Roughness"].default_value = roughness
        if name == "Skin":
            shader.inputs["IOR"].default_value = 1.4
    material[_KEY] = key
    material[_CHECKSUM] = _checksum(material)
    return material


def is_unedited(material):
    """Whether the extension created a material and nobody has edited it since."""
    return _KEY in material and material.get(_CHECKSUM) == _checksum(material)


def _checksum(material):
    """A number that changes when the material is edited."""
    settings = [tuple(material.diffuse_color), material.use_backface_culling]
    for node in material.node_tree.nodes if material.node_tree else ():
        settings.append(node.bl_idname)
        for socket in node.inputs:
            value = getattr(socket, "default_value", None)
            settings.append(tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value)
    settings.append(len(material.node_tree.links) if material.node_tree else 0)
    # Custom properties store signed 32-bit integers.
    return zlib.crc32(repr(settings).encode()) & 0x7FFFFFFF


def set_skin_tone(mesh_object, step):
    """Assigns the skin material of a step of the Monk Skin Tone scale. If the present skin material was edited, keeps that and
    returns False."""
    if mesh_object is None or not mesh_object.material_slots:
        return False
    slot = mesh_object.material_slots[0]
    if slot.material is not None and not is_unedited(slot.material):
        return False
    color, roughness = _skin_of_tone(step)
    material = _find_or_create("Skin", color, roughness, False)
    if slot.material != material:
        mesh_object.data.materials[0] = material
    return True


@lru_cache(maxsize=None)
def _skin_of_tone(step):
    """Colour and roughness of a skin tone, which the library has on its meshes: here on the smallest one."""
    body = library.model().generate(library.anthronet().Request())
    part = body.mesh(lod=3, body_only=True, skin_tone=step).parts[0]
    return tuple(float(component) for component in part.base_color), part.roughness
