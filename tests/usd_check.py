"""A .usda, .usdc or .usdz in Pixar's USD and, if asked, in Blender, against the .glb of the same person and clip.

    python usd_check.py FILE.usdc REFERENCE.glb [--blender]

The reference is skinned here in double precision from the .glb alone, so that what the two writers make of one clip
has to agree: joints, rest pose, weights, rotations, root motion, times.
"""

import sys

import numpy as np

from glb import Cases, Glb

TOLERANCE = 1e-5  # metres; both files hold single precision
FRAMES = 5
# Blender's importer leaves smaller weights out.
BLENDER_LEAST_WEIGHT = 1e-5
# Blender's axes: +Z up, the character looks along -Y. The file's: +Y up, it looks along +Z.
BLENDER_FROM_FILE = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)


class Reference:
    """One animation of a .glb: skinned vertices at its key times."""

    def __init__(self, path, place=0):
        self.glb = Glb(path)
        self.animation = self.glb.json["animations"][place]
        self.name = self.animation.get("name")
        samplers = [self.animation["samplers"][channel["sampler"]] for channel in self.animation["channels"]]
        self.rate = self.animation["extras"]["anthronet"]["frames_per_second"]
        self.times = np.unique(np.concatenate([self.glb.accessor(s["input"]).astype(float) for s in samplers]))

    def skinned(self, time, least=0.0):
        """By mesh: positions (vertices, 3), with the copies at texture seams after the model's own vertices.

        Weights below `least` are left out.
        """
        world = self.glb.world(animated=self.glb.animated(self.animation, time))
        nodes = self.glb.skinned_nodes()
        return {self.glb.nodes[node]["name"]: self.glb.skinned(node, world, least) for node in nodes}


def pick(reference, codes):
    """Some key times and their time codes: a .glb tells seconds in single precision, and a key is a whole frame."""
    times = reference.times
    chosen = [times[i * (len(times) - 1) // (FRAMES - 1)] for i in range(FRAMES)]
    return [(time, round(time * reference.rate) * codes / reference.rate) for time in chosen]


def valid(cases, stage):
    """Every validator that Pixar ships."""
    from pxr import UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    found = UsdValidation.ValidationContext(validators).Validate(stage)
    said = [f"{e.GetIdentifier()}: {e.GetMessage()}" for e in found]
    cases.case(f"USD: none of {len(validators)} validators complains", validators and not said, "; ".join(said[:5]))


def stage_metadata(cases, stage, reference):
    from pxr import Usd, UsdGeom, UsdSkel

    rate = stage.GetTimeCodesPerSecond()
    told = (UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage), stage.GetFramesPerSecond())
    cases.case("USD: metres, +Y up, one rate", told == (1.0, "Y", rate), told)
    cases.case("USD: plays as long as the reference", abs(stage.GetEndTimeCode() / rate - reference.times[-1]) < 1e-5
               and stage.GetStartTimeCode() == 0, f"{stage.GetEndTimeCode()} codes at {rate} for {reference.times[-1]} s")
    root = stage.GetDefaultPrim()
    cases.case("USD: the default prim is a SkelRoot, a component", root.IsA(UsdSkel.Root) and Usd.ModelAPI(root).GetKind()
               == "component", root)
    return rate


def skins(cases, stage, reference, rate, prim=None):
    """UsdSkel's own skinning, and the extents, which are those of the first animation.

    `prim` is a SkelAnimation that is to play instead of the one that the skeleton is bound to.
    """
    from pxr import Usd, UsdGeom, UsdSkel

    root, title = UsdSkel.Root(stage.GetDefaultPrim()), f"USD: {reference.name}"
    if prim:
        skeleton = next(p for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton))
        UsdSkel.BindingAPI(skeleton).GetAnimationSourceRel().SetTargets([prim.GetPath()])
    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.TraverseInstanceProxies())
    bindings = cache.ComputeSkelBindings(root, Usd.TraverseInstanceProxies())
    cases.case(f"{title}: one skeleton", len(bindings) == 1, f"{len(bindings)} skeletons")
    skeleton = cache.GetSkelQuery(bindings[0].GetSkeleton())
    animation = skeleton.GetAnimQuery()
    cases.case(f"{title}: skeleton and animation are valid", bool(skeleton) and bool(animation) and skeleton.HasBindPose()
               and skeleton.HasRestPose(), skeleton)
    cases.case(f"{title}: joints of animation and skeleton are one list",
               list(animation.GetJointOrder()) == list(skeleton.GetJointOrder()))

    targets = bindings[0].GetSkinningTargets()
    names = [t.GetPrim().GetDisplayName() or t.GetPrim().GetName() for t in targets]
    at_rest = reference.skinned(reference.times[0])
    cases.case(f"{title}: all meshes are skinned", sorted(names) == sorted(at_rest), sorted(set(names) ^ set(at_rest)))
    worst = {name: 0.0 for name in names}
    extents = UsdGeom.Boundable(root.GetPrim()).GetExtentAttr()
    spare, inside = 0.0, True
    for time, code in pick(reference, rate):
        code = Usd.TimeCode(code)
        transforms, goal = skeleton.ComputeSkinningTransforms(code), reference.skinned(time)
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for name, target in zip(names, targets):
            points = UsdGeom.Mesh(target.GetPrim()).GetPointsAttr().Get()
            assert target.ComputeSkinnedPoints(transforms, points, code)
            points = np.array(points, float)
            if name in goal:
                off = np.abs(points - goal[name][: len(points)]).max() if len(points) <= len(goal[name]) else np.inf
                worst[name] = max(worst[name], float(off))
            low, high = np.minimum(low, points.min(0)), np.maximum(high, points.max(0))
        extent = np.array(extents.Get(code), float)
        inside &= bool((extent[0] <= low).all() and (extent[1] >= high).all())
        spare = max(spare, float((extent[1] - extent[0]).max() / (high - low).max()))
    for name, off in worst.items():
        cases.case(f"{title}: skinned points of {name} (off by {off:.1e} m)", off <= TOLERANCE)
    if prim is None:
        cases.case(f"USD: the extent holds the character (at most {spare:.2f} times its size)", inside and spare < 2)


