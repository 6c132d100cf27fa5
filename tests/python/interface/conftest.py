"""Notes which functions of the C interface the package calls: for that it has to be here before the package is imported."""

import ctypes

import pytest

CALLED = set()


class Counting(ctypes.CDLL):
    """A library that notes which of its functions are called."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)

        class Function(self._FuncPtr):
            _flags_, _restype_ = self._FuncPtr._flags_, self._FuncPtr._restype_

            def __call__(self, *arguments):
                CALLED.add(self.__name__)
                return super().__call__(*arguments)

        self._FuncPtr = Function


ctypes.CDLL, plain = Counting, ctypes.CDLL
import anthronet  # noqa: E402, F401

ctypes.CDLL = plain


@pytest.fixture(scope="session")
def called():
    """The names of the functions that were called so far."""
    return CALLED
