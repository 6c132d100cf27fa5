# SPDX-License-Identifier: GPL-3.0-or-later
"""What there is of motion and pose on a character."""

import numpy as np

_SMALL = 1e-6


def moves(owner):
    """Whether anything may move a character from frame to frame: an action, a track, a driver, a constraint, a parent."""
    for block in (owner, owner.data):
        animation = block.animation_data
        if animation is not None and (animation.action or len(animation.nla_tracks) or len(animation.drivers)):
            return True
    if owner.parent is not None or len(owner.constraints):
        return True
    return any(len(bone.constraints) for bone in owner.pose.bones)


def is_posed(owner):
    """Whether a bone is elsewhere than in the rest pose."""
    return any(not np.allclose(bone.matrix_basis, np.eye(4), atol=_SMALL) for bone in owner.pose.bones)


def is_placed(owner):
    """Whether the object is elsewhere than at the scene's origin, or turned."""
    return not np.allclose(owner.matrix_world, np.eye(4), atol=_SMALL)


def is_scaled(owner):
    """Whether the object has a scale."""
    return not np.allclose(owner.matrix_world.to_scale(), 1.0, atol=1e-5)
