# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes: one template per level of detail, copied for each character, then moved.

A character's mesh holds all parts: the body's vertices first and in the model's order, then eyes, teeth, tongue and
lashes, with a material slot each. Topology, texture coordinates and weights are the same for everybody, so they are made
once a session; a character is a copy with other positions."""

import zlib

import bpy
import numpy as np

from . import material

#: The level of detail, on every mesh.
LOD = "anthronet_lod"
#: Positions as they were generated: what a sculpted mesh differs from.
GENERATED = "anthronet_generated"
_KEY = "anthronet_template"


def template(body, lod, accessories, bone_names):
    """The mesh that characters of a level of detail are copies of; made on first use."""
    key = f"{lod} {accessories} {' '.join(bone_names)}"
    # Names are looked up fast; that several vocabularies share one is told apart by the key.
    title = f".AnthroNet {lod} {'whole' if accessories else 'body'} {zlib.crc32(key.encode()):08x}"
    found = bpy.data.meshes.get((title, None))
    if found is not None and found.get(_KEY) == key:
        if not all(one is not None and material.is_ours(one) for one in found.materials):
            # Somebody edited one: new characters do not get it.
            for slot, part in enumerate(body.mesh(lod=lod, layout="model", body_only=not accessories).parts):
                found.materials[slot] = material.find_or_new(part)
        return found
    surface = body.mesh(lod=lod, influences=8, space="blender", layout="model", body_only=not accessories)
    mesh = _build(surface, bone_names, title)
    mesh[_KEY] = key
    return mesh


def new(body, lod, accessories, bone_names, name):
    """A mesh of a body."""
    mesh = template(body, lod, accessories, bone_names).copy()
    del mesh[_KEY]
    mesh.name = name
    mesh[LOD] = lod
    mesh.attributes.new(GENERATED, "FLOAT_VECTOR", "POINT")
    _write(mesh, positions(body, lod, accessories))
    return mesh


def positions(body, lod, accessories):
    """Positions of all parts, one after the other: (V, 3), metres, Blender's axes."""
    surface = body.mesh(lod=lod, space="blender", layout="model", body_only=not accessories)
    return np.concatenate([part.positions for part in surface.parts])


def check(mesh, places):
    """ValueError where a mesh cannot take positions."""
    if len(places) != len(mesh.vertices):
        raise ValueError(
            f"{mesh.name}: expected {len(places)} vertices, the mesh has {len(mesh.vertices)}: choose its Detail anew"
        )


def move(mesh, places, forget_sculpting=False):
    """Gives a mesh another body's positions. What was sculpted stays on top of them unless it is to be forgotten; shape keys
    stay."""
    check(mesh, places)
    count = len(mesh.vertices)
    moved, before = _now_and_generated(mesh)
    if GENERATED not in mesh.attributes:
        mesh.attributes.new(GENERATED, "FLOAT_VECTOR", "POINT")
    step = places.reshape(-1) - (moved if forget_sculpting else before)
    if mesh.shape_keys:
        shape = np.empty(3 * count, np.float32)
        for block in mesh.shape_keys.key_blocks:
            block.points.foreach_get("co", shape)
            block.points.foreach_set("co", shape + step)
    # Untouched vertices get exactly what the library made, not a sum of roundings.
    sculpted = (moved != before) & (not forget_sculpting)
    _write(mesh, np.where(sculpted, moved + step, places.reshape(-1)), places)


def _write(mesh, places, generated=None):
    mesh.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(places, np.float32).reshape(-1))
    generated = places if generated is None else generated
    mesh.attributes[GENERATED].data.foreach_set("vector", np.ascontiguousarray(generated, np.float32).reshape(-1))
    mesh.update()


def body_positions(mesh, vertex_count):
    """The body's vertices as they are now, without shape keys and modifiers: (V, 3), metres."""
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", places)
    return places.reshape(-1, 3)[:vertex_count]


def _build(surface, bone_names, title):
    parts = surface.parts
    starts = np.cumsum([0] + [len(part.positions) for part in parts])
    uv_starts = np.cumsum([0] + [len(part.uvs) for part in parts])
    corners, corner_uvs, sizes, slots = [], [], [], []
    for slot, part in enumerate(parts):
        for faces, face_uvs in ((part.quads, part.quad_uvs), (part.triangles, part.triangle_uvs)):
            corners.append(faces.astype(np.int32).reshape(-1) + starts[slot])
            corner_uvs.append(face_uvs.astype(np.int64).reshape(-1) + uv_starts[slot])
            sizes.append(np.full(len(faces), faces.shape[1], np.int32))
            slots.append(np.full(len(faces), slot, np.int32))
    corners, corner_uvs = np.concatenate(corners), np.concatenate(corner_uvs)
    sizes, slots = np.concatenate(sizes), np.concatenate(slots)

    mesh = bpy.data.meshes.new(title)
    mesh.vertices.add(int(starts[-1]))
    mesh.loops.add(len(corners))
    mesh.polygons.add(len(sizes))
    places = np.concatenate([part.positions for part in parts])
    mesh.attributes["position"].data.foreach_set("vector", places.reshape(-1))
    mesh.attributes[".corner_vert"].data.foreach_set("value", corners)
    mesh.polygons.foreach_set("loop_start", np.cumsum(sizes, dtype=np.int32) - sizes)
    mesh.polygons.foreach_set("material_index", slots)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", np.concatenate([part.uvs for part in parts])[corner_uvs].reshape(-1))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    for part in parts:
        mesh.materials.append(material.find_or_new(part))
    if mesh.validate(verbose=False):
        raise ValueError("the generated mesh is not valid")
    _weigh(mesh, parts, starts, bone_names)
    return mesh


def _weigh(mesh, parts, starts, bone_names):
    """Skin weights, exact to the bit. Vertex groups belong to objects, so an object is needed while they are made."""
    import bmesh

    carrier = bpy.data.objects.new(".AnthroNet Weights", mesh)
    for name in bone_names:
        carrier.vertex_groups.new(name=name)
    work = bmesh.new()
    work.from_mesh(mesh)
    layer = work.verts.layers.deform.verify()
    work.verts.ensure_lookup_table()
    verts = work.verts
    for start, part in zip(starts, parts):
        for vertex, (joints, weights) in enumerate(zip(part.joints.tolist(), part.weights.tolist()), int(start)):
            row = verts[vertex][layer]
            for joint, weight in zip(joints, weights):
                if weight > 0.0:
                    row[joint] = weight
    work.to_mesh(mesh)
    work.free()
    bpy.data.objects.remove(carrier)


def is_sculpted(mesh):
    """Whether vertices are elsewhere than they were generated."""
    return not np.array_equal(*_now_and_generated(mesh))


def sculpting(mesh):
    """How far vertices are from where they were generated: (V, 3), metres."""
    now, generated = _now_and_generated(mesh)
    return (now - generated).reshape(-1, 3)


def add_sculpting(mesh, offsets):
    """Moves vertices from where they were generated; shape keys are not looked at."""
    now, generated = _now_and_generated(mesh)
    _write(mesh, now + offsets.reshape(-1).astype(np.float32), generated)


def _now_and_generated(mesh):
    count = 3 * len(mesh.vertices)
    now, generated = np.empty(count, np.float32), np.empty(count, np.float32)
    mesh.attributes["position"].data.foreach_get("vector", now)
    if GENERATED not in mesh.attributes:
        return now, now
    mesh.attributes[GENERATED].data.foreach_get("vector", generated)
    return now, generated
