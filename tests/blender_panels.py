"""What the extension's panels show, read back from a real layout.

    python blender_panels.py anthronet-….zip

Blender does not survive a layout that was asked for without a window, so this runs in a process of its own and leaves as soon
as it has looked.
"""

import ast
import os
import sys
import tempfile
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


def drawn(panel, thing, layout):
    """What a panel draws for an object."""
    context = SimpleNamespace(object=thing)
    self = SimpleNamespace(layout=layout.column())
    for name in ("draw_header", "draw"):
        if name in panel.__dict__:
            panel.__dict__[name](self, context)
    return " | ".join(words(self.layout.introspect()))


def context_at_import():
    """Places where a module of the extension reads the context's scene data while it is imported or registered."""
    faults = []
    with zipfile.ZipFile(archive) as files:
        for name in files.namelist():
            if not name.endswith(".py"):
                continue
            tree = ast.parse(files.read(name), name)
            bodies = [node for node in tree.body if not isinstance(node, (ast.FunctionDef, ast.ClassDef))]
            bodies += [
                node
                for node in tree.body
                if isinstance(node, ast.FunctionDef) and node.name in ("register", "unregister")
            ]
            for body in bodies:
                for node in ast.walk(body):
                    if isinstance(node, ast.Attribute) and node.attr in ("context", "data", "ops"):
                        if isinstance(node.value, ast.Name) and node.value.id == "bpy":
                            faults.append(f"{name}:{node.lineno}: bpy.{node.attr}")
    return faults


bpy.ops.extensions.package_install_files(filepath=str(archive), repo="user_default", enable_on_install=True)
faults = context_at_import()
cases.case("nothing reads the scene at import or in register", not faults, "; ".join(faults))
bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
if NAME not in bpy.context.preferences.addons:
    bpy.ops.preferences.addon_enable(module=NAME)
panels = {name: getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ANTHRONET_PT_")}
cases.case(
    "no character: the start panel alone",
    [n for n, p in panels.items() if p.poll(bpy.context)] == ["ANTHRONET_PT_start"],
)

bpy.ops.anthronet.character_add(sex="FEMALE", height=1.70)
open_panels = {name for name, panel in panels.items() if panel.poll(bpy.context)}
cases.case("with a character: all the others", open_panels == set(panels) - {"ANTHRONET_PT_start"}, str(open_panels))
person = bpy.context.object
bpy.ops.anthronet.character_add(sex="MALE")
impossible = bpy.context.object
impossible.anthronet.waist_circumference = 2.9


def look(menu, _context):
    """Everything happens in here: Blender does not come back from it."""
    try:
        read_panels({name: drawn(panel, person, menu.layout) for name, panel in panels.items()})
        text = drawn(panels["ANTHRONET_PT_measures"], impossible, menu.layout)
        cases.case("an error stands in the panel", "waist" in text.lower(), text[:200])
    except Exception as error:
        cases.case("the panels draw", False, f"{type(error).__name__}: {error}")
    sys.stdout.flush()
    os._exit(1 if cases.failed else 0)


def read_panels(texts):
    import anthronet

    def has(panel, *expected):
        lost = [word for word in expected if word.lower() not in texts[f"ANTHRONET_PT_{panel}"].lower()]
        cases.case(f"panel {panel}", not lost, f"{lost} not in {texts[f'ANTHRONET_PT_{panel}'][:300]}")

    has("start", "Add Character", "Add Crowd")
    has("person", "Sex", "Seed", "Randomise", "Mirror")
    has("identity", "Identity 1", "Identity 10")
    has("body", "lod", "skin_tone", "joint_names")
    has("motion", "clip_apply", "Export")
    has("report", "Female", "kg", "percentile")
    groups = {name: texts[f"ANTHRONET_PT_{name}"] for name in ("head", "torso", "arms", "legs")}
    everything = " | ".join(groups.values())
    lost = [name for name in anthronet.MEASURES if name not in everything]
    cases.case("every measure has its row", not lost, f"{lost} not in {everything[:400]}")
    cases.case(
        "a filled measure shows its interval in metres",
        "–" in groups["legs"] and " m" in groups["legs"],
        groups["legs"][:200],
    )
    cases.case(
        "a given one its residual and percentile",
        " mm" in groups["torso"] and " %" in groups["torso"],
        groups["torso"][:300],
    )


with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
    bpy.context.window_manager.popup_menu(look)
cases.case("the panels draw", False, "Blender drew nothing")
cases.exit()
