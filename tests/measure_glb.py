"""Measures written .glb files again, with numpy and scipy, from the definitions that `anthronet info --json` gives.

    python measure_glb.py ANTHRONET FOLDER

The six vectors of the paper's interpolation table as request files, some partial requests as arguments, and random
people. All measures of every file have to equal the report's, and the given ones what was asked. A slice cuts the edges
that its definition lists; that they are all there is to cut is checked on the whole mesh.
"""

import json
import random
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError

from glb import Cases, Glb

TOLERANCE = 1e-4  # metres: what the project promises
BODY_VERTICES = 53_514  # of level of detail 0
RANDOM_PEOPLE = 100

# Measures that the standards take elsewhere than the paper: its values are not those of ours.
ELSEWHERE = {"shoulder_width", "neck_circumference", "neck_length_lateral", "thigh_length", "calf_length"}

PARTIAL = {
    "woman": {"sex": "female", "measures": {"height": 1.70}},
    "small woman": {"sex": "female", "measures": {"height": 1.52, "hip_circumference": 0.95}},
    "heavy woman": {"sex": "female", "measures": {"height": 1.66, "waist_circumference": 1.10}},
    "man": {"sex": "male", "measures": {"height": 1.80, "chest_circumference": 1.05}},
    "slim man": {"sex": "male", "measures": {"height": 1.92, "waist_circumference": 0.78, "thigh_circumference": 0.52}},
    "long left arm": {"sex": "male", "measures": {"arm_length_left": 0.34, "arm_length_right": 0.335}},
    "long feet": {"sex": "female", "measures": {"heel_to_toe_length": 0.27, "foot_width": 0.10}},
    "thick neck": {"sex": "male", "measures": {"neck_circumference": 0.46, "head_circumference": 0.55}},
}


def hull_perimeter(points, normal):
    """Length of a tape around points (n, 3) that are seen along a normal."""
    normal = normal / np.linalg.norm(normal)
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    flat = np.c_[points @ across, points @ np.cross(normal, across)]
    # Of a plane hull scipy calls the perimeter its area.
    return ConvexHull(flat).area


def crossings(vertices, edges, origin, normal):
    """Points where edges (n, 2) pass through a plane, and which edges those are."""
    side = (vertices - origin) @ normal
    a, b = side[edges[:, 0]], side[edges[:, 1]]
    through = (a < 0) != (b < 0)
    a, b, cut = a[through], b[through], edges[through]
    t = (a / (a - b))[:, None]
    return vertices[cut[:, 0]] * (1 - t) + vertices[cut[:, 1]] * t, through


def whole_slice(vertices, triangles, origin, normal):
    """Tape around the part of the cut through all triangles whose middle lies nearest to the plane's origin."""
    sides = np.sort(np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, edge_of_side = np.unique(sides, axis=0, return_inverse=True)
    points, through = crossings(vertices, edges, origin, normal)
    # A triangle that is cut joins the points on two of its sides.
    of_triangle = edge_of_side.reshape(3, -1).T
    cut = through[of_triangle]
    pairs = of_triangle[cut.sum(1) == 2][cut[cut.sum(1) == 2]].reshape(-1, 2)
    number = np.cumsum(through) - 1
    pairs = number[pairs]
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    count, part = connected_components(graph, directed=False)
    parts = [points[part == i] for i in range(count)]
    nearest = min(parts, key=lambda p: np.linalg.norm((p.min(0) + p.max(0)) / 2 - origin))
    return hull_perimeter(nearest, normal)


class Body:
    """Vertices in the T-pose, and standing as `info` tells: the file's skin, turned about z joint after joint."""

    def __init__(self, glb, info):
        node = glb.skinned_nodes()[0]
        primitive = glb.primitives(node)[0]
        self.vertices = glb.positions(primitive)
        nodes, _ = glb.skin(node)
        joints, weights = glb.influences(primitive)
        turns = {turn["joint"]: turn for turn in info["standing"]}
        self.chains = {}
        for joint in nodes:
            chain, at = [], joint
            while at is not None:
                chain += [turns[name] for name in [glb.nodes[at]["name"]] if name in turns]
                at = glb.parent.get(at)
            self.chains[glb.nodes[joint]["name"]] = chain
        self.standing = np.zeros_like(self.vertices)
        names = [glb.nodes[joint]["name"] for joint in nodes]
        for index, name in enumerate(names):
            share = np.where(joints == index, weights, 0).sum(1)
            follows = share > 0
            self.standing[follows] += share[follows, None] * self.carried(name, self.vertices[follows])

    def carried(self, joint, points):
        """Points (n, 3) as a joint carries them from the T-pose to the standing body."""
        for turn in self.chains[joint]:
            centre = point_of(turn["centre"], self.vertices)
            cos, sin = np.cos(np.radians(turn["degrees"])), np.sin(np.radians(turn["degrees"]))
            points = centre + (points - centre) @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]).T
        return points

    def surface(self, definition):
        return self.standing if definition["stance"] == "standing" else self.vertices


