# SPDX-License-Identifier: GPL-3.0-or-later
"""What motions are made of: a built-in clip, a file, another armature. A source is a dictionary of plain values, which an
action keeps so that its clip can be made again for a changed body.

``kind`` is ``builtin`` (``name``), ``file`` (``path``, ``clip``, ``up``, ``scale``) or ``armature`` (``object``, ``action``,
``slot``, ``start``, ``end``). All have ``frame_start``, ``at_scene_rate`` and ``options`` of retargeting."""

import contextlib

import bpy

from .. import compat, library
from . import action


def scene_rate(scene):
    """Frames a second of a scene."""
    return scene.render.fps / scene.render.fps_base


def read(source, context):
    """The motion of a source as it is before it comes onto a body; None for a built-in clip. A generator that yields how far
    it is."""
    if source["kind"] == "file":
        return _file(source)
    if source["kind"] == "armature":
        return (yield from _armature(source, context))
    return None


def _file(source):
    up, scale = source["up"], source["scale"]
    return library.anthronet().open_motion(
        bpy.path.abspath(source["path"]),
        metres_per_unit=scale or None,
        up=None if up == "FOUND" else up.lower(),
    )


def _armature(source, context):
    ob = context.scene.objects.get(source["object"])
    if ob is None or ob.type != "ARMATURE":
        raise ValueError(f"source: expected an armature of the scene, got {source['object']}")
    chosen = None
    if source["action"]:
        chosen = bpy.data.actions.get(source["action"])
        if chosen is None:
            raise ValueError(f"action: expected one of the file's, got {source['action']}")
    playing = chosen or compat.played(ob)[0]
    start, end = source["start"], source["end"]
    if start == 0 and end == 0:
        start, end = frame_range(playing, context.scene)
    name = playing.name if playing else ob.name
    with compat.assigned(ob, chosen, source["slot"]) if chosen else contextlib.nullcontext():
        return (yield from action.motion_of(ob, context.scene, start, end, name))


def frame_range(played, scene):
    """The whole frames of an action, or the scene's where there is none."""
    if played is None:
        return scene.frame_start, scene.frame_end
    start, end = played.frame_range
    return int(start), max(int(start), round(end))


def clip(source, motion, body, scene):
    """The clip of a motion that was read, for a body."""
    rate, options = scene_rate(scene), source["options"]
    if source["kind"] != "builtin":
        return motion.retarget(
            body,
            clip=source.get("clip", 0),
            frames_per_second=rate if source["at_scene_rate"] else None,
            **options,
        )
    made = library.anthronet().builtin_clip(source["name"], body)
    if options["in_place"]:
        made = made.in_place()
    return made.resample(rate) if source["at_scene_rate"] else made
