# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of characters. The library writes the files, not Blender's exporters."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ..services import action, character, pose, sampling
from ..state import definitions
from .base import NeedsCharacter
from .modal import ModalOperator

_FORMATS = (
    (".glb", "glTF Binary (.glb)", "A single file for game engines and viewers"),
    (".gltf", "glTF Separate (.gltf + .bin)", "A JSON document and a binary buffer"),
    (".vrm", "VRM 1.0 (.vrm)", "A humanoid avatar, without motion"),
    (".usdc", "USD Binary (.usdc)", "USD with UsdSkel, binary"),
    (".usda", "USD Text (.usda)", "USD with UsdSkel, as text"),
    (".usdz", "USD Package (.usdz)", "USD with UsdSkel, in an archive"),
    (".obj", "Wavefront (.obj)", "The mesh only, vertices in the model's order"),
)
_EXTENSIONS = tuple(extension for extension, _, _ in _FORMATS)
_WITHOUT_MOTION = (".vrm", ".obj")


class ANTHRONET_OT_character_export(NeedsCharacter, ModalOperator, bpy.types.Operator, ExportHelper):
    """Export the active character with its motion in the scene's frame range, or with its pose. Press Esc to stop"""

    bl_idname = "anthronet.character_export"
    bl_label = "Export AnthroNet Character"

    filename_ext = ".glb"
    filter_glob: StringProperty(
        name="File Filter",
        description="Files that are shown",
        default="*.glb;*.gltf;*.vrm;*.usdc;*.usda;*.usdz;*.obj",
        options={"HIDDEN"},
    )
    format: EnumProperty(
        name="Format",
        description="File format. If a script does not set it, the extension of the file path decides",
        items=_FORMATS,
    )
    use_motion: BoolProperty(
        name="Motion",
        description="Export the motion in the scene's frame range as Blender evaluates it. Without motion: the current pose",
        default=True,
    )
    use_world: BoolProperty(
        name="World Space",
        description="Export root motion in world space. If off, it is relative to the object at the first frame",
    )
    compress: BoolProperty(
        name="Compress", description="Compress .glb and .gltf files with EXT_meshopt_compression"
    )
    joint_names: EnumProperty(
        name="Joint Names",
        description="Naming convention of the joints",
        items=definitions.BONE_NAMES,
        default="NATIVE",
    )

    def check(self, context):
        """Makes the extension of the file path the one of the format."""
        self.filename_ext = self.format
        return super().check(context)

    def work(self, context):
        """Samples the motion, then writes the file."""
        rig = character.active(context)
        settings, body, path = rig.anthronet, character.generate_body(rig), self._path()
        clips = []
        if self.use_motion and not path.lower().endswith(_WITHOUT_MOTION):
            clips = yield from self._sample_clips(rig, body, context.scene)
        body.save(
            path,
            lod=int(settings.lod),
            joint_names=self.joint_names.lower(),
            clips=clips,
            compress=self.compress,
            skin_tone=settings.skin_tone,
            body_only=not settings.accessories,
        )
        if pose.is_scaled(rig):
            self.report({"WARNING"}, "The scale of the object is not exported: the body has the size of its measures")
        if character.is_sculpted(rig):
            self.report({"WARNING"}, "Sculpting is not exported: the mesh is the body of the measures")
        self.report({"INFO"}, f"Exported {path}")

    def _sample_clips(self, rig, body, scene):
        """A list with the clip to export, or an empty one if the character is in rest pose and does not move."""
        if pose.is_animated(rig):
            assigned = next(iter(action.used_by(rig)), None) or (rig.animation_data and rig.animation_data.action)
            name, start, end = assigned.name if assigned else rig.name, scene.frame_start, scene.frame_end
        elif pose.is_posed(rig) or (self.use_world and pose.is_transformed(rig)):
            name, start, end = "Pose", scene.frame_current, scene.frame_current
        else:
            return []
        return [(yield from sampling.sample_clip(rig, body, scene, name, start, end, in_world=self.use_world))]

    def _path(self):
        """The path of the file. A format that is set decides on its extension, else the extension on the format."""
        path = bpy.path.abspath(self.filepath)
        extension = Path(path).suffix.lower()
        if extension == self.format:
            return path
        if self.properties.is_property_set("format") or extension not in _EXTENSIONS:
            return bpy.path.ensure_ext(path, self.format)
        return path


CLASSES = (ANTHRONET_OT_character_export,)
