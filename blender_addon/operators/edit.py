# SPDX-License-Identifier: GPL-3.0-or-later
"""Changing the requests of the selected characters: of all of them or, after an error, of none."""

import random
from pathlib import Path

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import library, measures
from ..services import character, regeneration
from ..state import definitions, requests
from .base import ChangesCharacter, NeedsCharacter, reports_errors


def _change_selected(context, new_fields):
    """Gives each selected character the request whose fields ``new_fields(index, settings)`` returns."""
    changes = [
        (rig, requests.from_fields(new_fields(index, rig.anthronet)))
        for index, rig in enumerate(character.selected(context))
    ]
    regeneration.apply_requests(changes, context)
    return {"FINISHED"}


def _with_measures(settings, changed):
    """The fields of a request with some measures changed: ``changed`` goes from all measures, by name as (metres, given), to
    those that are replaced."""
    values = settings.measures()
    values.update(changed(dict(values)))
    return settings.request_fields(measures={name: value for name, (value, given) in values.items() if given})


class ANTHRONET_OT_randomise(ChangesCharacter, bpy.types.Operator):
    """Randomize the selected characters"""

    bl_idname = "anthronet.randomise"
    bl_label = "Randomize"
    bl_options = {"REGISTER", "UNDO"}

    what: EnumProperty(
        name="Randomize",
        description="What gets random values",
        items=(
            ("ALL", "All", "All measures that are not given, and the identity"),
            ("IDENTITY", "Identity Only", "The identity. All measures that are given are kept"),
        ),
    )
    seed: IntProperty(name="Seed", description="Seed of the random values. 0: a random seed", min=0)

    @reports_errors
    def execute(self, context):
        if self.seed == 0:
            # Stored, so that Adjust Last Operation shows the seed of the characters that are seen.
            self.seed = random.SystemRandom().randrange(1, definitions.LARGEST_SEED)

        def randomized(index, settings):
            seed = (self.seed + index - 1) % definitions.LARGEST_SEED + 1
            if self.what == "ALL":
                fields = settings.request_fields(seed=seed, fill="sample")
                fields.pop("z", None)
                return fields
            # The seed stays, since it may have selected the missing measures; the new identity is set by hand.
            request = library.anthronet().Request(sex=settings.body_sex or None, seed=seed)
            identity = library.model().generate(request).latent
            return settings.request_fields(z=[requests.typed_decimal(number) for number in identity])

        return _change_selected(context, randomized)


class ANTHRONET_OT_mirror(ChangesCharacter, bpy.types.Operator):
    """Swap the given measures of the left and the right side of the selected characters"""

    bl_idname = "anthronet.mirror"
    bl_label = "Mirror Measures"
    bl_options = {"REGISTER", "UNDO"}

    @reports_errors
    def execute(self, context):
        def mirrored(values):
            return {measure.name: values[measure.mirrored] for measure in measures.all_measures()}

        return _change_selected(context, lambda _, settings: _with_measures(settings, mirrored))


class ANTHRONET_OT_symmetrise(ChangesCharacter, bpy.types.Operator):
    """Copy the measures of one side to the other side, for the selected characters"""

    bl_idname = "anthronet.symmetrise"
    bl_label = "Symmetrize Measures"
    bl_options = {"REGISTER", "UNDO"}

    side: EnumProperty(
        name="From",
        description="Side whose measures are copied",
        items=(("left", "Left", "Copy from left to right"), ("right", "Right", "Copy from right to left")),
    )

    @reports_errors
    def execute(self, context):
        sources = [measure for measure in measures.all_measures() if measure.side == self.side]

        def symmetrized(values):
            return {measure.mirrored: values[measure.name] for measure in sources}

        return _change_selected(context, lambda _, settings: _with_measures(settings, symmetrized))


class ANTHRONET_OT_unset_measures(ChangesCharacter, bpy.types.Operator):
    """Make all measures of the selected characters not given, so that they are predicted"""

    bl_idname = "anthronet.unset_measures"
    bl_label = "Clear All Measures"
    bl_options = {"REGISTER", "UNDO"}

    @reports_errors
    def execute(self, context):
        return _change_selected(context, lambda _, settings: settings.request_fields(measures={}))


class ANTHRONET_OT_copy_request(ChangesCharacter, bpy.types.Operator):
    """Copy the request of the active character to the other selected characters"""

    bl_idname = "anthronet.copy_request"
    bl_label = "Copy to Selected"
    bl_options = {"REGISTER", "UNDO"}

    @reports_errors
    def execute(self, context):
        active, *others = character.selected(context)
        request = active.anthronet.request()
        regeneration.apply_requests([(rig, request) for rig in others], context)
        self.report({"INFO"}, f"{len(others)} characters changed")
        return {"FINISHED"}


class ANTHRONET_OT_make_local(NeedsCharacter, bpy.types.Operator):
    """Make the selected characters local to this file if they are linked or library overrides, so that they can be changed"""

    bl_idname = "anthronet.make_local"
    bl_label = "Make Local"
    bl_options = {"REGISTER", "UNDO"}

    @reports_errors
    def execute(self, context):
        for rig in character.selected(context):
            character.make_local(rig)
        return {"FINISHED"}


class ANTHRONET_OT_request_save(NeedsCharacter, bpy.types.Operator, ExportHelper):
    """Save the request of the active character as a JSON file, which the command line program reads, too"""

    bl_idname = "anthronet.request_save"
    bl_label = "Save Request"

    filename_ext = ".json"
    filter_glob: StringProperty(
        name="File Filter", description="Files that are shown", default="*.json", options={"HIDDEN"}
    )

    @reports_errors
    def execute(self, context):
        text = character.active(context).anthronet.request().to_json()
        Path(bpy.path.abspath(self.filepath)).write_text(text + "\n", encoding="utf-8")
        return {"FINISHED"}


class ANTHRONET_OT_request_load(ChangesCharacter, bpy.types.Operator, ImportHelper):
    """Apply the request of a JSON file to the selected characters"""

    bl_idname = "anthronet.request_load"
    bl_label = "Load Request"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(
        name="File Filter", description="Files that are shown", default="*.json", options={"HIDDEN"}
    )

    @reports_errors
    def execute(self, context):
        text = Path(bpy.path.abspath(self.filepath)).read_text(encoding="utf-8")
        request = library.anthronet().Request.from_json(text)
        regeneration.apply_requests([(rig, request) for rig in character.selected(context)], context)
        return {"FINISHED"}


CLASSES = (
    ANTHRONET_OT_randomise,
    ANTHRONET_OT_mirror,
    ANTHRONET_OT_symmetrise,
    ANTHRONET_OT_unset_measures,
    ANTHRONET_OT_copy_request,
    ANTHRONET_OT_make_local,
    ANTHRONET_OT_request_save,
    ANTHRONET_OT_request_load,
)
