# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share: polls for characters, and errors that a user can read."""

from functools import wraps

from .. import library
from ..services import character, live


class NeedsCharacter:
    """An operator on the active character."""

    @classmethod
    def poll(cls, context):
        """Whether there is one."""
        if character.active(context) is None:
            cls.poll_message_set("Select an AnthroNet character")
            return False
        return True


class ChangesCharacter(NeedsCharacter):
    """An operator that changes the selected characters."""

    @classmethod
    def poll(cls, context):
        """Whether there is one that can be changed."""
        owner = character.active(context)
        if owner is None:
            cls.poll_message_set("Select an AnthroNet character")
            return False
        reason = live.refusal(owner, context)
        if reason:
            cls.poll_message_set(reason)
            return False
        return True


def reported(method):
    """An operator's ``execute`` whose failures become reports in words."""

    @wraps(method)
    def run(self, context):
        try:
            return method(self, context)
        except library.failures() as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return run