def point_of(point, vertices):
    return sum(w * vertices[int(v)] for v, w in point)


def landmarks(definition, body):
    """(points, 3): each a weighted sum of vertices, on skin or carried by a bone."""
    bones = definition.get("bones") or [None] * len(definition["points"])
    return np.array([
        body.carried(bone, point_of(point, body.vertices)[None])[0] if bone else point_of(point, body.surface(definition))
        for point, bone in zip(definition["points"], bones)
    ])


def measured(definition, body):
    points, vertices = landmarks(definition, body), body.surface(definition)
    normal = np.array(definition["normal"] or (0, 0, 0), float)
    if definition["kind"] == "tape":
        return hull_perimeter(points, normal)
    if definition["kind"] == "slice":
        edges = np.array(definition["edges"], np.int64)
        return hull_perimeter(crossings(vertices, edges, points.mean(0), normal)[0], normal)
    if definition["kind"] == "length":
        steps = np.diff(points, axis=0)
        if definition["axis"]:
            axis = np.array(definition["axis"], float)
            return abs(float(steps.sum(0) @ (axis / np.linalg.norm(axis))))
        return float(np.linalg.norm(steps, axis=1).sum())
    if definition["kind"] == "extent":
        return float(np.ptp(points @ np.array(definition["axis"], float)))
    raise ValueError(f"{definition['name']}: unknown kind {definition['kind']}")


