//! The scene's meshes as plain arrays in a given space, to be drawn by graphics hardware or edited.

use glam::Vec3;

use super::morph::MorphTarget;
use super::scene::{Corners, Scene, SceneMaterial, SceneMesh, flip_v};
use super::split::SplitMesh;
use crate::skeleton::Influences;
use crate::space::Space;
use crate::{Error, Result};

/// The vertices and faces of a buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// For drawing: triangles only, and one texture coordinate per vertex, so that vertices at seams are duplicated.
    #[default]
    Render,
    /// For editing and measuring: the model's own vertices and quads, with texture coordinates per corner.
    Model,
}

/// A mesh of the scene with its material and skin. Metres, in the space given to [`Scene::into_buffers`].
#[derive(Clone, Debug)]
pub struct MeshBuffers {
    /// Name, such as `Body`.
    pub name: String,
    /// The mesh's material.
    pub material: SceneMaterial,
    /// `(V, 3)`, metres.
    pub positions: Vec<[f32; 3]>,
    /// `(V, 3)`, unit length, or empty for none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates: `(V, 2)` in the render layout, else `(T, 2)`, indexed by the corners of faces. v points down in
    /// the library's own space, as in glTF, and up in Blender's and Unity's.
    pub uvs: Vec<[f32; 2]>,
    /// Vertices of the triangles; in the model layout, of the faces that are not quads.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the triangles' corners; empty in the render layout.
    pub triangle_uvs: Vec<[u32; 3]>,
    /// Vertices of the quads; empty in the render layout.
    pub quads: Vec<[u32; 4]>,
    /// Texture coordinates of the quads' corners; empty in the render layout.
    pub quad_uvs: Vec<[u32; 4]>,
    /// The mesh's own vertex that each vertex is a copy of, `(V)`.
    pub sources: Vec<u32>,
    /// Joints and weights of each vertex.
    pub influences: Influences,
    /// Morph targets, of `(V, 3)` displacements each.
    pub morph_targets: Vec<MorphTarget>,
}

impl Scene {
    /// The meshes as buffers in this layout and space, in order.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a mesh has no material.
    pub fn into_buffers(self, layout: Layout, space: Space) -> Result<Vec<MeshBuffers>> {
        let Self { meshes, materials, .. } = self;
        let buffers = meshes.into_iter().map(|mesh| {
            let material = materials.get(mesh.material as usize).cloned().ok_or_else(|| {
                Error::invalid(
                    "mesh",
                    format!("`{}` has material {}, which is not there", mesh.name, mesh.material),
                )
            })?;
            let mut buffers = match layout {
                Layout::Render => MeshBuffers::split(mesh, material),
                Layout::Model => MeshBuffers::whole(mesh, material),
            };
            buffers.convert_to(space);
            Ok(buffers)
        });
        buffers.collect()
    }
}

impl MeshBuffers {
    /// The displacements from this surface to that of another body, at the same level of detail and in the same layout and
    /// space.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the two do not have the same vertices.
    pub fn blend_shape(&self, name: impl Into<String>, other: &Self) -> Result<MorphTarget> {
        if self.sources != other.sources {
            let (ours, theirs) = (self.positions.len(), other.positions.len());
            let message = format!("`{}`: expected the same {ours} vertices, got {theirs}", self.name);
            return Err(Error::invalid("blend shape", message));
        }
        let displacements = |from: &[[f32; 3]], to: &[[f32; 3]]| {
            from.iter().zip(to).map(|(a, b)| std::array::from_fn(|i| b[i] - a[i])).collect()
        };
        Ok(MorphTarget {
            name: name.into(),
            positions: displacements(&self.positions, &other.positions),
            normals: displacements(&self.normals, &other.normals),
        })
    }

    fn split(mesh: SceneMesh, material: SceneMaterial) -> Self {
        let split = SplitMesh::new(&mesh);
        let per_vertex = mesh.influences_per_vertex;
        let source = || split.source.iter().map(|v| *v as usize);
        let rows = || source().map(|v| v * per_vertex..(v + 1) * per_vertex);
        let of_sources = |rows: &[[f32; 3]]| source().filter_map(|v| rows.get(v).copied()).collect();
        let target = |target: &MorphTarget| MorphTarget {
            name: target.name.clone(),
            positions: of_sources(&target.positions),
            normals: of_sources(&target.normals),
        };
        Self {
            morph_targets: mesh.morph_targets.iter().map(target).collect(),
            positions: source().map(|v| mesh.positions[v]).collect(),
            normals: source().filter_map(|v| mesh.normals.get(v).copied()).collect(),
            uvs: split.uvs(&mesh),
            triangle_uvs: Vec::new(),
            quads: Vec::new(),
            quad_uvs: Vec::new(),
            influences: Influences {
                per_vertex,
                joints: rows().flat_map(|r| mesh.joint_indices[r].iter().copied()).collect(),
                weights: rows().flat_map(|r| mesh.joint_weights[r].iter().copied()).collect(),
            },
            triangles: split.triangles,
            sources: split.source,
            name: mesh.name,
            material,
        }
    }

