# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigify's human metarig, in the size and stance of a character.

Rigify comes with Blender. Its face is left out: a character's face has a jaw and eyes alone."""

import bpy
from mathutils import Vector

from . import rig

#: Metarig bones from one joint to the next: bone, joint of its head, joint of its tail; None for the bone's own end.
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
#: About which axis of the scene limbs of the left bend; of the right it is mirrored.
_BENDS = {
    "upper_arm": Vector((0, 0, -1)),
    "forearm": Vector((0, 0, -1)),
    "hand": Vector((0, 0, -1)),
    "thigh": Vector((1, 0, 0)),
    "shin": Vector((1, 0, 0)),
    "foot": Vector((1, 0, 0)),
    "toe": Vector((1, 0, 0)),
    "f_": Vector((0, 1, 0)),
}
#: Limbs whose middle joint Rigify wants bent: the bones above and below it.
_BENT = (("upper_arm", "forearm"), ("thigh", "shin"))
#: How far a middle joint is out of the straight at least, as a share of the limb.
_LEAST_BEND = 0.01
#: How far along the hand palms begin.
_PALM = 0.3
#: How long a heel is behind its ankle and how wide, as shares of the foot's length.
_HEEL_BACK, _HEEL_WIDE = 0.35, 0.5


def is_available(context):
    """Whether Rigify is enabled."""
    return "rigify" in context.preferences.addons and "armature_human_metarig_add" in dir(bpy.ops.object)


def add(context, owner):
    """The metarig's object, where the character stands; it becomes the active one. ValueError where the character has lost
    bones."""
    missing = rig.missing_joints(owner)
    if missing:
        raise ValueError(f"{owner.name}: has lost the bones of {', '.join(missing)}")
    joints = {bone[rig.JOINT]: bone for bone in owner.data.bones if rig.JOINT in bone}
    bpy.ops.object.armature_human_metarig_add()
    made = context.object
    made.name = f"{owner.name} Metarig"
    made.matrix_world = owner.matrix_world
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        bones = made.data.edit_bones
        size = joints["head"].tail_local.z / bones["spine.006"].tail.z
        _remove_face(bones)
        _lay(bones, joints, size)
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
    return made


def _remove_face(bones):
    face = bones.get("face")
    if face is None:
        return
    for bone in [*face.children_recursive, face]:
        bones.remove(bone)


def _lay(bones, joints, size):
    chest = bones["spine.003"].head.copy()
    hips = bones["spine"].head.copy()
    extras = {
        name: (bones[name].head - base, bones[name].tail - base)
        for stem, base in (("breast", chest), ("pelvis", hips))
        for name in (f"{stem}.L", f"{stem}.R")
        if name in bones
    }
    for name, joint, end in _CENTRE:
        _put(bones[name], joints[joint].head_local, joints[end].head_local if end else joints[joint].tail_local)
    # Rigify's neck has two bones.
    neck, head = joints["neck_01"].head_local, joints["head"].head_local
    _put(bones["spine.004"], neck, (neck + head) / 2)
    _put(bones["spine.005"], (neck + head) / 2, head)
    for side, suffix in (("L", "_l"), ("R", "_r")):
        for name, joint, end in _SIDED:
            start = joints[joint + suffix]
            tail = joints[end + suffix].head_local if end else start.tail_local
            _put(bones[f"{name}.{side}"], start.head_local, tail, _axis(name, side, start))
        for above, below in _BENT:
            _bend(bones[f"{above}.{side}"], bones[f"{below}.{side}"])
        for name, joint, palm in _FINGERS:
            chain = [joints[f"{joint}_0{number}{suffix}"] for number in (1, 2, 3)]
            if palm is not None:
                wrist = joints["hand" + suffix].head_local
                _put(bones[f"{palm}.{side}"], wrist.lerp(chain[0].head_local, _PALM), chain[0].head_local)
            for number, start in enumerate(chain, 1):
                tail = chain[number].head_local if number < 3 else start.tail_local
                axis = _axis("f_", side, start) if palm else None
                _put(bones[f"{name}.0{number}.{side}"], start.head_local, tail, axis)
        ankle, ball = joints["foot" + suffix].head_local, joints["ball" + suffix].head_local
        length = (ball - ankle).length
        heel = Vector((ankle.x, ankle.y + _HEEL_BACK * length, 0.0))
        half = Vector((_HEEL_WIDE / 2 * length * (1 if side == "L" else -1), 0, 0))
        _put(bones[f"heel.02.{side}"], heel - half, heel + half)
    places = {"breast": joints["spine_03"].head_local, "pelvis": joints["pelvis"].head_local}
    for name, (start, end) in extras.items():
        base = places[name.partition(".")[0]]
        _put(bones[name], base + size * start, base + size * end)


def _axis(name, side, joint):
    """The axis that a bone bends about: of the joint's own X and Z the one that lies as Rigify expects, which of arms and legs is
    X, of fingers Z."""
    expected = _BENDS.get(name)
    if expected is None:
        return None
    if side == "R":
        # Mirrored, an axis keeps its part across and changes the rest.
        expected = Vector((expected.x, -expected.y, -expected.z))
    axes = joint.matrix_local.to_3x3().col
    return max((sign * axes[i] for i in (0, 2) for sign in (1, -1)), key=expected.dot)


def _put(bone, head, tail, x_axis=None):
    bone.head, bone.tail = head, tail
    if x_axis is not None:
        bone.align_roll(x_axis.cross(bone.tail - bone.head))


def _bend(above, below):
    """Puts the joint between two bones out of the straight: Rigify finds there which way a limb bends."""
    limb = below.tail - above.head
    out = limb.cross(above.x_axis).normalized()
    lack = _LEAST_BEND * limb.length - (above.tail - above.head).dot(out)
    if lack > 0:
        axes = above.x_axis.copy(), below.x_axis.copy()
        middle = above.tail + lack * out
        _put(above, above.head, middle, axes[0])
        _put(below, middle, below.tail, axes[1])
