"""What comes out of the Python package: the bytes of the command, axes and handedness in every space.

    python python_files.py ANTHRONET FOLDER
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

import anthronet
from python_cases import main_module, run

COMMAND, FOLDER = sys.argv[1], Path(sys.argv[2])
#: The left arm is longer than the right one.
UNEVEN = anthronet.generate("male", arm_length_left=0.345, arm_length_right=0.33)
#: Rows are the axes of each space in glTF's.
AXES = {"gltf": np.eye(3), "blender": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), "unity": np.diag([-1, 1, 1])}


def by_command(name, request, *arguments):
    FOLDER.mkdir(parents=True, exist_ok=True)
    asked, file = FOLDER / f"{name}.json", FOLDER / name
    asked.write_text(request.to_json(), encoding="utf-8")
    subprocess.run([COMMAND, "generate", "--request", asked, *arguments, "-o", file], check=True, capture_output=True)
    return file.read_bytes()


def test_same_bytes():
    """files are those of the command, byte by byte"""
    requests = [anthronet.Request("female", height=1.70), anthronet.Request(), anthronet.Request("male", seed=5),
                anthronet.Request("male", height=1.72, waist_circumference=1.15, seed=5, fill="sample"),
                anthronet.Request("female", latent=np.linspace(-1, 1, 10), arm_length=0.31)]
    for i, request in enumerate(requests):
        body = anthronet.default_model().generate(request)
        for format in ("glb", "usdc", "obj") if i == 0 else ("glb",):
            assert body.to_bytes(format, lod=1) == by_command(f"{i}.{format}", request, "--lod", "1"), (i, format)
    body = anthronet.default_model().generate(requests[0])
    file = FOLDER / "saved.glb"
    body.save(file)
    assert file.read_bytes() == by_command("whole.glb", requests[0])
    clips = [anthronet.builtin_clip("walk", body)]
    moving = body.to_bytes("glb", lod=3, influences=8, joint_names="unity", clips=clips)
    options = ["--lod", "3", "--influences", "8", "--joint-names", "unity", "--clip", "walk"]
    assert moving == by_command("moving.glb", requests[0], *options)


def test_report():
    """reports, measures and information are those of the command"""
    request = anthronet.Request("female", height=1.70)
    report = FOLDER / "report.json"
    by_command("reported.glb", request, "--report", str(report))
    assert anthronet.default_model().generate(request).report == json.loads(report.read_text("utf-8"))
    info = subprocess.run([COMMAND, "info", "--json"], check=True, capture_output=True).stdout
    assert anthronet.default_model().info() == json.loads(info)
    found = anthronet.default_model().measure_file(FOLDER / "reported.glb")
    rows = json.loads(subprocess.run([COMMAND, "measure", FOLDER / "reported.glb", "--json"], check=True, capture_output=True).stdout)
    assert {row["name"]: row["value"] for row in rows["measures"]} == found.measures


def matrices(transforms):
    """(…, 7) quaternions and translations as (…, 4, 4)."""
    x, y, z, w = np.moveaxis(np.asarray(transforms, float)[..., :4], -1, 0)
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
            2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]
    found = np.zeros((*np.shape(x), 4, 4))
    found[..., :3, :3] = np.stack(rows, -1).reshape(*np.shape(x), 3, 3)
    found[..., :3, 3], found[..., 3, 3] = np.asarray(transforms)[..., 4:], 1
    return found


def into(space, model_from_joint):
    """A joint of glTF space in another space: the model's axes change; the joint's own stay, or are mirrored with it."""
    model, joint = np.eye(4), np.eye(4)
    model[:3, :3] = AXES[space]
    joint[0, 0] = -1 if space == "unity" else 1
    return model @ model_from_joint @ joint


def test_mesh_spaces():
    """meshes in three spaces: axes, winding, normals, volume"""
    ours = {part.name: part for part in UNEVEN.mesh(lod=1)}
    for space, axes in AXES.items():
        for layout in ("render", "model"):
            for part in UNEVEN.mesh(space=space, layout=layout):
                faces = part.triangles if layout == "render" else part.quads
                a, b, c = (part.positions[faces[:, i]].astype(float) for i in range(3))
                # The way round that makes normals point outwards is the same as the volume's in a right-handed space;
                # in a left-handed one both axes and winding are mirrored.
                if part.name == "Body":
                    triangles = faces if layout == "render" else np.r_[faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]
                    p, q, r = (part.positions[triangles[:, i]].astype(float) for i in range(3))
                    volume = np.einsum("ij,ij->", p, np.cross(q, r)) / 6
                    assert abs(volume - UNEVEN.volume_m3) < 1e-5, (space, layout, volume)
                agree = np.einsum("ij,ij->i", np.cross(b - a, c - a), part.normals[faces[:, 0]])
                assert (agree > 0).mean() > 0.8, (space, layout, part.name)
        for part in UNEVEN.mesh(lod=1, space=space):
            assert np.allclose(part.positions, ours[part.name].positions @ axes.T, atol=1e-7), (space, part.name)
            assert np.allclose(part.normals, ours[part.name].normals @ axes.T, atol=1e-7)
            v = ours[part.name].uvs[:, 1]
            assert np.allclose(part.uvs[:, 1], v if space == "gltf" else 1 - v, atol=1e-6)
        body = UNEVEN.mesh(lod=1, space=space)[0].positions
        forward, up = {"gltf": (2, 1), "blender": (1, 2), "unity": (2, 1)}[space]
        assert abs(body[:, up].min()) < 1e-3 and body[:, up].max() > 1.6, "feet on the floor, head up"
        face = body[body[:, up] > body[:, up].max() - 0.2]
        nose = face[np.abs(face[:, 0]) < 0.01][:, forward]
        front = -nose.min() if space == "blender" else nose.max()
        assert front > 0.05, "the nose points where the character looks"


def test_joint_spaces():
    """joints in three spaces: the left hand, the longer arm, chains, inverses"""
    names = UNEVEN.joint_names()
    ours = UNEVEN.joints()
    left, right = names.index("hand_l"), names.index("hand_r")
    for space, axes in AXES.items():
        joints = UNEVEN.joints(space)
        where = joints["model_from_joint"][:, :3, 3]
        side = -1 if space == "unity" else 1
        assert side * where[left, 0] > 0.3 and side * where[right, 0] < -0.3, (space, where[left])
        reach = [abs(where[joint, 0]) for joint in (left, right)]
        assert reach[0] > reach[1] + 0.003, (space, reach)
        assert np.allclose(joints["model_from_joint"], into(space, ours["model_from_joint"]), atol=1e-6)
        tails = where + joints["length"][:, None] * joints["model_from_joint"][:, :3, 1]
        in_ours = ours["model_from_joint"][:, :3, 3] + ours["length"][:, None] * ours["model_from_joint"][:, :3, 1]
        assert np.allclose(tails, in_ours @ axes.T, atol=1e-6), "bones run along +Y in every space"
        product = joints["model_from_joint"].astype(float) @ joints["joint_from_model"]
        assert np.allclose(product, np.eye(4), atol=1e-6)
        assert np.allclose(np.linalg.det(joints["model_from_joint"][:, :3, :3].astype(float)), 1, atol=1e-5)
        local = matrices(np.concatenate([joints["rotation"], joints["translation"]], axis=1))
        for i, parent in enumerate(joints["parent"]):
            chained = local[i] if parent < 0 else joints["model_from_joint"][parent].astype(float) @ local[i]
            assert np.allclose(chained, joints["model_from_joint"][i], atol=1e-5), (space, names[i])


def test_posed_spaces():
    """clips and skinning in three spaces give one posed surface"""
    walk = anthronet.builtin_clip("walk", UNEVEN)
    ours = walk.sample(0.4, relative="model")
    surface = UNEVEN.mesh(lod=1).skinner().skin(ours)
    for space, axes in AXES.items():
        pose = walk.sample(0.4, relative="model", space=space)
        assert np.allclose(matrices(pose), into(space, matrices(ours)), atol=1e-5), space
        local, parents = matrices(walk.sample(0.4, space=space)), UNEVEN.parents
        chained = []
        for i, parent in enumerate(parents):
            chained.append(local[i] if parent < 0 else chained[parent] @ local[i])
        assert np.allclose(chained, matrices(pose), atol=1e-4), space
        positions, normals = UNEVEN.mesh(lod=1, space=space).skinner().skin(pose)
        assert np.abs(positions - surface[0] @ axes.T).max() < 1e-5, space
        assert np.abs(normals - surface[1] @ axes.T).max() < 1e-3, space


if __name__ == "__main__":
    run(main_module())
