"""Motion from clips, files and other armatures; modal operators."""

import contextlib
import io
from types import SimpleNamespace

import bpy
import numpy as np
from mathutils import Matrix, Quaternion

from blender.harness import (
    TOLERANCE,
    add,
    check,
    clean,
    curves,
    evaluated,
    generated,
    home,
    joints,
    mesh_of,
    milliseconds,
    module,
    people,
    select,
    service,
    speed,
)


def moving():
    import anthronet

    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    character = add(sex="FEMALE", height=1.70, arm_length_left=0.33)
    surface, body = mesh_of(character), generated(character)
    mesh = body.mesh(lod=1, influences=8, space="blender", layout="model")
    skinners = [mesh.skinner(part) for part in range(len(mesh.parts))]
    bpy.ops.anthronet.clip_builtin(name="RANGE_OF_MOTION")
    clip = anthronet.builtin_clip("range_of_motion", body).resample(30)
    for method, frames, preserve in (
        ("linear", np.random.default_rng(1).integers(0, clip.frame_count, 20), False),
        ("dual_quaternion", (7, 31, 55), True),
    ):
        surface.modifiers[0].use_deform_preserve_volume = preserve
        worst = 0.0
        for frame in frames:
            scene.frame_set(1 + int(frame))
            pose = clip.sample(int(frame) / 30, relative="model", space="blender")
            expected = np.concatenate([skinner.skin(pose, method=method)[0] for skinner in skinners])
            worst = max(worst, float(np.abs(evaluated(surface) - expected).max()))
        check(f"{len(frames)} frames are skinned as by the library, {method}", worst <= TOLERANCE, f"{worst:.1e} m")

    long = clip.resample(30)
    while long.frame_count < 300:
        long = long.crossfade(clip, 0.2)
    source = home / "source.glb"
    body.save(source, clips=[long])
    took = milliseconds(lambda _: bpy.ops.anthronet.clip_apply(filepath=str(source)), 3)
    speed(f"a clip of {long.frame_count} frames", took, 500)
    check("the clip of a file becomes an action", len(curves(character.animation_data.action)) > 200)


def _off(character, clip, frames, rate, start=1):
    """Largest distance of joints from those of a clip, at frames of the scene; metres."""
    scene, worst = bpy.context.scene, 0.0
    for frame in frames:
        scene.frame_set(frame)
        expected = clip.sample((frame - start) / rate, relative="model", space="blender")[:, 4:]
        worst = max(worst, float(np.abs(joints(character) - expected).max()))
    return worst


def rating():
    """The scene's frame rate and frame range."""
    import anthronet

    for fps, base in ((24, 1.0), (30, 1.001)):
        clean()
        scene = bpy.context.scene
        scene.render.fps, scene.render.fps_base = fps, base
        rate = fps / base
        character = add(sex="MALE", height=1.80)
        scene.frame_start, scene.frame_end = 7, 9
        bpy.ops.anthronet.clip_builtin(name="WALK", frame_start=5)
        check("the scene's frame range is not changed", (scene.frame_start, scene.frame_end) == (7, 9))
        bpy.ops.anthronet.clip_builtin(name="WALK", frame_start=5, use_scene_range=True)
        clip = anthronet.builtin_clip("walk", generated(character)).resample(rate)
        keys = np.array([key.co[0] for key in curves(character.animation_data.action)[0].keyframe_points])
        check(
            f"{rate:.2f} frames a second: a keyframe on each frame",
            np.abs(keys - keys.round()).max() < 1e-3 and len(keys) == clip.frame_count,
            f"{len(keys)} keys, {clip.frame_count} frames",
        )
        check(
            f"{rate:.2f} frames a second: Set Scene Range",
            (scene.frame_start, scene.frame_end) == (5, 4 + clip.frame_count),
            f"{scene.frame_start} to {scene.frame_end}",
        )
        off = _off(character, clip, (5, 11, 4 + clip.frame_count), rate, start=5)
        check(f"{rate:.2f} frames a second: joints are the clip's", off < 1e-4, f"{1000 * off:.4f} mm")


