"""The picture of the documentation: three people, three poses, by Cycles on the processor. As one part of many it is rendered
small; asked for alone, as by `cargo xtask gen`, as the documentation has it."""

import sys

import bpy
import numpy as np

from blender.harness import add, check, clean, pictures

#: Width, height, samples.
_SMALL, _FINE = (400, 250, 6), (1280, 800, 32)
#: Request; clip, its frame or None for the one with the lowest hips, place, turn about the vertical.
_PEOPLE = (
    (dict(sex="FEMALE", height=1.62, hip_circumference=1.08, skin_tone=7), "WALK", 7, (-1.15, 0.1), 1.05),
    (dict(sex="MALE", height=1.88, chest_circumference=1.10, skin_tone=5), "WAVE", 40, (0.05, 0.3), 0.0),
    (dict(sex="FEMALE", height=1.76, waist_circumference=0.70, skin_tone=9), "SQUAT", None, (1.1, -0.1), -0.7),
)
_FRAME = 60


def _deepest(name, body):
    """The frame of a clip, at 30 a second, at which the hips are lowest."""
    import anthronet

    hips = list(body.joint_names()).index("pelvis")
    return int(np.argmin(anthronet.builtin_clip(name, body).resample(30).bake(relative="model")[:, hips, 5]))


def picturing():
    if bpy.app.version < (5, 0, 0):
        print("the picture is rendered in Blender 5.0 alone")
        return
    import anthronet

    clean()
    scene = bpy.context.scene
    scene.render.fps = 30
    for fields, clip, frame, (x, y), turn in _PEOPLE:
        character = add(**fields)
        if frame is None:
            frame = _deepest(clip.lower(), anthronet.default_model().generate(character.anthronet.request()))
        bpy.ops.anthronet.clip_builtin(name=clip, frame_start=_FRAME - frame, in_place=True)
        character.location, character.rotation_euler.z = (x, y, 0), turn
        character.anthronet.fine_render = True
    scene.frame_set(_FRAME)
    width, height, samples = _FINE if sys.argv[3:] == ["picturing"] else _SMALL
    _studio(scene)
    scene.cycles.samples = samples
    scene.render.resolution_x, scene.render.resolution_y = width, height
    path = pictures / "blender_people.png"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.array(image.pixels[:]).reshape(height, width, -1)[..., :3].mean(axis=2)
    # In each third of the picture a person contrasts with the wall.
    thirds = [third.std() for third in np.array_split(pixels[height // 8 : -height // 8], 3, axis=1)]
    check("a picture of three people", tuple(image.size) == (width, height) and min(thirds) > 0.03, str(thirds))


def _studio(scene):
    """A wall that goes over into the floor, three lights."""
    across, deep, high, bend = 14.0, 4.0, 7.0, 2.0
    outline = [(-deep, 0.0), (deep - bend, 0.0)]
    outline += [(deep - bend + bend * np.sin(a), bend - bend * np.cos(a)) for a in np.linspace(0, np.pi / 2, 16)[1:]]
    outline += [(deep, high)]
    points = [(x, y, z) for y, z in outline for x in (-across, across)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(outline) - 1)]
    backdrop = bpy.data.meshes.new("backdrop")
    backdrop.from_pydata(points, [], faces)
    backdrop.shade_smooth()
    paper = bpy.data.materials.new("paper")
    paper.use_nodes = True
    paper.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.55, 0.57, 0.60, 1)
    paper.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9
    backdrop.materials.append(paper)
    things = [bpy.data.objects.new("backdrop", backdrop)]
    for name, place, turn, size, power in (
        ("key", (-3.0, -4.0, 3.6), (0.95, 0.0, -0.62), 2.5, 330),
        ("fill", (4.0, -3.5, 2.2), (1.15, 0.0, 0.85), 4.0, 170),
    ):
        light = bpy.data.lights.new(name, "AREA")
        light.size, light.energy = size, power
        thing = bpy.data.objects.new(name, light)
        thing.location, thing.rotation_euler = place, turn
        things.append(thing)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -6.4, 1.15), (1.545, 0, 0)
    camera.data.lens = 62
    for thing in (*things, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("room")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.85, 0.9, 1.0, 1)
    scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.25
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.seed, scene.cycles.max_bounces = "CPU", 1, 4
    scene.cycles.use_denoising = True
    scene.view_settings.view_transform = "AgX"
