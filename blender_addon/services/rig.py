# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures. A bone lies where the joint is: its head at the joint, +Y along the bone, rolled so that limbs bend about X."""

from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Matrix

from .. import library

#: The bone's joint in the library, on every bone.
JOINT = "anthronet_joint"
_KEY = "anthronet_template"
#: On armatures: the joints that bones were made for, and where their heads were put last.
_JOINTS, _HEADS = "anthronet_joints", "anthronet_heads"
#: How far most heads have to be off before the bones as a whole count as moved, metres.
_STRAY = 1e-3
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


def new(bodies, names, context, name, made):
    """An armature's object for each body, in the context's collection; ``names``: vocabulary of the bones. Objects are put
    into the list ``made`` as they are made, so that a caller can take them back."""
    collection, view_layer = context.collection, context.view_layer
    template = _template(names) or _make_template(bodies[0], names, collection, view_layer)
    rigs = []
    for _ in bodies:
        armature = template.copy()
        del armature[_KEY]
        armature.name = name
        rig = bpy.data.objects.new(name, armature)
        made.append(rig)
        collection.objects.link(rig)
        rigs.append(rig)
    move(rigs, bodies, view_layer)
    for rig in rigs:
        for pose_bone in rig.pose.bones:
            pose_bone.rotation_mode = "QUATERNION"
    return rigs


def _make_template(body, names, scene_collection, view_layer):
    armature = bpy.data.armatures.new(_title(names))
    carrier = bpy.data.objects.new(armature.name, armature)
    try:
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
    except Exception:
        bpy.data.armatures.remove(armature)
        raise
    bpy.data.objects.remove(carrier)
    _describe(armature, body, names)
    armature[_KEY] = names
    return armature


def _title(names):
    return f".AnthroNet {names}"


def _template(names):
    found = bpy.data.armatures.get((_title(names), None))
    return found if found is not None and found.get(_KEY) == names else None


def move(rigs, bodies, view_layer):
    """Gives the bones of rigs the rest places of other bodies' joints, all rigs in one go. ValueError or RuntimeError where
    Blender does not let it, and then nothing has moved."""
    with edit_bones(rigs, view_layer):
        for rig, body in zip(rigs, bodies):
            by_joint = {bone.get(JOINT): bone for bone in rig.data.edit_bones}
            _place([by_joint[joint] for joint in body.joint_names()], body)
    for rig, body in zip(rigs, bodies):
        rig.data[_JOINTS] = " ".join(body.joint_names())
        rig.data[_HEADS] = _heads(rig, body.joint_names())


def _heads(rig, joints):
    by_joint = {bone.get(JOINT): bone for bone in rig.data.bones}
    return [number for joint in joints for number in by_joint[joint].head_local]


def missing_joints(rig):
    """The joints whose bones somebody deleted."""
    there = {bone.get(JOINT) for bone in rig.data.bones}
    return [joint for joint in rig.data.get(_JOINTS, "").split() if joint not in there]


def is_transformed(rig):
    """Whether the bones as a whole lie elsewhere than they were put, as after *Apply Scale*. Single ones may."""
    if _HEADS not in rig.data:
        return False
    placed = np.array(rig.data[_HEADS]).reshape(-1, 3)
    now = np.array(_heads(rig, rig.data[_JOINTS].split())).reshape(-1, 3)
    return float(np.median(np.linalg.norm(now - placed, axis=1))) > _STRAY


def rename(rig, names):
    """Calls the bones by another vocabulary; vertex groups and animation follow."""
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
    """Edit mode of rigs, whatever mode the user is in; mode, active object, selection and visibility come back.

    Blender redraws when its main loop is reached again: a user sees nothing of the modes in between. RuntimeError where
    Blender does not let the mode change, ValueError where a rig is hidden by its collection."""
    active = view_layer.objects.active
    mode = active.mode if active else "OBJECT"
    # Several armatures may be posed at once.
    posed = [ob for ob in view_layer.objects if ob.mode == "POSE"] if mode == "POSE" else []
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    # Only what is hidden is shown: each switch makes Blender rebuild the dependencies of the whole scene.
    hidden = [rig for rig in rigs if rig.hide_get(view_layer=view_layer)]
    disabled = [rig for rig in rigs if rig.hide_viewport]
    selected = list(view_layer.objects.selected)
    mirrored = [rig.data for rig in rigs if rig.data.use_mirror_x]
    try:
        _select(selected, False, view_layer)
        for armature in mirrored:
            armature.use_mirror_x = False
        for rig in disabled:
            rig.hide_viewport = False
        for rig in hidden:
            rig.hide_set(False, view_layer=view_layer)
        for rig in rigs:
            if not rig.visible_get(view_layer=view_layer):
                raise ValueError(f"{rig.name}: is hidden by its collection: show that to change it")
        _select(rigs, True, view_layer)
        view_layer.objects.active = rigs[0]
        bpy.ops.object.mode_set(mode="EDIT")
        yield
    finally:
        if rigs[0].mode == "EDIT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for armature in mirrored:
            armature.use_mirror_x = True
        _select(rigs, False, view_layer)
        for rig in hidden:
            rig.hide_set(True, view_layer=view_layer)
        for rig in disabled:
            rig.hide_viewport = True
        view_layer.objects.active = active
        if mode != "OBJECT":
            _select(posed, True, view_layer)
            bpy.ops.object.mode_set(mode=mode)
            _select(posed, False, view_layer)
        _select(selected, True, view_layer)


def _select(objects, state, view_layer):
    for ob in objects:
        ob.select_set(state, view_layer=view_layer)


def _place(bones, body):
    """Lays edit bones into a body's joints."""
    for bone, joint in zip(bones, body.joints("blender")):
        bone.length = max(float(joint["length"]), _SHORTEST)
        bone.matrix = Matrix(joint["model_from_joint"].tolist())


def _describe(armature, body, names):
    """Which joint each bone is, which bone of the humanoid, and the collections."""
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
