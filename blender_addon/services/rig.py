# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures. A bone lies where the joint is: its head at the joint, +Y along the bone, rolled so that limbs bend about X."""

from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Matrix

#: The bone's joint in the library, on every bone.
JOINT = "anthronet_joint"
_KEY = "anthronet_template"
_COLLECTIONS = (
    ("Twist", lambda joint: "twist" in joint),
    ("Face", lambda joint: joint in ("jaw", "eye_l", "eye_r")),
    ("Fingers", lambda joint: joint.split("_")[0] in ("thumb", "index", "middle", "ring", "pinky")),
    ("Arms", lambda joint: joint.split("_")[0] in ("clavicle", "upperarm", "lowerarm", "hand")),
    ("Legs", lambda joint: joint.split("_")[0] in ("thigh", "calf", "foot", "ball")),
    ("Torso", lambda joint: True),
)


def new(body, names, scene_collection, view_layer, name):
    """An armature's object for a body, linked to a collection; ``names``: vocabulary of the bones."""
    armature = _template(names)
    fresh = armature is None
    armature = bpy.data.armatures.new(name) if fresh else armature.copy()
    armature.name = name
    rig = bpy.data.objects.new(name, armature)
    scene_collection.objects.link(rig)
    with edit_bones(rig, view_layer) as bones:
        if fresh:
            for joint_name in body.joint_names(names):
                bones.new(joint_name)
        _place(bones, body, names)
        if fresh:
            joint_names = body.joint_names(names)
            for joint_name, parent in zip(joint_names, body.parents):
                bone = bones[joint_name]
                bone.use_connect = False
                bone.parent = bones[joint_names[parent]] if parent >= 0 else None
    if fresh:
        _describe(armature, body, names)
        copy = armature.copy()
        copy.name = ".AnthroNet Template"
        copy[_KEY] = names
    elif _KEY in armature:
        del armature[_KEY]
    for pose_bone in rig.pose.bones:
        pose_bone.rotation_mode = "QUATERNION"
    return rig


def _template(names):
    for armature in bpy.data.armatures:
        if armature.get(_KEY) == names and armature.library is None:
            return armature
    return None


def move(rig, body, view_layer):
    """Gives the bones of a rig the rest places of another body's joints."""
    with edit_bones(rig, view_layer) as bones:
        by_joint = {bone.get(JOINT): bone for bone in bones}
        _place_each(((by_joint.get(name), joint) for name, joint in zip(body.joint_names(), body.joints("blender"))))


def rename(rig, names):
    """Calls the bones by another vocabulary; vertex groups and animation follow."""
    from .. import library

    # Names are the same for every body.
    body = library.model().generate(library.anthronet().Request())
    table = dict(zip(body.joint_names(), body.joint_names(names)))
    for bone in rig.data.bones:
        joint = bone.get(JOINT)
        if joint in table:
            bone.name = table[joint]
    rig.data["anthronet_names"] = names


def joint_order(rig, body):
    """The bones in the order of the library's joints; a missing one is named in the error."""
    by_joint = {bone.get(JOINT): bone.name for bone in rig.data.bones}
    missing = [joint for joint in body.joint_names() if joint not in by_joint]
    if missing:
        raise ValueError(f"{rig.name}: has lost the bones of {', '.join(missing)}")
    return [rig.pose.bones[by_joint[joint]] for joint in body.joint_names()]


def rest_matrices(bones):
    """Rest matrices relative to the parent, (n, 4, 4)."""
    model = {bone.name: np.array(bone.bone.matrix_local) for bone in bones}
    out = []
    for bone in bones:
        above = bone.bone.parent
        rest = model[bone.name]
        out.append(np.linalg.inv(model[above.name]) @ rest if above and above.name in model else rest)
    return np.array(out)


@contextmanager
def edit_bones(rig, view_layer):
    """The edit bones of a rig, whatever mode the user is in; mode, active object, selection and visibility come back."""
    active = view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    hidden = rig.hide_get(view_layer=view_layer), rig.hide_viewport
    if active and mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    rig.hide_set(False, view_layer=view_layer)
    rig.hide_viewport = False
    selected = [ob for ob in view_layer.objects if ob.select_get(view_layer=view_layer)]
    for ob in selected:
        ob.select_set(False, view_layer=view_layer)
    view_layer.objects.active = rig
    mirror, rig.data.use_mirror_x = rig.data.use_mirror_x, False
    try:
        bpy.ops.object.mode_set(mode="EDIT")
        yield rig.data.edit_bones
    finally:
        if rig.mode == "EDIT":
            bpy.ops.object.mode_set(mode="OBJECT")
        rig.data.use_mirror_x = mirror
        rig.hide_set(hidden[0], view_layer=view_layer)
        rig.hide_viewport = hidden[1]
        view_layer.objects.active = active
        for ob in selected:
            ob.select_set(True, view_layer=view_layer)
        if active and mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)


def _place(bones, body, names):
    _place_each(((bones.get(name), joint) for name, joint in zip(body.joint_names(names), body.joints("blender"))))


def _place_each(pairs):
    for bone, joint in pairs:
        if bone is not None:
            bone.length = max(float(joint["length"]), 0.01)
            bone.matrix = Matrix(joint["model_from_joint"].tolist())


def _describe(armature, body, names):
    """Which joint each bone is, which bone of the humanoid, and the collections."""
    from .. import library

    joints = body.joint_names()
    collections = {title: armature.collections.new(title) for title, _ in reversed(_COLLECTIONS)}
    for bone_name, joint in zip(body.joint_names(names), joints):
        bone = armature.bones[bone_name]
        bone[JOINT] = joint
        title = next(title for title, belongs in _COLLECTIONS if belongs(joint))
        collections[title].assign(bone)
        bone.use_deform = joint != "Root"
    humanoid = {bone.native: bone.unity for bone in library.anthronet().HUMANOID_BONES}
    armature["anthronet_humanoid"] = {joint: humanoid[joint] for joint in joints if joint in humanoid}
    armature["anthronet_names"] = names
    armature.display_type = "OCTAHEDRAL"
