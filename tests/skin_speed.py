"""Linear skinning of level 0 with normals, 4 influences, on one thread: ours, numpy, PyTorch as anny does it, a copy.

    python skin_speed.py SKIN_DUMP [ROUNDS]

SKIN_DUMP is the example of that name, built for release. All of them take turns, so that a busy machine slows each of
them alike; the least and the median times are printed, ratios of the least, and each bar with what was measured and
whether it is met. PyTorch and anny's skinning are measured where tests/requirements-bench.txt is installed.
"""

import importlib.util
import os
import platform
import subprocess
import sys
import tempfile
import time

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")
import numpy as np

from skin_reference import Dump


ANNY = "PyTorch, anny's positions"


def processor():
    """What the system calls it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def in_numpy(dump, changes, joints, weights):
    """Gathered and blended in single precision: quicker than einsum over all slots at once."""
    rows, weights = changes[:, :3].astype(np.float32), weights.astype(np.float32)
    positions, directions = dump.positions.astype(np.float32), dump.normals.astype(np.float32)

    def skin():
        blended = rows[joints[:, 0]] * weights[:, 0, None, None]
        for k in range(1, 4):
            blended += rows[joints[:, k]] * weights[:, k, None, None]
        points = (blended[:, :, :3] @ positions[:, :, None])[:, :, 0] + blended[:, :, 3]
        normals = (blended[:, :, :3] @ directions[:, :, None])[:, :, 0]
        return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)

    return skin


def in_torch(dump, changes, joints, weights):
    """anny's own functions: a dense matrix of weights. For normals, its function once more, without translations."""
    import torch

    torch.set_num_threads(1)
    # The package's one file about skinning: all of it asks for much more than that.
    package = importlib.util.find_spec("anny")
    if package is None:
        raise ImportError("anny is not installed")
    path = os.path.join(package.submodule_search_locations[0], "skinning/skinning.py")
    spec = importlib.util.spec_from_file_location("anny_skinning", path)
    anny = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(anny)
    single = lambda array: torch.tensor(array, dtype=torch.float32)
    dense = anny.dense_bone_weights(single(weights), torch.tensor(joints), len(changes))
    transforms, positions, normals = (single(a)[None] for a in (changes, dump.positions, dump.normals))

    def points():
        with torch.no_grad():
            return anny.dense_linear_blend_skinning(positions, dense, transforms)

    def both():
        with torch.no_grad():
            blend = torch.einsum("nj,bjik->bnik", dense, transforms[..., :3, :])
            out = (blend[..., :3] * positions[..., None, :]).sum(-1) + blend[..., 3]
            turned = (blend[..., :3] * normals[..., None, :]).sum(-1)
            return out, torch.nn.functional.normalize(turned, dim=-1)

    return points, both


def main(program, rounds=200):
    with tempfile.TemporaryDirectory() as folder:
        ours = subprocess.Popen([program, folder, "--time"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        ask = lambda: (print(file=ours.stdin, flush=True), [int(n) * 1e-6 for n in ours.stdout.readline().split()])[1]
        ask()
        subprocess.run([program, folder], check=True)
        dump = Dump(folder)
        joints, weights = dump.influences(4)
        _, changes = dump.changes()[0]
        others = {"numpy": in_numpy(dump, changes, joints, weights)}
        expected = dump.got("linear", 4, "pose0", "positions")
        assert np.abs(others["numpy"]()[0] - expected).max() < 1e-5, "numpy computes something else"
        try:
            points, both = in_torch(dump, changes, joints, weights)
            assert np.abs(points()[0].numpy() - expected).max() < 1e-5, "PyTorch computes something else"
            others |= {ANNY: points, "PyTorch, anny's and normals": both}
        except (ImportError, OSError, ValueError) as why:
            print(f"skipped PyTorch: {why!r}")
        times = {name: [] for name in ["ours", "copy", *others]}
        for _ in range(int(rounds)):
            for name, milliseconds in zip(("ours", "copy"), ask()):
                times[name].append(milliseconds)
            for name, skin in others.items():
                start = time.perf_counter()
                skin()
                times[name].append((time.perf_counter() - start) * 1e3)
        ours.stdin.close()
        ours.wait()
    least = {name: min(row) for name, row in times.items()}
    for name, row in times.items():
        print(f"{name:28} least {least[name]:8.3f} ms   median {np.median(row):8.3f} ms   {least[name] / least['ours']:6.2f} of ours")
    print(f"{processor()}, Python {platform.python_version()}, numpy {np.__version__}, one thread")
    bars = [
        ("level 0 with normals, one thread", least["ours"], "ms", 1.5, False),
        ("faster than numpy", least["numpy"] / least["ours"], "times", 5.0, True),
        # Ours writes normals, too.
        ("faster than anny's positions in PyTorch", least.get(ANNY, np.nan) / least["ours"], "times", 3.0, True),
        ("of the bandwidth of a copy", 100 * least["copy"] / least["ours"], "%", 40.0, True),
    ]
    missed = 0
    for name, measured, unit, bar, at_least in bars:
        if np.isnan(measured):
            continue
        met = measured >= bar if at_least else measured <= bar
        missed += not met
        words = "at least" if at_least else "at most"
        print(f"{name}: bar {words} {bar} {unit}, measured {measured:.2f} {unit}, {'met' if met else 'MISSED'}")
    raise SystemExit(1 if missed else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
