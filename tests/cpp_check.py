"""What the C++ example made, by numpy: its printed measures, its skinned frame, its file.

    python cpp_check.py FOLDER PRINTED

The frame was skinned by the library in C++; here it is skinned again in double precision from the .glb alone. Height
is read off the vertices.
"""

import sys
from pathlib import Path

import numpy as np

from glb import Cases, Glb

GIVEN = {"height": 1.72, "waist_circumference": 0.74, "arm_length_left": 0.32, "arm_length_right": 0.32}
FRAME = 10


def main(folder, printed):
    cases, folder = Cases(), Path(folder)
    lines = [line.split() for line in Path(printed).read_text(encoding="utf-8").splitlines()]
    measures = {line[1]: (float(line[2]), line[3]) for line in lines if line[0] == "measure"}
    given = {name: value for name, (value, how) in measures.items() if how == "given"}
    cases.case("C++: 36 measures, of which the four given", len(measures) == 36 and set(given) == set(GIVEN), str(given))
    off = max(abs(given[name] - value) for name, value in GIVEN.items())
    cases.case("C++: given measures are met", off < 1e-4, f"{off * 1000} mm off")

    glb = Glb(folder / "walk.glb")
    node = glb.skinned_nodes()[0]
    (primitive,) = glb.primitives(node)
    bind = glb.positions(primitive)
    ours = np.fromfile(folder / "bind.f32", "<f4").reshape(-1, 3)
    cases.case("C++: positions in the slice are those of the file", np.array_equal(ours, bind.astype(np.float32)))
    triangles = np.fromfile(folder / "triangles.u32", "<u4").reshape(-1, 3)
    cases.case("C++: triangles too", np.array_equal(triangles, glb.triangles(primitive)))
    height = float(np.ptp(bind[:, 1]))
    # Height is measured at a landmark of the crown, which need not be the highest vertex.
    cases.case("C++: as tall as asked", abs(height - GIVEN["height"]) < 2e-3, f"{height} m")

    clips = [line[1:] for line in lines if line[0] == "clip"]
    names = [animation["name"] for animation in glb.json["animations"]]
    cases.case("C++: both clips are in the file", names == [name for name, _ in clips] == ["walk", "swing"], str(names))
    moved = []
    for animation, (_, frames) in zip(glb.json["animations"], clips):
        ours = animation["extras"]["anthronet"]
        cases.case(f"C++: frames of {animation['name']}", ours["frames"] == int(frames), str(ours["frames"]))
        time = FRAME / ours["frames_per_second"]
        moved.append(glb.skinned(node, glb.world(animated=glb.animated(animation, time))))
    skinned = np.fromfile(folder / "frame.f32", "<f4").reshape(-1, 3)
    cases.close_to("C++: the skinned frame is that of the file", skinned, moved[0], 1e-5)
    arms = float(np.abs(moved[1] - bind).max())
    cases.case(f"C++: the motion file's arms hang ({arms:.2f} m from the T-pose)", arms > 0.3, f"{arms} m")
    cases.exit()


main(*sys.argv[1:])
