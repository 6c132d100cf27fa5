# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and menus. They draw what properties hold and name operators; they change nothing."""


def _modules():
    from . import menu, panel

    return (panel, menu)


def register():
    for module in _modules():
        module.register()


def unregister():
    for module in reversed(_modules()):
        module.unregister()
