# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters as files, written by the library's core."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ..services import action, character, pose
from ..state import definitions
from .base import NeedsCharacter
from .job import ModalJob

_FORMATS = (
    (".glb", "glTF Binary (.glb)", "One file for engines and viewers"),
    (".gltf", "glTF (.gltf + .bin)", "A document and its buffer"),
    (".vrm", "VRM 1.0 (.vrm)", "A humanoid avatar, without motion"),
    (".usdc", "USD (.usdc)", "Binary USD with UsdSkel"),
    (".usda", "USD Text (.usda)", "USD to read"),
    (".usdz", "USD Package (.usdz)", "USD in one archive"),
    (".obj", "Wavefront (.obj)", "The mesh alone, vertices in the model's order"),
)
_WITHOUT_MOTION = (".vrm", ".obj")


class ANTHRONET_OT_character_export(NeedsCharacter, ModalJob, bpy.types.Operator, ExportHelper):
    """Write the active character, with its motion over the scene's frames or its pose, exact to the library's numbers. Esc
    stops"""

    bl_idname = "anthronet.character_export"
    bl_label = "Export AnthroNet Character"

    filename_ext = ".glb"
    filter_glob: StringProperty(
        name="Files",
        description="Which files are shown",
        default="*.glb;*.gltf;*.vrm;*.usdc;*.usda;*.usdz;*.obj",
        options={"HIDDEN"},
    )
    format: EnumProperty(
        name="Format",
        description="What is written. Where a script does not say, the file's ending does",
        items=_FORMATS,
    )
    use_motion: BoolProperty(
        name="Motion",
        description="The motion over the scene's frames as Blender evaluates it; the pose, where nothing moves",
        default=True,
    )
    use_world: BoolProperty(
        name="Place in World",
        description="Where the object stands and how it is turned in the scene; if not, from where it is at the first frame",
    )
    compress: BoolProperty(name="Compress", description="EXT_meshopt_compression, for .glb and .gltf")
    joint_names: EnumProperty(
        name="Joint Names", description="What the joints are called", items=definitions.BONE_NAMES, default="NATIVE"
    )

    def check(self, context):
        """Keeps the file's ending that of the format."""
        self.filename_ext = self.format
        return super().check(context)

    def work(self, context):
        """Looks at the scene's frames, then writes."""
        owner, scene = character.active(context), context.scene
        settings, body = owner.anthronet, character.body(owner)
        path = self._path()
        still = path.lower().endswith(_WITHOUT_MOTION)
        clips = []
        if self.use_motion and not still:
            frames = None
            if pose.moves(owner):
                playing = next(iter(action.of(owner)), None) or (owner.animation_data and owner.animation_data.action)
                name, frames = playing.name if playing else owner.name, (scene.frame_start, scene.frame_end)
            elif pose.is_posed(owner) or (self.use_world and pose.is_placed(owner)):
                name, frames = "Pose", (scene.frame_current, scene.frame_current)
            if frames:
                clips.append((yield from action.to_clip(owner, body, scene, name, *frames, in_world=self.use_world)))
        body.save(
            path,
            lod=int(settings.lod),
            joint_names=self.joint_names.lower(),
            clips=clips,
            compress=self.compress,
            skin_tone=settings.skin_tone,
            body_only=not settings.accessories,
        )
        if pose.is_scaled(owner):
            self.report({"WARNING"}, "The object is scaled: the file has the body as its measures are")
        if character.is_sculpted(owner):
            self.report({"WARNING"}, "The mesh was sculpted: the file has the body of the measures instead")
        self.report({"INFO"}, f"Wrote {path}")

    def _path(self):
        path = bpy.path.abspath(self.filepath)
        known = [ending for ending, _, _ in _FORMATS]
        ending = Path(path).suffix.lower()
        if self.properties.is_property_set("format") or ending not in known:
            return path if ending == self.format else bpy.path.ensure_ext(path, self.format)
        return path


CLASSES = (ANTHRONET_OT_character_export,)
