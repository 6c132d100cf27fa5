# SPDX-License-Identifier: GPL-3.0-or-later
"""Between the library's clips and Blender's actions."""

import bpy
import numpy as np

from .. import compat, library
from . import rig

_LINEAR = 1


def from_clip(owner, body, clip, frame_start, frames_per_second):
    """Bakes a clip to a new action that a character plays: keys at the clip's own frames, in the scene's time."""
    bones = rig.joint_order(owner, body)
    baked = clip.bake(relative="parent", space="blender")
    frames = len(baked)
    times = frame_start + np.arange(frames) * (frames_per_second / clip.frames_per_second)
    action = bpy.data.actions.new(clip.name)
    action["anthronet_clip"] = clip.name
    new_curve = compat.new_curves(action, owner)
    rest = rig.rest_matrices(bones)
    for joint, bone in enumerate(bones):
        rotation, translation = _basis(rest[joint], baked[:, joint])
        path = bone.path_from_id()
        for axis in range(4):
            _keys(new_curve(f"{path}.rotation_quaternion", axis, bone.name), times, rotation[:, axis])
        if np.abs(translation).max() > 1e-7:
            for axis in range(3):
                _keys(new_curve(f"{path}.location", axis, bone.name), times, translation[:, axis])
    compat.assign(owner, action)
    return action


def to_clip(owner, body, scene, name, frame_start, frame_end):
    """The character's motion over the scene's frames, as Blender evaluates it: actions, NLA, constraints, drivers."""
    bones = rig.joint_order(owner, body)
    parents = list(body.parents)
    poses = np.empty((frame_end - frame_start + 1, len(bones), 4, 4), np.float32)
    flat = np.empty(16 * len(owner.pose.bones), np.float32)
    index = {bone.name: i for i, bone in enumerate(owner.pose.bones)}
    order = [index[bone.name] for bone in bones]
    before = scene.frame_current, scene.frame_subframe
    with _without_deformation(owner):
        for row, frame in enumerate(range(frame_start, frame_end + 1)):
            scene.frame_set(frame)
            owner.pose.bones.foreach_get("matrix", flat)
            poses[row] = flat.reshape(-1, 4, 4).transpose(0, 2, 1)[order]
        scene.frame_set(before[0], subframe=before[1])
    locals_ = poses.copy()
    for joint, parent in enumerate(parents):
        if parent >= 0:
            locals_[:, joint] = np.linalg.inv(poses[:, parent]) @ poses[:, joint]
    transforms = np.concatenate([quaternions(locals_[..., :3, :3]), locals_[..., :3, 3]], axis=-1)
    rate = scene.render.fps / scene.render.fps_base
    return library.anthronet().Clip.from_poses(body, name, rate, transforms.astype(np.float32), space="blender")


def motion_of(armature_object, scene, frame_start, frame_end):
    """The motion of any armature over the scene's frames, to be retargeted."""
    bones = _parents_first(armature_object)
    index = {bone.name: i for i, bone in enumerate(bones)}
    parents = [index[bone.parent.name] if bone.parent else -1 for bone in bones]
    world = np.array(armature_object.matrix_world)
    scale = np.cbrt(abs(np.linalg.det(world[:3, :3])))
    turn = world[:3, :3] / scale

    def transforms(matrices):
        # To the world: roots take the object's turn and place, lengths its scale.
        locals_ = matrices.copy()
        for joint, parent in enumerate(parents):
            if parent >= 0:
                locals_[:, joint] = np.linalg.inv(matrices[:, parent]) @ matrices[:, joint]
            else:
                locals_[:, joint, :3, :3] = turn @ matrices[:, joint, :3, :3]
                locals_[:, joint, :3, 3] = matrices[:, joint, :3, 3] @ turn.T + world[:3, 3] / scale
        locals_[..., :3, 3] *= scale
        rotation = locals_[..., :3, :3] / np.linalg.norm(locals_[..., :3, :3], axis=-2, keepdims=True)
        return np.concatenate([quaternions(rotation), locals_[..., :3, 3]], axis=-1).astype(np.float32)

    rest = transforms(np.array([[np.array(bone.bone.matrix_local) for bone in bones]]))[0]
    frames = np.empty((frame_end - frame_start + 1, len(bones), 4, 4))
    before = scene.frame_current, scene.frame_subframe
    with _without_deformation(armature_object):
        for row, frame in enumerate(range(frame_start, frame_end + 1)):
            scene.frame_set(frame)
            frames[row] = [np.array(bone.matrix) for bone in bones]
        scene.frame_set(before[0], subframe=before[1])
    package = library.anthronet()
    action = armature_object.animation_data.action if armature_object.animation_data else None
    name = action.name if action else armature_object.name
    rate = scene.render.fps / scene.render.fps_base
    return package.Motion.from_poses(
        name, [bone.name for bone in bones], parents, rest, transforms(frames), rate, space="blender"
    )


