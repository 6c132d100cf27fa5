# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: what users and scripts can do. Each checks its input, calls a service and reports the outcome."""

import bpy

from . import add, clip, edit, export, measure, presets, rigify

_MODULES = (add, clip, edit, export, measure, presets, rigify)


def register():
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)


def unregister():
    for module in reversed(_MODULES):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
