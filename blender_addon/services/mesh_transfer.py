# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer of a user's work from the mesh of a character to its next one, of another level of detail or with other parts:
materials, sculpting, shape keys, vertex groups and attributes.

Vertices correspond if both meshes have the same vertex of the model; every other vertex of the new mesh is interpolated from
the nearest ones of the old mesh. Corners and faces correspond within a level of detail only, edges never do. Weights of bones
are not transferred: the library has them for each level of detail."""

from typing import NamedTuple

import numpy as np
from mathutils.kdtree import KDTree

from .. import compat
from . import mesh

#: Number of vertices of the old mesh that a vertex is interpolated from.
_NEIGHBOURS = 4
#: Attributes that the extension or Blender creates on every mesh.
_GENERATED_ATTRIBUTES = {"position", mesh.GENERATED, "material_index", "sharp_face", "sharp_edge", "UVMap"}
#: From the type of an attribute to the name of its value, the number of components and their type. String attributes are not
#: transferred.
_ATTRIBUTE_TYPES = {
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
_SHAPE_KEY_SETTINGS = ("slider_min", "slider_max", "value", "mute", "vertex_group", "interpolation")


class _Attribute(NamedTuple):
    """An attribute of a mesh."""

    name: str
    data_type: str
    domain: str
    #: (elements, components)
    values: np.ndarray


class _ShapeKey(NamedTuple):
    """A shape key."""

    name: str
    #: Name of the key that the offsets are relative to.
    relative_to: str
    #: (V, 3)
    offsets: np.ndarray
    settings: dict


class Snapshot(NamedTuple):
    """What is transferred from a mesh."""

    lod: int
    accessories: bool
    materials: list
    #: Sculpted offsets, (V, 3).
    sculpting: np.ndarray
    #: From the name of a vertex group to its weights, (V,).
    vertex_groups: dict
    attributes: list
    shape_keys: list
    #: Action and slot that animate the shape keys; None for each that there is not.
    shape_key_animation: tuple

    @property
    def point_attributes(self):
        """The attributes of vertices."""
        return [attribute for attribute in self.attributes if attribute.domain == "POINT"]

    @property
    def has_vertex_data(self):
        """Whether there is anything whose transfer needs the correspondence of vertices."""
        return bool(np.any(self.sculpting) or self.vertex_groups or self.shape_keys or self.point_attributes)


def take_snapshot(body, mesh_object):
    """Reads what has to be transferred from a character's mesh."""
    data = mesh_object.data
    lod = int(data.get(mesh.LOD, 1))
    body_part = body.mesh(lod=lod, layout="model").parts[0]
    bones = set(mesh_object.parent.data.bones.keys()) if mesh_object.parent else set()
    return Snapshot(
        lod=lod,
        accessories=len(data.vertices) > len(body_part.positions),
        materials=list(data.materials),
        sculpting=mesh.sculpted_offsets(data),
        vertex_groups=_read_vertex_groups(mesh_object, bones),
        attributes=_read_attributes(data),
        shape_keys=_read_shape_keys(data),
        shape_key_animation=compat.assigned_action(data.shape_keys) if data.shape_keys else (None, None),
    )


def restore_snapshot(body, mesh_object, snapshot):
    """Writes a snapshot of the old mesh to the mesh that the character has now."""
    data, settings = mesh_object.data, mesh_object.parent.anthronet
    _write_materials(data, snapshot.materials)
    lod = int(settings.lod)
    if snapshot.has_vertex_data:
        old = body.mesh(lod=snapshot.lod, space="blender", layout="model", body_only=not snapshot.accessories)
        new = body.mesh(lod=lod, space="blender", layout="model", body_only=not settings.accessories)
        if sum(len(part.positions) for part in old.parts) != len(snapshot.sculpting):
            # The user added or deleted vertices. Which ones is unknown.
            return
        _restore_vertex_data(mesh_object, snapshot, *_correspondence(old, new))
    if lod == snapshot.lod:
        for attribute in snapshot.attributes:
            if attribute.domain in ("CORNER", "FACE"):
                # The body comes first, so the elements that both meshes have are the first ones of both.
                _write_attribute(data, attribute, attribute.values)


def _restore_vertex_data(mesh_object, snapshot, sources, weights):
    """Writes what a snapshot has for vertices; ``sources`` and ``weights`` as of :func:`_correspondence`."""

    def interpolate(values):
        return np.einsum("vn,vnk->vk", weights, values[sources].astype(np.float64))

    if np.any(snapshot.sculpting):
        mesh.add_sculpted_offsets(mesh_object.data, interpolate(snapshot.sculpting))
    for name, group_weights in snapshot.vertex_groups.items():
        _write_vertex_group(mesh_object, name, interpolate(group_weights[:, None])[:, 0])
    for attribute in snapshot.point_attributes:
        # Integers and booleans cannot be interpolated: the value of the first source is used.
        continuous = attribute.values.dtype == np.float32
        values = interpolate(attribute.values) if continuous else attribute.values[sources[:, 0]]
        _write_attribute(mesh_object.data, attribute, values)
    _write_shape_keys(mesh_object, snapshot, interpolate)


def _correspondence(old, new):
    """The vertices of the old mesh that each vertex of the new one is interpolated from, and their weights: (V, 4) each. The
    weights of a part that the old mesh does not have are 0."""
    count = sum(len(part.positions) for part in new.parts)
    sources, weights = np.zeros((count, _NEIGHBOURS), np.int64), np.zeros((count, _NEIGHBOURS))
    old_parts, old_start = {}, 0
    for part in old.parts:
        old_parts[part.name] = part, old_start
        old_start += len(part.positions)
    start = 0
    for part in new.parts:
        rows = slice(start, start + len(part.positions))
        start = rows.stop
        if part.name in old_parts:
            _match_part(*old_parts[part.name], part, sources[rows], weights[rows])
    return sources, weights


