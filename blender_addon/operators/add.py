# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding characters to the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .. import library, measures
from ..services import character
from ..state import definitions
from ..state.requests import typed_decimal
from .base import poll_object_mode, reports_errors
from .modal import ModalOperatorWithoutDialog

#: Most characters that are added to the scene in one slice of work.
_BATCH = 16


class AddsCharacters:
    """Mix-in for operators that add characters to the active collection."""

    @classmethod
    def poll(cls, context):
        """Whether they would be visible in the active collection."""
        if not poll_object_mode(cls, context):
            return False
        collection = context.layer_collection
        if collection is None or collection.exclude or not collection.is_visible:
            cls.poll_message_set("The active collection is excluded or hidden: select another one")
            return False
        if context.collection.library is not None:
            cls.poll_message_set("The active collection is linked: select another one")
            return False
        return True


class ANTHRONET_OT_character_add(AddsCharacters, bpy.types.Operator):
    """Add a character with the given measures: mesh, armature and weights. Measures of 0 are predicted"""

    bl_idname = "anthronet.character_add"
    bl_label = "AnthroNet Character"
    bl_options = {"REGISTER", "UNDO"}

    __annotations__ = {**definitions.request_properties(), **definitions.measure_properties(zero_is_unset=True)}

    @reports_errors
    def execute(self, context):
        given = {name: value for name in measures.names() if (value := getattr(self, name)) > 0.0}
        request = library.anthronet().Request(
            sex=None if self.sex == "ANY" else self.sex.lower(),
            seed=self.seed,
            fill=self.fill.lower(),
            nearest=self.nearest,
            **{name: typed_decimal(value) for name, value in given.items()},
        )
        body = library.model().generate(request)
        (rig,) = character.create(
            context,
            [(body, request, context.scene.cursor.location)],
            lod=int(self.lod),
            accessories=self.accessories,
            convention=self.joint_names.lower(),
            skin_tones=[self.skin_tone],
        )
        character.select_only(context, rig)
        for warning in body.report["warnings"]:
            self.report({"WARNING"}, warning)
        return {"FINISHED"}

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("sex", "seed", "fill", "nearest"):
            layout.prop(self, name)
        column = layout.column(align=True)
        column.label(text="Measures (0: Not Given)")
        for name in ("height", "chest_circumference", "waist_circumference", "hip_circumference"):
            column.prop(self, name)
        for name in ("lod", "accessories", "joint_names", "skin_tone"):
            layout.prop(self, name)


class ANTHRONET_OT_crowd_add(AddsCharacters, ModalOperatorWithoutDialog, bpy.types.Operator):
    """Add many different characters on a grid. Press Esc to stop; characters added so far are kept"""

    bl_idname = "anthronet.crowd_add"
    bl_label = "AnthroNet Crowd"
    bl_options = {"REGISTER", "UNDO"}

    count: IntProperty(
        name="Count", description="Number of characters", default=20, min=1, max=10000, soft_max=200
    )
    seed: IntProperty(
        name="Seed", description="Seed of the first character. The others get the following numbers", default=1, min=1
    )
    spacing: FloatProperty(
        name="Spacing",
        description="Distance between neighbors on the grid",
        default=1.5,
        min=0.1,
        unit="LENGTH",
        subtype="DISTANCE",
    )
    lod: EnumProperty(
        name="Level of Detail", description="Number of vertices of each mesh", items=definitions.LODS, default="1"
    )
    skin_tones: BoolProperty(
        name="All Skin Tones",
        description="Give the characters the ten skin tones in turn. If off, all get the default tone",
        default=True,
    )

    def work(self, context):
        """Adds characters while other threads generate the next bodies."""
        Request, sexes = library.anthronet().Request, ("female", "male")
        seeds = [(self.seed + i - 1) % definitions.LARGEST_SEED + 1 for i in range(self.count)]
        requests = [Request(sex=sexes[i % 2], seed=seed, fill="sample") for i, seed in enumerate(seeds)]
        added = 0
        with library.model().start(requests) as job:
            while added < self.count:
                # In batches, since the window does not respond while one is added.
                ready = min(job.progress.done, added + _BATCH)
                if ready == added:
                    yield None
                    continue
                people = [(job.take(i), requests[i], self._location(context, i)) for i in range(added, ready)]
                skin_tones = [i % 10 + 1 if self.skin_tones else 0 for i in range(added, ready)]
                character.create(context, people, lod=int(self.lod), skin_tones=skin_tones)
                added, self.changed = ready, True
                yield added / self.count

    def _location(self, context, index):
        columns = max(1, round(self.count**0.5))
        row, column = divmod(index, columns)
        location = context.scene.cursor.location.copy()
        location.x += (column - (columns - 1) / 2) * self.spacing
        location.y += row * self.spacing
        return location


CLASSES = (ANTHRONET_OT_character_add, ANTHRONET_OT_crowd_add)
