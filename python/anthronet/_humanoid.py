"""The bones of the standard humanoid, and what they are called elsewhere."""

from __future__ import annotations

import ctypes
from typing import NamedTuple, Tuple

from . import _native
from ._library import call, described, lib, text


class HumanoidBone(NamedTuple):
    """A joint that is a bone of the standard humanoid, with its name in every vocabulary."""

    #: In the rig.
    native: str
    #: In Unity's `HumanBodyBones`.
    unity: str
    #: In Unity's `HumanTrait.BoneName`.
    unity_trait: str
    #: In files from Mixamo.
    mixamo: str
    #: In VRM 1.0's `humanBones`.
    vrm: str
    #: In Blender.
    blender: str
    #: Whether Unity and VRM 1.0 require it.
    required: bool


def _bone(index: int) -> HumanoidBone:
    bone = described(_native.HumanoidBone)
    call(lib.anthronet_humanoid_bone_at, index, ctypes.byref(bone))
    names = {name: text(getattr(bone, name)) for name in HumanoidBone._fields if name != "required"}
    return HumanoidBone(required=bool(bone.required), **names)


#: All of them.
HUMANOID_BONES: Tuple[HumanoidBone, ...] = tuple(map(_bone, range(lib.anthronet_humanoid_bone_count())))
