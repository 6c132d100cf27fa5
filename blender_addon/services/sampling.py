# SPDX-License-Identifier: GPL-3.0-or-later
"""Sampling of the motion of armatures, frame by frame and as Blender evaluates it: actions, NLA, constraints, drivers.

The functions are generators, since this takes long: they yield the progress, 0 to 1, and return their result."""

from contextlib import contextmanager

import numpy as np

from .. import library
from . import armature, quaternions

#: Prefix of the deforming bones of a rig by Rigify.
_DEFORM_PREFIX = "DEF-"


def frames_per_second(scene):
    """The frame rate of a scene."""
    return scene.render.fps / scene.render.fps_base


def sample_clip(rig, body, scene, name, frame_start, frame_end, in_world=False):
    """The motion of a character as a clip of the library.

    The motion of the object becomes root motion: relative to the object at the first frame or, with ``in_world``, in world
    space. The scale of the object is ignored."""
    bones = armature.pose_bones(rig, body)
    index = {bone.name: i for i, bone in enumerate(rig.pose.bones)}
    order = [index[bone.name] for bone in bones]
    flat = np.empty(16 * len(rig.pose.bones), np.float32)

    def read_pose():
        rig.pose.bones.foreach_get("matrix", flat)
        return flat.reshape(-1, 4, 4).transpose(0, 2, 1)[order]

    poses, world_from_object = yield from _sample(rig, scene, frame_start, frame_end, read_pose)
    root_from_object = world_from_object if in_world else np.linalg.inv(world_from_object[0]) @ world_from_object
    parent_from_joint = poses.astype(np.float64)
    for joint, parent in enumerate(body.parents):
        if parent >= 0:
            parent_from_joint[:, joint] = np.linalg.inv(poses[:, parent].astype(np.float64)) @ poses[:, joint]
        else:
            parent_from_joint[:, joint] = root_from_object @ poses[:, joint]
    transforms = _transforms(parent_from_joint)
    return library.anthronet().Clip.from_poses(body, name, frames_per_second(scene), transforms, space="blender")


def sample_motion(ob, scene, frame_start, frame_end, name):
    """The motion of any armature object as a motion of the library, to be retargeted. Of a rig by Rigify only the deforming
    bones are sampled."""
    bones, parents = _skeleton(ob)
    rest = np.array([np.array(bone.bone.matrix_local) for bone in bones])
    poses, world_from_object = yield from _sample(
        ob, scene, frame_start, frame_end, lambda: np.array([np.array(bone.matrix) for bone in bones])
    )
    scale = np.cbrt(abs(np.linalg.det(np.array(ob.matrix_world)[:3, :3])))

    def transforms(matrices, world_from_object):
        parent_from_joint = matrices.copy()
        for joint, parent in enumerate(parents):
            if parent >= 0:
                parent_from_joint[:, joint] = np.linalg.inv(matrices[:, parent]) @ matrices[:, joint]
                parent_from_joint[:, joint, :3, 3] *= scale
            else:
                # Roots go to world space: rotated, moved and scaled with the object.
                parent_from_joint[:, joint] = world_from_object @ matrices[:, joint]
                parent_from_joint[:, joint, :3, 3] += (scale - 1) * np.einsum(
                    "fij,fj->fi", world_from_object[:, :3, :3], matrices[:, joint, :3, 3]
                )
        return _transforms(parent_from_joint)

    return library.anthronet().Motion.from_poses(
        name,
        [bone.name for bone in bones],
        parents,
        transforms(rest[None], world_from_object[:1])[0],
        transforms(poses, world_from_object),
        frames_per_second(scene),
        space="blender",
    )


def _transforms(matrices):
    """Quaternions x, y, z, w and translations (…, 7) of matrices (…, 4, 4) that may have a scale."""
    rotations = matrices[..., :3, :3] / np.linalg.norm(matrices[..., :3, :3], axis=-2, keepdims=True)
    return np.concatenate([quaternions.from_matrices(rotations), matrices[..., :3, 3]], axis=-1).astype(np.float32)


def _sample(ob, scene, frame_start, frame_end, read_pose):
    """What ``read_pose`` returns at each frame, (frames, …), and the world matrices of the object without scale,
    (frames, 4, 4). Afterwards the scene is at its earlier frame again, even after an error."""
    if frame_end < frame_start:
        raise ValueError(f"frames: expected the first before the last, got {frame_start} to {frame_end}")
    before = scene.frame_current, scene.frame_subframe
    poses, world_from_object = [], []
    with _armature_modifiers_disabled(ob):
        try:
            for frame in range(frame_start, frame_end + 1):
                scene.frame_set(frame)
                poses.append(read_pose().copy())
                matrix = np.array(ob.matrix_world)
                matrix[:3, :3] = _rotation(matrix[:3, :3])
                world_from_object.append(matrix)
                yield len(poses) / (frame_end - frame_start + 1)
        finally:
            scene.frame_set(before[0], subframe=before[1])
    return np.array(poses), np.array(world_from_object)


def _rotation(matrix):
    """The rotation of a matrix that may have a scale."""
    u, _, v = np.linalg.svd(matrix)
    return u @ v


@contextmanager
def _armature_modifiers_disabled(ob):
    """Modifiers of an armature's meshes hidden in the viewport, as evaluating the unneeded vertices takes most of the time."""
    meshes = [child for child in ob.children_recursive if child.type == "MESH"]
    modifiers = [modifier for mesh in meshes for modifier in mesh.modifiers if modifier.show_viewport]
    try:
        for modifier in modifiers:
            modifier.show_viewport = False
        yield
    finally:
        for modifier in modifiers:
            modifier.show_viewport = True


def _skeleton(ob):
    """The pose bones that have the motion of a rig, parents first, and the index of each one's parent among them or −1."""
    bones = _depth_first(ob)
    deforming = [bone for bone in bones if bone.name.startswith(_DEFORM_PREFIX)]
    kept = deforming or bones
    index = {bone.name: i for i, bone in enumerate(kept)}

    def kept_parent(bone):
        parent = bone.parent
        while parent is not None:
            # In a rig by Rigify the parent can be a mechanism bone, whose deforming bone is then taken as the parent.
            for name in (parent.name, f"{_DEFORM_PREFIX}{parent.name.partition('-')[2]}"):
                if name in index and name != bone.name:
                    return index[name]
            parent = parent.parent
        return -1

    return _parents_first(kept, [kept_parent(bone) for bone in kept])


def _depth_first(ob):
    """All pose bones in depth-first order."""
    out = []

    def visit(bone):
        out.append(bone)
        for child in bone.children:
            visit(child)

    for bone in ob.pose.bones:
        if bone.parent is None:
            visit(bone)
    return out


def _parents_first(bones, parents):
    """The bones sorted so that parents come first, and the parents' new indices."""
    order, visited = [], set()

    def visit(bone, descendants=()):
        if bone in visited or bone in descendants:
            return
        if parents[bone] >= 0:
            visit(parents[bone], (*descendants, bone))
        visited.add(bone)
        order.append(bone)

    for bone in range(len(bones)):
        visit(bone)
    new_index = {bone: i for i, bone in enumerate(order)}
    return [bones[bone] for bone in order], [new_index.get(parents[bone], -1) for bone in order]
