# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding characters."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .. import library, measures, properties
from ..services import character
from .base import reported


class ANTHRONET_OT_character_add(bpy.types.Operator):
    """Add a person with the given measures: mesh, armature and weights. A measure of 0 is left open"""

    bl_idname = "anthronet.character_add"
    bl_label = "AnthroNet Character"
    bl_options = {"REGISTER", "UNDO"}

    sex: EnumProperty(name="Sex", items=properties.SEXES, default="FEMALE")
    seed: IntProperty(name="Seed", description="0 is the likeliest person, every other number another one", min=0)
    fill: EnumProperty(name="Open Measures", items=properties.FILLS)
    nearest: BoolProperty(name="Nearest Possible", description="Take the nearest measures that one person can have")
    lod: EnumProperty(name="Detail", items=properties.LODS, default="1")
    accessories: BoolProperty(name="Eyes, Teeth, Lashes", default=True)
    joint_names: EnumProperty(name="Bone Names", items=properties.NAMES)
    skin_tone: IntProperty(name="Skin Tone", description="Step of the Monk scale; 0 for the default", min=0, max=10)

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to object mode")
            return False
        return context.collection is not None

    @reported
    def execute(self, context):
        given = {name: value for name in measures.names() if (value := getattr(self, name)) > 0.0}
        request = library.anthronet().Request(
            sex=None if self.sex == "ANY" else self.sex.lower(),
            seed=self.seed,
            fill=self.fill.lower(),
            nearest=self.nearest,
            **given,
        )
        body = library.model().generate(request)
        made = character.add(
            context,
            body,
            request,
            lod=int(self.lod),
            accessories=self.accessories,
            names=self.joint_names.lower(),
            skin_tone=self.skin_tone,
            location=context.scene.cursor.location,
        )
        character.select_only(context, made)
        for warning in body.report["warnings"]:
            self.report({"WARNING"}, warning)
        return {"FINISHED"}

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("sex", "seed", "fill", "nearest"):
            layout.prop(self, name)
        column = layout.column(align=True)
        column.label(text="Measures (0: open)")
        for name in ("height", "chest_circumference", "waist_circumference", "hip_circumference"):
            column.prop(self, name)
        for name in ("lod", "accessories", "joint_names", "skin_tone"):
            layout.prop(self, name)


def _add_measures():
    for measure in measures.all_measures():
        ANTHRONET_OT_character_add.__annotations__[measure.name] = FloatProperty(
            name=f"{measure.label} {measure.side.capitalize()}".strip(),
            description=f"{measure.description}; 0 leaves it open",
            unit="LENGTH",
            subtype="DISTANCE",
            precision=4,
            min=0.0,
            max=3.0,
            soft_max=measure.high,
        )


class ANTHRONET_OT_crowd_add(bpy.types.Operator):
    """Add many different people on a grid. Esc stops; those that are there stay"""

    bl_idname = "anthronet.crowd_add"
    bl_label = "AnthroNet Crowd"
    bl_options = {"REGISTER", "UNDO"}

    count: IntProperty(name="People", default=20, min=1, max=10000, soft_max=200)
    seed: IntProperty(name="Seed", description="The first person's seed", default=1, min=1)
    spacing: FloatProperty(name="Spacing", default=1.5, min=0.1, unit="LENGTH", subtype="DISTANCE")
    lod: EnumProperty(name="Detail", items=properties.LODS, default="1")
    skin_tones: BoolProperty(name="All Skin Tones", description="Skin tones in turn instead of the default", default=True)

    poll = ANTHRONET_OT_character_add.poll

    @reported
    def execute(self, context):
        with library.model().start(self._requests()) as job:
            for index in range(self.count):
                while True:
                    body = _take(job, index)
                    if body is not None:
                        break
                self._place(context, index, body)
        return {"FINISHED"}

    @reported
    def invoke(self, context, _event):
        self._asked = self._requests()
        self._job = library.model().start(self._asked)
        self._next = 0
        self._timer = context.window_manager.event_timer_add(0.02, window=context.window)
        context.window_manager.progress_begin(0, self.count)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._finish(context)
            self.report({"INFO"}, f"Stopped after {self._next} of {self.count} people")
            return {"FINISHED"} if self._next else {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            body = _take(self._job, self._next)
            if body is not None:
                self._place(context, self._next, body)
                self._next += 1
                context.window_manager.progress_update(self._next)
        except library.failures() as error:
            self._finish(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if self._next < self.count:
            return {"RUNNING_MODAL"}
        self._finish(context)
        return {"FINISHED"}

    def _finish(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        self._job.close()

    def _requests(self):
        request = library.anthronet().Request
        sexes = ("female", "male")
        return [request(sex=sexes[i % 2], seed=self.seed + i, fill="sample") for i in range(self.count)]

    def _place(self, context, index, body):
        columns = max(1, round(self.count**0.5))
        row, column = divmod(index, columns)
        location = context.scene.cursor.location.copy()
        location.x += (column - (columns - 1) / 2) * self.spacing
        location.y += row * self.spacing
        character.add(
            context,
            body,
            self._requests()[index] if not hasattr(self, "_asked") else self._asked[index],
            lod=int(self.lod),
            accessories=True,
            names="blender",
            skin_tone=index % 10 + 1 if self.skin_tones else 0,
            location=location,
        )


def _take(job, index):
    """The body, or None while it is being made."""
    try:
        return job.take(index)
    except library.anthronet().BusyError:
        return None


_add_measures()
CLASSES = (ANTHRONET_OT_character_add, ANTHRONET_OT_crowd_add)
