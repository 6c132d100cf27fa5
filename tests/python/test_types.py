"""The type hints of the Python package: mypy --strict on the package and on the README's examples."""

import os
import re
import subprocess
import sys

import pytest
from readme import examples
from support import ROOT

PACKAGE = ROOT / "python"
WRONG = """import anthronet
anthronet.generate(sex=1)
body: int = anthronet.generate()
anthronet.generate().mesh().parts[0].positions.shape = "round"
"""


@pytest.fixture(scope="module")
def complaints(tmp_path_factory):
    """A function: what mypy says of a file or folder, a line each."""
    cache = tmp_path_factory.mktemp("mypy")

    def of(target):
        arguments = ["--strict", "--no-error-summary", "--cache-dir", str(cache), str(target)]
        done = subprocess.run([sys.executable, "-m", "mypy", *arguments], cwd=PACKAGE, capture_output=True, text=True,
                              check=False, env={**os.environ, "MYPYPATH": str(PACKAGE)})
        assert done.returncode <= 1 and not done.stderr, done.stderr or done.stdout
        return [line for line in done.stdout.splitlines() if ": error: " in line]

    return of


def test_package(complaints):
    """mypy --strict: the package"""
    found = complaints(PACKAGE / "anthronet")
    assert not found, found[:3]


def test_readme(complaints, tmp_path):
    """mypy --strict: the README's examples"""
    readme = tmp_path / "readme_examples.py"
    readme.write_text("\n".join(code for _, code in examples()), encoding="utf-8")
    found = complaints(readme)
    assert not found, found[:3]


def test_mypy_finds(complaints, tmp_path):
    """mypy finds what is wrong: it sees the hints at all"""
    wrong = tmp_path / "wrong.py"
    wrong.write_text(WRONG, encoding="utf-8")
    lines = {int(re.search(r"wrong\.py:(\d+):", line)[1]) for line in complaints(wrong)}
    assert lines == {2, 3, 4}
