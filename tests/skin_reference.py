"""The library's skinning against other programs' on the same arrays.

    python skin_reference.py FOLDER numpy|blender|usd

FOLDER is what the example `skin_dump` wrote. `numpy` is the definition in double precision; `blender` is the Armature
modifier with and without Preserve Volume; `usd` is UsdSkel. No coordinates are converted: all three only move points.
"""

import json
import sys
from pathlib import Path

import numpy as np

from glb import Cases, rotation

TOLERANCE = 1e-5  # metres, and the length of a normal; Blender keeps single precision


class Dump:
    """What the library skinned, and what it got."""

    def __init__(self, folder):
        self.folder = Path(folder)
        with open(self.folder / "skin.json", encoding="utf-8") as file:
            self.about = json.load(file)
        self.names = self.about["names"]
        self.positions, self.normals = self.vectors("positions"), self.vectors("normals")
        self.bind = self.motions("bind")

    def vectors(self, stem):
        return np.fromfile(self.folder / f"{stem}.f32", "<f4").reshape(-1, 3).astype(np.float64)

    def influences(self, width):
        """Joints and weights (vertices, width), strongest first."""
        joints = np.fromfile(self.folder / f"joints{width}.u16", "<u2").reshape(-1, width).astype(np.int64)
        weights = np.fromfile(self.folder / f"weights{width}.f32", "<f4").reshape(-1, width).astype(np.float64)
        return joints, weights

    def motions(self, stem):
        """Matrices (joints, 4, 4)."""
        numbers = np.fromfile(self.folder / f"{stem}.f32", "<f4").reshape(-1, 7).astype(np.float64)
        matrices = np.tile(np.eye(4), (len(numbers), 1, 1))
        for matrix, row in zip(matrices, numbers):
            matrix[:3, :3] = rotation(row[:4] / np.linalg.norm(row[:4]))
            matrix[:3, 3] = row[4:]
        return matrices

    def changes(self):
        """For each pose: its name, and posed · inverse bind of each joint."""
        inverse = np.linalg.inv(self.bind)
        return [(f"pose{p}", self.motions(f"pose{p}") @ inverse) for p in range(self.about["poses"])]

    def got(self, method, width, pose, what):
        return self.vectors(f"{method}_{width}_{pose}_{what}")


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def dual_quaternions(changes):
    """Real and dual parts (joints, 4) each, w first."""
    from scipy.spatial.transform import Rotation

    real = np.roll(Rotation.from_matrix(changes[:, :3, :3]).as_quat(), 1, axis=1)
    (w, v), t = (real[:, :1], real[:, 1:]), changes[:, :3, 3]
    dual = 0.5 * np.c_[-np.sum(t * v, axis=1), w * t + np.cross(t, v)]
    return real, dual


def blended(real, dual, joints, weights):
    """Unit dual quaternions of all vertices, and how surely each joint's sign was chosen."""
    sums, certain = np.zeros((2, len(joints), 4)), np.full(len(joints), np.inf)
    for k in range(joints.shape[1]):
        q, d, w = real[joints[:, k]], dual[joints[:, k]], weights[:, k : k + 1]
        agreement = np.sum(sums[0] * q, axis=1)
        if k:
            certain = np.minimum(certain, np.where(w[:, 0] > 0, np.abs(agreement), np.inf))
        w = np.where(agreement[:, None] < 0, -w, w)
        sums += np.stack([q * w, d * w])
    return *(sums / np.linalg.norm(sums[0], axis=1, keepdims=True)), certain


def turned(q, vectors):
    w, axis = q[:, :1], q[:, 1:]
    return vectors + 2 * np.cross(axis, np.cross(axis, vectors) + w * vectors)


def by_numpy(dump, cases):
    rest = dump.bind[:, :3, 3]
    for width in (4, 8):
        joints, weights = dump.influences(width)
        for pose, changes in dump.changes():
            matrices = np.einsum("vk,vkij->vij", weights, changes[joints])
            positions = np.einsum("vij,vj->vi", matrices, np.c_[dump.positions, np.ones(len(joints))])[:, :3]
            normals = unit(np.einsum("vij,vj->vi", matrices[:, :3, :3], dump.normals))
            name = f"{pose}, {width} influences"
            cases.close_to(f"linear positions, {name}", dump.got("linear", width, pose, "positions"), positions, TOLERANCE)
            cases.close_to(f"linear normals, {name}", dump.got("linear", width, pose, "normals"), normals, TOLERANCE)

            real, dual, certain = blended(*dual_quaternions(changes), joints, weights)
            (w, v), (dw, dv) = ((q[:, :1], q[:, 1:]) for q in (real, dual))
            positions = turned(real, dump.positions) + 2 * (w * dv - dw * v + np.cross(v, dv))
            sure = certain > 1e-5
            cases.case(f"signs of dual quaternions, {name}", sure.mean() > 0.999, f"{(~sure).sum()} are uncertain")
            for what, expected in (("positions", positions), ("normals", turned(real, dump.normals))):
                got = dump.got("dual_quaternion", width, pose, what)
                cases.close_to(f"dual quaternion {what}, {name}", got[sure], expected[sure], TOLERANCE)

            moved = dump.motions(pose)[:, :3, 3] - rest
            positions = dump.positions + np.einsum("vk,vki->vi", weights, moved[joints])
            got = dump.got("joint_translation", width, pose, "positions")
            cases.close_to(f"joint translation, {name}", got, positions, TOLERANCE)


