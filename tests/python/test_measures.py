"""The Python package's bodies measured again with numpy and scipy, from the definitions of `Model.info()`."""

import anthronet
import numpy as np
import pytest
from measure_glb import TOLERANCE, measured

REQUESTS = {
    "woman": {"sex": "female", "height": 1.70},
    "heavy man": {"sex": "male", "height": 1.78, "waist_circumference": 1.15, "seed": 5},
    "uneven arms": {"sex": "male", "arm_length_left": 0.34, "arm_length_right": 0.33},
    "drawn": {"sex": "female", "seed": 7, "fill": "sample"},
}
AXES = {"gltf": np.eye(3), "blender": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])}


@pytest.mark.parametrize("space", AXES)
@pytest.mark.parametrize("who", REQUESTS)
def test_measures(model, who, space):
    """all measures as reported"""
    definitions = model.info()["measures"]
    body = model.generate(anthronet.Request(**REQUESTS[who]))
    part = body.mesh(space=space, layout="model", body_only=True).parts[0]
    vertices = part.positions.astype(np.float64) @ AXES[space].T
    off = {d["name"]: abs(measured(d, vertices) - body.measures[d["name"]]) for d in definitions}
    worst = max(off, key=off.get)
    assert list(off) == list(anthronet.MEASURES) and off[worst] <= TOLERANCE, f"{worst}: {off[worst] * 1000:.4f} mm"
