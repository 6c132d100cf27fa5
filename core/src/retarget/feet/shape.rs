//! The skin under heel and ball, predicted from the skeleton.
//!
//! Retargeting knows a body by its skeleton alone. As bodies are linear in the coefficients of the model, and joints are linear in
//! the body, a few distances between joints tell where each vertex of a sole is. `soles.json` has a regression on the soles of
//! 105 random bodies at level of detail 1: it is off by 0.7 mm along the floor and 0.2 mm in height, where one shape for
//! all, scaled with the foot, is off by 3.5 mm and 2 mm.

use std::sync::LazyLock;

use glam::Vec3;
use serde::Deserialize;

use crate::math::RigidTransform;
use crate::pose::Leg;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};
use crate::{Error, Result, Side};

/// Distances of a body differ from the mean by no more spreads than this; beyond it the regression is not extended.
const FARTHEST: f32 = 3.0;
/// Radius of the sole of heel or ball, metres. That of the ball is centred under its joint, that of the heel one radius
/// ahead of its back edge.
const REACH: f32 = 0.03;
/// Height of the sole of heel or ball above its lowest point at rest, metres.
const HIGHEST: f32 = 0.01;
/// Number of distances between joints.
const DISTANCES: usize = 9;

/// The regression. Positions and distances are parts of the distance from ankle to ball along the floor.
#[derive(Deserialize)]
struct Soles {
    /// Of the distances over the bodies.
    mean: [f32; DISTANCES],
    /// Their standard deviations.
    spread: [f32; DISTANCES],
    heel: Vec<Vertex>,
    ball: Vec<Vertex>,
    /// Around heel and ball, up to the toes.
    rim: Vec<Vertex>,
}

/// Weight of the ball joint, mean position, and what each distance adds to it. Positions are ahead of the ankle towards the ball,
/// up from the floor, and towards the outer side.
#[derive(Deserialize)]
#[serde(from = "Vec<f32>")]
struct Vertex {
    ball_weight: f32,
    mean: Vec3,
    slopes: [Vec3; DISTANCES],
}

impl From<Vec<f32>> for Vertex {
    fn from(row: Vec<f32>) -> Self {
        let at = |i: usize| row.get(i).copied().unwrap_or_default();
        let vector = |i: usize| Vec3::new(at(i), at(i + 1), at(i + 2));
        Self { ball_weight: at(0), mean: vector(1), slopes: std::array::from_fn(|i| vector(4 + 3 * i)) }
    }
}

static SOLES: LazyLock<std::result::Result<Soles, String>> =
    LazyLock::new(|| serde_json::from_str(include_str!("soles.json")).map_err(|e| e.to_string()));

/// A vertex of a sole at rest, in model space, and the weight of the ball joint; the remaining weight is the foot joint's.
pub(super) struct SoleVertex {
    pub(super) position: Vec3,
    pub(super) ball_weight: f32,
}

/// The skin of a sole at rest.
pub(super) struct SoleSkin {
    /// Under the heel and under the ball.
    pub(super) parts: [Vec<SoleVertex>; 2],
    /// The outline of what touches the floor at rest, without toes.
    pub(super) rim: Vec<SoleVertex>,
}

/// The skin of the sole of a leg; `model` is `model_from_joint` at rest.
///
/// # Errors
/// [`Error::Invalid`] when the table in the program is damaged.
pub(super) fn sole_skin(rest: &Skeleton, leg: &Leg, model: &[RigidTransform]) -> Result<SoleSkin> {
    let soles = SOLES.as_ref().map_err(|why| Error::invalid("soles", why.clone()))?;
    let (foot, ball) = (model[leg.limb.end].translation, model[leg.ball]);
    let forward = (ball.translation - foot).with_y(0.0);
    let (length, ahead) = (forward.length(), forward.normalize_or_zero());
    // Left feet are at +X.
    let outwards = Vec3::Y.cross(ahead) * foot.x.signum();
    let on_floor = foot.with_y(0.0);
    let tip = ball.translation + ball.rotation * leg.tip - on_floor;
    let side = if foot.x < 0.0 { Side::Right } else { Side::Left };
    let joint = |joint: RigJoint| rest.rig_joint(joint).map(|j| model[j].translation.z - foot.z);
    let distances: [Option<f32>; DISTANCES] = [
        Some(foot.y),
        Some(ball.translation.y),
        Some(tip.dot(ahead) - length),
        Some(tip.y),
        Some(tip.dot(outwards)),
        Some(model[leg.limb.lower].translation.z - foot.z),
        Some(model[leg.limb.upper].translation.z - foot.z),
        joint(SidedJoint::Upperarm.on(side)),
        joint(RigJoint::Head),
    ];
    let unusual: [f32; DISTANCES] = std::array::from_fn(|i| {
        let most = FARTHEST * soles.spread[i];
        distances[i].map_or(0.0, |distance| (distance / length - soles.mean[i]).clamp(-most, most))
    });
    let place = |vertex: &Vertex| {
        let offsets = vertex.slopes.iter().zip(unusual).map(|(slope, unusual)| *slope * unusual);
        let at = (vertex.mean + offsets.sum::<Vec3>()) * length;
        let position = on_floor + ahead * at.x + Vec3::Y * at.y + outwards * at.z;
        SoleVertex { position, ball_weight: vertex.ball_weight }
    };
    let heel: Vec<SoleVertex> = soles.heel.iter().map(place).collect();
    let back = heel.iter().map(|v| (v.position - on_floor).dot(ahead)).fold(f32::INFINITY, f32::min);
    let ball_of = soles.ball.iter().map(place).collect();
    let parts = [within(heel, on_floor + ahead * (back + REACH)), within(ball_of, ball.translation)];
    Ok(SoleSkin { parts, rim: soles.rim.iter().map(place).collect() })
}

/// The vertices near the centre that are nearly as low as the lowest of them.
fn within(mut vertices: Vec<SoleVertex>, centre: Vec3) -> Vec<SoleVertex> {
    vertices.retain(|vertex| (vertex.position - centre).with_y(0.0).length() < REACH);
    let lowest = vertices.iter().map(|vertex| vertex.position.y).fold(f32::INFINITY, f32::min);
    vertices.retain(|vertex| vertex.position.y < lowest + HIGHEST);
    vertices
}
