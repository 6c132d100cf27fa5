"""The shared library: finding it, calling it, and keeping what it hands out.

Calls release the interpreter's lock. A handle is a reference-counted object of Python: calls that are under way and
arrays that look into the library's memory hold it, so that nothing is freed under them.
"""

from __future__ import annotations

import atexit
import ctypes
import json
import os
import sys
import threading
import weakref
from pathlib import Path
from typing import Any, Callable, Optional, TypeVar

from . import _native
from ._errors import error_of

#: Names another file than the one beside this module.
OVERRIDE = "ANTHRONET_LIBRARY"


def library_name() -> str:
    """File name of the shared library on this system."""
    if sys.platform == "win32":
        return "anthronet.dll"
    return "libanthronet.dylib" if sys.platform == "darwin" else "libanthronet.so"


def _load() -> ctypes.CDLL:
    override = os.environ.get(OVERRIDE)
    path = Path(override) if override else Path(__file__).resolve().parent / library_name()
    asked = f"{OVERRIDE} names it" if override else f"set {OVERRIDE} to use another"
    if not path.is_file():
        raise ImportError(f"anthronet: expected its library at {path} ({asked}); there is no such file", path=str(path))
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise ImportError(
            f"anthronet: {path} ({asked}) does not load here, it may be for another system: {error}", path=str(path)
        ) from error
    # This function alone is the same in all versions: it has to be asked before the others are looked at.
    try:
        version = library.anthronet_abi_version()
    except AttributeError:
        raise ImportError(f"anthronet: {path} ({asked}) is not libanthronet", path=str(path)) from None
    if version != _native.ABI_VERSION:
        raise ImportError(
            f"anthronet: {path} ({asked}) has version {version} of the C interface, expected {_native.ABI_VERSION}:"
            " package and library must be of one release",
            path=str(path),
        )
    for name, (result, arguments) in _native.FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise ImportError(
                f"anthronet: {path} ({asked}) lacks {name}: package and library must be of one release", path=str(path)
            ) from None
        function.restype, function.argtypes = result, arguments
    return library


lib = _load()


class _PerThread(threading.local):
    """What the library writes in, one per thread, as calls run side by side: errors, and memory to work in."""

    def __init__(self) -> None:
        self.error = _native.Error()
        self.where = ctypes.byref(self.error)
        self.hears = False
        self.context: Optional[Handle] = None


_per_thread = _PerThread()


def call(function: Any, *arguments: Any) -> None:
    """Calls an entry that returns a status and takes an error last; raises what it says."""
    mine = _per_thread
    if mine.hears:
        # It would wait for the message that it is hearing.
        raise RuntimeError("a log callback must not call the library: collect what it hears")
    status = function(*arguments, mine.where)
    if status != _native.OK:
        raise error_of(status, mine.error.message.decode("utf-8", "replace"))


class Handle(ctypes.c_void_p):
    """Something of the library's, freed with the last reference to it."""

    def kept(self, free: Any, at_exit: bool = False) -> Handle:
        """To be said once, as soon as the library has filled it in."""
        # When the process ends, its memory goes as a whole; only what still runs has to be stopped.
        weakref.finalize(self, free, self.value).atexit = at_exit
        return self


def context() -> Handle:
    """The memory that this thread samples and skins in; the library must not use it for two calls at once."""
    mine = _per_thread
    if mine.context is None:
        mine.context = new_handle(lib.anthronet_context_new, lib.anthronet_context_free)
    return mine.context


def new_handle(make: Any, free: Any, *arguments: Any) -> Handle:
    """Calls an entry whose last result is a handle."""
    handle = Handle()
    call(make, *arguments, ctypes.byref(handle))
    return handle.kept(free)


#: Whatever is held by `with`.
Held = TypeVar("Held", bound="Owner")


class Owner:
    """What holds a handle until it is closed: by `close`, by the end of `with`, or with its last reference."""

    _handle: Optional[Handle]

    def __init__(self) -> None:
        raise TypeError(f"{type(self).__name__}: is not made directly, see its documentation")

    @property
    def _open(self) -> Handle:
        handle = self._handle
        if handle is None:
            raise ValueError(f"{type(self).__name__}: is closed")
        return handle

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._handle is None

    def close(self) -> None:
        """Frees it, as soon as calls under way and arrays that look into it are gone. Closing twice does nothing."""
        self._handle = None

    def __enter__(self: Held) -> Held:
        if self._handle is None:
            raise ValueError(f"{type(self).__name__}: is closed")
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def text(value: _native.Text) -> str:
    """Text of the library's."""
    return ctypes.string_at(value.data, value.length).decode("utf-8") if value.length else ""


def described(kind: Any, **fields: Any) -> Any:
    """A descriptor with its size said."""
    return kind(struct_size=ctypes.sizeof(kind), **fields)


def text_of(function: Any, *arguments: Any) -> str:
    """Calls an entry whose result is a text."""
    value = _native.Text()
    call(function, *arguments, ctypes.byref(value))
    return text(value)


def number_of(function: Any, *arguments: Any) -> int:
    """Calls an entry whose result is a 32-bit number."""
    value = ctypes.c_uint32()
    call(function, *arguments, ctypes.byref(value))
    return value.value


def bytes_of(function: Any, *arguments: Any) -> bytes:
    """Calls an entry whose result is bytes, and takes them over."""
    return take_bytes(new_handle(function, lib.anthronet_bytes_free, *arguments))


def take_bytes(handle: Handle) -> bytes:
    """What a handle of bytes holds."""
    data, length = ctypes.c_void_p(), ctypes.c_uint64()
    call(lib.anthronet_bytes_data, handle, ctypes.byref(data), ctypes.byref(length))
    if not data.value:
        return b""
    # `string_at` counts in a C int.
    return bytes(memoryview((ctypes.c_char * length.value).from_address(data.value)))


def json_of(function: Any, *arguments: Any) -> Any:
    """Calls an entry whose result is JSON."""
    return json.loads(bytes_of(function, *arguments))


def abi_version() -> int:
    """Version of the C interface that library and package share."""
    return int(lib.anthronet_abi_version())


_log_lock = threading.Lock()
_log_callback: Any = None


def set_log_callback(callback: Optional[Callable[[int, str], None]]) -> None:
    """Sets who hears the library's messages: warnings of reports, joints that drove nothing, defects.

    Args:
        callback: called with a level (0 information, 1 warning, 2 error) and a message, from any thread, one call at a
            time; None for nobody, which is the default. It must not call this package: collect what it hears. What it
            raises is printed and goes no further.

    When this returns, the former callback is not running and will not be called again.

    Raises:
        TypeError: `callback` cannot be called.
    """
    global _log_callback
    if callback is not None and not callable(callback):
        raise TypeError(f"callback: expected a function or None, got {type(callback).__name__}")

    with _log_lock:
        wrapped = _native.LogCallback() if callback is None else _native.LogCallback(_hearing(callback))
        call(lib.anthronet_set_log_callback, wrapped, None)
        # The former one may go only now.
        _log_callback = wrapped


def _hearing(callback: Callable[[int, str], None]) -> Callable[[int, int, int, object], None]:
    def hear(level: int, data: int, length: int, _user: object) -> None:
        _per_thread.hears = True
        try:
            callback(level, ctypes.string_at(data, length).decode("utf-8", "replace"))
        finally:
            _per_thread.hears = False

    return hear


# A thread of the library must not come into an interpreter that is gone.
atexit.register(set_log_callback, None)
