# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share: a poll for characters, and errors that a user can read."""

from functools import wraps

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


def reported(method):
    """An operator's method whose failures become reports in words."""

    def failed(self, error):
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    # Blender counts the arguments, so there is one wrapper for ``execute`` and one for ``invoke`` and ``modal``.
    if method.__code__.co_argcount == 2:

        @wraps(method)
        def run(self, context):
            try:
                return method(self, context)
            except library.failures() as error:
                return failed(self, error)

    else:

        @wraps(method)
        def run(self, context, event):
            try:
                return method(self, context, event)
            except library.failures() as error:
                return failed(self, error)

    return run
