# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab *AnthroNet* in the sidebar of the 3D viewport."""

import textwrap

import bpy

from .. import measures, units
from ..services import action, character, regeneration
from .presets import ANTHRONET_PT_presets

#: Characters on a line of text that fits a sidebar of usual width.
_LINE_LENGTH = 44


class _SidebarPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "AnthroNet"


class _CharacterPanel(_SidebarPanel):
    """A panel for the active character."""

    @classmethod
    def poll(cls, context):
        return character.active(context) is not None


class ANTHRONET_PT_start(_SidebarPanel, bpy.types.Panel):
    """The only panel if no character is active"""

    bl_label = "AnthroNet"

    @classmethod
    def poll(cls, context):
        return character.active(context) is None

    def draw(self, _context):
        column = self.layout.column()
        column.operator("anthronet.character_add", text="Add Character", icon="ADD")
        column.operator("anthronet.crowd_add", text="Add Crowd", icon="COMMUNITY")


class ANTHRONET_PT_person(_CharacterPanel, bpy.types.Panel):
    """The request, without its measures"""

    bl_label = "Person"

    def draw_header_preset(self, _context):
        ANTHRONET_PT_presets.draw_panel_header(self.layout)

    def draw(self, context):
        layout, rig = self.layout, character.active(context)
        settings = rig.anthronet
        layout.use_property_split = True
        layout.use_property_decorate = False
        reason = regeneration.reason_not_editable(rig, context)
        if reason:
            box = layout.box()
            _draw_text(box, reason, "LOCKED")
            if "Make Local" in reason:
                box.operator("anthronet.make_local", icon="FILE_BLEND")
        layout.prop(context.scene, "anthronet_edit_together")
        layout.prop(settings, "sex")
        row = layout.row()
        # Otherwise the seed has no effect.
        row.active = not settings.identity_by_hand or settings.fill == "SAMPLE"
        row.prop(settings, "seed")
        layout.prop(settings, "fill")
        layout.prop(settings, "nearest")
        row = layout.row(align=True)
        row.operator("anthronet.randomise", icon="FILE_REFRESH").what = "ALL"
        row.operator("anthronet.randomise", text="Identity Only").what = "IDENTITY"
        row = layout.row(align=True)
        row.operator("anthronet.mirror", icon="MOD_MIRROR")
        row.operator("anthronet.symmetrise", text="Left to Right").side = "left"
        layout.operator("anthronet.copy_request", icon="COPYDOWN")
        row = layout.row(align=True)
        row.operator("anthronet.request_load", icon="IMPORT")
        row.operator("anthronet.request_save", icon="EXPORT")


class ANTHRONET_PT_identity(_CharacterPanel, bpy.types.Panel):
    """The identity vector"""

    bl_label = "Identity"
    bl_parent_id = "ANTHRONET_PT_person"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(character.active(context).anthronet, "identity_by_hand", text="")

    def draw(self, context):
        settings = character.active(context).anthronet
        column = self.layout.column(align=True)
        column.active = settings.identity_by_hand
        for index in range(len(settings.identity)):
            column.prop(settings, "identity", index=index, text=f"Identity {index + 1}", slider=True)


class ANTHRONET_PT_measures(_CharacterPanel, bpy.types.Panel):
    """Errors and operators for measures. The measures themselves are in sub-panels"""

    bl_label = "Measures"

    def draw(self, context):
        settings = character.active(context).anthronet
        if settings.error:
            _draw_text(self.layout.box(), settings.error, "ERROR")
        scale = context.scene.unit_settings.scale_length
        if abs(scale - 1.0) > 1e-6:
            _draw_text(self.layout.box(), f"Unit Scale is {scale:g}: lengths are shown multiplied by it", "INFO")
        row = self.layout.row(align=True)
        row.operator("anthronet.measure_selected", icon="DRIVER_DISTANCE")
        row.operator("anthronet.fit_selected")
        self.layout.operator("anthronet.unset_measures", icon="X")