def quaternions(rotations):
    """Unit quaternions x, y, z, w of rotation matrices (…, 3, 3); the branch with the largest divisor for each."""
    m = rotations
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz], axis=-1)
    a, b, c = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    d, e, f = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    candidates = np.stack(
        [
            np.stack([squares[..., 0], d, e, a], axis=-1),
            np.stack([d, squares[..., 1], f, b], axis=-1),
            np.stack([e, f, squares[..., 2], c], axis=-1),
            np.stack([a, b, c, squares[..., 3]], axis=-1),
        ],
        axis=-2,
    )
    best = squares.argmax(axis=-1)[..., None, None]
    chosen = np.take_along_axis(candidates, best, axis=-2)[..., 0, :]
    return chosen / np.linalg.norm(chosen, axis=-1, keepdims=True)


def _basis(rest, transforms):
    """From joints relative to their parents (x, y, z, w, then translation) to what a pose bone holds: w, x, y, z and the way
    in its rest space."""
    q = quaternions(rest[None, :3, :3])[0] * np.array([-1, -1, -1, 1])
    rotation = _product(np.broadcast_to(q, (len(transforms), 4)), transforms[:, :4].astype(np.float64))
    # Signs as of the frame before, so that curves do not jump.
    flips = np.sign(np.einsum("ij,ij->i", rotation[1:], rotation[:-1]))
    rotation[1:] *= np.cumprod(np.where(flips < 0, -1.0, 1.0))[:, None]
    translation = (transforms[:, 4:] - rest[:3, 3]) @ rest[:3, :3]
    return rotation[:, [3, 0, 1, 2]], translation


def _product(p, q):
    px, py, pz, pw = p.T
    qx, qy, qz, qw = q.T
    return np.stack(
        [
            pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
            pw * qw - px * qx - py * qy - pz * qz,
        ],
        axis=1,
    )


def _keys(curve, times, values):
    points = curve.keyframe_points
    points.add(len(times))
    points.foreach_set("co", np.stack([times, values], axis=1).astype(np.float32).reshape(-1))
    points.foreach_set("interpolation", np.full(len(times), _LINEAR, np.int32))
    curve.update()


def _parents_first(armature_object):
    out = []

    def visit(bone):
        out.append(bone)
        for child in bone.children:
            visit(child)

    for bone in armature_object.pose.bones:
        if bone.parent is None:
            visit(bone)
    return out


class _without_deformation:
    """Armature modifiers of an object's meshes off: their vertices are not needed, and cost most of a frame."""

    def __init__(self, armature_object):
        meshes = [ob for ob in armature_object.children_recursive if ob.type == "MESH"]
        self._modifiers = [m for ob in meshes for m in ob.modifiers if m.show_viewport]

    def __enter__(self):
        for modifier in self._modifiers:
            modifier.show_viewport = False

    def __exit__(self, *_):
        for modifier in self._modifiers:
            modifier.show_viewport = True
