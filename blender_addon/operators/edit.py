# SPDX-License-Identifier: GPL-3.0-or-later
"""Changing characters: drawing others, mirroring, files of requests."""

import random
from pathlib import Path

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import library, measures, properties
from ..services import character, live
from .base import NeedsCharacter, reported


def _regenerate(operator, context, owner):
    if live.regenerate(owner, context):
        return {"FINISHED"}
    operator.report({"ERROR"}, owner.anthronet.error)
    return {"CANCELLED"}


class ANTHRONET_OT_randomise(NeedsCharacter, bpy.types.Operator):
    """Make the selected characters other people"""

    bl_idname = "anthronet.randomise"
    bl_label = "Randomise"
    bl_options = {"REGISTER", "UNDO"}

    what: EnumProperty(
        name="What",
        items=(
            ("ALL", "All", "Draw every measure that is not given, and the identity"),
            ("IDENTITY", "Identity Only", "Keep all measures as they are, draw the identity"),
        ),
    )
    seed: IntProperty(name="Seed", description="0 draws one", min=0)

    @reported
    def execute(self, context):
        seed = self.seed or random.SystemRandom().randrange(1, 2**31)
        for step, owner in enumerate(character.selected(context)):
            settings = owner.anthronet
            with properties.silent():
                if self.what == "IDENTITY":
                    for name in measures.names():
                        settings.set_given(name, True)
                else:
                    settings.fill = "SAMPLE"
                settings.identity_by_hand = False
                settings.seed = (seed + step - 1) % (2**31 - 1) + 1
            result = _regenerate(self, context, owner)
            if result != {"FINISHED"}:
                return result
        return {"FINISHED"}


class ANTHRONET_OT_mirror(NeedsCharacter, bpy.types.Operator):
    """Exchange the given measures of left and right"""

    bl_idname = "anthronet.mirror"
    bl_label = "Mirror Measures"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        owner = character.active(context)
        settings = owner.anthronet
        before = settings.measures()
        settings.set_measures({measure.name: before[measure.mirrored] for measure in measures.all_measures()})
        return _regenerate(self, context, owner)


class ANTHRONET_OT_symmetrise(NeedsCharacter, bpy.types.Operator):
    """Give one side's measures to both"""

    bl_idname = "anthronet.symmetrise"
    bl_label = "Both Sides Alike"
    bl_options = {"REGISTER", "UNDO"}

    side: EnumProperty(name="From", items=(("left", "Left", ""), ("right", "Right", "")))

    @reported
    def execute(self, context):
        owner = character.active(context)
        settings = owner.anthronet
        before = settings.measures()
        sided = [measure for measure in measures.all_measures() if measure.side == self.side]
        settings.set_measures({measure.mirrored: before[measure.name] for measure in sided})
        return _regenerate(self, context, owner)


class ANTHRONET_OT_open_measures(NeedsCharacter, bpy.types.Operator):
    """Leave every measure open: the likeliest person"""

    bl_idname = "anthronet.open_measures"
    bl_label = "Open All Measures"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        owner = character.active(context)
        settings = owner.anthronet
        settings.set_measures({name: (value, False) for name, (value, _) in settings.measures().items()})
        return _regenerate(self, context, owner)


class ANTHRONET_OT_copy_request(NeedsCharacter, bpy.types.Operator):
    """Give the request of the active character to all selected ones"""

    bl_idname = "anthronet.copy_request"
    bl_label = "Copy to Selected"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        first, *others = character.selected(context)
        request = first.anthronet.request()
        for owner in others:
            owner.anthronet.set_request(request)
            result = _regenerate(self, context, owner)
            if result != {"FINISHED"}:
                return result
        self.report({"INFO"}, f"{len(others)} characters changed")
        return {"FINISHED"}


class ANTHRONET_OT_request_save(NeedsCharacter, bpy.types.Operator, ExportHelper):
    """Save the request of the active character as JSON, as the command line reads it"""

    bl_idname = "anthronet.request_save"
    bl_label = "Save Request"

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    @reported
    def execute(self, context):
        text = character.active(context).anthronet.request().to_json()
        Path(self.filepath).write_text(text + "\n", encoding="utf-8")
        return {"FINISHED"}


class ANTHRONET_OT_request_load(NeedsCharacter, bpy.types.Operator, ImportHelper):
    """Give the active character the request of a JSON file"""

    bl_idname = "anthronet.request_load"
    bl_label = "Load Request"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    @reported
    def execute(self, context):
        owner = character.active(context)
        text = Path(self.filepath).read_text(encoding="utf-8")
        owner.anthronet.set_request(library.anthronet().Request.from_json(text))
        return _regenerate(self, context, owner)


CLASSES = (
    ANTHRONET_OT_randomise,
    ANTHRONET_OT_mirror,
    ANTHRONET_OT_symmetrise,
    ANTHRONET_OT_open_measures,
    ANTHRONET_OT_copy_request,
    ANTHRONET_OT_request_save,
    ANTHRONET_OT_request_load,
)
