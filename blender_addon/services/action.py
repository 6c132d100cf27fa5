# SPDX-License-Identifier: GPL-3.0-or-later
"""Between the library's clips and Blender's actions.

What takes long is a generator that yields how far it is, 0 to 1, and returns its result."""

import json

import bpy
import numpy as np

from .. import compat, library
from . import rig

_LINEAR = 1
#: On actions: the clip's name, what it was made of, and the request of the body that it was made for.
CLIP, _SOURCE, _BODY = "anthronet_clip", "anthronet_source", "anthronet_request"


def from_clip(owner, body, clip, frame_start, frames_per_second, source, into=None):
    """The action of a clip: keys at the clip's own frames, in the scene's time. It is not played yet.

    ``source`` is what the clip can be made of again (:mod:`motion`), ``into`` an action whose keys are replaced."""
    bones = rig.joint_order(owner, body)
    baked = clip.bake(relative="parent", space="blender")
    times = frame_start + np.arange(len(baked)) * (frames_per_second / clip.frames_per_second)
    action = into or bpy.data.actions.new(clip.name)
    action[CLIP] = clip.name
    action[_SOURCE] = json.dumps(source, sort_keys=True)
    action[_BODY] = _request_text(owner)
    new_curve = compat.new_curves(action, owner.name)
    rest = rig.rest_matrices(bones)
    for joint, bone in enumerate(bones):
        rotation, translation = _basis(rest[joint], baked[:, joint])
        path = bone.path_from_id()
        for axis in range(4):
            _keys(new_curve(f"{path}.rotation_quaternion", axis, bone.name), times, rotation[:, axis])
        if np.abs(translation).max() > 1e-7:
            for axis in range(3):
                _keys(new_curve(f"{path}.location", axis, bone.name), times, translation[:, axis])
    return action


def play(owner, body, action, as_strip_from=None):
    """Lets a character play an action, or puts it on a track from a frame on. What was played before stays in the file: as a
    strip below the new one, or as an action with a user."""
    # What the action does not key must not stay as an earlier one left it.
    for bone in rig.joint_order(owner, body):
        bone.rotation_mode = "QUATERNION"
        bone.location, bone.rotation_quaternion, bone.scale = (0, 0, 0), (1, 0, 0, 0), (1, 1, 1)
    before, _ = compat.played(owner)
    if as_strip_from is not None:
        compat.push_down(owner)
        compat.add_strip(owner, action, as_strip_from)
        return
    compat.assign(owner, action)
    if before is not None and before.users == 0 and CLIP not in before:
        before.use_fake_user = True


def source_of(action):
    """What an action was made of; None for one that the extension did not make."""
    return json.loads(action[_SOURCE]) if action is not None and _SOURCE in action else None


def of(owner):
    """The actions of the extension's that a character plays, on tracks or directly."""
    if owner.animation_data is None:
        return []
    played = [owner.animation_data.action]
    played += [strip.action for track in owner.animation_data.nla_tracks for strip in track.strips]
    return list(dict.fromkeys(action for action in played if action is not None and _SOURCE in action))


def is_of_another_body(owner):
    """Whether a character plays an action that was made before its measures changed."""
    return any(action.get(_BODY) != _request_text(owner) for action in of(owner))


def own(owner, action):
    """The action for one character alone: a copy where others play it, too."""
    animation = owner.animation_data
    uses = [strip for track in animation.nla_tracks for strip in track.strips if strip.action == action]
    mine = len(uses) + (animation.action == action)
    if action.users - action.use_fake_user <= mine:
        return action
    copy = action.copy()
    if animation.action == action:
        compat.assign(owner, copy)
    for strip in uses:
        strip.action = copy
        slot = compat.object_slot(copy)
        if slot is not None:
            strip.action_slot = slot
    return copy


def _request_text(owner):
    return json.dumps(owner.anthronet.request_fields(), sort_keys=True)


def to_clip(owner, body, scene, name, frame_start, frame_end, in_world=False):
    """The character's motion over the scene's frames, as Blender evaluates it: actions, NLA, constraints, drivers, and the
    way of its object, from where that is at the first frame or, ``in_world``, from the scene's origin. The object's scale
    is left out. A generator."""
    bones = rig.joint_order(owner, body)
    index = {bone.name: i for i, bone in enumerate(owner.pose.bones)}
    order = [index[bone.name] for bone in bones]
    flat = np.empty(16 * len(owner.pose.bones), np.float32)

    def pose():
        owner.pose.bones.foreach_get("matrix", flat)
        return flat.reshape(-1, 4, 4).transpose(0, 2, 1)[order]

    poses, worlds = yield from _frames(owner, scene, frame_start, frame_end, pose)
    # The way of the object goes to the joints without a parent.
    places = worlds if in_world else np.linalg.inv(worlds[0]) @ worlds
    locals_ = poses.astype(np.float64)
    for joint, parent in enumerate(body.parents):
        if parent >= 0:
            locals_[:, joint] = np.linalg.inv(poses[:, parent].astype(np.float64)) @ poses[:, joint]
        else:
            locals_[:, joint] = places @ poses[:, joint]
    rotation = locals_[..., :3, :3] / np.linalg.norm(locals_[..., :3, :3], axis=-2, keepdims=True)
    transforms = np.concatenate([quaternions(rotation), locals_[..., :3, 3]], axis=-1)
    rate = scene.render.fps / scene.render.fps_base
    return library.anthronet().Clip.from_poses(body, name, rate, transforms.astype(np.float32), space="blender")


