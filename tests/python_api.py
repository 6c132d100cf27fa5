"""The Python package, family by family, and that every function of the C interface is called by it.

    python python_api.py HEADER FOLDER
"""

import copy
import ctypes
import json
import math
import pickle
import re
import sys
from pathlib import Path

import numpy as np

CALLED = set()


class Counting(ctypes.CDLL):
    """A library that notes which of its functions are called."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)

        class Function(self._FuncPtr):
            _flags_, _restype_ = self._FuncPtr._flags_, self._FuncPtr._restype_

            def __call__(self, *arguments):
                CALLED.add(self.__name__)
                return super().__call__(*arguments)

        self._FuncPtr = Function


ctypes.CDLL, plain = Counting, ctypes.CDLL
import anthronet  # noqa: E402

ctypes.CDLL = plain

from anthronet import _errors, _library, _native  # noqa: E402
from python_cases import main_module, raises, run  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
HEADER, FOLDER = Path(sys.argv[1]), Path(sys.argv[2])

WOMAN = anthronet.generate(sex="female", height=1.70)
HEAVY = anthronet.generate(sex="female", height=1.70, waist_circumference=0.95)
MODEL = anthronet.default_model()


def bvh():
    """A walker of ten joints, centimetres, three frames."""
    children = {"Hips": ["LeftUpLeg", "RightUpLeg", "Spine"], "LeftUpLeg": ["LeftLeg"], "LeftLeg": ["LeftFoot"],
                "RightUpLeg": ["RightLeg"], "RightLeg": ["RightFoot"], "Spine": ["Head"]}
    offsets = {"Hips": "0 95 0", "LeftUpLeg": "9 -4 0", "RightUpLeg": "-9 -4 0", "Spine": "0 10 0", "Head": "0 50 0"}
    ends = {"LeftFoot": "0 -7 14", "RightFoot": "0 -7 14", "Head": "0 15 0"}

    def joint(name, kind):
        channels = "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation" if kind == "ROOT" else \
            "3 Zrotation Xrotation Yrotation"
        yield from (f"{kind} {name}", "{", f"OFFSET {offsets.get(name, '0 -42 0')}", f"CHANNELS {channels}")
        for child in children.get(name, []):
            yield from joint(child, "JOINT")
        if name in ends:
            yield from ("End Site", "{", f"OFFSET {ends[name]}", "}")
        yield "}"

    frames = [" ".join(map(str, [0, 95, z, 0, 0, 0, 0, x, 0] + [0] * 21)) for z, x in ((0, -20), (3, 0), (6, 20))]
    return "\n".join(["HIERARCHY", *joint("Hips", "ROOT"), "MOTION", "Frames: 3", "Frame Time: 0.0333333", *frames, ""])


def test_versions():
    """versions of package, library, wheel and workspace are one"""
    from importlib.metadata import PackageNotFoundError, version

    workspace = re.search(r'^version = "([^"]+)"', (ROOT / "Cargo.toml").read_text("utf-8"), re.MULTILINE).group(1)
    assert anthronet.__version__ == workspace, (anthronet.__version__, workspace)
    try:
        assert version("anthronet") == workspace
    except PackageNotFoundError:
        return "the package is not installed"
    defined = re.search(r"ANTHRONET_ABI_VERSION (\d+)", HEADER.read_text("utf-8")).group(1)
    assert anthronet.abi_version() == int(defined) == _native.ABI_VERSION


def test_measures():
    """36 measures with names, ranges and places"""
    assert len(set(anthronet.MEASURES)) == 36 and anthronet.MEASURES[3] == "height"
    ranges = MODEL.measure_ranges
    assert list(ranges) == list(anthronet.MEASURES) and all(0 < low < high < 3 for low, high in ranges.values())
    assert MODEL.measure_range("height") == ranges["height"]
    raises(anthronet.RequestError, lambda: MODEL.measure_range("heigth"), "heigth", "not a measure")
    raises(TypeError, lambda: MODEL.measure_range(3), "name", "int")


def test_model():
    """models from the library, a file, memory; info, sizes"""
    info = MODEL.info()
    assert [m["name"] for m in info["measures"]] == list(anthronet.MEASURES)
    assert info["vertices_per_lod"] == [MODEL.vertex_count(lod) for lod in range(4)]
    raises(anthronet.ArgumentError, lambda: MODEL.vertex_count(4), "lod", "0 to 3")
    raises(ValueError, lambda: MODEL.vertex_count(-1), "lod", "-1")
    assert MODEL.latent_size == info["latent_size"] == len(WOMAN.latent)
    file = ROOT / "model" / "anthronet.safetensors"
    request = anthronet.Request("female", height=1.70)
    same = WOMAN.to_bytes("glb", lod=3)
    for model in (anthronet.Model.embedded(), anthronet.Model.open(file), anthronet.Model.open(str(file)),
                  anthronet.Model.from_bytes(file.read_bytes()), anthronet.Model.from_bytes(bytearray(file.read_bytes()))):
        with model:
            assert model.generate(request).to_bytes("glb", lod=3) == same
        raises(ValueError, lambda: model.generate(request), "Model", "closed")
    assert anthronet.default_model() is MODEL
    raises(anthronet.ModelError, lambda: anthronet.Model.from_bytes(b"no model"))
    raises(anthronet.ModelError, lambda: anthronet.Model.from_bytes(b""))
    raises(anthronet.IoError, lambda: anthronet.Model.open("no such file"), "no such file")
    raises(TypeError, lambda: anthronet.Model.open(7), "path", "int")
    raises(TypeError, lambda: anthronet.Model.from_bytes("text"), "data", "str")
    raises(ValueError, lambda: anthronet.Model.open("\udc80"), "path", "UTF-8")
    raises(TypeError, anthronet.Model, "documentation")


def test_request():
    """requests: measures as of a dictionary, sides, JSON, copies"""
    request = anthronet.Request("male", height=1.8, arm_length_left=0.34, arm_length=0.33, seed=2**64 - 1)
    assert request["arm_length_left"] == 0.34 and request["arm_length_right"] == 0.33, "one side goes before both"
    assert "arm_length" in request and "neck_circumference" not in request and "nonsense" not in request
    raises(KeyError, lambda: request["arm_length"])
    raises(KeyError, lambda: request["neck_circumference"])
    raises(KeyError, lambda: request["nonsense"])
    request["arm_length"] = 0.3
    assert request["arm_length"] == 0.3 and len(request) == 3 == len(list(request))
    assert request.sex == "male" and request.seed == 2**64 - 1 and request.latent is None
    again = anthronet.Request.from_json(request.to_json())
    assert again == request and json.loads(request.to_json())["measures"]["height"] == 1.8
    for twin in (request.copy(), copy.copy(request), copy.deepcopy(request), pickle.loads(pickle.dumps(request)),
                 eval(repr(request), {"Request": anthronet.Request})):
        assert twin == request and twin is not request
        twin["height"] = 1.7
        assert twin != request and request["height"] == 1.8
    assert request != "a text"
    del request["arm_length"]
    request["height"] = None
    request["height"] = None
    assert request.measures == {} and not list(request) and bool(request)
    request.sex, request.fill, request.nearest, request.seed = None, "sample", True, 3
    request.latent = np.arange(MODEL.latent_size) / 10
    assert (request.sex, request.fill, request.nearest, request.seed) == (None, "sample", True, 3)
    assert np.allclose(request.latent, np.arange(MODEL.latent_size) / 10)
    body = MODEL.generate(request)
    assert np.array_equal(body.latent, request.latent), "latent numbers by hand are the body's"
    request.latent = None
    request.measures = {"foot_width": 0.1, "height": None}
    assert request.measures == {"foot_width_left": 0.1, "foot_width_right": 0.1}


def test_request_refusals():
    """requests refuse wrong names, numbers and kinds, and stay as they were"""
    request = anthronet.Request(height=1.7)
    before = request.to_json()

    def give(name, value):
        request[name] = value

    raises(anthronet.RequestError, lambda: give("heigth", 1.7), "heigth", "height")
    raises(anthronet.RequestError, lambda: give("heigth", None), "heigth")
    for value in (math.nan, math.inf, -math.inf):
        raises(anthronet.RequestError, lambda: give("height", value), "height", "finite")
    for value in ("1.7", True, [1.7], b"1", object()):
        raises(TypeError, lambda: give("height", value), "height", "number")
    raises(TypeError, lambda: give(3, 1.7), "measure", "int")
    raises(anthronet.RequestError, lambda: request.__delitem__("nonsense"), "nonsense")
    for name, value, kind in (("sex", "woman", ValueError), ("sex", 1, TypeError), ("fill", "none", ValueError),
                              ("fill", None, ValueError), ("nearest", 2, TypeError), ("nearest", None, TypeError),
                              ("seed", -1, ValueError), ("seed", 2**64, ValueError), ("seed", 1.0, TypeError),
                              ("seed", True, TypeError), ("latent", "0" * 10, TypeError), ("latent", 3, TypeError),
                              ("latent", [], ValueError), ("latent", ["1"], TypeError),
                              ("latent", [math.nan], anthronet.RequestError)):
        raises(kind, lambda: setattr(request, name, value), name)
        raises(kind, lambda: anthronet.Request(**{name: value}), name)
    assert request.to_json() == before
    raises(anthronet.RequestError, lambda: anthronet.Request.from_json("[]"))
    raises(anthronet.RequestError, lambda: anthronet.Request.from_json('{"sexx": 1}'), "sexx")
    raises(anthronet.RequestError, lambda: anthronet.Request.from_json(""))
    raises(TypeError, lambda: anthronet.Request.from_json(b"{}"), "text", "bytes")
    raises(TypeError, lambda: hash(request))


def test_generate():
    """bodies: numbers, report, interpolation, what cannot be"""
    assert WOMAN.sex == "female" and WOMAN.seed == 0 and WOMAN.converged and WOMAN.iterations >= 0
    assert abs(WOMAN.measures["height"] - 1.70) <= 1e-4 and abs(WOMAN.solve_residual) <= 1e-4
    assert abs(WOMAN.bmi - WOMAN.mass_kg / 1.70**2) < 0.01 and 0.03 < WOMAN.volume_m3 < 0.12
    report, rows = WOMAN.report, WOMAN.measure_reports
    assert [row["name"] for row in report["measures"]] == list(anthronet.MEASURES)
    assert rows.dtype == anthronet.MEASURE_REPORT and rows.shape == (36,)
    for row, listed in zip(rows, report["measures"]):
        assert row["obtained"] == listed["obtained"] == WOMAN.measures[listed["name"]]
        assert row["percentile"] == listed["percentile"] and row["low90"] <= row["high90"]
        assert bool(row["given"]) == (listed["name"] == "height")
    assert rows["asked"][3] == 1.70
    a, b = anthronet.Request("female", height=1.60), anthronet.Request("female", height=1.80)
    half = MODEL.interpolate(a, b, 0.5)
    assert abs(half.measures["height"] - 1.70) <= 1e-3
    raises(anthronet.RequestError, lambda: MODEL.interpolate(a, b, math.nan))
    raises(TypeError, lambda: MODEL.interpolate(a, {"height": 1}, 0.5), "b", "Request", "dict")
    raises(TypeError, lambda: MODEL.generate({"height": 1}), "request", "Request", "dict")
    raises(TypeError, lambda: anthronet.generate(model="x"), "model", "Model", "str")
    raises(anthronet.RequestError, lambda: anthronet.generate(height=1700), "height")
    raises(anthronet.RequestError, lambda: anthronet.generate(latent=[0.0]), "z")
    conflict = {"height": 1.9, "torso_height_back": 0.35, "thigh_length": 0.32, "neck_length_midline": 0.06}
    error = raises(anthronet.InfeasibleError, lambda: anthronet.generate("female", **conflict), "height")
    assert error.code == _native.ERROR_INFEASIBLE and isinstance(error, (anthronet.Error, ValueError))
    nearest = anthronet.generate("female", nearest=True, **conflict)
    assert nearest.report["warnings"]


def test_job():
    """jobs: progress, results, errors, cancelling"""
    requests = [anthronet.Request("male", seed=i) for i in range(4)]
    requests.insert(2, anthronet.Request(height=17))
    with MODEL.start(requests) as job:
        first = job.results(return_errors=True)
        got = list(first)
        assert job.wait() == job.progress == ("done", 5, 5)
        raises(anthronet.TakenError, lambda: job.take(0), "0")
        raises(anthronet.RequestError, lambda: job.take(2), "height")
        raises(anthronet.ArgumentError, lambda: job.take(5), "index")
        assert [type(r).__name__ for r in list(job.results(return_errors=True))] == ["RequestError"], "taken ones are left out"
    assert isinstance(got[2], anthronet.RequestError)
    for i in (0, 1, 3, 4):
        alone = MODEL.generate(requests[i])
        assert got[i].seed == requests[i].seed and got[i].to_bytes("obj", lod=3) == alone.to_bytes("obj", lod=3)
    raises(ValueError, lambda: job.progress, "Job", "closed")
    job = MODEL.start([anthronet.Request(seed=i) for i in range(200)])
    raises(anthronet.BusyError, lambda: job.take(199), "199")
    job.cancel()
    state, done, total = job.wait(60)
    assert state == "cancelled" and done < total == 200
    raises(anthronet.CancelledError, lambda: job.take(199), "cancelled")
    assert len(list(job.results())) == done
    job.close()
    job.close()
    assert MODEL.start([]).wait().state == "done"
    raises(TypeError, lambda: MODEL.start([{}]), "requests", "Request")


def test_measuring():
    """measuring meshes in every space and stride, and files"""
    for space in ("gltf", "blender", "unity"):
        for lod in (0, 1):
            positions = WOMAN.mesh(lod=lod, space=space, layout="model", body_only=True)[0].positions
            found = MODEL.measure(positions, space)
            assert found.lod == lod
            if lod == 0:
                worst = max(abs(found.measures[name] - value) for name, value in WOMAN.measures.items())
                assert worst < 1e-5 and abs(found.mass_kg - WOMAN.mass_kg) < 1e-2, (space, worst)
    rows = np.zeros((len(positions), 7), np.float32)
    rows[:, 2:5] = positions
    for other in (rows[:, 2:5], positions.astype(np.float64), np.asfortranarray(positions), positions.astype(">f4"),
                  positions.tolist()):
        assert MODEL.measure(other, "unity") == found
    file = FOLDER / "measured.glb"
    WOMAN.save(file)
    found = MODEL.measure_file(file)
    assert found.lod == 0 and abs(found.measures["height"] - 1.70) < 1e-4
    raises(anthronet.IoError, lambda: MODEL.measure_file(FOLDER / "nothing.glb"), "nothing.glb")
    file.write_bytes(b"glTF")
    raises(anthronet.FileError, lambda: MODEL.measure_file(file), "measured.glb")
    raises(ValueError, lambda: MODEL.measure(np.zeros((4, 2))), "positions", "(n, 3)", "(4, 2)")
    raises(TypeError, lambda: MODEL.measure("text"), "positions")
    raises(TypeError, lambda: MODEL.measure(np.zeros((4, 3), complex)), "positions")
    raises(ValueError, lambda: MODEL.measure(positions, "maya"), "space", "maya", "blender")
    for wrong in (positions[:-1], np.zeros((0, 3), np.float32), positions * np.float32(np.nan)):
        assert isinstance(raises_any(lambda: MODEL.measure(wrong)), anthronet.Error)


def raises_any(function):
    try:
        function()
    except Exception as error:
        return error
    return None


def test_skeleton():
    """joints, names in every vocabulary, humanoid bones"""
    joints, names = WOMAN.joints(), WOMAN.joint_names()
    assert joints.dtype == anthronet.JOINT and len(joints) == len(names) == WOMAN.joint_count == len(set(names))
    assert np.array_equal(WOMAN.parents, joints["parent"]) and WOMAN.parents[0] == -1
    assert (WOMAN.parents < np.arange(len(joints))).all()
    assert names == tuple(joint["name"] for joint in MODEL.info()["joints"])
    bones = {bone.native: bone for bone in anthronet.HUMANOID_BONES}
    assert len(bones) == 55 and sum(bone.required for bone in bones.values()) >= 15
    for vocabulary in ("unity", "mixamo", "vrm", "blender"):
        for native, name in zip(names, WOMAN.joint_names(vocabulary)):
            if native in bones:
                assert name == getattr(bones[native], vocabulary), (vocabulary, native, name)
    assert bones["upperarm_l"].mixamo == "mixamorig:LeftArm" and bones["upperarm_l"].unity_trait == "LeftUpperArm"
    raises(ValueError, lambda: WOMAN.joint_names("maya"), "names", "maya")
    raises(ValueError, lambda: WOMAN.joints("maya"), "space", "maya")
    raises(TypeError, lambda: WOMAN.joints([]), "space")


def test_mesh():
    """meshes: parts, shapes, layouts, arguments"""
    mesh = WOMAN.mesh()
    assert [part.name for part in mesh][:2] == ["Body", "Eyes"] and len(mesh) == len(mesh.parts) == 7
    assert mesh[0].name == "Body" and 0 < mesh[0].roughness <= 1 and len(mesh[0].base_color) == 4
    assert any(part.double_sided for part in mesh), "lashes are seen from both sides"
    for layout, influences in (("render", 4), ("model", 8)):
        for part in WOMAN.mesh(lod=1, influences=influences, layout=layout):
            count = part.vertex_count
            assert part.positions.shape == part.normals.shape == (count, 3) and part.positions.dtype == np.float32
            assert np.allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-4)
            assert part.joints.shape == part.weights.shape == (count, influences) and part.joints.dtype == np.uint16
            assert np.allclose(part.weights.sum(1), 1, atol=1e-5) and (np.diff(part.weights, axis=1) <= 0).all()
            assert part.joints.max() < WOMAN.joint_count and part.sources.shape == (count,)
            faces, uvs = (part.triangles, None) if layout == "render" else (part.quads, part.quad_uvs)
            assert faces.max() == count - 1 and faces.dtype == np.uint32
            if layout == "render":
                assert part.uvs.shape == (count, 2) and part.quads.shape == (0, 4) == part.quad_uvs.shape
            else:
                assert uvs.shape == faces.shape and uvs.max() < len(part.uvs) and part.uvs.shape[1] == 2
                assert part.triangles.shape == (0, 3) == part.triangle_uvs.shape
    assert [len(WOMAN.mesh(lod=lod, layout="model", body_only=True)[0].positions) for lod in range(4)] == [
        MODEL.vertex_count(lod) for lod in range(4)]
    assert len(WOMAN.mesh(lod=3, body_only=True)) == 1
    assert np.array_equal(mesh[0].read("positions"), mesh[0].positions)
    assert WOMAN.mesh(lod=3, skin_tone=10)[0].base_color != WOMAN.mesh(lod=3, skin_tone=1)[0].base_color
    for name, value in (("lod", 4), ("skin_tone", 11)):
        raises(anthronet.ArgumentError, lambda: WOMAN.mesh(**{name: value}), name)
    assert isinstance(raises_any(lambda: WOMAN.mesh(influences=5)), anthronet.Error)
    for name, value, kind in (("lod", 1.5, TypeError), ("lod", 2**32, ValueError), ("lod", "1", TypeError),
                              ("space", "maya", ValueError), ("layout", "x", ValueError), ("body_only", 1, TypeError)):
        raises(kind, lambda: WOMAN.mesh(**{name: value}), name)


def test_blend_shapes():
    """blend shapes lead to the other body's surface"""
    mesh, other = WOMAN.mesh(lod=1), HEAVY.mesh(lod=1)
    mesh.add_blend_shape("heavy", HEAVY)
    mesh.add_blend_shape("heaviér", HEAVY)
    assert mesh.blend_shapes == ("heavy", "heaviér")
    for part, there in zip(mesh, other):
        for shape in ("heavy", 1):
            assert np.allclose(part.positions + part.blend_shape(shape), there.positions, atol=1e-6)
            assert np.allclose(part.normals + part.blend_shape(shape, "normals"), there.normals, atol=1e-6)
            assert np.array_equal(part.read_blend_shape(shape), part.blend_shape(shape))
    view = mesh[0].blend_shape(0)
    mesh.update(HEAVY)
    assert mesh.blend_shapes == () and np.abs(view).max() > 0.01
    raises(anthronet.InvalidError, lambda: mesh.add_blend_shape("", HEAVY))
    raises(TypeError, lambda: mesh.add_blend_shape("x", 3), "body", "int")
    raises(ValueError, lambda: mesh[0].blend_shape("x"), "shape", "x")
    raises(anthronet.ArgumentError, lambda: mesh[0].blend_shape(0), "shape")
    mesh.add_blend_shape("x", WOMAN)
    raises(ValueError, lambda: mesh[0].blend_shape("x", "uvs"), "attribute", "uvs")


