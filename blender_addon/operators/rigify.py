# SPDX-License-Identifier: GPL-3.0-or-later
"""A Rigify metarig for a character."""

import bpy

from ..services import character, metarig
from .base import NeedsCharacter, reported


class ANTHRONET_OT_metarig_add(NeedsCharacter, bpy.types.Operator):
    """Add Rigify's human metarig in the size and stance of the active character. Generate Rig makes a control rig of it, whose
    motion Apply Motion of Armature brings onto the character"""

    bl_idname = "anthronet.metarig_add"
    bl_label = "Add Rigify Metarig"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to object mode")
            return False
        if not metarig.is_available(context):
            cls.poll_message_set("Enable the add-on Rigify, which comes with Blender")
            return False
        return True

    @reported
    def execute(self, context):
        made = metarig.add(context, character.active(context))
        self.report({"INFO"}, f"Added {made.name}")
        return {"FINISHED"}


CLASSES = (ANTHRONET_OT_metarig_add,)
