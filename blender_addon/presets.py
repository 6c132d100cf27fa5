# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of requests, in Blender's own preset system."""

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from . import measures, properties
from .operators.base import ChangesCharacter, NeedsCharacter, reported

_SUBDIRECTORY = "anthronet"


def _kept():
    """The properties that a preset keeps: the request; not detail, names and tone, which are a scene's choice."""
    names = ["sex", "seed", "fill", "nearest", "identity_by_hand", "identity"]
    return names + [name for one in measures.names() for name in (one, f"given_{one}")]


class ANTHRONET_PT_presets(PresetPanel, bpy.types.Panel):
    """Requests that were saved"""

    bl_label = "AnthroNet Presets"
    preset_subdir = _SUBDIRECTORY
    preset_operator = "anthronet.preset_apply"
    preset_add_operator = "anthronet.preset_add"


class ANTHRONET_OT_preset_add(NeedsCharacter, AddPresetBase, bpy.types.Operator):
    """Save the active character's request as a preset, or remove one"""

    bl_idname = "anthronet.preset_add"
    bl_label = "Add AnthroNet Preset"
    preset_menu = "ANTHRONET_PT_presets"
    preset_subdir = _SUBDIRECTORY
    preset_defines = [
        "from importlib import import_module",
        f"settings = import_module('{__package__}.services.character').active(bpy.context).anthronet",
    ]

    @property
    def preset_values(self):
        """The properties that are written."""
        return [f"settings.{name}" for name in _kept()]


class ANTHRONET_OT_preset_apply(ChangesCharacter, bpy.types.Operator):
    """Give the selected characters the request of a preset"""

    bl_idname = "anthronet.preset_apply"
    bl_label = "Apply AnthroNet Preset"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(
        name="File", description="The preset's", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    menu_idname: bpy.props.StringProperty(
        name="Menu", description="Where it was chosen", options={"SKIP_SAVE", "HIDDEN"}
    )

    @reported
    def execute(self, context):
        from .services import character, live

        settings = character.active(context).anthronet
        # A preset is a script that sets the active character's properties: they are only looked at.
        before = {name: _plain(getattr(settings, name)) for name in _kept()}
        with properties.silent():
            try:
                bpy.utils.execfile(bpy.path.abspath(self.filepath))
                request = settings.request()
            except Exception as error:
                raise ValueError(f"{self.filepath}: expected a preset of AnthroNet: {error}") from error
            finally:
                for name, value in before.items():
                    setattr(settings, name, value)
        live.change([(owner, request) for owner in character.selected(context)], context)
        return {"FINISHED"}


def _plain(value):
    return value if isinstance(value, (bool, int, float, str)) else list(value)


CLASSES = (ANTHRONET_PT_presets, ANTHRONET_OT_preset_add, ANTHRONET_OT_preset_apply)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
