"""The imports of the extension, read from its source without Blender: they have no cycle and go from the user interface down.

    python import_order.py [FOLDER]

Imports inside functions count like all others: a cycle that is only hidden is still one.
"""

import ast
import sys
from pathlib import Path, PurePosixPath

#: The layers from top to bottom. A module imports from its own layer and from lower ones. "" is the package itself.
LAYERS = (("",), ("ui",), ("operators",), ("services",), ("state",), ("library", "measures", "units", "compat"))
_RANK = {name: rank for rank, names in enumerate(LAYERS) for name in names}


def imports(sources):
    """From each module to the modules of the extension that it imports. ``sources``: from paths in the extension to source
    texts. Names of modules have dots and no package in front: ``services.mesh``; a package is named by its folder."""
    names = {path: _module_name(path) for path in sources}
    known = set(names.values())
    graph = {}
    for path, text in sources.items():
        package = PurePosixPath(path).parent.parts
        found = set()
        for node in ast.walk(ast.parse(text, path)):
            if isinstance(node, ast.ImportFrom) and node.level > 0:
                base = package[: len(package) - node.level + 1]
                base = ".".join((*base, *(node.module or "").split("."))).strip(".")
                for alias in node.names:
                    full = f"{base}.{alias.name}".strip(".")
                    found.add(full if full in known else base)
        graph[names[path]] = found - {names[path]}
    return graph


def _module_name(path):
    parts = PurePosixPath(path).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def faults(sources):
    """What is wrong with the imports, one text each."""
    graph = imports(sources)
    out = []
    for module, imported in sorted(graph.items()):
        layer = module.partition(".")[0]
        if layer not in _RANK:
            out.append(f"{module}: {layer} is in no layer")
            continue
        for other in sorted(imported):
            rank = _RANK.get(other.partition(".")[0])
            if rank is not None and rank < _RANK[layer]:
                out.append(f"{module}: imports {other or 'the package'}, which is in a higher layer")
    cycle = _cycle(graph)
    return [*out, "a cycle: " + " → ".join(name or "the package" for name in cycle)] if cycle else out


def _cycle(graph):
    """The modules of a cycle of imports, the first one again at the end; empty if there is none."""
    finished = set()

    def visit(module, path):
        if module in path:
            return [*path[path.index(module) :], module]
        if module in finished:
            return []
        for other in sorted(graph.get(module, ())):
            found = visit(other, [*path, module])
            if found:
                return found
        finished.add(module)
        return []

    return next((found for module in sorted(graph) if (found := visit(module, []))), [])


#: Faults that the check has to find: sources, and a part of the message.
_PLANTED = (
    ({"services/a.py": "from ..operators import b\n", "operators/b.py": ""}, "higher layer"),
    ({"state/a.py": "def late():\n    from ..services.b import c\n", "services/b.py": ""}, "higher layer"),
    ({"library.py": "from .state import a\n", "state/a.py": ""}, "higher layer"),
    ({"units.py": "from . import register\n", "__init__.py": ""}, "higher layer"),
    ({"services/a.py": "from . import b\n", "services/b.py": "def late():\n    from .a import c\n"}, "cycle"),
    ({"elsewhere.py": ""}, "no layer"),
)


def missed():
    """Planted faults that the check does not find, and a sound source that it complains of."""
    lost = [str(sources) for sources, expected in _PLANTED if expected not in "; ".join(faults(sources))]
    sound = {"__init__.py": "from . import ui\n", "ui/__init__.py": "from ..services import a\n", "services/a.py": ""}
    return lost + faults(sound)


if __name__ == "__main__":
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2] / "blender_addon")
    found = missed() + faults({str(path.relative_to(root)): path.read_text("utf-8") for path in root.rglob("*.py")})
    print("\n".join(found) or "the imports of the extension are in order")
    sys.exit(1 if found else 0)