def test_clip():
    """clips: built-in, sampling, baking, editing"""
    assert anthronet.BUILTIN_CLIPS[:2] == ("idle", "walk")
    walk = anthronet.builtin_clip("walk", WOMAN)
    assert walk.name == "walk" and walk.joint_count == WOMAN.joint_count and walk.report is None
    assert abs(walk.duration - (walk.frame_count - 1) / walk.frames_per_second) < 1e-6
    for relative in ("parent", "model"):
        for space in ("gltf", "blender", "unity"):
            baked = walk.bake(relative, space)
            assert baked.shape == (walk.frame_count, walk.joint_count, 7) and baked.dtype == np.float32
            for frame in (0, 7):
                pose = walk.sample(frame / walk.frames_per_second, relative=relative, space=space)
                assert np.allclose(pose, baked[frame], atol=1e-5)
    out = np.zeros((walk.joint_count, 7), np.float32)
    assert walk.sample(0.5, out=out) is out and np.array_equal(out, walk.sample(0.5))
    late = walk.duration * 2.5
    once, loop, travel = (walk.sample(late, wrap, "model") for wrap in ("once", "loop", "travel"))
    assert np.allclose(once, walk.bake("model")[-1], atol=1e-5) and not np.allclose(once, loop)
    assert travel[:, 6].mean() > loop[:, 6].mean() + 0.5, "two rounds further on"
    frames = walk.bake(space="unity")
    again = anthronet.Clip.from_poses(WOMAN, "nöw", 30, frames, space="unity")
    assert again.name == "nöw" and np.allclose(again.bake(space="unity"), frames, atol=1e-6)
    slow = walk.resample(15)
    assert slow.frames_per_second == 15 and abs(slow.duration - walk.duration) < 0.1
    idle = anthronet.builtin_clip("idle", WOMAN)
    assert np.abs(walk.in_place().bake("model")[:, 1, 6]).max() < np.abs(walk.bake("model")[:, 1, 6]).max()
    joined, mixed, looped = walk.crossfade(idle, 0.3), walk.blend(idle, 0.5), idle.looped(0.2)
    assert joined.duration > walk.duration and mixed.frame_count > 0
    mask = walk.joint_mask("spine_01", "thigh_l")
    assert mask.shape == (walk.joint_count,) and set(mask) == {0, 1} and walk.joint_mask().max() == 0
    names = list(WOMAN.joint_names())
    assert mask[names.index("head")] == mask[names.index("foot_l")] == 1 and mask[names.index("foot_r")] == 0
    half, layered = walk.blend(idle, 1, mask).bake(), idle.additive(walk, mask=mask).bake()
    assert np.allclose(half[3, mask == 0], walk.bake()[3, mask == 0], atol=1e-6)
    assert np.allclose(half[3, mask == 1], idle.bake()[3, mask == 1], atol=1e-6)
    assert np.allclose(layered[:, mask == 0], idle.bake()[:, mask == 0], atol=1e-6)
    assert np.abs(layered[:, mask == 1] - idle.bake()[:, mask == 1]).max() > 0.01
    for space in ("gltf", "unity"):
        same = idle.additive(walk, 1, walk.sample(0.3, space=space), space=space)
        assert np.allclose(same.sample(0.3), idle.sample(0.3), atol=1e-5), "what differs from itself by nothing"
    pose = looped.bake()
    assert np.allclose(pose[0, :, 5], pose[-1, :, 5], atol=1e-6), "heights meet"
    assert np.abs((pose[0, :, :4] * pose[-1, :, :4]).sum(1)).min() > 1 - 1e-6, "and rotations do"
    for wrong in (np.zeros((walk.joint_count, 7)), np.zeros((3, 7), np.float32), np.zeros((7, walk.joint_count), np.float32).T,
                  [0.0]):
        assert isinstance(raises_any(lambda: walk.sample(0, out=wrong)), (TypeError, ValueError))
    frozen = np.zeros((walk.joint_count, 7), np.float32)
    frozen.flags.writeable = False
    raises(ValueError, lambda: walk.sample(0, out=frozen), "out")
    raises(anthronet.RequestError, lambda: walk.sample(math.nan), "seconds")
    raises(ValueError, lambda: walk.sample(0, "often"), "wrap", "often")
    raises(TypeError, lambda: walk.sample("0"), "seconds")
    raises(ValueError, lambda: walk.bake("joint"), "relative", "joint")
    for bad in (lambda: walk.resample(0), lambda: walk.looped(math.nan), lambda: walk.looped(-1), lambda: walk.blend(idle, math.inf),
                lambda: walk.crossfade(idle, 1e9), lambda: anthronet.builtin_clip("nonsense", WOMAN),
                lambda: anthronet.Clip.from_poses(WOMAN, "x", 0, frames), lambda: anthronet.Clip.from_poses(WOMAN, "x", 30, frames * 0)):
        assert isinstance(raises_any(bad), anthronet.Error), bad
    raises(ValueError, lambda: anthronet.Clip.from_poses(WOMAN, "x", 30, frames[:, :-1]), "frames", "shape")
    raises(TypeError, lambda: walk.blend(3, 0.5), "other", "int")
    raises(ValueError, lambda: walk.blend(idle, 0.5, mask[1:]), "mask", "shape")
    raises(anthronet.InvalidError, lambda: walk.blend(idle, 0.5, mask * 2), "joint mask", "0 to 1")
    raises(anthronet.InvalidError, lambda: walk.joint_mask("tail"), "tail")
    raises(TypeError, lambda: walk.joint_mask(3), "joints", "int")
    raises(TypeError, lambda: walk.additive(3), "layer", "int")
    raises(ValueError, lambda: walk.additive(idle, reference=walk.bake()), "reference", "shape")
    raises(TypeError, lambda: anthronet.builtin_clip("walk", None), "body", "NoneType")


