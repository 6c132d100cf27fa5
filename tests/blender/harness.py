"""What the parts share. It sets Blender's user folder, so it must be imported before bpy."""

import importlib
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

archive, pictures = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
pictures.mkdir(parents=True, exist_ok=True)
home = Path(tempfile.mkdtemp(prefix="anthronet-blender-"))
os.environ["BLENDER_USER_RESOURCES"] = str(home)

import bpy  # noqa: E402
import numpy as np  # noqa: E402

from glb import Cases  # noqa: E402

NAME = "bl_ext.user_default.anthronet"
TOLERANCE = 1e-5  # metres; Blender and the library keep single precision
cases = Cases()


def check(name, passed, details=""):
    cases.case(name, bool(passed), details)


def clean():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if NAME not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module=NAME)


def module(name):
    """A module of the extension's."""
    return importlib.import_module(f"{NAME}.{name}")


def service(name):
    return module(f"services.{name}")


def add(**fields):
    assert bpy.ops.anthronet.character_add(**fields) == {"FINISHED"}
    return bpy.context.object


def select(*objects):
    """Makes objects the selected ones, the first one active."""
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in objects)
    bpy.context.view_layer.objects.active = objects[0]


def people():
    return [ob for ob in bpy.data.objects if ob.anthronet.is_character]


def mesh_of(character):
    return service("character").mesh_object(character)


def generated(character):
    """The body of a character's request, by the library alone."""
    import anthronet

    return anthronet.default_model().generate(character.anthronet.request())


def positions(mesh):
    out = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", out)
    return out.reshape(-1, 3)


def expected_positions(character):
    settings = character.anthronet
    surface = generated(character).mesh(
        lod=int(settings.lod), space="blender", layout="model", body_only=not settings.accessories
    )
    return np.concatenate([part.positions for part in surface.parts])


def place(mesh, points):
    mesh.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(points, np.float32).reshape(-1))
    mesh.update()


def evaluated(surface):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return positions(surface.evaluated_get(depsgraph).data)


def joints(character, body=None):
    """Where the joints are in the pose, in the armature's space: (joints, 3)."""
    bpy.context.view_layer.update()
    bones = service("armature").pose_bones(character, body or generated(character))
    return np.array([bone.head for bone in bones])


def curves(action):
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    return [
        curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves
    ]


def failure(work):
    """The error message of an operator; empty if it succeeds."""
    try:
        work()
    except RuntimeError as error:
        return str(error)
    return ""


def state(character):
    """Everything that a change of a character can change: request, given measures, identity, mesh, bones."""
    settings = character.anthronet
    given = tuple(settings.is_given(name) for name in module("measures").names())
    values = tuple(getattr(settings, name) for name in module("measures").names())
    bones = np.array([np.array(bone.matrix_local) for bone in character.data.bones])
    return (
        settings.request().to_json(),
        given,
        values,
        tuple(settings.identity),
        positions(mesh_of(character).data).tobytes(),
        bones.tobytes(),
    )


def alike(one, other):
    """Whether two states are the same; bones within a tolerance, since edit mode rounds them."""
    bones = [np.frombuffer(state[-1]) for state in (one, other)]
    return one[:-1] == other[:-1] and np.allclose(*bones, atol=TOLERANCE)


def milliseconds(work, times=1):
    taken = []
    for step in range(times):
        start = time.perf_counter()
        work(step)
        taken.append(1000 * (time.perf_counter() - start))
    return statistics.median(taken)


def speed(name, took, limit):
    """Prints a time and its limit. It never fails, since machines are shared."""
    print(f"speed {name}: {took:.1f} ms (limit {limit} ms{'' if took <= limit else ', OVER THE LIMIT'})", flush=True)
