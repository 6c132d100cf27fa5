# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that differs between Blender 4.2, 4.5 and 5.0."""

import bpy

#: Whether actions have slots and layers (4.4 and newer).
HAS_SLOTS = bpy.app.version >= (4, 4, 0)


def new_curves(action, armature_object):
    """An empty action's curves for an object: something with ``new(data_path=…, index=…)`` that also sorts them into groups."""
    if not HAS_SLOTS:
        return lambda path, index, group: action.fcurves.new(path, index=index, action_group=group)
    slot = action.slots.new(id_type="OBJECT", name=armature_object.name)
    layer = action.layers.new("Layer")
    strip = layer.strips.new(type="KEYFRAME")
    bag = strip.channelbag(slot, ensure=True)

    def new(path, index, group):
        curve = bag.fcurves.new(path, index=index)
        curve.group = bag.groups.get(group) or bag.groups.new(group)
        return curve

    return new


def assign(armature_object, action):
    """Makes an object play an action. The slot is named: an action that is assigned to a second object plays nothing."""
    animation = armature_object.animation_data or armature_object.animation_data_create()
    animation.action = action
    if HAS_SLOTS:
        slots = [slot for slot in action.slots if slot.target_id_type in ("OBJECT", "UNSPECIFIED")]
        if slots:
            animation.action_slot = slots[0]
    return animation


def add_strip(armature_object, action, start):
    """Puts an action on a new track of the non-linear animation."""
    animation = armature_object.animation_data or armature_object.animation_data_create()
    track = animation.nla_tracks.new()
    track.name = action.name
    strip = track.strips.new(action.name, start, action)
    if HAS_SLOTS and action.slots:
        strip.action_slot = action.slots[0]
    return strip
