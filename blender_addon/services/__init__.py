# SPDX-License-Identifier: GPL-3.0-or-later
"""From the library's arrays to Blender's data and back. No operators, no drawing."""
