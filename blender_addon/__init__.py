# SPDX-License-Identifier: GPL-3.0-or-later
"""AnthroNet for Blender: type tape measures, get a person.

Layers, each of which knows only those below it: ``ui`` → ``operators`` → ``services`` → the package ``anthronet``.
``properties`` is what a character keeps in the .blend file; ``compat`` is the only file that knows Blender's versions.
"""


def _modules():
    from . import operators, presets, properties, ui

    return (properties, operators, presets, ui)


def register():
    for module in _modules():
        module.register()


def unregister():
    for module in reversed(_modules()):
        module.unregister()
