# SPDX-License-Identifier: GPL-3.0-or-later
"""What a character stores in the .blend file: property groups, plain data.

Nothing in here knows what a change of a property does. The update callbacks are handed to :func:`register` by the root of the
extension."""

from . import properties


def register(update_for):
    """Registers the property groups. ``update_for``: from a property's name to its update callback."""
    properties.register(update_for)


def unregister():
    properties.unregister()
