"""How fast the Python package is: numbers beside their bars. Times are told and never fail: machines are shared."""

import time

import anthronet
import numpy as np
import pytest
from anthronet import _library

CALL_BAR = 1.0  # Microseconds.
COPY_BAR = 0.6  # Of numpy's speed.


def best(function, repeats=7, number=1):
    """Seconds of one call, the best of some rounds."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        for _ in range(number):
            function()
        times.append((time.perf_counter() - start) / number)
    return min(times)


def met(good):
    return "" if good else ", OVER THE BAR"


@pytest.fixture
def tell(capsys):
    """Prints, though pytest keeps what tests print to itself."""

    def printed(line):
        with capsys.disabled():
            print(line)

    return printed


def test_speed(model, woman, tell):
    """speed is measured"""
    mesh, walk = woman.mesh(), anthronet.builtin_clip("walk", woman)
    empty = best(lambda: None, number=100_000)
    call = best(anthronet.abi_version, number=100_000) * 1e6
    tell(f"a call of a trivial function     {call:8.2f} µs   bar {CALL_BAR:g} µs{met(call <= CALL_BAR)}")
    plain = _library.lib.anthronet_abi_version
    tell(f"  the entry alone                {best(plain, number=100_000) * 1e6:8.2f} µs")
    count = lambda: model.vertex_count(0)  # noqa: E731
    tell(f"model.vertex_count(0)            {(best(count, number=50_000) - empty) * 1e6:8.2f} µs   two results checked")

    part = mesh[0]
    view, out = part.positions, np.empty(part.positions.shape, np.float32)
    # In turns, so that both meet the same machine.
    rounds = [(best(lambda: np.copyto(out, view), 3, 40), best(lambda: part.read("positions", out), 3, 40)) for _ in range(9)]
    copied, read = (min(times) for times in zip(*rounds))
    size = view.nbytes
    tell(f"numpy copies level 0 positions   {copied * 1e6:8.1f} µs   {size / copied / 1e9:.1f} GB/s, {size / 1e6:.2f} MB")
    share = copied / read
    tell(f"part.read of level 0 positions   {read * 1e6:8.1f} µs   {share:.0%} of numpy's speed, bar {COPY_BAR:.0%}{met(share >= COPY_BAR)}")
    stable = np.zeros(len(view), [("position", "f4", 3), ("normal", "f4", 3)])
    rows = best(lambda: part.read("positions", stable["position"]), number=20)
    tell(f"part.read into interleaved rows  {rows * 1e6:8.1f} µs")
    tell(f"part.positions (a view)          {best(lambda: part.positions, number=5000) * 1e6:8.2f} µs")

    request = anthronet.Request("female", height=1.70)
    tell(f"generate                         {best(lambda: model.generate(request)) * 1e3:8.2f} ms")
    tell(f"generate and mesh, level 1       {best(lambda: model.generate(request).mesh(lod=1)) * 1e3:8.2f} ms")
    tell(f"mesh, level 1                    {best(lambda: woman.mesh(lod=1)) * 1e3:8.2f} ms")
    tell(f"mesh, level 0                    {best(lambda: woman.mesh()) * 1e3:8.2f} ms")
    pose = np.empty((walk.joint_count, 7), np.float32)
    tell(f"clip.sample                      {best(lambda: walk.sample(0.3, relative='model', out=pose), number=2000) * 1e6:8.2f} µs")
    skinner, normals = woman.mesh(lod=1).skinner(), None
    positions, normals = skinner.skin(pose)
    tell(f"skinner.skin, level 1            {best(lambda: skinner.skin(pose, positions, normals), number=50) * 1e6:8.1f} µs")
