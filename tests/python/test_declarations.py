"""The declarations of the Python package against the C header, as a C compiler sees it."""

import ctypes
import re
import shutil
import subprocess

import pytest
from anthronet import _native
from support import HEADER

NUMBERS = {
    ctypes.c_int32: "int32_t",
    ctypes.c_uint32: "uint32_t",
    ctypes.c_uint64: "uint64_t",
    ctypes.c_float: "float",
    ctypes.c_double: "double",
}


def c_name(kind):
    return "anthronet_" + re.sub(r"(?<!^)([A-Z])", r"_\1", kind.__name__).lower()


STRUCTURES = {c_name(kind): kind for kind in vars(_native).values()
              if isinstance(kind, type) and issubclass(kind, ctypes.Structure) and kind is not ctypes.Structure}
CONSTANTS = [name for name, value in vars(_native).items() if isinstance(value, int) and name.isupper()]


@pytest.fixture(scope="module")
def code():
    """The header after the preprocessor."""
    if shutil.which("cc") is None:
        pytest.skip("no C compiler `cc`")
    return subprocess.run(["cc", "-E", "-P", HEADER], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def listed(code):
    """Per entry, which arguments are pointers: where a number stands for a pointer, C would take 0 alone."""
    found = {}
    for name, arguments in re.findall(r"\b(anthronet_\w+)\s*\(([^()]*)\)\s*;", code):
        arguments = [] if arguments.strip() == "void" else arguments.split(",")
        found[name] = ["*" in a or "anthronet_log_callback" in a for a in arguments]
    return found


def compiled(source, path, arguments):
    path.write_text(source, encoding="utf-8")
    done = subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wsign-conversion", path,
                           *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr.strip()


def layout_of_c(folder):
    """What a C program prints: `structure size`, `structure.field offset size`, `constant value`."""
    lines = []
    for name, kind in STRUCTURES.items():
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        for field, *_ in kind._fields_:
            place = f"offsetof({name}, {field}), sizeof((({name} *)0)->{field})"
            lines.append(f'printf("{name}.{field} %zu %zu\\n", {place});')
    lines += [f'printf("{name} %lld\\n", (long long)ANTHRONET_{name});' for name in CONSTANTS]
    source = f'#include <stddef.h>\n#include <stdio.h>\n#include "{HEADER}"\nint main(void) {{\n' + "\n".join(lines) + "\n}\n"
    program = folder / "layout"
    compiled(source, folder / "layout.c", ["-o", program])
    return subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()


def calls():
    """A C function for every entry that passes what Python passes: another count or kind of arguments does not
    compile, nor does a number that would be cut."""
    text = f'#include "{HEADER}"\n'
    for name, (result, arguments) in _native.FUNCTIONS.items():
        kinds = [NUMBERS.get(kind) for kind in arguments]
        parameters = ", ".join(f"{kind} a{i}" for i, kind in enumerate(kinds) if kind)
        callback = {i for i, kind in enumerate(arguments) if kind is _native.LogCallback}
        passed = ", ".join(f"a{i}" if kind else "(anthronet_log_callback)0" if i in callback else "(void *)0"
                           for i, kind in enumerate(kinds))
        back = "void" if result is None else NUMBERS[result]
        text += f"{back} call_{name}({parameters or 'void'});\n"
        text += f"{back} call_{name}({parameters or 'void'}) {{ {'return ' if result else ''}{name}({passed}); }}\n"
    return text


def test_functions(listed):
    """Python declares the header's functions"""
    assert len(listed) > 80 and set(listed) == set(_native.FUNCTIONS), sorted(set(listed) ^ set(_native.FUNCTIONS))


def test_pointers_and_numbers(listed):
    """pointers are pointers and numbers are numbers"""
    wrong = [name for name, (_, arguments) in _native.FUNCTIONS.items()
             if listed.get(name) != [kind not in NUMBERS for kind in arguments]]
    assert not wrong, wrong


def test_structures(code):
    """Python declares the header's structures"""
    in_c = set(re.findall(r"typedef struct (anthronet_\w+)\s*\{", code))
    assert in_c == set(STRUCTURES), sorted(in_c ^ set(STRUCTURES))


@pytest.mark.parametrize("name", sorted(STRUCTURES))
def test_fields(code, name):
    """fields of a structure"""
    fields = re.search(rf"typedef struct {name}\s*\{{(.*?)\}}", code, re.DOTALL).group(1).split(";")
    of_c = [re.search(r"(\w+)(\[\d+\])?\s*$", field.strip()).group(1) for field in fields if field.strip()]
    assert [field for field, *_ in STRUCTURES[name]._fields_] == of_c


def test_constants():
    """Python declares the header's constants"""
    defined = set(re.findall(r"^#define ANTHRONET_(\w+) -?\d+$", HEADER.read_text(encoding="utf-8"), re.MULTILINE))
    assert defined == set(CONSTANTS), sorted(defined ^ set(CONSTANTS))


def test_layout(code, tmp_path):
    """sizes, offsets and constants are those of C"""
    in_python = []
    for name, kind in STRUCTURES.items():
        in_python.append(f"{name} {ctypes.sizeof(kind)}")
        for field, *_ in kind._fields_:
            place = getattr(kind, field)
            in_python.append(f"{name}.{field} {place.offset} {place.size}")
    in_python += [f"{name} {getattr(_native, name)}" for name in CONSTANTS]
    in_c = layout_of_c(tmp_path)
    differ = [f"{p}, C has {c}" for p, c in zip(in_python, in_c) if p != c]
    assert in_c == in_python, differ[:3]


def test_calls(code, tmp_path):
    """every function takes and returns what Python passes"""
    compiled(calls(), tmp_path / "calls.c", ["-c", "-o", tmp_path / "calls.o"])
