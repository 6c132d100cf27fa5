# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding characters."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .. import library, measures
from ..services import character
from ..state import definitions
from .base import reported
from .job import ModalJob


#: How many people are put into the scene at once.
_BATCH = 16


class AddsCharacters:
    """An operator that puts characters into the active collection."""

    @classmethod
    def poll(cls, context):
        """Whether they would be seen there."""
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to object mode")
            return False
        collection = context.layer_collection
        if collection is None or collection.exclude or not collection.is_visible:
            cls.poll_message_set("The active collection is excluded or hidden: choose another one")
            return False
        if context.collection.library is not None:
            cls.poll_message_set("The active collection is linked: choose another one")
            return False
        return True


class ANTHRONET_OT_character_add(AddsCharacters, bpy.types.Operator):
    """Add a person with the given measures: mesh, armature and weights. A measure of 0 is left open"""

    bl_idname = "anthronet.character_add"
    bl_label = "AnthroNet Character"
    bl_options = {"REGISTER", "UNDO"}

    __annotations__ = {**definitions.request_properties(), **definitions.measure_properties(zero_is_unset=True)}

    @reported
    def execute(self, context):
        given = {name: value for name in measures.names() if (value := getattr(self, name)) > 0.0}
        request = library.anthronet().Request(
            sex=None if self.sex == "ANY" else self.sex.lower(),
            seed=self.seed,
            fill=self.fill.lower(),
            nearest=self.nearest,
            **{name: float(f"{value:.7g}") for name, value in given.items()},
        )
        body = library.model().generate(request)
        (made,) = character.add(
            context,
            [(body, request, context.scene.cursor.location)],
            lod=int(self.lod),
            accessories=self.accessories,
            names=self.joint_names.lower(),
            tones=[self.skin_tone],
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


class ANTHRONET_OT_crowd_add(AddsCharacters, ModalJob, bpy.types.Operator):
    """Add many different people on a grid. Esc stops; those that are there stay"""

    bl_idname = "anthronet.crowd_add"
    bl_label = "AnthroNet Crowd"
    bl_options = {"REGISTER", "UNDO"}

    count: IntProperty(name="People", description="How many", default=20, min=1, max=10000, soft_max=200)
    seed: IntProperty(name="Seed", description="The first person's seed", default=1, min=1)
    spacing: FloatProperty(
        name="Spacing",
        description="From one person to the next",
        default=1.5,
        min=0.1,
        unit="LENGTH",
        subtype="DISTANCE",
    )
    lod: EnumProperty(name="Detail", description="How many vertices each has", items=definitions.LODS, default="1")
    skin_tones: BoolProperty(
        name="All Skin Tones", description="Skin tones in turn instead of the default", default=True
    )

    def invoke(self, context, _event):
        return self.execute(context)

    def work(self, context):
        """Places people as they are made beside this thread."""
        request, sexes = library.anthronet().Request, ("female", "male")
        seeds = [(self.seed + i - 1) % definitions.LARGEST_SEED + 1 for i in range(self.count)]
        requests = [request(sex=sexes[i % 2], seed=seed, fill="sample") for i, seed in enumerate(seeds)]
        placed = 0
        with library.model().start(requests) as job:
            while placed < self.count:
                # Few at a time: each batch keeps the window waiting.
                done = min(job.progress.done, placed + _BATCH)
                if done == placed:
                    yield None
                    continue
                people = [(job.take(i), requests[i], self._place(context, i)) for i in range(placed, done)]
                tones = [i % 10 + 1 if self.skin_tones else 0 for i in range(placed, done)]
                character.add(context, people, lod=int(self.lod), tones=tones)
                placed, self.changed = done, True
                yield placed / self.count

    def _place(self, context, index):
        columns = max(1, round(self.count**0.5))
        row, column = divmod(index, columns)
        place = context.scene.cursor.location.copy()
        place.x += (column - (columns - 1) / 2) * self.spacing
        place.y += row * self.spacing
        return place


CLASSES = (ANTHRONET_OT_character_add, ANTHRONET_OT_crowd_add)
