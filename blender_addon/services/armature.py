# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures of characters: creation, rest pose, bone names.

A bone has its head at the joint and its +Y axis along the limb; its roll makes limbs bend about X."""

from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Matrix

from .. import library

#: Custom property of a bone: the library's name of its joint.
JOINT = "anthronet_joint"
#: Custom property of a template armature: the naming convention of its bones.
_TEMPLATE_KEY = "anthronet_template"
#: Custom properties of an armature: the joints that it was created with, and the rest positions of their bones' heads.
_JOINTS, _HEADS = "anthronet_joints", "anthronet_heads"
#: If the median distance of bone heads from where they were put is more, somebody moved the whole armature; metres.
_MOVED_TOLERANCE = 1e-3
#: Blender deletes bones of zero length; metres.
_MIN_BONE_LENGTH = 0.01
#: Bone collections: a bone goes into the first one whose condition its joint meets.
_COLLECTIONS = (
    ("Twist", lambda joint: "twist" in joint),
    ("Face", lambda joint: joint in ("jaw", "eye_l", "eye_r")),
    ("Fingers", lambda joint: joint.split("_")[0] in ("thumb", "index", "middle", "ring", "pinky")),
    ("Arms", lambda joint: joint.split("_")[0] in ("clavicle", "upperarm", "lowerarm", "hand")),
    ("Legs", lambda joint: joint.split("_")[0] in ("thigh", "calf", "foot", "ball")),
    ("Torso", lambda joint: True),
)


def create(bodies, convention, context, name, created):
    """Creates an armature object for each body in the active collection. ``convention``: how bones are named.

    Each object is appended to the list ``created`` at once, so that a caller can remove them after an error."""
    collection, view_layer = context.collection, context.view_layer
    template = _find_template(convention) or _create_template(bodies[0], convention, collection, view_layer)
    rigs = []
    for _ in bodies:
        armature = template.copy()
        del armature[_TEMPLATE_KEY]
        armature.name = name
        rig = bpy.data.objects.new(name, armature)
        created.append(rig)
        collection.objects.link(rig)
        rigs.append(rig)
    set_rest_pose(rigs, bodies, view_layer)
    for rig in rigs:
        for pose_bone in rig.pose.bones:
            pose_bone.rotation_mode = "QUATERNION"
    return rigs


def _template_name(convention):
    return f".AnthroNet {convention}"


def _find_template(convention):
    found = bpy.data.armatures.get((_template_name(convention), None))
    return found if found is not None and found.get(_TEMPLATE_KEY) == convention else None


def _create_template(body, convention, collection, view_layer):
    """The armature that those of all characters are copied from: creating bones is slow, moving them is not."""
    armature = bpy.data.armatures.new(_template_name(convention))
    # Bones can be created in edit mode only, for which an object in the scene is needed.
    helper = bpy.data.objects.new(armature.name, armature)
    try:
        collection.objects.link(helper)
        bone_names = body.joint_names(convention)
        with edit_mode([helper], view_layer):
            bones = armature.edit_bones
            for bone_name in bone_names:
                bones.new(bone_name)
            _set_bone_matrices([bones[bone_name] for bone_name in bone_names], body)
            for bone_name, parent in zip(bone_names, body.parents):
                if parent >= 0:
                    bones[bone_name].parent = bones[bone_names[parent]]
    except Exception:
        bpy.data.armatures.remove(armature)
        raise
    bpy.data.objects.remove(helper)
    _add_metadata(armature, body, convention)
    armature[_TEMPLATE_KEY] = convention
    return armature


def set_rest_pose(rigs, bodies, view_layer):
    """Moves the bones of several armatures to the joints of other bodies, in one switch to edit mode.

    ValueError or RuntimeError if Blender does not allow it; then no bone has moved."""
    with edit_mode(rigs, view_layer):
        for rig, body in zip(rigs, bodies):
            by_joint = {bone.get(JOINT): bone for bone in rig.data.edit_bones}
            _set_bone_matrices([by_joint[joint] for joint in body.joint_names()], body)
    for rig, body in zip(rigs, bodies):
        rig.data[_JOINTS] = " ".join(body.joint_names())
        rig.data[_HEADS] = _head_coordinates(rig, body.joint_names())


def _head_coordinates(rig, joints):
    by_joint = {bone.get(JOINT): bone for bone in rig.data.bones}
    return [coordinate for joint in joints for coordinate in by_joint[joint].head_local]


def _set_bone_matrices(edit_bones, body):
    for bone, joint in zip(edit_bones, body.joints("blender")):
        bone.length = max(float(joint["length"]), _MIN_BONE_LENGTH)
        bone.matrix = Matrix(joint["model_from_joint"].tolist())


def _add_metadata(armature, body, convention):
    """Adds each bone's joint, bone collections, and the map from joints to the bones of Unity's humanoid."""
    joints = body.joint_names()
    collections = {name: armature.collections.new(name) for name, _ in reversed(_COLLECTIONS)}
    for bone_name, joint in zip(body.joint_names(convention), joints):
        bone = armature.bones[bone_name]
        bone[JOINT] = joint
        collection = next(name for name, contains in _COLLECTIONS if contains(joint))
        collections[collection].assign(bone)
        bone.use_deform = joint != "Root"
    humanoid = {bone.native: bone.unity for bone in library.anthronet().HUMANOID_BONES}
    armature["anthronet_humanoid"] = {joint: humanoid[joint] for joint in joints if joint in humanoid}
    armature["anthronet_names"] = convention
    armature.display_type = "OCTAHEDRAL"


def rename_bones(rig, convention):
    """Renames the bones by a naming convention. Blender renames vertex groups and animation channels with them."""
    # All bodies have the same joints.
    body = library.model().generate(library.anthronet().Request())
    bone_names = dict(zip(body.joint_names(), body.joint_names(convention)))
    for bone in rig.data.bones:
        joint = bone.get(JOINT)
        if joint in bone_names:
            bone.name = bone_names[joint]
    rig.data["anthronet_names"] = convention


def missing_joints(rig):
    """The joints whose bones were deleted."""
    present = {bone.get(JOINT) for bone in rig.data.bones}
    return [joint for joint in rig.data.get(_JOINTS, "").split() if joint not in present]


def has_applied_transform(rig):
    """Whether the armature as a whole was moved in its object space, as *Apply ▸ Scale* does. Single bones may differ."""
    if _HEADS not in rig.data:
        return False
    expected = np.array(rig.data[_HEADS]).reshape(-1, 3)
    actual = np.array(_head_coordinates(rig, rig.data[_JOINTS].split())).reshape(-1, 3)
    return float(np.median(np.linalg.norm(actual - expected, axis=1))) > _MOVED_TOLERANCE


def pose_bones(rig, body):
    """The pose bones in the order of the library's joints. ValueError if some were deleted."""
    by_joint = {bone.get(JOINT): bone.name for bone in rig.data.bones}
    missing = [joint for joint in body.joint_names() if joint not in by_joint]
    if missing:
        raise ValueError(f"{rig.name}: the bones of these joints were deleted: {', '.join(missing)}")
    return [rig.pose.bones[by_joint[joint]] for joint in body.joint_names()]


