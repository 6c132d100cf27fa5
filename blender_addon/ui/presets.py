# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of presets in the header of the panel *Person*."""

import bpy
from bl_ui.utils import PresetPanel

from ..operators.presets import SUBDIRECTORY


class ANTHRONET_PT_presets(PresetPanel, bpy.types.Panel):
    """Saved requests"""

    bl_label = "AnthroNet Presets"
    preset_subdir = SUBDIRECTORY
    preset_operator = "anthronet.preset_apply"
    preset_add_operator = "anthronet.preset_add"


def register():
    bpy.utils.register_class(ANTHRONET_PT_presets)


def unregister():
    bpy.utils.unregister_class(ANTHRONET_PT_presets)
