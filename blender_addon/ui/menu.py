# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries in Blender's menus."""

import bpy


def _add(self, _context):
    self.layout.separator()
    # A layout of its own: the context of the menu's holds for the entries of others.
    own = self.layout.column()
    own.operator_context = "INVOKE_DEFAULT"
    own.operator("anthronet.character_add", icon="OUTLINER_OB_ARMATURE")
    own.operator("anthronet.crowd_add", icon="COMMUNITY")


def _import(self, _context):
    self.layout.operator("anthronet.clip_apply", text="Motion onto AnthroNet Character (.bvh/.fbx/.glb/.npz/.usd)")


def _export(self, _context):
    self.layout.operator("anthronet.character_export", text="AnthroNet Character (.glb/.vrm/.usd/.obj)")


_ENTRIES = (
    ("VIEW3D_MT_mesh_add", _add),
    ("TOPBAR_MT_file_import", _import),
    ("TOPBAR_MT_file_export", _export),
)


def register():
    for menu, draw in _ENTRIES:
        getattr(bpy.types, menu).append(draw)


def unregister():
    for menu, draw in reversed(_ENTRIES):
        getattr(bpy.types, menu).remove(draw)
