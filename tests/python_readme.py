"""The examples of the Python package's README, run one after the other, as a reader would.

    python python_readme.py FOLDER
"""

import contextlib
import io
import os
import re
import sys
from pathlib import Path

from glb import Cases

README = Path(__file__).resolve().parent.parent / "python" / "README.md"


def examples():
    """The examples in their order: the line that each begins at, and its code."""
    text = README.read_text("utf-8")
    found = re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [(text[: example.start()].count("\n") + 2, example[1]) for example in found]


def main(folder):
    cases, names = Cases(), {"__name__": "readme"}
    folder = Path(folder) / "readme"
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    found = examples()
    cases.case(f"the README has {len(found)} examples", len(found) >= 10)
    for line, code in found:
        name = f"example at line {line}, `{code.strip().splitlines()[0]}`"
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile("\n" * (line - 1) + code, str(README), "exec"), names)  # noqa: S102
        except Exception as error:
            cases.case(name, False, f"{type(error).__name__}: {error}")
        else:
            cases.case(name, True)
    for file in ("person.glb", "him.vrm", "him.usdz", "walking.glb"):
        cases.case(f"it wrote {file}", Path(file).is_file() and Path(file).stat().st_size > 100_000)
    cases.exit()


if __name__ == "__main__":
    main(sys.argv[1])
