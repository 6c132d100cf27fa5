# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion for characters: from files, built-in clips and other armatures in the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..services import action, character, motion_source, regeneration
from ..services.sampling import frames_per_second
from .base import ChangesCharacter
from .modal import ModalOperator, ModalOperatorWithoutDialog

_FINGERS = (
    ("SOURCE", "Source", "Retarget the fingers of the source, if it has any"),
    ("RELAXED", "Relaxed", "Keep the fingers relaxed"),
    ("REST", "Rest Pose", "Keep the fingers in the rest pose"),
)
_UP_AXES = (
    ("FOUND", "Automatic", "As stored in the file, or else as the pose of the skeleton suggests"),
    ("Y", "Y", "Y points up"),
    ("Z", "Z", "Z points up"),
    ("X", "X", "X points up"),
    ("-Y", "-Y", "Y points down, as in the axes of cameras"),
    ("-Z", "-Z", "Z points down"),
    ("-X", "-X", "X points down"),
)
_BUILTIN_CLIPS = (
    ("IDLE", "Idle", "Standing and breathing"),
    ("WALK", "Walk", "A walk cycle of two steps"),
    ("WAVE", "Wave", "Waving with one hand"),
    ("SQUAT", "Squat", "Squatting down and standing up"),
    ("RANGE_OF_MOTION", "Range of Motion", "Every joint to its limits, to check the deformation of the skin"),
)


class BakesMotion:
    """Mix-in for operators that bake motion into actions: their options, and the work."""

    frame_start: IntProperty(
        name="Start Frame", description="Frame of the scene at which the motion begins", default=1
    )
    in_place: BoolProperty(name="In Place", description="Remove horizontal root motion")
    use_scene_rate: BoolProperty(
        name="Resample to Scene Rate",
        description="Insert a keyframe on each frame of the scene. If off, keyframes are at the times of the source",
        default=True,
    )
    use_scene_range: BoolProperty(
        name="Set Scene Range", description="Set the scene's frame range to that of the motion"
    )
    nla: BoolProperty(
        name="As NLA Strip",
        description="Add the action as a strip on a new NLA track. The action that is assigned now becomes the strip below",
    )

    def source_dictionary(self, kind, **fields):
        """A source (:mod:`services.motion_source`) with the options of this operator."""
        return {
            "kind": kind,
            "frame_start": self.frame_start,
            "at_scene_rate": self.use_scene_rate,
            "options": {"in_place": self.in_place},
            **fields,
        }

    def bake(self, context, rigs, source):
        """Bakes a source for several characters. All clips are made before the first action is assigned. A generator that
        yields the progress."""
        scene = context.scene
        for rig in rigs:
            regeneration.check_editable(rig, context)
        motion = yield from _scaled_progress(motion_source.read(source, context), 0.0, 0.5)
        if motion is not None:
            for warning in motion.report["warnings"]:
                self.report({"WARNING"}, warning)
        clips = []
        for rig in rigs:
            body = character.generate_body(rig)
            clips.append((rig, body, motion_source.make_clip(source, motion, body, scene)))
            yield 0.5 + 0.25 * len(clips) / len(rigs)
        report = clips[0][2].report or {}
        for doubt in report.get("confidence", {}).get("doubts", ()):
            self.report({"WARNING"}, f"This may be no person, or not a whole one: {doubt}")
        unmatched = report.get("joints", {}).get("unmatched")
        if unmatched:
            self.report({"INFO"}, f"Joints of the source without a counterpart: {', '.join(unmatched)}")
        for done, (rig, body, clip) in enumerate(clips, 1):
            self.changed = True
            baked = action.from_clip(rig, body, clip, self.frame_start, frames_per_second(scene), source)
            action.assign(rig, body, baked, self.frame_start if self.nla else None)
            yield 0.75 + 0.25 * done / len(clips)
        if self.use_scene_range:
            scene.frame_start = self.frame_start
            scene.frame_end = max(round(baked.frame_range[1]), self.frame_start)


def _scaled_progress(work, start, end):
    """Does work that yields its progress, as a part of other work: from ``start`` to ``end`` of that."""
    try:
        while True:
            progress = next(work)
            yield start + (end - start) * progress
    except StopIteration as finished:
        return finished.value
    finally:
        work.close()


class RetargetsMotion(BakesMotion):
    """Mix-in for operators that retarget motion of other skeletons."""

    fingers: EnumProperty(name="Fingers", description="Pose of the fingers", items=_FINGERS)
    limits: BoolProperty(
        name="Joint Limits", description="Keep joints within the range of human joints", default=True
    )
    feet: BoolProperty(
        name="Foot Contacts", description="Keep feet that touch the floor from sliding and from sinking in", default=True
    )
    looped: BoolProperty(name="Loop", description="Blend the end of the motion into its beginning")
    force: BoolProperty(
        name="Force", description="Retarget even what seems to be no person's motion, or motion in which nobody stands"
    )

    def source_dictionary(self, kind, **fields):
        """A source with the options of this operator."""
        source = super().source_dictionary(kind, **fields)
        source["options"].update(
            fingers=self.fingers.lower(), limits=self.limits, feet=self.feet, looped=self.looped, force=self.force
        )
        return source


