# SPDX-License-Identifier: GPL-3.0-or-later
"""A Rigify metarig for a character."""

import bpy

from ..services import character, metarig
from .base import NeedsCharacter, poll_object_mode, reports_errors


class ANTHRONET_OT_metarig_add(NeedsCharacter, bpy.types.Operator):
    """Adds a metarig."""

    bl_idname = "anthronet.metarig_add"
    bl_label = "Add Rigify Metarig"
    bl_description = (
        "Add Rigify's human metarig with the rest pose of the active character. Generate Rig makes a control rig from it, and "
        "Apply Motion of Armature retargets the motion of that rig to the character"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context) or not poll_object_mode(cls, context):
            return False
        if not metarig.is_available(context):
            cls.poll_message_set("Enable the add-on Rigify, which comes with Blender")
            return False
        return True

    @reports_errors
    def execute(self, context):
        added = metarig.create(context, character.active(context))
        self.report({"INFO"}, f"Added {added.name}")
        return {"FINISHED"}


CLASSES = (ANTHRONET_OT_metarig_add,)
