//! Holding feet on the floor.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;

use super::contacts::{Contact, Contacts, contacts};
use super::hold::{Correction, bridged, corrections, ramped};
use super::roll::slips;
use super::soles;
use super::{FeetOptions, FeetReport, for_each_pose, measure};
use crate::Result;
use crate::clip::edit::{closed, cut, repeated};
use crate::clip::{Clip, TranslationTrack};
use crate::math::{RigidTransform, Rotation};
use crate::pose::Leg;
use crate::pose::SwingTwist;
use crate::pose::ik::Reach;
use crate::pose::limits::JointLimits;
use crate::skeleton::{Pose, RigJoint, Skeleton, model_from_joints};

/// The last part of a leg's stretch, over which it slows down; the pelvis sinks so that feet on the floor need none.
const SOFTNESS: f32 = 0.001;
/// How far off the floor a foot may stay, metres: a leg that is almost straight folds by 10° for 4 mm.
const SPARED: f32 = 0.004;
/// How far an ankle or the toes may go beyond their limits so that a foot can stay where it is: 4°.
const GIVE: f32 = 0.07;
/// How fast toes begin and end to bend at most, radians a second (600°).
const TOES: f32 = 10.5;
/// How much deeper than its middle an edge of the sole may be in the floor, metres: skin gives way.
const EDGE: f32 = 0.006;
/// How often what still slides is taken back: that moves feet by up to 2 cm, which changes how ankle and toes bend, and
/// that by up to 1 mm more.
const ROUNDS: usize = 2;

/// Holds the feet of a clip of our rig: points in contact stay where they are, nothing sinks deeper than
/// `options.depth`, toes bend instead of going through the floor. A foot keeps the rotation it has, but for the turn
/// that lays its sole on the floor while heel and ball touch, and as far as the ankle's limits allow.
///
/// # Errors
/// [`Error`](crate::Error) naming a joint of the legs or the pelvis that is missing, or an option out of range.
pub fn plant(clip: &Clip, options: &FeetOptions) -> Result<(Clip, FeetReport)> {
    let (planted, found, mut report) = held(clip, options)?;
    report.before = measure(clip, &found)?;
    report.after = measure(&planted, &Contacts { floor: 0.0, ..found.clone() })?;
    report.contacts = found;
    Ok((planted, report))
}

/// As [`plant`], of a clip whose last frame is its first but for its travel, so that it still is: feet are held as if the
/// clip had come before already and went on after, and contacts reach over its ends.
///
/// # Errors
/// As [`plant`].
pub fn plant_loop(clip: &Clip, options: &FeetOptions) -> Result<(Clip, FeetReport)> {
    let cycle = clip.frame_count() - 1;
    if cycle == 0 {
        return plant(clip, options);
    }
    let (planted, found, mut report) = held(&repeated(clip, 3)?, options)?;
    // The middle one of the three. Its contacts in frames of its own.
    let planted = closed(&cut(&planted, cycle, clip.frame_count())?)?;
    let within = |contact: &Contact| {
        let start = contact.start.max(cycle) - cycle;
        let end = contact.end.min(2 * cycle + 1).saturating_sub(cycle);
        (start < end).then_some(Contact { start, end, ..*contact })
    };
    let feet = found.feet.map(|contacts| contacts.iter().filter_map(within).collect());
    let found = Contacts { feet, floor: found.floor };
    report.before = measure(clip, &found)?;
    report.after = measure(&planted, &Contacts { floor: 0.0, ..found.clone() })?;
    report.contacts = found;
    Ok((planted, report))
}

