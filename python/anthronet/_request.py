"""Requests: who is to be made."""

from __future__ import annotations

import threading
from ctypes import c_double, c_uint8
from typing import Any, Dict, Iterable, Iterator, List, Optional, Tuple

from . import _arguments, _native
from ._library import Handle, bytes_of, call, json_of, lib, new_handle, number_of, text_of

#: Names of the measures, in the order of all arrays of measures.
MEASURES: Tuple[str, ...] = tuple(text_of(lib.anthronet_measure_name, i) for i in range(lib.anthronet_measure_count()))

_SEXES = {None: _native.SEX_ANY, "female": _native.SEX_FEMALE, "male": _native.SEX_MALE}
_FILLS = {"mean": _native.FILL_MEAN, "sample": _native.FILL_SAMPLE}


class Request:
    """A person to be made: any subset of the measures, a sex, a seed.

    The same request gives the same person, to the last bit. Measures are set, read and unset as in a
    dictionary; a name without its side, such as `arm_length`, stands for both. May be used by many threads.

    Args:
        sex: `"female"`, `"male"`, or None to leave it to the measures.
        seed: 0 for the likeliest person with these measures; any other number below 2**64 for another one.
        latent: the latent numbers by hand, `Model.latent_size` of them, each normally distributed with variance 1; None
            to leave them to the seed.
        fill: how measures that are not given are filled: `"mean"` for the likeliest values, `"sample"` for ones
            drawn by the seed.
        nearest: whether measures that no person has are replaced by the nearest that a person has, with a warning in the
            report, instead of refused.
        **measures: values by name, metres; None for one that is not given.

    Raises:
        RequestError: a name is no measure, or a value is not finite. Ranges are checked when a body is made.
        TypeError, ValueError: an argument is of another kind; the message names it.
    """

    __slots__ = ("_handle", "_lock", "__weakref__")

    def __init__(
        self,
        sex: Optional[str] = None,
        seed: int = 0,
        latent: Optional[Iterable[float]] = None,
        fill: str = "mean",
        nearest: bool = False,
        **measures: Optional[float],
    ) -> None:
        handle = _new(lib.anthronet_request_new)
        _set_sex(handle, sex)
        _set_seed(handle, seed)
        _set_latent(handle, latent)
        _set_fill(handle, fill)
        _set_nearest(handle, nearest)
        # One side goes before both, whatever the order.
        for name in sorted(measures, key=MEASURES.__contains__):
            _set_measure(handle, name, measures[name])
        self._handle = handle
        self._lock = threading.Lock()

    @classmethod
    def _of(cls, handle: Handle) -> Request:
        self = cls.__new__(cls)
        self._handle = handle
        self._lock = threading.Lock()
        return self

    @classmethod
    def from_json(cls, text: str) -> Request:
        """A request from JSON: `{"sex": "female", "measures": {"height": 1.7}, "seed": 7}`; metres.

        Raises:
            RequestError: the text is not such JSON, or names what there is not.
        """
        data = _arguments.text(text, "text")
        return cls._of(_new(lib.anthronet_request_from_json, data, len(data)))

    def to_json(self) -> str:
        """The request in the form that `from_json` reads."""
        return bytes_of(lib.anthronet_request_to_json, self._handle).decode()

    def copy(self) -> Request:
        """A copy of the request."""
        return self._of(_new(lib.anthronet_request_copy, self._handle))

    __copy__ = copy

    def __deepcopy__(self, _memo: object) -> Request:
        return self.copy()

    def __reduce__(self) -> Any:
        return Request.from_json, (self.to_json(),)

    def _fields(self) -> Dict[str, Any]:
        said: Dict[str, Any] = json_of(lib.anthronet_request_to_json, self._handle)
        return said

    def _change(self, change: Any, *arguments: Any) -> None:
        # A handle that others may be reading is never changed: a copy of it is, and takes its place.
        with self._lock:
            handle = _new(lib.anthronet_request_copy, self._handle)
            change(handle, *arguments)
            self._handle = handle

    @property
    def sex(self) -> Optional[str]:
        """`"female"`, `"male"` or None."""
        return self._fields().get("sex")

    @sex.setter
    def sex(self, value: Optional[str]) -> None:
        self._change(_set_sex, value)

    @property
    def seed(self) -> int:
        """0 for the likeliest person, any other for one of the people with these measures."""
        return int(self._fields()["seed"])

    @seed.setter
    def seed(self, value: int) -> None:
        self._change(_set_seed, value)

    @property
    def latent(self) -> Optional[List[float]]:
        """The latent numbers given by hand; None where the seed chooses them."""
        return self._fields().get("z")

    @latent.setter
    def latent(self, value: Optional[Iterable[float]]) -> None:
        self._change(_set_latent, value)

    @property
    def fill(self) -> str:
        """`"mean"` or `"sample"`."""
        return str(self._fields()["fill"])

    @fill.setter
    def fill(self, value: str) -> None:
        self._change(_set_fill, value)

    @property
    def nearest(self) -> bool:
        """Whether the nearest person is made if no person has these measures."""
        return bool(self._fields()["nearest"])

    @nearest.setter
    def nearest(self, value: bool) -> None:
        self._change(_set_nearest, value)

    @property
    def measures(self) -> Dict[str, float]:
        """The given measures by name, in the order of `MEASURES`, metres: a copy."""
        values, given = (c_double * len(MEASURES))(), (c_uint8 * len(MEASURES))()
        call(lib.anthronet_request_measures, self._handle, values, given, len(MEASURES))
        return {name: value for name, value, there in zip(MEASURES, values, given) if there}

    @measures.setter
    def measures(self, value: Dict[str, Optional[float]]) -> None:
        self._change(_set_measures, value)

    def __setitem__(self, name: str, metres: Optional[float]) -> None:
        """Sets a measure, or unsets it with None. RequestError where there is no such measure."""
        self._change(_set_measure, name, metres)

    def __delitem__(self, name: str) -> None:
        """Unsets a measure, given or not. RequestError where there is no such measure."""
        self._change(_set_measure, name, None)

    def __getitem__(self, name: str) -> float:
        """A given measure, metres. KeyError where it is not given, is none, or where two sides differ."""
        measures = self.measures
        sides = _sides(name)
        values = {measures[side] for side in sides if side in measures}
        if len(values) != 1 or not all(side in measures for side in sides):
            raise KeyError(name)
        return values.pop()

    def __contains__(self, name: object) -> bool:
        measures, sides = self.measures, _sides(name)
        return bool(sides) and all(side in measures for side in sides)

    def __iter__(self) -> Iterator[str]:
        return iter(self.measures)

    def __len__(self) -> int:
        return len(self.measures)

    def __bool__(self) -> bool:
        return True

    def __eq__(self, other: object) -> Any:
        return self._fields() == other._fields() if isinstance(other, Request) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        fields = self._fields()
        words = {"sex": fields.get("sex"), "seed": fields["seed"], "latent": fields.get("z"), "fill": fields["fill"]}
        words.update(nearest=fields["nearest"], **fields["measures"])
        plain = {"sex": None, "seed": 0, "latent": None, "fill": "mean", "nearest": False}
        said = ", ".join(f"{name}={value!r}" for name, value in words.items() if plain.get(name, self) != value)
        return f"Request({said})"


