# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and menu entries. They show properties and operators and change nothing."""

from . import menu, panel, presets

_MODULES = (presets, panel, menu)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
