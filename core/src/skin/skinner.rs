//! The skinned surface, and the parallel work of posing it.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use super::SkinContext;
use super::block::{Blocks, CHUNK_VERTICES, Chunk};
use super::buffers::{SurfaceMut, Target};
use super::palette::Palette;
use super::rigid::in_double;
use crate::math::RigidTransform;
use crate::math::RigidTransformF64;
use crate::skeleton::Influences;
use crate::{Error, Result};

/// Maximum number of influences per vertex; files have 4 or 8.
const MAX_INFLUENCES: usize = 64;

/// How joints move vertices; see the [module](crate::skin) for the formulas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SkinMethod {
    /// Linear blend skinning, as in glTF, UsdSkel and game engines. Strongly rotated joints collapse.
    #[default]
    Linear,
    /// Dual quaternions, Blender's *Preserve Volume*: keeps the girth of twisted limbs, bulges at bent joints.
    DualQuaternion,
    /// The paper's own formula: joints translate vertices but do not rotate them. Without offsets trained for it, poses are
    /// centimetres wrong.
    JointTranslation,
}

/// A surface in its bind pose with the influences of each vertex. Immutable.
#[derive(Clone, Debug)]
pub struct Skinner {
    vertex_count: usize,
    /// Bind `joint_from_model` of each joint.
    joint_from_model: Vec<RigidTransformF64>,
    blocks: Blocks,
}

/// One character to skin: its surface, pose and destination.
#[derive(Debug)]
pub struct SkinJob<'a> {
    /// The surface.
    pub skinner: &'a Skinner,
    /// The formula.
    pub method: SkinMethod,
    /// The pose: posed `model_from_joint` of every joint, see [`Pose::model_from_joints`](crate::skeleton::Pose).
    pub model_from_joints: &'a [RigidTransform],
    /// Added to the bind positions before they are posed: correctives. One per vertex, metres.
    pub offsets: Option<&'a [Vec3]>,
    /// The destination.
    pub out: SurfaceMut<'a>,
}

impl Skinner {
    /// Makes a skinner of positions (metres) and unit normals in the bind pose, influences per vertex, and the joints' bind
    /// `model_from_joint`. The weights of each vertex are normalised.
    ///
    /// # Errors
    /// [`Error::Invalid`] when arrays differ in length, a number is not finite, a joint does not exist, or the weights
    /// of a vertex are negative or far from summing to one.
    pub fn new(
        positions: &[Vec3],
        normals: &[Vec3],
        influences: &Influences,
        model_from_joints: &[RigidTransform],
    ) -> Result<Self> {
        let count = positions.len();
        let expect = |what, expected: usize, got: usize| match expected == got {
            true => Ok(()),
            false => {
                Err(Error::invalid(what, format!("expected {expected} for {count} vertices, got {got}")))
            }
        };
        expect("normals", count, normals.len())?;
        if !(1..=MAX_INFLUENCES).contains(&influences.per_vertex) {
            let got = influences.per_vertex;
            let message = format!("expected 1 to {MAX_INFLUENCES} influences per vertex, got {got}");
            return Err(Error::invalid("skin weights", message));
        }
        let slots = count.saturating_mul(influences.per_vertex);
        expect("skin joints", slots, influences.joints.len())?;
        expect("skin weights", slots, influences.weights.len())?;
        finite("positions", positions)?;
        finite("normals", normals)?;
        let mut bind = Vec::new();
        in_double("bind pose", model_from_joints, &mut bind)?;
        Ok(Self {
            vertex_count: count,
            joint_from_model: bind.iter().map(|joint| joint.inverse()).collect(),
            blocks: Blocks::new(positions, normals, influences, model_from_joints.len())?,
        })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        self.joint_from_model.len()
    }

    /// Poses the surface: [`skin_many`] for one character without offsets.
    ///
    /// # Errors
    /// As [`skin_many`].
    pub fn skin(
        &self,
        method: SkinMethod,
        model_from_joints: &[RigidTransform],
        out: SurfaceMut<'_>,
        context: &mut SkinContext,
    ) -> Result<()> {
        let job = SkinJob { skinner: self, method, model_from_joints, offsets: None, out };
        let mut palette = context.palettes.pop().unwrap_or_default();
        let prepared = CheckedJob::new(job, &mut palette, &mut context.posed);
        let skinned = prepared.map(|prepared| run(vec![prepared]));
        context.palettes.push(palette);
        skinned
    }
}

