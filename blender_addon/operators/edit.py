# SPDX-License-Identifier: GPL-3.0-or-later
"""Changing the selected characters: drawing others, mirroring, files of requests. All of them change, or none."""

import random
from pathlib import Path

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import library, measures
from ..services import character, live
from ..state import definitions, requests
from .base import ChangesCharacter, NeedsCharacter, reported


def _change_selected(context, fields_of):
    """Gives the selected characters the requests whose JSON's fields ``fields_of`` tells of each one."""
    changed = [
        (owner, requests.from_fields(fields_of(place, owner.anthronet)))
        for place, owner in enumerate(character.selected(context))
    ]
    live.change(changed, context)
    return {"FINISHED"}


def _remeasured(settings, change):
    """A request's fields with other measures; ``change``: from all (metres, given) by name to those that become others."""
    told = settings.measures()
    told.update(change(dict(told)))
    return settings.request_fields(measures={name: value for name, (value, given) in told.items() if given})


class ANTHRONET_OT_randomise(ChangesCharacter, bpy.types.Operator):
    """Make the selected characters other people"""

    bl_idname = "anthronet.randomise"
    bl_label = "Randomise"
    bl_options = {"REGISTER", "UNDO"}

    what: EnumProperty(
        name="What",
        description="What is drawn",
        items=(
            ("ALL", "All", "Draw every measure that is not given, and the identity"),
            ("IDENTITY", "Identity Only", "Keep the measures, draw the identity"),
        ),
    )
    seed: IntProperty(name="Seed", description="Which person; 0 draws one", min=0)

    @reported
    def execute(self, context):
        if self.seed == 0:
            # Kept, so that Adjust Last Operation starts from the person that is seen.
            self.seed = random.SystemRandom().randrange(1, definitions.LARGEST_SEED)

        def drawn(place, settings):
            seed = (self.seed + place - 1) % definitions.LARGEST_SEED + 1
            if self.what == "ALL":
                described = settings.request_fields(seed=seed, fill="sample")
                described.pop("z", None)
                return described
            # The seed of the request may have chosen the open measures: the identity of the new one comes by hand.
            stranger = library.anthronet().Request(sex=settings.body_sex or None, seed=seed)
            latent = library.model().generate(stranger).latent
            return settings.request_fields(z=[float(f"{number:.7g}") for number in latent])

        return _change_selected(context, drawn)


class ANTHRONET_OT_mirror(ChangesCharacter, bpy.types.Operator):
    """Exchange the given measures of left and right of the selected characters"""

    bl_idname = "anthronet.mirror"
    bl_label = "Mirror Measures"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        def mirrored(told):
            return {measure.name: told[measure.mirrored] for measure in measures.all_measures()}

        return _change_selected(context, lambda _, settings: _remeasured(settings, mirrored))


class ANTHRONET_OT_symmetrise(ChangesCharacter, bpy.types.Operator):
    """Give one side's measures to both, of the selected characters"""

    bl_idname = "anthronet.symmetrise"
    bl_label = "Both Sides Alike"
    bl_options = {"REGISTER", "UNDO"}

    side: EnumProperty(
        name="From",
        description="Whose measures both sides get",
        items=(("left", "Left", "Those of the left side"), ("right", "Right", "Those of the right side")),
    )

    @reported
    def execute(self, context):
        sided = [measure for measure in measures.all_measures() if measure.side == self.side]

        def alike(told):
            return {measure.mirrored: told[measure.name] for measure in sided}

        return _change_selected(context, lambda _, settings: _remeasured(settings, alike))


class ANTHRONET_OT_open_measures(ChangesCharacter, bpy.types.Operator):
    """Leave every measure of the selected characters open: the likeliest person"""

    bl_idname = "anthronet.open_measures"
    bl_label = "Open All Measures"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        return _change_selected(context, lambda _, settings: settings.request_fields(measures={}))


class ANTHRONET_OT_copy_request(ChangesCharacter, bpy.types.Operator):
    """Give the request of the active character to all selected ones"""

    bl_idname = "anthronet.copy_request"
    bl_label = "Copy to Selected"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        first, *others = character.selected(context)
        request = first.anthronet.request()
        live.change([(owner, request) for owner in others], context)
        self.report({"INFO"}, f"{len(others)} characters changed")
        return {"FINISHED"}


class ANTHRONET_OT_make_local(NeedsCharacter, bpy.types.Operator):
    """Make the selected characters that are linked from another file, or overridden, this file's own, so that they can be
    edited"""

    bl_idname = "anthronet.make_local"
    bl_label = "Make Local"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        for owner in character.selected(context):
            character.make_local(owner)
        return {"FINISHED"}


class ANTHRONET_OT_request_save(NeedsCharacter, bpy.types.Operator, ExportHelper):
    """Save the request of the active character as JSON, as the command line reads it"""

    bl_idname = "anthronet.request_save"
    bl_label = "Save Request"

    filename_ext = ".json"
    filter_glob: StringProperty(
        name="Files", description="Which files are shown", default="*.json", options={"HIDDEN"}
    )

    @reported
    def execute(self, context):
        text = character.active(context).anthronet.request().to_json()
        Path(bpy.path.abspath(self.filepath)).write_text(text + "\n", encoding="utf-8")
        return {"FINISHED"}


class ANTHRONET_OT_request_load(ChangesCharacter, bpy.types.Operator, ImportHelper):
    """Give the selected characters the request of a JSON file"""

    bl_idname = "anthronet.request_load"
    bl_label = "Load Request"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(
        name="Files", description="Which files are shown", default="*.json", options={"HIDDEN"}
    )

    @reported
    def execute(self, context):
        text = Path(bpy.path.abspath(self.filepath)).read_text(encoding="utf-8")
        request = library.anthronet().Request.from_json(text)
        live.change([(owner, request) for owner in character.selected(context)], context)
        return {"FINISHED"}


CLASSES = (
    ANTHRONET_OT_randomise,
    ANTHRONET_OT_mirror,
    ANTHRONET_OT_symmetrise,
    ANTHRONET_OT_open_measures,
    ANTHRONET_OT_copy_request,
    ANTHRONET_OT_make_local,
    ANTHRONET_OT_request_save,
    ANTHRONET_OT_request_load,
)
