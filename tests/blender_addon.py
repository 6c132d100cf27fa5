"""The Blender extension as its users have it: installed from its zip, then used.

    python blender_addon.py anthronet-….zip PICTURES

Runs in any Blender from 4.2 as a module. Speeds are printed beside their bars and asserted nowhere.
"""

import importlib
import json
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

archive, pictures = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
pictures.mkdir(parents=True, exist_ok=True)
home = tempfile.mkdtemp(prefix="anthronet-blender-")
os.environ["BLENDER_USER_RESOURCES"] = home

import bpy  # noqa: E402
import numpy as np  # noqa: E402

from glb import Cases  # noqa: E402

NAME = "bl_ext.user_default.anthronet"
TOLERANCE = 1e-5  # metres; Blender and the library keep single precision
cases = Cases()


def check(name, true, told=""):
    cases.case(name, bool(true), told)


def clean():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if NAME not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module=NAME)


def add(**fields):
    assert bpy.ops.anthronet.character_add(**fields) == {"FINISHED"}
    return bpy.context.object


def service(name):
    return importlib.import_module(f"{NAME}.services.{name}")


def mesh_of(character):
    return service("character").mesh_of(character)


def positions(mesh):
    out = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", out)
    return out.reshape(-1, 3)


def evaluated(surface):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return positions(surface.evaluated_get(depsgraph).data)


def milliseconds(work, times=1):
    taken = []
    for step in range(times):
        start = time.perf_counter()
        work(step)
        taken.append(1000 * (time.perf_counter() - start))
    return statistics.median(taken)


def speed(name, took, bar):
    print(f"speed {name}: {took:.1f} ms (bar {bar} ms)")


def generated(character):
    import anthronet

    return anthronet.default_model().generate(character.anthronet.request())


def installing():
    result = bpy.ops.extensions.package_install_files(
        filepath=str(archive), repo="user_default", enable_on_install=True
    )
    check("the zip installs and is enabled", result == {"FINISHED"} and NAME in bpy.context.preferences.addons)
    import anthronet

    check("the library comes from the extension's own wheel", home in anthronet.__file__, anthronet.__file__)


def creating():
    clean()
    first = milliseconds(lambda _: add(sex="FEMALE", height=1.70, waist_circumference=0.72))
    character = bpy.context.object
    surface = mesh_of(character)
    body = generated(character)
    speed("first character, with its template", first, "–")
    speed("character at level 1", milliseconds(lambda i: add(sex="MALE", height=1.80, seed=i), 7), 60)
    add(sex="MALE", lod="0")
    speed("character at level 0", milliseconds(lambda i: add(sex="MALE", height=1.80, seed=i, lod="0"), 5), 150)

    check("an armature with a mesh below it", character.type == "ARMATURE" and surface.type == "MESH")
    bpy.context.view_layer.objects.active = character
    bpy.ops.anthronet.measure_selected()
    measures = character["anthronet_measured"]
    off = max(abs(measures["height"] - 1.70), abs(measures["waist_circumference"] - 0.72))
    check("the mesh measures what was asked, to 0.1 mm", off < 1e-4, f"{1000 * off:.4f} mm")

    mesh = body.mesh(lod=1, influences=8, space="blender", layout="model")
    expected = np.concatenate([part.positions for part in mesh.parts])
    check("vertices are the library's to the bit", np.array_equal(positions(surface.data), expected))
    groups = [group.name for group in surface.vertex_groups]
    check("a vertex group for each bone", tuple(groups) == tuple(body.joint_names("blender")))
    worst, vertex = 0.0, 0
    for part in mesh.parts:
        for joints, weights in zip(part.joints, part.weights):
            asked = {int(j): float(w) for j, w in zip(joints, weights) if w > 0}
            got = {g.group: g.weight for g in surface.data.vertices[vertex].groups}
            if asked.keys() != got.keys():
                worst = 1.0
                break
            worst = max(worst, max(abs(asked[j] - got[j]) for j in asked))
            vertex += 1
    check("weights are the library's to the bit", worst == 0.0, f"{worst:.1e}")

    rest = np.array([np.array(character.data.bones[name].matrix_local) for name in body.joint_names("blender")])
    off = np.abs(rest - body.joints("blender")["model_from_joint"]).max()
    check("bones lie in the joints", off < 1e-5, f"{off:.1e}")
    left, right = (character.data.bones[f"hand.{side}"].head_local for side in "LR")
    check("the left hand is at +X, the face looks along -Y", left.x > 0 > right.x)
    bone, child = character.data.bones["upper_arm.L"], character.data.bones["forearm.L"]
    check(
        "a bone's tail points to its child",
        (bone.tail_local - child.head_local).length < 0.02,
        f"{(bone.tail_local - child.head_local).length:.4f} m",
    )
    check(
        "bones that do not deform are told apart", not character.data.bones[body.joint_names("blender")[0]].use_deform
    )
    names = {collection.name for collection in character.data.collections}
    check("bone collections", names == {"Torso", "Arms", "Legs", "Fingers", "Face", "Twist"}, str(names))
    check("the humanoid map", character.data["anthronet_humanoid"]["upperarm_l"] == "LeftUpperArm")
    uv = np.empty(2 * len(surface.data.loops), np.float32)
    surface.data.uv_layers[0].uv.foreach_get("vector", uv)
    check("texture coordinates in the unit square", 0 <= uv.min() and uv.max() <= 1 and np.ptp(uv) > 0.5)