def parent_from_bone(bones):
    """Rest matrices of pose bones relative to their parents, (n, 4, 4)."""
    armature_from_bone = {bone.name: np.array(bone.bone.matrix_local) for bone in bones}
    out = []
    for bone in bones:
        parent = bone.bone.parent
        matrix = armature_from_bone[bone.name]
        if parent and parent.name in armature_from_bone:
            matrix = np.linalg.inv(armature_from_bone[parent.name]) @ matrix
        out.append(matrix)
    return np.array(out)


@contextmanager
def edit_mode(rigs, view_layer):
    """Edit mode of several armatures, from any mode. Afterwards mode, active object, selection and visibility are as before.

    Blender redraws only when its main loop continues, so users do not see the modes in between. RuntimeError if Blender does
    not allow the change of mode, ValueError if a collection hides one of the armatures."""
    active = view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    # Several armatures can be in pose mode at once.
    posed = [ob for ob in view_layer.objects if ob.mode == "POSE"] if mode == "POSE" else []
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    # Visibility is only set where it has to be: each change makes Blender rebuild the scene's dependency graph.
    hidden = [rig for rig in rigs if rig.hide_get(view_layer=view_layer)]
    disabled = [rig for rig in rigs if rig.hide_viewport]
    selected = list(view_layer.objects.selected)
    mirrored = [rig.data for rig in rigs if rig.data.use_mirror_x]
    try:
        _set_selected(selected, False, view_layer)
        for armature in mirrored:
            armature.use_mirror_x = False
        for rig in disabled:
            rig.hide_viewport = False
        for rig in hidden:
            rig.hide_set(False, view_layer=view_layer)
        for rig in rigs:
            if not rig.visible_get(view_layer=view_layer):
                raise ValueError(f"{rig.name} is in a hidden collection: show the collection to change the character")
        _set_selected(rigs, True, view_layer)
        view_layer.objects.active = rigs[0]
        bpy.ops.object.mode_set(mode="EDIT")
        yield
    finally:
        if rigs[0].mode == "EDIT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for armature in mirrored:
            armature.use_mirror_x = True
        _set_selected(rigs, False, view_layer)
        for rig in hidden:
            rig.hide_set(True, view_layer=view_layer)
        for rig in disabled:
            rig.hide_viewport = True
        view_layer.objects.active = active
        if mode != "OBJECT":
            _set_selected(posed, True, view_layer)
            bpy.ops.object.mode_set(mode=mode)
            _set_selected(posed, False, view_layer)
        _set_selected(selected, True, view_layer)


def _set_selected(objects, state, view_layer):
    for ob in objects:
        ob.select_set(state, view_layer=view_layer)
