"""AnthroNet: type tape measures, get a person: rigged, skinned and animated.

    >>> import anthronet
    >>> body = anthronet.generate(sex="female", height=1.70)
    >>> body.save("person.glb")

A `Request` describes a person, a `Model` makes a `Body` of it, a body has a `Mesh` and joints, a `Motion` read from a
file is retargeted to it as a `Clip`, and a `Skinner` poses its surface by the clip's joints. Bodies, meshes and the like are
freed with their last reference, at the end of `with`, or by `close`.

Metres, radians, seconds, kilograms. The space of a call says axes and handedness: `"gltf"` is right-handed, +Y
up, the character faces +Z; `"blender"` is right-handed, +Z up, it faces −Y; `"unity"` is left-handed, +Y up, it faces
+Z. A joint's +Y axis runs along its bone in all of them.
Quaternions are x, y, z, w. Matrices multiply column vectors.

All errors of the library are `Error`; arguments of a wrong type are TypeError, wrong values ValueError.
"""

from __future__ import annotations

from ._arguments import Path
from ._body import JOINT, MEASURE_REPORT, Body
from ._clip import BUILTIN_CLIPS, Clip, builtin_clip
from ._errors import (
    ArgumentError,
    BusyError,
    CancelledError,
    Error,
    FileError,
    InfeasibleError,
    InvalidError,
    IoError,
    ModelError,
    PanicError,
    RequestError,
    TakenError,
)
from ._humanoid import HUMANOID_BONES, HumanoidBone
from ._job import Job, Progress
from ._library import abi_version, lib, set_log_callback, text_of
from ._mesh import Mesh, MeshPart
from ._model import Measured, Model, default_model, generate
from ._motion import Motion, open_motion
from ._request import MEASURES, Request
from ._skin import Skinner, SkinJob, skin

__version__: str = text_of(lib.anthronet_version)

__all__ = [
    "BUILTIN_CLIPS",
    "HUMANOID_BONES",
    "JOINT",
    "MEASURES",
    "MEASURE_REPORT",
    "ArgumentError",
    "Body",
    "BusyError",
    "CancelledError",
    "Clip",
    "Error",
    "FileError",
    "HumanoidBone",
    "InfeasibleError",
    "InvalidError",
    "IoError",
    "Job",
    "Measured",
    "Mesh",
    "Model",
    "ModelError",
    "Motion",
    "PanicError",
    "MeshPart",
    "Path",
    "Progress",
    "Request",
    "RequestError",
    "SkinJob",
    "Skinner",
    "TakenError",
    "abi_version",
    "builtin_clip",
    "default_model",
    "generate",
    "open_motion",
    "set_log_callback",
    "skin",
]