/// The planted clip, the contacts of the one that came in, and the report without its measures.
fn held(clip: &Clip, options: &FeetOptions) -> Result<(Clip, Contacts, FeetReport)> {
    let found = contacts(clip, options)?;
    let rest = clip.skeleton();
    let legs = Leg::both(rest)?;
    let pelvis = rest.require_rig_joint(RigJoint::Pelvis)?;
    let blend = libm::roundf(options.blend * clip.frames_per_second() as f32) as usize;

    let corrected = |floor: f32| -> [Vec<Correction>; 2] {
        let soles = soles::tracks(clip, &legs, floor);
        std::array::from_fn(|f| corrections(&soles[f], &found.feet[f], legs[f].sole, blend))
    };
    // Feet that are laid flat have their ankles at another height than the motion had them. What all have in common
    // moves the whole body, so that legs keep their bend.
    let floor = found.floor - common_rise(clip, &legs, &found, &corrected(found.floor));
    let mut feet = corrected(floor);
    let planter = Planter { legs, rest, limits: JointLimits::of_rig(rest).widened(GIVE), floor, options };
    let (mut planted, mut drops) = planter.held(clip, &feet, pelvis, blend)?;
    for _ in 0..ROUNDS {
        for (foot, corrections) in feet.iter_mut().enumerate() {
            let slips = slips(&planted, &planter.legs[foot], &found.feet[foot]);
            for (correction, slip) in corrections.iter_mut().zip(bridged(&slips, blend)) {
                correction.shift -= slip;
            }
        }
        (planted, drops) = planter.held(clip, &feet, pelvis, blend)?;
    }
    let pelvis_drop = drops.iter().copied().fold(0.0, f32::max);
    Ok((planted, found, FeetReport { floor, pelvis_drop, ..FeetReport::default() }))
}

