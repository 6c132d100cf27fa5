"""Changes that are rejected, and that a change is applied completely or not at all."""

import json

import bpy
import numpy as np

from blender.harness import (
    add,
    check,
    clean,
    expected_positions,
    failure,
    home,
    mesh_of,
    people,
    place,
    positions,
    select,
    service,
    state,
)


def _check_rejected(name, character, expected):
    """Checks that sliders and operators say why a character cannot be changed."""
    regeneration = service("regeneration")
    settings = character.anthronet
    before = settings.height
    settings.height = before + 0.02
    error = settings.error
    check(f"{name}: the error of a slider has the reason", expected in error, error)
    poll = regeneration.reason_not_editable(character, bpy.context) or ""
    check(f"{name}: so do operators' polls", expected in poll and not bpy.ops.anthronet.unset_measures.poll(), poll)
    settings.height = before


def refusing():
    clean()
    character = add(sex="FEMALE", height=1.70)
    surface = mesh_of(character)
    kept = positions(surface.data).copy()
    select(surface)
    for mode, words in (("EDIT", "edit mesh mode"), ("SCULPT", "sculpt mode"), ("VERTEX_PAINT", "vertex mode")):
        bpy.ops.object.mode_set(mode=mode)
        _check_rejected(f"{mode.lower()} mode", character, "Leave ")
        if mode == "EDIT":
            message = failure(bpy.ops.anthronet.measure_selected)
            check("edit mode: Measure reports the reason", "edit mode" in message and "Traceback" not in message, message)
        check(f"Blender stays in {mode.lower()} mode", surface.mode == mode)
        bpy.ops.object.mode_set(mode="OBJECT")
    select(character)
    bpy.ops.object.mode_set(mode="POSE")
    select(surface, character)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    _check_rejected("weight paint over a pose", character, "weight")
    check(
        "weight paint over a pose: both objects stay in their modes",
        (surface.mode, character.mode) == ("WEIGHT_PAINT", "POSE"),
        character.mode,
    )
    bpy.ops.object.mode_set(mode="OBJECT")
    select(character)
    if character.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    check("a rejected change moves no vertices", np.array_equal(positions(surface.data), kept))
    character.anthronet.height = 1.71
    check(
        "back in object mode the character can be changed",
        np.array_equal(positions(surface.data), expected_positions(character)),
    )

    collection = bpy.data.collections.new("away")
    bpy.context.scene.collection.children.link(collection)
    layer = bpy.context.view_layer.layer_collection.children["away"]
    bpy.context.view_layer.active_layer_collection = layer
    collection.hide_viewport = True
    bpy.context.view_layer.active_layer_collection = layer
    count = len(bpy.data.objects)
    message = failure(lambda: bpy.ops.anthronet.character_add(sex="MALE"))
    check("no character is added to a hidden collection", "hidden" in message and len(bpy.data.objects) == count, message)
    collection.hide_viewport = False
    layer.exclude = True
    message = failure(lambda: bpy.ops.anthronet.character_add(sex="MALE"))
    strays = [ob.name for ob in bpy.data.objects if ob.name not in bpy.context.view_layer.objects]
    check("no object is added to an excluded collection", not strays, f"{strays} {message}")
    layer.exclude = False
    bpy.context.view_layer.active_layer_collection = layer
    outside = add(sex="MALE")
    layer.exclude = True
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection
    outside.anthronet.height = 1.81
    check("outside the view layer: an error", "view layer" in outside.anthronet.error, outside.anthronet.error)
    layer.exclude = False
    collection.hide_viewport = True
    before = state(outside)
    outside.anthronet.height = 1.82
    check("in a hidden collection: an error, and nothing moves", "hidden" in outside.anthronet.error and
          state(outside)[4:] == before[4:], outside.anthronet.error)
    collection.hide_viewport = False

    scaled = add(sex="MALE", height=1.80)
    select(scaled, mesh_of(scaled))
    scaled.scale = (1.1, 1.1, 1.1)
    scaled.anthronet.height = 1.79
    check("a scaled object can be changed", scaled.anthronet.error == "", scaled.anthronet.error)
    bpy.ops.object.transform_apply(scale=True)
    _check_rejected("after Apply Scale", scaled, "applied")

    damaged = add(sex="MALE", height=1.80)
    bpy.ops.object.mode_set(mode="EDIT")
    damaged.data.edit_bones.remove(damaged.data.edit_bones["toe.L"])
    bpy.ops.object.mode_set(mode="OBJECT")
    _check_rejected("a deleted bone", damaged, "ball_l")