def test_motion():
    """motions: from a file, memory and poses, retargeted"""
    file = FOLDER / "steps.bvh"
    file.write_text(bvh(), encoding="utf-8")
    motion = anthronet.open_motion(file)
    assert motion.clip_names == ("steps",) and motion.report["format"] == "BVH", (motion.clip_names, motion.report)
    assert anthronet.Motion.from_bytes(bvh().encode(), "steps.bvh").report == motion.report
    clip = motion.retarget(WOMAN)
    assert clip.frame_count == 3 and clip.joint_count == WOMAN.joint_count and clip.report["joints"]
    assert motion.retarget(WOMAN, frames_per_second=60).frames_per_second == 60
    assert anthronet.open_motion(file, frames_per_second=10).retarget(WOMAN).frames_per_second == 10
    scaled = anthronet.open_motion(file, metres_per_unit=0.02, up="y").report
    assert scaled["unit_found"] == "asked" == scaled["up_found"]
    left_alone = motion.retarget(WOMAN, mapping={"Head": None, "Spine": "spine_03"}).report["joints"]
    assert left_alone != clip.report["joints"]
    for options in ({"in_place": True}, {"looped": True}, {"root_motion": True}, {"limits": False}, {"feet": False},
                    {"fingers": "relaxed"}, {"fingers": "rest"}):
        motion.retarget(WOMAN, **options)
    walk, joints = anthronet.builtin_clip("walk", WOMAN), WOMAN.joints("blender")
    rest = np.concatenate([joints["rotation"], joints["translation"]], axis=1)
    posed = anthronet.Motion.from_poses("walk", WOMAN.joint_names(), list(WOMAN.parents), rest, walk.bake(space="blender"), 30,
                                        space="blender")
    assert posed.clip_names == ("walk",)
    own = posed.retarget(WOMAN, limits=False, feet=False)
    # The way over the ground is the pelvis' now, all else is where it was.
    assert np.allclose(own.bake("model")[:, 1:, 4:], walk.bake("model")[:, 1:, 4:], atol=1e-5)
    arguments = ["walk", WOMAN.joint_names(), list(WOMAN.parents), rest, walk.bake(), 30]
    for place, value in ((1, ["a"] * len(rest)), (2, [5] * len(rest)), (3, rest * np.nan), (5, 0)):
        wrong = [*arguments[:place], value, *arguments[place + 1 :]]
        assert isinstance(raises_any(lambda: anthronet.Motion.from_poses(*wrong)), anthronet.Error), place
    for place, value in ((0, 3), (1, "abc"), (1, [1]), (2, [-1]), (2, ["x"] * len(rest)), (3, rest[1:]), (4, rest), (5, "30")):
        wrong = [*arguments[:place], value, *arguments[place + 1 :]]
        assert isinstance(raises_any(lambda: anthronet.Motion.from_poses(*wrong)), (TypeError, ValueError)), place
    raises(anthronet.ArgumentError, lambda: motion.retarget(WOMAN, clip=1), "clip")
    raises(anthronet.IoError, lambda: anthronet.open_motion("nothing.bvh"), "nothing.bvh")
    raises(anthronet.FileError, lambda: anthronet.Motion.from_bytes(b"x", "a.bvh"))
    assert isinstance(raises_any(lambda: anthronet.Motion.from_bytes(b"x", "a.txt")), anthronet.Error)
    assert isinstance(raises_any(lambda: motion.retarget(WOMAN, mapping={"no joint": "x"})), anthronet.Error)
    raises(ValueError, lambda: anthronet.open_motion(file, up="x"), "up", "'x'")
    for name in ("metres_per_unit", "frames_per_second"):
        for value in (0, -1, math.nan):
            raises(ValueError, lambda: anthronet.open_motion(file, **{name: value}), name, "positive")
    raises(ValueError, lambda: motion.retarget(WOMAN, fingers="x"), "fingers")
    raises(TypeError, lambda: motion.retarget(WOMAN, limits=None), "limits")


