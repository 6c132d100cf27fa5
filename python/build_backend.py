"""Makes the wheel of `anthronet`: the package, the library, the licences. A build backend after PEP 517.

The library is the file that the environment variable ANTHRONET_LIBRARY names, else cargo builds it in the source tree
that this file is part of. The same files give the same wheel, byte by byte.
"""

import base64
import hashlib
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
# rustc's standard library and libc of the builder: the oldest glibc that the library runs with.
LINUX = "manylinux_2_34"
LIBRARIES = {"linux": "libanthronet.so", "darwin": "libanthronet.dylib", "win32": "anthronet.dll"}
LICENCES = ["LICENSE-APACHE", "LICENSE-MIT", "THIRD_PARTY.md", "model/LICENSE"]

METADATA = """\
Metadata-Version: 2.4
Name: anthronet
Version: {version}
Summary: Type tape measures, get a person: rigged, skinned and animated
Author: The AnthroNet authors
License-Expression: (MIT OR Apache-2.0) AND CC0-1.0
{licences}
Keywords: human,body,anthropometry,character,mesh,rig,animation,gltf,usd
Classifier: Intended Audience :: Developers
Classifier: Operating System :: {system}
Classifier: Programming Language :: Python :: 3
Classifier: Programming Language :: Rust
Classifier: Topic :: Multimedia :: Graphics :: 3D Modeling
Classifier: Typing :: Typed
Requires-Python: >=3.9
Requires-Dist: numpy>=1.21
Description-Content-Type: text/markdown

{readme}"""

SYSTEMS = {"linux": "POSIX :: Linux", "darwin": "MacOS", "win32": "Microsoft :: Windows"}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel into a folder and returns its name."""
    version = workspace_version()
    tag = f"py3-none-{platform_tag()}"
    info = f"anthronet-{version}.dist-info"
    files = {f"anthronet/{path.name}": path.read_bytes() for path in (HERE / "anthronet").iterdir() if shipped(path)}
    files[f"anthronet/{LIBRARIES[sys.platform]}"] = stripped(library())
    licences = {name: (ROOT / name).read_bytes() for name in LICENCES}
    files.update({f"{info}/licenses/{name}": content for name, content in licences.items()})
    files[f"{info}/METADATA"] = METADATA.format(
        version=version,
        licences="\n".join(f"License-File: {name}" for name in licences),
        system=SYSTEMS[sys.platform],
        readme=(HERE / "README.md").read_text("utf-8"),
    ).encode()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: anthronet {version}\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    )
    record = f"{info}/RECORD"
    files[record] = "".join(row(name, files[name]) for name in sorted(files)).encode() + f"{record},,\n".encode()

    name = f"anthronet-{version}-{tag}.whl"
    Path(wheel_directory).mkdir(parents=True, exist_ok=True)
    partial = Path(wheel_directory) / f"{name}.partial"
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as wheel:
        # The description of a wheel stands at its end.
        for file in sorted(files, key=lambda file: (file.startswith(info), file)):
            entry = zipfile.ZipInfo(file, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, whose permissions follow.
            entry.external_attr = (0o100755 if file.endswith(LIBRARIES[sys.platform]) else 0o100644) << 16
            wheel.writestr(entry, files[file])
    os.replace(partial, Path(wheel_directory) / name)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Refuses: the library is made of more than lies in this folder."""
    raise SystemExit("anthronet: its sources are the whole source tree; build a wheel in there")


def workspace_version():
    """The version that all crates have."""
    manifest = (ROOT / "Cargo.toml").read_text("utf-8")
    return re.search(r'^\[workspace\.package\]\nversion = "([^"]+)"', manifest, re.MULTILINE).group(1)


def platform_tag():
    """The platform part of the wheel's tag."""
    if sys.platform == "linux":
        return f"{LINUX}_{platform.machine()}"
    if sys.platform not in LIBRARIES:
        raise SystemExit(f"anthronet: no library is made for {sys.platform}")
    return re.sub(r"[-.]", "_", sysconfig.get_platform())


def shipped(path):
    """Whether a file of the package goes into the wheel: no library that somebody put there."""
    return path.suffix in (".py", ".typed")


def library():
    """The shared library, built where none is named."""
    named = os.environ.get("ANTHRONET_LIBRARY")
    if named:
        if not Path(named).is_file():
            raise SystemExit(f"anthronet: ANTHRONET_LIBRARY names {named}, where there is no file")
        return Path(named)
    arguments = ["build", "--release", "--ignore-rust-version", "--locked", "--package", "anthronet-ffi"]
    subprocess.run([os.environ.get("CARGO", "cargo"), *arguments], cwd=ROOT, check=True)
    target = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
    return target / "release" / LIBRARIES[sys.platform]


def stripped(path):
    """The bytes of the library without symbols that nobody links with."""
    strip = shutil.which("strip") if sys.platform != "win32" else None
    if strip is None:
        return path.read_bytes()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        shutil.copyfile(path, copy)
        subprocess.run([strip, "-x" if sys.platform == "darwin" else "--strip-unneeded", str(copy)], check=True)
        return copy.read_bytes()


def row(name, content):
    """A line of the wheel's RECORD."""
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"
