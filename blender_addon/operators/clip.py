# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion: files, built-in clips and other armatures of the scene, onto characters."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper


from ..services import action, character, live, motion
from .base import ChangesCharacter
from .job import ModalJob

_FINGERS = (
    ("SOURCE", "Source", "As the source's fingers, where it has any"),
    ("RELAXED", "Relaxed", "Hands at ease"),
    ("REST", "Rest", "As in the rest pose"),
)
_UPS = (
    ("FOUND", "From File", "What the file says, or its body's stance"),
    ("Y", "Y", "Y points up"),
    ("Z", "Z", "Z points up"),
)
_BUILTIN = (
    ("IDLE", "Idle", "Standing at ease, breathing"),
    ("WALK", "Walk", "Two steps that repeat"),
    ("WAVE", "Wave", "A greeting with one hand"),
    ("SQUAT", "Squat", "Down and up again"),
    ("RANGE_OF_MOTION", "Range of Motion", "Every joint as far as it goes, to look at the skin"),
)


class Bakes:
    """Where a motion goes: an action, from a frame on."""

    frame_start: IntProperty(name="Start Frame", description="Frame of the scene that the motion begins at", default=1)
    in_place: BoolProperty(name="In Place", description="Leave out the way over the ground")
    use_scene_rate: BoolProperty(
        name="Resample to Scene Rate",
        description="One key on every frame of the scene instead of the motion's own times",
        default=True,
    )
    use_scene_range: BoolProperty(
        name="Set Scene Range", description="Make the scene's first and last frame those of the motion"
    )
    nla: BoolProperty(
        name="As NLA Strip",
        description="Put the action on a new track of the non-linear animation; what is played now becomes a strip below",
    )

    def described(self, kind, **fields):
        """The source of a motion with this operator's options."""
        return {
            "kind": kind,
            "frame_start": self.frame_start,
            "at_scene_rate": self.use_scene_rate,
            "options": {"in_place": self.in_place},
            **fields,
        }

    def bake(self, context, owners, source):
        """Gives characters the clips of a source. All clips are made before the first one is played. A generator."""
        scene = context.scene
        for owner in owners:
            reason = live.refusal(owner, context)
            if reason:
                raise ValueError(reason)
        read = motion.read(source, context)
        opened = yield from _share(read, 0.0, 0.5)
        if opened is not None:
            for warning in opened.report["warnings"]:
                self.report({"WARNING"}, warning)
        clips = []
        for owner in owners:
            body = character.body(owner)
            clips.append((owner, body, motion.clip(source, opened, body, scene)))
            yield 0.5 + 0.25 * len(clips) / len(owners)
        unmatched = (clips[0][2].report or {}).get("joints", {}).get("unmatched")
        if unmatched:
            self.report({"INFO"}, f"Joints that drive nothing: {', '.join(unmatched)}")
        for done, (owner, body, clip) in enumerate(clips, 1):
            self.changed = True
            made = action.from_clip(owner, body, clip, self.frame_start, motion.scene_rate(scene), source)
            action.play(owner, body, made, self.frame_start if self.nla else None)
            yield 0.75 + 0.25 * done / len(clips)
        if self.use_scene_range:
            scene.frame_start = self.frame_start
            scene.frame_end = max(round(made.frame_range[1]), self.frame_start)


def _share(work, start, end):
    """A part of work as a share of the whole."""
    try:
        while True:
            progress = next(work)
            yield start + (end - start) * progress
    except StopIteration as finished:
        return finished.value
    finally:
        work.close()


class Retargets(Bakes):
    """Options of retargeting."""

    fingers: EnumProperty(name="Fingers", description="What fingers do", items=_FINGERS)
    limits: BoolProperty(name="Joint Limits", description="Keep joints within what people's joints do", default=True)
    feet: BoolProperty(name="Hold Feet", description="Keep feet on the floor and from sliding", default=True)
    looped: BoolProperty(name="Loop", description="Make the end meet the beginning")

    def described(self, kind, **fields):
        """The source of a motion with this operator's options."""
        source = super().described(kind, **fields)
        source["options"].update(
            fingers=self.fingers.lower(), limits=self.limits, feet=self.feet, looped=self.looped
        )
        return source


