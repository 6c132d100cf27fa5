"""Skinning: methods, buffers, many characters."""

import gc
import threading
import weakref

import anthronet
import numpy as np
import pytest
from support import matrices, raised_by, raises


@pytest.fixture(scope="module")
def mesh(woman):
    return woman.mesh(lod=1)


@pytest.fixture(scope="module")
def skinner(mesh):
    return mesh.skinner()


@pytest.fixture(scope="module")
def walk(woman):
    return anthronet.builtin_clip("walk", woman)


@pytest.fixture(scope="module")
def pose(walk):
    return walk.sample(0.3, relative="model")


def test_methods(mesh, skinner, pose):
    """methods differ, and offsets move the surface"""
    assert skinner.vertex_count == mesh[0].vertex_count
    linear, dual, moved = (skinner.skin(pose, method=m)[0] for m in ("linear", "dual_quaternion", "joint_translation"))
    assert not np.allclose(linear, dual) and not np.allclose(linear, moved)
    offsets = np.full((skinner.vertex_count, 3), 0.01, np.float32)
    assert 0.001 < np.abs(skinner.skin(pose, offsets=offsets)[0] - linear).max() < 0.02


def test_linear_by_numpy(woman, mesh, skinner, pose):
    """linear blend skinning is what numpy makes of the definition"""
    weights, joints = mesh[0].weights, mesh[0].joints
    moved = matrices(pose) @ woman.joints()["joint_from_model"]
    blended = np.einsum("vi,vijk->vjk", weights.astype(float), moved[joints])
    expected = np.einsum("vjk,vk->vj", blended[:, :3], np.c_[mesh[0].positions, np.ones(len(weights))])
    off = np.abs(expected - skinner.skin(pose, method="linear")[0]).max()
    assert off < 1e-5, off


def test_buffers(skinner, pose):
    """positions and normals into interleaved buffers, and nothing beside them"""
    vertices = np.zeros(skinner.vertex_count, [("position", "f4", 3), ("normal", "f4", 3), ("uv", "f4", 2)])
    positions, normals = skinner.skin(pose, vertices["position"], vertices["normal"])
    alone = skinner.skin(pose)
    assert np.array_equal(vertices["position"], alone[0]) and np.array_equal(vertices["normal"], alone[1])
    assert (vertices["uv"] == 0).all() and np.shares_memory(positions, vertices) and np.shares_memory(normals, vertices)
    assert skinner.skin(pose, normals=False)[1] is None


def test_many(skinner, walk):
    """many characters in a call"""
    poses = [walk.sample(i / 7, relative="model") for i in range(6)]
    crowd = anthronet.skin([anthronet.SkinJob(skinner, p) for p in poses])
    assert len(crowd) == 6 and all(np.array_equal(many[0], skinner.skin(p)[0]) for many, p in zip(crowd, poses))
    assert anthronet.skin([]) == []


def test_contexts(skinner, walk, pose):
    """each thread samples and skins in memory of its own, which goes with it"""
    expected, right, freed = skinner.skin(pose)[0], [], []

    def work():
        skinned = [skinner.skin(walk.sample(0.3, relative="model"))[0] for _ in range(3)]
        right.append(all(np.array_equal(one, expected) for one in skinned))
        weakref.finalize(anthronet._library.context(), freed.append, True)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    gc.collect()
    assert right == freed == [True] * 4


def test_refusals(mesh, skinner, pose):
    """buffers that do not fit or overlap are refused, and nothing is written"""
    count, job = skinner.vertex_count, anthronet.SkinJob
    shared = np.zeros((count, 3), np.float32)
    raises(anthronet.ArgumentError, lambda: anthronet.skin([job(skinner, pose, shared), job(skinner, pose, shared[::-1][::-1])]), "overlap")
    raises(anthronet.ArgumentError, lambda: skinner.skin(pose, shared, offsets=shared), "overlap", "offsets")
    raises(ValueError, lambda: skinner.skin(pose, shared[:-1]), "positions", "shape")
    raises(TypeError, lambda: skinner.skin(pose, shared.astype(np.float64)), "positions", "float32")
    raises(TypeError, lambda: skinner.skin(pose, shared.tolist()), "positions", "ndarray")
    raises(ValueError, lambda: skinner.skin(pose, mesh[0].positions), "positions", "read-only")
    raises(ValueError, lambda: skinner.skin(pose, shared[::-1]), "positions", "strides")
    raises(ValueError, lambda: skinner.skin(pose, np.zeros((3, count), np.float32).T), "positions", "strides")
    raises(ValueError, lambda: skinner.skin(pose, np.broadcast_to(shared[:1], shared.shape)), "positions")
    raises(ValueError, lambda: skinner.skin(pose, method="magic"), "method", "magic")
    raises(ValueError, lambda: skinner.skin(pose, offsets=shared[1:]), "offsets")
    raises(ValueError, lambda: skinner.skin(pose[:, :6]), "joints", "(n, 7)")
    raises(anthronet.ArgumentError, lambda: skinner.skin(pose[1:]), "joint")
    before = shared.copy()
    assert isinstance(raised_by(lambda: skinner.skin(pose * np.nan, shared)), anthronet.Error)
    assert isinstance(raised_by(lambda: anthronet.skin([job(skinner, pose, shared), job(skinner, pose[1:])])), anthronet.Error)
    assert np.array_equal(shared, before), "nothing is written unless all is in order"
    raises(anthronet.ArgumentError, lambda: mesh.skinner(7), "part")
    raises(TypeError, lambda: anthronet.skin([3]), "jobs")
    raises(TypeError, lambda: anthronet.skin([job("x", pose)]), "skinner")
