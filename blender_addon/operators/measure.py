# SPDX-License-Identifier: GPL-3.0-or-later
"""Measuring meshes, and characters made from what was measured."""

import bpy
from bpy.props import BoolProperty

from ..services import character, live, mesh
from .base import NeedsCharacter, reported


class ANTHRONET_OT_measure_selected(NeedsCharacter, bpy.types.Operator):
    """Measure the active character's mesh as it is now, sculpted or not, and show the result"""

    bl_idname = "anthronet.measure_selected"
    bl_label = "Measure"
    bl_options = {"REGISTER"}

    popup: BoolProperty(name="Show", default=True, options={"HIDDEN", "SKIP_SAVE"})

    @reported
    def execute(self, context):
        owner = character.active(context)
        measured = character.measured(owner)
        owner["anthronet_measured"] = {
            **measured.measures,
            "mass_kg": measured.mass_kg,
            "volume_m3": measured.volume_m3,
        }
        for name, value in measured.measures.items():
            self.report({"INFO"}, f"{name}: {1000 * value:.1f} mm")
        if self.popup and not bpy.app.background:
            context.window_manager.popup_menu(
                lambda menu, _context: _draw(menu.layout, measured), title="Measures", icon="DRIVER_DISTANCE"
            )
        return {"FINISHED"}


class ANTHRONET_OT_fit_selected(NeedsCharacter, bpy.types.Operator):
    """Give the active character the measures of its own mesh as it is now, so that sculpting becomes measures"""

    bl_idname = "anthronet.fit_selected"
    bl_label = "Measures from Mesh"
    bl_options = {"REGISTER", "UNDO"}

    @reported
    def execute(self, context):
        owner = character.active(context)
        settings = owner.anthronet
        found = character.measured(owner).measures
        before = settings.measures()
        settings.set_measures({name: (value, True) for name, value in found.items()})
        mesh.forget_sculpting(character.mesh_of(owner).data)
        if live.regenerate(owner, context):
            return {"FINISHED"}
        message = settings.error
        settings.set_measures(before)
        live.regenerate(owner, context)
        self.report({"ERROR"}, message)
        return {"CANCELLED"}


def _draw(layout, measured):
    columns = layout.grid_flow(columns=2, even_columns=True)
    for name, value in measured.measures.items():
        columns.label(
            text=f"{name.replace('_', ' ')}: {bpy.utils.units.to_string('METRIC', 'LENGTH', value, precision=4)}"
        )
    layout.separator()
    layout.label(text=f"{measured.mass_kg:.1f} kg, BMI {measured.bmi:.1f}")


CLASSES = (ANTHRONET_OT_measure_selected, ANTHRONET_OT_fit_selected)
