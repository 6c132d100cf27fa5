# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigify's human metarig, fitted to the rest pose of a character.

Rigify comes with Blender. The face of the metarig is removed: the face of a character has bones for jaw and eyes only."""

import bpy
from mathutils import Vector

from . import armature

#: Bones of the metarig: name, joint at the head, joint at the tail. None: the tail of the character's own bone.
_CENTRE = (
    ("spine", "pelvis", "spine_01"),
    ("spine.001", "spine_01", "spine_02"),
    ("spine.002", "spine_02", "spine_03"),
    ("spine.003", "spine_03", "neck_01"),
    ("spine.006", "head", None),
)
_SIDED = (
    ("shoulder", "clavicle", "upperarm"),
    ("upper_arm", "upperarm", "lowerarm"),
    ("forearm", "lowerarm", "hand"),
    ("hand", "hand", None),
    ("thigh", "thigh", "calf"),
    ("shin", "calf", "foot"),
    ("foot", "foot", "ball"),
    ("toe", "ball", None),
)
_FINGERS = (
    ("thumb", "thumb", None),
    ("f_index", "index", "palm.01"),
    ("f_middle", "middle", "palm.02"),
    ("f_ring", "ring", "palm.03"),
    ("f_pinky", "pinky", "palm.04"),
)
#: By bone of the left side, the axis in object space that Rigify expects it to bend about. "f_" stands for the fingers other
#: than the thumb.
_BEND_AXES = {
    "upper_arm": Vector((0, 0, -1)),
    "forearm": Vector((0, 0, -1)),
    "hand": Vector((0, 0, -1)),
    "thigh": Vector((1, 0, 0)),
    "shin": Vector((1, 0, 0)),
    "foot": Vector((1, 0, 0)),
    "toe": Vector((1, 0, 0)),
    "f_": Vector((0, 1, 0)),
}
#: Limbs whose middle joint must be bent for Rigify: the bones above and below the joint.
_BENT_LIMBS = (("upper_arm", "forearm"), ("thigh", "shin"))
#: Least distance of a middle joint from the straight line between the ends of its limb, as a share of the limb's length.
_LEAST_BEND = 0.01
#: Where palm bones begin, as a share of the way from the wrist to the first finger joint.
_PALM_START = 0.3
#: Distance of the heel behind the ankle, and its width, as shares of the distance from ankle to ball.
_HEEL_BACK, _HEEL_WIDTH = 0.35, 0.5


def is_available(context):
    """Whether Rigify is enabled."""
    return "rigify" in context.preferences.addons and "armature_human_metarig_add" in dir(bpy.ops.object)


def create(context, rig):
    """Adds a metarig with the transform and rest pose of a character and makes it the active object. ValueError if bones of the
    character were deleted."""
    missing = armature.missing_joints(rig)
    if missing:
        raise ValueError(f"{rig.name}: the bones of these joints were deleted: {', '.join(missing)}")
    joints = {bone[armature.JOINT]: bone for bone in rig.data.bones if armature.JOINT in bone}
    bpy.ops.object.armature_human_metarig_add()
    metarig = context.object
    metarig.name = f"{rig.name} Metarig"
    metarig.matrix_world = rig.matrix_world
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        bones = metarig.data.edit_bones
        _remove_face(bones)
        _fit(bones, joints)
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
    return metarig


def _remove_face(bones):
    face = bones.get("face")
    if face is None:
        return
    for bone in [*face.children_recursive, face]:
        bones.remove(bone)


def _fit(bones, joints):
    """Moves the edit bones of a metarig to the joints of a character."""
    extras = _extra_bones(bones)
    size = joints["head"].tail_local.z / bones["spine.006"].tail.z
    _fit_spine(bones, joints)
    for side, suffix in (("L", "_l"), ("R", "_r")):
        _fit_limbs(bones, joints, side, suffix)
        _fit_fingers(bones, joints, side, suffix)
        _fit_heel(bones, joints, side, suffix)
    for name, (joint, head, tail) in extras.items():
        origin = joints[joint].head_local
        _place(bones[name], origin + size * head, origin + size * tail)


def _extra_bones(bones):
    """Bones without a joint of their own: from name to the joint that they keep their distance from, and the offsets of head
    and tail."""
    extras = {}
    for stem, spine_bone, joint in (("breast", "spine.003", "spine_03"), ("pelvis", "spine", "pelvis")):
        origin = bones[spine_bone].head.copy()
        for name in (f"{stem}.L", f"{stem}.R"):
            if name in bones:
                extras[name] = joint, bones[name].head - origin, bones[name].tail - origin
    return extras


def _fit_spine(bones, joints):
    for name, joint, end in _CENTRE:
        _place(bones[name], joints[joint].head_local, joints[end].head_local if end else joints[joint].tail_local)
    # The neck of the metarig has two bones.
    neck, head = joints["neck_01"].head_local, joints["head"].head_local
    _place(bones["spine.004"], neck, (neck + head) / 2)
    _place(bones["spine.005"], (neck + head) / 2, head)


def _fit_limbs(bones, joints, side, suffix):
    for name, joint, end in _SIDED:
        start = joints[joint + suffix]
        tail = joints[end + suffix].head_local if end else start.tail_local
        _place(bones[f"{name}.{side}"], start.head_local, tail, _bend_axis(name, side, start))
    for above, below in _BENT_LIMBS:
        _bend(bones[f"{above}.{side}"], bones[f"{below}.{side}"])


def _fit_fingers(bones, joints, side, suffix):
    wrist = joints["hand" + suffix].head_local
    for name, joint, palm in _FINGERS:
        chain = [joints[f"{joint}_0{number}{suffix}"] for number in (1, 2, 3)]
        if palm is not None:
            _place(bones[f"{palm}.{side}"], wrist.lerp(chain[0].head_local, _PALM_START), chain[0].head_local)
        for number, start in enumerate(chain, 1):
            tail = chain[number].head_local if number < 3 else start.tail_local
            axis = _bend_axis("f_", side, start) if palm else None
            _place(bones[f"{name}.0{number}.{side}"], start.head_local, tail, axis)


def _fit_heel(bones, joints, side, suffix):
    ankle, ball = joints["foot" + suffix].head_local, joints["ball" + suffix].head_local
    length = (ball - ankle).length
    heel = Vector((ankle.x, ankle.y + _HEEL_BACK * length, 0.0))
    half_width = Vector((_HEEL_WIDTH / 2 * length * (1 if side == "L" else -1), 0, 0))
    _place(bones[f"heel.02.{side}"], heel - half_width, heel + half_width)


def _bend_axis(name, side, joint):
    """The X axis for a bone of the metarig: of ±X and ±Z of the character's bone the one closest to what Rigify expects,
    which is an X for arms and legs and a Z for fingers."""
    expected = _BEND_AXES.get(name)
    if expected is None:
        return None
    if side == "R":
        # A rotation axis is a pseudovector: mirrored in x, it keeps x and changes the sign of y and z.
        expected = Vector((expected.x, -expected.y, -expected.z))
    axes = joint.matrix_local.to_3x3().col
    return max((sign * axes[i] for i in (0, 2) for sign in (1, -1)), key=expected.dot)


def _place(bone, head, tail, x_axis=None):
    bone.head, bone.tail = head, tail
    if x_axis is not None:
        bone.align_roll(x_axis.cross(bone.tail - bone.head))


def _bend(above, below):
    """Moves the joint between two bones off the straight line, if it is not already, as Rigify infers from it to which side
    the limb bends."""
    limb = below.tail - above.head
    direction = limb.cross(above.x_axis).normalized()
    missing = _LEAST_BEND * limb.length - (above.tail - above.head).dot(direction)
    if missing > 0:
        x_axes = above.x_axis.copy(), below.x_axis.copy()
        middle = above.tail + missing * direction
        _place(above, above.head, middle, x_axes[0])
        _place(below, middle, below.tail, x_axes[1])
