"""What the tests of the Python package share besides fixtures: places, matrices, errors that have to come."""

from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
HEADER = ROOT / "ffi" / "include" / "anthronet.h"


def raises(kind, function, *words):
    """Calls a function that has to raise exactly this class, with all these words in its message.

    Unlike `pytest.raises` it keeps no frame alive, and with it no handle whose freeing a test waits for.
    """
    error = raised_by(function)
    assert error is not None, f"nothing was raised, expected {kind.__name__}"
    if type(error) is not kind:
        raise AssertionError(f"{type(error).__name__} instead of {kind.__name__}: {error}") from error
    for word in words:
        assert word in str(error), f"`{error}` lacks `{word}`"
    return error


def raised_by(function):
    """What a function raises; None if nothing."""
    try:
        function()
    except Exception as error:
        return error
    return None


def matrices(transforms):
    """(…, 7) quaternions and translations as (…, 4, 4)."""
    x, y, z, w = np.moveaxis(np.asarray(transforms, float)[..., :4], -1, 0)
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
            2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]
    found = np.zeros((*np.shape(x), 4, 4))
    found[..., :3, :3] = np.stack(rows, -1).reshape(*np.shape(x), 3, 3)
    found[..., :3, 3], found[..., 3, 3] = np.asarray(transforms)[..., 4:], 1
    return found