def test_skinning():
    """skinning: methods, buffers, many characters, refusals"""
    mesh = WOMAN.mesh(lod=1)
    skinner, walk = mesh.skinner(), anthronet.builtin_clip("walk", WOMAN)
    assert skinner.vertex_count == mesh[0].vertex_count
    rest = WOMAN.joints()
    bind = np.zeros((len(rest), 7), np.float32)
    bind[:, 3] = 1
    pose = walk.sample(0.3, relative="model")
    linear, dual, moved = (skinner.skin(pose, method=m)[0] for m in ("linear", "dual_quaternion", "joint_translation"))
    assert not np.allclose(linear, dual) and not np.allclose(linear, moved)
    offsets = np.full((skinner.vertex_count, 3), 0.01, np.float32)
    assert 0.001 < np.abs(skinner.skin(pose, offsets=offsets)[0] - linear).max() < 0.02
    weights, joints = mesh[0].weights, mesh[0].joints
    matrices = np.zeros((len(pose), 4, 4))
    x, y, z, w = pose[:, :4].astype(float).T
    matrices[:, :3, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w),
                                    1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w),
                                    1 - 2 * (x * x + y * y)], -1).reshape(-1, 3, 3)
    matrices[:, :3, 3], matrices[:, 3, 3] = pose[:, 4:], 1
    matrices = matrices @ rest["joint_from_model"]
    blended = np.einsum("vi,vijk->vjk", weights.astype(float), matrices[joints])
    expected = np.einsum("vjk,vk->vj", blended[:, :3], np.c_[mesh[0].positions, np.ones(len(weights))])
    assert np.abs(expected - linear).max() < 1e-5, np.abs(expected - linear).max()
    vertices = np.zeros(skinner.vertex_count, [("position", "f4", 3), ("normal", "f4", 3), ("uv", "f4", 2)])
    positions, normals = skinner.skin(pose, vertices["position"], vertices["normal"])
    alone = skinner.skin(pose)
    assert np.array_equal(vertices["position"], alone[0]) and np.array_equal(vertices["normal"], alone[1])
    assert (vertices["uv"] == 0).all() and np.shares_memory(positions, vertices)
    assert skinner.skin(pose, normals=False)[1] is None
    poses = [walk.sample(i / 7, relative="model") for i in range(6)]
    crowd = anthronet.skin([anthronet.SkinJob(skinner, p) for p in poses])
    assert all(np.array_equal(many[0], skinner.skin(p)[0]) for many, p in zip(crowd, poses))
    assert anthronet.skin([]) == []
    count, job = skinner.vertex_count, anthronet.SkinJob
    shared = np.zeros((count, 3), np.float32)
    raises(anthronet.ArgumentError, lambda: anthronet.skin([job(skinner, pose, shared), job(skinner, pose, shared[::-1][::-1])]), "overlap")
    raises(anthronet.ArgumentError, lambda: skinner.skin(pose, shared, offsets=shared), "overlap", "offsets")
    raises(ValueError, lambda: skinner.skin(pose, shared[:-1]), "positions", "shape")
    raises(TypeError, lambda: skinner.skin(pose, shared.astype(np.float64)), "positions", "float32")
    raises(TypeError, lambda: skinner.skin(pose, shared.tolist()), "positions", "ndarray")
    raises(ValueError, lambda: skinner.skin(pose, mesh[0].positions), "positions", "read-only")
    raises(ValueError, lambda: skinner.skin(pose, shared[::-1]), "positions", "strides")
    raises(ValueError, lambda: skinner.skin(pose, np.zeros((3, count), np.float32).T), "positions", "strides")
    raises(ValueError, lambda: skinner.skin(pose, np.broadcast_to(shared[:1], shared.shape)), "positions")
    raises(ValueError, lambda: skinner.skin(pose, method="magic"), "method", "magic")
    raises(ValueError, lambda: skinner.skin(pose, offsets=offsets[1:]), "offsets")
    raises(ValueError, lambda: skinner.skin(pose[:, :6]), "joints", "(n, 7)")
    raises(anthronet.ArgumentError, lambda: skinner.skin(pose[1:]), "joint")
    before = shared.copy()
    assert isinstance(raises_any(lambda: skinner.skin(pose * np.nan, shared)), anthronet.Error)
    assert isinstance(raises_any(lambda: anthronet.skin([job(skinner, pose, shared), job(skinner, pose[1:])])), anthronet.Error)
    assert np.array_equal(shared, before), "nothing is written unless all is in order"
    raises(anthronet.ArgumentError, lambda: mesh.skinner(7), "part")
    raises(TypeError, lambda: anthronet.skin([3]), "jobs")
    raises(TypeError, lambda: anthronet.skin([job("x", pose)]), "skinner")