class ANTHRONET_OT_clip_apply(ChangesCharacter, ModalJob, Retargets, bpy.types.Operator, ImportHelper):
    """Bring a motion file onto the selected characters: BVH, FBX, glTF, USD or AMASS / SMPL-X npz. Esc stops"""

    bl_idname = "anthronet.clip_apply"
    bl_label = "Apply Clip"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(
        name="Files",
        description="Which files are shown",
        default="*.bvh;*.fbx;*.glb;*.gltf;*.npz;*.usda;*.usdc;*.usdz",
        options={"HIDDEN"},
    )
    clip: IntProperty(name="Clip", description="Which clip of the file, counted from 0", min=0)
    up: EnumProperty(name="Up", description="Which axis of the file points up", items=_UPS)
    scale: FloatProperty(name="Metres per Unit", description="0: what the file says, or its body's size", min=0.0)

    def work(self, context):
        """Every selected character plays the file's clip."""
        source = self.described("file", path=self.filepath, clip=self.clip, up=self.up, scale=self.scale)
        yield from self.bake(context, character.selected(context), source)


class ANTHRONET_OT_clip_builtin(ChangesCharacter, ModalJob, Bakes, bpy.types.Operator):
    """Let the selected characters play a built-in clip"""

    bl_idname = "anthronet.clip_builtin"
    bl_label = "Built-in Clip"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(name="Clip", description="Which one", items=_BUILTIN, default="WALK")

    def invoke(self, context, _event):
        return self.execute(context)

    def work(self, context):
        """Every selected character plays it."""
        yield from self.bake(
            context, character.selected(context), self.described("builtin", name=self.name.lower())
        )


class ANTHRONET_OT_clip_from_armature(ChangesCharacter, ModalJob, Retargets, bpy.types.Operator):
    """Bring the motion of another armature of the scene, of any rig, onto the active character. Esc stops"""

    bl_idname = "anthronet.clip_from_armature"
    bl_label = "Apply Motion of Armature"
    bl_options = {"REGISTER", "UNDO"}

    source: StringProperty(name="Armature", description="Its object; empty for the other selected armature")
    action: StringProperty(
        name="Action", description="Which action it plays; empty for what it does in the scene, constraints included"
    )
    slot: StringProperty(name="Slot", description="Which slot of the action; empty for the first that suits")
    start: IntProperty(name="From Frame", description="First frame; 0 and 0 for all of the action", min=0)
    end: IntProperty(name="To Frame", description="Last frame; 0 and 0 for all of the action", min=0)

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        owner = character.active(context)
        if not any(ob.type == "ARMATURE" and ob != owner for ob in context.scene.objects):
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
        for name in ("slot", "start", "end", "fingers", "limits", "feet", "looped"):
            layout.prop(self, name)
        for name in ("frame_start", "in_place", "use_scene_rate", "use_scene_range", "nla"):
            layout.prop(self, name)

    def work(self, context):
        """The active character plays the armature's motion."""
        owner = character.active(context)
        found = self.source
        if not found:
            others = _other_armatures(context, owner)
            if len(others) != 1:
                raise ValueError(f"source: expected one other armature selected, got {len(others)}")
            found = others[0].name
        if found == owner.name:
            raise ValueError(f"source: expected another armature than {found} itself")
        source = self.described(
            "armature", object=found, action=self.action, slot=self.slot, start=self.start, end=self.end
        )
        yield from self.bake(context, [owner], source)


def _other_armatures(context, owner):
    return [ob for ob in context.selected_objects if ob.type == "ARMATURE" and ob is not owner]


class ANTHRONET_OT_clip_refit(ChangesCharacter, ModalJob, bpy.types.Operator):
    """Make the actions of the selected characters anew for the bodies that they have now. Keys that were edited are lost"""

    bl_idname = "anthronet.clip_refit"
    bl_label = "Refit Clip"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not action.of(character.active(context)):
            cls.poll_message_set("The character plays no action of AnthroNet")
            return False
        return True

    def invoke(self, context, _event):
        return self.execute(context)

    def work(self, context):
        """Every action's keys are replaced by those of its source, for the body of now."""
        tasks = [(owner, one) for owner in character.selected(context) for one in action.of(owner)]
        clips = []
        for owner, one in tasks:
            source = action.source_of(one)
            body = character.body(owner)
            share = len(clips) / len(tasks)
            opened = yield from _share(motion.read(source, context), 0.8 * share, 0.8 * (share + 1 / len(tasks)))
            clips.append((owner, body, one, source, motion.clip(source, opened, body, context.scene)))
        for done, (owner, body, one, source, clip) in enumerate(clips, 1):
            self.changed = True
            rate = motion.scene_rate(context.scene)
            mine = action.own(owner, one)
            action.from_clip(owner, body, clip, source["frame_start"], rate, source, into=mine)
            yield 0.8 + 0.2 * done / len(clips)


CLASSES = (
    ANTHRONET_OT_clip_apply,
    ANTHRONET_OT_clip_builtin,
    ANTHRONET_OT_clip_from_armature,
    ANTHRONET_OT_clip_refit,
)
