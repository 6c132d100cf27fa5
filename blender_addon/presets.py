# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of requests, in Blender's own preset system."""

import bpy
from bl_operators.presets import AddPresetBase

from . import measures

_SUBDIRECTORY = "anthronet"


class ANTHRONET_MT_presets(bpy.types.Menu):
    """Requests that were saved"""

    bl_label = "AnthroNet Presets"
    preset_subdir = _SUBDIRECTORY
    preset_operator = "anthronet.preset_apply"

    def draw(self, context):
        self.layout.operator("anthronet.preset_add", icon="ADD")
        bpy.types.Menu.draw_preset(self, context)


class ANTHRONET_OT_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the active character's request as a preset"""

    bl_idname = "anthronet.preset_add"
    bl_label = "Add AnthroNet Preset"
    preset_menu = "ANTHRONET_MT_presets"
    preset_subdir = _SUBDIRECTORY
    preset_defines = [
        "from importlib import import_module",
        f"settings = import_module('{__package__}.services.character').active(bpy.context).anthronet",
    ]

    @classmethod
    def poll(cls, context):
        from .services import character

        return character.active(context) is not None

    @property
    def preset_values(self):
        """What a preset keeps: the request; not detail, names and tone, which are a scene's choice."""
        names = ["sex", "seed", "fill", "nearest", "identity_by_hand", "identity"]
        names += [name for measure in measures.names() for name in (measure, f"given_{measure}")]
        return [f"settings.{name}" for name in names]


class ANTHRONET_OT_preset_apply(bpy.types.Operator):
    """Give the active character the request of a preset"""

    bl_idname = "anthronet.preset_apply"
    bl_label = "Apply AnthroNet Preset"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    menu_idname: bpy.props.StringProperty(name="Menu", options={"SKIP_SAVE", "HIDDEN"})

    @classmethod
    def poll(cls, context):
        from .services import character

        return character.active(context) is not None

    def execute(self, context):
        from . import properties
        from .services import character, live

        owner = character.active(context)
        with properties.silent():
            bpy.utils.execfile(self.filepath)
        if live.regenerate(owner, context):
            return {"FINISHED"}
        self.report({"ERROR"}, owner.anthronet.error)
        return {"CANCELLED"}


CLASSES = (ANTHRONET_MT_presets, ANTHRONET_OT_preset_add, ANTHRONET_OT_preset_apply)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
