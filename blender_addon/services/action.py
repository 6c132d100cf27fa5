# SPDX-License-Identifier: GPL-3.0-or-later
"""Actions made from the library's clips, and which of them a character uses."""

import json

import bpy
import numpy as np

from .. import compat
from . import armature, quaternions

_LINEAR = 1
#: A joint that translates less than this in its rest space gets no location channels; metres.
_STILL = 1e-7
#: Custom properties of an action: name of the clip, its source (:mod:`motion_source`) as JSON, and the request of the body that
#: it was made for.
CLIP, _SOURCE, _REQUEST = "anthronet_clip", "anthronet_source", "anthronet_request"


def from_clip(rig, body, clip, frame_start, frames_per_second, source, into=None):
    """Creates an action from a clip, keyframes at the clip's own times on the scene's time line. It is not assigned yet.

    ``source`` is what the clip can be made from again (:mod:`motion_source`). ``into``: an action whose keyframes are
    replaced."""
    bones = armature.pose_bones(rig, body)
    transforms = clip.bake(relative="parent", space="blender")
    frames = frame_start + np.arange(len(transforms)) * (frames_per_second / clip.frames_per_second)
    action = into or bpy.data.actions.new(clip.name)
    action[CLIP] = clip.name
    action[_SOURCE] = json.dumps(source, sort_keys=True)
    action[_REQUEST] = _request_text(rig)
    new_fcurve = compat.clear_fcurves(action, rig.name)
    for joint, (bone, rest) in enumerate(zip(bones, armature.parent_from_bone(bones))):
        rotation, location = _channels(rest, transforms[:, joint])
        path = bone.path_from_id()
        for axis in range(4):
            _insert_keyframes(new_fcurve(f"{path}.rotation_quaternion", axis, bone.name), frames, rotation[:, axis])
        if np.abs(location).max() > _STILL:
            for axis in range(3):
                _insert_keyframes(new_fcurve(f"{path}.location", axis, bone.name), frames, location[:, axis])
    return action


def _channels(parent_from_rest, parent_from_joint):
    """Values of a pose bone's channels: quaternions w, x, y, z and locations in the bone's rest space.

    ``parent_from_joint``: (frames, 7), each a quaternion x, y, z, w and a translation."""
    rest_rotation = quaternions.from_matrices(parent_from_rest[None, :3, :3])
    inverse = np.broadcast_to(quaternions.conjugate(rest_rotation), (len(parent_from_joint), 4))
    rotation = quaternions.multiply(inverse, parent_from_joint[:, :4].astype(np.float64))
    rotation = quaternions.without_sign_flips(rotation)
    location = (parent_from_joint[:, 4:] - parent_from_rest[:3, 3]) @ parent_from_rest[:3, :3]
    return rotation[:, [3, 0, 1, 2]], location


def _insert_keyframes(fcurve, frames, values):
    points = fcurve.keyframe_points
    points.add(len(frames))
    points.foreach_set("co", np.stack([frames, values], axis=1).astype(np.float32).reshape(-1))
    points.foreach_set("interpolation", np.full(len(frames), _LINEAR, np.int32))
    fcurve.update()


def assign(rig, body, action, nla_start=None):
    """Assigns an action to a character or, with ``nla_start``, adds it as an NLA strip that begins at this frame. The action
    that was assigned before is kept: as the strip below, or in the file as an action with a fake user."""
    # Channels that the action does not have must not keep values of an earlier one.
    for bone in armature.pose_bones(rig, body):
        bone.rotation_mode = "QUATERNION"
        bone.location, bone.rotation_quaternion, bone.scale = (0, 0, 0), (1, 0, 0, 0), (1, 1, 1)
    before, _ = compat.assigned_action(rig)
    if nla_start is not None:
        compat.push_down(rig)
        compat.add_strip(rig, action, nla_start)
        return
    compat.assign_action(rig, action)
    if before is not None and before.users == 0 and CLIP not in before:
        before.use_fake_user = True


def source_of(action):
    """The source of an action's clip; None for an action that the extension did not create."""
    return json.loads(action[_SOURCE]) if action is not None and _SOURCE in action else None


def used_by(rig):
    """The actions with a source that a character uses, assigned or in NLA strips."""
    animation = rig.animation_data
    if animation is None:
        return []
    actions = [animation.action]
    actions += [strip.action for track in animation.nla_tracks for strip in track.strips]
    return list(dict.fromkeys(action for action in actions if action is not None and _SOURCE in action))


def is_outdated(rig):
    """Whether a character uses an action that was made for an earlier body of it, or for another character's."""
    return any(action.get(_REQUEST) != _request_text(rig) for action in used_by(rig))


def make_single_user(rig, action):
    """The action for this character alone: a copy in its place if others use it, too."""
    animation = rig.animation_data
    strips = [strip for track in animation.nla_tracks for strip in track.strips if strip.action == action]
    own_users = len(strips) + (animation.action == action)
    if action.users - action.use_fake_user <= own_users:
        return action
    copy = action.copy()
    if animation.action == action:
        compat.assign_action(rig, copy)
    for strip in strips:
        strip.action = copy
        slot = compat.object_slot(copy)
        if slot is not None:
            strip.action_slot = slot
    return copy


def _request_text(rig):
    return json.dumps(rig.anthronet.request_fields(), sort_keys=True)
