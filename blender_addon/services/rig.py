# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures. A bone lies where the joint is: its head at the joint, +Y along the bone, rolled so that limbs bend about X."""

from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Matrix

#: The bone's joint in the library, on every bone.
JOINT = "anthronet_joint"
_KEY = "anthronet_template"
#: Blender removes bones without length.
_SHORTEST = 0.01
_COLLECTIONS = (
    ("Twist", lambda joint: "twist" in joint),
    ("Face", lambda joint: joint in ("jaw", "eye_l", "eye_r")),
    ("Fingers", lambda joint: joint.split("_")[0] in ("thumb", "index", "middle", "ring", "pinky")),
    ("Arms", lambda joint: joint.split("_")[0] in ("clavicle", "upperarm", "lowerarm", "hand")),
    ("Legs", lambda joint: joint.split("_")[0] in ("thigh", "calf", "foot", "ball")),
    ("Torso", lambda joint: True),
)


def new(bodies, names, scene_collection, view_layer, name):
    """An armature's object for each body, linked to a collection; ``names``: vocabulary of the bones."""
    template = _template(names) or _make_template(bodies[0], names, scene_collection, view_layer)
    rigs = []
    for _ in bodies:
        armature = template.copy()
        del armature[_KEY]
        armature.name = name
        rig = bpy.data.objects.new(name, armature)
        scene_collection.objects.link(rig)
        rigs.append(rig)
    move(rigs, bodies, view_layer)
    for rig in rigs:
        for pose_bone in rig.pose.bones:
            pose_bone.rotation_mode = "QUATERNION"
    return rigs


def _make_template(body, names, scene_collection, view_layer):
    armature = bpy.data.armatures.new(".AnthroNet Template")
    carrier = bpy.data.objects.new(".AnthroNet Template", armature)
    scene_collection.objects.link(carrier)
    bone_names = body.joint_names(names)
    with edit_bones([carrier], view_layer):
        bones = armature.edit_bones
        for bone_name in bone_names:
            bones.new(bone_name)
        _place([bones[bone_name] for bone_name in bone_names], body)
        for bone_name, parent in zip(bone_names, body.parents):
            if parent >= 0:
                bones[bone_name].parent = bones[bone_names[parent]]
    bpy.data.objects.remove(carrier)
    _describe(armature, body, names)
    armature[_KEY] = names
    return armature


def _template(names):
    for armature in bpy.data.armatures:
        if armature.get(_KEY) == names and armature.library is None:
            return armature
    return None


def move(rigs, bodies, view_layer):
    """Gives the bones of rigs the rest places of other bodies' joints, all rigs in one go."""
    with edit_bones(rigs, view_layer):
        for rig, body in zip(rigs, bodies):
            by_joint = {bone.get(JOINT): bone for bone in rig.data.edit_bones}
            _place([by_joint.get(joint) for joint in body.joint_names()], body)


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
def edit_bones(rigs, view_layer):
    """Edit mode of rigs, whatever mode the user is in; mode, active object, selection and visibility come back."""
    active = view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    hidden = [(rig, rig.hide_get(view_layer=view_layer), rig.hide_viewport) for rig in rigs]
    selected = [ob for ob in view_layer.objects if ob.select_get(view_layer=view_layer)]
    for ob in selected:
        ob.select_set(False, view_layer=view_layer)
    mirrored = [rig.data for rig in rigs if rig.data.use_mirror_x]
    for armature in mirrored:
        armature.use_mirror_x = False
    for rig in rigs:
        rig.hide_set(False, view_layer=view_layer)
        rig.hide_viewport = False
        rig.select_set(True, view_layer=view_layer)
    view_layer.objects.active = rigs[0]
    try:
        bpy.ops.object.mode_set(mode="EDIT")
        yield
    finally:
        if rigs[0].mode == "EDIT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for armature in mirrored:
            armature.use_mirror_x = True
        for rig, hide, hide_viewport in hidden:
            rig.select_set(False, view_layer=view_layer)
            rig.hide_set(hide, view_layer=view_layer)
            rig.hide_viewport = hide_viewport
        for ob in selected:
            ob.select_set(True, view_layer=view_layer)
        view_layer.objects.active = active
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)


def _place(bones, body):
    """Lays edit bones into a body's joints; None for a bone that is gone."""
    for bone, joint in zip(bones, body.joints("blender")):
        if bone is not None:
            bone.length = max(float(joint["length"]), _SHORTEST)
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