def _new(make: Any, *arguments: Any) -> Handle:
    return new_handle(make, lib.anthronet_request_free, *arguments)


def _sides(name: object) -> List[str]:
    """The measures that a name speaks of."""
    return [one for one in MEASURES if one == name or one in (f"{name}_left", f"{name}_right")]


def _set_sex(handle: Handle, value: Optional[str]) -> None:
    call(lib.anthronet_request_set_sex, handle, _arguments.choice(_SEXES, value, "sex"))


def _set_seed(handle: Handle, value: int) -> None:
    call(lib.anthronet_request_set_seed, handle, _arguments.whole(value, "seed", 64))


def _set_latent(handle: Handle, value: Optional[Iterable[float]]) -> None:
    if isinstance(value, (str, bytes)) or not (value is None or hasattr(value, "__iter__")):
        raise TypeError(f"latent: expected numbers or None, got {value!r}")
    numbers = [] if value is None else [_arguments.number(one, "latent") for one in value]
    if value is not None and not numbers:
        raise ValueError("latent: expected numbers or None, got none of them")
    call(lib.anthronet_request_set_latent, handle, (c_double * len(numbers))(*numbers), len(numbers))


def _set_fill(handle: Handle, value: str) -> None:
    call(lib.anthronet_request_set_fill, handle, _arguments.choice(_FILLS, value, "fill"))


def _set_nearest(handle: Handle, value: bool) -> None:
    call(lib.anthronet_request_set_nearest, handle, _arguments.flag(value, "nearest"))


def _set_measure(handle: Handle, name: str, metres: Optional[float]) -> None:
    encoded = _arguments.text(name, "measure")
    if metres is not None:
        call(lib.anthronet_request_set_measure, handle, encoded, len(encoded), _arguments.number(metres, name))
        return
    for side in _sides(name) or [name]:
        encoded = side.encode()
        measure = number_of(lib.anthronet_measure_index, encoded, len(encoded))
        call(lib.anthronet_request_unset_measure, handle, measure)


def _set_measures(handle: Handle, measures: Dict[str, Optional[float]]) -> None:
    count = len(MEASURES)
    call(lib.anthronet_request_set_measures, handle, (c_double * count)(), (c_uint8 * count)(), count)
    for name in sorted(measures, key=MEASURES.__contains__):
        _set_measure(handle, name, measures[name])
