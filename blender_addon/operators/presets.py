# SPDX-License-Identifier: GPL-3.0-or-later
"""Saving and applying presets of requests, in Blender's own preset system."""

import bpy
from bl_operators.presets import AddPresetBase

from .. import measures
from ..services import character, regeneration
from ..state.properties import updates_suspended
from .base import ChangesCharacter, NeedsCharacter, reports_errors

#: Folder of the presets, within Blender's folder of presets.
SUBDIRECTORY = "anthronet"
_EXTENSION = __package__.rpartition(".")[0]


def _preset_properties():
    """The properties that a preset stores: the request, without what depends on the scene (detail, bone names, skin tone)."""
    names = ["sex", "seed", "fill", "nearest", "identity_by_hand", "identity"]
    return names + [name for measure in measures.names() for name in (measure, f"given_{measure}")]


class ANTHRONET_OT_preset_add(NeedsCharacter, AddPresetBase, bpy.types.Operator):
    """Save the request of the active character as a preset, or remove a preset"""

    bl_idname = "anthronet.preset_add"
    bl_label = "Add AnthroNet Preset"
    preset_menu = "ANTHRONET_PT_presets"
    preset_subdir = SUBDIRECTORY
    # These lines are in the presets that users have saved: the module and the function keep their names.
    preset_defines = [
        "from importlib import import_module",
        f"settings = import_module('{_EXTENSION}.services.character').active(bpy.context).anthronet",
    ]

    @property
    def preset_values(self):
        """The expressions that are written to the preset."""
        return [f"settings.{name}" for name in _preset_properties()]


class ANTHRONET_OT_preset_apply(ChangesCharacter, bpy.types.Operator):
    """Apply the request of a preset to the selected characters"""

    bl_idname = "anthronet.preset_apply"
    bl_label = "Apply AnthroNet Preset"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(
        name="File", description="Path of the preset", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    menu_idname: bpy.props.StringProperty(
        name="Menu", description="Menu that the preset was chosen from", options={"SKIP_SAVE", "HIDDEN"}
    )

    @reports_errors
    def execute(self, context):
        settings = character.active(context).anthronet
        # A preset is a script that sets properties of the active character. They are read and then restored, so that the
        # change is applied like every other one.
        before = {name: _copied(getattr(settings, name)) for name in _preset_properties()}
        with updates_suspended():
            try:
                bpy.utils.execfile(bpy.path.abspath(self.filepath))
                request = settings.request()
            except Exception as error:
                raise ValueError(f"{self.filepath}: expected a preset of AnthroNet: {error}") from error
            finally:
                for name, value in before.items():
                    setattr(settings, name, value)
        regeneration.apply_requests([(rig, request) for rig in character.selected(context)], context)
        return {"FINISHED"}


def _copied(value):
    """The value of a property, as a list where Blender gives a view of an array."""
    return value if isinstance(value, (bool, int, float, str)) else list(value)


CLASSES = (ANTHRONET_OT_preset_add, ANTHRONET_OT_preset_apply)
