//! What all bodies share: topology, levels of detail, accessories, joint tree and skin weights.

use std::sync::{Arc, OnceLock};

use glam::Vec3;

use crate::measure::{Definitions, Skin, Standing};
use crate::mesh::{Lod, Subdivision, Topology, VertexFaces};
use crate::skeleton::{JointTree, SkinWeights};
use crate::{Error, Result};

/// A submesh that moves with the body: eyes, teeth, tongue or lashes.
#[derive(Clone, Debug, PartialEq)]
pub struct Accessory {
    /// `eyes`, `teeth`, `tongue` or `lashes`.
    pub name: String,
    /// Index of its first point among the points of the shape space.
    pub start: usize,
    /// Topology over its own vertices.
    pub topology: Topology,
}

/// A level of detail below the cage: triangles over a subset of the cage's vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReducedMesh {
    /// The cage vertices in use, ascending.
    pub vertices: Vec<u32>,
    /// Triangles of indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the corners, as indices into the cage's.
    pub triangle_uvs: Vec<[u32; 3]>,
}

/// What all bodies share: everything but positions and normals.
#[derive(Debug)]
pub struct Character {
    cage: Topology,
    subdivision: Subdivision,
    faces_around: VertexFaces,
    reduced: [ReducedMesh; 2],
    accessories: Vec<Accessory>,
    joint_tree: Arc<JointTree>,
    /// Points of the mean body, metres: cage, then accessories.
    mean: Vec<Vec3>,
    /// Skin weights of the same points.
    weights: SkinWeights,
    refined_weights: OnceLock<Result<SkinWeights>>,
}

impl Character {
    /// Assembles a character. `weights` and `mean` (metres, model space) have one row per point: those of the cage, then those
    /// of the accessories in order.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the part that is inconsistent or of another size.
    pub fn new(
        cage: Topology,
        reduced: [ReducedMesh; 2],
        accessories: Vec<Accessory>,
        joint_tree: Arc<JointTree>,
        weights: SkinWeights,
        mean: Vec<Vec3>,
    ) -> Result<Self> {
        let mut points = cage.vertex_count;
        for accessory in &accessories {
            accessory.topology.validate()?;
            if accessory.start != points {
                return Err(Error::invalid("accessory", format!("{} does not follow", accessory.name)));
            }
            points += accessory.topology.vertex_count;
        }
        if weights.len() != points {
            return Err(Error::invalid(
                "skin weights",
                format!("expected {points} vertices, got {}", weights.len()),
            ));
        }
        if mean.len() != points {
            return Err(Error::invalid("mean body", format!("expected {points} points, got {}", mean.len())));
        }
        // After the checks of size: it allocates by the cage's number of vertices.
        let subdivision = Subdivision::new(&cage)?;
        for mesh in &reduced {
            let fits = mesh.triangles.len() == mesh.triangle_uvs.len()
                && mesh.vertices.iter().all(|v| (*v as usize) < cage.vertex_count)
                && mesh.vertices.is_sorted()
                && mesh.triangles.iter().flatten().all(|v| (*v as usize) < mesh.vertices.len())
                && mesh.triangle_uvs.iter().flatten().all(|t| (*t as usize) < cage.uvs.len());
            if !fits {
                return Err(Error::invalid("level of detail", "indices out of range"));
            }
        }
        let refined = subdivision.refined();
        let faces_around = VertexFaces::new(refined.vertex_count, &refined.quads);
        let refined_weights = OnceLock::new();
        Ok(Self {
            cage,
            subdivision,
            faces_around,
            reduced,
            accessories,
            joint_tree,
            mean,
            weights,
            refined_weights,
        })
    }

    /// The cage, which is also the topology of LOD 1.
    pub fn cage(&self) -> &Topology {
        &self.cage
    }

    /// The subdivision of the cage that gives LOD 0.
    pub fn subdivision(&self) -> &Subdivision {
        &self.subdivision
    }

    /// Faces around the vertices of LOD 0.
    pub fn faces_around(&self) -> &VertexFaces {
        &self.faces_around
    }

    /// The index lists of LODs 2 and 3; `None` for the others.
    pub fn reduced(&self, lod: Lod) -> Option<&ReducedMesh> {
        match lod {
            Lod::Lod0 | Lod::Lod1 => None,
            Lod::Lod2 => Some(&self.reduced[0]),
            Lod::Lod3 => Some(&self.reduced[1]),
        }
    }

    /// Number of the body's vertices at a level of detail, without accessories.
    pub fn vertex_count(&self, lod: Lod) -> usize {
        match self.reduced(lod) {
            Some(mesh) => mesh.vertices.len(),
            None if lod == Lod::Lod0 => self.subdivision.refined().vertex_count,
            None => self.cage.vertex_count,
        }
    }

    /// Eyes, teeth, tongue and lashes, in the order of their points.
    pub fn accessories(&self) -> &[Accessory] {
        &self.accessories
    }

    /// Names and parents of the joints; the first is the only root.
    pub fn joint_tree(&self) -> &Arc<JointTree> {
        &self.joint_tree
    }

    /// Number of points of cage and accessories, which the shape space must have too.
    pub fn point_count(&self) -> usize {
        self.weights.len()
    }

    /// Points of an accessory of the mean body, metres: for decisions that have to be the same for all bodies.
    pub fn accessory_mean(&self, accessory: &Accessory) -> &[Vec3] {
        let end = accessory.start + accessory.topology.vertex_count;
        self.mean.get(accessory.start..end).unwrap_or_default()
    }

    /// Skin weights of an accessory.
    pub fn accessory_weights(&self, accessory: &Accessory) -> SkinWeights {
        self.weights.rows(accessory.start..accessory.start + accessory.topology.vertex_count)
    }

    /// The definitions of the measures, for bodies with this skin.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the joint tree lacks a joint that turns from the T-pose to the standing body.
    pub(crate) fn definitions(&self) -> Result<Definitions> {
        let weights = |vertex: u32| self.weights.refined(&self.subdivision, vertex as usize);
        let (joints, parents) = (self.joint_tree.names(), self.joint_tree.parents());
        Definitions::embedded(&Standing::embedded(Skin { joints, parents, weights: &weights })?)
    }

    /// Skin weights of the body at LOD 0; the first rows are those of LOD 1.
    ///
    /// # Errors
    /// None for a character that [`Character::new`] accepted.
    pub fn body_weights(&self) -> Result<&SkinWeights> {
        let made = self
            .refined_weights
            .get_or_init(|| self.weights.rows(0..self.cage.vertex_count).refine(&self.subdivision));
        made.as_ref().map_err(|e| Error::invalid("skin weights", e.to_string()))
    }
}
