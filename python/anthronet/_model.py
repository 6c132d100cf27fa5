"""Models: what makes bodies of requests, and measures meshes."""

from __future__ import annotations

import ctypes
import threading
from typing import Any, Dict, Iterable, NamedTuple, Optional, Tuple

import numpy as np

from . import _arguments, _native
from ._arguments import Array, Path
from ._body import Body
from ._job import Job
from ._library import Owner, call, described, json_of, lib, new_handle, number_of
from ._request import MEASURES, Request


class Measured(NamedTuple):
    """What a tape and the scales say of a mesh."""

    #: All measures by name, metres.
    measures: Dict[str, float]
    #: Mass, kilograms.
    mass_kg: float
    #: Volume, cubic metres.
    volume_m3: float
    #: Body mass index, kg/m².
    bmi: float
    #: The level of detail that the mesh was recognised as.
    lod: int
    #: In which unit and axes a file was read, if not in metres with +Y up.
    warnings: Tuple[str, ...] = ()


class Model(Owner):
    """A trained model: makes bodies. Immutable; may be used by many threads at once.

    Opened by `Model.embedded`, `Model.open`, `Model.from_bytes` and `default_model`. Bodies and jobs made by it live on
    without it.
    """

    _latent_size: int

    @classmethod
    def _make(cls, make: Any, *arguments: Any) -> Model:
        self = cls.__new__(cls)
        self._handle = new_handle(make, lib.anthronet_model_free, *arguments)
        self._latent_size = number_of(lib.anthronet_model_latent_size, self._handle)
        return self

    @classmethod
    def embedded(cls) -> Model:
        """The model that the library carries."""
        return cls._make(lib.anthronet_model_open_embedded)

    @classmethod
    def open(cls, path: Path) -> Model:
        """A model file.

        Raises:
            ModelError: it is damaged or of another version.
            IoError: the system does not let it be read.
        """
        encoded = _arguments.path(path)
        return cls._make(lib.anthronet_model_open_path, encoded, len(encoded))

    @classmethod
    def from_bytes(cls, data: Any) -> Model:
        """A model from the bytes of its file, which are not needed afterwards.

        Raises:
            ModelError: they are damaged or of another version.
        """
        content = _arguments.data(data, "data")
        return cls._make(lib.anthronet_model_open_memory, content.ctypes.data, len(content))

    def info(self) -> Dict[str, Any]:
        """What the model is: measures with definitions and ranges, joints, versions, scores. A copy."""
        said: Dict[str, Any] = json_of(lib.anthronet_model_info, self._open)
        return said

    @property
    def latent_size(self) -> int:
        """Number of latent numbers of a body."""
        return self._latent_size

    def vertex_count(self, lod: int) -> int:
        """Number of vertices of the body at a level of detail, 0 to 3, in the model's order."""
        return number_of(lib.anthronet_model_vertex_count, self._open, _arguments.whole(lod, "lod"))

    def measure_range(self, name: str) -> Tuple[float, float]:
        """The smallest and largest value that a request may give of a measure, metres.

        Args:
            name: with its side, one of `MEASURES`.

        Raises:
            RequestError: there is no such measure.
        """
        encoded = _arguments.text(name, "name")
        return self._range(number_of(lib.anthronet_measure_index, encoded, len(encoded)))

    @property
    def measure_ranges(self) -> Dict[str, Tuple[float, float]]:
        """The ranges of all measures by name, metres. A copy."""
        return {name: self._range(i) for i, name in enumerate(MEASURES)}

    def _range(self, measure: int) -> Tuple[float, float]:
        low, high = ctypes.c_double(), ctypes.c_double()
        call(lib.anthronet_model_measure_range, self._open, measure, ctypes.byref(low), ctypes.byref(high))
        return low.value, high.value

    def generate(self, request: Request) -> Body:
        """Makes the body that a request describes.

        Raises:
            RequestError: a field is not finite or out of range.
            InfeasibleError: the measures cannot belong to one person.
        """
        request = _arguments.instance(request, Request, "request")
        return self._body(lib.anthronet_generate, request._handle)

    def interpolate(self, a: Request, b: Request, t: float) -> Body:
        """Makes a body between two requests: `t` = 0 is the first, 1 the second."""
        a, b = _arguments.instance(a, Request, "a"), _arguments.instance(b, Request, "b")
        return self._body(lib.anthronet_interpolate, a._handle, b._handle, _arguments.number(t, "t"))

    def _body(self, make: Any, *arguments: Any) -> Body:
        return Body._of(new_handle(make, lib.anthronet_body_free, self._open, *arguments), self._latent_size)

    def start(self, requests: Iterable[Request]) -> Job:
        """Starts to make the bodies of many requests, in order, beside the caller's thread."""
        return Job._new(self._open, list(requests), self._latent_size)

    def measure(self, positions: Array, space: str = "gltf") -> Measured:
        """Measures a body in its bind pose at any level of detail, sculpted or not.

        Args:
            positions: (vertices, 3) float32, metres: the vertices of the body alone in the model's order, as the first
                part of a mesh in the model layout has them; rows any stride apart. Other numbers are converted.
            space: `"gltf"`, `"blender"` or `"unity"`.

        Raises:
            ArgumentError: its number of vertices is not that of a body.
            InvalidError: numbers that are not finite.
        """
        number = _arguments.choice(_arguments.SPACES, space, "space")
        array = positions
        direct = isinstance(array, np.ndarray) and array.dtype == np.float32 and array.dtype.isnative
        if not (direct and array.ndim == 2 and array.shape[1] == 3 and _arguments.packed_rows(array)):
            array = _arguments.floats(positions, "positions", (None, 3))
        count = _arguments.whole(len(array), "positions")
        stride = array.strides[0] if count > 1 else 0
        metres = (ctypes.c_double * len(MEASURES))()
        found = described(_native.Measured)
        place = (array.ctypes.data, count, stride, number)
        call(lib.anthronet_measure_mesh, self._open, *place, metres, len(MEASURES), ctypes.byref(found))
        return Measured(dict(zip(MEASURES, metres)), found.mass_kg, found.volume_m3, found.bmi, found.lod)

    def measure_file(self, path: Path) -> Measured:
        """Measures the body of a file: .glb, .gltf, .vrm, .obj, .usd, .usda, .usdc or .usdz with the model's vertex order.

        Other units and axes are found from the body, and `warnings` say so.

        Raises:
            FileError: there is no such body in it.
            IoError: the system does not let it be read.
        """
        encoded = _arguments.path(path)
        said = json_of(lib.anthronet_measure_file_report, self._open, encoded, len(encoded))
        measures = {row["name"]: row["value"] for row in said.pop("measures")}
        return Measured(measures=measures, warnings=tuple(said.pop("warnings")), **said)

    def __repr__(self) -> str:
        return "<Model, closed>" if self.closed else "<Model>"


_default: Optional[Model] = None
_default_lock = threading.Lock()


def default_model() -> Model:
    """The model file that the environment variable ANTHRONET_MODEL names, else the one that the library carries.

    Opened once; all callers share it.
    """
    global _default
    with _default_lock:
        if _default is None or _default.closed:
            _default = Model._make(lib.anthronet_model_open_default)
        return _default


def generate(
    sex: Optional[str] = None,
    seed: int = 0,
    model: Optional[Model] = None,
    latent: Optional[Iterable[float]] = None,
    fill: str = "mean",
    nearest: bool = False,
    **measures: Optional[float],
) -> Body:
    """Makes a body: `generate("female", height=1.70)`.

    Args:
        model: what makes it; None for `default_model()`.
        sex, seed, latent, fill, nearest, **measures: as of `Request`.

    Raises:
        RequestError: a measure is unknown, not finite or out of range.
        InfeasibleError: the measures cannot belong to one person.
        TypeError, ValueError: an argument is of another kind; the message names it.
    """
    request = Request(sex, seed, latent, fill, nearest, **measures)
    model = default_model() if model is None else _arguments.instance(model, Model, "model")
    return model.generate(request)
