# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of characters: creation, and new positions for the vertices.

A mesh holds all parts of a character, with a material slot each: the body first, its vertices in the model's order, then
eyes, teeth, tongue and eyelashes. Topology, UV map and weights are the same for everybody. They are built once for each level
of detail, as a template mesh that is copied for each character."""

import zlib

import bmesh
import bpy
import numpy as np

from . import material

#: Custom property of a mesh: its level of detail.
LOD = "anthronet_lod"
#: Attribute of a mesh: the generated positions. A sculpted mesh differs from them.
GENERATED = "anthronet_generated"
#: Custom property of a template mesh: level of detail, parts and bone names that it was built for.
_TEMPLATE_KEY = "anthronet_template"


def create(body, lod, accessories, bone_names, name):
    """A mesh of a body."""
    mesh = _template(body, lod, accessories, bone_names).copy()
    del mesh[_TEMPLATE_KEY]
    mesh.name = name
    mesh[LOD] = lod
    mesh.attributes.new(GENERATED, "FLOAT_VECTOR", "POINT")
    _write_positions(mesh, generated_positions(body, lod, accessories))
    return mesh


def _template(body, lod, accessories, bone_names):
    """The mesh that those of all characters of a level of detail are copied from, built on first use."""
    key = f"{lod} {accessories} {' '.join(bone_names)}"
    # Lookup by name is fast. The key tells names with the same checksum apart.
    name = f".AnthroNet {lod} {'whole' if accessories else 'body'} {zlib.crc32(key.encode()):08x}"
    template = bpy.data.meshes.get((name, None))
    if template is not None and template.get(_TEMPLATE_KEY) == key:
        if not all(slot is not None and material.is_unedited(slot) for slot in template.materials):
            # The user edited one of the materials: new characters do not get it.
            for slot, part in enumerate(body.mesh(lod=lod, layout="model", body_only=not accessories).parts):
                template.materials[slot] = material.for_part(part)
        return template
    library_mesh = body.mesh(lod=lod, influences=8, space="blender", layout="model", body_only=not accessories)
    template = _build(library_mesh, bone_names, name)
    template[_TEMPLATE_KEY] = key
    return template


def generated_positions(body, lod, accessories):
    """The positions of all parts, concatenated: (V, 3)."""
    library_mesh = body.mesh(lod=lod, space="blender", layout="model", body_only=not accessories)
    return np.concatenate([part.positions for part in library_mesh.parts])


def check_vertex_count(mesh, positions):
    """ValueError if a mesh does not have a vertex for each position."""
    if len(positions) != len(mesh.vertices):
        raise ValueError(
            f"{mesh.name}: expected {len(positions)} vertices, the mesh has {len(mesh.vertices)}: "
            "change the Level of Detail to get a new mesh"
        )


def set_positions(mesh, positions, discard_sculpting=False):
    """Moves a mesh to the positions of another body. Shape keys keep their offsets; sculpted offsets are kept, too, unless they
    are to be discarded."""
    check_vertex_count(mesh, positions)
    current, generated = _current_and_generated(mesh)
    if GENERATED not in mesh.attributes:
        mesh.attributes.new(GENERATED, "FLOAT_VECTOR", "POINT")
    target = positions.reshape(-1)
    delta = target - (current if discard_sculpting else generated)
    if mesh.shape_keys:
        shape = np.empty(3 * len(mesh.vertices), np.float32)
        for block in mesh.shape_keys.key_blocks:
            block.points.foreach_get("co", shape)
            block.points.foreach_set("co", shape + delta)
    # Vertices that were not sculpted get exactly the library's positions, without rounding errors of the addition.
    sculpted = (current != generated) & (not discard_sculpting)
    _write_positions(mesh, np.where(sculpted, current + delta, target), positions)


def _write_positions(mesh, positions, generated=None):
    """Writes the current positions, and the generated ones where they differ."""
    mesh.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(positions, np.float32).reshape(-1))
    generated = positions if generated is None else generated
    mesh.attributes[GENERATED].data.foreach_set("vector", np.ascontiguousarray(generated, np.float32).reshape(-1))
    mesh.update()


def body_positions(mesh, vertex_count):
    """The current positions of the body's vertices, without shape keys and modifiers: (V, 3)."""
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", positions)
    return positions.reshape(-1, 3)[:vertex_count]


