"""The wheel of the Python package, looked at as a file: what auditwheel and pip's own rules say, and what is in it.

    python python_wheel.py WHEEL
"""

import base64
import csv
import hashlib
import io
import os
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from glb import Cases

ROOT = Path(__file__).resolve().parent.parent


def main(wheel):
    cases, wheel = Cases(), Path(wheel)
    version = re.search(r'^version = "([^"]+)"', (ROOT / "Cargo.toml").read_text("utf-8"), re.MULTILINE).group(1)
    name = rf"anthronet-{re.escape(version)}-py3-none-\w+\.whl"
    cases.case("the wheel is for every Python and this platform", re.fullmatch(name, wheel.name), wheel.name)
    with zipfile.ZipFile(wheel) as file:
        content = {name: file.read(name) for name in file.namelist()}
    cases.case("no file of the wheel comes twice", len(content) == len(file.namelist()))
    info = f"anthronet-{version}.dist-info"
    rows = {row[0]: row for row in csv.reader(io.StringIO(content[f"{info}/RECORD"].decode())) if row}
    wrong = sorted(set(rows) ^ set(content))
    for path, data in content.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        if not path.endswith("/RECORD") and rows[path][1:] != [f"sha256={digest}", str(len(data))]:
            wrong.append(path)
    cases.case("RECORD lists every file with its hash and size", not wrong, wrong)
    sources = {f"anthronet/{path.name}" for path in (ROOT / "python" / "anthronet").glob("*.py")} | {"anthronet/py.typed"}
    libraries = [path for path in content if path.startswith("anthronet/") and path not in sources]
    cases.case("the package is its sources and one library", sources <= set(content) and len(libraries) == 1, libraries)
    metadata = content[f"{info}/METADATA"].decode()
    head = metadata.split("\n\n", 1)[0].splitlines()
    wanted = {f"Version: {version}", "Requires-Python: >=3.9", "Requires-Dist: numpy>=1.21"}
    cases.case("numpy is needed and nothing else", wanted <= set(head) and sum("Requires-Dist" in line for line in head) == 1, head)
    cases.case("the wheel's text is the README", metadata.endswith((ROOT / "python" / "README.md").read_text("utf-8")))
    licences = {f"{info}/licenses/{line.split(': ')[1]}" for line in head if line.startswith("License-File")}
    cases.case(f"{len(licences)} licences are inside", licences and licences <= set(content), licences)
    size = len(content[libraries[0]]) / 1e6
    cases.case(f"the library has {size:.1f} MB, at most 40", size < 40)

    sys.path.insert(0, str(ROOT / "python"))
    import build_backend

    # The wheel at hand was made without: cargo built the library.
    os.environ["ANTHRONET_LIBRARY"] = str(wheel)
    cases.case("ANTHRONET_LIBRARY names the file that goes into a wheel", build_backend.library() == wheel)
    os.environ["ANTHRONET_LIBRARY"] = "no such library"
    try:
        build_backend.library()
        said = "nothing"
    except SystemExit as error:
        said = str(error)
    cases.case("and is refused by name where there is none", "ANTHRONET_LIBRARY" in said and "no such library" in said, said)

    if not sys.platform.startswith("linux"):
        print("skipped auditwheel: it reads wheels for Linux alone")
        cases.exit()
    done = subprocess.run([sys.executable, "-m", "auditwheel", "show", wheel], capture_output=True, text=True, check=False)
    tag = wheel.stem.split("-")[-1]
    cases.case(f"auditwheel says {tag}", f'platform tag: "{tag}"' in " ".join(done.stdout.split()), done.stdout + done.stderr)
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "library.so"
        library.write_bytes(content[libraries[0]])
        sections = subprocess.run(["readelf", "--sections", "--wide", library], capture_output=True, text=True, check=False)
        cases.case("the library is stripped", sections.returncode == 0 and ".symtab" not in sections.stdout, sections.stderr)
    cases.exit()


if __name__ == "__main__":
    main(sys.argv[1])
