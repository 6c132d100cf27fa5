# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths and masses as text, in the units of the scene.

A character is one metre to a Blender unit. If the scene's *Unit Scale* is not 1, Blender's sliders show lengths multiplied by
it, and these functions do the same."""

import bpy


def length(scene, metres, precision=4):
    """A length, as Blender's sliders show it."""
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


def length_difference(scene, metres):
    """A small difference of lengths with its sign, in millimetres or inches."""
    settings = scene.unit_settings
    if settings.system == "IMPERIAL":
        return f"{metres * settings.scale_length / 0.0254:+.4f} in"
    if settings.system == "NONE":
        return f"{metres:+.6f}"
    return f"{1000 * metres * settings.scale_length:+.2f} mm"


def mass(scene, kilograms):
    """A mass in kilograms or pounds."""
    if scene.unit_settings.system == "IMPERIAL":
        return f"{kilograms / 0.45359237:.1f} lb"
    return f"{kilograms:.1f} kg"


def body_mass_index(bmi):
    """A body mass index."""
    return f"BMI {bmi:.1f} kg/m²"
