# SPDX-License-Identifier: GPL-3.0-or-later
"""From one mesh of a character to another one, of another level of detail or with other parts: materials, shape keys,
sculpting, vertex groups and attributes.

Vertices correspond where both meshes have the model's vertex; a vertex that is new lies between its nearest neighbours.
Corners and faces correspond within one level of detail; edges never do. Weights of bones are the library's at each level."""

from typing import NamedTuple

import numpy as np
from mathutils.kdtree import KDTree

from .. import compat
from . import mesh

_NEIGHBOURS = 4
#: What every mesh of ours has: not the user's to keep.
_OWN = {"position", mesh.GENERATED, "material_index", "sharp_face", "sharp_edge", "UVMap"}
#: How an attribute's values are read and written, and of how many numbers they are. Text is not carried.
_NUMBERS = {
    "FLOAT": ("value", 1, np.float32),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "QUATERNION": ("value", 4, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
}


class _Key(NamedTuple):
    """A shape key: how far it is from the one that it is relative to, (V, 3), and its settings."""

    name: str
    relative: str
    offsets: np.ndarray
    settings: dict


class Carried(NamedTuple):
    """What was on a mesh."""

    lod: int
    whole: bool
    materials: list
    sculpting: np.ndarray
    #: By name: (V,) weights.
    groups: dict
    #: Name, type, domain, values (n, k).
    attributes: list
    keys: list
    #: What the keys play: an action and its slot.
    played: tuple


def read(body, surface):
    """What is on a character's mesh, before it gets another one."""
    data = surface.data
    lod = int(data.get(mesh.LOD, 1))
    count = len(data.vertices)
    parts = body.mesh(lod=lod, layout="model").parts
    return Carried(
        lod,
        count > len(parts[0].positions),
        list(data.materials),
        mesh.sculpting(data),
        _groups(surface, set(surface.parent.data.bones.keys()) if surface.parent else set()),
        _attributes(data),
        _keys(data),
        compat.played(data.shape_keys) if data.shape_keys else (None, None),
    )


def write(body, surface, carried):
    """Puts it on the mesh that the character has now."""
    data = surface.data
    _give_materials(data, carried.materials)
    sculpted = bool(np.any(carried.sculpting))
    points = [one for one in carried.attributes if one[2] == "POINT"]
    if not (sculpted or carried.groups or carried.keys or carried.attributes):
        return
    settings = surface.parent.anthronet
    lod, whole = int(settings.lod), settings.accessories
    if sculpted or carried.groups or carried.keys or points:
        old = body.mesh(lod=carried.lod, space="blender", layout="model", body_only=not carried.whole)
        new = body.mesh(lod=lod, space="blender", layout="model", body_only=not whole)
        if sum(len(part.positions) for part in old.parts) != len(carried.sculpting):
            # Somebody added or removed vertices: which is which is not known.
            return
        sources, weights = _correspondence(old, new)

        def blended(values):
            return np.einsum("vn,vnk->vk", weights, values[sources].astype(np.float64))

        if sculpted:
            mesh.add_sculpting(data, blended(carried.sculpting))
        for name, values in carried.groups.items():
            _give_group(surface, name, blended(values[:, None])[:, 0])
        for name, kind, domain, values in points:
            smooth = values.dtype == np.float32
            _give_attribute(data, name, kind, domain, blended(values) if smooth else values[sources[:, 0]])
        _give_keys(surface, carried, blended)
    if lod == carried.lod:
        for name, kind, domain, values in carried.attributes:
            if domain in ("CORNER", "FACE"):
                # The body comes first, so what both meshes have is the beginning of both.
                _give_attribute(data, name, kind, domain, values)


def _correspondence(old, new):
    """For each vertex of the new mesh its sources in the old one and their weights: (V, 4) each; weights of zero for a part
    that was not there."""
    count = sum(len(part.positions) for part in new.parts)
    sources, weights = np.zeros((count, _NEIGHBOURS), np.int64), np.zeros((count, _NEIGHBOURS))
    starts_old = dict(zip((part.name for part in old.parts), np.cumsum([0] + [len(p.positions) for p in old.parts])))
    olds = {part.name: part for part in old.parts}
    start = 0
    for part in new.parts:
        was = olds.get(part.name)
        rows = slice(start, start + len(part.positions))
        start = rows.stop
        if was is None:
            continue
        first = int(starts_old[part.name])
        largest = int(max(was.sources.max(), part.sources.max())) + 1
        place = np.full(largest, -1, np.int64)
        place[was.sources] = np.arange(len(was.sources))
        found = place[part.sources]
        sources[rows, 0] = np.where(found >= 0, found, 0) + first
        weights[rows, 0] = found >= 0
        lost = np.flatnonzero(found < 0)
        if not len(lost):
            continue
        tree = KDTree(len(was.positions))
        for index, position in enumerate(was.positions.tolist()):
            tree.insert(position, index)
        tree.balance()
        for vertex in lost:
            near = tree.find_n(part.positions[vertex].tolist(), _NEIGHBOURS)
            share = np.array([1.0 / (distance + 1e-9) for _, _, distance in near])
            row = rows.start + vertex
            sources[row, : len(near)] = [first + index for _, index, _ in near]
            weights[row, : len(near)] = share / share.sum()
    return sources, weights


def _give_materials(data, materials):
    # Slots of parts that are off stay, so that they come back with the parts.
    for slot, material in enumerate(materials):
        if slot < len(data.materials):
            data.materials[slot] = material
        else:
            data.materials.append(material)


def _groups(surface, bones):
    names = {group.index: group.name for group in surface.vertex_groups if group.name not in bones}
    out = {name: np.zeros(len(surface.data.vertices)) for name in names.values()}
    if names:
        for vertex in surface.data.vertices:
            for one in vertex.groups:
                if one.group in names:
                    out[names[one.group]][vertex.index] = one.weight
    return out


def _give_group(surface, name, weights):
    group = surface.vertex_groups.new(name=name)
    for weight in np.unique(weights[weights > 0]):
        group.add(np.flatnonzero(weights == weight).tolist(), float(min(weight, 1.0)), "REPLACE")


def _attributes(data):
    out = []
    for attribute in data.attributes:
        if attribute.name in _OWN or attribute.name.startswith(".") or attribute.data_type not in _NUMBERS:
            continue
        field, width, dtype = _NUMBERS[attribute.data_type]
        values = np.empty(len(attribute.data) * width, dtype)
        attribute.data.foreach_get(field, values)
        out.append((attribute.name, attribute.data_type, attribute.domain, values.reshape(-1, width)))
    return out


def _give_attribute(data, name, kind, domain, values):
    attribute = data.attributes.get(name) or data.attributes.new(name, kind, domain)
    if attribute.data_type != kind or attribute.domain != domain:
        return
    field, width, dtype = _NUMBERS[kind]
    out = np.zeros((len(attribute.data), width), dtype)
    common = min(len(out), len(values))
    out[:common] = values[:common]
    attribute.data.foreach_set(field, out.reshape(-1))


_SETTINGS = ("slider_min", "slider_max", "value", "mute", "vertex_group", "interpolation")


def _keys(data):
    if not data.shape_keys:
        return []
    places = {}
    for block in data.shape_keys.key_blocks:
        places[block.name] = np.empty(3 * len(data.vertices), np.float32)
        block.points.foreach_get("co", places[block.name])
    return [
        _Key(
            block.name,
            block.relative_key.name,
            (places[block.name] - places[block.relative_key.name]).reshape(-1, 3),
            {name: getattr(block, name) for name in _SETTINGS},
        )
        for block in data.shape_keys.key_blocks
    ]


def _give_keys(surface, carried, blended):
    data = surface.data
    for key in carried.keys:
        surface.shape_key_add(name=key.name, from_mix=False)
    if not carried.keys:
        return
    blocks = data.shape_keys.key_blocks
    places = np.empty(3 * len(data.vertices), np.float32)
    blocks[0].points.foreach_get("co", places)
    done = {carried.keys[0].name: places}
    # A key may be relative to one that comes after it.
    waiting = list(carried.keys[1:])
    while waiting:
        key = next((one for one in waiting if one.relative in done), waiting[0])
        waiting.remove(key)
        base = done.get(key.relative, places)
        done[key.name] = base + blended(key.offsets).reshape(-1).astype(np.float32)
        blocks[key.name].points.foreach_set("co", done[key.name])
    for key in carried.keys:
        block = blocks[key.name]
        block.relative_key = blocks[key.relative]
        for name, value in key.settings.items():
            setattr(block, name, value)
    action, slot = carried.played
    if action is not None:
        compat.assign(data.shape_keys, action, slot)
