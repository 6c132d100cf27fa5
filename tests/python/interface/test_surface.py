"""Skeletons, meshes, blend shapes and skinning."""

import anthronet
import numpy as np
import pytest
from support import raised_by, raises


def test_skeleton(woman, model):
    """joints, names in every vocabulary, humanoid bones"""
    joints, names = woman.joints(), woman.joint_names()
    assert joints.dtype == anthronet.JOINT and len(joints) == len(names) == woman.joint_count == len(set(names))
    assert np.array_equal(woman.parents, joints["parent"]) and woman.parents[0] == -1
    assert (woman.parents < np.arange(len(joints))).all()
    assert names == tuple(joint["name"] for joint in model.info()["joints"])
    bones = {bone.native: bone for bone in anthronet.HUMANOID_BONES}
    assert len(bones) == 55 and sum(bone.required for bone in bones.values()) >= 15
    for vocabulary in ("unity", "mixamo", "vrm", "blender"):
        for native, name in zip(names, woman.joint_names(vocabulary)):
            if native in bones:
                assert name == getattr(bones[native], vocabulary), (vocabulary, native, name)
    assert bones["upperarm_l"].mixamo == "mixamorig:LeftArm" and bones["upperarm_l"].unity_trait == "LeftUpperArm"
    raises(ValueError, lambda: woman.joint_names("maya"), "names", "maya")
    raises(ValueError, lambda: woman.joints("maya"), "space", "maya")
    raises(TypeError, lambda: woman.joints([]), "space")


def test_mesh(woman, model):
    """meshes: parts, levels of detail, arguments"""
    mesh = woman.mesh()
    assert [part.name for part in mesh][:2] == ["Body", "Eyes"] and len(mesh) == len(mesh.parts) == 7
    assert mesh[0].name == "Body" and 0 < mesh[0].roughness <= 1 and len(mesh[0].base_color) == 4
    assert any(part.double_sided for part in mesh), "lashes are seen from both sides"
    assert [len(woman.mesh(lod=lod, layout="model", body_only=True)[0].positions) for lod in range(4)] == [
        model.vertex_count(lod) for lod in range(4)]
    assert len(woman.mesh(lod=3, body_only=True)) == 1
    assert np.array_equal(mesh[0].read("positions"), mesh[0].positions)
    assert woman.mesh(lod=3, skin_tone=10)[0].base_color != woman.mesh(lod=3, skin_tone=1)[0].base_color
    for name, value in (("lod", 4), ("skin_tone", 11)):
        raises(anthronet.ArgumentError, lambda: woman.mesh(**{name: value}), name)
    assert isinstance(raised_by(lambda: woman.mesh(influences=5)), anthronet.Error)
    for name, value, kind in (("lod", 1.5, TypeError), ("lod", 2**32, ValueError), ("lod", "1", TypeError),
                              ("space", "maya", ValueError), ("layout", "x", ValueError), ("body_only", 1, TypeError)):
        raises(kind, lambda: woman.mesh(**{name: value}), name)


@pytest.mark.parametrize("layout, influences", [("render", 4), ("model", 8)])
def test_layouts(woman, layout, influences):
    """arrays of a layout: shapes, types, weights"""
    for part in woman.mesh(lod=1, influences=influences, layout=layout):
        count = part.vertex_count
        assert part.positions.shape == part.normals.shape == (count, 3) and part.positions.dtype == np.float32
        assert np.allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-4)
        assert part.joints.shape == part.weights.shape == (count, influences) and part.joints.dtype == np.uint16
        assert np.allclose(part.weights.sum(1), 1, atol=1e-5) and (np.diff(part.weights, axis=1) <= 0).all()
        assert part.joints.max() < woman.joint_count and part.sources.shape == (count,)
        faces, uvs = (part.triangles, None) if layout == "render" else (part.quads, part.quad_uvs)
        assert faces.max() == count - 1 and faces.dtype == np.uint32
        if layout == "render":
            assert part.uvs.shape == (count, 2) and part.quads.shape == (0, 4) == part.quad_uvs.shape
        else:
            assert uvs.shape == faces.shape and uvs.max() < len(part.uvs) and part.uvs.shape[1] == 2
            assert part.triangles.shape == (0, 3) == part.triangle_uvs.shape


def test_blend_shapes(woman, heavy):
    """blend shapes lead to the other body's surface"""
    mesh, other = woman.mesh(lod=1), heavy.mesh(lod=1)
    mesh.add_blend_shape("heavy", heavy)
    mesh.add_blend_shape("heaviér", heavy)
    assert mesh.blend_shapes == ("heavy", "heaviér")
    for part, there in zip(mesh, other):
        for shape in ("heavy", 1):
            assert np.allclose(part.positions + part.blend_shape(shape), there.positions, atol=1e-6)
            assert np.allclose(part.normals + part.blend_shape(shape, "normals"), there.normals, atol=1e-6)
            assert np.array_equal(part.read_blend_shape(shape), part.blend_shape(shape))
    view = mesh[0].blend_shape(0)
    mesh.update(heavy)
    assert mesh.blend_shapes == () and np.abs(view).max() > 0.01
    raises(anthronet.InvalidError, lambda: mesh.add_blend_shape("", heavy))
    raises(TypeError, lambda: mesh.add_blend_shape("x", 3), "body", "int")
    raises(ValueError, lambda: mesh[0].blend_shape("x"), "shape", "x")
    raises(anthronet.ArgumentError, lambda: mesh[0].blend_shape(0), "shape")
    mesh.add_blend_shape("x", woman)
    raises(ValueError, lambda: mesh[0].blend_shape("x", "uvs"), "attribute", "uvs")