def editing():
    clean()
    character = add(sex="FEMALE", height=1.70)
    surface = mesh_of(character)
    settings = character.anthronet
    bpy.ops.anthronet.clip_builtin(name="WALK")
    action = character.animation_data.action
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="nose")
    key.data[5].co.x += 0.25
    material = surface.data.materials[0]

    settings.waist_circumference = 0.80
    check(
        "moving a slider gives the measure", settings.given_waist_circumference and settings.error == "", settings.error
    )
    check(
        "the filled values follow",
        abs(settings.hip_circumference - generated(character).measures["hip_circumference"]) < 1e-6,
    )
    expected = np.concatenate(
        [p.positions for p in generated(character).mesh(lod=1, space="blender", layout="model").parts]
    )
    check("the mesh follows", np.array_equal(positions(surface.data), expected))
    moved = np.array(key.data[5].co) - np.array(surface.data.shape_keys.key_blocks[0].data[5].co)
    check("shape keys stay on top", np.allclose(moved, (0.25, 0, 0), atol=1e-6), str(moved))
    check(
        "animation and materials stay",
        character.animation_data.action == action and surface.data.materials[0] == material,
    )
    rest = np.array(character.data.bones["head"].matrix_local)
    joints = dict(zip(generated(character).joint_names("blender"), generated(character).joints("blender")))
    check("the bones follow", np.abs(rest - joints["head"]["model_from_joint"]).max() < 1e-5)

    bpy.ops.object.mode_set(mode="POSE")
    settings.height = 1.75
    check(
        "works in pose mode", character.mode == "POSE" and settings.error == "" and abs(settings.height - 1.75) < 1e-6
    )
    bpy.ops.object.mode_set(mode="OBJECT")

    before = positions(surface.data).copy()
    settings.waist_circumference = 2.5
    check("an impossible measure is told", "waist" in settings.error, settings.error)
    check("and the body stays as it was", np.array_equal(positions(surface.data), before))
    settings.waist_circumference = 0.80
    check("and is well again after it", settings.error == "")

    settings.identity[0] = 1.5
    check("identity by hand", settings.identity_by_hand and settings.error == "")
    settings.lod = "0"
    check("another level of detail", len(mesh_of(character).data.vertices) > 53_514)
    settings.lod, settings.accessories = "3", False
    check("the coarsest level, the body alone", len(mesh_of(character).data.vertices) < 2_000)
    settings.lod = "1"
    settings.joint_names = "UNITY"
    groups = {group.name for group in mesh_of(character).vertex_groups}
    check("bones and vertex groups are renamed", "LeftUpperArm" in character.data.bones and "LeftUpperArm" in groups)
    bpy.context.scene.frame_set(10)
    paths = {curve.data_path for curve in curves(action)}
    check("animation follows the names", any("LeftUpperArm" in path for path in paths))
    settings.skin_tone = 8
    dark = mesh_of(character).data.materials[0]
    check("skin tone", dark.diffuse_color[0] < 0.3, str(dark.diffuse_color[:]))


