"""Bodies: what a model makes of a request."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Dict, Iterable, Optional, Tuple

import numpy as np

from . import _arguments, _native
from ._arguments import Array, Doubles, Path
from ._clip import Clip
from ._library import Handle, Owner, bytes_of, call, described, json_of, lib, text_of
from ._request import MEASURES

if TYPE_CHECKING:
    from ._mesh import Mesh

#: A row of `Body.measure_reports`; metres, percentile 0 to 100.
MEASURE_REPORT = np.dtype(_native.MeasureReport)

#: A row of `Body.joints`. `parent_from_joint` is a unit quaternion x, y, z, w and a translation, as in clips; matrices are
#: relative to the model and multiply column vectors.
JOINT = np.dtype(
    [
        ("parent", np.int32),
        ("length", np.float32),
        ("parent_from_joint", np.float32, (7,)),
        ("model_from_joint", np.float32, (4, 4)),
        ("joint_from_model", np.float32, (4, 4)),
    ]
)


class Body(Owner):
    """A person in the bind pose, with the report of how it was made. Immutable; may be used by many threads.

    Made by `generate`, `Model.generate`, `Model.interpolate` and `Job.take`.
    """

    _latent_size: int
    _summary: Any

    @classmethod
    def _of(cls, handle: Handle, latent_size: int) -> Body:
        self = cls.__new__(cls)
        summary = described(_native.BodySummary)
        call(lib.anthronet_body_summarise, handle, ctypes.byref(summary))
        self._handle, self._latent_size, self._summary = handle, latent_size, summary
        return self

    @property
    def sex(self) -> str:
        """`"female"` or `"male"`."""
        return "female" if self._summary.sex == _native.SEX_FEMALE else "male"

    @property
    def seed(self) -> int:
        """The request's seed."""
        return int(self._summary.seed)

    @property
    def mass_kg(self) -> float:
        """Mass, kilograms."""
        return float(self._summary.mass_kg)

    @property
    def volume_m3(self) -> float:
        """Volume, cubic metres."""
        return float(self._summary.volume_m3)

    @property
    def bmi(self) -> float:
        """Body mass index, kg/m²."""
        return float(self._summary.bmi)

    @property
    def converged(self) -> bool:
        """Whether the exact solve met its tolerance."""
        return bool(self._summary.converged)

    @property
    def solve_residual(self) -> float:
        """Largest difference between a given measure and the body's, metres."""
        return float(self._summary.solve_residual)

    @property
    def iterations(self) -> int:
        """Steps of the exact solve."""
        return int(self._summary.iterations)

    @property
    def joint_count(self) -> int:
        """Number of joints."""
        return int(self._summary.joint_count)

    @property
    def latent(self) -> Doubles:
        """The latent numbers of the body: (latent size,) float64. A copy."""
        latent = np.empty(self._latent_size)
        call(lib.anthronet_body_latent, self._open, latent.ctypes.data, len(latent))
        return latent

    @property
    def report(self) -> Dict[str, Any]:
        """How the body was made, as `anthronet generate --report` writes it: for each measure asked, obtained, residual,
        percentile, how it was filled; warnings, conflicts; metres. A copy."""
        said: Dict[str, Any] = json_of(lib.anthronet_body_report, self._open)
        return said

    @property
    def measures(self) -> Dict[str, float]:
        """All measures of the body by name, in the order of `MEASURES`, metres. A copy."""
        return dict(zip(MEASURES, self.measure_reports["obtained"].tolist()))

    @property
    def measure_reports(self) -> Array:
        """One row per measure, in the order of `MEASURES`, of the type `MEASURE_REPORT`.

        Fields: `asked`, `obtained`, `residual`, the 90 % interval `low90` to `high90` (metres), `percentile`, `given`
        (1 or 0), `filled` (0 with the mean, 1 by a draw). `asked` and `residual` are 0 for filled measures. A copy.
        """
        reports = np.empty(len(MEASURES), MEASURE_REPORT)
        call(lib.anthronet_body_measures, self._open, reports.ctypes.data, len(reports))
        return reports

    def joints(self, space: str = "gltf") -> Array:
        """The joints in the bind pose, parents first: (joints,) of `JOINT`, metres.

        Fields: `parent` (−1 of the root), `length` (along +Y to where the bone ends), `parent_from_joint` (a quaternion
        x, y, z, w and a translation), `model_from_joint` and its inverse `joint_from_model` as 4 × 4 matrices
        that multiply column vectors: `model_from_joint[:3, 3]` is where the joint is. A copy.

        Args:
            space: `"gltf"`, `"blender"` or `"unity"`.
        """
        joints = np.empty(self.joint_count, JOINT)
        number = _arguments.choice(_arguments.SPACES, space, "space")
        call(lib.anthronet_body_joints, self._open, number, joints.ctypes.data, len(joints))
        for matrix in ("model_from_joint", "joint_from_model"):
            # The library's are column-major, numpy's row-major.
            joints[matrix] = joints[matrix].transpose(0, 2, 1).copy()
        return joints

    def joint_names(self, names: str = "native") -> Tuple[str, ...]:
        """The names of the joints, in their order.

        Args:
            names: `"native"`, `"unity"`, `"mixamo"`, `"vrm"` or `"blender"`; joints without a name there keep theirs.
        """
        number = _arguments.choice(_arguments.NAMES, names, "names")
        handle = self._open
        return tuple(text_of(lib.anthronet_body_joint_name, handle, i, number) for i in range(self.joint_count))

    @property
    def parents(self) -> Array:
        """Place of each joint's parent, −1 of the root: (joints,) int32. A copy."""
        return self.joints()["parent"].copy()

    def mesh(
        self,
        lod: int = 0,
        influences: int = 4,
        space: str = "gltf",
        layout: str = "render",
        body_only: bool = False,
        skin_tone: int = 0,
    ) -> Mesh:
        """The surfaces of the body, as arrays.

        Args:
            lod: level of detail, 0 (53,514 vertices) to 3.
            influences: joints per vertex, 4 or 8.
            space: `"gltf"`, `"blender"` or `"unity"`: axes, handedness, winding and direction of v.
            layout: `"render"` for triangles with vertices doubled at seams, `"model"` for the model's vertices and
                quads with texture coordinates by corner.
            body_only: leaves out eyes, teeth, tongue and lashes.
            skin_tone: step of the Monk scale, 1 to 10; 0 for the default.

        Raises:
            ArgumentError, InvalidError, TypeError, ValueError: an argument is none of these.
        """
        from ._mesh import Mesh

        return Mesh._new(self, lod, influences, space, layout, body_only, skin_tone)

    def save(
        self,
        path: Path,
        lod: int = 0,
        influences: int = 4,
        joint_names: str = "native",
        clips: Iterable[Clip] = (),
        compress: bool = False,
        skin_tone: int = 0,
        body_only: bool = False,
        pose: str = "t-pose",
    ) -> None:
        """Writes the body to a file, completely or not at all, in the format of its extension: .glb, .gltf (and .bin
        beside it), .vrm, .usda, .usdc, .usdz or .obj.

        Args:
            path: where to.
            lod: level of detail, 0 to 3.
            influences: joints per vertex, 4 or 8.
            joint_names: `"native"`, `"unity"`, `"mixamo"`, `"vrm"` or `"blender"`.
            clips: motions that go into the file; their names must differ.
            compress: EXT_meshopt_compression, for .glb and .gltf.
            skin_tone: step of the Monk scale, 1 to 10; 0 for the default.
            body_only: leaves out eyes, teeth, tongue and lashes.
            pose: the pose in which the file stands: `"t-pose"`, `"a-pose"`, `"standing"` or `"sitting"`. Files with joints
                stay bound in the T-pose, the only one of a .vrm; an .obj has the posed surface.

        Raises:
            FileError, IoError: the extension is unknown, or the system does not let it be written.
            ArgumentError, InvalidError, TypeError, ValueError: an argument does not fit.
        """
        encoded = _arguments.path(path)
        options, kept = _export_options(lod, influences, joint_names, clips, compress, skin_tone, body_only, pose)
        call(lib.anthronet_export_path, self._open, ctypes.byref(options), encoded, len(encoded))
        del kept

    def to_bytes(
        self,
        format: str,
        lod: int = 0,
        influences: int = 4,
        joint_names: str = "native",
        clips: Iterable[Clip] = (),
        compress: bool = False,
        skin_tone: int = 0,
        body_only: bool = False,
        pose: str = "t-pose",
    ) -> bytes:
        """The file that `save` writes, as bytes.

        Args:
            format: `"glb"`, `"vrm"`, `"usda"`, `"usdc"`, `"usdz"` or `"obj"`; the rest as of `save`.
        """
        encoded = _arguments.text(format, "format")
        options, kept = _export_options(lod, influences, joint_names, clips, compress, skin_tone, body_only, pose)
        result = bytes_of(lib.anthronet_export_memory, self._open, ctypes.byref(options), encoded, len(encoded))
        del kept
        return result

    def __repr__(self) -> str:
        return f"<Body {self.sex} seed {self.seed}, {self.mass_kg:.1f} kg{', closed' if self.closed else ''}>"


