"""The examples of the Python package's README, run one after the other, as a reader would."""

import contextlib
import io
from pathlib import Path

import pytest
from readme import README, examples

EXAMPLES = examples()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("readme")


@pytest.fixture
def reader(folder, monkeypatch):
    """The reader's folder is where the examples run."""
    monkeypatch.chdir(folder)


@pytest.fixture(scope="module")
def names():
    """What the examples so far have defined."""
    return {"__name__": "readme"}


def test_there_are_examples():
    """the README has examples"""
    assert len(EXAMPLES) >= 10


@pytest.mark.parametrize("line, code", EXAMPLES, ids=[f"line {line}, `{code.strip().splitlines()[0]}`" for line, code in EXAMPLES])
def test_example(reader, names, line, code):
    """example"""
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile("\n" * (line - 1) + code, str(README), "exec"), names)  # noqa: S102


@pytest.mark.parametrize("file", ["person.glb", "him.vrm", "him.usdz", "walking.glb"])
def test_files(reader, file):
    """the examples wrote a file"""
    assert Path(file).stat().st_size > 100_000
