"""The package as a whole: versions, what it imports, errors, the log, documentation."""

import ctypes
import inspect
import pickle
import re
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version

import anthronet
import numpy as np
import pytest
from anthronet import _errors, _library, _native
from support import HEADER, ROOT


def test_versions():
    """versions of package, library, wheel and workspace are one"""
    workspace = re.search(r'^version = "([^"]+)"', (ROOT / "Cargo.toml").read_text("utf-8"), re.MULTILINE).group(1)
    assert anthronet.__version__ == workspace, (anthronet.__version__, workspace)
    try:
        assert version("anthronet") == workspace
    except PackageNotFoundError:
        pytest.skip("the package is not installed")
    defined = re.search(r"ANTHRONET_ABI_VERSION (\d+)", HEADER.read_text("utf-8")).group(1)
    assert anthronet.abi_version() == int(defined) == _native.ABI_VERSION


def test_imports():
    """it imports the standard library and numpy, and nothing else that is installed"""
    code = ("import sys\nbefore = set(sys.modules)\nimport anthronet\n"
            "new = {name: sys.modules[name] for name in set(sys.modules) - before}\n"
            "print(*[name for name, m in new.items() if 'site-packages' in (getattr(m, '__file__', None) or '')])")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {name.partition(".")[0] for name in done.stdout.split()} <= {"anthronet", "numpy"}, done.stdout


@pytest.mark.parametrize("name", [name for name in dir(_native) if name.startswith("ERROR_")])
def test_errors(name):
    """every code has its class"""
    error = _errors.error_of(getattr(_native, name), "why")
    assert isinstance(error, anthronet.Error) and str(error) == error.message == "why"
    assert (type(error) is anthronet.Error) == (name == "ERROR_OTHER")
    assert pickle.loads(pickle.dumps(error)).code == error.code


def test_codes_of_the_future():
    """codes of the future are errors too"""
    assert type(_errors.error_of(12345, "new")) is anthronet.Error


def test_arguments_in_c(woman, heavy):
    """the C interface itself refuses what the package never passes"""
    error, out = _native.Error(), ctypes.c_void_p(5)
    request = _library.lib.anthronet_request_new
    assert request(None, ctypes.byref(error)) == _native.ERROR_POINTER == error.code and b"NULL" in error.message
    assert _library.lib.anthronet_generate(None, None, ctypes.byref(out), None) == _native.ERROR_POINTER and out.value == 5
    # In place, which leaves no views valid: the package makes a new mesh instead.
    mesh = woman.mesh(lod=3)
    assert _library.lib.anthronet_mesh_update(mesh._open, heavy._open, None) == _native.OK
    assert np.array_equal(mesh[0].positions, heavy.mesh(lod=3)[0].positions)


def test_log():
    """the log callback is set and taken away"""
    anthronet.set_log_callback(print)
    anthronet.set_log_callback(None)


def test_documentation():
    """everything public is documented and typed"""
    for name in anthronet.__all__:
        thing = getattr(anthronet, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert inspect.getdoc(thing), name
        members = vars(thing).items() if inspect.isclass(thing) and thing.__module__.startswith("anthronet") else ()
        for member, value in members:
            function = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
            if member.startswith("_") or not inspect.isfunction(function):
                continue
            assert function.__doc__, f"{name}.{member} has no documentation"
            assert "return" in function.__annotations__, f"{name}.{member} has no types"
