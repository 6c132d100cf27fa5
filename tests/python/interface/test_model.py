"""Models, requests, the bodies that they make, jobs, and measuring."""

import copy
import ctypes
import json
import math
import pickle

import anthronet
import numpy as np
import pytest
from anthronet import _native
from anthronet._library import call, described, lib
from support import ROOT, raised_by, raises


def test_measures(model):
    """36 measures with names, ranges and places"""
    assert len(set(anthronet.MEASURES)) == 36 and anthronet.MEASURES[3] == "height"
    ranges = model.measure_ranges
    assert list(ranges) == list(anthronet.MEASURES) and all(0 < low < high < 3 for low, high in ranges.values())
    assert model.measure_range("height") == ranges["height"]
    raises(anthronet.RequestError, lambda: model.measure_range("heigth"), "heigth", "not a measure")
    raises(TypeError, lambda: model.measure_range(3), "name", "int")


FILE = ROOT / "model" / "anthronet.safetensors"
SOURCES = {
    "the library": anthronet.Model.embedded,
    "a path": lambda: anthronet.Model.open(FILE),
    "a path as text": lambda: anthronet.Model.open(str(FILE)),
    "bytes": lambda: anthronet.Model.from_bytes(FILE.read_bytes()),
    "a bytearray": lambda: anthronet.Model.from_bytes(bytearray(FILE.read_bytes())),
}


@pytest.mark.parametrize("source", SOURCES)
def test_sources(woman, source):
    """a model is the same from wherever it comes"""
    request = anthronet.Request("female", height=1.70)
    with SOURCES[source]() as opened:
        assert opened.generate(request).to_bytes("glb", lod=3) == woman.to_bytes("glb", lod=3)
    raises(ValueError, lambda: opened.generate(request), "Model", "closed")


def test_model(woman, model):
    """what a model says of itself, and models that are none"""
    info = model.info()
    assert [m["name"] for m in info["measures"]] == list(anthronet.MEASURES)
    assert info["vertices_per_lod"] == [model.vertex_count(lod) for lod in range(4)]
    raises(anthronet.ArgumentError, lambda: model.vertex_count(4), "lod", "0 to 3")
    raises(ValueError, lambda: model.vertex_count(-1), "lod", "-1")
    assert model.latent_size == info["latent_size"] == len(woman.latent)
    assert anthronet.default_model() is model
    raises(anthronet.ModelError, lambda: anthronet.Model.from_bytes(b"no model"))
    raises(anthronet.ModelError, lambda: anthronet.Model.from_bytes(b""))
    raises(anthronet.IoError, lambda: anthronet.Model.open("no such file"), "no such file")
    raises(TypeError, lambda: anthronet.Model.open(7), "path", "int")
    raises(TypeError, lambda: anthronet.Model.from_bytes("text"), "data", "str")
    raises(ValueError, lambda: anthronet.Model.open("\udc80"), "path", "UTF-8")
    raises(TypeError, anthronet.Model, "documentation")


def test_request(model):
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
    request.latent = np.arange(model.latent_size) / 10
    assert (request.sex, request.fill, request.nearest, request.seed) == (None, "sample", True, 3)
    assert np.allclose(request.latent, np.arange(model.latent_size) / 10)
    body = model.generate(request)
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
    assert request.to_json() == before
    raises(anthronet.RequestError, lambda: anthronet.Request.from_json("[]"))
    raises(anthronet.RequestError, lambda: anthronet.Request.from_json('{"sexx": 1}'), "sexx")
    raises(anthronet.RequestError, lambda: anthronet.Request.from_json(""))
    raises(TypeError, lambda: anthronet.Request.from_json(b"{}"), "text", "bytes")
    raises(TypeError, lambda: hash(request))


