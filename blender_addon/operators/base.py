# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share: conditions for being available, and reports of errors."""

from functools import wraps

from .. import library
from ..services import character, regeneration


def poll_object_mode(cls, context):
    """Part of the ``poll`` of an operator class: whether Blender is in object mode."""
    if context.mode != "OBJECT":
        cls.poll_message_set("Switch to object mode")
        return False
    return True


class NeedsCharacter:
    """Mix-in for operators that use the active character."""

    @classmethod
    def poll(cls, context):
        """Whether a character is active."""
        if character.active(context) is None:
            cls.poll_message_set("Select an AnthroNet character")
            return False
        return True


class ChangesCharacter(NeedsCharacter):
    """Mix-in for operators that change the selected characters."""

    @classmethod
    def poll(cls, context):
        """Whether the active character can be changed."""
        if not super().poll(context):
            return False
        reason = regeneration.reason_not_editable(character.active(context), context)
        if reason:
            cls.poll_message_set(reason)
            return False
        return True


def reports_errors(execute):
    """Decorator for ``execute`` of an operator: errors that are meant for the user become reports."""

    @wraps(execute)
    def run(self, context):
        try:
            return execute(self, context)
        except library.failures() as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return run
