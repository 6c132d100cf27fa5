"""Blender imports a .glb: armature, bones, weights, mesh, pose; and a picture to look at.

    python blender_import.py FILE.glb [PICTURE.png]

Run pose_reference.py on the file first.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from glb import Cases, Glb

TOLERANCE = 1e-5  # metres; Blender keeps single precision
# Blender's axes: +Z up, the character looks along -Y. glTF's: +Y up, it looks along +Z.
BLENDER_FROM_GLTF = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)


def to_blender(points):
    return points @ BLENDER_FROM_GLTF[:3, :3].T


def evaluated(thing):
    """Positions (vertices, 3) in world space after all modifiers."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    owner = thing.evaluated_get(depsgraph)
    mesh = owner.to_mesh()
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    owner.to_mesh_clear()
    world = np.array(thing.matrix_world)
    return points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]


def render(path):
    """Front view of the T-pose by Cycles on the processor: no graphics hardware asked for."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 8
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 640, 640
    scene.render.film_transparent = False
    scene.world = bpy.data.worlds.new("sky")
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.6, 0.6, 0.6, 1)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler = (np.radians(50), 0, np.radians(-30))
    sun.data.energy = 2
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.2
    camera.location, camera.rotation_euler = (0, -5, 0.95), (np.radians(90), 0, 0)
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main(path, picture=None):
    cases, glb = Cases(), Glb(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)

    armatures = [o for o in bpy.data.objects if o.type == "ARMATURE"]
    cases.case("Blender: one armature", len(armatures) == 1, f"{len(armatures)} armatures")
    if not armatures:
        cases.exit()
    armature = armatures[0]
    unit = np.array(armature.matrix_world)
    cases.close_to("Blender: the armature has no transform of its own", unit, np.eye(4), 1e-7)

    nodes = glb.skinned_nodes()
    joints, joint_from_bind = glb.skin(nodes[0])
    names = [glb.nodes[j]["name"] for j in joints]
    bones = armature.data.bones
    cases.case("Blender: bones are the rig's joints", sorted(b.name for b in bones) == sorted(names),
               sorted(set(names) ^ {b.name for b in bones}))
    heads = to_blender(np.linalg.inv(joint_from_bind)[:, :3, 3])
    known = [(i, n) for i, n in enumerate(names) if n in bones]
    cases.close_to("Blender: bone heads", [bones[n].head_local for _, n in known], heads[[i for i, _ in known]], TOLERANCE)

    # The importer adds a sphere to draw bones with; ours are those that the armature moves.
    meshes = {o.name: o for o in bpy.data.objects if any(m.type == "ARMATURE" for m in o.modifiers)}
    cases.case("Blender: all skinned meshes", len(meshes) == len(nodes), f"{sorted(meshes)} for {len(nodes)} nodes")
    expected = np.fromfile(f"{path}.posed.f64", "<f8").reshape(-1, 3)
    with open(f"{path}.posed.json", encoding="utf-8") as file:
        pose = json.load(file)

    start, pairs = 0, []
    for node in nodes:
        parts, used, first = [], [], start
        for primitive in glb.primitives(node):
            points = glb.positions(primitive)
            parts.append(points)
            # The importer keeps the vertices that a triangle uses, in their order.
            used.append(np.unique(glb.triangles(primitive)) + start)
            start += len(points)
        used = np.concatenate(used)
        name = glb.nodes[node]["name"]
        thing = meshes.get(name)
        cases.case(f"Blender: mesh {name}", thing is not None, f"not among {sorted(meshes)}")
        if thing is None:
            continue
        rest = to_blender(np.vstack(parts)[used - first])
        cases.close_to(f"Blender: positions of {name}", evaluated(thing), rest, TOLERANCE)
        pairs.append((name, thing, to_blender(expected[used])))

        width = max(glb.influences(p)[1].shape[1] for p in glb.primitives(node))
        groups = [[g.weight for g in v.groups if g.weight > 0] for v in thing.data.vertices]
        most, off = max(map(len, groups)), max(abs(sum(g) - 1) for g in groups)
        cases.case(f"Blender: {name} has at most {width} groups a vertex (most: {most})", most <= width)
        cases.case(f"Blender: weights of {name} sum to 1", off <= 1e-5, f"off by {off}")

    if pairs:
        body = evaluated(pairs[0][1])
        height = float(body[:, 2].max() - body[:, 2].min())
        cases.case(f"Blender: a grown-up stands on the floor, {height:.4f} m tall",
                   1.3 < height < 2.2 and abs(body[:, 2].min()) < 1e-3, f"lowest {body[:, 2].min()} m")
    if picture:
        render(str(Path(picture).resolve()))

    # Parents first, so that each bone's pose lies on its parent's.
    for name in names:
        if name in bones:
            change = BLENDER_FROM_GLTF @ np.array(pose["change"][name]) @ BLENDER_FROM_GLTF.T
            armature.pose.bones[name].matrix = Matrix(change) @ bones[name].matrix_local
            bpy.context.view_layer.update()
    for name, thing, goal in pairs:
        cases.close_to(f"Blender: {name} posed", evaluated(thing), goal, TOLERANCE)
    cases.exit()


if __name__ == "__main__":
    main(*sys.argv[1:])
