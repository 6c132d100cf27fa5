//! Sliding and sinking of feet, measured on the skin of the soles, frame by frame.

use std::ops::Range;

use anthronet::clip::Clip;
use anthronet::mesh::Lod;
use anthronet::retarget::feet::{Contact, Contacts, FootPoint};
use anthronet::scene::{Scene, SceneOptions};
use anthronet::skeleton::{Influences, Pose, SidedJoint, Skeleton};
use anthronet::skin::{SkinContext, SkinMethod, Skinner, SurfaceMut};
use anthronet::{Body, Side};
use glam::Vec3;

use crate::failure::{Failure, Result};

/// Height of the sole of heel or ball above its lowest vertex in the rest pose, metres.
const SOLE: f32 = 0.01;
/// Radius of the sole of heel or ball, metres. That of the ball is centred under its joint, that of the heel one radius
/// ahead of its back edge.
const REACH: f32 = 0.03;
/// Vertices up to this height above the lowest one stand on the floor with it, metres.
const TOUCHING: f32 = 0.005;
/// Duration of a stride at a comfortable walk, seconds.
const STRIDE: f64 = 1.1;

/// The skin of both feet at level of detail 1, with four influences per vertex as in files.
pub(super) struct Soles {
    skinner: Skinner,
    feet: [Foot; 2],
}

struct Foot {
    /// Vertices influenced by the foot or ball joint.
    vertices: Range<usize>,
    /// Vertices of the sole under the heel and under the ball.
    under: [Vec<usize>; 2],
}

/// The skin of the feet over a clip; the worse foot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkinMeasure {
    /// Depth of the lowest vertex under the floor, metres; 0 when none is below.
    pub(super) deepest: f32,
    /// The longest path over the floor, within a stride and a contact, of the centre of the skin that stands on it, metres.
    pub(super) slide: f32,
    /// Number of vertices with coordinates that are not finite, over all frames.
    pub(super) not_finite: usize,
}

impl Soles {
    pub(super) fn of(body: &Body, skeleton: &Skeleton) -> Result<Self> {
        let scene = Scene::from_body(body, &SceneOptions { lod: Lod::Lod1, ..SceneOptions::default() })?;
        let mesh = scene.meshes.first().ok_or_else(|| Failure::failed("the scene has no body"))?;
        let model = skeleton.model_from_joints();
        let mut feet = Vec::new();
        let mut kept: Vec<usize> = Vec::new();
        for side in Side::ALL {
            let joint = |joint: SidedJoint| skeleton.require_rig_joint(joint.on(side));
            let joints = [joint(SidedJoint::Foot)?, joint(SidedJoint::Ball)?];
            let follows = |v: &usize| {
                mesh.influences(*v).any(|(joint, w)| w > 0.0 && joints.contains(&usize::from(joint)))
            };
            let first = kept.len();
            kept.extend((0..mesh.positions.len()).filter(follows));
            let positions: Vec<_> = kept[first..].iter().map(|&v| Vec3::from(mesh.positions[v])).collect();
            let [ankle, ball] = joints.map(|joint| model[joint].translation);
            feet.push(Foot::new(first, &positions, ankle, ball));
        }
        let pick = |of: &[[f32; 3]]| kept.iter().map(|&v| Vec3::from(of[v])).collect::<Vec<_>>();
        let influences = Influences {
            per_vertex: mesh.influences_per_vertex,
            joints: kept.iter().flat_map(|&v| mesh.influences(v).map(|(joint, _)| joint)).collect(),
            weights: kept.iter().flat_map(|&v| mesh.influences(v).map(|(_, weight)| weight)).collect(),
        };
        let skinner = Skinner::new(&pick(&mesh.positions), &pick(&mesh.normals), &influences, &model)?;
        let feet = feet.try_into().map_err(|_| Failure::failed("expected two feet"))?;
        Ok(Self { skinner, feet })
    }

    /// Measures a clip relative to the floor of the contacts.
    pub(super) fn measure(&self, clip: &Clip, contacts: &Contacts) -> Result<SkinMeasure> {
        let count = self.skinner.vertex_count();
        let [mut now, mut before, mut normals] = [(); 3].map(|()| vec![[0.0; 3]; count]);
        let mut steps = contacts.feet.each_ref().map(|of_foot| vec![Vec::new(); of_foot.len()]);
        let mut out = SkinMeasure::default();
        let (mut pose, mut context) = (Pose::default(), SkinContext::default());
        for frame in 0..clip.frame_count() {
            std::mem::swap(&mut now, &mut before);
            clip.pose_into(frame, &mut pose);
            let model = pose.model_from_joints(clip.skeleton().parents());
            let surface = SurfaceMut::packed(&mut now, &mut normals);
            self.skinner.skin(SkinMethod::Linear, &model, surface, &mut context)?;
            out.not_finite += now.iter().filter(|p| !p.iter().all(|x| x.is_finite())).count();
            let lowest = now.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min);
            out.deepest = out.deepest.max(contacts.floor - lowest);
            for ((foot, of_foot), steps) in self.feet.iter().zip(&contacts.feet).zip(&mut steps) {
                for (contact, steps) in of_foot.iter().zip(steps) {
                    if (contact.start + 1..contact.end).contains(&frame) {
                        steps.push(foot.step(contact, &before, &now));
                    }
                }
            }
        }
        let stride = ((STRIDE * clip.frames_per_second()).round() as usize).max(1);
        let slides = steps.iter().flatten().flat_map(|steps| {
            let ends = 0..(steps.len() + 1).saturating_sub(stride).max(1);
            ends.map(move |at| steps[at..].iter().take(stride).sum::<f32>())
        });
        out.slide = slides.fold(0.0, f32::max);
        Ok(out)
    }

    /// Number of measured vertices of both feet.
    pub(super) fn vertex_count(&self) -> usize {
        self.feet.iter().map(|foot| foot.vertices.len()).sum()
    }
}

