# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths and masses as the scene shows them. A character is a metre a Blender unit; where the scene's *Unit Scale* is another
one, Blender's own sliders show it times that, and so do these."""

import bpy


def length(scene, metres, precision=4):
    """A length, as a slider of the scene shows it."""
    settings = scene.unit_settings
    if settings.system == "NONE":
        return f"{metres:.{precision}f}"
    return bpy.utils.units.to_string(
        settings.system,
        "LENGTH",
        metres * settings.scale_length,
        precision=precision,
        split_unit=settings.use_separate,
    )


def millimetres(scene, metres):
    """A small difference of lengths, with its sign."""
    settings = scene.unit_settings
    if settings.system == "IMPERIAL":
        return f"{metres * settings.scale_length / 0.0254:+.4f} in"
    if settings.system == "NONE":
        return f"{metres:+.6f}"
    return f"{1000 * metres * settings.scale_length:+.2f} mm"


def mass(scene, kilograms):
    """A mass."""
    if scene.unit_settings.system == "IMPERIAL":
        return f"{kilograms / 0.45359237:.1f} lb"
    return f"{kilograms:.1f} kg"
