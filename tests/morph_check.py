"""Morph targets of what the example `morph_dump` wrote, in Pixar's USD or in Blender.

    python morph_check.py FOLDER FILE [--blender]

FILE is a name in FOLDER: a .usda or .usdc for either, a .glb for Blender. `FOLDER/morph.json` says what is to be found.
"""

import json
import sys
from pathlib import Path

import numpy as np

from glb import Cases

TOLERANCE = 1e-5  # metres; the files hold single precision
WEIGHT_TOLERANCE = 1e-6
# Blender's axes: +Z up, the character looks along -Y. The file's: +Y up, it looks along +Z.
BLENDER_FROM_FILE = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)


def pixar(cases, path, expected):
    """UsdSkel's own blend shapes and weights, of every animation."""
    from pxr import Usd, UsdGeom, UsdSkel

    stage = Usd.Stage.Open(str(path))
    root = UsdSkel.Root(stage.GetDefaultPrim())
    skeleton = next(p for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton))
    animations = {p.GetDisplayName() or p.GetName(): p for p in stage.Traverse() if p.IsA(UsdSkel.Animation)}
    for place, clip in enumerate(expected["clips"]):
        if clip["name"] not in animations:
            cases.case(f"USD: {clip['name']}", False, f"{sorted(animations)}")
            continue
        UsdSkel.BindingAPI(skeleton).GetAnimationSourceRel().SetTargets([animations[clip["name"]].GetPath()])
        cache = UsdSkel.Cache()
        cache.Populate(root, Usd.TraverseInstanceProxies())
        binding = cache.ComputeSkelBindings(root, Usd.TraverseInstanceProxies())[0]
        query = cache.GetSkelQuery(binding.GetSkeleton())
        animation = query.GetAnimQuery()
        skins = {t.GetPrim().GetDisplayName() or t.GetPrim().GetName(): t for t in binding.GetSkinningTargets()}
        for mesh in expected["meshes"]:
            skin, title = skins[mesh["name"]], f"USD: {clip['name']}, {mesh['name']}"
            shapes = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(skin.GetPrim()))
            names = [shapes.GetBlendShape(i).GetPrim() for i in range(shapes.GetNumBlendShapes())]
            names = [p.GetDisplayName() or p.GetName() for p in names]
            wanted = [t["name"] for t in mesh["targets"]]
            cases.case(f"{title}: targets", names == wanted and skin.HasBlendShapes(), f"{names} for {wanted}")

            def weights(frame):
                code = Usd.TimeCode(frame / clip["rate"] * stage.GetTimeCodesPerSecond())
                return code, skin.GetBlendShapeMapper().Remap(animation.ComputeBlendShapeWeights(code))

            off = 0.0
            for frame in range(clip["frames"]):
                goal = [t["weights"][place][frame] for t in mesh["targets"]]
                off = max(off, float(np.abs(np.array(weights(frame)[1]) - goal).max()))
            cases.case(f"{title}: weights of {clip['frames']} frames (off by {off:.1e})", off <= WEIGHT_TOLERANCE)
            if place > 0:
                continue
            off = 0.0
            for moment in mesh["morphed"]:
                code, values = weights(moment["frame"])
                sub_weights, shape_indices, sub_indices = shapes.ComputeSubShapeWeights(values)
                points = UsdGeom.Mesh(skin.GetPrim()).GetPointsAttr().Get()
                assert shapes.ComputeDeformedPoints(
                    sub_weights, shape_indices, sub_indices, shapes.ComputeBlendShapePointIndices(),
                    shapes.ComputeSubShapePointOffsets(), points)
                assert skin.ComputeSkinnedPoints(query.ComputeSkinningTransforms(code), points, code)
                off = max(off, float(np.abs(np.array(points, float) - moment["positions"]).max()))
            cases.case(f"{title}: points (off by {off:.1e} m)", off <= TOLERANCE)


def valid(cases, path):
    """Every validator that Pixar ships."""
    from pxr import Usd, UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    found = UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(path)))
    said = [f"{e.GetIdentifier()}: {e.GetMessage()}" for e in found]
    cases.case(f"USD: none of {len(validators)} validators complains", validators and not said, "; ".join(said[:5]))


def evaluated(thing):
    """Positions (vertices, 3) in world space after shape keys and modifiers."""
    import bpy

    owner = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = owner.to_mesh()
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    owner.to_mesh_clear()
    world = np.array(thing.matrix_world)
    return points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]


def play(data, name):
    """Makes an animated thing play the first clip alone; the glTF importer keeps each clip in a track."""
    for track in data.nla_tracks:
        track.mute = True
        if track.name == name:
            strip = track.strips[0]
            data.action, data.action_slot = strip.action, strip.action_slot


def blender(cases, path, expected):
    """Imported shape keys: names, values and shapes over the first clip."""
    import bpy

    clip = expected["clips"][0]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = round(clip["rate"])
    if path.suffix == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(path))
    else:
        bpy.ops.wm.usd_import(filepath=str(path))
    meshes = {o.data.name: o for o in bpy.data.objects if o.type == "MESH" and o.data.shape_keys}
    wanted = sorted(mesh["name"] for mesh in expected["meshes"])
    cases.case(f"Blender: {path.name}, shape keys", sorted(meshes) == wanted, f"{sorted(meshes)} for {wanted}")
    for armature in (o for o in bpy.data.objects if o.type == "ARMATURE" and o.animation_data):
        play(armature.animation_data, clip["name"])
    for mesh in expected["meshes"]:
        if mesh["name"] not in meshes:
            continue
        thing, title = meshes[mesh["name"]], f"Blender: {path.name}, {mesh['name']}"
        keys = thing.data.shape_keys
        names = [key.name for key in keys.key_blocks][1:]
        # Of a USD file Blender takes what the weights go by.
        goal = [t["name" if path.suffix == ".glb" else "token"] for t in mesh["targets"]]
        cases.case(f"{title}: targets", names == goal, f"{names} for {goal}")
        cases.case(f"{title}: is animated", keys.animation_data is not None)
        if names != goal or not keys.animation_data:
            continue
        play(keys.animation_data, clip["name"])
        off = far = 0.0
        for moment in mesh["morphed"]:
            frame = moment["frame"]
            scene.frame_set(frame)
            values = [key.value for key in keys.key_blocks][1:]
            weights = [t["weights"][0][frame] for t in mesh["targets"]]
            off = max(off, float(np.abs(np.array(values) - weights).max()))
            positions = np.array(moment["positions"]) @ BLENDER_FROM_FILE.T
            # The copies of texture seams come after the model's own vertices.
            far = max(far, float(np.abs(evaluated(thing)[: len(positions)] - positions).max()))
        cases.case(f"{title}: values (off by {off:.1e})", off <= WEIGHT_TOLERANCE)
        cases.case(f"{title}: points (off by {far:.1e} m)", far <= TOLERANCE)


def main(folder, name, *options):
    cases, path = Cases(), Path(folder) / name
    expected = json.loads((Path(folder) / "morph.json").read_text(encoding="utf-8"))
    # Blender carries a USD of its own under the same name, so a process has one or the other.
    if "--blender" in options:
        blender(cases, path, expected)
        cases.exit()
    try:
        from pxr import Usd  # noqa: F401
    except ModuleNotFoundError:
        print("skipped USD: usd-core has no wheel for this platform")
        return
    valid(cases, path)
    pixar(cases, path, expected)
    cases.exit()


main(*sys.argv[1:])
