# SPDX-License-Identifier: GPL-3.0-or-later
"""Measuring the meshes of characters."""

import bpy
from bpy.props import BoolProperty

from .. import units
from ..services import character, regeneration
from ..state.requests import from_fields, typed_decimal
from .base import ChangesCharacter, NeedsCharacter, reports_errors


class ANTHRONET_OT_measure_selected(NeedsCharacter, bpy.types.Operator):
    """Measures the mesh of the active character."""

    bl_idname = "anthronet.measure_selected"
    bl_label = "Measure"
    bl_description = (
        "Measure the mesh of the active character as it is now, sculpted or not. The result is shown and stored in the custom "
        "property anthronet_measured"
    )
    bl_options = {"REGISTER", "UNDO"}

    popup: BoolProperty(
        name="Show Result",
        description="Show the measures in a pop-up",
        default=True,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @reports_errors
    def execute(self, context):
        rig = character.active(context)
        measured = character.measure_mesh(rig)
        if rig.library is None:
            rig["anthronet_measured"] = {
                **measured.measures,
                "mass_kg": measured.mass_kg,
                "volume_m3": measured.volume_m3,
            }
        for name, value in measured.measures.items():
            self.report({"INFO"}, f"{name}: {units.length(context.scene, value)}")
        if self.popup and not bpy.app.background:
            context.window_manager.popup_menu(
                lambda menu, menu_context: _draw_measures(menu.layout, menu_context.scene, measured),
                title="Measures",
                icon="DRIVER_DISTANCE",
            )
        return {"FINISHED"}


class ANTHRONET_OT_fit_selected(ChangesCharacter, bpy.types.Operator):
    """Makes sculpting a part of the request."""

    bl_idname = "anthronet.fit_selected"
    bl_label = "Measures from Mesh"
    bl_description = (
        "Measure the meshes of the selected characters and request these measures, so that sculpting becomes part of the "
        "request. If no body can have the measures, nothing changes"
    )
    bl_options = {"REGISTER", "UNDO"}

    @reports_errors
    def execute(self, context):
        requests = []
        for rig in character.selected(context):
            measured = character.measure_mesh(rig).measures
            measured = {name: typed_decimal(value) for name, value in measured.items()}
            requests.append((rig, from_fields(rig.anthronet.request_fields(measures=measured))))
        regeneration.apply_requests(requests, context, discard_sculpting=True)
        return {"FINISHED"}


def _draw_measures(layout, scene, measured):
    columns = layout.grid_flow(columns=2, even_columns=True)
    for name, value in measured.measures.items():
        columns.label(text=f"{name.replace('_', ' ')}: {units.length(scene, value)}")
    layout.separator()
    layout.label(text=f"{units.mass(scene, measured.mass_kg)}, {units.body_mass_index(measured.bmi)}")


CLASSES = (ANTHRONET_OT_measure_selected, ANTHRONET_OT_fit_selected)