def _match_part(old, old_start, new, sources, weights):
    """Fills the rows of one part in the arrays of :func:`_correspondence`."""
    # ``part.sources`` are vertices of the model: those that both meshes have correspond.
    old_row_of_model = np.full(int(max(old.sources.max(), new.sources.max())) + 1, -1, np.int64)
    old_row_of_model[old.sources] = np.arange(len(old.sources))
    old_rows = old_row_of_model[new.sources]
    sources[:, 0] = np.where(old_rows >= 0, old_rows, 0) + old_start
    weights[:, 0] = old_rows >= 0
    unmatched = np.flatnonzero(old_rows < 0)
    if not len(unmatched):
        return
    tree = KDTree(len(old.positions))
    for index, position in enumerate(old.positions.tolist()):
        tree.insert(position, index)
    tree.balance()
    for vertex in unmatched:
        nearest = tree.find_n(new.positions[vertex].tolist(), _NEIGHBOURS)
        inverse_distances = np.array([1.0 / (distance + 1e-9) for _, _, distance in nearest])
        sources[vertex, : len(nearest)] = [old_start + index for _, index, _ in nearest]
        weights[vertex, : len(nearest)] = inverse_distances / inverse_distances.sum()


def _write_materials(data, materials):
    # Slots of parts that the mesh does not have now are kept, so that their materials come back with the parts.
    for slot, material in enumerate(materials):
        if slot < len(data.materials):
            data.materials[slot] = material
        else:
            data.materials.append(material)


def _read_vertex_groups(mesh_object, bones):
    """The weights of all vertex groups that belong to no bone, by name."""
    names = {group.index: group.name for group in mesh_object.vertex_groups if group.name not in bones}
    weights = {name: np.zeros(len(mesh_object.data.vertices)) for name in names.values()}
    if names:
        for vertex in mesh_object.data.vertices:
            for element in vertex.groups:
                if element.group in names:
                    weights[names[element.group]][vertex.index] = element.weight
    return weights


def _write_vertex_group(mesh_object, name, weights):
    group = mesh_object.vertex_groups.new(name=name)
    for weight in np.unique(weights[weights > 0]):
        group.add(np.flatnonzero(weights == weight).tolist(), float(min(weight, 1.0)), "REPLACE")


def _read_attributes(data):
    """The attributes that users or other extensions created."""
    out = []
    for attribute in data.attributes:
        name, data_type = attribute.name, attribute.data_type
        if name in _GENERATED_ATTRIBUTES or name.startswith(".") or data_type not in _ATTRIBUTE_TYPES:
            continue
        field, components, dtype = _ATTRIBUTE_TYPES[data_type]
        values = np.empty(len(attribute.data) * components, dtype)
        attribute.data.foreach_get(field, values)
        out.append(_Attribute(name, data_type, attribute.domain, values.reshape(-1, components)))
    return out


def _write_attribute(data, source, values):
    """Writes values to the attribute with the name of ``source``, as many as both have."""
    attribute = data.attributes.get(source.name)
    if attribute is None:
        attribute = data.attributes.new(source.name, source.data_type, source.domain)
    if attribute.data_type != source.data_type or attribute.domain != source.domain:
        return
    field, components, dtype = _ATTRIBUTE_TYPES[source.data_type]
    out = np.zeros((len(attribute.data), components), dtype)
    common = min(len(out), len(values))
    out[:common] = values[:common]
    attribute.data.foreach_set(field, out.reshape(-1))


def _read_shape_keys(data):
    if not data.shape_keys:
        return []
    positions = {}
    for block in data.shape_keys.key_blocks:
        positions[block.name] = np.empty(3 * len(data.vertices), np.float32)
        block.points.foreach_get("co", positions[block.name])
    return [
        _ShapeKey(
            name=block.name,
            relative_to=block.relative_key.name,
            offsets=(positions[block.name] - positions[block.relative_key.name]).reshape(-1, 3),
            settings={name: getattr(block, name) for name in _SHAPE_KEY_SETTINGS},
        )
        for block in data.shape_keys.key_blocks
    ]


def _write_shape_keys(mesh_object, snapshot, interpolate):
    keys, data = snapshot.shape_keys, mesh_object.data
    if not keys:
        return
    for key in keys:
        mesh_object.shape_key_add(name=key.name, from_mix=False)
    blocks = data.shape_keys.key_blocks
    basis = np.empty(3 * len(data.vertices), np.float32)
    blocks[0].points.foreach_get("co", basis)
    positions = {keys[0].name: basis}
    # A key can be relative to one that comes after it.
    pending = list(keys[1:])
    while pending:
        key = next((key for key in pending if key.relative_to in positions), pending[0])
        pending.remove(key)
        reference = positions.get(key.relative_to, basis)
        positions[key.name] = reference + interpolate(key.offsets).reshape(-1).astype(np.float32)
        blocks[key.name].points.foreach_set("co", positions[key.name])
    for key in keys:
        block = blocks[key.name]
        block.relative_key = blocks[key.relative_to]
        for name, value in key.settings.items():
            setattr(block, name, value)
    action, slot = snapshot.shape_key_animation
    if action is not None:
        compat.assign_action(data.shape_keys, action, slot)
