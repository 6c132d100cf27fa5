"""Clips and motions of others."""

import math

import anthronet
import numpy as np
import pytest
from support import raised_by, raises


def bvh():
    """A walker of ten joints, centimetres, three frames."""
    children = {"Hips": ["LeftUpLeg", "RightUpLeg", "Spine"], "LeftUpLeg": ["LeftLeg"], "LeftLeg": ["LeftFoot"],
                "RightUpLeg": ["RightLeg"], "RightLeg": ["RightFoot"], "Spine": ["Head"]}
    offsets = {"Hips": "0 95 0", "LeftUpLeg": "9 -4 0", "RightUpLeg": "-9 -4 0", "Spine": "0 10 0", "Head": "0 50 0"}
    ends = {"LeftFoot": "0 -7 14", "RightFoot": "0 -7 14", "Head": "0 15 0"}

    def joint(name, kind):
        channels = "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation" if kind == "ROOT" else \
            "3 Zrotation Xrotation Yrotation"
        yield from (f"{kind} {name}", "{", f"OFFSET {offsets.get(name, '0 -42 0')}", f"CHANNELS {channels}")
        for child in children.get(name, []):
            yield from joint(child, "JOINT")
        if name in ends:
            yield from ("End Site", "{", f"OFFSET {ends[name]}", "}")
        yield "}"

    frames = [" ".join(map(str, [0, 95, z, 0, 0, 0, 0, x, 0] + [0] * 21)) for z, x in ((0, -20), (3, 0), (6, 20))]
    return "\n".join(["HIERARCHY", *joint("Hips", "ROOT"), "MOTION", "Frames: 3", "Frame Time: 0.0333333", *frames, ""])


@pytest.fixture(scope="module")
def walk(woman):
    return anthronet.builtin_clip("walk", woman)


@pytest.fixture(scope="module")
def idle(woman):
    return anthronet.builtin_clip("idle", woman)


def test_builtin(woman, walk):
    """built-in clips: names and numbers"""
    assert anthronet.BUILTIN_CLIPS[:2] == ("idle", "walk")
    assert walk.name == "walk" and walk.joint_count == woman.joint_count and walk.report is None
    assert abs(walk.duration - (walk.frame_count - 1) / walk.frames_per_second) < 1e-6


@pytest.mark.parametrize("relative", ["parent", "model"])
@pytest.mark.parametrize("space", ["gltf", "blender", "unity"])
def test_baking(walk, relative, space):
    """baked frames are samples"""
    baked = walk.bake(relative, space)
    assert baked.shape == (walk.frame_count, walk.joint_count, 7) and baked.dtype == np.float32
    for frame in (0, 7):
        pose = walk.sample(frame / walk.frames_per_second, relative=relative, space=space)
        assert np.allclose(pose, baked[frame], atol=1e-5)


def test_sampling(walk):
    """sampling into a buffer, and beyond the end"""
    out = np.zeros((walk.joint_count, 7), np.float32)
    assert walk.sample(0.5, out=out) is out and np.array_equal(out, walk.sample(0.5))
    late = walk.duration * 2.5
    once, loop, travel = (walk.sample(late, wrap, "model") for wrap in ("once", "loop", "root_motion"))
    assert np.allclose(once, walk.bake("model")[-1], atol=1e-5) and not np.allclose(once, loop)
    assert travel[:, 6].mean() > loop[:, 6].mean() + 0.5, "two rounds further on"


def test_sampling_refusals(walk):
    """sampling refuses buffers that do not fit and words that it does not know"""
    for wrong in (np.zeros((walk.joint_count, 7)), np.zeros((3, 7), np.float32), np.zeros((7, walk.joint_count), np.float32).T,
                  [0.0]):
        assert isinstance(raised_by(lambda: walk.sample(0, out=wrong)), (TypeError, ValueError))
    frozen = np.zeros((walk.joint_count, 7), np.float32)
    frozen.flags.writeable = False
    raises(ValueError, lambda: walk.sample(0, out=frozen), "out")
    raises(anthronet.RequestError, lambda: walk.sample(math.nan), "seconds")
    raises(ValueError, lambda: walk.sample(0, "often"), "wrap", "often")
    raises(TypeError, lambda: walk.sample("0"), "seconds")
    raises(ValueError, lambda: walk.bake("joint"), "relative", "joint")


