"""The wheel of the Python package, looked at as a file: what auditwheel and pip's own rules say, and what is in it."""

import base64
import csv
import hashlib
import io
import re
import subprocess
import sys
import zipfile

import pytest
from support import ROOT

VERSION = re.search(r'^version = "([^"]+)"', (ROOT / "Cargo.toml").read_text("utf-8"), re.MULTILINE).group(1)
INFO = f"anthronet-{VERSION}.dist-info"


@pytest.fixture(scope="module")
def content(wheel):
    """The files of the wheel with what is in them."""
    with zipfile.ZipFile(wheel) as file:
        return {name: file.read(name) for name in file.namelist()}


@pytest.fixture(scope="module")
def metadata(content):
    return content[f"{INFO}/METADATA"].decode()


@pytest.fixture(scope="module")
def head(metadata):
    """The lines of the metadata before its text."""
    return metadata.split("\n\n", 1)[0].splitlines()


@pytest.fixture(scope="module")
def libraries(content):
    """The files of the package that are none of its sources."""
    return [path for path in content if path.startswith("anthronet/") and path not in sources()]


def sources():
    return {f"anthronet/{path.name}" for path in (ROOT / "python" / "anthronet").glob("*.py")} | {"anthronet/py.typed"}


def test_name(wheel):
    """the wheel is for every Python and this platform"""
    assert re.fullmatch(rf"anthronet-{re.escape(VERSION)}-py3-none-\w+\.whl", wheel.name), wheel.name


def test_no_file_twice(wheel):
    """no file of the wheel comes twice"""
    with zipfile.ZipFile(wheel) as file:
        names = file.namelist()
    assert len(set(names)) == len(names)


def test_record(content):
    """RECORD lists every file with its hash and size"""
    rows = {row[0]: row for row in csv.reader(io.StringIO(content[f"{INFO}/RECORD"].decode())) if row}
    wrong = sorted(set(rows) ^ set(content))
    for path, data in content.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        if not path.endswith("/RECORD") and rows[path][1:] != [f"sha256={digest}", str(len(data))]:
            wrong.append(path)
    assert not wrong, wrong


def test_sources_and_one_library(content, libraries):
    """the package is its sources and one library"""
    assert sources() <= set(content) and len(libraries) == 1, libraries


def test_needs(head):
    """numpy is needed and nothing else"""
    wanted = {f"Version: {VERSION}", "Requires-Python: >=3.9", "Requires-Dist: numpy>=1.21"}
    assert wanted <= set(head) and sum("Requires-Dist" in line for line in head) == 1, head


def test_text(metadata):
    """the wheel's text is the README"""
    assert metadata.endswith((ROOT / "python" / "README.md").read_text("utf-8"))


def test_licences(content, head):
    """the licences are inside"""
    licences = {f"{INFO}/licenses/{line.split(': ')[1]}" for line in head if line.startswith("License-File")}
    assert licences and licences <= set(content), licences


def test_size(content, libraries):
    """the library has at most 40 MB"""
    assert len(content[libraries[0]]) < 40e6, f"{len(content[libraries[0]]) / 1e6:.1f} MB"


@pytest.fixture
def build_backend(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "python"))
    import build_backend

    return build_backend


def test_library_by_name(build_backend, wheel, monkeypatch):
    """ANTHRONET_LIBRARY names the file that goes into a wheel"""
    # The wheel at hand was made without: cargo built the library.
    monkeypatch.setenv("ANTHRONET_LIBRARY", str(wheel))
    assert build_backend.library() == wheel


def test_library_that_is_none(build_backend, monkeypatch):
    """and is refused by name where there is none"""
    monkeypatch.setenv("ANTHRONET_LIBRARY", "no such library")
    with pytest.raises(SystemExit) as refused:
        build_backend.library()
    said = str(refused.value)
    assert "ANTHRONET_LIBRARY" in said and "no such library" in said, said


linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="auditwheel reads wheels for Linux alone")


@linux
def test_auditwheel(wheel):
    """auditwheel says what the wheel's name says"""
    done = subprocess.run([sys.executable, "-m", "auditwheel", "show", wheel], capture_output=True, text=True, check=False)
    tag = wheel.stem.split("-")[-1]
    assert f'platform tag: "{tag}"' in " ".join(done.stdout.split()), done.stdout + done.stderr


@linux
def test_stripped(content, libraries, tmp_path):
    """the library is stripped"""
    library = tmp_path / "library.so"
    library.write_bytes(content[libraries[0]])
    sections = subprocess.run(["readelf", "--sections", "--wide", library], capture_output=True, text=True, check=False)
    assert sections.returncode == 0 and ".symtab" not in sections.stdout, sections.stderr
