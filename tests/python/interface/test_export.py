"""Files of every format, on the disk and in memory."""

import anthronet
import pytest
from support import raised_by, raises


HEADS = {"glb": b"glTF", "vrm": b"glTF", "usda": b"#usda", "usdc": b"PXR-USDC", "usdz": b"PK", "obj": b""}


@pytest.fixture(scope="module")
def clips(woman):
    return [anthronet.builtin_clip(name, woman) for name in ("walk", "wave")]


@pytest.mark.parametrize("format", HEADS)
def test_formats(woman, tmp_path, format):
    """the same bytes in memory and on the disk"""
    data = woman.to_bytes(format, lod=3)
    file = tmp_path / f"python.{format}"
    woman.save(file, lod=3)
    assert data.startswith(HEADS[format]) and file.read_bytes() == data


def test_options(woman, clips, tmp_path):
    """clips, names of joints and the other options of a file"""
    moving = woman.to_bytes("glb", lod=3, clips=clips, joint_names="mixamo")
    assert b'"mixamorig:Hips"' in moving and b'"walk"' in moving and b'"wave"' in moving
    assert b'"walk 2"' in woman.to_bytes("glb", lod=3, clips=[clips[0], clips[0]])
    assert len(woman.to_bytes("glb", lod=2, compress=True)) < len(woman.to_bytes("glb", lod=2)) * 0.7
    assert len(woman.to_bytes("glb", lod=3, body_only=True)) < len(woman.to_bytes("glb", lod=3))
    assert len(woman.to_bytes("glb", lod=3, influences=8)) > len(woman.to_bytes("glb", lod=3))
    assert woman.to_bytes("glb", lod=3, skin_tone=9) != woman.to_bytes("glb", lod=3)
    assert b'"posed":true' in woman.to_bytes("glb", lod=3, pose="sitting", clips=clips)
    assert woman.to_bytes("obj", lod=3, pose="sitting") != woman.to_bytes("obj", lod=3)
    assert woman.to_bytes("glb", lod=3, pose="t-pose") == woman.to_bytes("glb", lod=3)
    woman.save(str(tmp_path / "umläut 人.gltf").encode(), lod=3)
    assert (tmp_path / "umläut 人.gltf").is_file() and (tmp_path / "umläut 人.bin").is_file()


def test_refusals(woman, clips, tmp_path):
    """what cannot be written is refused, and no file is left"""
    for bad in (lambda: woman.to_bytes("fbx"), lambda: woman.save(tmp_path / "a.fbx"), lambda: woman.save(tmp_path),
                lambda: woman.save(tmp_path / "no folder" / "a.glb"),
                lambda: woman.to_bytes("vrm", lod=3, pose="sitting"), lambda: woman.to_bytes("glb", lod=3, pose="lotus"),
                lambda: woman.to_bytes("glb", influences=3), lambda: woman.save(tmp_path / "a\0b.glb")):
        assert isinstance(raised_by(bad), anthronet.Error), bad
    raises(TypeError, lambda: woman.to_bytes("glb", clips=clips[0]), "clips", "list")
    raises(TypeError, lambda: woman.to_bytes("glb", clips=["walk"]), "clips", "Clip")
    raises(TypeError, lambda: woman.to_bytes("glb", pose=1), "pose")
    raises(TypeError, lambda: woman.save(None), "path")
    raises(ValueError, lambda: woman.save("a.glb", joint_names="maya"), "joint_names")
    assert not list(tmp_path.iterdir())
