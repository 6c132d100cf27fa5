# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion between the library's arrays and Blender's data-blocks. No operators, no user interface.

In all modules ``rig`` is the armature object of a character, which holds its request, and ``body`` a body that the library
generated. Positions and lengths are metres in Blender's axes, in the object space of the armature."""
