"""The animations of a .glb in double precision, from the file alone.

    python animation_reference.py FILE.glb

Checks the tracks and writes what viewers have to agree with: FILE.animated.json, a list of clips with the frames that
were taken and their times; FILE.animated.f64, the positions of all skinned vertices, clip after clip, frame after
frame, node after node, little endian; FILE.expected.json, numbers of joints, meshes and tracks, and per clip where
joints are at a time.
"""

import json
import sys

import numpy as np

from glb import Cases, Glb


def check_tracks(cases, glb, animation):
    name, ours = animation["name"], animation["extras"]["anthronet"]
    rate, frames = ours["frames_per_second"], ours["frames"]
    expected = (np.arange(frames) / rate).astype(np.float32)
    lengths, off, flips, inputs = set(), 0.0, 0, set()
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        times, values = glb.accessor(sampler["input"]), glb.accessor(sampler["output"]).astype(np.float64)
        inputs.add(sampler["input"])
        lengths.add(len(times))
        off = max(off, float(np.abs(times - expected[: len(times)]).max()))
        if channel["target"]["path"] == "rotation":
            off = max(off, float(np.abs(np.linalg.norm(values, axis=1) - 1).max()) - 1e-6)
            flips += int((np.einsum("ki,ki->k", values[1:], values[:-1]) < 0).sum())
    cases.case(f"{name}: keys on frames, quaternions of unit length", off <= 0, f"off by {off}")
    cases.case(f"{name}: quaternions keep their sign", flips == 0, f"{flips} flips")
    whole = lengths <= {1, frames} and frames in lengths
    cases.case(f"{name}: one key or all", whole, f"{lengths} keys, {frames} frames")
    cases.case(f"{name}: one accessor of times for each", len(inputs) == len(lengths), f"{len(inputs)} accessors")
    return rate, frames


def main(path):
    cases, glb = Cases(), Glb(path)
    nodes = glb.skinned_nodes()
    animations = glb.json.get("animations", [])
    cases.case("has animations", bool(animations))
    clips, positions = [], []
    for animation in animations:
        rate, frames = check_tracks(cases, glb, animation)
        taken = sorted({int(f) for f in np.linspace(0, frames - 1, 5)})
        clips.append({"name": animation["name"], "rate": rate, "frames": frames, "taken": taken,
                      "times": [f / rate for f in taken]})
        for frame in taken:
            world = glb.world(animated=glb.animated(animation, frame / rate))
            positions.append(np.vstack([glb.skinned(node, world) for node in nodes]))
        moved = float(np.abs(positions[-1] - positions[-len(taken)]).max())
        far = float(np.abs(positions[-2] - positions[-len(taken)]).max()) if len(taken) > 1 else 0.0
        far = max(moved, far)
        cases.case(f"{animation['name']}: the body moves ({far:.3f} m)", far > 1e-3, "stands still")
    with open(f"{path}.animated.json", "w", encoding="utf-8") as file:
        json.dump(clips, file)
    joints, _ = glb.skin(nodes[0])
    expected = []
    for animation, clip in zip(animations, clips):
        # A frame in the middle, where nothing is as at rest.
        time = clip["times"][len(clip["times"]) // 2]
        world = glb.world(animated=glb.animated(animation, time))
        expected.append({"name": clip["name"], "length": (clip["frames"] - 1) / clip["rate"], "time": time,
                         "tracks": len({channel["target"]["node"] for channel in animation["channels"]}),
                         "places": {glb.nodes[j]["name"]: world[j, :3, 3].tolist() for j in joints}})
    with open(f"{path}.expected.json", "w", encoding="utf-8") as file:
        json.dump({"joints": len(joints), "meshes": len(nodes), "clips": expected}, file)
    np.vstack(positions).astype("<f8").tofile(f"{path}.animated.f64")
    cases.exit()


main(sys.argv[1])
