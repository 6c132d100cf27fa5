"""Changing characters in place."""

import bpy
import numpy as np

from blender.harness import (
    add,
    alike,
    check,
    clean,
    curves,
    expected_positions,
    failure,
    generated,
    mesh_of,
    milliseconds,
    module,
    place,
    positions,
    select,
    service,
    speed,
    state,
)


def editing():
    clean()
    character = add(sex="FEMALE", height=1.70)
    surface = mesh_of(character)
    settings = character.anthronet
    bpy.ops.anthronet.clip_builtin(name="WALK")
    action = character.animation_data.action
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="nose")
    key.data[5].co.x += 0.25
    material = surface.data.materials[0]

    settings.waist_circumference = 0.80
    check(
        "moving a slider makes its measure a given one",
        settings.given_waist_circumference and settings.error == "",
        settings.error,
    )
    check(
        "measures that are not given are predicted again",
        abs(settings.hip_circumference - generated(character).measures["hip_circumference"]) < 1e-6,
    )
    check("the mesh is updated", np.array_equal(positions(surface.data), expected_positions(character)))
    moved = np.array(key.data[5].co) - np.array(surface.data.shape_keys.key_blocks[0].data[5].co)
    check("shape keys keep their offsets", np.allclose(moved, (0.25, 0, 0), atol=1e-6), str(moved))
    check(
        "animation and materials are kept",
        character.animation_data.action == action and surface.data.materials[0] == material,
    )
    rest = np.array(character.data.bones["head"].matrix_local)
    joints = dict(zip(generated(character).joint_names("blender"), generated(character).joints("blender")))
    check("the bones are updated", np.abs(rest - joints["head"]["model_from_joint"]).max() < 1e-5)

    bpy.ops.object.mode_set(mode="POSE")
    settings.height = 1.75
    check(
        "a measure can be changed in pose mode",
        character.mode == "POSE" and settings.error == "" and abs(settings.height - 1.75) < 1e-6,
    )
    bpy.ops.object.mode_set(mode="OBJECT")

    before = positions(surface.data).copy()
    settings.waist_circumference = 2.5
    check("an impossible measure is reported", "waist" in settings.error, settings.error)
    check("an impossible measure leaves the body as it is", np.array_equal(positions(surface.data), before))
    settings.waist_circumference = 0.80
    check("the error is cleared by a possible measure", settings.error == "")

    settings.joint_names = "UNITY"
    groups = {group.name for group in mesh_of(character).vertex_groups}
    check("bones and vertex groups are renamed", "LeftUpperArm" in character.data.bones and "LeftUpperArm" in groups)
    bpy.context.scene.frame_set(10)
    paths = {curve.data_path for curve in curves(action)}
    check("animation channels are renamed with the bones", any("LeftUpperArm" in path for path in paths))
    settings.fine_render = True
    fine = surface.modifiers[-1]
    check(
        "Fine in Renders subdivides after the armature modifier, in renders only",
        (fine.type, fine.levels, fine.render_levels) == ("SUBSURF", 0, 1) and surface.modifiers[0].type == "ARMATURE",
    )
    settings.fine_render = False
    check("Fine in Renders is removed", [modifier.type for modifier in surface.modifiers] == ["ARMATURE"])
    animatable = [
        one.identifier
        for cls in (settings, settings.report[0])
        for one in cls.bl_rna.properties
        if one.is_animatable and one.identifier not in ("name", "rna_type")
    ]
    check("no property of a character can be animated", not animatable, str(animatable))


def posing_together():
    """Several armatures that are in pose mode at once."""
    clean()
    first, second = add(sex="FEMALE"), add(sex="MALE")
    select(first, second)
    bpy.ops.object.mode_set(mode="POSE")
    first.anthronet.height = 1.72
    check(
        "several armatures in pose mode stay there",
        (first.mode, second.mode) == ("POSE", "POSE") and first.select_get() and second.select_get(),
        f"{first.mode} {second.mode} {first.anthronet.error}",
    )
    bpy.ops.object.mode_set(mode="OBJECT")


def escaping():
    """Esc during a drag sets the earlier value through the same update callback."""
    clean()
    settings = add(sex="FEMALE", height=1.70).anthronet
    before = state(bpy.context.object)
    value = settings.hip_circumference
    for step in (0.01, 0.02, 0.03):
        settings.hip_circumference = value + step
    check("a drag makes the measure a given one", settings.given_hip_circumference)
    settings.hip_circumference = value
    same = [one == other for one, other in zip(state(bpy.context.object), before)]
    check("Esc restores the character", alike(state(bpy.context.object), before), str(same))
    identity = list(settings.identity)
    settings.identity[3] = 1.5
    check(
        "moving an identity slider sets the identity by hand",
        settings.identity_by_hand and settings.error == "",
        settings.error,
    )
    settings.identity[3] = identity[3]
    check("Esc restores the identity of the seed", alike(state(bpy.context.object), before))
    settings.given_hip_circumference = True
    settings.hip_circumference = value + 0.02
    settings.hip_circumference = value
    check("a measure that was locked before the drag stays given after Esc", settings.given_hip_circumference)
    settings.identity_by_hand = True
    settings.identity[3] = identity[3] + 0.5
    settings.identity[3] = identity[3]
    check("an identity that was by hand before the drag stays so after Esc", settings.identity_by_hand)


