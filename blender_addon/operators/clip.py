# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion: files, built-in clips and other armatures of the scene, onto characters."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import compat, library
from ..services import action, character
from .base import NeedsCharacter, reported

_FINGERS = (
    ("SOURCE", "Source", "As the source's fingers, where it has any"),
    ("RELAXED", "Relaxed", "Hands at ease"),
    ("REST", "Rest", "As in the rest pose"),
)
_BUILTIN = tuple(
    (name.upper(), name.replace("_", " ").title(), "") for name in ("idle", "walk", "wave", "squat", "range_of_motion")
)


class Retargets:
    """Options of retargeting, and what is done with the result."""

    fingers: EnumProperty(name="Fingers", items=_FINGERS)
    limits: BoolProperty(name="Joint Limits", description="Keep joints within what people's joints do", default=True)
    feet: BoolProperty(name="Hold Feet", description="Keep feet on the floor and from sliding", default=True)
    in_place: BoolProperty(name="In Place", description="Leave out the way over the ground")
    looped: BoolProperty(name="Loop", description="Make the end meet the beginning")
    frame_start: IntProperty(name="Start Frame", default=1)
    use_scene_rate: BoolProperty(
        name="Resample to Scene Rate",
        description="One key on every frame of the scene instead of the motion's own times",
        default=True,
    )
    nla: BoolProperty(name="As NLA Strip", description="Put the action on a new track of the non-linear animation")

    def retarget(self, context, motion, index, body):
        """The clip of a motion on a body."""
        rate = context.scene.render.fps / context.scene.render.fps_base if self.use_scene_rate else None
        return motion.retarget(
            body,
            clip=index,
            fingers=self.fingers.lower(),
            limits=self.limits,
            feet=self.feet,
            in_place=self.in_place,
            looped=self.looped,
            frames_per_second=rate,
        )

    def bake(self, context, owner, body, clip):
        """The action of a clip, playing or as a strip."""
        rate = context.scene.render.fps / context.scene.render.fps_base
        made = action.from_clip(owner, body, clip, self.frame_start, rate)
        if self.nla:
            owner.animation_data.action = None
            compat.add_strip(owner, made, self.frame_start)
        return made


class ANTHRONET_OT_clip_apply(NeedsCharacter, Retargets, bpy.types.Operator, ImportHelper):
    """Bring a motion file onto the selected characters: BVH, FBX, glTF, USD or AMASS / SMPL-X npz"""

    bl_idname = "anthronet.clip_apply"
    bl_label = "Apply Clip"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*.bvh;*.fbx;*.glb;*.gltf;*.npz;*.usda;*.usdc;*.usdz", options={"HIDDEN"})
    clip: IntProperty(name="Clip", description="Which clip of the file, counted from 0", min=0)
    up: EnumProperty(
        name="Up",
        items=(
            ("FOUND", "From File", "What the file says, or its body's stance"),
            ("Y", "Y", "Y points up"),
            ("Z", "Z", "Z points up"),
        ),
    )
    scale: FloatProperty(name="Metres per Unit", description="0: what the file says, or its body's size", min=0.0)

    @reported
    def execute(self, context):
        up = None if self.up == "FOUND" else self.up.lower()
        motion = library.anthronet().open_motion(self.filepath, metres_per_unit=self.scale or None, up=up)
        for warning in motion.report["warnings"]:
            self.report({"WARNING"}, warning)
        for owner in character.selected(context):
            body = library.model().generate(owner.anthronet.request())
            clip = self.retarget(context, motion, self.clip, body)
            unmatched = clip.report["joints"]["unmatched"]
            if unmatched:
                self.report({"INFO"}, f"Joints that drive nothing: {', '.join(unmatched)}")
            self.bake(context, owner, body, clip)
        return {"FINISHED"}


class ANTHRONET_OT_clip_builtin(NeedsCharacter, bpy.types.Operator):
    """Let the selected characters play a built-in clip"""

    bl_idname = "anthronet.clip_builtin"
    bl_label = "Built-in Clip"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(name="Clip", items=_BUILTIN, default="WALK")
    frame_start: IntProperty(name="Start Frame", default=1)
    in_place: BoolProperty(name="In Place", description="Leave out the way over the ground")

    @reported
    def execute(self, context):
        rate = context.scene.render.fps / context.scene.render.fps_base
        for owner in character.selected(context):
            body = library.model().generate(owner.anthronet.request())
            clip = library.anthronet().builtin_clip(self.name.lower(), body)
            clip = clip.in_place() if self.in_place else clip
            action.from_clip(owner, body, clip.resample(rate), self.frame_start, rate)
        return {"FINISHED"}


class ANTHRONET_OT_clip_from_armature(NeedsCharacter, Retargets, bpy.types.Operator):
    """Bring the motion of another selected armature, of any rig, onto the active character"""

    bl_idname = "anthronet.clip_from_armature"
    bl_label = "Apply Motion of Armature"
    bl_options = {"REGISTER", "UNDO"}

    source: StringProperty(name="Armature", description="Its object; empty for the other selected armature")

    @reported
    def execute(self, context):
        owner = character.active(context)
        source = self._source(context, owner)
        scene = context.scene
        motion = action.motion_of(source, scene, scene.frame_start, scene.frame_end)
        body = library.model().generate(owner.anthronet.request())
        clip = self.retarget(context, motion, 0, body)
        self.bake(context, owner, body, clip)
        return {"FINISHED"}

    def _source(self, context, owner):
        if self.source:
            found = context.scene.objects.get(self.source)
            if found is None or found.type != "ARMATURE":
                raise ValueError(f"source: expected an armature of the scene, got {self.source}")
            return found
        others = [ob for ob in context.selected_objects if ob.type == "ARMATURE" and ob is not owner]
        if len(others) != 1:
            raise ValueError(f"expected one other armature selected, got {len(others)}")
        return others[0]


CLASSES = (ANTHRONET_OT_clip_apply, ANTHRONET_OT_clip_builtin, ANTHRONET_OT_clip_from_armature)