def curves(action):
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    return [
        curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves
    ]


def ticking():
    for lod, bar in (("1", 20), ("0", 40)):
        clean()
        character = add(sex="FEMALE", height=1.70, lod=lod)

        def tick(step):
            character.anthronet.waist_circumference = 0.70 + 0.003 * step
            bpy.context.view_layer.update()

        milliseconds(tick, 3)
        speed(f"slider tick at level {lod}", milliseconds(tick, 20), bar)
        check(
            f"the last tick at level {lod} was met",
            abs(generated(character).measures["waist_circumference"] - 0.757) < 1e-4,
        )


def sculpting():
    clean()
    character = add(sex="MALE", height=1.82)
    surface = mesh_of(character)
    pushed = positions(surface.data).copy()
    belly = (np.abs(pushed[:, 2] - 1.10) < 0.08) & (np.abs(pushed[:, 0]) < 0.16) & (pushed[:, 1] < 0)
    pushed[belly, 1] -= 0.03
    surface.data.attributes["position"].data.foreach_set("vector", pushed.reshape(-1))
    surface.data.update()
    before = generated(character).measures
    bpy.ops.anthronet.measure_selected()
    sculpted = dict(character["anthronet_measured"])
    check("sculpting shows in the measures", sculpted["waist_circumference"] > before["waist_circumference"] + 0.01)
    character.anthronet.height = 1.80
    depth = positions(surface.data)[belly, 1] - positions_of(character)[belly, 1]
    check("sculpting stays on top of a slider", np.allclose(depth, -0.03, atol=1e-5))
    bpy.ops.anthronet.measure_selected()
    sculpted = dict(character["anthronet_measured"])
    result = bpy.ops.anthronet.fit_selected()
    off = abs(generated(character).measures["waist_circumference"] - sculpted["waist_circumference"])
    check("measures from the mesh", result == {"FINISHED"} and off < 1e-4, f"{1000 * off:.3f} mm")


