# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters as files, written by the library's core."""

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from .. import library, properties
from ..services import action, character
from .base import NeedsCharacter, reported

_FORMATS = (
    (".glb", "glTF Binary (.glb)", "One file for engines and viewers"),
    (".gltf", "glTF (.gltf + .bin)", "A document and its buffer"),
    (".vrm", "VRM 1.0 (.vrm)", "A humanoid avatar, without motion"),
    (".usdc", "USD (.usdc)", "Binary USD with UsdSkel"),
    (".usda", "USD Text (.usda)", "USD to read"),
    (".usdz", "USD Package (.usdz)", "USD in one archive"),
    (".obj", "Wavefront (.obj)", "The mesh alone, vertices in the model's order"),
)


class ANTHRONET_OT_character_export(NeedsCharacter, bpy.types.Operator, ExportHelper):
    """Write the active character, with its motion over the scene's frames, exact to the library's numbers"""

    bl_idname = "anthronet.character_export"
    bl_label = "Export AnthroNet Character"

    filename_ext = ".glb"
    filter_glob: StringProperty(default="*.glb;*.gltf;*.vrm;*.usdc;*.usda;*.usdz;*.obj", options={"HIDDEN"})
    format: EnumProperty(name="Format", items=_FORMATS)
    use_motion: BoolProperty(
        name="Motion", description="The motion over the scene's frames, if there is any", default=True
    )
    compress: BoolProperty(name="Compress", description="EXT_meshopt_compression, for .glb and .gltf")
    joint_names: EnumProperty(name="Joint Names", items=properties.NAMES, default="NATIVE")

    def check(self, context):
        """Keeps the file's ending that of the format."""
        self.filename_ext = self.format
        return super().check(context)

    @reported
    def execute(self, context):
        owner = character.active(context)
        settings, scene = owner.anthronet, context.scene
        body = library.model().generate(settings.request())
        animation = owner.animation_data
        moves = animation is not None and (animation.action is not None or len(animation.nla_tracks) > 0)
        path = bpy.path.abspath(self.filepath)
        still = path.lower().endswith((".vrm", ".obj"))
        clips = []
        if self.use_motion and moves and not still:
            name = animation.action.name if animation.action else owner.name
            clips.append(action.to_clip(owner, body, scene, name, scene.frame_start, scene.frame_end))
        body.save(
            path,
            lod=int(settings.lod),
            joint_names=self.joint_names.lower(),
            clips=clips,
            compress=self.compress,
            skin_tone=settings.skin_tone,
            body_only=not settings.accessories,
        )
        if character.is_sculpted(owner):
            self.report({"WARNING"}, "The mesh was sculpted: the file has the body of the measures instead")
        self.report({"INFO"}, f"Wrote {path}")
        return {"FINISHED"}


CLASSES = (ANTHRONET_OT_character_export,)
