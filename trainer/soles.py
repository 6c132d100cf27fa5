"""Fits `core/src/retarget/feet/soles.json`: where the skin of a sole is, given the skeleton.

    python trainer/soles.py target/release/anthronet > soles.json

makes random bodies of both sexes with the command and regresses the vertices under heel and ball, and those around them, on
distances between joints. To be run again when the model is retrained. Needs numpy and scipy.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from glb import Glb  # noqa: E402

BODIES = {"female": 60, "male": 45}
# As in `core/src/retarget/feet/shape.rs`, metres.
REACH, HIGHEST = 0.03, 0.01
# Vertices count that are under heel or ball in more than this share of the bodies.
OFTEN = 0.1
FLOOR = [1, 0, 1]
# Price of a slope against what it explains: distances go together, and bodies of other proportions are not to be extrapolated.
RIDGE = 0.02


def read(path):
    """Positions of LOD 1, joints and weights of its vertices, `model_from_joint` and bone lengths by name."""
    glb = Glb(path)
    node = glb.skinned_nodes()[0]
    joints, inverse = glb.skin(node)
    names = [glb.nodes[joint]["name"] for joint in joints]
    (primitive,) = glb.primitives(node)
    slots, weights = glb.influences(primitive)
    bind = {name: np.linalg.inv(matrix) for name, matrix in zip(names, inverse)}
    of_joint = {name: np.where(slots == names.index(name), weights, 0).sum(1) for name in feet()}
    lengths = {n: glb.nodes[j].get("extras", {}).get("anthronet", {}).get("bone_length") for n, j in zip(names, joints)}
    return glb.positions(primitive), of_joint, bind, lengths


def feet():
    return [f"{name}_{side}" for name in ("foot", "ball") for side in "lr"]


def foot(body, side, chosen):
    """Vertices ahead of the ankle, up and outwards, and the distances, all in parts of the distance from ankle to ball."""
    positions, _, bind, lengths = body
    at = {name: matrix[:3, 3] for name, matrix in bind.items()}
    ankle, ball = at[f"foot_{side}"], at[f"ball_{side}"]
    forward = (ball - ankle) * FLOOR
    length = np.linalg.norm(forward)
    ahead = forward / length
    axes = np.array([ahead, [0, 1, 0], np.cross([0, 1, 0], ahead) * np.sign(ankle[0])])
    tip = axes @ (ball + bind[f"ball_{side}"][:3, 1] * lengths[f"ball_{side}"] - ankle * FLOOR)
    above = [at[name][2] - ankle[2] for name in (f"calf_{side}", f"thigh_{side}", f"upperarm_{side}", "head")]
    distances = np.array([ankle[1], ball[1], tip[0] - length, tip[1], tip[2], *above])
    return (positions[chosen] - ankle * FLOOR) @ axes.T / length, distances / length, length


def under(vertices, length):
    """Which vertices are under the heel and under the ball."""
    along = vertices[:, 0]
    back = along[vertices[:, 1] * length < 2 * HIGHEST].min()
    for centre in (back + REACH / length, 1.0):
        near = np.hypot(along - centre, vertices[:, 2]) * length < REACH
        yield near & (vertices[:, 1] < vertices[near, 1].min() + HIGHEST / length)


def rim(mean, ball_weight, length):
    """The outline of the sole, of vertices that the toes do not move alone, thinned out."""
    low = np.flatnonzero((mean[:, 1] * length < 0.012) & (ball_weight < 0.9))
    kept = []
    for vertex in low[ConvexHull(mean[low][:, [0, 2]]).vertices]:
        if all(np.hypot(*(mean[vertex] - mean[other])[[0, 2]]) > 0.06 for other in kept):
            kept.append(vertex)
    return np.array(kept)


def bodies(anthronet):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "body.glb"
        for sex, count in BODIES.items():
            for seed in range(1, count + 1):
                request = ["--sex", sex, "--fill", "sample", "--population", "synthetic", "--seed", str(seed), "--lod", "1"]
                subprocess.run([anthronet, "generate", *request, "-o", str(path)], check=True, capture_output=True)
                yield read(path)


def main(anthronet):
    chosen, rows = None, []
    for body in bodies(anthronet):
        if chosen is None:
            positions, weights, *_ = body
            chosen = {}
            for side in "lr":
                of_foot = np.flatnonzero(weights[f"foot_{side}"] + weights[f"ball_{side}"] > 0.05)
                _, first = np.unique(positions[of_foot], axis=0, return_index=True)
                chosen[side] = of_foot[np.sort(first)]
            left = chosen["l"]
            mirrored = cKDTree(positions[chosen["r"]]).query(positions[left] * [-1, 1, 1])[1]
            chosen["r"] = chosen["r"][mirrored]
            ball_weight = weights["ball_l"][left] / (weights["foot_l"] + weights["ball_l"])[left]
        rows += [foot(body, side, chosen[side]) for side in "lr"]
    vertices, distances, lengths = (np.array(column) for column in zip(*rows))
    mean, spread = distances.mean(0), distances.std(0)
    often = np.mean([list(under(v, length)) for v, length in zip(vertices, lengths)], 0) > OFTEN
    outline = rim(vertices.mean(0), ball_weight, lengths.mean())
    print('{\n  "mean": %s,\n  "spread": %s,' % tuple(json.dumps(v.round(4).tolist()) for v in (mean, spread)))
    parts = {"heel": np.flatnonzero(often[0]), "ball": np.flatnonzero(often[1]), "rim": outline}
    for name, part in parts.items():
        middle = vertices[:, part].mean(0)
        offsets = (vertices[:, part] - middle).reshape(len(vertices), -1)
        apart = distances - mean
        ridge = RIDGE * len(apart) * np.diag(spread**2)
        slopes = np.linalg.solve(apart.T @ apart + ridge, apart.T @ offsets).reshape(len(mean), -1, 3)
        lines = [
            json.dumps([round(ball_weight[v], 3), *middle[i].round(4).tolist(), *slopes[:, i].ravel().round(3).tolist()])
            for i, v in enumerate(part)
        ]
        print('  "%s": [\n    %s\n  ]%s' % (name, ",\n    ".join(lines), "" if name == "rim" else ","))
    print("}")


if __name__ == "__main__":
    main(*sys.argv[1:])
