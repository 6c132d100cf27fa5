"""The Python package's bodies measured again with numpy and scipy, from the definitions of `Model.info()`.

    python python_measures.py
"""

import numpy as np

import anthronet
from glb import Cases
from measure_glb import TOLERANCE, measured

REQUESTS = {
    "woman": anthronet.Request("female", height=1.70),
    "heavy man": anthronet.Request("male", height=1.78, waist_circumference=1.15, seed=5),
    "uneven arms": anthronet.Request("male", arm_length_left=0.34, arm_length_right=0.33),
    "drawn": anthronet.Request("female", seed=7, fill="sample"),
}


def main():
    cases, model = Cases(), anthronet.default_model()
    definitions = model.info()["measures"]
    for name, request in REQUESTS.items():
        body = model.generate(request)
        for space, axes in {"gltf": np.eye(3), "blender": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])}.items():
            part = body.mesh(space=space, layout="model", body_only=True).parts[0]
            vertices = part.positions.astype(np.float64) @ axes.T
            off = {d["name"]: abs(measured(d, vertices) - body.measures[d["name"]]) for d in definitions}
            worst = max(off, key=off.get)
            cases.case(f"{name}, {space}: all {len(off)} as reported (worst {worst} {off[worst] * 1000:.4f} mm)",
                       len(off) == 36 and off[worst] <= TOLERANCE, "reported and measured differ")
    cases.exit()


if __name__ == "__main__":
    main()
