# SPDX-License-Identifier: GPL-3.0-or-later
"""AnthroNet for Blender: rigged characters from body measures.

Imports go one way: ``ui`` → ``operators`` → ``services`` → ``state`` → ``library``, ``measures``, ``units`` and ``compat``.
``tests/blender/import_order.py`` checks that."""

from . import operators, state, ui
from .services import property_callbacks


def register():
    # Only here are the property groups connected with the callbacks for their changes.
    state.register(property_callbacks.callback_for)
    operators.register()
    ui.register()


def unregister():
    ui.unregister()
    operators.unregister()
    state.unregister()