def by_blender(dump, cases):
    import bpy
    from mathutils import Matrix

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    armature = bpy.data.objects.new("Armature", bpy.data.armatures.new("Armature"))
    scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name, matrix in zip(dump.names, dump.bind):
        bone = armature.data.edit_bones.new(name)
        bone.tail = (0, 0.1, 0)
        bone.matrix = Matrix(matrix)
    bpy.ops.object.mode_set(mode="OBJECT")

    for width in (4, 8):
        mesh = bpy.data.meshes.new("Body")
        mesh.from_pydata(dump.positions, [], [])
        body = bpy.data.objects.new("Body", mesh)
        scene.collection.objects.link(body)
        groups = [body.vertex_groups.new(name=name) for name in dump.names]
        joints, weights = dump.influences(width)
        # Slot by slot: Blender takes a vertex's groups in the order in which they came.
        for k in range(width):
            for v in np.flatnonzero(weights[:, k]):
                groups[joints[v, k]].add([int(v)], weights[v, k], "ADD")
        modifier = body.modifiers.new("Armature", "ARMATURE")
        modifier.object = armature
        for pose, changes in dump.changes():
            for name, change in zip(dump.names, changes):
                bone = armature.pose.bones[name]
                bone.matrix = Matrix(change) @ bone.bone.matrix_local
            real, dual = dual_quaternions(changes)
            sure = blended(real, dual, joints, weights)[2] > 1e-5
            for method, preserve in (("linear", False), ("dual_quaternion", True)):
                modifier.use_deform_preserve_volume = preserve
                bpy.context.view_layer.update()
                owner = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
                points = np.empty(3 * len(joints), np.float32)
                owner.to_mesh().vertices.foreach_get("co", points)
                owner.to_mesh_clear()
                got = dump.got(method, width, pose, "positions")
                keep = sure if preserve else slice(None)
                name = "Preserve Volume" if preserve else "Armature"
                cases.close_to(f"Blender {name}, {pose}, {width} influences", got[keep], points.reshape(-1, 3)[keep], TOLERANCE)
        bpy.data.objects.remove(body)


def by_usd(dump, cases):
    try:
        from pxr import Gf, UsdSkel, Vt
    except ImportError as why:
        print(f"skipped UsdSkel: {why}")
        return

    def array(kind, numbers):
        return kind.FromNumpy(np.ascontiguousarray(numbers))

    for width in (4, 8):
        joints, weights = dump.influences(width)
        slots = array(Vt.IntArray, joints.ravel().astype(np.int32)), array(Vt.FloatArray, weights.ravel().astype(np.float32))
        for pose, changes in dump.changes():
            # Row vectors: every matrix is transposed.
            transforms = array(Vt.Matrix4dArray, changes.transpose(0, 2, 1))
            turns = array(Vt.Matrix3dArray, changes[:, :3, :3].transpose(0, 2, 1))
            points = array(Vt.Vec3fArray, dump.positions.astype(np.float32))
            normals = array(Vt.Vec3fArray, dump.normals.astype(np.float32))
            good = UsdSkel.SkinPointsLBS(Gf.Matrix4d(1), transforms, *slots, width, points)
            good = good and UsdSkel.SkinNormalsLBS(Gf.Matrix3d(1), turns, *slots, width, normals)
            name = f"{pose}, {width} influences"
            cases.case(f"UsdSkel skins, {name}", good, "refused")
            for what, expected in (("positions", points), ("normals", normals)):
                got = dump.got("linear", width, pose, what)
                cases.close_to(f"UsdSkel {what}, {name}", got, np.array(expected), TOLERANCE)


def main(folder, program):
    cases = Cases()
    {"numpy": by_numpy, "blender": by_blender, "usd": by_usd}[program](Dump(folder), cases)
    cases.exit()


if __name__ == "__main__":
    main(*sys.argv[1:])
