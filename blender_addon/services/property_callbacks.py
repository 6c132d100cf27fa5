# SPDX-License-Identifier: GPL-3.0-or-later
"""The update callbacks of a character's properties, called when a user or a script changes one.

:func:`callback_for` is passed to :func:`state.register`, so that the property groups do not depend on services."""

from functools import partial

from .. import measures
from ..state.properties import NO_IDENTITY, are_updates_suspended, updates_suspended
from . import armature, character, material, regeneration


def callback_for(name):
    """The update callback of a property of a character."""
    callback = _CALLBACKS.get(name)
    if callback is None and name in measures.names():
        callback = partial(_measure_changed, name, measures.names().index(name))
    if callback is None and name.startswith("given_"):
        measure = name.removeprefix("given_")
        callback = partial(_given_changed, measure, measures.names().index(measure))
    if callback is None:
        callback = partial(_request_changed, name)

    # Blender accepts functions only, no callable objects.
    def update(settings, context):
        if not are_updates_suspended():
            callback(settings, context)

    return update


def _regenerate(settings, context, *names):
    """Generates a new body after a change of the named properties."""
    if settings.is_character:
        regeneration.apply_property_change(settings.id_data, context, names)


def _request_changed(name, settings, context):
    _regenerate(settings, context, name)


def _measure_changed(name, index, settings, context):
    # When a user cancels a drag with Esc, Blender sets the earlier value through this callback, too. A measure that has the
    # value that was predicted for it counts as not given, so that Esc undoes the change entirely.
    predicted = settings.report[index].filled if index < len(settings.report) else 0.0
    with updates_suspended():
        settings.set_given(name, getattr(settings, name) != predicted)
    _regenerate(settings, context, name, f"given_{name}")


def _given_changed(name, index, settings, context):
    if index < len(settings.report):
        # The user locked the predicted value: from now on it is a given one.
        settings.report[index].filled = 0.0
    _regenerate(settings, context, name, f"given_{name}")


def _identity_changed(settings, context):
    with updates_suspended():
        # As for measures: Esc restores the identity that the seed selected.
        settings.identity_by_hand = list(settings.identity) != list(settings.drawn)
    _regenerate(settings, context, "identity", "identity_by_hand")


def _identity_by_hand_changed(settings, context):
    # Esc must not switch back to the seed.
    settings.drawn = NO_IDENTITY
    _regenerate(settings, context, "identity_by_hand")


def _mesh_changed(settings, context):
    if settings.is_character:
        regeneration.rebuild_mesh(settings.id_data, context)


def _joint_names_changed(settings, _context):
    if settings.is_character:
        armature.rename_bones(settings.id_data, settings.joint_names.lower())


def _skin_tone_changed(settings, _context):
    if settings.is_character and not material.set_skin_tone(
        character.mesh_object(settings.id_data), settings.skin_tone
    ):
        settings.error = "The material of the skin was edited, so it keeps its color"


def _fine_render_changed(settings, _context):
    if settings.is_character:
        character.set_fine_render(settings.id_data, settings.fine_render)


_CALLBACKS = {
    "identity": _identity_changed,
    "identity_by_hand": _identity_by_hand_changed,
    "lod": _mesh_changed,
    "accessories": _mesh_changed,
    "joint_names": _joint_names_changed,
    "skin_tone": _skin_tone_changed,
    "fine_render": _fine_render_changed,
}
