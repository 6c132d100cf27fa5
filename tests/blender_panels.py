"""Tests of what the extension's panels draw, read back from a real layout.

    python blender_panels.py anthronet-….zip

Blender crashes after it has drawn a layout without a window, so this runs in a process of its own and exits right after that.
"""

import ast
import os
import re
import sys
import tempfile
import traceback
import zipfile
from pathlib import Path
from types import SimpleNamespace

archive = Path(sys.argv[1]).resolve()
os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="anthronet-panels-")

import bpy  # noqa: E402

from glb import Cases  # noqa: E402

cases = Cases()
NAME = "bl_ext.user_default.anthronet"


def words(items):
    """All labels, properties and operators of an introspected layout."""
    for item in items:
        yield from (str(value) for value in item.values() if isinstance(value, str))
        yield from words(item.get("items", ()))


def readable(panel):
    """Whether the extension draws a panel. Blender draws the one of presets."""
    return "draw" in panel.__dict__


class Context:
    """Blender's context with another object and mode."""

    def __init__(self, thing, mode="OBJECT"):
        self.object, self.mode = thing, mode

    def __getattr__(self, name):
        return getattr(bpy.context, name)


def drawn(panel, context, layout):
    """The texts that a panel draws in a context."""
    self = SimpleNamespace(layout=layout.column())
    for name in ("draw_header", "draw_header_preset", "draw"):
        if name in panel.__dict__:
            panel.__dict__[name](self, context)
    try:
        return " | ".join(words(self.layout.introspect()))
    except SyntaxError as error:
        # Blender does not escape the marks of feet and inches, but the error has the text.
        return error.text


#: What of bpy a module must not use while Blender starts: there may be no scene, or not the user's.
FORBIDDEN = {"context", "data", "ops"}


