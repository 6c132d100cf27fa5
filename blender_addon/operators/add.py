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
        (made,) = character.add(
            context,
            [(body, request, context.scene.cursor.location)],
            lod=int(self.lod),
            accessories=self.accessories,
            names=self.joint_names.lower(),
        )
        made.anthronet.skin_tone = self.skin_tone
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
    skin_tones: BoolProperty(
        name="All Skin Tones", description="Skin tones in turn instead of the default", default=True
    )

    poll = ANTHRONET_OT_character_add.poll

    @reported
    def execute(self, context):
        crowd = _Crowd(self)
        with crowd.job:
            bodies = list(crowd.job.results())
        crowd.place(context, bodies)
        return {"FINISHED"}

    @reported
    def invoke(self, context, _event):
        self._crowd = _Crowd(self)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.progress_begin(0, self.count)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            return self._finish(context)
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            self._crowd.place(context, self._crowd.ready())
        except library.failures() as error:
            self.report({"ERROR"}, str(error))
            return self._finish(context)
        context.window_manager.progress_update(self._crowd.placed)
        return {"RUNNING_MODAL"} if self._crowd.placed < self.count else self._finish(context)

    def cancel(self, context):
        """Blender ends: stop the work."""
        self._finish(context)

    def _finish(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        self._crowd.job.close()
        placed = self._crowd.placed
        if placed < self.count:
            self.report({"INFO"}, f"Stopped after {placed} of {self.count} people")
        return {"FINISHED"} if placed else {"CANCELLED"}


class _Crowd:
    """People that are being made, and how many of them stand in the scene."""

    def __init__(self, asked):
        request = library.anthronet().Request
        sexes = ("female", "male")
        self._requests = [request(sex=sexes[i % 2], seed=asked.seed + i, fill="sample") for i in range(asked.count)]
        self._columns = max(1, round(asked.count**0.5))
        self._spacing, self._lod, self._tones = asked.spacing, int(asked.lod), asked.skin_tones
        self.placed = 0
        self.job = library.model().start(self._requests)

    def ready(self):
        """Bodies that are made and do not stand yet."""
        return [self.job.take(index) for index in range(self.placed, self.job.progress.done)]

    def place(self, context, bodies):
        """Stands bodies in the next places of the grid."""
        if not bodies:
            return
        people = []
        for index, body in enumerate(bodies, self.placed):
            row, column = divmod(index, self._columns)
            place = context.scene.cursor.location.copy()
            place.x += (column - (self._columns - 1) / 2) * self._spacing
            place.y += row * self._spacing
            people.append((body, self._requests[index], place))
        for index, made in enumerate(character.add(context, people, lod=self._lod), self.placed):
            made.anthronet.skin_tone = index % 10 + 1 if self._tones else 0
        self.placed += len(bodies)


_add_measures()
CLASSES = (ANTHRONET_OT_character_add, ANTHRONET_OT_crowd_add)