def test_editing(woman, walk, idle):
    """clips from poses, resampled, in place, faded, blended, looped"""
    frames = walk.bake(space="unity")
    again = anthronet.Clip.from_poses(woman, "nöw", 30, frames, space="unity")
    assert again.name == "nöw" and np.allclose(again.bake(space="unity"), frames, atol=1e-6)
    slow = walk.resample(15)
    assert slow.frames_per_second == 15 and abs(slow.duration - walk.duration) < 0.1
    assert np.abs(walk.in_place().bake("model")[:, 1, 6]).max() < np.abs(walk.bake("model")[:, 1, 6]).max()
    joined, mixed = walk.crossfade(idle, 0.3), walk.blend(idle, 0.5)
    assert joined.duration > walk.duration and mixed.frame_count > 0
    pose = idle.looped(0.2).bake()
    assert np.allclose(pose[0, :, 5], pose[-1, :, 5], atol=1e-6), "heights meet"
    assert np.abs((pose[0, :, :4] * pose[-1, :, :4]).sum(1)).min() > 1 - 1e-6, "and rotations do"


def test_editing_refusals(woman, walk, idle):
    """clips refuse numbers and arrays that make none"""
    frames = walk.bake(space="unity")
    for bad in (lambda: walk.resample(0), lambda: walk.looped(math.nan), lambda: walk.looped(-1), lambda: walk.blend(idle, math.inf),
                lambda: walk.crossfade(idle, 1e9), lambda: anthronet.builtin_clip("nonsense", woman),
                lambda: anthronet.Clip.from_poses(woman, "x", 0, frames), lambda: anthronet.Clip.from_poses(woman, "x", 30, frames * 0)):
        assert isinstance(raised_by(bad), anthronet.Error), bad
    raises(ValueError, lambda: anthronet.Clip.from_poses(woman, "x", 30, frames[:, :-1]), "frames", "shape")
    raises(TypeError, lambda: walk.blend(3, 0.5), "other", "int")
    raises(TypeError, lambda: anthronet.builtin_clip("walk", None), "body", "NoneType")


def test_masks_and_layers(woman, walk, idle):
    """masks of joints, and additive layers"""
    mask = walk.joint_mask("spine_01", "thigh_l")
    assert mask.shape == (walk.joint_count,) and set(mask) == {0, 1} and walk.joint_mask().max() == 0
    names = list(woman.joint_names())
    assert mask[names.index("head")] == mask[names.index("foot_l")] == 1 and mask[names.index("foot_r")] == 0
    half, layered = walk.blend(idle, 1, mask).bake(), idle.additive(walk, mask=mask).bake()
    assert np.allclose(half[3, mask == 0], walk.bake()[3, mask == 0], atol=1e-6)
    assert np.allclose(half[3, mask == 1], idle.bake()[3, mask == 1], atol=1e-6)
    assert np.allclose(layered[:, mask == 0], idle.bake()[:, mask == 0], atol=1e-6)
    assert np.abs(layered[:, mask == 1] - idle.bake()[:, mask == 1]).max() > 0.01
    for space in ("gltf", "unity"):
        same = idle.additive(walk, 1, walk.sample(0.3, space=space), space=space)
        assert np.allclose(same.sample(0.3), idle.sample(0.3), atol=1e-5), "what differs from itself by nothing"
    raises(ValueError, lambda: walk.blend(idle, 0.5, mask[1:]), "mask", "shape")
    raises(anthronet.InvalidError, lambda: walk.blend(idle, 0.5, mask * 2), "joint mask", "0 to 1")
    raises(anthronet.InvalidError, lambda: walk.joint_mask("tail"), "tail")
    raises(TypeError, lambda: walk.joint_mask(3), "joints", "int")
    raises(TypeError, lambda: walk.additive(3), "layer", "int")
    raises(ValueError, lambda: walk.additive(idle, reference=walk.bake()), "reference", "shape")


@pytest.fixture
def file(tmp_path):
    file = tmp_path / "steps.bvh"
    file.write_text(bvh(), encoding="utf-8")
    return file


@pytest.fixture
def motion(file):
    return anthronet.open_motion(file)


def test_motion(woman, motion):
    """a motion from a file or memory, retargeted"""
    assert motion.clip_names == ("steps",) and motion.report["format"] == "BVH", (motion.clip_names, motion.report)
    assert anthronet.Motion.from_bytes(bvh().encode(), "steps.bvh").report == motion.report
    clip = motion.retarget(woman)
    assert clip.frame_count == 3 and clip.joint_count == woman.joint_count and clip.report["joints"]
    left_alone = motion.retarget(woman, mapping={"Head": None, "Spine": "spine_03"}).report["joints"]
    assert left_alone != clip.report["joints"]


def test_motion_numbers(woman, file, motion):
    """frames per second, units and axes that are asked for"""
    assert motion.retarget(woman, frames_per_second=60).frames_per_second == 60
    assert anthronet.open_motion(file, frames_per_second=10).retarget(woman).frames_per_second == 10
    scaled = anthronet.open_motion(file, metres_per_unit=0.02, up="y").report
    assert scaled["unit_found"] == "asked" == scaled["up_found"]


