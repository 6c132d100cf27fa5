# SPDX-License-Identifier: GPL-3.0-or-later
"""Measuring meshes, and characters made from what was measured."""

import bpy
from bpy.props import BoolProperty

from .. import units
from ..services import character, live
from ..state.requests import from_fields
from .base import ChangesCharacter, NeedsCharacter, reported


class ANTHRONET_OT_measure_selected(NeedsCharacter, bpy.types.Operator):
    """Measure the active character's mesh as it is now, sculpted or not, show the result and keep it as a property"""

    bl_idname = "anthronet.measure_selected"
    bl_label = "Measure"
    bl_options = {"REGISTER", "UNDO"}

    popup: BoolProperty(
        name="Show",
        description="Show the measures in a window of their own",
        default=True,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @reported
    def execute(self, context):
        owner = character.active(context)
        measured = character.measured(owner)
        if owner.library is None:
            owner["anthronet_measured"] = {
                **measured.measures,
                "mass_kg": measured.mass_kg,
                "volume_m3": measured.volume_m3,
            }
        for name, value in measured.measures.items():
            self.report({"INFO"}, f"{name}: {units.length(context.scene, value)}")
        if self.popup and not bpy.app.background:
            context.window_manager.popup_menu(
                lambda menu, opened: _draw(menu.layout, opened.scene, measured),
                title="Measures",
                icon="DRIVER_DISTANCE",
            )
        return {"FINISHED"}


class ANTHRONET_OT_fit_selected(ChangesCharacter, bpy.types.Operator):
    """Give the selected characters the measures of their own meshes as they are now, so that sculpting becomes measures. Where
    nobody has such measures, sculpting stays as it is"""

    bl_idname = "anthronet.fit_selected"
    bl_label = "Measures from Mesh"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        requests = []
        for owner in character.selected(context):
            found = {name: float(f"{value:.7g}") for name, value in character.measured(owner).measures.items()}
            requests.append((owner, from_fields(owner.anthronet.request_fields(measures=found))))
        live.change(requests, context, forget_sculpting=True)
        return {"FINISHED"}


def _draw(layout, scene, measured):
    columns = layout.grid_flow(columns=2, even_columns=True)
    for name, value in measured.measures.items():
        columns.label(text=f"{name.replace('_', ' ')}: {units.length(scene, value)}")
    layout.separator()
    layout.label(text=f"{units.mass(scene, measured.mass_kg)}, BMI {measured.bmi:.1f}")


CLASSES = (ANTHRONET_OT_measure_selected, ANTHRONET_OT_fit_selected)