def others(cases, stage, path_of_reference, rate):
    """Every animation after the first, which nothing is bound to, played in its place."""
    from pxr import UsdSkel

    names = [animation["name"] for animation in Glb(path_of_reference).json["animations"]]
    prims = [prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Animation)]
    found = {prim.GetDisplayName() or prim.GetName(): prim for prim in prims}
    cases.case(f"USD: {len(names)} animations", sorted(found) == sorted(names), f"{sorted(found)} for {names}")
    for place, name in enumerate(names[1:], 1):
        if name in found:
            skins(cases, stage, Reference(path_of_reference, place), rate, found[name])


def surfaces(cases, stage):
    from pxr import UsdGeom, UsdShade

    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh, name = UsdGeom.Mesh(prim), prim.GetName()
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
        indices = np.array(mesh.GetFaceVertexIndicesAttr().Get())
        good, why = UsdGeom.Mesh.ValidateTopology(indices.tolist(), counts.tolist(), len(mesh.GetPointsAttr().Get()))
        cases.case(f"USD: faces of {name} ({np.unique(counts).tolist()} corners)", good, why)
        normals = mesh.GetNormalsAttr().Get()
        cases.case(f"USD: normals of {name}", normals is not None and mesh.GetNormalsInterpolation() == "vertex"
                   and np.abs(np.linalg.norm(np.array(normals), axis=1) - 1).max() < 1e-3)
        st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        flat = st.ComputeFlattened() if st else None
        cases.case(f"USD: texture coordinates of {name}", flat is not None and len(flat) == len(indices))
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        shader = material.ComputeSurfaceSource()[0] if material else None
        cases.case(f"USD: material of {name}", shader and shader.GetIdAttr().Get() == "UsdPreviewSurface", material)


def blender(cases, path, reference, rate):
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=path)
    scene = bpy.context.scene
    armatures = [o for o in bpy.data.objects if o.type == "ARMATURE"]
    cases.case("Blender: one armature", len(armatures) == 1, f"{len(armatures)} armatures")
    if not armatures:
        return
    action = armatures[0].animation_data and armatures[0].animation_data.action
    cases.case("Blender: the armature has an action", action is not None)
    meshes = {o.data.name: o for o in bpy.data.objects if any(m.type == "ARMATURE" for m in o.modifiers)}
    at_rest = reference.skinned(reference.times[0])
    cases.case("Blender: all skinned meshes", sorted(meshes) == sorted(at_rest), f"{sorted(meshes)} for {sorted(at_rest)}")
    worst = {name: 0.0 for name in meshes}
    for time, frame in pick(reference, rate):
        scene.frame_set(round(frame))
        graph, goal = bpy.context.evaluated_depsgraph_get(), reference.skinned(time, BLENDER_LEAST_WEIGHT)
        for name, thing in meshes.items():
            owner = thing.evaluated_get(graph)
            mesh = owner.to_mesh()
            points = np.empty(len(mesh.vertices) * 3, np.float32)
            mesh.vertices.foreach_get("co", points)
            owner.to_mesh_clear()
            world = np.array(owner.matrix_world)
            points = points.reshape(-1, 3).astype(float) @ world[:3, :3].T + world[:3, 3]
            expected = goal.get(name, np.empty((0, 3)))[: len(points)] @ BLENDER_FROM_FILE.T
            off = float(np.abs(points - expected).max()) if len(points) == len(expected) else np.inf
            worst[name] = max(worst[name], off)
    for name, off in worst.items():
        cases.case(f"Blender: {name} plays (off by {off:.1e} m)", off <= TOLERANCE)


def main(path, path_of_reference, *options):
    cases, reference = Cases(), Reference(path_of_reference)
    # Blender carries a USD of its own under the same name, so a process has one or the other.
    if "--blender" in options:
        blender(cases, path, reference, (len(reference.times) - 1) / reference.times[-1])
        cases.exit()
    try:
        from pxr import Usd
    except ModuleNotFoundError:
        print("skipped USD: usd-core has no wheel for this platform")
        return

    stage = Usd.Stage.Open(path)
    valid(cases, stage)
    rate = stage_metadata(cases, stage, reference)
    skins(cases, stage, reference, rate)
    others(cases, stage, path_of_reference, rate)
    surfaces(cases, stage)
    cases.exit()


main(*sys.argv[1:])
