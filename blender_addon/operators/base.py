# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share: a poll for characters, and errors that a user can read."""

from .. import library
from ..services import character


class NeedsCharacter:
    """An operator on the active character."""

    @classmethod
    def poll(cls, context):
        """Whether there is one."""
        if character.active(context) is None:
            cls.poll_message_set("Select an AnthroNet character")
            return False
        return True


def reported(execute):
    """An operator's ``execute`` whose failures become reports in words."""

    def run(self, context):
        try:
            return execute(self, context)
        except library.failures() as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return run