def layering():
    """Clips for characters that already have poses, actions or NLA tracks."""
    import anthronet

    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    character = add(sex="FEMALE", height=1.70)
    body = generated(character)
    bpy.ops.anthronet.clip_builtin(name="WALK")
    scene.frame_set(9)
    character.pose.bones["thigh.L"].rotation_mode = "XYZ"
    character.pose.bones["head"].scale = (1.2, 1.2, 1.2)
    bpy.ops.anthronet.clip_builtin(name="IDLE", in_place=True)
    idle = anthronet.builtin_clip("idle", body).in_place().resample(30)
    off = _off(character, idle, (1, 20, 40), 30)
    check("no channel keeps a value of an earlier pose", off < 1e-4, f"{1000 * off:.3f} mm")

    own = bpy.data.actions.new("own")
    character.animation_data.action = own
    character.pose.bones["jaw"].keyframe_insert("rotation_quaternion", frame=3)
    bpy.ops.anthronet.clip_builtin(name="SQUAT")
    check("a replaced action is kept with a fake user", own.use_fake_user and own.name in bpy.data.actions)
    character.animation_data.action = own
    bpy.ops.anthronet.clip_builtin(name="SQUAT", nla=True, frame_start=11)
    tracks = character.animation_data.nla_tracks
    strips = [strip for track in tracks for strip in track.strips]
    check(
        "As NLA Strip: the earlier action is the strip below",
        [strip.action.name for strip in strips] == ["own", strips[-1].action.name]
        and character.animation_data.action is None,
        str([strip.action.name for strip in strips]),
    )
    if module("compat").HAS_SLOTS:
        check("NLA strips have slots", all(strip.action_slot is not None for strip in strips))
    squat = anthronet.builtin_clip("squat", body).resample(30)
    off = _off(character, squat, (11, 30, 45), 30, start=11)
    check("As NLA Strip: the pose is the clip's", off < 1e-4, f"{1000 * off:.3f} mm")


def refitting():
    """Refit Clip, after a change of the body."""
    import anthronet

    clean()
    bpy.context.scene.render.fps = 30
    character = add(sex="FEMALE", height=1.70)
    action = service("action")
    bpy.ops.anthronet.clip_builtin(name="WALK", frame_start=3)
    played = character.animation_data.action
    check("a new action is not outdated", not action.is_outdated(character))
    character.anthronet.height = 1.50
    check("after a change of the body the action is outdated", action.is_outdated(character))
    bpy.ops.anthronet.clip_refit()
    clip = anthronet.builtin_clip("walk", generated(character)).resample(30)
    off = _off(character, clip, (3, 12, 25), 30, start=3)
    check(
        "Refit Clip bakes the clip of the new body into the same action",
        off < 1e-4 and character.animation_data.action == played and not action.is_outdated(character),
        f"{1000 * off:.3f} mm",
    )
    path = home / "refit.glb"
    generated(character).save(path, clips=[clip])
    bpy.ops.anthronet.clip_apply(filepath=str(path), nla=True, feet=False, limits=False)
    select(character, mesh_of(character))
    bpy.ops.object.duplicate(linked=True)
    other = next(one for one in people() if one != character)
    other.anthronet.height = 1.80
    select(other)
    before = [one.name for one in action.used_by(character)]
    bpy.ops.anthronet.clip_refit()
    check(
        "Refit Clip does not change an action that another character uses",
        [one.name for one in action.used_by(character)] == before
        and not set(action.used_by(other)) & set(action.used_by(character))
        and not action.is_outdated(other),
        f"{before} {[one.name for one in action.used_by(other)]}",
    )


def _directions(places, pairs):
    offsets = np.array([places[b] - places[a] for a, b in pairs])
    return offsets / np.linalg.norm(offsets, axis=1, keepdims=True)


#: Bones whose directions are compared, as our joints: from one to the other.
_LIMBS = (
    ("upperarm_l", "lowerarm_l"),
    ("lowerarm_l", "hand_l"),
    ("upperarm_r", "lowerarm_r"),
    ("thigh_l", "calf_l"),
    ("calf_l", "foot_l"),
    ("thigh_r", "calf_r"),
    ("calf_r", "foot_r"),
)