def failing_whole():
    """Operators on several characters change all of them or none."""
    clean()
    character = add(sex="FEMALE", height=1.70)
    other = add(sex="MALE", height=1.80)
    armature = service("armature")
    counts = lambda: (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.armatures))
    before, set_rest_pose = counts(), armature.set_rest_pose
    armature.set_rest_pose = lambda *_: (_ for _ in ()).throw(RuntimeError("no mode"))
    try:
        message = failure(lambda: bpy.ops.anthronet.character_add(sex="MALE"))
        check("a failed creation leaves no data-blocks behind", "no mode" in message and counts() == before, f"{counts()}")
        kept = state(character)
        character.anthronet.height = 1.72
        check("if bones cannot move, the mesh does not move either", character.anthronet.error == "no mode" and
              state(character)[4:] == kept[4:], character.anthronet.error)
    finally:
        armature.set_rest_pose = set_rest_pose
    character.anthronet.height = 1.70

    impossible = {"sex": "female", "measures": {"height": 1.5, "thigh_length_left": 0.69, "thigh_length_right": 0.69}}
    path = home / "impossible.json"
    path.write_text(json.dumps(impossible))
    select(character, other)
    both = state(character), state(other)
    message = failure(lambda: bpy.ops.anthronet.request_load(filepath=str(path)))
    check("an impossible request is reported", "thigh" in message and "Traceback" not in message, message)
    check("an impossible request changes no character", (state(character), state(other)) == both)
    path.write_text(json.dumps({"sex": "female", "seed": 2**40}))
    message = failure(lambda: bpy.ops.anthronet.request_load(filepath=str(path)))
    check("a seed that Blender cannot store is reported", "seed" in message, message)
    preset = home / "impossible.py"
    preset.write_text(
        "import bpy\nsettings = bpy.context.object.anthronet\nsettings.sex = 'MALE'\n"
        "settings.given_thigh_length_left = True\nsettings.thigh_length_left = 0.9\n"
    )
    message = failure(lambda: bpy.ops.anthronet.preset_apply(filepath=str(preset)))
    check("an impossible preset is reported", "thigh" in message, message)
    preset.write_text("settings = nothing\n")
    message = failure(lambda: bpy.ops.anthronet.preset_apply(filepath=str(preset)))
    check("a script that is no preset is reported", "preset" in message and "Traceback" not in message, message)
    mesh_of(other).data.clear_geometry()
    both = state(character), state(other)
    for name, work in (
        ("mirror", bpy.ops.anthronet.mirror),
        ("both sides alike", bpy.ops.anthronet.symmetrise),
        ("open all", bpy.ops.anthronet.unset_measures),
        ("copy", bpy.ops.anthronet.copy_request),
        ("randomise", bpy.ops.anthronet.randomise),
        ("measures from mesh", bpy.ops.anthronet.fit_selected),
    ):
        message = failure(work)
        check(
            f"{name}: if one character cannot be changed, none is",
            "vertices" in message and (state(character), state(other)) == both,
            message,
        )


def _legs():
    """A motion of two legs alone."""
    leg = """JOINT {0}UpLeg
{{
OFFSET {1} -4 0
CHANNELS 1 Xrotation
JOINT {0}Leg
{{
OFFSET 0 -42 0
CHANNELS 1 Xrotation
JOINT {0}Foot
{{
OFFSET 0 -42 0
CHANNELS 1 Xrotation
End Site
{{
OFFSET 0 -6 12
}}
}}
}}
}}
"""
    hips = "ROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n"
    frames = "MOTION\nFrames: 2\nFrame Time: 0.04\n" + 2 * "0 92 0 0 0 0 0 0 0\n"
    return "HIERARCHY\n" + hips + leg.format("Left", 9) + leg.format("Right", -9) + "}\n" + frames


