# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user or a script can do: every operator checks, calls a service and reports."""


def _modules():
    from . import add, clip, edit, files, measure, rigify

    return (add, clip, edit, files, measure, rigify)


def register():
    import bpy

    for module in _modules():
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)


def unregister():
    import bpy

    for module in reversed(_modules()):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