def ticking():
    for lod, bar in (("1", 20), ("0", 40)):
        clean()
        character = add(sex="FEMALE", height=1.70, lod=lod)

        def update(step):
            character.anthronet.waist_circumference = 0.70 + 0.003 * step
            bpy.context.view_layer.update()

        milliseconds(update, 3)
        speed(f"slider update at LOD {lod}", milliseconds(update, 20), bar)
        check(
            f"the body has the last measure at LOD {lod}",
            abs(generated(character).measures["waist_circumference"] - 0.757) < 1e-4,
        )


def _belly(points):
    return (np.abs(points[:, 2] - 1.10) < 0.08) & (np.abs(points[:, 0]) < 0.16) & (points[:, 1] < 0)


def sculpting():
    clean()
    character = add(sex="MALE", height=1.82)
    surface = mesh_of(character)
    pushed = positions(surface.data).copy()
    belly = _belly(pushed)
    pushed[belly, 1] -= 0.03
    place(surface.data, pushed)
    before = generated(character).measures
    bpy.ops.anthronet.measure_selected()
    sculpted = dict(character["anthronet_measured"])
    check("Measure measures the sculpted mesh", sculpted["waist_circumference"] > before["waist_circumference"] + 0.01)
    character.anthronet.height = 1.80
    depth = positions(surface.data)[belly, 1] - expected_positions(character)[belly, 1]
    check("sculpting is kept after a change of a measure", np.allclose(depth, -0.03, atol=1e-5))
    key = (surface.shape_key_add(name="Basis"), surface.shape_key_add(name="smile"))[1]
    key.data[9].co.z += 0.1
    bpy.ops.anthronet.measure_selected()
    sculpted = dict(character["anthronet_measured"])
    result = bpy.ops.anthronet.fit_selected()
    off = abs(generated(character).measures["waist_circumference"] - sculpted["waist_circumference"])
    check(
        "Measures from Mesh requests the measures of the sculpted mesh",
        result == {"FINISHED"} and off < 1e-4,
        f"{1000 * off:.3f} mm",
    )
    check("after that the mesh is not sculpted", not service("character").is_sculpted(character))
    moved = np.array(key.data[9].co) - positions(surface.data)[9]
    check("after that the mesh has its shape keys", np.allclose(moved, (0, 0, 0.1), atol=1e-5), str(moved))

    absurd = positions(surface.data) * (1, 1, 1.8)
    place(surface.data, absurd)
    before = state(character)
    message = failure(bpy.ops.anthronet.fit_selected)
    check("impossible measures of a mesh are reported", "height" in message and "Traceback" not in message, message)
    check("after that the sculpting is still there", state(character) == before)


def transferring():
    """Transfer of a user's work to the mesh of another level of detail or with other parts."""
    clean()
    character = add(sex="FEMALE", height=1.70)
    settings = character.anthronet
    surface = mesh_of(character)
    own = [bpy.data.materials.new(f"own {slot}") for slot in range(len(surface.data.materials))]
    for slot, material in enumerate(own):
        surface.data.materials[slot] = material
    pushed = positions(surface.data).copy()
    belly = _belly(pushed)
    pushed[belly, 1] -= 0.03
    place(surface.data, pushed)
    surface.vertex_groups.new(name="cloth").add([int(i) for i in np.flatnonzero(belly)], 0.75, "REPLACE")
    heat = surface.data.attributes.new("heat", "FLOAT", "POINT")
    heat.data.foreach_set("value", np.arange(len(heat.data), dtype=np.float32))
    layer = surface.data.uv_layers.new(name="second")
    layer.uv[11].vector = (0.25, 0.5)
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="smile")
    key.data[7].co.x += 0.2
    key.value = 0.5

    def check_transfer(what, exact):
        surface = mesh_of(character)
        offsets = positions(surface.data) - expected_positions(character)
        check(f"{what}: sculpting", np.isclose(offsets[:, 1].min(), -0.03, atol=1e-4), str(offsets[:, 1].min()))
        group = surface.vertex_groups.get("cloth")
        weights = [g.weight for v in surface.data.vertices for g in v.groups if group and g.group == group.index]
        check(f"{what}: a vertex group", group and np.isclose(max(weights), 0.75), f"{group}")
        values = np.empty(len(surface.data.vertices), np.float32)
        surface.data.attributes["heat"].data.foreach_get("value", values)
        check(f"{what}: an attribute", not exact or np.array_equal(values[:13000], np.arange(13000)), str(values[:3]))
        blocks = surface.data.shape_keys.key_blocks
        moved = np.array(blocks["smile"].data[7].co) - np.array(blocks[0].data[7].co)
        check(
            f"{what}: a shape key and its value",
            (not exact or np.allclose(moved, (0.2, 0, 0), atol=1e-5)) and blocks["smile"].value == 0.5,
            str(moved),
        )
        materials = [slot.material for slot in surface.material_slots]
        check(f"{what}: materials by slot", materials == own, str(materials))

    settings.accessories = False
    count = len(mesh_of(character).data.vertices)
    check("a mesh without eyes and teeth", count == len(expected_positions(character)) and settings.error == "", settings.error)
    check_transfer("without eyes and teeth", True)
    second = mesh_of(character).data.uv_layers.get("second")
    check("other UV maps are transferred within a level of detail", second and second.uv[11].vector[0] == 0.25)
    settings.lod = "0"
    check("a mesh at LOD 0", len(mesh_of(character).data.vertices) == 53_514, settings.error)
    check_transfer("at LOD 0", True)
    settings.accessories = True
    settings.lod = "1"
    check_transfer("back at LOD 1", True)
    settings.lod = "3"
    check("a mesh at LOD 3", len(mesh_of(character).data.vertices) < 5_000)
    settings.height = 1.74
    check("a measure can be changed at LOD 3", settings.error == "" and abs(settings.height - 1.74) < 1e-6, settings.error)