def failing():
    clean()
    character = add(sex="FEMALE")
    add(sex="FEMALE")
    broken = home / "broken.bvh"
    broken.write_text("HIERARCHY\nROOT hips\n{\n")
    legs = home / "legs.bvh"
    legs.write_text(_legs())
    for name, work, expected in (
        ("a broken clip", lambda: bpy.ops.anthronet.clip_apply(filepath=str(broken)), "broken.bvh"),
        ("half a person", lambda: bpy.ops.anthronet.clip_apply(filepath=str(legs)), "lacks the trunk"),
        ("a missing clip", lambda: bpy.ops.anthronet.clip_apply(filepath="/nowhere/a.bvh"), "/nowhere/a.bvh"),
        ("an unknown armature", lambda: bpy.ops.anthronet.clip_from_armature(source="nobody"), "nobody"),
        ("no armature", lambda: bpy.ops.anthronet.clip_from_armature(), "armature"),
        (
            "an unknown action",
            lambda: bpy.ops.anthronet.clip_from_armature(source=character.name, action="dance"),
            "dance",
        ),
        (
            "an impossible person",
            lambda: bpy.ops.anthronet.character_add(
                sex="FEMALE", height=1.5, thigh_length_left=0.69, thigh_length_right=0.69
            ),
            "thigh",
        ),
        (
            "a folder that is not there",
            lambda: bpy.ops.anthronet.character_export(filepath="/nowhere/a.glb"),
            "/nowhere",
        ),
        ("a request that is not there", lambda: bpy.ops.anthronet.request_load(filepath="/nowhere/a.json"), "/nowhere"),
    ):
        message = failure(work)
        check(f"{name} is reported", expected in message and "Traceback" not in message, message.strip()[:160])
    character = bpy.context.object
    bpy.ops.anthronet.clip_apply(filepath=str(legs), force=True)
    check("half a person is retargeted if forced", character.animation_data.action is not None)
    mesh_of(character).data.clear_geometry()
    message = failure(bpy.ops.anthronet.measure_selected)
    check(
        "a mesh without its vertices is reported",
        "vertices" in message and "Traceback" not in message,
        message.strip(),
    )


def sharing():
    """Linked and unlinked duplicates."""
    clean()
    first = add(sex="FEMALE", height=1.70)
    before = state(first)
    select(first, mesh_of(first))
    bpy.ops.object.duplicate(linked=True)
    second = next(one for one in people() if one != first)
    check("a linked duplicate shares its data", second.data == first.data)
    second.anthronet.height = 1.80
    check("a change of a linked duplicate does not change the original", state(first) == before, second.anthronet.error)
    check(
        "a changed linked duplicate has data of its own",
        np.array_equal(positions(mesh_of(second).data), expected_positions(second)) and second.data != first.data,
    )
    select(first, mesh_of(first))
    bpy.ops.object.duplicate(linked=False)
    third = next(one for one in people() if one not in (first, second))
    third.anthronet.height = 1.60
    check(
        "an unlinked duplicate is a character of its own",
        third.anthronet.error == ""
        and state(first) == before
        and np.array_equal(positions(mesh_of(third).data), expected_positions(third))
        and mesh_of(third).modifiers[0].object == third,
        third.anthronet.error,
    )
    select(first)
    bpy.ops.object.duplicate(linked=False)
    bare = next(one for one in people() if one not in (first, second, third))
    _check_rejected("an armature that was duplicated alone", bare, "no body mesh")


def linking():
    """Characters that are linked from another file."""
    clean()
    add(sex="FEMALE", height=1.70, waist_circumference=0.72)
    path = home / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    clean()
    with bpy.data.libraries.load(str(path), link=True) as (there, here):
        here.objects = list(there.objects)
    for thing in here.objects:
        bpy.context.collection.objects.link(thing)
    linked = people()[0]
    select(linked)
    reason = service("regeneration").reason_not_editable(linked, bpy.context) or ""
    check("a linked character: the reason suggests Make Local", "linked" in reason and "Make Local" in reason, reason)
    check(
        "a linked character: operators are not available",
        not bpy.ops.anthronet.mirror.poll() and not bpy.ops.anthronet.clip_builtin.poll(),
    )
    check("a linked character: Make Local", bpy.ops.anthronet.make_local() == {"FINISHED"})
    local = people()[0]
    local.anthronet.height = 1.74
    check(
        "a linked character can be changed after Make Local",
        local.library is None
        and local.anthronet.error == ""
        and np.array_equal(positions(mesh_of(local).data), expected_positions(local)),
        local.anthronet.error,
    )
    clean()
    with bpy.data.libraries.load(str(path), link=True) as (there, here):
        here.objects = list(there.objects)
    for thing in here.objects:
        bpy.context.collection.objects.link(thing)
    override = people()[0].override_create(remap_local_usages=True)
    select(override)
    reason = service("regeneration").reason_not_editable(override, bpy.context) or ""
    check("a library override: the reason suggests Make Local", "Make Local" in reason, reason)
