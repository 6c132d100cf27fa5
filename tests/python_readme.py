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


def main(folder):
    cases, names = Cases(), {"__name__": "readme"}
    text = README.read_text("utf-8")
    folder = Path(folder) / "readme"
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    examples = list(re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    cases.case(f"the README has {len(examples)} examples", len(examples) >= 10)
    for example in examples:
        line = text[: example.start()].count("\n") + 2
        name = f"example at line {line}, `{example[1].strip().splitlines()[0]}`"
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile("\n" * (line - 1) + example[1], str(README), "exec"), names)  # noqa: S102
        except Exception as error:
            cases.case(name, False, f"{type(error).__name__}: {error}")
        else:
            cases.case(name, True)
    for file in ("person.glb", "him.vrm", "him.usdz", "walking.glb"):
        cases.case(f"it wrote {file}", Path(file).is_file() and Path(file).stat().st_size > 100_000)
    cases.exit()


if __name__ == "__main__":
    main(sys.argv[1])