def test_export():
    """files of every format, on the disk and in memory"""
    clips = [anthronet.builtin_clip(name, WOMAN) for name in ("walk", "wave")]
    heads = {"glb": b"glTF", "vrm": b"glTF", "usda": b"#usda", "usdc": b"PXR-USDC", "usdz": b"PK"}
    for format, head in [*heads.items(), ("obj", b"")]:
        data = WOMAN.to_bytes(format, lod=3)
        file = FOLDER / f"python.{format}"
        WOMAN.save(file, lod=3)
        assert data.startswith(head) and file.read_bytes() == data, format
    moving = WOMAN.to_bytes("glb", lod=3, clips=clips, joint_names="mixamo")
    assert b'"mixamorig:Hips"' in moving and b'"walk"' in moving and b'"wave"' in moving
    assert b'"walk 2"' in WOMAN.to_bytes("glb", lod=3, clips=[clips[0], clips[0]])
    assert len(WOMAN.to_bytes("glb", lod=2, compress=True)) < len(WOMAN.to_bytes("glb", lod=2)) * 0.7
    assert len(WOMAN.to_bytes("glb", lod=3, body_only=True)) < len(WOMAN.to_bytes("glb", lod=3))
    assert len(WOMAN.to_bytes("glb", lod=3, influences=8)) > len(WOMAN.to_bytes("glb", lod=3))
    assert WOMAN.to_bytes("glb", lod=3, skin_tone=9) != WOMAN.to_bytes("glb", lod=3)
    WOMAN.save(str(FOLDER / "umläut 人.gltf").encode(), lod=3)
    assert (FOLDER / "umläut 人.gltf").is_file() and (FOLDER / "umläut 人.bin").is_file()
    for bad in (lambda: WOMAN.to_bytes("fbx"), lambda: WOMAN.save(FOLDER / "a.fbx"), lambda: WOMAN.save(FOLDER),
                lambda: WOMAN.save(FOLDER / "no folder" / "a.glb"),
                lambda: WOMAN.to_bytes("glb", influences=3), lambda: WOMAN.save(FOLDER / "a\0b.glb")):
        assert isinstance(raises_any(bad), anthronet.Error), bad
    raises(TypeError, lambda: WOMAN.to_bytes("glb", clips=clips[0]), "clips", "list")
    raises(TypeError, lambda: WOMAN.to_bytes("glb", clips=["walk"]), "clips", "Clip")
    raises(TypeError, lambda: WOMAN.save(None), "path")
    raises(ValueError, lambda: WOMAN.save("a.glb", joint_names="maya"), "joint_names")
    assert not (FOLDER / "a.fbx").exists()


