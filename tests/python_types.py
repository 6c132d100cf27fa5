"""The type hints of the Python package: mypy --strict on the package and on the README's examples.

    python python_types.py FOLDER
"""

import os
import re
import subprocess
import sys
from pathlib import Path

from glb import Cases
from python_readme import examples

PACKAGE = Path(__file__).resolve().parent.parent / "python"
WRONG = """import anthronet
anthronet.generate(sex=1)
body: int = anthronet.generate()
anthronet.generate().mesh().parts[0].positions.shape = "round"
"""


def complaints(folder, target):
    """What mypy says of a file or folder, a line each."""
    arguments = ["--strict", "--no-error-summary", "--cache-dir", str(folder / "mypy"), str(target)]
    done = subprocess.run([sys.executable, "-m", "mypy", *arguments], cwd=PACKAGE, capture_output=True, text=True,
                          check=False, env={**os.environ, "MYPYPATH": str(PACKAGE)})
    if done.returncode > 1 or done.stderr:
        raise SystemExit(done.stderr or done.stdout)
    return [line for line in done.stdout.splitlines() if ": error: " in line]


def main(folder):
    cases, folder = Cases(), Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    found = complaints(folder, PACKAGE / "anthronet")
    cases.case("mypy --strict: the package", not found, found[:3])
    readme = folder / "readme_examples.py"
    readme.write_text("\n".join(code for _, code in examples()), encoding="utf-8")
    found = complaints(folder, readme)
    cases.case("mypy --strict: the README's examples", not found, found[:3])
    # That it sees the hints at all.
    wrong = folder / "wrong.py"
    wrong.write_text(WRONG, encoding="utf-8")
    lines = {int(re.search(r"wrong\.py:(\d+):", line)[1]) for line in complaints(folder, wrong)}
    cases.case("mypy finds what is wrong", lines == {2, 3, 4}, sorted(lines))
    cases.exit()


if __name__ == "__main__":
    main(sys.argv[1])