/// Poses many characters, distributed over the threads of the pool. Nothing is written unless all jobs are valid.
///
/// # Errors
/// [`Error::Invalid`] when a job has another number of joints or offsets than its skinner, a number is not finite, a
/// rotation is not of unit length, or a buffer is too small for its offset and stride; the message counts characters
/// from 0.
pub fn skin_many(jobs: Vec<SkinJob<'_>>, context: &mut SkinContext) -> Result<()> {
    let SkinContext { posed, palettes } = context;
    if palettes.len() < jobs.len() {
        palettes.resize_with(jobs.len(), Palette::default);
    }
    let prepared = jobs.into_iter().zip(palettes).enumerate().map(|(i, (job, palette))| {
        CheckedJob::new(job, palette, posed).map_err(|error| match error {
            Error::Invalid { what, message } => Error::invalid(what, format!("character {i}: {message}")),
            other => other,
        })
    });
    run(prepared.collect::<Result<_>>()?);
    Ok(())
}

/// A job whose input and buffers have been checked.
struct CheckedJob<'a> {
    skinner: &'a Skinner,
    palette: &'a Palette,
    offsets: Option<&'a [Vec3]>,
    targets: Vec<Target<'a>>,
}

impl<'a> CheckedJob<'a> {
    fn new(job: SkinJob<'a>, palette: &'a mut Palette, posed: &mut Vec<RigidTransformF64>) -> Result<Self> {
        let SkinJob { skinner, method, model_from_joints, offsets, out } = job;
        let (expected, got) = (skinner.joint_count(), model_from_joints.len());
        if expected != got {
            return Err(Error::invalid("pose", format!("expected {expected} joints, got {got}")));
        }
        in_double("pose", model_from_joints, posed)?;
        palette.fill(method, posed, &skinner.joint_from_model);
        if let Some(offsets) = offsets {
            if offsets.len() != skinner.vertex_count {
                let message = format!("expected {} vertices, got {}", skinner.vertex_count, offsets.len());
                return Err(Error::invalid("offsets", message));
            }
            finite("offsets", offsets)?;
        }
        Ok(Self { skinner, palette, offsets, targets: out.into_chunks(skinner.vertex_count)? })
    }
}

fn run(mut characters: Vec<CheckedJob<'_>>) {
    let mut work = Vec::new();
    for character in &mut characters {
        let CheckedJob { skinner, palette, offsets, targets } = character;
        let mut offsets = offsets.map(|all| all.chunks(CHUNK_VERTICES));
        for (chunk, target) in skinner.blocks.chunks().zip(targets) {
            work.push((*palette, chunk, offsets.as_mut().and_then(Iterator::next), target));
        }
    }
    let skin =
        |(palette, chunk, offsets, target): (&Palette, Chunk<'_>, Option<&[Vec3]>, &mut Target<'_>)| {
            #[cfg(feature = "test-hooks")]
            super::test_hooks::before_a_chunk();
            palette.skin(chunk, offsets, target);
        };
    if work.len() > 1 && pool_has_threads() {
        work.into_par_iter().for_each(skin);
    } else {
        work.into_iter().for_each(skin);
    }
}

/// Whether the pool's threads exist in this process: a child made by `fork` has the pool's memory but none of its threads,
/// and would wait for them forever.
fn pool_has_threads() -> bool {
    /// The first process that posed in parallel; 0 before.
    static OWNER: AtomicU32 = AtomicU32::new(0);
    let here = std::process::id();
    match OWNER.compare_exchange(0, here, Ordering::Relaxed, Ordering::Relaxed) {
        Ok(_) => true,
        Err(owner) => owner == here,
    }
}

fn finite(what: &'static str, vectors: &[Vec3]) -> Result<()> {
    match vectors.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(v) => {
            Err(Error::invalid(what, format!("vertex {v}: expected finite numbers, got {}", vectors[v])))
        }
    }
}
