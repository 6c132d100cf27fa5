"""Checks of arguments, before anything reaches the library: errors name the argument and what was expected."""

from __future__ import annotations

import operator
import os
from typing import TYPE_CHECKING, Any, Mapping, Optional, Tuple, Type, TypeVar, Union

import numpy as np

from . import _native

T = TypeVar("T")

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]
    Doubles = NDArray[np.float64]
    Floats = NDArray[np.float32]
    Indices = NDArray[np.uint32]
    Places = NDArray[np.uint16]
else:
    # What an array holds is for checkers of types alone.
    Array = Doubles = Floats = Indices = Places = np.ndarray

#: What names a file.
Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]

SPACES = {"gltf": _native.SPACE_GLTF, "blender": _native.SPACE_BLENDER, "unity": _native.SPACE_UNITY}
NAMES = {
    "native": _native.NAMES_NATIVE,
    "unity": _native.NAMES_UNITY,
    "mixamo": _native.NAMES_MIXAMO,
    "vrm": _native.NAMES_VRM,
    "blender": _native.NAMES_BLENDER,
}
RELATIVE = {"parent": _native.RELATIVE_TO_PARENT, "model": _native.RELATIVE_TO_MODEL}


def choice(table: Mapping[Any, int], value: Any, name: str) -> int:
    """The number that one of a few names stands for."""
    try:
        return table[value]
    except (KeyError, TypeError):
        known = ", ".join(map(repr, table)) or "none"
        kind = ValueError if isinstance(value, (str, type(None))) else TypeError
        raise kind(f"{name}: expected one of {known}, got {value!r}") from None


def number(value: Any, name: str) -> float:
    """A number, as a float. Whether it is finite and in range is the library's to say."""
    if not isinstance(value, (bool, np.bool_, str, bytes)):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
    raise TypeError(f"{name}: expected a number, got {value!r}")


def positive(value: Any, name: str) -> float:
    """A number above 0."""
    found = number(value, name)
    if not found > 0:
        raise ValueError(f"{name}: expected a positive number, got {value!r}")
    return found


def whole(value: Any, name: str, bits: int = 32) -> int:
    """A number without a fraction that fits into so many bits, without sign."""
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: expected a whole number, got {value!r}")
    try:
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: expected a whole number, got {value!r}") from None
    if not 0 <= found < 1 << bits:
        raise ValueError(f"{name}: expected 0 to {(1 << bits) - 1}, got {found}")
    return found


def place(value: Any, name: str) -> int:
    """The place of a parent: −1 for none."""
    return -1 if not isinstance(value, str) and value == -1 else whole(value, name, 31)


def flag(value: Any, name: str) -> int:
    """True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: expected True or False, got {value!r}")
    return int(value)


def text(value: Any, name: str) -> bytes:
    """Text, as UTF-8."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected text, got {type(value).__name__}")
    try:
        return value.encode("utf-8")
    except UnicodeEncodeError as error:
        raise ValueError(f"{name}: {value!r} cannot be said in UTF-8") from error


def path(value: Any, name: str = "path") -> bytes:
    """The path of a file, as UTF-8."""
    try:
        return text(os.fsdecode(value), name)
    except TypeError:
        raise TypeError(f"{name}: expected a path, got {type(value).__name__}") from None


def data(value: Any, name: str) -> Array:
    """The bytes of anything that has some, not copied."""
    try:
        return np.frombuffer(value, np.uint8) if len(value) else np.empty(0, np.uint8)
    except (TypeError, ValueError, BufferError) as error:
        raise TypeError(f"{name}: expected bytes, got {type(value).__name__}: {error}") from None


def instance(value: Any, kind: Type[T], name: str) -> T:
    """Something of a class of this package."""
    if not isinstance(value, kind):
        raise TypeError(f"{name}: expected a {kind.__name__}, got {type(value).__name__}")
    return value


def floats(value: Any, name: str, shape: Tuple[Optional[int], ...]) -> Array:
    """A packed array of 32-bit floats; copied only where it is something else. None in `shape` is any number."""
    try:
        given = np.asarray(value)
    except (TypeError, ValueError):
        given = np.empty(0, object)
    if given.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected an array of numbers, got {type(value).__name__}")
    array = np.ascontiguousarray(given, np.float32)
    shaped(array, name, shape)
    return array if array.flags.aligned else array.copy()


def filled(out: Any, name: str, shape: Tuple[int, ...]) -> Array:
    """Rows of 32-bit floats that are written: any stride from row to row, each row packed."""
    array = instance(out, np.ndarray, name)
    if array.dtype != np.float32 or not array.dtype.isnative:
        raise TypeError(f"{name}: expected an array of float32, got {array.dtype}")
    shaped(array, name, shape)
    if not array.flags.writeable:
        raise ValueError(f"{name}: expected an array that can be written, got one that is read-only")
    if not packed_rows(array):
        raise ValueError(f"{name}: expected rows that are packed and do not overlap, got strides {array.strides}")
    return array


def packed_rows(array: Array) -> bool:
    """Whether each row is packed and the next lies behind it."""
    width = array.itemsize * (array.shape[1] if array.ndim == 2 else 1)
    packed = array.ndim == 1 or array.strides[1] == array.itemsize or array.shape[1] == 1
    return packed and (len(array) < 2 or array.strides[0] >= width)


def extent(array: Array) -> int:
    """Bytes from the first row's first to the last row's last."""
    width = array.itemsize * (array.shape[1] if array.ndim == 2 else 1)
    return (len(array) - 1) * array.strides[0] + width if len(array) else 0


def shaped(array: Array, name: str, shape: Tuple[Optional[int], ...]) -> None:
    """Refuses an array of another shape; None in `shape` is any number."""
    if array.ndim != len(shape) or any(want not in (None, got) for want, got in zip(shape, array.shape)):
        expected = ", ".join("n" if want is None else str(want) for want in shape)
        raise ValueError(f"{name}: expected an array of shape ({expected}), got {array.shape}")