REFUSED = [
    ("sex", "woman", ValueError), ("sex", 1, TypeError), ("fill", "none", ValueError), ("fill", None, ValueError),
    ("nearest", 2, TypeError), ("nearest", None, TypeError), ("seed", -1, ValueError), ("seed", 2**64, ValueError),
    ("seed", 1.0, TypeError), ("seed", True, TypeError), ("latent", "0" * 10, TypeError), ("latent", 3, TypeError),
    ("latent", [], ValueError), ("latent", ["1"], TypeError), ("latent", [math.nan], anthronet.RequestError),
]


@pytest.mark.parametrize("name, value, kind", REFUSED, ids=[f"{name}={value!r}" for name, value, _ in REFUSED])
def test_attributes_refused(name, value, kind):
    """attributes of a request refuse what is none of theirs"""
    request = anthronet.Request(height=1.7)
    before = request.to_json()
    raises(kind, lambda: setattr(request, name, value), name)
    raises(kind, lambda: anthronet.Request(**{name: value}), name)
    assert request.to_json() == before


def test_generate(woman, model):
    """bodies: numbers, report, interpolation, what cannot be"""
    assert woman.sex == "female" and woman.seed == 0 and woman.converged and woman.iterations >= 0
    assert abs(woman.measures["height"] - 1.70) <= 1e-4 and abs(woman.solve_residual) <= 1e-4
    assert abs(woman.bmi - woman.mass_kg / 1.70**2) < 0.01 and 0.03 < woman.volume_m3 < 0.12
    report, rows = woman.report, woman.measure_reports
    assert [row["name"] for row in report["measures"]] == list(anthronet.MEASURES)
    assert rows.dtype == anthronet.MEASURE_REPORT and rows.shape == (len(anthronet.MEASURES),)
    for row, listed in zip(rows, report["measures"]):
        assert row["obtained"] == listed["obtained"] == woman.measures[listed["name"]]
        assert row["percentile"] == listed["percentile"] and row["low90"] <= row["high90"]
        assert bool(row["given"]) == (listed["name"] == "height")
    assert rows["asked"][3] == 1.70
    a, b = anthronet.Request("female", height=1.60), anthronet.Request("female", height=1.80)
    half = model.interpolate(a, b, 0.5)
    assert abs(half.measures["height"] - 1.70) <= 1e-3
    raises(anthronet.RequestError, lambda: model.interpolate(a, b, math.nan))
    raises(TypeError, lambda: model.interpolate(a, {"height": 1}, 0.5), "b", "Request", "dict")
    raises(TypeError, lambda: model.generate({"height": 1}), "request", "Request", "dict")
    raises(TypeError, lambda: anthronet.generate(model="x"), "model", "Model", "str")
    raises(anthronet.RequestError, lambda: anthronet.generate(height=1700), "height")
    raises(anthronet.RequestError, lambda: anthronet.generate(latent=[0.0]), "z")
    conflict = {"height": 1.9, "torso_height_back": 0.35, "thigh_length": 0.32, "neck_length_midline": 0.06}
    error = raises(anthronet.InfeasibleError, lambda: anthronet.generate("female", **conflict), "height")
    assert error.code == _native.ERROR_INFEASIBLE and isinstance(error, (anthronet.Error, ValueError))
    nearest = anthronet.generate("female", nearest=True, **conflict)
    assert nearest.report["warnings"]


def test_job(model):
    """jobs: progress, results, errors, cancelling"""
    requests = [anthronet.Request("male", seed=i) for i in range(4)]
    requests.insert(2, anthronet.Request(height=17))
    with model.start(requests) as job:
        first = job.results(return_errors=True)
        got = list(first)
        assert job.wait() == job.progress == ("done", 5, 5)
        raises(anthronet.TakenError, lambda: job.take(0), "0")
        raises(anthronet.RequestError, lambda: job.take(2), "height")
        raises(anthronet.ArgumentError, lambda: job.take(5), "index")
        assert [type(r).__name__ for r in list(job.results(return_errors=True))] == ["RequestError"], "taken ones are left out"
    assert isinstance(got[2], anthronet.RequestError)
    for i in (0, 1, 3, 4):
        alone = model.generate(requests[i])
        assert got[i].seed == requests[i].seed and got[i].to_bytes("obj", lod=3) == alone.to_bytes("obj", lod=3)
    raises(ValueError, lambda: job.progress, "Job", "closed")
    job = model.start([anthronet.Request(seed=i) for i in range(200)])
    raises(anthronet.BusyError, lambda: job.take(199), "199")
    job.cancel()
    state, done, total = job.wait(60)
    assert state == "cancelled" and done < total == 200
    raises(anthronet.CancelledError, lambda: job.take(199), "cancelled")
    assert len(list(job.results())) == done
    job.close()
    job.close()
    assert model.start([]).wait().state == "done"
    raises(TypeError, lambda: model.start([{}]), "requests", "Request")


