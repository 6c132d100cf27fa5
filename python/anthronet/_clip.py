"""Clips: motions of a body's joints, frame by frame."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple

import numpy as np

from . import _arguments, _native
from ._arguments import Array, Floats
from ._library import Handle, Owner, call, context, described, lib, new_handle, text, text_of

if TYPE_CHECKING:
    from ._body import Body

#: Names of the clips that the library carries.
BUILTIN_CLIPS: Tuple[str, ...] = tuple(
    text_of(lib.anthronet_clip_builtin_name, i) for i in range(lib.anthronet_clip_builtin_count())
)

_WRAPS = {"once": _native.WRAP_ONCE, "loop": _native.WRAP_LOOP, "root_motion": _native.WRAP_ROOT_MOTION}


class Clip(Owner):
    """A motion of a body's joints, frame by frame. Immutable; may be used by many threads.

    Made by `builtin_clip`, `Motion.retarget` and the methods below. Joints are those of the body, in its order: rows of
    seven float32, a unit quaternion x, y, z, w and a translation in metres.
    """

    _info: Any
    _name: str
    _report: Optional[Dict[str, Any]]

    @classmethod
    def _of(cls, handle: Handle, report: Optional[Dict[str, Any]] = None) -> Clip:
        self = cls.__new__(cls)
        info = described(_native.ClipInfo)
        call(lib.anthronet_clip_describe, handle, ctypes.byref(info))
        self._handle, self._info, self._name, self._report = handle, info, text(info.name), report
        return self

    @classmethod
    def _make(cls, make: Any, *arguments: Any) -> Clip:
        return cls._of(new_handle(make, lib.anthronet_clip_free, *arguments))

    @classmethod
    def from_poses(
        cls, body: Body, name: str, frames_per_second: float, frames: Array, space: str = "gltf"
    ) -> Clip:
        """A clip from poses of another program, such as an action of an armature.

        Args:
            body: whose joints move.
            name: of the clip.
            frames_per_second: its rate.
            frames: (frames, joints, 7) float32, each joint relative to its parent: a unit quaternion x, y, z, w and a
                translation in metres. Other numbers are converted.
            space: of `frames`: `"gltf"`, `"blender"` or `"unity"`.

        Raises:
            Error: numbers are not finite, quaternions not of unit length, or the rate is not positive.
            TypeError, ValueError: `frames` is of another shape, or an argument of another kind.
        """
        from ._body import Body

        body = _arguments.instance(body, Body, "body")
        encoded, rate = _arguments.text(name, "name"), _arguments.number(frames_per_second, "frames_per_second")
        array = _arguments.floats(frames, "frames", (None, body.joint_count, 7))
        count = len(array) * body.joint_count
        poses = (_space(space), array.ctypes.data, count)
        return cls._make(lib.anthronet_clip_from_poses, body._open, encoded, len(encoded), rate, *poses)

    @property
    def name(self) -> str:
        """Its name."""
        return self._name

    @property
    def frame_count(self) -> int:
        """Number of frames."""
        return int(self._info.frame_count)

    @property
    def joint_count(self) -> int:
        """Number of joints."""
        return int(self._info.joint_count)

    @property
    def frames_per_second(self) -> float:
        """Frames per second."""
        return float(self._info.frames_per_second)

    @property
    def duration(self) -> float:
        """From the first frame to the last, seconds."""
        return float(self._info.duration)

    @property
    def report(self) -> Optional[Dict[str, Any]]:
        """How the motion was retargeted: which joint drives which, which joints drive none, errors of directions, limits
        and feet. None for a clip that was not retargeted."""
        return self._report

    def sample(
        self,
        seconds: float,
        wrap: str = "once",
        relative: str = "parent",
        space: str = "gltf",
        out: Optional[Array] = None,
    ) -> Floats:
        """The pose at a time: (joints, 7) float32.

        Args:
            seconds: the time.
            wrap: `"once"` holds the first or last frame outside the duration, `"loop"` starts over, `"root_motion"` loops
                with root motion: every cycle continues where the last one ended.
            relative: `"parent"`, as animation tracks have it, or `"model"`, as skinning takes it.
            space: `"gltf"`, `"blender"` or `"unity"`.
            out: a packed float32 array of that shape, which is filled and returned instead of a new one.

        Raises:
            RequestError: `seconds` is not finite.
            TypeError, ValueError: an argument is none of these.
        """
        wrapped = _arguments.choice(_WRAPS, wrap, "wrap")
        to, of = _arguments.choice(_arguments.RELATIVE, relative, "relative"), _space(space)
        joints = _packed(out, (self.joint_count, 7))
        seconds = _arguments.number(seconds, "seconds")
        asked = (seconds, wrapped, to, of, joints.ctypes.data, self.joint_count)
        call(lib.anthronet_clip_sample, self._open, context(), *asked)
        return joints

    def bake(self, relative: str = "parent", space: str = "gltf", out: Optional[Array] = None) -> Floats:
        """All frames: (frames, joints, 7) float32. Arguments and errors as of `sample`."""
        to, of = _arguments.choice(_arguments.RELATIVE, relative, "relative"), _space(space)
        joints = _packed(out, (self.frame_count, self.joint_count, 7))
        count = self.frame_count * self.joint_count
        call(lib.anthronet_clip_bake, self._open, to, of, joints.ctypes.data, count)
        return joints

    def resample(self, frames_per_second: float) -> Clip:
        """The clip at another rate."""
        rate = _arguments.number(frames_per_second, "frames_per_second")
        return self._make(lib.anthronet_clip_resample, self._open, rate)

    def in_place(self) -> Clip:
        """The clip without root motion."""
        return self._make(lib.anthronet_clip_in_place, self._open)

    def looped(self, seconds: float) -> Clip:
        """The clip with its end blended into its beginning during the last `seconds`, so that it loops."""
        return self._make(lib.anthronet_clip_looped, self._open, _arguments.number(seconds, "seconds"))

    def crossfade(self, other: Clip, seconds: float) -> Clip:
        """This clip and then another of the same body, blended over the `seconds` by which they overlap."""
        second = _arguments.instance(other, Clip, "other")._open
        return self._make(lib.anthronet_clip_crossfade, self._open, second, _arguments.number(seconds, "seconds"))

    def blend(self, other: Clip, weight: float, mask: Optional[Array] = None) -> Clip:
        """This clip blended with another of the same body.

        Args:
            other: the other clip.
            weight: 0 is this clip, 1 the other.
            mask: (joints,) float32, a weight per joint from 0 (this clip) to 1 (blended fully), such as `joint_mask`
                gives; None for 1 everywhere.
        """
        second, share = _arguments.instance(other, Clip, "other")._open, _arguments.number(weight, "weight")
        if mask is None:
            return self._make(lib.anthronet_clip_blend, self._open, second, share)
        shares = self._shares(mask)
        return self._make(
            lib.anthronet_clip_blend_masked, self._open, second, share, shares.ctypes.data, len(shares)
        )

    def additive(
        self,
        layer: Clip,
        weight: float = 1.0,
        reference: Optional[Array] = None,
        mask: Optional[Array] = None,
        space: str = "gltf",
    ) -> Clip:
        """This clip plus the difference between a layer and a pose. A layer shorter than this clip starts over.

        Args:
            layer: a clip of the same body.
            weight: factor of the difference, 0 to 1.
            reference: (joints, 7) float32, the pose that adds nothing, each joint relative to its parent, as `sample`
                gives it; None for the layer's first frame.
            mask: as of `blend`.
            space: of `reference`.
        """
        other, share = _arguments.instance(layer, Clip, "layer")._open, _arguments.number(weight, "weight")
        shape = (self.joint_count, 7)
        pose = None if reference is None else _arguments.floats(reference, "reference", shape)
        shares = None if mask is None else self._shares(mask)
        return self._make(
            lib.anthronet_clip_additive,
            self._open,
            other,
            share,
            None if pose is None else pose.ctypes.data,
            0 if pose is None else len(pose),
            _space(space),
            None if shares is None else shares.ctypes.data,
            0 if shares is None else len(shares),
        )

    def joint_mask(self, *joints: str) -> Floats:
        """The mask of parts of the body, for `blend` and `additive`: (joints,) float32, 1 for these joints and all
        below them, else 0. `"spine_01"` is the upper body.

        Args:
            joints: names in the rig.

        Raises:
            Error: there is no such joint.
        """
        mask = np.zeros(self.joint_count, np.float32)
        for joint in joints:
            encoded, part = _arguments.text(joint, "joints"), np.empty_like(mask)
            call(lib.anthronet_clip_joint_mask, self._open, encoded, len(encoded), part.ctypes.data, len(part))
            np.maximum(mask, part, out=mask)
        return mask

    def _shares(self, mask: Array) -> Floats:
        return _arguments.floats(mask, "mask", (self.joint_count,))

    def __repr__(self) -> str:
        return f"<Clip {self.name!r}, {self.frame_count} frames at {self.frames_per_second:g}/s>"


def builtin_clip(name: str, body: Body) -> Clip:
    """A clip that the library carries, for a body.

    Args:
        name: one of `BUILTIN_CLIPS`.
        body: whose joints move.

    Raises:
        Error: there is no such clip; the message lists those that there are.
    """
    from ._body import Body

    encoded = _arguments.text(name, "name")
    body = _arguments.instance(body, Body, "body")
    return Clip._make(lib.anthronet_clip_builtin, encoded, len(encoded), body._open)


def _space(space: str) -> int:
    return _arguments.choice(_arguments.SPACES, space, "space")


def _packed(out: Optional[Array], shape: Tuple[int, ...]) -> Floats:
    if out is None:
        return np.empty(shape, np.float32)
    array = _arguments.instance(out, np.ndarray, "out")
    if array.dtype != np.float32 or not array.dtype.isnative:
        raise TypeError(f"out: expected an array of float32, got {array.dtype}")
    if array.shape != shape:
        raise ValueError(f"out: expected an array of shape {shape}, got {array.shape}")
    if not (array.flags.c_contiguous and array.flags.aligned and array.flags.writeable):
        raise ValueError("out: expected a packed array that can be written")
    return array
