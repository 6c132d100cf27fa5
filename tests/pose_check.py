"""A posed .glb or .usd in Blender, and a posed .usd in Pixar's USD, against the .obj of the same person and pose.

    python pose_check.py FILE.glb REFERENCE.obj PLAIN.obj [PICTURE.png]

The .obj has the skinned vertices; the other file has joints in the pose and a skin in the bind pose, which is that of
PLAIN.obj, the same person without a pose.
"""

import sys
from pathlib import Path

import numpy as np

from glb import Cases, Glb

TOLERANCE = 5e-4  # metres
EXACT = 1e-5  # metres; of the bind pose, which is not computed anew
# Blender's axes: +Z up, the character looks along -Y. The file's: +Y up, it looks along +Z.
BLENDER_FROM_FILE = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)


def objects(path):
    """Positions by object of an .obj."""
    found = {}
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        key, _, rest = line.partition(" ")
        if key == "o":
            found[rest] = []
        elif key == "v":
            next(reversed(found.values())).append([float(number) for number in rest.split()])
    return {name: np.array(points) for name, points in found.items()}


def in_blender(cases, path, reference, plain, picture):
    import bpy

    from blender_import import evaluated

    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.suffix == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(path))
    else:
        bpy.ops.wm.usd_import(filepath=str(path))
    skinned = {o.name: o for o in bpy.data.objects if any(m.type == "ARMATURE" for m in o.modifiers)}
    cases.case("Blender: all meshes are skinned", set(skinned) == set(reference), sorted(set(skinned) ^ set(reference)))
    for name, expected in reference.items():
        thing = skinned.get(name)
        if thing is None:
            continue
        # A .glb has copies at the seams of textures behind the model's own vertices.
        found = evaluated(thing)[: len(expected)]
        cases.close_to(f"Blender: {name} in the pose", found, expected @ BLENDER_FROM_FILE.T, TOLERANCE)
        rest = np.array([vertex.co for vertex in thing.data.vertices])[: len(expected)]
        world = np.array(thing.matrix_world)
        rest = rest @ world[:3, :3].T + world[:3, 3]
        cases.close_to(f"Blender: {name} in the bind pose", rest, plain[name] @ BLENDER_FROM_FILE.T, EXACT)
    if picture:
        from blender_import import render

        render(picture)


def in_usd(cases, path, reference, plain):
    from pxr import Usd, UsdGeom, UsdSkel

    stage = Usd.Stage.Open(str(path))
    root = UsdSkel.Root(stage.GetDefaultPrim())
    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.PrimDefaultPredicate)
    skeleton = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath(root.GetPath().AppendChild("Skel"))))
    xforms = skeleton.ComputeSkinningTransforms(Usd.TimeCode.Default())
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        name = prim.GetDisplayName() or prim.GetName()
        mesh = UsdGeom.Mesh(prim)
        points = mesh.GetPointsAttr().Get()
        cases.close_to(f"USD: {name} in the bind pose", np.array(points), plain[name], EXACT)
        query = cache.GetSkinningQuery(prim)
        query.ComputeSkinnedPoints(xforms, points, Usd.TimeCode.Default())
        cases.close_to(f"USD: {name} in the pose", np.array(points), reference[name], TOLERANCE)
    box = np.array(UsdGeom.Boundable(root).GetExtentAttr().Get())
    everything = np.vstack(list(reference.values()))
    around = np.array([everything.min(0), everything.max(0)])
    cases.close_to("USD: the extent is that of the pose", box, around, 2 * TOLERANCE)


def in_glb(cases, path, reference):
    """The file's own arithmetic, in double precision."""
    glb = Glb(path)
    world = glb.world()
    for node in glb.skinned_nodes():
        name = glb.nodes[node]["name"]
        expected = reference[name]
        cases.close_to(f"glTF: {name} in the pose", glb.skinned(node, world)[: len(expected)], expected, TOLERANCE)


def main(path, reference, plain, picture=None):
    cases, path = Cases(), Path(path)
    reference, plain = objects(reference), objects(plain)
    moved = np.abs(reference["Body"] - plain["Body"]).max()
    cases.case(f"the pose moves the body, by {moved:.2f} m", moved > 0.2)
    if path.suffix == ".glb":
        in_glb(cases, path, reference)
    else:
        in_usd(cases, path, reference, plain)
    in_blender(cases, path, reference, plain, picture)
    cases.exit()


main(*sys.argv[1:])