def at_import(tree):
    """The nodes of a module that run when it is imported: bodies of classes, defaults, decorators and annotations with them,
    bodies of functions not."""
    waiting = list(tree.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            arguments = node.args
            waiting += [*arguments.defaults, *(default for default in arguments.kw_defaults if default)]
            if not isinstance(node, ast.Lambda):
                every = (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
                waiting += [*node.decorator_list, *(one.annotation for one in every if one.annotation)]
            continue
        yield node
        waiting += ast.iter_child_nodes(node)


def runs_at_start(tree):
    """The nodes of a module that run at import, in ``register`` and ``unregister``, and in the module's own functions that those
    call, however deep."""
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    nodes = list(at_import(tree))
    called = {"register", "unregister"} & functions.keys()
    done = set()
    while True:
        called |= {
            node.func.id
            for node in nodes
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in functions
        }
        fresh = called - done
        if not fresh:
            return nodes
        for name in fresh:
            nodes += [node for statement in functions[name].body for node in ast.walk(statement)]
        done |= fresh


def scene_at_start():
    """Places where the extension reads the scene while it is imported or registered, or leaves a timer."""
    faults = []
    with zipfile.ZipFile(archive) as files:
        for name in files.namelist():
            if name.endswith(".py"):
                tree = ast.parse(files.read(name), name)
                faults += [f"{name}:{line}: {what}" for line, what in scene_reads(runs_at_start(tree))]
                faults += [
                    f"{name}:{node.lineno}: a timer of Blender's, which would outlive the extension"
                    for node in ast.walk(tree)
                    if isinstance(node, ast.Attribute) and ast.unparse(node) == "bpy.app.timers"
                ]
    return faults


def scene_reads(nodes):
    """Lines and names of what reads the scene: ``bpy.context`` and the like, or a name that was imported from bpy."""
    for node in nodes:
        if isinstance(node, ast.Attribute) and node.attr in FORBIDDEN:
            if isinstance(node.value, ast.Name) and node.value.id == "bpy":
                yield node.lineno, f"bpy.{node.attr}"
        if isinstance(node, ast.ImportFrom) and node.module == "bpy":
            yield from ((node.lineno, one.name) for one in node.names if one.name in FORBIDDEN)


# Faults that the check has to find.
_PLANTED = """
import bpy
class A:
    x = bpy.data.objects
    def late(self, y=bpy.context.scene): return bpy.context
def helper(): deeper()
def deeper(): bpy.ops.mesh.select_all()
def register(): helper()
def never(): bpy.data.meshes
"""
found = sorted(line for line, _ in scene_reads(runs_at_start(ast.parse(_PLANTED))))
cases.case("the check of what runs at start finds planted faults", found == [4, 5, 7], str(found))

bpy.ops.extensions.package_install_files(filepath=str(archive), repo="user_default", enable_on_install=True)
faults = scene_at_start()
cases.case("nothing uses the scene at import or in register", not faults, "; ".join(faults))
bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
if NAME not in bpy.context.preferences.addons:
    bpy.ops.preferences.addon_enable(module=NAME)
panels = {name: getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ANTHRONET_PT_")}
cases.case(
    "without a character there is the start panel only",
    [n for n, p in panels.items() if readable(p) and p.poll(bpy.context)] == ["ANTHRONET_PT_start"],
)

bpy.ops.anthronet.character_add(sex="FEMALE", height=1.70)
open_panels = {name for name, panel in panels.items() if readable(panel) and panel.poll(bpy.context)}
hidden = {"ANTHRONET_PT_start", "ANTHRONET_PT_presets"}
cases.case("with a character there are all other panels", open_panels == set(panels) - hidden, str(open_panels))
person = bpy.context.object
bpy.ops.anthronet.clip_builtin(name="IDLE")
bpy.ops.anthronet.character_add(sex="MALE")
impossible = bpy.context.object
impossible.anthronet.waist_circumference = 2.9
walker = person.copy()
bpy.context.collection.objects.link(walker)


def look(menu, _context):
    """All tests of drawing. It does not return, because Blender would crash."""
    try:
        layout, units = menu.layout, bpy.context.scene.unit_settings
        read_panels({name: drawn(panel, Context(person), layout) for name, panel in panels.items() if readable(panel)})
        text = drawn(panels["ANTHRONET_PT_measures"], Context(impossible), layout)
        cases.case("an error is shown in the panel", "waist" in text.lower(), text[:200])
        units.system = "IMPERIAL"
        text = drawn(panels["ANTHRONET_PT_legs"], Context(person), layout)
        cases.case("imperial: intervals in feet and inches", "\"" in text or "'" in text, text[:300])
        text = drawn(panels["ANTHRONET_PT_report"], Context(person), layout)
        cases.case("imperial: mass in pounds", "lb" in text, text[:200])
        units.system, units.scale_length = "METRIC", 0.01
        text = drawn(panels["ANTHRONET_PT_measures"], Context(person), layout)
        cases.case("another Unit Scale is noted", "Unit Scale" in text, text[:200])
        units.scale_length = 1.0
        text = drawn(panels["ANTHRONET_PT_person"], Context(person, "EDIT_MESH"), layout)
        cases.case("the panel shows why the character cannot be changed", "edit mesh mode" in text, text[:200])
        text = drawn(panels["ANTHRONET_PT_person"], Context(walker), layout)
        cases.case("the panel shows that the mesh is missing", "no body mesh" in text, text[:200])
        before = drawn(panels["ANTHRONET_PT_motion"], Context(person), layout)
        person.anthronet.hip_circumference = 1.0
        after = drawn(panels["ANTHRONET_PT_motion"], Context(person), layout)
        cases.case("Refit Clip is offered after a change", "clip_refit" in after and "clip_refit" not in before, after)
    except Exception as error:
        traceback.print_exc(file=sys.stdout)
        cases.case("the panels draw", False, f"{type(error).__name__}: {error}")
    sys.stdout.flush()
    os._exit(1 if cases.failed else 0)


def read_panels(texts):
    import anthronet

    def has(panel, *expected):
        lost = [word for word in expected if word.lower() not in texts[f"ANTHRONET_PT_{panel}"].lower()]
        cases.case(f"panel {panel}", not lost, f"{lost} not in {texts[f'ANTHRONET_PT_{panel}'][:300]}")

    has("start", "Add Character", "Add Crowd")
    has("person", "Sex", "Seed", "Randomize", "Mirror", "anthronet_edit_together")
    has("identity", "Identity 1", "Identity 10")
    has("body", "lod", "skin_tone", "joint_names", "fine_render")
    has("motion", "clip_apply", "clip_builtin", "clip_from_armature", "metarig_add", "Export")
    has("report", "Female", "kg", "percentile")
    groups = {name: texts[f"ANTHRONET_PT_{name}"] for name in ("head", "torso", "arms", "legs")}
    everything = " | ".join(groups.values())
    lost = [name for name in anthronet.MEASURES if name not in everything]
    cases.case("every measure has its row", not lost, f"{lost} not in {everything[:400]}")
    cases.case(
        "a predicted measure shows its percentile and interval",
        "–" in groups["legs"] and " m" in groups["legs"] and re.search(r"P\d+ ", groups["legs"]),
        groups["legs"][:200],
    )
    cases.case(
        "a given measure shows its percentile and error",
        re.search(r"P\d+  error [+-]0\.00 mm", groups["torso"]),
        groups["torso"][:300],
    )


with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
    bpy.context.window_manager.popup_menu(look)
cases.case("the panels draw", False, "Blender did not draw")
cases.exit()
