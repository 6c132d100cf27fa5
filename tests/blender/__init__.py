"""The parts of blender_addon.py, by what they are about."""
