"""Motions: motion files as they were read, before they are retargeted."""

from __future__ import annotations

import ctypes
import json
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Sequence, Tuple

import numpy as np

from . import _arguments, _native
from ._arguments import Array, Path
from ._clip import Clip
from ._library import Handle, Owner, call, described, json_of, lib, new_handle, number_of, take_bytes, text_of

if TYPE_CHECKING:
    from ._body import Body

_FINGERS = {
    "source": _native.FINGERS_SOURCE,
    "relaxed": _native.FINGERS_RELAXED,
    "rest": _native.FINGERS_REST,
}
_UPS = {
    None: _native.UP_FOUND,
    "x": _native.UP_X,
    "y": _native.UP_Y,
    "z": _native.UP_Z,
    "-x": _native.UP_NEGATIVE_X,
    "-y": _native.UP_NEGATIVE_Y,
    "-z": _native.UP_NEGATIVE_Z,
}


class Motion(Owner):
    """A motion file as it was read: at least one clip of its own skeleton. Immutable; may be used by many threads.

    Made by `open_motion`, `Motion.from_bytes` and `Motion.from_poses`.
    """

    @classmethod
    def _make(cls, make: Any, *arguments: Any) -> Motion:
        self = cls.__new__(cls)
        self._handle = new_handle(make, lib.anthronet_motion_free, *arguments)
        return self

    @classmethod
    def from_bytes(
        cls,
        data: Any,
        name: str,
        metres_per_unit: Optional[float] = None,
        up: Optional[str] = None,
        frames_per_second: Optional[float] = None,
        person: Optional[int] = None,
    ) -> Motion:
        """Reads a motion file from memory.

        Args:
            data: bytes, or anything that has some.
            name: the file's: its extension says the format, and a clip without a name gets it.
            metres_per_unit, up, frames_per_second, person: as of `open_motion`.
        """
        options = _options(metres_per_unit, up, frames_per_second, person)
        content, encoded = _arguments.data(data, "data"), _arguments.text(name, "name")
        return cls._make(
            lib.anthronet_motion_open_memory,
            content.ctypes.data,
            len(content),
            encoded,
            len(encoded),
            ctypes.byref(options),
        )

    @classmethod
    def from_poses(
        cls,
        name: str,
        joint_names: Sequence[str],
        parents: Sequence[int],
        rest: Array,
        frames: Array,
        frames_per_second: float,
        space: str = "gltf",
    ) -> Motion:
        """A motion from poses of a skeleton of another program, such as an action of an armature.

        Args:
            name: of its clip.
            joint_names: one per joint, none twice.
            parents: place of each joint's parent, before the joint's own; −1 for none.
            rest: (joints, 7) float32: where each joint rests relative to its parent, a unit quaternion x, y, z, w and a
                translation in metres. Other numbers are converted.
            frames: (frames, joints, 7) float32: likewise for each frame.
            frames_per_second: their rate.
            space: of the transforms: `"gltf"`, `"blender"` or `"unity"`.

        Raises:
            Error: numbers are not finite, a parent is not before its joint, or a name comes twice.
            TypeError, ValueError: an argument is of another kind or shape.
        """
        if isinstance(joint_names, (str, bytes)):
            raise TypeError("joint_names: expected a list of names, got one text")
        encoded = [_arguments.text(one, "joint_names") for one in joint_names]
        count = len(encoded)
        places = np.array([_arguments.place(one, "parents") for one in parents], np.int32)
        _arguments.shaped(places, "parents", (count,))
        resting = _arguments.floats(rest, "rest", (count, 7))
        poses = _arguments.floats(frames, "frames", (None, count, 7))
        clip_name, buffers = _arguments.text(name, "name"), [ctypes.c_char_p(one) for one in encoded]
        kept = ctypes.c_char_p(clip_name)
        texts = (_native.Text * count)(*[_text(buffer, len(one)) for buffer, one in zip(buffers, encoded)])
        source = described(
            _native.MotionSource,
            space=_arguments.choice(_arguments.SPACES, space, "space"),
            joint_count=count,
            frame_count=_arguments.whole(len(poses), "frames"),
            frames_per_second=_arguments.number(frames_per_second, "frames_per_second"),
            name=_text(kept, len(clip_name)),
            joint_names=ctypes.addressof(texts),
            parents=places.ctypes.data,
            rest=resting.ctypes.data,
            frames=poses.ctypes.data,
        )
        return cls._make(lib.anthronet_motion_from_poses, ctypes.byref(source))

    @property
    def clip_names(self) -> Tuple[str, ...]:
        """The names of its clips."""
        handle = self._open
        count = number_of(lib.anthronet_motion_clip_count, handle)
        return tuple(text_of(lib.anthronet_motion_clip_name, handle, i) for i in range(count))

    @property
    def report(self) -> Dict[str, Any]:
        """How the file was read: format, unit, up axis, frame rate, how each was found, warnings. A copy."""
        said: Dict[str, Any] = json_of(lib.anthronet_motion_report, self._open)
        return said

    def retarget(
        self,
        body: Body,
        clip: int = 0,
        fingers: str = "source",
        limits: bool = True,
        feet: bool = True,
        in_place: bool = False,
        looped: bool = False,
        root_motion: bool = False,
        mapping: Optional[Mapping[str, Optional[str]]] = None,
        frames_per_second: Optional[float] = None,
        force: bool = False,
    ) -> Clip:
        """Retargets one clip to a body.

        Args:
            body: whose joints move.
            clip: its place in `clip_names`.
            fingers: `"source"` for those of the motion where it has any, `"relaxed"` for relaxed hands, `"rest"` for those
                of the bind pose.
            limits: keeps joints within the limits of human joints.
            feet: keeps feet that touch the floor from sliding and sinking in.
            in_place: removes root motion.
            looped: blends the end into the beginning, so that the clip loops.
            root_motion: puts root motion on the joint `Root` instead of the pelvis.
            mapping: which joint of the motion drives which joint of the rig, or none: `{"LeftArm": "upperarm_l", "Jaw":
                None}`; other joints are matched automatically.
            frames_per_second: rate of the result; None for the motion's.
            force: accepts a motion that seems to be no person's, an animal's for example, or in which nobody stands.

        Returns:
            A clip with a `report`. Its `confidence` says how sure it is that the motion is a person's, as `value` from 0 to 1,
            and why it may be none, as `doubts`.

        Raises:
            ArgumentError: there is no such clip.
            Error: the joints cannot be matched, or the mapping names what there is not; the motion is more likely no person's (a
                confidence below 0.5), and it has no mapping and is not forced.
        """
        from ._body import Body

        body = _arguments.instance(body, Body, "body")
        said = b"" if mapping is None else json.dumps(dict(mapping)).encode()
        kept = ctypes.create_string_buffer(said, max(len(said), 1))
        options = described(
            _native.RetargetOptions,
            fingers=_arguments.choice(_FINGERS, fingers, "fingers"),
            no_limits=1 - _arguments.flag(limits, "limits"),
            no_feet=1 - _arguments.flag(feet, "feet"),
            in_place=_arguments.flag(in_place, "in_place"),
            looped=_arguments.flag(looped, "looped"),
            root_motion=_arguments.flag(root_motion, "root_motion"),
            mapping_length=len(said),
            mapping_json=ctypes.addressof(kept) if said else None,
            frames_per_second=_rate(frames_per_second),
            force=_arguments.flag(force, "force"),
        )
        made, report = Handle(), Handle()
        call(
            lib.anthronet_motion_retarget,
            self._open,
            _arguments.whole(clip, "clip"),
            body._open,
            ctypes.byref(options),
            ctypes.byref(made),
            ctypes.byref(report),
        )
        made.kept(lib.anthronet_clip_free)
        return Clip._of(made, json.loads(take_bytes(report.kept(lib.anthronet_bytes_free))))

    def __repr__(self) -> str:
        return f"<Motion {', '.join(map(repr, self.clip_names))}>" if not self.closed else "<Motion, closed>"