def call(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def generate(anthronet, request, file, report, as_file):
    if as_file:
        path = file.with_suffix(".request.json")
        path.write_text(json.dumps(request), encoding="utf-8")
        arguments = ["--request", path]
    else:
        arguments = ["--sex", request["sex"]]
        for name, value in request["measures"].items():
            arguments += ["-m", f"{name}={value}"]
    # Eight influences, so that a file's skin is the whole of it.
    call(anthronet, "generate", *arguments, "--influences", "8", "-o", file, "--report", report)


def enclosed_volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def other_ways(cases, anthronet, request, folder, vertices, lengths):
    """The same body through `measure` and as .obj."""
    file = folder / "other_ways.obj"
    for path in (file, file.with_suffix(".glb")):
        generate(anthronet, request, path, folder / "other_ways.json", as_file=False)
        rows = json.loads(call(anthronet, "measure", path, "--json"))["measures"]
        worst = max(abs(row["value"] - lengths[row["name"]]) for row in rows)
        cases.case(f"`measure` of {path.name} agrees (worst {worst * 1000:.5f} mm)", len(rows) == len(lengths) and worst <= 1e-5,
                   "`measure` and numpy differ")
    lines = [line.split()[1:4] for line in file.read_text(encoding="utf-8").splitlines() if line.startswith("v ")]
    got = np.array(lines, float)
    cases.case(".obj has the body's vertices", len(got) >= BODY_VERTICES, f"{len(got)}, at least {BODY_VERTICES} expected")
    cases.close_to(".obj has the body first, in the same order", got[:BODY_VERTICES], vertices[:BODY_VERTICES], 1e-6)


def joints(cases, listed, glb):
    """The rig that `info` lists against the nodes of a file."""
    nodes, _ = glb.skin(glb.skinned_nodes()[0])
    name = {i: glb.nodes[i]["name"] for i in nodes}
    in_file = {name[i]: name.get(glb.parent.get(i)) for i in nodes}
    in_info = {joint["name"]: joint["parent"] for joint in listed}
    # A parent may be given by name or by its place in the list.
    in_info = {n: listed[p]["name"] if isinstance(p, int) else p for n, p in in_info.items()}
    differ = {n for n in in_file | in_info if in_file.get(n, 0) != in_info.get(n, 0)}
    cases.case(f"the file's {len(in_file)} joints are those of info", not differ, sorted(differ))


def chain(anthronet, info, folder, sex, count):
    """Random people, each asked for by a random part of the measures of the one before: the worst difference from what
    was asked or reported, metres, and how many measures were asked for."""
    definitions = info["measures"]
    dice = random.Random(sex)
    file, report = folder / f"chain_{sex}.glb", folder / f"chain_{sex}.json"
    asked, worst, given = {}, 0.0, 0
    for seed in range(1, count + 1):
        request = {"sex": sex, "measures": asked, "seed": seed, "fill": "sample"}
        generate(anthronet, request, file, report, as_file=True)
        glb = Glb(file)
        body = Body(glb, info)
        lengths = {d["name"]: measured(d, body) for d in definitions}
        rows = json.loads(report.read_text(encoding="utf-8"))["measures"]
        worst = max([worst, *(abs(lengths[name] - value) for name, value in asked.items()),
                     *(abs(lengths[row["name"]] - row["obtained"]) for row in rows)])
        given += len(asked)
        keep = dice.random()
        # To the millimetre, as people type.
        asked = {row["name"]: round(row["obtained"], 3) for row in rows if dice.random() < keep}
    return worst, given


def random_people(cases, anthronet, info, folder):
    name = f"{RANDOM_PEOPLE} random people"
    with ThreadPoolExecutor(2) as pool:
        try:
            of_sex = [pool.submit(chain, anthronet, info, folder, sex, RANDOM_PEOPLE // 2) for sex in ("female", "male")]
            worst, given = (of(values) for of, values in zip((max, sum), zip(*(one.result() for one in of_sex))))
        except (RuntimeError, QhullError, ValueError, KeyError) as error:
            cases.case(name, False, repr(error))
            return
    cases.case(f"{name}, {given} measures as asked and all as reported (worst {worst * 1000:.5f} mm)", worst <= TOLERANCE,
               "measured and asked or reported differ")


def main(anthronet, folder):
    cases, folder = Cases(), Path(folder)
    info = json.loads(call(anthronet, "info", "--json"))
    definitions = info["measures"]
    names = [d["name"] for d in definitions]
    cases.case("info lists 36 measures", len(set(names)) == len(names) == 36, names)
    known = max(int(v) for d in definitions for point in d["points"] for v, _ in point) < BODY_VERTICES
    cases.case("measures speak of the body's vertices", known, f"some id is not below {BODY_VERTICES}")

    paper = json.loads((Path(__file__).parent / "data" / "paper_vectors.json").read_text(encoding="utf-8"))
    for request in paper.values():
        request["measures"] = {name: value for name, value in request["measures"].items() if name not in ELSEWHERE}
    requests = {f"paper {name}": request for name, request in paper.items()} | PARTIAL
    worst_asked = 0.0
    for name, request in requests.items():
        stem = folder / f"measured_{name.replace(' ', '_')}"
        file, report = stem.with_suffix(".glb"), stem.with_suffix(".json")
        try:
            generate(anthronet, request, file, report, as_file=name not in PARTIAL)
        except RuntimeError as error:
            cases.case(f"{name}: generate", False, error)
            continue
        glb = Glb(file)
        body = glb.primitives(glb.skinned_nodes()[0])[0]
        vertices = glb.positions(body)
        if len(vertices) < BODY_VERTICES:
            cases.case(f"{name}: vertices", False, f"{len(vertices)}, at least {BODY_VERTICES} expected")
            continue
        try:
            stands = Body(glb, info)
            lengths = {d["name"]: measured(d, stands) for d in definitions}
        except (QhullError, ValueError, KeyError) as error:
            cases.case(f"{name}: measured", False, repr(error))
            continue

        account = json.loads(report.read_text(encoding="utf-8"))
        rows = account["measures"]
        off = {row["name"]: abs(lengths[row["name"]] - row["obtained"]) for row in rows}
        first = max(off, key=off.get)
        cases.case(f"{name}: all {len(off)} as reported (worst {first} {off[first] * 1000:.4f} mm)",
                   off.keys() == lengths.keys() and off[first] <= TOLERANCE, "reported and measured differ")

        asked = {}
        for measure, value in request["measures"].items():
            both = [measure] if measure in lengths else [f"{measure}_left", f"{measure}_right"]
            asked |= {one: abs(lengths[one] - value) for one in both}
        first = max(asked, key=asked.get)
        worst_asked = max(worst_asked, asked[first])
        cases.case(f"{name}: {len(asked)} given as asked (worst {first} {asked[first] * 1000:.4f} mm)",
                   asked[first] <= TOLERANCE, "asked and measured differ")

        volume = enclosed_volume(vertices, glb.triangles(body))
        cases.case(f"{name}: volume as reported ({volume * 1000:.3f} l)", abs(volume - account["volume_m3"]) <= 1e-6,
                   f"reported {account['volume_m3'] * 1000:.3f} l")

        for d in definitions:
            if d["kind"] == "slice":
                around = whole_slice(stands.surface(d), glb.triangles(body), landmarks(d, stands).mean(0), np.array(d["normal"], float))
                cases.case(f"{name}: {d['name']} is the whole slice ({(around - lengths[d['name']]) * 1000:+.4f} mm)",
                           abs(around - lengths[d["name"]]) <= TOLERANCE, "the slice through all triangles differs")
        if name == "woman":
            joints(cases, info["joints"], glb)
            other_ways(cases, anthronet, request, folder, vertices, lengths)
    random_people(cases, anthronet, info, folder)
    print(f"   worst given measure of {len(requests)} requests: {worst_asked * 1000:.5f} mm")
    cases.exit()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