def positions_of(character):
    settings = character.anthronet
    mesh = generated(character).mesh(
        lod=int(settings.lod), space="blender", layout="model", body_only=not settings.accessories
    )
    return np.concatenate([part.positions for part in mesh.parts])


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
    worst = 0.0
    for frame in np.random.default_rng(1).integers(0, clip.frame_count, 20):
        scene.frame_set(1 + int(frame))
        pose = clip.sample(int(frame) / 30, relative="model", space="blender")
        expected = np.concatenate([skinner.skin(pose)[0] for skinner in skinners])
        worst = max(worst, float(np.abs(evaluated(surface) - expected).max()))
    check("20 frames as the library skins them", worst <= TOLERANCE, f"{worst:.1e} m (bar 1e-5)")
    surface.modifiers[0].use_deform_preserve_volume = True
    worst = 0.0
    for frame in (7, 31, 55):
        scene.frame_set(1 + frame)
        pose = clip.sample(frame / 30, relative="model", space="blender")
        expected = np.concatenate([skinner.skin(pose, method="dual_quaternion")[0] for skinner in skinners])
        worst = max(worst, float(np.abs(evaluated(surface) - expected).max()))
    check("with Preserve Volume as dual quaternions", worst <= TOLERANCE, f"{worst:.1e} m (bar 1e-5)")

    folder = Path(home)
    source = folder / "source.glb"
    long = clip.resample(30)
    while long.frame_count < 300:
        long = long.crossfade(clip, 0.2)
    body.save(source, clips=[long])
    took = milliseconds(lambda _: bpy.ops.anthronet.clip_apply(filepath=str(source)), 3)
    speed(f"a clip of {long.frame_count} frames", took, 500)
    check("a clip of a file plays", len(curves(character.animation_data.action)) > 200)
    bpy.ops.anthronet.clip_apply(filepath=str(source), nla=True)
    check("as a strip", len(character.animation_data.nla_tracks) == 1)

    scene.frame_start, scene.frame_end = 1, clip.frame_count
    bpy.ops.anthronet.clip_builtin(name="RANGE_OF_MOTION")
    for track in list(character.animation_data.nla_tracks):
        character.animation_data.nla_tracks.remove(track)
    for ending in (".glb", ".usdc"):
        path = folder / f"out{ending}"
        bpy.ops.anthronet.character_export(filepath=str(path), format=ending)
        back = anthronet.open_motion(str(path))
        check(f"export with motion, {ending}", back.clip_names and path.stat().st_size > 100_000, str(back.clip_names))
    again = anthronet.open_motion(str(folder / "out.glb")).retarget(body, limits=False, feet=False)
    off = np.abs(again.bake(relative="model")[:, :, 4:] - clip.bake(relative="model")[:, :, 4:]).max()
    check("the exported motion is the scene's", off < 2e-3, f"{1000 * off:.2f} mm")

    bpy.ops.import_scene.gltf(filepath=str(folder / "out.glb"))
    other = next(ob for ob in bpy.data.objects if ob.type == "ARMATURE" and ob is not character)
    service("character").select_only(bpy.context, character)
    character.animation_data_clear()
    result = bpy.ops.anthronet.clip_from_armature(source=other.name, limits=False, feet=False, fingers="SOURCE")
    own = character.animation_data.action
    check("the motion of another armature", result == {"FINISHED"} and len(curves(own)) > 200)


def failing():
    clean()
    character = add(sex="FEMALE")
    broken = Path(home) / "broken.bvh"
    broken.write_text("HIERARCHY\nROOT hips\n{\n")
    for name, work, expected in (
        ("a broken clip", lambda: bpy.ops.anthronet.clip_apply(filepath=str(broken)), "broken.bvh"),
        ("a missing clip", lambda: bpy.ops.anthronet.clip_apply(filepath="/nowhere/a.bvh"), "/nowhere/a.bvh"),
        ("a clip's number", lambda: bpy.ops.anthronet.clip_from_armature(source="nobody"), "nobody"),
        (
            "an impossible person",
            lambda: bpy.ops.anthronet.character_add(
                sex="FEMALE", height=1.5, thigh_length_left=0.69, thigh_length_right=0.69
            ),
            "thigh",
        ),
        (
            "a folder that is not there",
            lambda: bpy.ops.anthronet.character_export(filepath="/nowhere/a.glb"),
            "/nowhere",
        ),
    ):
        message = ""
        try:
            work()
        except RuntimeError as error:
            message = str(error)
        check(f"{name} is an error in words", expected in message and "Traceback" not in message, message.strip()[:160])
    mesh_of(character).data.clear_geometry()
    try:
        bpy.ops.anthronet.measure_selected()
        message = ""
    except RuntimeError as error:
        message = str(error)
    check(
        "a mesh without its vertices is an error in words",
        "vertices" in message and "Traceback" not in message,
        message.strip(),
    )