def _build(library_mesh, bone_names, name):
    """A Blender mesh from one of the library's, with UV map, materials and weights."""
    parts = library_mesh.parts
    starts = np.cumsum([0] + [len(part.positions) for part in parts])
    uv_starts = np.cumsum([0] + [len(part.uvs) for part in parts])
    corner_vertices, corner_uvs, face_sizes, face_slots = [], [], [], []
    for slot, part in enumerate(parts):
        for faces, face_uvs in ((part.quads, part.quad_uvs), (part.triangles, part.triangle_uvs)):
            corner_vertices.append(faces.astype(np.int32).reshape(-1) + starts[slot])
            corner_uvs.append(face_uvs.astype(np.int64).reshape(-1) + uv_starts[slot])
            face_sizes.append(np.full(len(faces), faces.shape[1], np.int32))
            face_slots.append(np.full(len(faces), slot, np.int32))
    corner_vertices, corner_uvs = np.concatenate(corner_vertices), np.concatenate(corner_uvs)
    face_sizes, face_slots = np.concatenate(face_sizes), np.concatenate(face_slots)

    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(int(starts[-1]))
    mesh.loops.add(len(corner_vertices))
    mesh.polygons.add(len(face_sizes))
    positions = np.concatenate([part.positions for part in parts])
    mesh.attributes["position"].data.foreach_set("vector", positions.reshape(-1))
    mesh.attributes[".corner_vert"].data.foreach_set("value", corner_vertices)
    mesh.polygons.foreach_set("loop_start", np.cumsum(face_sizes, dtype=np.int32) - face_sizes)
    mesh.polygons.foreach_set("material_index", face_slots)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", np.concatenate([part.uvs for part in parts])[corner_uvs].reshape(-1))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    for part in parts:
        mesh.materials.append(material.for_part(part))
    if mesh.validate(verbose=False):
        raise ValueError("the generated mesh is not valid")
    _set_weights(mesh, parts, starts, bone_names)
    return mesh


def _set_weights(mesh, parts, starts, bone_names):
    """Writes the skin weights, exact to the bit. Weights belong to a mesh, but the names of vertex groups to an object, so one
    is needed here."""
    helper = bpy.data.objects.new(".AnthroNet Weights", mesh)
    for name in bone_names:
        helper.vertex_groups.new(name=name)
    edited = bmesh.new()
    edited.from_mesh(mesh)
    layer = edited.verts.layers.deform.verify()
    edited.verts.ensure_lookup_table()
    vertices = edited.verts
    for start, part in zip(starts, parts):
        for vertex, (joints, weights) in enumerate(zip(part.joints.tolist(), part.weights.tolist()), int(start)):
            deform = vertices[vertex][layer]
            for joint, weight in zip(joints, weights):
                if weight > 0.0:
                    deform[joint] = weight
    edited.to_mesh(mesh)
    edited.free()
    bpy.data.objects.remove(helper)


def is_sculpted(mesh):
    """Whether any vertex differs from its generated position."""
    return not np.array_equal(*_current_and_generated(mesh))


def sculpted_offsets(mesh):
    """Offsets of the vertices from their generated positions: (V, 3)."""
    current, generated = _current_and_generated(mesh)
    return (current - generated).reshape(-1, 3)


def add_sculpted_offsets(mesh, offsets):
    """Adds offsets to the vertices, as if a user had sculpted them. Shape keys are not changed."""
    current, generated = _current_and_generated(mesh)
    _write_positions(mesh, current + offsets.reshape(-1).astype(np.float32), generated)


def _current_and_generated(mesh):
    size = 3 * len(mesh.vertices)
    current, generated = np.empty(size, np.float32), np.empty(size, np.float32)
    mesh.attributes["position"].data.foreach_get("vector", current)
    if GENERATED not in mesh.attributes:
        return current, current
    mesh.attributes[GENERATED].data.foreach_get("vector", generated)
    return current, generated