def _measure_group_panel(group):
    """The class of the panel for a group of measures."""

    def draw(self, context):
        settings = character.active(context).anthronet
        column = self.layout.column(align=True)
        for measure, report in zip(measures.all_measures(), settings.report):
            if measure.group == group:
                _draw_measure(column, context.scene, settings, measure, report)

    return type(
        f"ANTHRONET_PT_{group.lower()}",
        (_CharacterPanel, bpy.types.Panel),
        {
            "__doc__": f"Measures of the {group.lower()}",
            "bl_label": group,
            "bl_parent_id": "ANTHRONET_PT_measures",
            "draw": draw,
            "bl_options": set() if group == "Torso" else {"DEFAULT_CLOSED"},
        },
    )


def _draw_measure(column, scene, settings, measure, report):
    given = settings.is_given(measure.name)
    row = column.row(align=True)
    row.prop(settings, f"given_{measure.name}", text="", icon="LOCKED" if given else "UNLOCKED")
    slider = row.row(align=True)
    slider.active = given
    slider.prop(settings, measure.name, text=_label(measure), slider=True)
    if given:
        text = f"error {units.length_difference(scene, report.residual)}"
    else:
        text = f"{units.length(scene, report.low90, 3)} – {units.length(scene, report.high90, 3)}"
    # In a row of its own: a sidebar of usual width is too narrow for both.
    details = column.row()
    details.active = False
    details.scale_y = 0.7
    details.label(text=f"P{report.percentile:.0f}  {text}", icon="BLANK1")


class ANTHRONET_PT_report(_CharacterPanel, bpy.types.Panel):
    """Report on the generated body"""

    bl_label = "Report"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        settings, scene = character.active(context).anthronet, context.scene
        layout = self.layout
        mass, bmi = units.mass(scene, settings.mass), units.body_mass_index(settings.bmi)
        layout.label(text=f"{settings.body_sex.capitalize()}, {mass}, {bmi}")
        for warning in filter(None, settings.warnings.split("\n")):
            _draw_text(layout.box(), warning, "INFO")
        pairs = zip(measures.all_measures(), settings.report)
        given = [(measure, report) for measure, report in pairs if settings.is_given(measure.name)]
        if not given:
            layout.label(text="No measure is given, all are predicted")
        for measure, report in given:
            row = layout.row()
            row.label(text=_label(measure))
            row.label(text=units.length(scene, getattr(settings, measure.name)))
            row.label(text=f"error {units.length_difference(scene, report.residual)}")
            row.label(text=f"percentile {report.percentile:.0f}")


class ANTHRONET_PT_body(_CharacterPanel, bpy.types.Panel):
    """Settings of mesh and armature"""

    bl_label = "Mesh and Armature"

    def draw(self, context):
        settings = character.active(context).anthronet
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("lod", "fine_render", "accessories", "skin_tone", "joint_names"):
            layout.prop(settings, name)


class ANTHRONET_PT_motion(_CharacterPanel, bpy.types.Panel):
    """Motion and export"""

    bl_label = "Motion and Export"

    def draw(self, context):
        rig = character.active(context)
        column = self.layout.column()
        column.operator("anthronet.clip_apply", icon="ANIM_DATA")
        column.operator_menu_enum("anthronet.clip_builtin", "name", icon="PLAY")
        column.operator("anthronet.clip_from_armature", icon="ARMATURE_DATA")
        if action.is_outdated(rig):
            box = column.box()
            _draw_text(box, "The motion was made for a different body", "INFO")
            box.operator("anthronet.clip_refit", icon="FILE_REFRESH")
        column.operator("anthronet.metarig_add", icon="OUTLINER_OB_ARMATURE")
        column.operator("anthronet.character_export", text="Export", icon="EXPORT")


def _label(measure):
    return measure.label + (f" {measure.side[0].upper()}" if measure.side else "")


def _draw_text(layout, text, icon):
    """Draws a text in lines that fit the sidebar: Blender's labels do not wrap."""
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, _LINE_LENGTH)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


CLASSES = (
    ANTHRONET_PT_start,
    ANTHRONET_PT_person,
    ANTHRONET_PT_identity,
    ANTHRONET_PT_measures,
    *(_measure_group_panel(group) for group in measures.GROUPS),
    ANTHRONET_PT_report,
    ANTHRONET_PT_body,
    ANTHRONET_PT_motion,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
