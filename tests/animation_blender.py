"""Blender imports a .glb, plays its clips as actions and agrees with FILE.animated.f64 on every vertex at its frames.

    python animation_blender.py FILE.glb

Run animation_reference.py on the file first.
"""

import json
import sys

import bpy
import numpy as np

from glb import Cases, Glb

TOLERANCE = 1e-5  # metres; Blender keeps single precision
# Blender's axes: +Z up, the character looks along -Y. glTF's: +Y up, it looks along +Z.
BLENDER_FROM_GLTF = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)


def evaluated(thing):
    """Positions (vertices, 3) in world space after all modifiers."""
    owner = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = owner.to_mesh()
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    owner.to_mesh_clear()
    world = np.array(thing.matrix_world)
    return points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]


def curves(action):
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                yield from bag.fcurves


def play(cases, path, glb, clip, expected):
    """Imports the file at the clip's rate, so that its keys land on whole frames."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.render.fps_base = round(clip["rate"]), round(clip["rate"]) / clip["rate"]
    bpy.ops.import_scene.gltf(filepath=path)
    name = clip["name"]
    armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
    found = [a for a in bpy.data.actions if a.name == name or a.name.startswith(f"{name}_")]
    cases.case(f"Blender: {name} is an action", len(found) == 1, f"{[a.name for a in bpy.data.actions]}")
    if len(found) != 1:
        return
    action = found[0]
    data = armature.animation_data
    for track in data.nla_tracks:
        track.mute = True
    # The importer leaves the pose of the first clip; what another clip has no channels for is at rest in it.
    for bone in armature.pose.bones:
        bone.matrix_basis.identity()
    data.action = action
    data.action_slot = action.slots[0]
    keys = np.concatenate([[k.co[0] for k in curve.keyframe_points] for curve in curves(action)])
    off = float(np.abs(keys - keys.round()).max())
    # Blender keeps frames in single precision.
    cases.case(f"Blender: {name} has its keys on whole frames", off <= 1e-3, f"off by {off} frames")
    first, last = keys.min().round(), keys.max().round()
    frames = clip["frames"]
    cases.case(f"Blender: {name} lasts {frames} frames", last - first + 1 == frames, f"{first} to {last}")

    meshes = {o.name: o for o in bpy.data.objects if any(m.type == "ARMATURE" for m in o.modifiers)}
    worst = 0.0
    for frame, all_points in zip(clip["taken"], expected):
        scene.frame_set(int(first) + frame)
        start = 0
        for node in glb.skinned_nodes():
            used, count = [], 0
            for primitive in glb.primitives(node):
                # The importer keeps the vertices that a triangle uses, in their order.
                used.append(np.unique(glb.triangles(primitive)) + count)
                count += len(glb.positions(primitive))
            goal = all_points[start : start + count][np.concatenate(used)] @ BLENDER_FROM_GLTF.T
            points = evaluated(meshes[glb.nodes[node]["name"]])
            worst = max(worst, float(np.abs(points - goal).max()) if points.shape == goal.shape else np.inf)
            start += count
    cases.case(f"Blender: {name} at frames {clip['taken']} (largest difference {worst * 1000:.6f} mm)",
               worst <= TOLERANCE, f"{worst * 1000} mm, at most {TOLERANCE * 1000} mm expected")


def main(path):
    cases, glb = Cases(), Glb(path)
    with open(f"{path}.animated.json", encoding="utf-8") as file:
        clips = json.load(file)
    frames = sum(len(clip["taken"]) for clip in clips)
    expected = np.fromfile(f"{path}.animated.f64", "<f8").reshape(frames, -1, 3)
    for clip in clips:
        taken = len(clip["taken"])
        play(cases, path, glb, clip, expected[:taken])
        expected = expected[taken:]
    cases.exit()


main(sys.argv[1])
