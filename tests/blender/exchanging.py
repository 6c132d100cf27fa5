"""Exported files, read back."""

import shutil

import bpy
import numpy as np

from blender.harness import (
    add,
    check,
    clean,
    curves,
    expected_positions,
    failure,
    generated,
    home,
    joints,
    mesh_of,
    place,
    positions,
    select,
)


def _export(name, **options):
    path = home / name
    assert bpy.ops.anthronet.character_export(filepath=str(path), **options) == {"FINISHED"}
    return path


def _read(path, body):
    """Joint positions of a file's clip, retargeted to the body that it was exported from: (frames, joints, 3)."""
    import anthronet

    motion = anthronet.open_motion(str(path))
    return motion.retarget(body, limits=False, feet=False).bake(relative="model", space="blender")[:, :, 4:]


def exporting():
    import anthronet

    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    character = add(sex="FEMALE", height=1.70)
    body = generated(character)
    bpy.ops.anthronet.clip_builtin(name="RANGE_OF_MOTION", use_scene_range=True)
    clip = anthronet.builtin_clip("range_of_motion", body).resample(30)
    for name in ("out.glb", "out.usdc"):
        path = _export(name)
        back = anthronet.open_motion(str(path))
        check(f"{name} has the motion", back.clip_names and path.stat().st_size > 100_000, str(back.clip_names))
    off = np.abs(_read(home / "out.glb", body) - clip.bake(relative="model", space="blender")[:, :, 4:]).max()
    check("the exported motion is the scene's", off < 2e-3, f"{1000 * off:.2f} mm")

    scene.frame_end = 5
    for extension, start in ((".usdc", b"PXR-USDC"), (".usda", b"#usda"), (".vrm", b"glTF"), (".obj", None)):
        path = _export(f"by_extension{extension}")
        check(f"the extension of a script's path is the format: {extension}", start is None or path.read_bytes().startswith(start))
    check("a format decides on the extension", _export("plain", format=".glb") and (home / "plain.glb").exists())
    check("without format and extension it is glTF", _export("bare") and (home / "bare.glb").exists())
    scene.frame_set(5)
    message = failure(lambda: bpy.ops.anthronet.character_export(filepath="/nowhere/a.glb"))
    check("after a failed export the scene is at its earlier frame", message and scene.frame_current == 5, message)
    _reading_back(character)
    posing(character)


def _reading_back(character):
    """The files, read by Blender's own importers."""
    expected = expected_positions(character)
    shutil.copy(home / "by_extension.vrm", home / "vrm.glb")
    # The USD of Blender 4.2 is older than the binary files of today's; it reads text.
    usd = "out.usdc" if bpy.app.version >= (4, 5, 0) else "by_extension.usda"
    importers = {
        usd: bpy.ops.wm.usd_import,
        "vrm.glb": bpy.ops.import_scene.gltf,
        "by_extension.obj": bpy.ops.wm.obj_import,
    }
    if bpy.app.version < (4, 5, 0):
        del importers["vrm.glb"]
        print("skipped vrm.glb in Blender: the importer of 4.2 as a module may crash after others have run")
    for name, work in importers.items():
        before = set(bpy.data.objects)
        work(filepath=str(home / name))
        bpy.context.view_layer.update()
        made = sorted(set(bpy.data.objects) - before, key=lambda ob: ob.name)
        meshes = [ob for ob in made if ob.type == "MESH" and ob.name != "Icosphere"]
        vertices = sum(len(ob.data.vertices) for ob in meshes)
        check(f"{name} in Blender: its vertices", vertices >= 0.9 * len(expected), f"{vertices} of {len(expected)}")
        biggest = max(meshes, key=lambda ob: len(ob.data.vertices))
        there = positions(biggest.data) @ np.array(biggest.matrix_world)[:3, :3].T
        sizes = np.ptp(there, axis=0), np.ptp(expected, axis=0)
        check(f"{name} in Blender: its size", np.allclose(*sizes, atol=2e-3), str(sizes))
        rigs = [ob for ob in made if ob.type == "ARMATURE"]
        if name != "by_extension.obj":
            check(f"{name} in Blender: its bones", rigs and len(rigs[0].data.bones) >= 60, str(rigs))
        if name == usd:
            action = rigs[0].animation_data.action if rigs and rigs[0].animation_data else None
            check(f"{name} in Blender: its motion", action and len(curves(action)) > 100, str(action))
        for ob in made:
            bpy.data.objects.remove(ob)
    select(character)


def posing(character):
    """Export of a pose, of motion by constraints, of motion of the object."""
    scene, body = bpy.context.scene, generated(character)
    character.animation_data_clear()
    scene.frame_start, scene.frame_end = 1, 12
    for bone in character.pose.bones:
        bone.location, bone.rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)
    import anthronet

    rest = _export("rest.glb")
    check("a rest pose is exported without motion", _has_no_motion(rest), str(rest))
    bone = character.pose.bones["forearm.L"]
    bone.rotation_quaternion = (0.9, 0.43589, 0, 0)
    there = joints(character, body)
    read = _read(_export("pose.glb"), body)
    off = np.abs(read[0] - there).max()
    check("a pose without an action is exported", len(read) == 1 and off < 2e-3, f"{1000 * off:.2f} mm")
    check("a pose in USD, too", anthronet.open_motion(str(_export("pose.usda"))).clip_names == ("Pose",))

    target = bpy.data.objects.new("target", None)
    bpy.context.collection.objects.link(target)
    for frame, goal in ((1, (-2, 0, 1.4)), (12, (-1, -2, 0.5))):
        target.location = goal
        target.keyframe_insert("location", frame=frame)
    character.pose.bones["upper_arm.R"].constraints.new("DAMPED_TRACK").target = target
    poses = []
    for frame in range(1, 13):
        scene.frame_set(frame)
        poses.append(joints(character, body))
    read = _read(_export("constraint.glb"), body)
    off = np.abs(read - np.array(poses)).max()
    distance = np.ptp(poses, axis=0).max()
    check("motion of constraints is exported", distance > 0.1 and off < 2e-3, f"{1000 * off:.2f} mm of {distance:.2f} m")

    character.location = (2, 3, 0)
    character.keyframe_insert("location", frame=1)
    character.location = (2, 2, 0)
    character.keyframe_insert("location", frame=12)
    hips = list(body.joint_names()).index("pelvis")
    path = _read(_export("root_motion.glb"), body)[:, hips]
    step = path[-1] - path[0]
    check("motion of the object is exported as root motion", np.allclose(step, (0, -1, 0), atol=2e-3), str(step))
    check("root motion is relative to the first frame", np.abs(path[0][:2]).max() < 0.2, str(path[0]))
    placed = _read(_export("placed.glb", use_world=True), body)[:, hips]
    check("or in world space", np.allclose(placed - path, (2, 3, 0), atol=2e-3), str(placed[0] - path[0]))

    surface = mesh_of(character)
    moved = positions(surface.data).copy()
    moved[3] += 0.1
    place(surface.data, moved)
    check("a character with a sculpted mesh is exported", _export("sculpted.obj").exists())


def _has_no_motion(path):
    """Whether a file has no motion."""
    import anthronet

    try:
        return anthronet.open_motion(str(path)).clip_names == ()
    except anthronet.Error as error:
        return "animation" in str(error) or "motion" in str(error) or "clip" in str(error)