def motion_of(armature_object, scene, frame_start, frame_end, name):
    """The motion of any armature over the scene's frames, to be retargeted. Of a rig with deforming bones of its own (Rigify's
    ``DEF-``) these alone. A generator."""
    bones, parents = _skeleton(armature_object)
    rest = np.array([np.array(bone.bone.matrix_local) for bone in bones])
    poses, worlds = yield from _frames(
        armature_object, scene, frame_start, frame_end, lambda: np.array([np.array(bone.matrix) for bone in bones])
    )
    scale = np.cbrt(abs(np.linalg.det(np.array(armature_object.matrix_world)[:3, :3])))

    def transforms(matrices, places):
        locals_ = matrices.copy()
        for joint, parent in enumerate(parents):
            if parent >= 0:
                locals_[:, joint] = np.linalg.inv(matrices[:, parent]) @ matrices[:, joint]
                locals_[:, joint, :3, 3] *= scale
            else:
                # To the world: roots take the object's turn and place, lengths its scale.
                locals_[:, joint] = places @ matrices[:, joint]
                locals_[:, joint, :3, 3] += (scale - 1) * np.einsum(
                    "fij,fj->fi", places[:, :3, :3], matrices[:, joint, :3, 3]
                )
        rotation = locals_[..., :3, :3] / np.linalg.norm(locals_[..., :3, :3], axis=-2, keepdims=True)
        return np.concatenate([quaternions(rotation), locals_[..., :3, 3]], axis=-1).astype(np.float32)

    rate = scene.render.fps / scene.render.fps_base
    return library.anthronet().Motion.from_poses(
        name,
        [bone.name for bone in bones],
        parents,
        transforms(rest[None], worlds[:1])[0],
        transforms(poses, worlds),
        rate,
        space="blender",
    )


def _frames(ob, scene, frame_start, frame_end, read):
    """What ``read`` gives at each frame, and the object's turn and place without its scale: (frames, …), (frames, 4, 4). The
    frame comes back, whatever happens. A generator."""
    if frame_end < frame_start:
        raise ValueError(f"frames: expected the first before the last, got {frame_start} to {frame_end}")
    before = scene.frame_current, scene.frame_subframe
    rows, worlds = [], []
    with _without_deformation(ob):
        try:
            for frame in range(frame_start, frame_end + 1):
                scene.frame_set(frame)
                rows.append(read().copy())
                world = np.array(ob.matrix_world)
                world[:3, :3] = _turn(world[:3, :3])
                worlds.append(world)
                yield (len(rows)) / (frame_end - frame_start + 1)
        finally:
            scene.frame_set(before[0], subframe=before[1])
    return np.array(rows), np.array(worlds)


def _turn(matrix):
    """The rotation of a matrix that may scale, too."""
    u, _, v = np.linalg.svd(matrix)
    return u @ v


def _skeleton(armature_object):
    """The bones that carry a rig's motion, parents first, and each one's parent among them or −1."""
    bones = _parents_first(armature_object)
    deforming = [bone for bone in bones if bone.name.startswith("DEF-")]
    kept = deforming or bones
    index = {bone.name: i for i, bone in enumerate(kept)}

    def above(bone):
        parent = bone.parent
        while parent is not None:
            # Rigify hangs limbs on the copies of the bones that deform.
            for name in (parent.name, f"DEF-{parent.name.partition('-')[2]}"):
                if name in index and name != bone.name:
                    return index[name]
            parent = parent.parent
        return -1

    parents = [above(bone) for bone in kept]
    return _sorted_by_parent(kept, parents)


def _sorted_by_parent(bones, parents):
    order, done = [], set()

    def visit(bone, below=()):
        if bone in done or bone in below:
            return
        if parents[bone] >= 0:
            visit(parents[bone], (*below, bone))
        done.add(bone)
        order.append(bone)

    for bone in range(len(bones)):
        visit(bone)
    place = {bone: i for i, bone in enumerate(order)}
    return [bones[bone] for bone in order], [place.get(parents[bone], -1) for bone in order]


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
