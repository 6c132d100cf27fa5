"""Linear blend skinning of a .glb in double precision, from the file alone.

    python pose_reference.py FILE.glb

Checks what skinning rests on (weights, bind matrices, sides) and writes what three.js and Blender have to agree with:
FILE.posed.json (the pose) and FILE.posed.f64 (positions of all skinned vertices, node after node, little endian).
"""

import json
import sys

import numpy as np

from glb import Cases, Glb, rotation

# Lopsided on purpose: a mirrored, transposed or mixed-up rotation lands somewhere else. Axis and degrees.
POSE = {"lowerarm_l": ((0.3, 0.5, 0.8), 70), "thigh_r": ((0.9, 0.1, 0.2), -35), "neck_01": ((0.2, 0.9, 0.1), 25)}


def quaternion(axis, degrees):
    axis = np.array(axis) / np.linalg.norm(axis)
    half = np.radians(degrees) / 2
    return [*(axis * np.sin(half)), np.cos(half)]


def main(path):
    cases, glb = Cases(), Glb(path)
    nodes = glb.skinned_nodes()
    cases.case("a skinned mesh", bool(nodes), "no node has a mesh and a skin")
    body = nodes[0]
    joints, joint_from_bind = glb.skin(body)
    names = [glb.nodes[j]["name"] for j in joints]
    bind = glb.world()

    cases.case("one skin for all meshes", len(glb.json["skins"]) == 1, f"{len(glb.json['skins'])} skins")
    cases.case("joint names are unique", len(set(names)) == len(names), names)
    place = {j: i for i, j in enumerate(joints)}
    late = [names[i] for i, j in enumerate(joints) if place.get(glb.parent.get(j), -1) > i]
    cases.case("joints stand after their parents", not late, late)
    cases.close_to("inverse bind matrices undo the rest pose", bind[joints] @ joint_from_bind,
                   np.broadcast_to(np.eye(4), (len(joints), 4, 4)), 1e-5)
    at = np.linalg.inv(joint_from_bind)[:, :3, 3]
    wrong = [n for n, p in zip(names, at) if (n.endswith("_l") and p[0] <= 0) or (n.endswith("_r") and p[0] >= 0)]
    cases.case("the character's left is at +X", not wrong, wrong)

    for node in nodes:
        for primitive in glb.primitives(node):
            slots, weights = glb.influences(primitive)
            name = glb.nodes[node].get("name", node)
            worst = float(np.abs(weights.sum(1) - 1).max())
            cases.case(f"weights of {name} sum to 1", worst <= 2e-6, f"off by {worst}")
            cases.case(f"weights of {name} fall", bool((np.diff(weights, axis=1) <= 0).all()), "not sorted")
            cases.case(f"unused slots of {name} are 0", not slots[weights == 0].any(), "joint index without weight")

    missing = [name for name in POSE if name not in names]
    cases.case("joints of the test pose exist", not missing, f"{missing} not among {names}")
    pose = {name: quaternion(*turn) for name, turn in POSE.items() if name in names}

    rest = glb.skinned(body, bind)
    cases.close_to("the rest pose is the bind pose", rest, np.vstack([glb.positions(p) for p in glb.primitives(body)]), 1e-5)
    if "lowerarm_l" in pose:
        moved = np.linalg.norm(glb.skinned(body, glb.world({"lowerarm_l": pose["lowerarm_l"]})) - rest, axis=1) > 1e-3
        cases.case("the left forearm moves left vertices alone", moved.any() and (rest[moved, 0] > 0).all(),
                   f"{int(moved.sum())} moved, smallest x {rest[moved, 0].min() if moved.any() else None}")

    # The pose once more as a change in model space, for a program whose bones have axes of their own.
    posed = glb.world(pose)
    change = posed[joints] @ np.linalg.inv(bind[joints])
    with open(f"{path}.posed.json", "w", encoding="utf-8") as file:
        json.dump({"rotations": pose, "change": dict(zip(names, change.tolist()))}, file)
    np.vstack([glb.skinned(node, posed) for node in nodes]).astype("<f8").tofile(f"{path}.posed.f64")
    cases.exit()


assert np.allclose(rotation(quaternion((0, 0, 1), 90)) @ (1, 0, 0), (0, 1, 0))
main(sys.argv[1])
