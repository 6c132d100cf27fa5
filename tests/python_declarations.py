"""The declarations of the Python package against the C header, as a C compiler sees it.

    python python_declarations.py HEADER
"""

import ctypes
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from anthronet import _native
from glb import Cases

NUMBERS = {
    ctypes.c_int32: "int32_t",
    ctypes.c_uint32: "uint32_t",
    ctypes.c_uint64: "uint64_t",
    ctypes.c_float: "float",
    ctypes.c_double: "double",
}


def c_name(kind):
    return "anthronet_" + re.sub(r"(?<!^)([A-Z])", r"_\1", kind.__name__).lower()


def structures():
    return [kind for kind in vars(_native).values() if isinstance(kind, type) and issubclass(kind, ctypes.Structure)
            and kind is not ctypes.Structure]


def layout_of_c(header, folder):
    """What a C program prints: `structure size`, `structure.field offset size`, `constant value`."""
    lines = []
    for kind in structures():
        name = c_name(kind)
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        for field, *_ in kind._fields_:
            place = f"offsetof({name}, {field}), sizeof((({name} *)0)->{field})"
            lines.append(f'printf("{name}.{field} %zu %zu\\n", {place});')
    lines += [f'printf("{name} %lld\\n", (long long)ANTHRONET_{name});' for name in constants()]
    source = f'#include <stddef.h>\n#include <stdio.h>\n#include "{header}"\nint main(void) {{\n' + "\n".join(lines) + "\n}\n"
    return compiled(source, folder, "layout", ["-o", folder / "layout"]) and subprocess.run(
        [folder / "layout"], capture_output=True, text=True, check=True).stdout.splitlines()


def constants():
    return [name for name, value in vars(_native).items() if isinstance(value, int) and name.isupper()]


def compiled(source, folder, name, arguments):
    path = folder / f"{name}.c"
    path.write_text(source, encoding="utf-8")
    done = subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wsign-conversion", path,
                           *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().splitlines()[0])
    return True


def calls(header):
    """A C function for every entry that passes what Python passes: another count or kind of arguments does not
    compile, nor does a number that would be cut."""
    text = f'#include "{header}"\n'
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


def pointers_and_numbers(code):
    """Per entry, which arguments are pointers: where a number stands for a pointer, C would take 0 alone."""
    found = {}
    for name, arguments in re.findall(r"\b(anthronet_\w+)\s*\(([^()]*)\)\s*;", code):
        arguments = [] if arguments.strip() == "void" else arguments.split(",")
        found[name] = ["*" in a or "anthronet_log_callback" in a for a in arguments]
    return found


def main(header):
    cases, header = Cases(), Path(header).resolve()
    if shutil.which("cc") is None:
        print("skipped declarations of Python: no C compiler `cc`")
        return
    code = subprocess.run(["cc", "-E", "-P", header], capture_output=True, text=True, check=True).stdout
    listed = pointers_and_numbers(code)
    cases.case(f"Python declares the header's {len(listed)} functions", set(listed) == set(_native.FUNCTIONS),
               sorted(set(listed) ^ set(_native.FUNCTIONS)))
    wrong = [name for name, (_, arguments) in _native.FUNCTIONS.items()
             if listed.get(name) != [kind not in NUMBERS for kind in arguments]]
    cases.case("pointers are pointers and numbers are numbers", not wrong, wrong)

    in_c = {name for name in re.findall(r"typedef struct (anthronet_\w+)\s*\{", code)}
    in_python = {c_name(kind) for kind in structures()}
    cases.case(f"Python declares the header's {len(in_c)} structures", in_c == in_python, sorted(in_c ^ in_python))
    for name in sorted(in_c & in_python):
        fields = re.search(rf"typedef struct {name}\s*\{{(.*?)\}}", code, re.DOTALL).group(1).split(";")
        of_c = [re.search(r"(\w+)(\[\d+\])?\s*$", field.strip()).group(1) for field in fields if field.strip()]
        kind = next(kind for kind in structures() if c_name(kind) == name)
        of_python = [field for field, *_ in kind._fields_]
        if of_c != of_python:
            cases.case(f"fields of {name}", False, f"{of_python}, expected {of_c}")
    defined = set(re.findall(r"^#define ANTHRONET_(\w+) -?\d+$", header.read_text(encoding="utf-8"), re.MULTILINE))
    cases.case(f"Python declares the header's {len(defined)} constants", defined == set(constants()),
               sorted(defined ^ set(constants())))

    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        in_python = []
        for kind in structures():
            in_python.append(f"{c_name(kind)} {ctypes.sizeof(kind)}")
            for field, *_ in kind._fields_:
                place = getattr(kind, field)
                in_python.append(f"{c_name(kind)}.{field} {place.offset} {place.size}")
        in_python += [f"{name} {getattr(_native, name)}" for name in constants()]
        in_c = layout_of_c(header, folder)
        differ = [f"{p}, C has {c}" for p, c in zip(in_python, in_c) if p != c]
        cases.case(f"{len(in_c)} sizes, offsets and constants are those of C", in_c == in_python, differ[:3])
        try:
            compiled(calls(header), folder, "calls", ["-c", "-o", folder / "calls.o"])
            cases.case("every function takes and returns what Python passes", True)
        except RuntimeError as error:
            cases.case("every function takes and returns what Python passes", False, error)
    cases.exit()


if __name__ == "__main__":
    main(sys.argv[1])