def _export_options(
    lod: int,
    influences: int,
    joint_names: str,
    clips: Iterable[Clip],
    compress: bool,
    skin_tone: int,
    body_only: bool,
    pose: str,
) -> Tuple[Any, Optional[Any]]:
    """The options, and what has to live as long as they do."""
    if isinstance(clips, Clip):
        raise TypeError("clips: expected a list of clips, got one clip: put it into a list")
    handles = [_arguments.instance(clip, Clip, "clips")._open for clip in clips]
    name = _arguments.text(pose, "pose")
    text = ctypes.create_string_buffer(name, len(name) + 1)
    addresses = (ctypes.c_void_p * len(handles))(*[handle.value for handle in handles])
    options = described(
        _native.ExportOptions,
        lod=_arguments.whole(lod, "lod"),
        influences=_arguments.whole(influences, "influences"),
        joint_names=_arguments.choice(_arguments.NAMES, joint_names, "joint_names"),
        body_only=_arguments.flag(body_only, "body_only"),
        skin_tone=_arguments.whole(skin_tone, "skin_tone"),
        compress=_arguments.flag(compress, "compress"),
        clip_count=len(handles),
        clips=ctypes.addressof(addresses) if handles else None,
        pose=ctypes.addressof(text),
        pose_length=len(name),
    )
    return options, (handles, addresses, text)
