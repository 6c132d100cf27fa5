"""Skinning: surfaces posed by joints, many characters in one call."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any, Iterable, List, Optional, Tuple, Union

import numpy as np

from . import _arguments, _native
from ._arguments import Array, Floats
from ._library import Handle, Owner, call, context, lib, new_handle, number_of

_METHODS = {
    "linear": _native.SKIN_LINEAR,
    "dual_quaternion": _native.SKIN_DUAL_QUATERNION,
    "joint_translation": _native.SKIN_JOINT_TRANSLATION,
}

Posed = Tuple[Floats, Optional[Floats]]


class Skinner(Owner):
    """A part of a mesh ready to be posed. Immutable; may be used by many threads and jobs at once.

    Made by `Mesh.skinner`. Everything is in the space of that mesh.
    """

    _vertex_count: int

    @classmethod
    def _new(cls, mesh: Handle, part: int) -> Skinner:
        self = cls.__new__(cls)
        self._handle = new_handle(lib.anthronet_skinner_new, lib.anthronet_skinner_free, mesh, part)
        self._vertex_count = number_of(lib.anthronet_skinner_vertex_count, self._handle)
        return self

    @property
    def vertex_count(self) -> int:
        """Number of vertices that it poses."""
        return self._vertex_count

    def skin(
        self,
        joints: Array,
        positions: Optional[Array] = None,
        normals: Union[Array, None, bool] = None,
        method: str = "linear",
        offsets: Optional[Array] = None,
    ) -> Posed:
        """Poses the surface: `(positions, normals)`. Arguments and errors as of `SkinJob` and `skin`."""
        return skin([SkinJob(self, joints, positions, normals, method, offsets)])[0]

    def __repr__(self) -> str:
        return f"<Skinner of {self.vertex_count} vertices>"


@dataclass
class SkinJob:
    """One surface to pose.

    Args:
        skinner: the surface.
        joints: (joints, 7) float32, relative to the model: a quaternion x, y, z, w and a translation in metres, as
            `Clip.sample(…, relative="model")` gives them. Other numbers are converted.
        positions: (vertices, 3) float32 that is filled; rows may be any stride apart, each packed. None for a new one.
        normals: likewise for unit normals; False for none. May lie in the rows of `positions`, as in vertex buffers.
        method: `"linear"`, `"dual_quaternion"`, or `"joint_translation"`, which moves vertices without turning them.
        offsets: (vertices, 3) float32 added to the bind positions before they are posed (correctives), metres.
    """

    skinner: Skinner
    joints: Array
    positions: Optional[Array] = None
    normals: Union[Array, None, bool] = None
    method: str = "linear"
    offsets: Optional[Array] = None


def skin(jobs: Iterable[SkinJob]) -> List[Posed]:
    """Poses many surfaces in one call, on all cores: `(positions, normals)` of each job, in order.

    The numbers do not depend on how many jobs go together. Nothing is written unless all jobs are in order.

    Raises:
        ArgumentError: a pose has another number of joints, or an array that is filled overlaps another one of the call.
        InvalidError: a pose has numbers that are not finite.
        TypeError, ValueError: an array is of another shape, type or stride.
    """
    jobs = [_arguments.instance(job, SkinJob, "jobs") for job in jobs]
    prepared = [_Prepared(job) for job in jobs]
    count = len(prepared)
    described = (_native.SkinJob * count)(*[one.described for one in prepared])
    call(lib.anthronet_skin, context(), described, count)
    return [(one.positions, one.normals) for one in prepared]


class _Prepared:
    """A job whose arrays were looked at, and which keeps them."""

    __slots__ = ("described", "joints", "normals", "offsets", "positions", "skinner")

    def __init__(self, job: SkinJob) -> None:
        skinner = _arguments.instance(job.skinner, Skinner, "skinner")
        count = skinner.vertex_count
        self.skinner = skinner._open
        self.joints = _arguments.floats(job.joints, "joints", (None, 7))
        self.offsets = None if job.offsets is None else _arguments.floats(job.offsets, "offsets", (count, 3))
        self.positions = _output(job.positions, "positions", count)
        self.normals = None if job.normals is False else _output(job.normals, "normals", count)
        self.described = _native.SkinJob(
            struct_size=ctypes.sizeof(_native.SkinJob),
            method=_arguments.choice(_METHODS, job.method, "method"),
            skinner=self.skinner,
            joints=self.joints.ctypes.data,
            joint_count=len(self.joints),
            offset_count=0 if self.offsets is None else count,
            offsets=None if self.offsets is None else self.offsets.ctypes.data,
            positions=self.positions.ctypes.data,
            position_bytes=_arguments.extent(self.positions),
            position_stride=self.positions.strides[0],
        )
        if self.normals is not None:
            self.described.normals = self.normals.ctypes.data
            self.described.normal_bytes = _arguments.extent(self.normals)
            self.described.normal_stride = self.normals.strides[0]


def _output(array: Any, name: str, count: int) -> Array:
    return np.empty((count, 3), np.float32) if array is None else _arguments.filled(array, name, (count, 3))