    fn whole(mesh: SceneMesh, material: SceneMaterial) -> Self {
        let Corners { positions: quads, uvs: quad_uvs } = mesh.quads;
        let Corners { positions: triangles, uvs: triangle_uvs } = mesh.triangles;
        Self {
            sources: (0..mesh.positions.len() as u32).collect(),
            positions: mesh.positions,
            normals: mesh.normals,
            morph_targets: mesh.morph_targets,
            uvs: mesh.uvs,
            triangles,
            triangle_uvs,
            quads,
            quad_uvs,
            influences: Influences {
                per_vertex: mesh.influences_per_vertex,
                joints: mesh.joint_indices,
                weights: mesh.joint_weights,
            },
            name: mesh.name,
            material,
        }
    }

    /// Converts from the library's own space.
    fn convert_to(&mut self, space: Space) {
        if space == Space::Gltf {
            return;
        }
        let offsets =
            self.morph_targets.iter_mut().flat_map(|t| t.positions.iter_mut().chain(&mut t.normals));
        for vector in self.positions.iter_mut().chain(&mut self.normals).chain(offsets) {
            *vector = space.from_ours(Vec3::from_array(*vector)).to_array();
        }
        self.uvs.iter_mut().for_each(|uv| *uv = flip_v(*uv));
        if space.flips_winding() {
            self.triangles.iter_mut().chain(&mut self.triangle_uvs).for_each(|face| face.swap(1, 2));
            self.quads.iter_mut().chain(&mut self.quad_uvs).for_each(|face| face.swap(1, 3));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene::{arm, bulging};

    /// Six times the volume of the tetrahedra from the origin, with the sign of the winding.
    fn signed_volume(buffers: &MeshBuffers) -> f32 {
        let at = |v: u32| Vec3::from_array(buffers.positions[v as usize]);
        let quads = buffers.quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
        quads.chain(buffers.triangles.iter().copied()).map(|[a, b, c]| at(a).cross(at(b)).dot(at(c))).sum()
    }

    #[test]
    fn every_space_and_layout_is_the_same_surface() {
        let first = |layout, space| arm(4).into_buffers(layout, space).unwrap().swap_remove(0);
        let ours = first(Layout::Model, Space::Gltf);
        let volume = signed_volume(&ours);
        assert!(volume.abs() > 0.0);
        for layout in [Layout::Render, Layout::Model] {
            for space in [Space::Gltf, Space::Blender, Space::Unity] {
                let there = first(layout, space);
                // The reflection changes the sign of the volume, reversed faces change it back.
                assert!((signed_volume(&there) - volume).abs() < 1e-4 * volume.abs(), "{layout:?} {space:?}");
                assert_eq!(there.sources.len(), there.positions.len());
                assert_eq!(
                    there.influences.weights.len(),
                    there.positions.len() * there.influences.per_vertex
                );
                for (vertex, source) in there.sources.iter().enumerate() {
                    let back = space.to_ours(Vec3::from_array(there.positions[vertex]));
                    assert_eq!(back.to_array(), ours.positions[*source as usize]);
                }
            }
        }
    }

    #[test]
    fn a_blend_shape_is_the_difference_to_the_other_body() {
        let one = arm(4).into_buffers(Layout::Render, Space::Blender).unwrap().swap_remove(0);
        let mut scene = arm(4);
        scene.meshes[0].positions[1][0] += 0.5;
        let other = scene.into_buffers(Layout::Render, Space::Blender).unwrap().swap_remove(0);
        let shape = one.blend_shape("wide", &other).unwrap();
        for (vertex, source) in one.sources.iter().enumerate() {
            let expected = if *source == 1 { [0.5, 0.0, 0.0] } else { [0.0; 3] };
            assert_eq!(shape.positions[vertex], expected);
        }
        let mut fewer = other;
        fewer.sources.pop();
        assert!(one.blend_shape("wide", &fewer).is_err());
    }

    #[test]
    fn morph_targets_follow_layout_and_space() {
        for layout in [Layout::Render, Layout::Model] {
            let meshes = bulging(arm(4)).into_buffers(layout, Space::Blender).unwrap();
            let (cushion, scene) = (&meshes[2], bulging(arm(4)));
            assert_eq!(cushion.sources.len(), if layout == Layout::Render { 8 } else { 6 });
            for (there, ours) in cushion.morph_targets.iter().zip(&scene.meshes[2].morph_targets) {
                assert_eq!(there.name, ours.name);
                for (offset, source) in there.positions.iter().zip(&cushion.sources) {
                    let back = Space::Blender.to_ours(Vec3::from_array(*offset));
                    assert_eq!(back.to_array(), ours.positions[*source as usize]);
                }
            }
        }
    }

    #[test]
    fn a_mesh_without_its_material_is_refused() {
        let mut scene = arm(4);
        scene.materials.clear();
        let message = scene.into_buffers(Layout::Render, Space::Gltf).unwrap_err().to_string();
        assert!(message.contains("material 0"), "{message}");
    }
}