def keeping():
    clean()
    bpy.ops.ed.undo_push(message="start")
    character = add(sex="MALE", height=1.80)
    bpy.ops.ed.undo_push(message="add")
    before = positions(mesh_of(character).data).copy()
    character.anthronet.height = 1.90
    bpy.ops.ed.undo_push(message="taller")
    bpy.ops.ed.undo()
    character = service("character").active(bpy.context) or next(
        ob for ob in bpy.data.objects if ob.anthronet.is_character
    )
    same = np.array_equal(positions(mesh_of(character).data), before)
    check("undo restores the request and the body", same and abs(character.anthronet.height - 1.80) < 1e-6)
    bpy.ops.ed.redo()
    character = next(ob for ob in bpy.data.objects if ob.anthronet.is_character)
    check("redo brings them back", abs(character.anthronet.height - 1.90) < 1e-6)
    character.anthronet.waist_circumference = 0.95
    check("editing goes on after undo", character.anthronet.error == "")

    path = Path(home) / "kept.blend"
    request = character.anthronet.request().to_json()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    character = next(ob for ob in bpy.data.objects if ob.anthronet.is_character)
    check("a saved file has the request", character.anthronet.request().to_json() == request)
    character.anthronet.height = 1.70
    expected = positions_of(character)
    check(
        "and is edited on",
        character.anthronet.error == "" and np.array_equal(positions(mesh_of(character).data), expected),
    )

    clean()
    with bpy.data.libraries.load(str(path)) as (there, here):
        here.objects = [name for name in there.objects]
    for thing in here.objects:
        bpy.context.collection.objects.link(thing)
    character = next(ob for ob in bpy.data.objects if ob.anthronet.is_character)
    character.anthronet.height = 1.72
    check("an appended character is edited on", character.anthronet.error == "")

    saved = Path(home) / "request.json"
    service("character").select_only(bpy.context, character)
    bpy.ops.anthronet.request_save(filepath=str(saved))
    fields = json.loads(saved.read_text())
    check("the request as a file", abs(fields["measures"]["height"] - 1.72) < 1e-6, str(fields))
    fields["measures"]["height"] = 1.66
    saved.write_text(json.dumps(fields))
    bpy.ops.anthronet.request_load(filepath=str(saved))
    check("and back", abs(character.anthronet.height - 1.66) < 1e-6)
    bpy.ops.anthronet.preset_add(name="Somebody")
    character.anthronet.height = 1.80
    preset = next(path for path in Path(home).rglob("presets/anthronet/*.py") if path.stem.lower() == "somebody")
    bpy.ops.anthronet.preset_apply(filepath=str(preset))
    check("presets", abs(character.anthronet.height - 1.66) < 1e-6)
    character.anthronet.arm_length_left = 0.33
    bpy.ops.anthronet.mirror()
    check(
        "mirrored measures",
        abs(character.anthronet.arm_length_right - 0.33) < 1e-6 and character.anthronet.given_arm_length_right,
    )
    seed = character.anthronet.seed
    bpy.ops.anthronet.randomise(what="IDENTITY")
    check(
        "another identity with the same measures",
        character.anthronet.seed != seed and abs(character.anthronet.height - 1.66) < 1e-6,
    )


def crowding():
    clean()
    took = milliseconds(lambda _: bpy.ops.anthronet.crowd_add(count=100))
    speed("100 characters at level 1", took, 10_000)
    people = [ob for ob in bpy.data.objects if ob.anthronet.is_character]
    heights = {round(ob.anthronet.height, 4) for ob in people}
    check(
        "a hundred different people", len(people) == 100 and len(heights) > 90, f"{len(people)}, {len(heights)} heights"
    )
    for thing in people[3:6]:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = people[3]
    people[3].anthronet.height = 1.77
    bpy.ops.anthronet.copy_request()
    alike = {round(ob.anthronet.height, 4) for ob in people[3:6]}
    check("a request for all selected", alike == {1.77}, str(alike))
    check("each of them can be edited", people[3].anthronet.error == "" and people[7].anthronet.height != 1.77)