impl Foot {
    /// The foot of the vertices from number `first` on, with their positions in the rest pose.
    fn new(first: usize, positions: &[Vec3], ankle: Vec3, ball: Vec3) -> Self {
        let forward = (ball - ankle).with_y(0.0);
        let along = |p: &Vec3| (*p - ankle).with_y(0.0).dot(forward) / forward.length_squared();
        let low = positions.iter().filter(|p| p.y < 2.0 * SOLE);
        let back = low.map(along).fold(f32::INFINITY, f32::min);
        let heel = ankle + forward * back + forward.normalize_or_zero() * REACH;
        let sole_at = |centre: Vec3| {
            let near = |p: &Vec3| (*p - centre).with_y(0.0).length() < REACH;
            let part = || positions.iter().enumerate().filter(|(_, p)| near(p));
            let lowest = part().map(|(_, p)| p.y).fold(f32::INFINITY, f32::min);
            part().filter(|(_, p)| p.y < lowest + SOLE).map(|(v, _)| first + v).collect()
        };
        Self { vertices: first..first + positions.len(), under: [sole_at(heel), sole_at(ball)] }
    }

    /// Horizontal distance from one frame to the next of the centre of what stands on the floor.
    fn step(&self, contact: &Contact, before: &[[f32; 3]], now: &[[f32; 3]]) -> f32 {
        let sole = &self.under[usize::from(contact.point == FootPoint::Ball)];
        let lowest = sole.iter().map(|&v| before[v][1]).fold(f32::INFINITY, f32::min);
        let standing = sole.iter().filter(|&&v| before[v][1] < lowest + TOUCHING);
        let steps = standing.map(|&v| (Vec3::from(now[v]) - Vec3::from(before[v])).with_y(0.0));
        let (count, sum) = steps.fold((0, Vec3::ZERO), |(count, sum), step| (count + 1, sum + step));
        sum.length() / count.max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use anthronet::clip::{TranslationTrack, builtin};
    use anthronet::condition::Request;
    use anthronet::math::Rotation;
    use anthronet::measure::Sex;
    use anthronet::model::Model;
    use anthronet::retarget::feet::{FeetOptions, plant};

    use super::*;

    #[test]
    fn soles_of_very_different_bodies_stand_still_and_on_the_floor() {
        let model = Model::from_environment().unwrap();
        for (sex, measures) in [
            (Sex::Female, &[("height", 1.50), ("waist_circumference", 1.05)][..]),
            (Sex::Female, &[("height", 1.88), ("waist_circumference", 0.68)][..]),
            (Sex::Male, &[("height", 1.72), ("waist_circumference", 1.15)][..]),
            (Sex::Male, &[("height", 1.99)][..]),
        ] {
            let mut request = Request { sex: Some(sex), ..Request::default() };
            measures.iter().for_each(|(name, value)| request.set(name, *value).unwrap());
            let body = model.generate(&request).unwrap();
            let skeleton = body.skeleton().clone();
            let soles = Soles::of(&body, &skeleton).unwrap();
            let clip = sliding(&builtin("walk", &skeleton).unwrap());
            let (planted, report) = plant(&clip, &FeetOptions::default()).unwrap();
            let before = soles.measure(&clip, &report.contacts).unwrap();
            let on_floor = Contacts { floor: 0.0, ..report.contacts };
            let after = soles.measure(&planted, &on_floor).unwrap();
            let said = format!("{sex:?} {measures:?}: {before:?} {after:?}");
            assert!(before.slide > 0.03, "{said}");
            assert!(after.slide < 0.003 && after.deepest < 0.01, "{said}");
        }
    }

    /// The clip with a way that is 8 % too long, and feet that roll aside by 10° as they swing.
    fn sliding(walk: &Clip) -> Clip {
        let skeleton = walk.skeleton();
        let feet = SidedJoint::Foot.both().map(|foot| skeleton.require_rig_joint(foot).unwrap());
        let mut rotations = Vec::new();
        for frame in 0..walk.frame_count() {
            let mut pose = walk.pose(frame);
            let phase = std::f32::consts::TAU * frame as f32 / (walk.frame_count() - 1) as f32;
            for foot in feet {
                pose.locals[foot].rotation *= Rotation::from_rotation_y(0.17 * phase.sin());
            }
            rotations.extend(pose.locals.iter().map(|local| local.rotation));
        }
        let longer = |track: &TranslationTrack| TranslationTrack {
            joint: track.joint,
            values: track.values.iter().map(|v| Vec3::new(v.x, v.y, v.z * 1.08)).collect(),
        };
        let tracks = walk.translations().iter().map(longer).collect();
        Clip::new("sliding".into(), skeleton.clone(), walk.frames_per_second(), rotations, tracks).unwrap()
    }
}
