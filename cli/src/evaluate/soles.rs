//! Feet as the floor meets them: the skin of the soles, posed frame by frame.

use anthronet::Body;
use anthronet::clip::Clip;
use anthronet::mesh::Lod;
use anthronet::retarget::feet::{Contact, Contacts, FootPoint};
use anthronet::scene::{Scene, SceneOptions};
use anthronet::skeleton::Influences;
use anthronet::skeleton::{Pose, RestPose};
use anthronet::skin::{SkinMethod, Skinner, SurfaceMut};
use glam::Vec3;

use crate::failure::{Failure, Result};

/// How far above the lowest vertex of heel or ball at rest its sole reaches, metres.
const SOLE: f32 = 0.01;
/// How far from its middle the sole counts as that of heel or ball, metres. The middle of the ball is under its joint, that
/// of the heel as far ahead of its back edge.
const REACH: f32 = 0.03;
/// How far above the lowest vertex of heel or ball a vertex stands on the floor with it, metres.
const TOUCHING: f32 = 0.005;
/// How long a stride takes, seconds: of people who walk at their ease.
const STRIDE: f64 = 1.1;

/// The skin of both feet at level of detail 1, with the four influences that files carry.
pub(super) struct Soles {
    skinner: Skinner,
    feet: [Foot; 2],
}

struct Foot {
    /// All vertices that follow the foot or its toes.
    vertices: Vec<usize>,
    /// The sole under the heel, and under the ball.
    under: [Vec<usize>; 2],
}

/// What the skin of the feet does over a clip, the worse foot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SkinMeasure {
    /// How far the lowest vertex is under the floor, metres; 0 when none is.
    pub(super) deepest: f32,
    /// The longest way over the floor, within a stride and a contact, of the middle of the skin that stands on it, metres.
    pub(super) slide: f32,
    /// Vertices of frames that are nowhere.
    pub(super) not_finite: usize,
}

impl Soles {
    pub(super) fn of(body: &Body, rest: &RestPose) -> Result<Self> {
        let scene = Scene::from_body(body, &SceneOptions { lod: Lod::Lod1, ..SceneOptions::default() })?;
        let mesh = scene.meshes.first().ok_or_else(|| Failure::failed("the scene has no body"))?;
        let model = rest.model_from_joints();
        let mut feet = Vec::new();
        let mut kept: Vec<usize> = Vec::new();
        for side in ["l", "r"] {
            let [foot, ball] =
                [format!("foot_{side}"), format!("ball_{side}")].map(|name| rest.require(&name));
            let [foot, ball] = [foot?, ball?];
            let first = kept.len();
            let follows = |v: &usize| {
                mesh.influences(*v).any(|(joint, w)| w > 0.0 && [foot, ball].contains(&usize::from(joint)))
            };
            kept.extend((0..mesh.positions.len()).filter(follows));
            let (ankle, ahead) = (model[foot].translation, model[ball].translation - model[foot].translation);
            let along = |v: usize| {
                let way = Vec3::from(mesh.positions[kept[v]]) - ankle;
                way.with_y(0.0).dot(ahead.with_y(0.0)) / ahead.with_y(0.0).length_squared()
            };
            let height = |v: usize| mesh.positions[kept[v]][1];
            let vertices: Vec<usize> = (first..kept.len()).collect();
            let ball_at = model[ball].translation;
            let way = ahead.with_y(0.0);
            let low = vertices.iter().filter(|&&v| height(v) < 2.0 * SOLE);
            let back = low.map(|&v| along(v)).fold(f32::INFINITY, f32::min);
            let heel_at = ankle + way * back + way.normalize_or_zero() * REACH;
            let near = |middle: Vec3| {
                let near =
                    |v: &usize| (Vec3::from(mesh.positions[kept[*v]]) - middle).with_y(0.0).length() < REACH;
                let part: Vec<usize> = vertices.iter().copied().filter(near).collect();
                let lowest = part.iter().map(|&v| height(v)).fold(f32::INFINITY, f32::min);
                part.into_iter().filter(|&v| height(v) < lowest + SOLE).collect()
            };
            let under = [near(heel_at), near(ball_at)];
            feet.push(Foot { vertices, under });
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

    /// Measures a clip over the contacts' floor.
    pub(super) fn measure(&self, clip: &Clip, contacts: &Contacts) -> Result<SkinMeasure> {
        let count = self.skinner.vertex_count();
        let [mut now, mut before, mut normals] = [(); 3].map(|()| vec![[0.0; 3]; count]);
        let mut steps = contacts.feet.each_ref().map(|of_foot| vec![Vec::new(); of_foot.len()]);
        let mut out = SkinMeasure::default();
        let mut pose = Pose::default();
        for frame in 0..clip.frame_count() {
            std::mem::swap(&mut now, &mut before);
            clip.pose_into(frame, &mut pose);
            let model = pose.model_from_joints(clip.rest().parents());
            self.skinner.skin(SkinMethod::Linear, &model, SurfaceMut::packed(&mut now, &mut normals))?;
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
        let ways = steps.iter().flatten().flat_map(|steps| {
            let ends = 0..(steps.len() + 1).saturating_sub(stride).max(1);
            ends.map(move |at| steps[at..].iter().take(stride).sum::<f32>())
        });
        out.slide = ways.fold(0.0, f32::max);
        Ok(out)
    }

    /// How many vertices are looked at, both feet.
    pub(super) fn vertex_count(&self) -> usize {
        self.feet.iter().map(|foot| foot.vertices.len()).sum()
    }
}

impl Foot {
    /// How far the middle of what stands on the floor goes over it from one frame to the next.
    fn step(&self, contact: &Contact, before: &[[f32; 3]], now: &[[f32; 3]]) -> f32 {
        let sole = &self.under[usize::from(contact.point == FootPoint::Ball)];
        let lowest = sole.iter().map(|&v| before[v][1]).fold(f32::INFINITY, f32::min);
        let standing = sole.iter().filter(|&&v| before[v][1] < lowest + TOUCHING);
        let steps = standing.map(|&v| (Vec3::from(now[v]) - Vec3::from(before[v])).with_y(0.0));
        let (count, sum) = steps.fold((0, Vec3::ZERO), |(count, sum), step| (count + 1, sum + step));
        sum.length() / count.max(1) as f32
    }
}
