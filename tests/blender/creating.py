"""Installing the extension and making characters."""

import bpy
import numpy as np

from blender.harness import (
    NAME,
    add,
    archive,
    check,
    clean,
    failure,
    generated,
    home,
    mesh_of,
    milliseconds,
    module,
    people,
    positions,
    service,
    speed,
)


def installing():
    result = bpy.ops.extensions.package_install_files(
        filepath=str(archive), repo="user_default", enable_on_install=True
    )
    check("the zip installs and is enabled", result == {"FINISHED"} and NAME in bpy.context.preferences.addons)
    import anthronet

    check("the library comes from the extension's own wheel", str(home) in anthronet.__file__, anthronet.__file__)


def creating():
    clean()
    first = milliseconds(lambda _: add(sex="FEMALE", height=1.70, waist_circumference=0.72))
    print(f"first character, with its template: {first:.1f} ms")
    character = bpy.context.object
    surface = mesh_of(character)
    body = generated(character)
    speed("character at LOD 1", milliseconds(lambda i: add(sex="MALE", height=1.80, seed=i), 7), 60)
    add(sex="MALE", lod="0")
    speed("character at LOD 0", milliseconds(lambda i: add(sex="MALE", height=1.80, seed=i, lod="0"), 5), 150)

    check("a character is an armature with a mesh as its child", character.type == "ARMATURE" and surface.type == "MESH")
    check("the request has the typed numbers", generated(character).report and '"height":1.7,' in
          character.anthronet.request().to_json().replace(" ", ""), character.anthronet.request().to_json())
    bpy.context.view_layer.objects.active = character
    bpy.ops.anthronet.measure_selected()
    measures = character["anthronet_measured"]
    off = max(abs(measures["height"] - 1.70), abs(measures["waist_circumference"] - 0.72))
    check("the mesh has the given measures within 0.1 mm", off < 1e-4, f"{1000 * off:.4f} mm")

    mesh = body.mesh(lod=1, influences=8, space="blender", layout="model")
    expected = np.concatenate([part.positions for part in mesh.parts])
    check("vertices are exactly those of the library", np.array_equal(positions(surface.data), expected))
    groups = [group.name for group in surface.vertex_groups]
    check("a vertex group for each bone", tuple(groups) == tuple(body.joint_names("blender")))
    check("weights are exactly those of the library", _weights(surface) == _expected_weights(mesh))

    rest = np.array([np.array(character.data.bones[name].matrix_local) for name in body.joint_names("blender")])
    off = np.abs(rest - body.joints("blender")["model_from_joint"]).max()
    check("bones are at the joints", off < 1e-5, f"{off:.1e}")
    left, right = (character.data.bones[f"hand.{side}"].head_local for side in "LR")
    check("the left hand is at +X, the face looks along -Y", left.x > 0 > right.x)
    bone, child = character.data.bones["upper_arm.L"], character.data.bones["forearm.L"]
    check(
        "the tail of a bone is at its child",
        (bone.tail_local - child.head_local).length < 0.02,
        f"{(bone.tail_local - child.head_local).length:.4f} m",
    )
    check(
        "the root bone does not deform", not character.data.bones[body.joint_names("blender")[0]].use_deform
    )
    names = {collection.name for collection in character.data.collections}
    check("bone collections", names == {"Torso", "Arms", "Legs", "Fingers", "Face", "Twist"}, str(names))
    check("the map to Unity's humanoid", character.data["anthronet_humanoid"]["upperarm_l"] == "LeftUpperArm")
    uv = np.empty(2 * len(surface.data.loops), np.float32)
    surface.data.uv_layers[0].uv.foreach_get("vector", uv)
    check("the UV map is in the unit square", 0 <= uv.min() and uv.max() <= 1 and np.ptp(uv) > 0.5)
    bending(character)


def _weights(surface):
    return [
        {group.group: group.weight for group in vertex.groups} for vertex in surface.data.vertices
    ]