def open_motion(
    path: Path,
    metres_per_unit: Optional[float] = None,
    up: Optional[str] = None,
    frames_per_second: Optional[float] = None,
    person: Optional[int] = None,
) -> Motion:
    """Reads a motion file: .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .npz (AMASS, SMPL-X), .usd, .usda, .usdc or .usdz.

    Args:
        path: of the file.
        metres_per_unit: such as 0.01 for centimetres; None for what the file says, or its skeleton's size.
        up: `"x"`, `"y"` or `"z"`, or with a minus where that axis points down, as `"-y"` does in the axes of cameras; None for
            what the file says, or its skeleton's stance.
        frames_per_second: the rate that frames were recorded at, and that curves are sampled at.
        person: which of several people in an .npz, from 0; None for the first, with a warning in the report.

    Raises:
        FileError: the file is not what its extension says.
        IoError: the system does not let it be read.
        TypeError, ValueError: an argument does not fit.
    """
    options = _options(metres_per_unit, up, frames_per_second, person)
    encoded = _arguments.path(path)
    return Motion._make(lib.anthronet_motion_open_path, encoded, len(encoded), ctypes.byref(options))


def _text(buffer: ctypes.c_char_p, length: int) -> _native.Text:
    return _native.Text(ctypes.cast(buffer, ctypes.c_void_p), length)


def _options(
    metres_per_unit: Optional[float], up: Optional[str], frames_per_second: Optional[float], person: Optional[int]
) -> Any:
    return described(
        _native.MotionOptions,
        up=_arguments.choice(_UPS, up, "up"),
        metres_per_unit=0.0 if metres_per_unit is None else _arguments.positive(metres_per_unit, "metres_per_unit"),
        frames_per_second=_rate(frames_per_second),
        # The library counts from 1, as 0 is its default.
        person=0 if person is None else _arguments.whole(_arguments.whole(person, "person") + 1, "person"),
    )


def _rate(frames_per_second: Optional[float]) -> float:
    # 0 asks the library for the default, which None does here.
    return 0.0 if frames_per_second is None else _arguments.positive(frames_per_second, "frames_per_second")
