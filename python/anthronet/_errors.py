"""What the library raises: one class per group of its codes, all of them `Error`."""

from __future__ import annotations

from . import _native


class Error(Exception):
    """What went wrong in the library.

    Attributes:
        code: one of the `ANTHRONET_ERROR_…` of the C interface.
        message: a sentence that names what was wrong and what was expected; cut at 511 bytes.
    """

    def __init__(self, code: int, message: str) -> None:
        super().__init__(code, message)
        self.code = code
        self.message = message

    def __str__(self) -> str:
        return self.message


class ArgumentError(Error, ValueError):
    """An argument does not fit: a size, an unknown value, an index beyond the last, text that is not UTF-8."""


class RequestError(Error, ValueError):
    """A field of a request is unknown, not finite, or out of range."""


class InfeasibleError(Error, ValueError):
    """The measures of a request cannot belong to one person; the message says which contradict each other."""


class ModelError(Error):
    """A model file is damaged or of another version."""


class FileError(Error):
    """A file is not what it should be."""


class IoError(Error):
    """The operating system refused to read or write."""


class InvalidError(Error, ValueError):
    """Data contradicts itself: counts that differ, numbers that are not finite, a pose of another skeleton."""


class BusyError(Error):
    """The job is still running."""


class CancelledError(Error):
    """The job was cancelled before this was made."""


class TakenError(Error):
    """The body was taken before."""


class PanicError(Error):
    """A defect of the library, caught; please report it."""


_CLASSES = {
    _native.ERROR_POINTER: ArgumentError,
    _native.ERROR_SIZE: ArgumentError,
    _native.ERROR_ENUM: ArgumentError,
    _native.ERROR_INDEX: ArgumentError,
    _native.ERROR_TEXT: ArgumentError,
    _native.ERROR_REQUEST: RequestError,
    _native.ERROR_INFEASIBLE: InfeasibleError,
    _native.ERROR_MODEL: ModelError,
    _native.ERROR_FILE: FileError,
    _native.ERROR_IO: IoError,
    _native.ERROR_INVALID: InvalidError,
    _native.ERROR_BUSY: BusyError,
    _native.ERROR_CANCELLED: CancelledError,
    _native.ERROR_TAKEN: TakenError,
    _native.ERROR_PANIC: PanicError,
}


def error_of(code: int, message: str) -> Error:
    """The exception of a code; `Error` itself of one that is younger than this package."""
    return _CLASSES.get(code, Error)(code, message)