def together():
    clean()
    scene = bpy.context.scene
    first, second, third = add(sex="FEMALE"), add(sex="MALE", height=1.80), add(sex="MALE")
    select(first, second)
    first.anthronet.waist_circumference = 0.70
    check("a slider changes the active character only", not second.anthronet.given_waist_circumference)
    scene.anthronet_edit_together = True
    first.anthronet.waist_circumference = 0.82
    check(
        "Edit Selected Together: a slider changes all selected characters",
        abs(generated(second).measures["waist_circumference"] - 0.82) < 1e-4
        and second.anthronet.given_waist_circumference
        and abs(second.anthronet.height - 1.80) < 1e-6,
    )
    check("Edit Selected Together: no other character changes", not third.anthronet.given_waist_circumference)
    first.anthronet.given_waist_circumference = False
    check("Edit Selected Together: a measure that is not given any more", not second.anthronet.given_waist_circumference)
    scene.anthronet_edit_together = False
    for person, length in ((first, 0.31), (second, 0.34)):
        person.anthronet.arm_length_left = length
    bpy.ops.anthronet.mirror()
    check(
        "Mirror Measures changes all selected characters",
        [round(one.anthronet.arm_length_right, 4) for one in (first, second)] == [0.31, 0.34]
        and first.anthronet.given_arm_length_right
        and not first.anthronet.given_arm_length_left,
    )
    bpy.ops.anthronet.symmetrise(side="right")
    check(
        "Symmetrize Measures changes all selected characters",
        [round(one.anthronet.arm_length_left, 4) for one in (first, second)] == [0.31, 0.34],
    )
    names = module("measures").names()
    before = {name: getattr(second.anthronet, name) for name in names}
    given = [second.anthronet.is_given(name) for name in names]
    identity = list(second.anthronet.identity)
    bpy.ops.anthronet.randomise(what="IDENTITY", seed=5)
    off = max(abs(getattr(second.anthronet, name) - before[name]) for name in names)
    kept = max(abs(getattr(second.anthronet, n) - before[n]) for n, g in zip(names, given) if g)
    check(
        "Randomize Identity Only keeps the measures and which of them are given",
        list(second.anthronet.identity) != identity
        and [second.anthronet.is_given(name) for name in names] == given
        and kept < 1e-6
        and off < 0.03,
        f"given ones off by {1000 * kept:.3f} mm, all by {1000 * off:.1f} mm",
    )
    bpy.ops.anthronet.randomise(what="ALL", seed=6)
    check(
        "Randomize All gives each character its own seed", first.anthronet.seed == 6 and second.anthronet.seed == 7 and
        not first.anthronet.identity_by_hand
    )
    bpy.ops.anthronet.unset_measures()
    check("Clear All Measures", not any(one.anthronet.is_given(name) for one in (first, second) for name in names))


def tinting():
    clean()
    character = add(sex="FEMALE")
    character.anthronet.skin_tone = 8
    skin = mesh_of(character).data.materials[0]
    check("skin tone", skin.diffuse_color[0] < 0.3, str(skin.diffuse_color[:]))
    other = add(sex="MALE", skin_tone=8)
    check("characters with the same tone share a material", mesh_of(other).data.materials[0] == skin)
    skin.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9
    third = add(sex="MALE", skin_tone=8)
    check("an edited skin material is not assigned to other characters", mesh_of(third).data.materials[0] != skin)
    character.anthronet.skin_tone = 2
    error = character.anthronet.error
    check("an edited skin material is not replaced, which is reported", mesh_of(character).data.materials[0] == skin and
          "edited" in error, error)
    plain = mesh_of(add(sex="FEMALE")).data.materials
    for one in plain:
        one.diffuse_color = (1, 0, 0, 1)
    fresh = mesh_of(add(sex="FEMALE")).data.materials
    check(
        "edited materials of other parts are not assigned to other characters",
        not set(plain) & set(fresh) and len(plain) == len(fresh),
    )
    third.anthronet.skin_tone = 2
    check("an unedited skin material is replaced", mesh_of(third).data.materials[0].diffuse_color[0] > 0.5)
