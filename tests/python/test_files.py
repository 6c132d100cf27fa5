"""What comes out of the Python package: the bytes of the command, axes and handedness in every space."""

import json
import subprocess

import anthronet
import numpy as np
import pytest
from support import matrices

#: Rows are the axes of each space in glTF's.
AXES = {"gltf": np.eye(3), "blender": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), "unity": np.diag([-1, 1, 1])}


@pytest.fixture(scope="module")
def uneven():
    """The left arm is longer than the right one."""
    return anthronet.generate("male", arm_length_left=0.345, arm_length_right=0.33)


@pytest.fixture
def by_command(anthronet_command, tmp_path):
    """A function: the bytes of a file that the command makes of a request."""

    def made(name, request, *arguments):
        asked, file = tmp_path / f"{name}.json", tmp_path / name
        asked.write_text(request.to_json(), encoding="utf-8")
        command = [anthronet_command, "generate", "--request", asked, *arguments, "-o", file]
        subprocess.run(command, check=True, capture_output=True)
        return file.read_bytes()

    return made


REQUESTS = {
    "woman": {"sex": "female", "height": 1.70},
    "anybody": {},
    "man with a seed": {"sex": "male", "seed": 5},
    "drawn man": {"sex": "male", "height": 1.72, "waist_circumference": 1.15, "seed": 5, "fill": "sample"},
    "latent numbers": {"sex": "female", "latent": np.linspace(-1, 1, 10), "arm_length": 0.31},
}


@pytest.mark.parametrize("who, format", [*((who, "glb") for who in REQUESTS), ("woman", "usdc"), ("woman", "obj")])
def test_same_bytes(model, by_command, who, format):
    """files are those of the command, byte by byte"""
    request = anthronet.Request(**REQUESTS[who])
    assert model.generate(request).to_bytes(format, lod=1) == by_command(f"same.{format}", request, "--lod", "1")


def test_same_saved(woman, by_command, tmp_path):
    """a saved file is that of the command, byte by byte"""
    file = tmp_path / "saved.glb"
    woman.save(file)
    assert file.read_bytes() == by_command("whole.glb", anthronet.Request("female", height=1.70))


def test_same_moving(woman, by_command):
    """a file with a clip is that of the command, byte by byte"""
    clips = [anthronet.builtin_clip("walk", woman)]
    moving = woman.to_bytes("glb", lod=3, influences=8, joint_names="unity", clips=clips)
    options = ["--lod", "3", "--influences", "8", "--joint-names", "unity", "--clip", "walk"]
    assert moving == by_command("moving.glb", anthronet.Request("female", height=1.70), *options)


def test_report(woman, model, anthronet_command, by_command, tmp_path):
    """reports, measures and information are those of the command"""
    report, file = tmp_path / "report.json", tmp_path / "reported.glb"
    by_command(file.name, anthronet.Request("female", height=1.70), "--report", str(report))
    assert woman.report == json.loads(report.read_text("utf-8"))
    info = subprocess.run([anthronet_command, "info", "--json"], check=True, capture_output=True).stdout
    assert model.info() == json.loads(info)
    measured = subprocess.run([anthronet_command, "measure", file, "--json"], check=True, capture_output=True).stdout
    rows = json.loads(measured)["measures"]
    assert {row["name"]: row["value"] for row in rows} == model.measure_file(file).measures


def into(space, model_from_joint):
    """A joint of glTF space in another space: the model's axes change; the joint's own stay, or are mirrored with it."""
    model, joint = np.eye(4), np.eye(4)
    model[:3, :3] = AXES[space]
    joint[0, 0] = -1 if space == "unity" else 1
    return model @ model_from_joint @ joint


@pytest.mark.parametrize("space", AXES)
def test_mesh_spaces(uneven, space):
    """meshes: axes, winding, normals, volume"""
    axes = AXES[space]
    ours = {part.name: part for part in uneven.mesh(lod=1)}
    for layout in ("render", "model"):
        for part in uneven.mesh(space=space, layout=layout):
            faces = part.triangles if layout == "render" else part.quads
            a, b, c = (part.positions[faces[:, i]].astype(float) for i in range(3))
            # The way round that makes normals point outwards is the same as the volume's in a right-handed space;
            # in a left-handed one both axes and winding are mirrored.
            if part.name == "Body":
                triangles = faces if layout == "render" else np.r_[faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]
                p, q, r = (part.positions[triangles[:, i]].astype(float) for i in range(3))
                volume = np.einsum("ij,ij->", p, np.cross(q, r)) / 6
                assert abs(volume - uneven.volume_m3) < 1e-5, (space, layout, volume)
            agree = np.einsum("ij,ij->i", np.cross(b - a, c - a), part.normals[faces[:, 0]])
            assert (agree > 0).mean() > 0.8, (space, layout, part.name)
    for part in uneven.mesh(lod=1, space=space):
        assert np.allclose(part.positions, ours[part.name].positions @ axes.T, atol=1e-7), (space, part.name)
        assert np.allclose(part.normals, ours[part.name].normals @ axes.T, atol=1e-7)
        v = ours[part.name].uvs[:, 1]
        assert np.allclose(part.uvs[:, 1], v if space == "gltf" else 1 - v, atol=1e-6)
    body = uneven.mesh(lod=1, space=space)[0].positions
    forward, up = {"gltf": (2, 1), "blender": (1, 2), "unity": (2, 1)}[space]
    assert abs(body[:, up].min()) < 1e-3 and body[:, up].max() > 1.6, "feet on the floor, head up"
    face = body[body[:, up] > body[:, up].max() - 0.2]
    nose = face[np.abs(face[:, 0]) < 0.01][:, forward]
    front = -nose.min() if space == "blender" else nose.max()
    assert front > 0.05, "the nose points where the character looks"


@pytest.mark.parametrize("space", AXES)
def test_joint_spaces(uneven, space):
    """joints: the left hand, the longer arm, chains, inverses"""
    axes = AXES[space]
    names = uneven.joint_names()
    ours = uneven.joints()
    left, right = names.index("hand_l"), names.index("hand_r")
    joints = uneven.joints(space)
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
    local = matrices(joints["parent_from_joint"])
    for i, parent in enumerate(joints["parent"]):
        chained = local[i] if parent < 0 else joints["model_from_joint"][parent].astype(float) @ local[i]
        assert np.allclose(chained, joints["model_from_joint"][i], atol=1e-5), (space, names[i])


@pytest.mark.parametrize("space", AXES)
def test_posed_spaces(uneven, space):
    """clips and skinning give one posed surface in every space"""
    axes = AXES[space]
    walk = anthronet.builtin_clip("walk", uneven)
    ours = walk.sample(0.4, relative="model")
    surface = uneven.mesh(lod=1).skinner().skin(ours)
    pose = walk.sample(0.4, relative="model", space=space)
    assert np.allclose(matrices(pose), into(space, matrices(ours)), atol=1e-5), space
    local, parents = matrices(walk.sample(0.4, space=space)), uneven.parents
    chained = []
    for i, parent in enumerate(parents):
        chained.append(local[i] if parent < 0 else chained[parent] @ local[i])
    assert np.allclose(chained, matrices(pose), atol=1e-4), space
    positions, normals = uneven.mesh(lod=1, space=space).skinner().skin(pose)
    assert np.abs(positions - surface[0] @ axes.T).max() < 1e-5, space
    assert np.abs(normals - surface[1] @ axes.T).max() < 1e-3, space