def registering():
    clean()
    known = lambda: {name for name in dir(bpy.types) if "anthro" in name.lower()} | set(dir(bpy.ops.anthronet))
    menus = lambda: [
        len(getattr(bpy.types, m).draw._draw_funcs)
        for m in ("VIEW3D_MT_mesh_add", "TOPBAR_MT_file_import", "TOPBAR_MT_file_export")
    ]
    first, entries = known(), menus()
    for _ in range(20):
        bpy.ops.preferences.addon_disable(module=NAME)
        bpy.ops.preferences.addon_enable(module=NAME)
    check("20 times off and on leaves nothing", known() == first and menus() == entries)
    bpy.ops.preferences.addon_disable(module=NAME)
    left = {name for name in dir(bpy.types) if "anthro" in name.lower()}
    check("off is off", not left and not hasattr(bpy.types.Object, "anthronet"), str(left))
    bpy.ops.preferences.addon_enable(module=NAME)

    operators = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ANTHRONET_OT_")]
    reads = {
        "anthronet.request_save",
        "anthronet.character_export",
        "anthronet.measure_selected",
        "anthronet.preset_add",
    }
    faults = []
    for operator in operators:
        module, _, name = operator.bl_idname.partition(".")
        if not getattr(getattr(bpy.ops, module), name).get_rna_type().description:
            faults.append(f"{operator.bl_idname}: no description")
        if "poll" not in {key for cls in operator.__mro__ for key in vars(cls)}:
            faults.append(f"{operator.bl_idname}: no poll")
        if operator.bl_idname not in reads and "UNDO" not in getattr(operator, "bl_options", ()):
            faults.append(f"{operator.bl_idname}: no undo")
    check("every operator has a poll, a description and undo", len(operators) >= 14 and not faults, "; ".join(faults))


def picturing():
    """Three people in three poses, by Cycles."""
    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    people = (
        (dict(sex="FEMALE", height=1.62, hip_circumference=1.08, skin_tone=7), "WALK", 9, -0.95),
        (dict(sex="MALE", height=1.90, chest_circumference=1.12, skin_tone=3), "WAVE", 40, 0.0),
        (dict(sex="FEMALE", height=1.78, waist_circumference=0.68, skin_tone=9), "SQUAT", 24, 0.95),
    )
    for fields, clip, frame, place in people:
        character = add(**fields)
        bpy.ops.anthronet.clip_builtin(name=clip, frame_start=12 - frame, in_place=True)
        character.location.x = place
        character.anthronet.fine_render = True
    scene.frame_set(12)
    bpy.ops.mesh.primitive_plane_add(size=40)
    ground = bpy.data.materials.new("ground")
    ground.diffuse_color = (0.75, 0.76, 0.78, 1)
    ground.use_nodes = True
    ground.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = ground.diffuse_color
    bpy.context.object.data.materials.append(ground)
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.85, 0.88, 0.92, 1)
    world.node_tree.nodes["Background"].inputs[1].default_value = 0.45
    scene.world = world
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler, sun.data.energy, sun.data.angle = (0.75, 0.1, 0.5), 1.7, 0.1
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -6.2, 1.35), (1.515, 0, 0)
    camera.data.lens = 62
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.seed = "CPU", 24, 1
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 660, 455
    scene.view_settings.view_transform = "Standard"
    path = pictures / "blender_people.png"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    check("a picture of three people", path.stat().st_size > 20_000)


PARTS = (installing, creating, editing, ticking, sculpting, moving, failing, keeping, crowding, registering, picturing)

if __name__ == "__main__":
    wanted = set(sys.argv[3:])
    print(f"Blender {bpy.app.version_string}")
    for part in PARTS:
        if not wanted or part is installing or part.__name__ in wanted:
            try:
                part()
            except Exception as error:  # A part that breaks off is a failed case; the others are still worth running.
                import traceback

                traceback.print_exc()
                check(f"{part.__name__} runs to its end", False, f"{type(error).__name__}: {error}")
    cases.exit()