/// How far standing ankles are lifted by their corrections, metres: the median over frames and feet in which heel or
/// ball touch; 0 when none does.
fn common_rise(clip: &Clip, legs: &[Leg; 2], found: &Contacts, feet: &[Vec<Correction>; 2]) -> f32 {
    let standing = |foot: usize, frame: usize| {
        found.feet[foot].iter().any(|contact| (contact.start..contact.end).contains(&frame))
    };
    let mut rises = Vec::new();
    let mut model = Vec::new();
    for_each_pose(clip, |frame, pose| {
        model_from_joints(clip.skeleton().parents(), &pose.locals, &mut model);
        for (foot, leg) in legs.iter().enumerate().filter(|(foot, _)| standing(*foot, frame)) {
            let (ankle, ball) = (model[leg.limb.end], model[leg.ball]);
            let moved = feet[foot][frame].apply(ankle.translation, leg.points(ankle, ball).joint);
            rises.push(moved.y - ankle.translation.y);
        }
    });
    let middle = rises.len() / 2;
    if rises.is_empty() { 0.0 } else { *rises.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

struct Planter<'a> {
    legs: [Leg; 2],
    rest: &'a Skeleton,
    limits: JointLimits,
    floor: f32,
    options: &'a FeetOptions,
}

impl Planter<'_> {
    /// The clip with its feet at their corrected places, and how far the pelvis sank in each frame.
    fn held(
        &self,
        clip: &Clip,
        feet: &[Vec<Correction>; 2],
        pelvis: usize,
        blend: usize,
    ) -> Result<(Clip, Vec<f32>)> {
        let rest = clip.skeleton();
        let drops = self.pelvis_drops(clip, feet, blend);
        let mut rotations = Vec::with_capacity(clip.frame_count() * rest.len());
        let mut places = Vec::with_capacity(clip.frame_count());
        let mut bends = [Vec::with_capacity(clip.frame_count()), Vec::with_capacity(clip.frame_count())];
        let mut pose = Pose::default();
        let mut model = Vec::new();
        for frame in 0..clip.frame_count() {
            clip.pose_into(frame, &mut pose);
            let corrections = [feet[0][frame], feet[1][frame]];
            let toes = self.frame(&mut pose, &mut model, pelvis, corrections, drops[frame]);
            rotations.extend(pose.locals.iter().map(|l| l.rotation));
            places.push(pose.locals[pelvis].translation);
            bends.iter_mut().zip(toes).for_each(|(bends, bend)| bends.push(bend));
        }
        for (leg, bends) in self.legs.iter().zip(&mut bends) {
            ramped(bends, TOES / clip.frames_per_second() as f32);
            self.bend_toes(leg, bends, &mut pose, &mut rotations);
        }
        let mut tracks = clip.translations().to_vec();
        tracks.retain(|track| track.joint as usize != pelvis);
        tracks.push(TranslationTrack { joint: pelvis as u32, values: places });
        let planted =
            Clip::new(clip.name().to_owned(), rest.clone(), clip.frames_per_second(), rotations, tracks)?;
        Ok((planted, drops))
    }

    /// Where a foot goes, `model_from_foot`, before the pelvis is lowered: corrected, and lifted out of the floor.
    fn goal(&self, leg: &Leg, model: &[RigidTransform], correction: &Correction) -> RigidTransform {
        let (foot, ball) = (self.over_floor(model[leg.limb.end]), self.over_floor(model[leg.ball]));
        let sole = leg.points(foot, ball);
        let moved = correction.apply(foot.translation, sole.joint);
        let rise = moved.y - foot.translation.y;
        let spared = rise.clamp(-SPARED, SPARED);
        let (heel, ball) = (correction.apply(sole.heel, sole.joint).y, sole.ball.y + correction.shift.y);
        let tilt = libm::fabsf((correction.rotation() * foot.rotation * Vec3::X).y);
        let edges = leg.half_widths.map(|half| tilt * half - EDGE).map(|drop| drop.max(0.0));
        let lowest = (heel - edges[0]).min(ball - edges[1]) - spared;
        let lift = (-self.options.depth - lowest).max(0.0);
        RigidTransform {
            rotation: (correction.rotation() * foot.rotation).normalize(),
            translation: moved + Vec3::Y * (lift - spared),
        }
    }

    fn over_floor(&self, local: RigidTransform) -> RigidTransform {
        RigidTransform { translation: local.translation - Vec3::Y * self.floor, ..local }
    }

    /// How far the pelvis sinks in each frame so that both legs reach, smooth in time.
    fn pelvis_drops(&self, clip: &Clip, feet: &[Vec<Correction>; 2], blend: usize) -> Vec<f32> {
        let mut needed = vec![0.0_f32; clip.frame_count()];
        let mut model = Vec::new();
        for_each_pose(clip, |frame, pose| {
            model_from_joints(clip.skeleton().parents(), &pose.locals, &mut model);
            for (leg, corrections) in self.legs.iter().zip(feet) {
                let goal = self.goal(leg, &model, &corrections[frame]).translation;
                let hip = self.over_floor(model[leg.limb.upper]).translation;
                let reach = leg.limb.length(pose) * (1.0 - SOFTNESS);
                let level = (goal - hip).with_y(0.0).length();
                let down = libm::sqrtf((reach * reach - level * level).max(0.0));
                needed[frame] = needed[frame].max(hip.y - goal.y - down);
            }
            needed[frame] = needed[frame].min(self.options.pelvis_drop);
        });
        // The most over a window, then its mean: never less than what is needed.
        let radius = blend / 2;
        let window = |frame: usize| frame.saturating_sub(radius)..(frame + radius + 1).min(needed.len());
        let most: Vec<f32> =
            (0..needed.len()).map(|f| needed[window(f)].iter().copied().fold(0.0, f32::max)).collect();
        (0..most.len()).map(|f| most[window(f)].iter().sum::<f32>() / window(f).len() as f32).collect()
    }

    /// Puts the feet of a frame where they go; how far the toes of each still have to bend.
    fn frame(
        &self,
        pose: &mut Pose,
        model: &mut Vec<RigidTransform>,
        pelvis: usize,
        corrections: [Correction; 2],
        drop: f32,
    ) -> [f32; 2] {
        let parents = self.rest.parents();
        model_from_joints(parents, &pose.locals, model);
        let goals: [RigidTransform; 2] =
            std::array::from_fn(|f| self.goal(&self.legs[f], model, &corrections[f]));
        let above = parents[pelvis].map_or(Rotation::IDENTITY, |p| model[p as usize].rotation);
        pose.locals[pelvis].translation -= above.conjugate() * (Vec3::Y * (drop + self.floor));
        model_from_joints(parents, &pose.locals, model);
        for ((leg, goal), correction) in self.legs.iter().zip(goals).zip(corrections) {
            let pivot = if correction.on_heel { leg.heel } else { pose.locals[leg.ball].translation };
            self.reach(leg, pose, leg.model_from_parent(model), goal, pivot);
        }
        std::array::from_fn(|f| self.toe_bend(&self.legs[f], pose, self.legs[f].model_from_parent(model)))
    }

    /// Bends the leg to its goal. Where the ankle is past its limit the foot turns back about `pivot`, a point in its
    /// space, and the leg is bent again.
    fn reach(
        &self,
        leg: &Leg,
        pose: &mut Pose,
        above: RigidTransform,
        mut goal: RigidTransform,
        pivot: Vec3,
    ) {
        let place = goal.translation + goal.rotation * pivot;
        for _ in 0..4 {
            leg.limb.reach(pose, above, &Reach { softness: SOFTNESS, ..Reach::to(goal) });
            if !self.limits.clamp_joint(self.rest, pose, leg.limb.end) {
                return;
            }
            goal.rotation = leg.limb.model_from_joints(pose, above)[2].rotation;
            goal.translation = place - goal.rotation * pivot;
        }
        leg.limb.reach(pose, above, &Reach { softness: SOFTNESS, ..Reach::to(goal) });
        self.limits.clamp_joint(self.rest, pose, leg.limb.end);
    }

    /// How far the toes turn up about the ball until their tip is out of the floor, radians; toes that point back under
    /// the foot come forwards.
    fn toe_bend(&self, leg: &Leg, pose: &Pose, above: RigidTransform) -> f32 {
        let [_, _, foot] = leg.limb.model_from_joints(pose, above);
        let ball = foot.then(pose.locals[leg.ball]);
        let wanted = leg.clearance[1] - ball.translation.y - self.options.depth;
        let (axis, toes) = (ball.rotation * Vec3::X, ball.rotation * leg.tip);
        // toes.y · cos + (axis × toes).y · sin = wanted, on the way up. The axis is level but for the foot's roll.
        let (cos, sin) = (toes.y, axis.cross(toes).y);
        let most = libm::sqrtf(cos * cos + sin * sin);
        if toes.y >= wanted || most < 1e-6 {
            return 0.0;
        }
        let angle = libm::atan2f(sin, cos) - libm::acosf((wanted / most).clamp(-1.0, 1.0));
        if angle < -FRAC_PI_2 { angle + TAU } else { angle.max(0.0) }
    }

    /// Bends the toes of every frame, within their limits.
    fn bend_toes(&self, leg: &Leg, bends: &[f32], pose: &mut Pose, rotations: &mut [Rotation]) {
        let at_rest = self.rest.rest_pose().locals[leg.ball].rotation;
        for (bend, frame) in bends.iter().zip(rotations.chunks_exact_mut(self.rest.len())) {
            let limit = self.limits.get(leg.ball).map_or(PI, |limit| limit.swing_x[1]);
            let bent = SwingTwist::of(at_rest.conjugate() * frame[leg.ball]).swing.x;
            let bend = bend.min(limit - bent);
            if bend > 0.0 {
                pose.locals[leg.ball].rotation = frame[leg.ball] * Rotation::from_rotation_x(bend);
                self.limits.clamp_joint(self.rest, pose, leg.ball);
                frame[leg.ball] = pose.locals[leg.ball].rotation;
            }
        }
    }
}
