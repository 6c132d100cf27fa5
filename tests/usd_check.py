"""A .usda, .usdc or .usdz in Pixar's USD and, if asked, in Blender, against the .glb of the same person and clip.

    python usd_check.py FILE.usdc REFERENCE.glb [--blender]

The reference is skinned here in double precision from the .glb alone, so that what the two writers make of one clip
has to agree: joints, rest pose, weights, rotations, root motion, times.
"""

import sys

import numpy as np

from glb import Cases, Glb, rotation

TOLERANCE = 1e-5  # metres; both files hold single precision
FRAMES = 5
# Blender's importer leaves smaller weights out.
BLENDER_LEAST_WEIGHT = 1e-5
# Blender's axes: +Z up, the character looks along -Y. The file's: +Y up, it looks along +Z.
BLENDER_FROM_FILE = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)


class Reference:
    """The first animation of a .glb: skinned vertices at its key times."""

    def __init__(self, path):
        self.glb = Glb(path)
        animation = self.glb.json["animations"][0]
        self.name = animation.get("name")
        self.tracks, times = {}, set()
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            at = self.glb.accessor(sampler["input"]).astype(float)
            assert sampler.get("interpolation", "LINEAR") == "LINEAR"
            target = channel["target"]
            self.tracks[target["node"], target["path"]] = at, self.glb.accessor(sampler["output"]).astype(float)
            times.update(at.tolist())
        self.times = np.array(sorted(times))

    def local(self, node, time):
        """parent_from_node at a key time; what has no track, or none at this time, stands between its keys."""
        rest = self.glb.nodes[node]
        parts = {"translation": rest.get("translation", (0, 0, 0)), "rotation": rest.get("rotation", (0, 0, 0, 1))}
        for part in parts:
            if (node, part) in self.tracks:
                at, values = self.tracks[node, part]
                i = int(np.clip(np.searchsorted(at, time + 1e-9) - 1, 0, len(at) - 1))
                share = 0 if i + 1 == len(at) else (time - at[i]) / (at[i + 1] - at[i])
                parts[part] = values[i] if share < 1e-6 else values[i] * (1 - share) + values[i + 1] * share
        matrix = np.eye(4)
        matrix[:3, :3] = rotation(np.array(parts["rotation"]) / np.linalg.norm(parts["rotation"]))
        matrix[:3, 3] = parts["translation"]
        return matrix

    def world(self, time):
        done = {}

        def at(node):
            if node not in done:
                above = at(self.glb.parent[node]) if node in self.glb.parent else np.eye(4)
                done[node] = above @ self.local(node, time)
            return done[node]

        return np.array([at(i) for i in range(len(self.glb.nodes))])

    def skinned(self, time, least=0.0):
        """By mesh: positions (vertices, 3), with the copies at texture seams after the model's own vertices.

        Weights below `least` are left out.
        """
        world, meshes = self.world(time), {}
        for node in self.glb.skinned_nodes():
            joints, joint_from_bind = self.glb.skin(node)
            matrices, parts = world[joints] @ joint_from_bind, []
            for primitive in self.glb.primitives(node):
                slots, weights = self.glb.influences(primitive)
                weights = np.where(weights < least, 0, weights)
                weights /= weights.sum(1, keepdims=True)
                points = np.c_[self.glb.positions(primitive), np.ones(len(slots))]
                parts.append(np.einsum("vk,vkij,vj->vi", weights, matrices[slots], points)[:, :3])
            meshes[self.glb.nodes[node]["name"]] = np.vstack(parts)
        return meshes


def pick(times, rate):
    """Some key times and their frames: a .glb tells seconds in single precision, and a key is a whole frame."""
    chosen = [times[i * (len(times) - 1) // (FRAMES - 1)] for i in range(FRAMES)]
    return [(time, round(time * rate)) for time in chosen]


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


def skins(cases, stage, reference, rate):
    """UsdSkel's own skinning; the points of all meshes by time, for the extents."""
    from pxr import Usd, UsdGeom, UsdSkel

    cache, root = UsdSkel.Cache(), UsdSkel.Root(stage.GetDefaultPrim())
    cache.Populate(root, Usd.TraverseInstanceProxies())
    bindings = cache.ComputeSkelBindings(root, Usd.TraverseInstanceProxies())
    cases.case("USD: one skeleton", len(bindings) == 1, f"{len(bindings)} skeletons")
    skeleton = cache.GetSkelQuery(bindings[0].GetSkeleton())
    animation = skeleton.GetAnimQuery()
    cases.case("USD: skeleton and animation are valid", bool(skeleton) and bool(animation) and skeleton.HasBindPose()
               and skeleton.HasRestPose(), skeleton)
    cases.case("USD: joints of animation and skeleton are one list",
               list(animation.GetJointOrder()) == list(skeleton.GetJointOrder()))

    targets = bindings[0].GetSkinningTargets()
    names = [t.GetPrim().GetDisplayName() or t.GetPrim().GetName() for t in targets]
    at_rest = reference.skinned(reference.times[0])
    cases.case("USD: all meshes are skinned", sorted(names) == sorted(at_rest), sorted(set(names) ^ set(at_rest)))
    worst = {name: 0.0 for name in names}
    extents = UsdGeom.Boundable(root.GetPrim()).GetExtentAttr()
    spare, inside = 0.0, True
    for time, frame in pick(reference.times, rate):
        code = Usd.TimeCode(frame)
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
        cases.case(f"USD: skinned points of {name} (off by {off:.1e} m)", off <= TOLERANCE)
    cases.case(f"USD: the extent holds the character (at most {spare:.2f} times its size)", inside and spare < 2)


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
    for time, frame in pick(reference.times, rate):
        scene.frame_set(frame)
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


def main(path, reference, *options):
    cases, reference = Cases(), Reference(reference)
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
    surfaces(cases, stage)
    cases.exit()


main(*sys.argv[1:])
