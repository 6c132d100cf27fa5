"""Meshes: the surfaces of a body as arrays."""

from __future__ import annotations

import ctypes
import threading
from typing import TYPE_CHECKING, Any, Dict, Iterator, NamedTuple, Optional, Tuple, Union

import numpy as np

from . import _arguments, _native
from ._arguments import Array, Floats, Indices, Places
from ._library import Handle, Owner, call, described, lib, new_handle, number_of, text, text_of

if TYPE_CHECKING:
    from ._body import Body
    from ._skin import Skinner

_LAYOUTS = {"render": _native.LAYOUT_RENDER, "model": _native.LAYOUT_MODEL}
_ATTRIBUTES = {
    "positions": _native.ATTRIBUTE_POSITIONS,
    "normals": _native.ATTRIBUTE_NORMALS,
    "uvs": _native.ATTRIBUTE_UVS,
    "triangles": _native.ATTRIBUTE_TRIANGLES,
    "joints": _native.ATTRIBUTE_JOINTS,
    "weights": _native.ATTRIBUTE_WEIGHTS,
    "sources": _native.ATTRIBUTE_SOURCES,
    "quads": _native.ATTRIBUTE_QUADS,
    "quad_uvs": _native.ATTRIBUTE_QUAD_UVS,
    "triangle_uvs": _native.ATTRIBUTE_TRIANGLE_UVS,
}
# What a blend shape moves.
_MOVED = {name: _ATTRIBUTES[name] for name in ("positions", "normals")}
_TYPES: Dict[int, np.dtype[Any]] = {
    _native.TYPE_F32: np.dtype(np.float32),
    _native.TYPE_U32: np.dtype(np.uint32),
    _native.TYPE_U16: np.dtype(np.uint16),
}


class Mesh(Owner):
    """The surfaces of a body: `parts`, the body first, then eyes, teeth, tongue and lashes.

    Made by `Body.mesh`. May be used by many threads, one of which at a time is at its memory.
    """

    _options: Any
    _lock: threading.Lock
    _parts: Tuple[MeshPart, ...]

    @classmethod
    def _new(
        cls, body: Body, lod: int, influences: int, space: str, layout: str, body_only: bool, skin_tone: int
    ) -> Mesh:
        self = cls.__new__(cls)
        self._options = described(
            _native.MeshOptions,
            lod=_arguments.whole(lod, "lod"),
            influences=_arguments.whole(influences, "influences"),
            space=_arguments.choice(_arguments.SPACES, space, "space"),
            layout=_arguments.choice(_LAYOUTS, layout, "layout"),
            body_only=_arguments.flag(body_only, "body_only"),
            skin_tone=_arguments.whole(skin_tone, "skin_tone"),
        )
        self._lock = threading.Lock()
        self._handle = self._surfaces(body)
        count = number_of(lib.anthronet_mesh_part_count, self._handle)
        self._parts = tuple(MeshPart(self, i) for i in range(count))
        return self

    def _surfaces(self, body: Body) -> Handle:
        return new_handle(lib.anthronet_mesh_new, lib.anthronet_mesh_free, body._open, ctypes.byref(self._options))

    def update(self, body: Body) -> None:
        """Changes the mesh to that of another body, with the same options and without blend shapes.

        Arrays got before keep the surface of before and stay valid: the new surface has memory of its own, so that
        threads may go on reading the old one. Get the arrays again to see the new one.
        """
        from ._body import Body

        body = _arguments.instance(body, Body, "body")
        if self.closed:
            raise ValueError("Mesh: is closed")
        self._handle = self._surfaces(body)

    def add_blend_shape(self, name: str, body: Body) -> None:
        """Adds a blend shape from the mesh to the surface of another body: at weight 1 the mesh has that body's shape in
        the bind pose. Joints stay where they are, so bodies should be of about the same stature.

        Args:
            name: its name, not taken by another.
            body: of the same model.

        Raises:
            InvalidError: the name is empty or taken.
        """
        from ._body import Body

        encoded, body = _arguments.text(name, "name"), _arguments.instance(body, Body, "body")
        with self._lock:
            call(lib.anthronet_mesh_add_blend_shape, self._open, encoded, len(encoded), body._open)

    @property
    def blend_shapes(self) -> Tuple[str, ...]:
        """The names of its blend shapes, in their order; `MeshPart.blend_shape` has the arrays."""
        with self._lock:
            handle = self._open
            count = number_of(lib.anthronet_mesh_blend_shape_count, handle)
            return tuple(text_of(lib.anthronet_mesh_blend_shape_name, handle, i) for i in range(count))

    @property
    def parts(self) -> Tuple[MeshPart, ...]:
        """The surfaces, the body first."""
        return self._parts

    def __len__(self) -> int:
        return len(self._parts)

    def __getitem__(self, index: int) -> MeshPart:
        return self._parts[index]

    def __iter__(self) -> Iterator[MeshPart]:
        return iter(self._parts)

    def skinner(self, part: int = 0) -> Skinner:
        """Makes a part ready to be posed; what was made of the mesh before stays as it is when the mesh changes.

        Args:
            part: its place in `parts`.
        """
        from ._skin import Skinner

        place = _arguments.whole(part, "part")
        with self._lock:
            return Skinner._new(self._open, place)

    def __repr__(self) -> str:
        return f"<Mesh of {', '.join(part.name for part in self._parts)}>"