@pytest.mark.parametrize("option", [{"in_place": True}, {"looped": True}, {"root_motion": True}, {"limits": False}, {"feet": False},
                                    {"fingers": "relaxed"}, {"fingers": "rest"}],
                         ids=lambda option: "{}={}".format(*next(iter(option.items()))))
def test_retarget_options(woman, motion, option):
    """an option of retargeting"""
    assert motion.retarget(woman, **option).frame_count > 0


def test_motion_people(woman, tmp_path):
    """one of two people in an archive of arrays"""
    file, poses = tmp_path / "two.npz", np.zeros((2, 5, 66), np.float32)
    poses[..., 0] = math.pi / 2
    poses[1, :, 3 * 16 + 1] = 0.5
    np.savez(file, poses=poses, trans=np.zeros((2, 5, 3), np.float32), fps=30.0)
    first, second = (anthronet.open_motion(file, person=person) for person in (0, 1))
    assert "2 people" in " ".join(anthronet.open_motion(file).report["warnings"])
    assert not any("people" in warning for warning in first.report["warnings"] + second.report["warnings"])
    assert not np.allclose(first.retarget(woman).bake(), second.retarget(woman).bake())
    assert anthronet.Motion.from_bytes(file.read_bytes(), "two.npz", person=1).report == second.report
    raises(anthronet.FileError, lambda: anthronet.open_motion(file, person=2), "person", "2")
    for wrong in (-1, 2**32 - 1):
        raises(ValueError, lambda: anthronet.open_motion(file, person=wrong), "person")
    raises(TypeError, lambda: anthronet.open_motion(file, person=0.5), "person")


def test_motion_doubts(woman, motion):
    """how sure it is that a motion is a person's"""
    armless = motion.retarget(woman).report["confidence"]
    assert armless == {"value": 0.5625, "doubts": ["it lacks the left arm, the right arm"]}
    headless = motion.retarget(woman, mapping={"Head": None}).report["confidence"]
    assert headless["value"] < 0.5 and headless["doubts"] == ["it lacks the head, the left arm, the right arm"], headless


def test_motion_refusals(woman, file, motion):
    """motions that are none, and wrong options"""
    raises(anthronet.ArgumentError, lambda: motion.retarget(woman, clip=1), "clip")
    raises(anthronet.IoError, lambda: anthronet.open_motion("nothing.bvh"), "nothing.bvh")
    raises(anthronet.FileError, lambda: anthronet.Motion.from_bytes(b"x", "a.bvh"))
    assert isinstance(raised_by(lambda: anthronet.Motion.from_bytes(b"x", "a.txt")), anthronet.Error)
    assert isinstance(raised_by(lambda: motion.retarget(woman, mapping={"no joint": "x"})), anthronet.Error)
    raises(ValueError, lambda: anthronet.open_motion(file, up="w"), "up", "'w'")
    for name in ("metres_per_unit", "frames_per_second"):
        for value in (0, -1, math.nan):
            raises(ValueError, lambda: anthronet.open_motion(file, **{name: value}), name, "positive")
    raises(ValueError, lambda: motion.retarget(woman, fingers="x"), "fingers")
    raises(TypeError, lambda: motion.retarget(woman, limits=None), "limits")


def test_motion_of_poses(woman, walk):
    """a motion of poses of another program comes back as it was, and wrong arrays are refused"""
    joints = woman.joints("blender")
    rest = joints["parent_from_joint"]
    posed = anthronet.Motion.from_poses("walk", woman.joint_names(), list(woman.parents), rest, walk.bake(space="blender"), 30,
                                        space="blender")
    assert posed.clip_names == ("walk",)
    own = posed.retarget(woman, limits=False, feet=False)
    # The way over the ground is the pelvis' now, all else is where it was.
    assert np.allclose(own.bake("model")[:, 1:, 4:], walk.bake("model")[:, 1:, 4:], atol=1e-5)
    arguments = ["walk", woman.joint_names(), list(woman.parents), rest, walk.bake(), 30]
    for place, value in ((1, ["a"] * len(rest)), (2, [5] * len(rest)), (3, rest * np.nan), (5, 0)):
        wrong = [*arguments[:place], value, *arguments[place + 1 :]]
        assert isinstance(raised_by(lambda: anthronet.Motion.from_poses(*wrong)), anthronet.Error), place
    for place, value in ((0, 3), (1, "abc"), (1, [1]), (2, [-1]), (2, ["x"] * len(rest)), (3, rest[1:]), (4, rest), (5, "30")):
        wrong = [*arguments[:place], value, *arguments[place + 1 :]]
        assert isinstance(raised_by(lambda: anthronet.Motion.from_poses(*wrong)), (TypeError, ValueError)), place
