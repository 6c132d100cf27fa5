# SPDX-License-Identifier: GPL-3.0-or-later
"""Sources of motion: built-in clips, files, other armatures. A source is a dictionary of plain values that an action stores, so
that its clip can be made again after the body changed.

``kind`` is ``builtin`` (with ``name``), ``file`` (``path``, ``clip``, ``person``, ``up``, ``scale``) or ``armature`` (``object``,
``action``, ``slot``, ``start``, ``end``). All have ``frame_start``, ``at_scene_rate`` and ``options``, those of retargeting."""

import contextlib

import bpy

from .. import compat, library
from .sampling import frames_per_second, sample_motion


def read(source, context):
    """The motion of a source before it is retargeted; None for a built-in clip. A generator that yields the progress."""
    if source["kind"] == "file":
        return _read_file(source)
    if source["kind"] == "armature":
        return (yield from _read_armature(source, context))
    return None


def _read_file(source):
    up, scale = source["up"], source["scale"]
    return library.anthronet().open_motion(
        bpy.path.abspath(source["path"]),
        metres_per_unit=scale or None,
        up=None if up == "FOUND" else up.lower(),
        # Actions of older releases have none; for the first person the library says how many there are.
        person=source.get("person") or None,
    )


def _read_armature(source, context):
    ob = context.scene.objects.get(source["object"])
    if ob is None or ob.type != "ARMATURE":
        raise ValueError(f"source: expected an armature of the scene, got {source['object']}")
    chosen = None
    if source["action"]:
        chosen = bpy.data.actions.get(source["action"])
        if chosen is None:
            raise ValueError(f"action: expected an action of this file, got {source['action']}")
    action = chosen or compat.assigned_action(ob)[0]
    start, end = source["start"], source["end"]
    if start == 0 and end == 0:
        start, end = _frame_range(action, context.scene)
    name = action.name if action else ob.name
    with compat.temporarily_assigned(ob, chosen, source["slot"]) if chosen else contextlib.nullcontext():
        return (yield from sample_motion(ob, context.scene, start, end, name))


def _frame_range(action, scene):
    """The whole frames of an action; without one those of the scene."""
    if action is None:
        return scene.frame_start, scene.frame_end
    start, end = action.frame_range
    return int(start), max(int(start), round(end))


def make_clip(source, motion, body, scene):
    """The clip for a body; ``motion`` as :func:`read` returned it."""
    rate = frames_per_second(scene) if source["at_scene_rate"] else None
    options = source["options"]
    if source["kind"] != "builtin":
        return motion.retarget(body, clip=source.get("clip", 0), frames_per_second=rate, **options)
    clip = library.anthronet().builtin_clip(source["name"], body)
    if options["in_place"]:
        clip = clip.in_place()
    return clip if rate is None else clip.resample(rate)