def _largest_angle(character, source, names, frames, first):
    """The largest angle between limbs of an armature and of the character, degrees, over frames of the armature's action that
    came to the frames from 1 on."""
    scene, worst = bpy.context.scene, 0.0
    native = generated(character).joint_names()
    for frame in frames:
        scene.frame_set(frame)
        bpy.context.view_layer.update()
        world = source.matrix_world
        there = {joint: np.array(world @ source.pose.bones[name].head) for joint, name in names.items()}
        scene.frame_set(frame - first + 1)
        here = dict(zip(native, joints(character)))
        cosines = np.sum(_directions(there, _LIMBS) * _directions(here, _LIMBS), axis=1)
        worst = max(worst, float(np.degrees(np.arccos(np.clip(cosines, -1, 1))).max()))
    return worst


def _key(bone, angle, frames):
    """Turns a bone about its X from rest to an angle between two frames."""
    bone.rotation_mode = "QUATERNION"
    for frame, turned in zip(frames, (0.0, angle)):
        bone.rotation_quaternion = Quaternion((1, 0, 0), turned)
        bone.keyframe_insert("rotation_quaternion", frame=frame)


def following():
    """Retargeting of another armature: with Mixamo's names, in centimetres, rotated, with two actions."""
    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    character = add(sex="MALE", height=1.80)
    body = generated(character)
    check("without another armature the operator is not available", not bpy.ops.anthronet.clip_from_armature.poll())
    armature = bpy.data.armatures.new("Mixamo")
    rig = bpy.data.objects.new("Mixamo", armature)
    bpy.context.collection.objects.link(rig)
    rig.scale, rig.rotation_euler = (0.01, 0.01, 0.01), (0, 0, 0.7)
    native, mixamo = body.joint_names(), body.joint_names("mixamo")
    kept = [i for i, name in enumerate(native) if "twist" not in name and name != "Root"]
    select(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    placed = body.joints("blender")
    for i in kept:
        bone = armature.edit_bones.new(mixamo[i])
        bone.length = 5
        matrix = Matrix(placed[i]["model_from_joint"].tolist())
        matrix.translation *= 100
        bone.matrix = matrix
        parent = int(placed[i]["parent"])
        if parent in kept:
            bone.parent = armature.edit_bones[mixamo[parent]]
    bpy.ops.object.mode_set(mode="OBJECT")
    names = {native[i]: mixamo[i] for i in kept}
    for joint, angle in (("lowerarm_l", 0.9), ("calf_r", 0.8), ("thigh_r", -0.6), ("upperarm_r", 0.5)):
        _key(rig.pose.bones[names[joint]], angle, (11, 31))
    action = rig.animation_data.action
    other = bpy.data.actions.new("still")
    rig.animation_data.action = other
    scene.frame_set(2)
    select(character)
    result = bpy.ops.anthronet.clip_from_armature(
        source="Mixamo", action=action.name, limits=False, feet=False, fingers="SOURCE"
    )
    check("the armature has its earlier action, and the scene its earlier frame",
          rig.animation_data.action == other and scene.frame_current == 2)
    length = character.animation_data.action.frame_range[1]
    check("the motion is as long as the action", result == {"FINISHED"} and abs(length - 21) < 1e-3, f"{length}")
    module("compat").assign_action(rig, action)
    scene.frame_set(31)
    worst = _largest_angle(character, rig, names, (11, 20, 31), 11)
    check("a Mixamo rig in centimetres: limbs point the same way", worst < 1.0, f"{worst:.2f}°")


def rigging():
    """Rigify: the metarig fits the character, and motion of the generated rig is retargeted."""
    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    character = add(sex="FEMALE", height=1.64)
    check("without Rigify the operator is not available", not bpy.ops.anthronet.metarig_add.poll())
    bpy.ops.preferences.addon_enable(module="rigify")
    bpy.ops.anthronet.metarig_add()
    metarig = bpy.context.object
    own = {bone["anthronet_joint"]: bone.head_local for bone in character.data.bones}
    pairs = {
        "spine": "pelvis", "spine.003": "spine_03", "spine.004": "neck_01", "spine.006": "head",
        **{f"{meta}.{s}": f"{joint}_{s.lower()}" for s in "LR" for meta, joint in (
            ("shoulder", "clavicle"), ("upper_arm", "upperarm"), ("forearm", "lowerarm"), ("hand", "hand"),
            ("thigh", "thigh"), ("shin", "calf"), ("foot", "foot"), ("toe", "ball"), ("thumb.02", "thumb_02"),
            ("f_index.01", "index_01"), ("f_pinky.03", "pinky_03"))},
    }  # fmt: skip
    offs = {m: (metarig.data.bones[m].head_local - own[joint]).length for m, joint in pairs.items()}
    # Rigify wants elbows and knees out of the straight.
    bent = max(offs.pop(f"{meta}.{side}") for meta in ("forearm", "shin") for side in "LR")
    check(
        "the joints of the metarig are the character's, elbows and knees slightly bent",
        max(offs.values()) < 1e-5 and bent < 0.01,
        f"{1000 * max(offs.values()):.3f} mm, {1000 * bent:.1f} mm",
    )
    for meta, axis in (("forearm", (0, 0, -1)), ("shin", (1, 0, 0)), ("f_middle.02", (0, 1, 0))):
        left, right = (metarig.data.bones[f"{meta}.{side}"].matrix_local.to_3x3().col[0] for side in "LR")
        check(f"{meta}: the roll is symmetric", abs(left.x - right.x) < 0.02 and abs(left.y + right.y) < 0.02
              and abs(left.z + right.z) < 0.02, f"{left} {right}")
        check(f"{meta}: bends about the axis of Rigify's own metarig", left.dot(axis) > 0.9, f"{left}")
    before = set(bpy.data.objects)
    bpy.ops.pose.rigify_generate()
    rig = next(ob for ob in set(bpy.data.objects) - before if ob.type == "ARMATURE")
    off = max(
        (rig.data.bones[f"DEF-{meta}"].head_local - own[joint]).length
        for meta, joint in pairs.items()
        if f"DEF-{meta}" in rig.data.bones
    )
    check("the generated rig is where the character is", off < 0.01 and len(rig.data.bones) > 300, f"{1000 * off:.2f} mm")

    for side in "LR":
        for limb in ("upper_arm_parent", "thigh_parent"):
            rig.pose.bones[f"{limb}.{side}"]["IK_FK"] = 1.0
    for name, angle in (("forearm_fk.L", 0.9), ("shin_fk.R", 0.8), ("thigh_fk.R", -0.6), ("upper_arm_fk.R", 0.4)):
        _key(rig.pose.bones[name], angle, (1, 15))
    select(character, rig)
    scene.frame_set(1)
    took = milliseconds(lambda _: bpy.ops.anthronet.clip_from_armature(limits=False, feet=False))
    print(f"the motion of a Rigify rig: {took:.0f} ms")
    names = {
        f"{joint}_{side.lower()}": f"DEF-{meta}.{side}"
        for side in "LR"
        for joint, meta in (("upperarm", "upper_arm"), ("lowerarm", "forearm"), ("hand", "hand"), ("thigh", "thigh"),
                            ("calf", "shin"), ("foot", "foot"))
    }  # fmt: skip
    worst = _largest_angle(character, rig, names, (1, 8, 15), 1)
    check("a Rigify rig: limbs point the same way", worst < 3.0, f"{worst:.2f}°")
    bpy.ops.preferences.addon_disable(module="rigify")


def slicing():
    """Long work in slices, as the timer of a window does them."""
    _slices_of_a_crowd()
    _ends_of_modal_operators()
    _stopped_sampling()


def _slices_of_a_crowd():
    clean()
    modal = module("operators.modal")
    crowd = bpy.types.ANTHRONET_OT_crowd_add
    options = SimpleNamespace(count=40, seed=3, spacing=1.5, lod="3", skin_tones=True, changed=False)
    options._location = lambda context, index: crowd._location(options, context, index)
    work = modal.SlicedWork(crowd.work(options, bpy.context))
    while not options.changed:
        work.run_slice(0.01)
    count = len(people())
    check("a slice adds some characters", 0 < count < 40 and not work.done and 0 < work.progress < 1, f"{count}")
    work.close()
    check("after Esc they are still there", len(people()) == count and work.done and work.run_slice())


class _Window:
    """A window manager and workspace for a modal operator. Counts timers and progress bars."""

    def __init__(self):
        self.timers = self.bars = 0
        self.text = ""

    def event_timer_add(self, _time, window):
        self.timers += 1
        return object()

    def event_timer_remove(self, _timer):
        self.timers -= 1

    def progress_begin(self, *_):
        self.bars += 1

    def progress_end(self):
        self.bars -= 1

    def progress_update(self, _):
        pass

    def modal_handler_add(self, _):
        pass

    def status_text_set(self, text):
        self.text = text or ""


class _CountingOperator:
    """What a modal operator needs besides the mix-in: work that counts and raises an error at a number."""

    bl_label = "Count"
    options = SimpleNamespace(is_invoke=True, is_repeat=False)

    def __init__(self, fails_at, error):
        self.fails_at, self.error, self.reports, self.closed = fails_at, error, [], False

    def report(self, kinds, text):
        self.reports.append((next(iter(kinds)), text))

    def work(self, _context):
        try:
            for number in range(1000):
                self.changed = number > 2
                if number == self.fails_at:
                    raise self.error
                yield number / 1000
                yield None
        finally:
            self.closed = True


def _run_modal(fails_at, error, events):
    """Sends events to a modal operator until it ends: operator, window, result."""
    modal = module("operators.modal")
    operator = type("Operator", (_CountingOperator, modal.ModalOperator), {})(fails_at, error)
    window = _Window()
    context = SimpleNamespace(window_manager=window, workspace=window, window=None)
    operator._work = modal.SlicedWork(operator.work(context))
    operator._start_modal(context)
    for event in events:
        result = operator.modal(context, event)
        if result != {"RUNNING_MODAL"}:
            break
    return operator, window, result


def _ends_of_modal_operators():
    tick, escape, move = (SimpleNamespace(type=kind) for kind in ("TIMER", "ESC", "MOUSEMOVE"))
    for name, fails_at, error, events, expected, reported in (
        ("Esc after some work", None, None, [tick, move, tick, escape], {"FINISHED"}, "INFO"),
        ("Esc before any", None, None, [move, escape], {"CANCELLED"}, "INFO"),
        ("the end", None, None, [tick] * 5000, {"FINISHED"}, None),
        ("an error", 0, ValueError("no such thing"), [tick], {"CANCELLED"}, "ERROR"),
        ("an error after some work", 5, ValueError("no such thing"), [tick] * 20, {"FINISHED"}, "ERROR"),
        ("a programming error", 5, KeyError("a"), [tick] * 20, {"FINISHED"}, "ERROR"),
    ):
        with contextlib.redirect_stderr(io.StringIO()):
            operator, window, result = _run_modal(fails_at, error, events)
        left = (window.timers, window.bars, window.text)
        kinds = [kind for kind, _ in operator.reports]
        check(
            f"{name}: no timer, progress bar or text is left",
            result == expected and left == (0, 0, "") and operator.closed == (name != "Esc before any")
            and kinds == ([reported] if reported else []),
            f"{result} {left} {operator.reports}",
        )


def _stopped_sampling():
    clean()
    character = add(sex="FEMALE")
    bpy.ops.anthronet.clip_builtin(name="WALK")
    scene = bpy.context.scene
    scene.frame_set(4)
    work = service("sampling").sample_clip(character, generated(character), scene, "walk", 1, 50)
    next(work), next(work)
    shown = [modifier.show_viewport for modifier in mesh_of(character).modifiers]
    work.close()
    check(
        "Esc while frames are sampled: the frame and the modifiers are as before",
        scene.frame_current == 4 and not any(shown) and mesh_of(character).modifiers[0].show_viewport,
    )