class MeshPart:
    """One surface with one material: a part of a mesh.

    Its arrays are read-only views of the library's memory. They keep that memory alive by themselves, after the mesh
    was closed and updated too. `triangles`, `quads` and the like count from 0 within the part.
    """

    __slots__ = ("_mesh", "_index", "_described", "_name")

    def __init__(self, mesh: Mesh, index: int) -> None:
        part = described(_native.MeshPart)
        call(lib.anthronet_mesh_describe_part, mesh._open, index, ctypes.byref(part))
        self._mesh, self._index, self._described, self._name = mesh, index, part, text(part.name)

    @property
    def name(self) -> str:
        """Its name, such as `Body`."""
        return self._name

    @property
    def base_color(self) -> Tuple[float, float, float, float]:
        """Colour of the material: linear red, green, blue and alpha, 0 to 1."""
        return tuple(self._described.base_color)

    @property
    def roughness(self) -> float:
        """Perceptual roughness of the material, 0 to 1."""
        return float(self._described.roughness)

    @property
    def double_sided(self) -> bool:
        """Whether back faces are drawn too."""
        return bool(self._described.double_sided)

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return int(self._described.vertex_count)

    @property
    def positions(self) -> Floats:
        """(vertices, 3) float32, metres."""
        return self._view("positions")

    @property
    def normals(self) -> Floats:
        """(vertices, 3) float32, unit length."""
        return self._view("normals")

    @property
    def uvs(self) -> Floats:
        """(vertices, 2) float32 in the render layout, (texture coordinates, 2) in the model layout; v grows downwards
        in glTF space and upwards in the others."""
        return self._view("uvs")

    @property
    def triangles(self) -> Indices:
        """(triangles, 3) uint32: vertices. In the model layout the faces that are no quads: none at levels 0 and 1."""
        return self._view("triangles")

    @property
    def quads(self) -> Indices:
        """(quads, 4) uint32: vertices. Model layout only."""
        return self._view("quads")

    @property
    def quad_uvs(self) -> Indices:
        """(quads, 4) uint32: texture coordinates of the corners. Model layout only."""
        return self._view("quad_uvs")

    @property
    def triangle_uvs(self) -> Indices:
        """(triangles, 3) uint32: texture coordinates of the corners. Model layout only."""
        return self._view("triangle_uvs")

    @property
    def joints(self) -> Places:
        """(vertices, influences) uint16: joints of the body."""
        return self._view("joints")

    @property
    def weights(self) -> Floats:
        """(vertices, influences) float32: weights of those joints, descending, of sum 1."""
        return self._view("weights")

    @property
    def sources(self) -> Indices:
        """(vertices,) uint32: which vertex of the model each one is."""
        return self._view("sources")

    def blend_shape(self, shape: Union[str, int], attribute: str = "positions") -> Floats:
        """The displacements of a blend shape: (vertices, 3) float32, to be added to the positions or normals. A view.

        Args:
            shape: its name or place in `Mesh.blend_shapes`.
            attribute: `"positions"` or `"normals"`.
        """
        return self._view(attribute, self._shape(shape))

    def read(self, attribute: str, out: Optional[Array] = None) -> Array:
        """Copies an array of the part.

        Args:
            attribute: its name, such as `"positions"`.
            out: where to: an array of the same shape and type, of any strides, such as a field of a structured array;
                None for a new one. Returned.

        Raises:
            TypeError, ValueError: there is no such array, or `out` is of another shape or type, or read-only.
        """
        return self._read(attribute, None, out)

    def read_blend_shape(
        self, shape: Union[str, int], attribute: str = "positions", out: Optional[Array] = None
    ) -> Array:
        """Copies the displacements of a blend shape. Arguments and errors as of `blend_shape` and `read`."""
        return self._read(attribute, self._shape(shape), out)

    def _shape(self, shape: Union[str, int]) -> int:
        if not isinstance(shape, str):
            return _arguments.whole(shape, "shape")
        names = self._mesh.blend_shapes
        return _arguments.choice({name: i for i, name in enumerate(names)}, shape, "shape")

    def _read(self, attribute: str, shape: Optional[int], out: Optional[Array]) -> Array:
        with self._mesh._lock:
            source = self._source(attribute, shape)
            array = np.empty(source.shape, source.dtype) if out is None else _arguments.instance(out, np.ndarray, "out")
            if array.dtype != source.dtype:
                raise TypeError(f"out: expected an array of {source.dtype}, got {array.dtype}")
            if array.shape != source.shape:
                raise ValueError(f"out: expected an array of shape {source.shape}, got {array.shape}")
            if not array.flags.writeable:
                raise ValueError("out: expected an array that can be written, got one that is read-only")
            if not _arguments.packed_rows(array):
                array[...] = source.array()
            elif len(array):
                stride = array.strides[0] if len(array) > 1 else 0
                call(source.read, *source.place, array.ctypes.data, _arguments.extent(array), stride)
            return array

    def _view(self, attribute: str, shape: Optional[int] = None) -> Array:
        with self._mesh._lock:
            return self._source(attribute, shape).array()

    def _source(self, attribute: str, shape: Optional[int]) -> _Source:
        handle = self._mesh._open
        if shape is None:
            place: Tuple[Any, ...] = (handle, self._index, _arguments.choice(_ATTRIBUTES, attribute, "attribute"))
            data, read = lib.anthronet_mesh_data, lib.anthronet_mesh_read
        else:
            place = (handle, shape, self._index, _arguments.choice(_MOVED, attribute, "attribute"))
            data, read = lib.anthronet_mesh_blend_shape_data, lib.anthronet_mesh_read_blend_shape
        view = _native.View()
        call(data, *place, ctypes.byref(view))
        rows = (view.rows,) if attribute == "sources" else (view.rows, view.columns)
        return _Source(place, read, view.data, _TYPES[view.number_type], rows)

    def __repr__(self) -> str:
        return f"<MeshPart {self.name!r}, {self.vertex_count} vertices>"


class _Memory:
    """Memory of the library's as numpy's array interface; arrays over it hold this, and this holds the handle."""

    __slots__ = ("__array_interface__", "handle")

    def __init__(self, source: _Source) -> None:
        read_only = True
        self.handle = source.place[0]
        self.__array_interface__: Dict[str, Any] = {
            "data": (source.address, read_only),
            "shape": source.shape,
            "typestr": source.dtype.str,
            "version": 3,
        }


class _Source(NamedTuple):
    """Where an array of a mesh is."""

    #: The handle, and what of it.
    place: Tuple[Any, ...]
    #: The entry that copies it.
    read: Any
    #: Of its first number; None of an empty one.
    address: Optional[int]
    dtype: np.dtype[Any]
    shape: Tuple[int, ...]

    def array(self) -> Array:
        """A view of it."""
        if self.address:
            return np.asarray(_Memory(self))
        array = np.empty(self.shape, self.dtype)
        array.flags.writeable = False
        return array
