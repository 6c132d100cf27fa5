# SPDX-License-Identifier: GPL-3.0-or-later
"""The AnthroNet tab of the 3D view's side bar."""

import bpy

from .. import measures, units
from ..services import action, character, live
from .presets import ANTHRONET_PT_presets


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "AnthroNet"

    @classmethod
    def poll(cls, context):
        return character.active(context) is not None


class ANTHRONET_PT_start(bpy.types.Panel):
    """What there is to do without a character"""

    bl_label = "AnthroNet"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "AnthroNet"

    @classmethod
    def poll(cls, context):
        return character.active(context) is None

    def draw(self, _context):
        column = self.layout.column()
        column.operator("anthronet.character_add", text="Add Character", icon="ADD")
        column.operator("anthronet.crowd_add", text="Add Crowd", icon="COMMUNITY")


class ANTHRONET_PT_person(_Panel, bpy.types.Panel):
    """Sex, seed, identity"""

    bl_label = "Person"

    def draw_header_preset(self, _context):
        ANTHRONET_PT_presets.draw_panel_header(self.layout)

    def draw(self, context):
        layout, owner = self.layout, character.active(context)
        settings = owner.anthronet
        layout.use_property_split = True
        layout.use_property_decorate = False
        reason = live.refusal(owner, context)
        if reason:
            box = layout.box()
            _sentences(box, reason, "LOCKED")
            if "Make Local" in reason:
                box.operator("anthronet.make_local", icon="FILE_BLEND")
        layout.prop(context.scene, "anthronet_edit_together")
        layout.prop(settings, "sex")
        row = layout.row()
        row.active = not settings.identity_by_hand or settings.fill == "SAMPLE"
        row.prop(settings, "seed")
        layout.prop(settings, "fill")
        layout.prop(settings, "nearest")
        row = layout.row(align=True)
        row.operator("anthronet.randomise", text="Randomise", icon="FILE_REFRESH").what = "ALL"
        row.operator("anthronet.randomise", text="Identity Only").what = "IDENTITY"
        row = layout.row(align=True)
        row.operator("anthronet.mirror", icon="MOD_MIRROR")
        row.operator("anthronet.symmetrise", text="Left to Right").side = "left"
        layout.operator("anthronet.copy_request", icon="COPYDOWN")
        row = layout.row(align=True)
        row.operator("anthronet.request_load", icon="IMPORT")
        row.operator("anthronet.request_save", icon="EXPORT")


class ANTHRONET_PT_identity(_Panel, bpy.types.Panel):
    """The latent numbers"""

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


class ANTHRONET_PT_measures(_Panel, bpy.types.Panel):
    """The measures, by part of the body"""

    bl_label = "Measures"

    def draw(self, context):
        settings = character.active(context).anthronet
        if settings.error:
            _sentences(self.layout.box(), settings.error, "ERROR")
        if abs(context.scene.unit_settings.scale_length - 1.0) > 1e-6:
            scale = context.scene.unit_settings.scale_length
            _sentences(self.layout.box(), f"Unit Scale is {scale:g}: lengths are shown times that", "INFO")
        row = self.layout.row(align=True)
        row.operator("anthronet.measure_selected", icon="DRIVER_DISTANCE")
        row.operator("anthronet.fit_selected")
        self.layout.operator("anthronet.open_measures", icon="X")


def _group_panel(group):
    def draw(self, context):
        settings = character.active(context).anthronet
        column = self.layout.column(align=True)
        for measure, report in zip(measures.all_measures(), settings.report):
            if measure.group == group:
                _measure_row(column, context.scene, settings, measure, report)

    return type(
        f"ANTHRONET_PT_{group.lower()}",
        (_Panel, bpy.types.Panel),
        {
            "__doc__": f"Measures of the {group.lower()}",
            "bl_label": group,
            "bl_parent_id": "ANTHRONET_PT_measures",
            "draw": draw,
            "bl_options": set() if group == "Torso" else {"DEFAULT_CLOSED"},
        },
    )


def _measure_row(column, scene, settings, measure, report):
    given = settings.is_given(measure.name)
    row = column.row(align=True)
    row.prop(settings, f"given_{measure.name}", text="", icon="LOCKED" if given else "UNLOCKED")
    slider = row.row(align=True)
    slider.active = given
    slider.prop(settings, measure.name, text=_label(measure), slider=True)
    if given:
        text = f"off by {units.millimetres(scene, report.residual)}"
    else:
        text = f"{units.length(scene, report.low90, 3)} – {units.length(scene, report.high90, 3)}"
    # Below and not beside: a side bar of usual width has no room for both.
    told = column.row()
    told.active = False
    told.scale_y = 0.7
    told.label(text=f"P{report.percentile:.0f}  {text}", icon="BLANK1")


class ANTHRONET_PT_report(_Panel, bpy.types.Panel):
    """What came of the request"""

    bl_label = "Report"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        settings = character.active(context).anthronet
        layout = self.layout
        mass = units.mass(context.scene, settings.mass)
        layout.label(text=f"{settings.body_sex.capitalize()}, {mass}, BMI {settings.bmi:.1f}")
        for warning in filter(None, settings.warnings.split("\n")):
            _sentences(layout.box(), warning, "INFO")
        pairs = zip(measures.all_measures(), settings.report)
        rows = [(measure, report) for measure, report in pairs if settings.is_given(measure.name)]
        if not rows:
            layout.label(text="No measure is given: the likeliest person")
        for measure, report in rows:
            row = layout.row()
            row.label(text=_label(measure))
            row.label(text=units.length(context.scene, getattr(settings, measure.name)))
            row.label(text=units.millimetres(context.scene, report.residual))
            row.label(text=f"percentile {report.percentile:.0f}")


class ANTHRONET_PT_body(_Panel, bpy.types.Panel):
    """Mesh and rig"""

    bl_label = "Mesh and Rig"

    def draw(self, context):
        settings = character.active(context).anthronet
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("lod", "fine_render", "accessories", "skin_tone", "joint_names"):
            layout.prop(settings, name)


class ANTHRONET_PT_motion(_Panel, bpy.types.Panel):
    """Motion and files"""

    bl_label = "Motion and Files"

    def draw(self, context):
        owner = character.active(context)
        column = self.layout.column()
        column.operator("anthronet.clip_apply", icon="ANIM_DATA")
        column.operator_menu_enum("anthronet.clip_builtin", "name", icon="PLAY")
        column.operator("anthronet.clip_from_armature", icon="ARMATURE_DATA")
        if action.is_of_another_body(owner):
            box = column.box()
            _sentences(box, "The motion was made for the body of before", "INFO")
            box.operator("anthronet.clip_refit", icon="FILE_REFRESH")
        column.operator("anthronet.metarig_add", icon="OUTLINER_OB_ARMATURE")
        column.operator("anthronet.character_export", text="Export", icon="EXPORT")


def _label(measure):
    return measure.label + (f" {measure.side[0].upper()}" if measure.side else "")


def _sentences(layout, text, icon):
    """A text in lines that fit the side bar."""
    import textwrap

    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, 44)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


CLASSES = (
    ANTHRONET_PT_start,
    ANTHRONET_PT_person,
    ANTHRONET_PT_identity,
    ANTHRONET_PT_measures,
    *(_group_panel(group) for group in measures.GROUPS),
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