class ANTHRONET_OT_clip_apply(ChangesCharacter, ModalOperator, RetargetsMotion, bpy.types.Operator, ImportHelper):
    """Retarget a motion file to the selected characters: BVH, FBX, glTF, VRM, USD or AMASS / SMPL-X npz. Press Esc to stop"""

    bl_idname = "anthronet.clip_apply"
    bl_label = "Apply Clip"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(
        name="File Filter",
        description="Files that are shown",
        default="*.bvh;*.fbx;*.glb;*.gltf;*.vrm;*.vrma;*.npz;*.usd;*.usda;*.usdc;*.usdz",
        options={"HIDDEN"},
    )
    clip: IntProperty(name="Clip", description="Index of the clip in the file. The first one has 0", min=0)
    person: IntProperty(name="Person", description="Index of the person in an .npz of several. The first one has 0", min=0)
    up: EnumProperty(name="Up Axis", description="Axis of the file that points up", items=_UP_AXES)
    scale: FloatProperty(
        name="Meters per Unit",
        description="Length of the file's unit, meters. 0: as stored in the file, or else from the size of the skeleton",
        min=0.0,
    )

    def work(self, context):
        """Bakes the file's clip for all selected characters."""
        chosen = {"clip": self.clip, "person": self.person, "up": self.up, "scale": self.scale}
        source = self.source_dictionary("file", path=self.filepath, **chosen)
        yield from self.bake(context, character.selected(context), source)


class ANTHRONET_OT_clip_builtin(ChangesCharacter, ModalOperatorWithoutDialog, BakesMotion, bpy.types.Operator):
    """Animate the selected characters with a built-in clip"""

    bl_idname = "anthronet.clip_builtin"
    bl_label = "Built-in Clip"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(name="Clip", description="The built-in clip", items=_BUILTIN_CLIPS, default="WALK")

    def work(self, context):
        """Bakes the clip for all selected characters."""
        source = self.source_dictionary("builtin", name=self.name.lower())
        yield from self.bake(context, character.selected(context), source)


class ANTHRONET_OT_clip_from_armature(ChangesCharacter, ModalOperator, RetargetsMotion, bpy.types.Operator):
    """Retarget the motion of another armature in the scene to the active character. Press Esc to stop"""

    bl_idname = "anthronet.clip_from_armature"
    bl_label = "Apply Motion of Armature"
    bl_options = {"REGISTER", "UNDO"}

    source: StringProperty(
        name="Armature", description="Name of the armature object. Empty: the other selected armature"
    )
    action: StringProperty(
        name="Action",
        description="Action to retarget. Empty: the motion in the scene, with constraints, drivers and NLA",
    )
    slot: StringProperty(name="Slot", description="Slot of the action. Empty: the first slot for objects")
    start: IntProperty(
        name="From Frame", description="First frame to retarget. If both are 0: the whole action", min=0
    )
    end: IntProperty(name="To Frame", description="Last frame to retarget. If both are 0: the whole action", min=0)

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        rig = character.active(context)
        if not any(ob.type == "ARMATURE" and ob != rig for ob in context.scene.objects):
            cls.poll_message_set("There is no other armature in the scene")
            return False
        return True

    def invoke(self, context, _event):
        if not self.source:
            others = _other_armatures(context, character.active(context))
            self.source = others[0].name if len(others) == 1 else ""
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop_search(self, "source", context.scene, "objects", icon="ARMATURE_DATA")
        layout.prop_search(self, "action", bpy.data, "actions")
        for name in ("slot", "start", "end", "fingers", "limits", "feet", "looped", "force"):
            layout.prop(self, name)
        for name in ("frame_start", "in_place", "use_scene_rate", "use_scene_range", "nla"):
            layout.prop(self, name)

    def work(self, context):
        """Bakes the motion of the armature for the active character."""
        rig = character.active(context)
        armature = self.source
        if not armature:
            others = _other_armatures(context, rig)
            if len(others) != 1:
                raise ValueError(f"source: expected one other armature to be selected, got {len(others)}")
            armature = others[0].name
        if armature == rig.name:
            raise ValueError(f"source: expected an armature other than the character {armature}")
        source = self.source_dictionary(
            "armature", object=armature, action=self.action, slot=self.slot, start=self.start, end=self.end
        )
        yield from self.bake(context, [rig], source)


def _other_armatures(context, rig):
    return [ob for ob in context.selected_objects if ob.type == "ARMATURE" and ob is not rig]


class ANTHRONET_OT_clip_refit(ChangesCharacter, ModalOperatorWithoutDialog, bpy.types.Operator):
    """Bake the actions of the selected characters again for their present bodies. Edits of their keyframes are lost"""

    bl_idname = "anthronet.clip_refit"
    bl_label = "Refit Clip"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not action.used_by(character.active(context)):
            cls.poll_message_set("The character has no action that AnthroNet created")
            return False
        return True

    def work(self, context):
        """Replaces the keyframes of each action by those of its source for the present body."""
        scene = context.scene
        tasks = [(rig, used) for rig in character.selected(context) for used in action.used_by(rig)]
        clips = []
        for rig, used in tasks:
            source = action.source_of(used)
            body = character.generate_body(rig)
            start, end = (0.8 * (len(clips) + step) / len(tasks) for step in (0, 1))
            motion = yield from _scaled_progress(motion_source.read(source, context), start, end)
            clips.append((rig, body, used, source, motion_source.make_clip(source, motion, body, scene)))
        for done, (rig, body, used, source, clip) in enumerate(clips, 1):
            self.changed = True
            own = action.make_single_user(rig, used)
            action.from_clip(rig, body, clip, source["frame_start"], frames_per_second(scene), source, into=own)
            yield 0.8 + 0.2 * done / len(clips)


CLASSES = (
    ANTHRONET_OT_clip_apply,
    ANTHRONET_OT_clip_builtin,
    ANTHRONET_OT_clip_from_armature,
    ANTHRONET_OT_clip_refit,
)