def _expected_weights(mesh):
    return [
        {int(joint): float(weight) for joint, weight in zip(joints, weights) if weight > 0}
        for part in mesh.parts
        for joints, weights in zip(part.joints, part.weights)
    ]


def bending(character):
    """Elbows and knees bend about the X axes of their bones, symmetrically."""
    for name, child, angle, across, forward in (
        # In the T-pose an elbow bends in the horizontal plane, forwards; a knee in the sagittal one, backwards.
        ("forearm", "hand", 0.8, 2, -1),
        ("shin", "foot", -0.8, 0, +1),
    ):
        offsets = {}
        for side in "LR":
            bone = character.pose.bones[f"{name}.{side}"]
            bpy.context.view_layer.update()
            before = character.pose.bones[f"{child}.{side}"].head.copy()
            bone.rotation_mode, bone.rotation_euler = "XYZ", (angle, 0, 0)
            bpy.context.view_layer.update()
            offset = character.pose.bones[f"{child}.{side}"].head - before
            bone.rotation_euler, bone.rotation_mode = (0, 0, 0), "QUATERNION"
            offsets[side] = np.array(offset)
        left, right = offsets["L"], offsets["R"] * (-1, 1, 1)
        off = np.linalg.norm(left - right)
        check(f"{name}s bend about X symmetrically", off < 0.005, f"{offsets}")
        check(
            f"{name}s bend in the anatomical plane and direction",
            abs(left[across]) < 0.15 * np.linalg.norm(left) and np.sign(left[1]) == forward,
            f"{offsets}",
        )


def crowding():
    clean()
    took = milliseconds(lambda _: bpy.ops.anthronet.crowd_add(count=100))
    speed("100 characters at LOD 1", took, 10_000)
    crowd = people()
    heights = {round(ob.anthronet.height, 4) for ob in crowd}
    check(
        "a crowd has different people", len(crowd) == 100 and len(heights) > 90, f"{len(crowd)}, {len(heights)} heights"
    )

    def update(step):
        crowd[50].anthronet.waist_circumference = 0.80 + 0.002 * step
        bpy.context.view_layer.update()

    milliseconds(update, 2)
    # Slower than with one character: Blender rebuilds the dependency graph of the scene whenever bones change.
    speed("slider update at LOD 1 with 100 characters", milliseconds(update, 5), 100)
    for thing in crowd[3:6]:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = crowd[3]
    crowd[3].anthronet.height = 1.77
    bpy.ops.anthronet.copy_request()
    alike = {round(ob.anthronet.height, 4) for ob in crowd[3:6]}
    check("Copy to Selected copies the request", alike == {1.77}, str(alike))
    check("and only to selected characters", crowd[3].anthronet.error == "" and crowd[7].anthronet.height != 1.77)
    crowd[0].select_set(False)
    last = failure(lambda: bpy.ops.anthronet.crowd_add(count=2, seed=2**31 - 1))
    check("seeds of a crowd wrap around after the largest one", last == "" and len(people()) == 102, last)


def unitising():
    """Lengths and masses as text, in the units of the scene."""
    clean()
    scene, units = bpy.context.scene, module("units")
    settings = scene.unit_settings
    texts = {}
    for system, scale in (("METRIC", 1.0), ("IMPERIAL", 1.0), ("NONE", 1.0), ("METRIC", 0.1)):
        settings.system, settings.scale_length = system, scale
        texts[system, scale] = units.length(scene, 1.70), units.length_difference(scene, 0.0004), units.mass(scene, 70.0)
    check("metres", texts["METRIC", 1.0] == ("1.7 m", "+0.40 mm", "70.0 kg"), str(texts))
    check("feet and pounds", "'" in texts["IMPERIAL", 1.0][0] and
          texts["IMPERIAL", 1.0][1:] == ("+0.0157 in", "154.3 lb"), str(texts))
    check("no unit", texts["NONE", 1.0][0] == "1.7000", str(texts))
    check("lengths are multiplied by the Unit Scale", texts["METRIC", 0.1][0] in ("0.17 m", "17 cm"), str(texts))
    assert service("character").active(bpy.context) is None
