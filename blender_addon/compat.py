# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that differs between Blender 4.2, 4.5 and 5.0. No other module depends on Blender's version.

In all functions ``block`` is a data-block that can be animated: an object, or the shape keys of a mesh."""

from contextlib import contextmanager

import bpy

#: Whether actions have slots and layers: from Blender 4.4 on.
HAS_SLOTS = bpy.app.version >= (4, 4, 0)


def clear_fcurves(action, slot_name):
    """Removes the F-curves of an action for objects and returns a function that adds one: ``(data_path, index, group)``.
    ``slot_name``: for the slot, if a new one is needed."""
    if not HAS_SLOTS:
        action.fcurves.clear()
        return lambda path, index, group: action.fcurves.new(path, index=index, action_group=group)
    slot = object_slot(action) or action.slots.new(id_type="OBJECT", name=slot_name)
    layer = action.layers[0] if action.layers else action.layers.new("Layer")
    strip = layer.strips[0] if layer.strips else layer.strips.new(type="KEYFRAME")
    channelbag = strip.channelbag(slot, ensure=True)
    channelbag.fcurves.clear()

    def new_fcurve(path, index, group):
        fcurve = channelbag.fcurves.new(path, index=index)
        fcurve.group = channelbag.groups.get(group) or channelbag.groups.new(group)
        return fcurve

    return new_fcurve


def object_slot(action, name=""):
    """The slot of an action that animates an object: the named one, or else the first that can. None if there is none, or if
    this Blender's actions have no slots."""
    if not HAS_SLOTS:
        return None
    suitable = [slot for slot in action.slots if slot.target_id_type in ("OBJECT", "UNSPECIFIED")]
    if name:
        suitable = [slot for slot in suitable if name in (slot.name_display, slot.identifier)]
        if not suitable:
            known = ", ".join(slot.name_display for slot in action.slots) or "none"
            raise ValueError(f"slot: expected one of {known}, got {name}")
    return suitable[0] if suitable else None


def assign_action(block, action, slot=None):
    """Assigns an action and its slot. Without the slot, an action that was made for another object would animate nothing."""
    animation = block.animation_data or block.animation_data_create()
    animation.action = action
    if HAS_SLOTS and action is not None:
        slot = slot or object_slot(action)
        if slot is not None:
            animation.action_slot = slot


def assigned_action(block):
    """The assigned action and its slot; None for each that there is not."""
    animation = block.animation_data
    if animation is None or animation.action is None:
        return None, None
    return animation.action, animation.action_slot if HAS_SLOTS else None


@contextmanager
def temporarily_assigned(block, action, slot_name=""):
    """Assigns an action for the duration of a ``with`` statement."""
    had_animation = block.animation_data is not None
    before, slot_before = assigned_action(block)
    slot = object_slot(action, slot_name)
    try:
        assign_action(block, action, slot)
        yield
    finally:
        if had_animation:
            assign_action(block, before, slot_before)
        else:
            block.animation_data_clear()


def add_strip(block, action, start, slot=None):
    """Adds an action as a strip on a new NLA track."""
    animation = block.animation_data or block.animation_data_create()
    track = animation.nla_tracks.new()
    track.name = action.name
    strip = track.strips.new(action.name, int(start), action)
    if HAS_SLOTS:
        slot = slot or object_slot(action)
        if slot is not None:
            strip.action_slot = slot
    return strip


def push_down(block):
    """Turns the assigned action into an NLA strip, as Blender's *Push Down Action* does, so that it no longer overrides the
    tracks."""
    action, slot = assigned_action(block)
    if action is None:
        return
    animation = block.animation_data
    animation.action = None
    strip = add_strip(block, action, action.frame_range[0], slot)
    strip.extrapolation = animation.action_extrapolation
