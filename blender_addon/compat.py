# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that differs between Blender 4.2, 4.5 and 5.0."""

from contextlib import contextmanager

import bpy

#: Whether actions have slots and layers (4.4 and newer).
HAS_SLOTS = bpy.app.version >= (4, 4, 0)


def new_curves(action, title):
    """Empties an action for an object's curves: a function of data path, index and group that makes one more."""
    if not HAS_SLOTS:
        action.fcurves.clear()
        return lambda path, index, group: action.fcurves.new(path, index=index, action_group=group)
    slot = object_slot(action) or action.slots.new(id_type="OBJECT", name=title)
    layer = action.layers[0] if action.layers else action.layers.new("Layer")
    strip = layer.strips[0] if layer.strips else layer.strips.new(type="KEYFRAME")
    bag = strip.channelbag(slot, ensure=True)
    bag.fcurves.clear()

    def new(path, index, group):
        curve = bag.fcurves.new(path, index=index)
        curve.group = bag.groups.get(group) or bag.groups.new(group)
        return curve

    return new


def object_slot(action, name=""):
    """The slot of an action that an object plays: the named one, or the first that suits. None where there is none, or where
    actions have no slots."""
    if not HAS_SLOTS:
        return None
    suitable = [slot for slot in action.slots if slot.target_id_type in ("OBJECT", "UNSPECIFIED")]
    if name:
        suitable = [slot for slot in suitable if name in (slot.name_display, slot.identifier)]
        if not suitable:
            known = ", ".join(slot.name_display for slot in action.slots) or "none"
            raise ValueError(f"slot: expected one of {known}, got {name}")
    return suitable[0] if suitable else None


def assign(ob, action, slot=None):
    """Makes an object or key play an action. The slot is named: an action that is assigned to a second object plays nothing."""
    animation = ob.animation_data or ob.animation_data_create()
    animation.action = action
    if HAS_SLOTS and action is not None:
        found = slot or object_slot(action)
        if found is not None:
            animation.action_slot = found
    return animation


def played(block):
    """The action that a data-block plays, and its slot: a pair, None for what there is not."""
    animation = block.animation_data
    if animation is None or animation.action is None:
        return None, None
    return animation.action, animation.action_slot if HAS_SLOTS else None


@contextmanager
def assigned(ob, action, slot_name=""):
    """An object that plays an action for a while."""
    had = ob.animation_data is not None
    before, slot_before = played(ob)
    slot = object_slot(action, slot_name)
    try:
        assign(ob, action, slot)
        yield
    finally:
        if had:
            assign(ob, before, slot_before)
        else:
            ob.animation_data_clear()


def add_strip(ob, action, start, slot=None):
    """Puts an action on a new track of the non-linear animation."""
    animation = ob.animation_data or ob.animation_data_create()
    track = animation.nla_tracks.new()
    track.name = action.name
    strip = track.strips.new(action.name, int(start), action)
    if HAS_SLOTS:
        found = slot or object_slot(action)
        if found is not None:
            strip.action_slot = found
    return strip


def push_down(ob):
    """Makes the action that an object plays a strip, as Blender's *Push Down*: what comes on tracks above it is then seen."""
    action, slot = played(ob)
    if action is None:
        return
    animation = ob.animation_data
    animation.action = None
    strip = add_strip(ob, action, action.frame_range[0], slot)
    strip.extrapolation = animation.action_extrapolation