def test_errors():
    """every code has its class, and codes of the future are errors too"""
    for name in [name for name in dir(_native) if name.startswith("ERROR_")]:
        error = _errors.error_of(getattr(_native, name), "why")
        assert isinstance(error, anthronet.Error) and str(error) == error.message == "why"
        assert (type(error) is anthronet.Error) == (name == "ERROR_OTHER"), name
        assert pickle.loads(pickle.dumps(error)).code == error.code
    assert type(_errors.error_of(12345, "new")) is anthronet.Error


def test_arguments_in_c():
    """the C interface itself refuses what the package never passes"""
    error, out = _native.Error(), ctypes.c_void_p(5)
    request = _library.lib.anthronet_request_new
    assert request(None, ctypes.byref(error)) == _native.ERROR_POINTER == error.code and b"NULL" in error.message
    assert _library.lib.anthronet_generate(None, None, ctypes.byref(out), None) == _native.ERROR_POINTER and out.value == 5
    # In place, which leaves no views valid: the package makes a new mesh instead.
    mesh = WOMAN.mesh(lod=3)
    assert _library.lib.anthronet_mesh_update(mesh._open, HEAVY._open, None) == _native.OK
    assert np.array_equal(mesh[0].positions, HEAVY.mesh(lod=3)[0].positions)


def test_log():
    """the log callback is set and taken away"""
    anthronet.set_log_callback(print)
    anthronet.set_log_callback(None)


def test_documentation():
    """everything public is documented and typed"""
    import inspect

    for name in anthronet.__all__:
        thing = getattr(anthronet, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert inspect.getdoc(thing), name
        members = vars(thing).items() if inspect.isclass(thing) and thing.__module__.startswith("anthronet") else ()
        for member, value in members:
            function = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
            if member.startswith("_") or not inspect.isfunction(function):
                continue
            assert function.__doc__, f"{name}.{member} has no documentation"
            assert "return" in function.__annotations__, f"{name}.{member} has no types"


def test_zz_every_function_was_called():
    """every function of the header was called"""
    import gc

    gc.collect()
    text = re.sub(r"//.*", "", HEADER.read_text("utf-8").split("*/", 1)[1])
    listed = set(re.findall(r"\b(anthronet_\w+)\s*\(", text))
    assert len(listed) > 80 and listed - {"anthronet_log_callback"} == CALLED & listed, sorted(listed - CALLED)


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    run(main_module())