@pytest.mark.parametrize("space", ["gltf", "blender", "unity"])
def test_measuring_meshes(woman, model, space):
    """measuring meshes of two levels"""
    for lod in (0, 1):
        positions = woman.mesh(lod=lod, space=space, layout="model", body_only=True)[0].positions
        found = model.measure(positions, space)
        assert found.lod == lod
        if lod == 0:
            worst = max(abs(found.measures[name] - value) for name, value in woman.measures.items())
            assert worst < 1e-5 and abs(found.mass_kg - woman.mass_kg) < 1e-2, worst


def test_measuring_arrays(woman, model):
    """measuring positions of every stride and type of number, and what are none"""
    positions = woman.mesh(lod=1, space="unity", layout="model", body_only=True)[0].positions
    found = model.measure(positions, "unity")
    rows = np.zeros((len(positions), 7), np.float32)
    rows[:, 2:5] = positions
    for other in (rows[:, 2:5], positions.astype(np.float64), np.asfortranarray(positions), positions.astype(">f4"),
                  positions.tolist()):
        assert model.measure(other, "unity") == found
    raises(ValueError, lambda: model.measure(np.zeros((4, 2))), "positions", "(n, 3)", "(4, 2)")
    raises(TypeError, lambda: model.measure("text"), "positions")
    raises(TypeError, lambda: model.measure(np.zeros((4, 3), complex)), "positions")
    raises(ValueError, lambda: model.measure(positions, "maya"), "space", "maya", "blender")
    for wrong in (positions[:-1], np.zeros((0, 3), np.float32), positions * np.float32(np.nan)):
        assert isinstance(raised_by(lambda: model.measure(wrong)), anthronet.Error)


def test_measuring_files(woman, model, tmp_path):
    """measuring files"""
    file = tmp_path / "measured.glb"
    woman.save(file)
    found = model.measure_file(file)
    assert found.lod == 0 and abs(found.measures["height"] - 1.70) < 1e-4
    assert found.warnings == () and abs(found.mass_kg - woman.mass_kg) < 0.01
    metres, numbers = (ctypes.c_double * len(anthronet.MEASURES))(), described(_native.Measured)
    path = str(file).encode()
    call(lib.anthronet_measure_file, model._open, path, len(path), metres, len(metres), ctypes.byref(numbers))
    assert list(metres) == list(found.measures.values()) and numbers.mass_kg == found.mass_kg
    large = tmp_path / "centimetres.obj"
    woman.save(large)
    lines = (line.split() for line in large.read_text(encoding="utf-8").splitlines())
    scaled = (["v"] + [repr(100 * float(x)) for x in line[1:]] if line[:1] == ["v"] else line for line in lines)
    large.write_text("\n".join(map(" ".join, scaled)) + "\n", encoding="utf-8")
    found = model.measure_file(large)
    assert abs(found.measures["height"] - 1.70) < 1e-4 and "0.01 m" in found.warnings[0], found.warnings
    raises(anthronet.IoError, lambda: model.measure_file(tmp_path / "nothing.glb"), "nothing.glb")
    file.write_bytes(b"glTF")
    raises(anthronet.FileError, lambda: model.measure_file(file), "measured.glb")
