# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries in Blender's menus *Add*, *Import* and *Export*."""

import bpy


def _draw_add(self, _context):
    self.layout.separator()
    # A layout of its own, since the operator context of a menu also applies to the entries of other extensions.
    column = self.layout.column()
    column.operator_context = "INVOKE_DEFAULT"
    column.operator("anthronet.character_add", icon="OUTLINER_OB_ARMATURE")
    column.operator("anthronet.crowd_add", icon="COMMUNITY")


def _draw_import(self, _context):
    self.layout.operator("anthronet.clip_apply", text="Motion for AnthroNet Character (.bvh/.fbx/.glb/.vrma/.npz/.usd)")


def _draw_export(self, _context):
    self.layout.operator("anthronet.character_export", text="AnthroNet Character (.glb/.vrm/.usd/.obj)")


_ENTRIES = (
    ("VIEW3D_MT_mesh_add", _draw_add),
    ("TOPBAR_MT_file_import", _draw_import),
    ("TOPBAR_MT_file_export", _draw_export),
)


def register():
    for menu, draw in _ENTRIES:
        getattr(bpy.types, menu).append(draw)


def unregister():
    for menu, draw in reversed(_ENTRIES):
        getattr(bpy.types, menu).remove(draw)
