"""Undo, redo, .blend files, requests as files, presets."""

import json

import bpy
import numpy as np

from blender.harness import (
    add,
    check,
    clean,
    expected_positions,
    home,
    mesh_of,
    people,
    positions,
    select,
    state,
)


def undoing():
    clean()
    bpy.ops.ed.undo_push(message="start")
    character = add(sex="MALE", height=1.80)
    bpy.ops.ed.undo_push(message="add")
    before = state(character)
    character.anthronet.height = 1.90
    character.anthronet.identity[2] = 1.25
    after = state(character)
    bpy.ops.ed.undo_push(message="taller")
    bpy.ops.ed.undo()
    check("undo restores the request, the mesh and the bones", state(people()[0]) == before != after)
    bpy.ops.ed.redo()
    check("redo restores them", state(people()[0]) == after)
    people()[0].anthronet.waist_circumference = 0.95
    check("a character can be changed after undo", people()[0].anthronet.error == "")


def adjusting():
    """Adjust Last Operation: undo, then the operator again with its last properties, some of them changed. Blender's own
    operator for that needs a window."""

    def again(operator, **changed):
        last = bpy.context.window_manager.operators[-1].properties
        kept = {name: getattr(last, name) for name in last.keys()}
        bpy.ops.ed.undo()
        operator("EXEC_DEFAULT", True, **{**kept, **changed})

    clean()
    bpy.ops.ed.undo_push(message="start")
    bpy.ops.anthronet.character_add("EXEC_DEFAULT", True, sex="MALE", height=1.80)
    again(bpy.ops.anthronet.character_add, height=1.70)
    there = people()
    check(
        "Adjust Last Operation changes the character that was added",
        len(there) == 1 and abs(there[0].anthronet.height - 1.70) < 1e-6 and there[0].anthronet.sex == "MALE",
        f"{[one.anthronet.height for one in there]}",
    )
    bpy.ops.anthronet.randomise("EXEC_DEFAULT", True)
    seed = people()[0].anthronet.seed
    kept = bpy.context.window_manager.operators[-1].properties.seed
    check("Randomize stores its random seed for Adjust Last Operation", kept == seed > 0, f"{kept} {seed}")
    again(bpy.ops.anthronet.randomise, what="IDENTITY")
    settings = people()[0].anthronet
    check(
        "Adjust Last Operation can change what is randomized",
        settings.identity_by_hand and settings.fill == "MEAN" and settings.seed == 0,
        f"{settings.fill} {settings.seed}",
    )


def keeping():
    clean()
    character = add(sex="MALE", height=1.80)
    character.anthronet.waist_circumference = 0.95
    path = home / "kept.blend"
    before = state(character)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    character = people()[0]
    check("a saved file has the request, the mesh and the bones", state(character) == before)
    character.anthronet.height = 1.70
    check(
        "a character of a saved file can be changed",
        character.anthronet.error == ""
        and np.array_equal(positions(mesh_of(character).data), expected_positions(character)),
    )
    clean()
    with bpy.data.libraries.load(str(path)) as (there, here):
        here.objects = list(there.objects)
    for thing in here.objects:
        bpy.context.collection.objects.link(thing)
    character = people()[0]
    character.anthronet.height = 1.72
    check("an appended character can be changed", character.anthronet.error == "", character.anthronet.error)

    saved = home / "request.json"
    select(character)
    bpy.ops.anthronet.request_save(filepath=str(saved))
    fields = json.loads(saved.read_text())
    check("a saved request has the typed numbers", fields["measures"]["height"] == 1.72, str(fields))
    fields["measures"]["height"] = 1.66
    saved.write_text(json.dumps(fields))
    bpy.ops.wm.save_as_mainfile(filepath=str(home / "beside.blend"))
    bpy.ops.anthronet.request_load(filepath="//request.json")
    check("a request is loaded from a path relative to the .blend file", abs(character.anthronet.height - 1.66) < 1e-6)
    _presets(character)


def _presets(character):
    other = add(sex="FEMALE")
    select(character)
    bpy.ops.anthronet.preset_add(name="Somebody")
    character.anthronet.height = 1.80
    kept = state(character)
    (preset,) = [path for path in home.rglob("presets/anthronet/*.py") if path.stem.lower() == "somebody"]
    select(character, other)
    bpy.ops.anthronet.preset_apply(filepath=str(preset))
    heights = [round(one.anthronet.height, 5) for one in (character, other)]
    check("a preset is applied to all selected characters", heights == [1.66, 1.66] and state(character) != kept, str(heights))
    panel = bpy.types.ANTHRONET_PT_presets
    check("the panel of presets can add and remove them", panel.preset_add_operator == "anthronet.preset_add")
    bpy.ops.anthronet.preset_add(name="Somebody", remove_name=True)
    check("a preset is removed", not preset.exists())
