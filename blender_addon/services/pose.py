# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a character is animated, posed, transformed."""

import numpy as np

_TOLERANCE = 1e-6


def is_animated(rig):
    """Whether anything may move a character between frames: an action, NLA, drivers, constraints, a parent."""
    for block in (rig, rig.data):
        animation = block.animation_data
        if animation is not None and (animation.action or len(animation.nla_tracks) or len(animation.drivers)):
            return True
    if rig.parent is not None or len(rig.constraints):
        return True
    return any(len(bone.constraints) for bone in rig.pose.bones)


def is_posed(rig):
    """Whether a bone is not in its rest pose."""
    return any(not np.allclose(bone.matrix_basis, np.eye(4), atol=_TOLERANCE) for bone in rig.pose.bones)


def is_transformed(rig):
    """Whether the world matrix of the object is not the identity."""
    return not np.allclose(rig.matrix_world, np.eye(4), atol=_TOLERANCE)


def is_scaled(rig):
    """Whether the object has a scale in world space."""
    return not np.allclose(rig.matrix_world.to_scale(), 1.0, atol=1e-5)
