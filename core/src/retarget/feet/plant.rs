//! Planting feet on the floor.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;

use super::contacts::{Contact, Contacts, contacts};
use super::hold::{Correction, bridged, corrections, ramped};
use super::roll::{RoundSole, slips};
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
use crate::skeleton::{Pose, RigJoint, Skeleton, model_from_some_joints, with_ancestors};

/// Softness of inverse kinematics, see [`Reach::softness`]; the pelvis is lowered so that feet on the floor stay out of it.
const SOFTNESS: f32 = 0.0005;
/// Vertical correction that is left out, metres: to shorten an almost straight leg by 4 mm takes 10° of knee flexion.
const IGNORED_RISE: f32 = 0.004;
/// How far ankles and toes may exceed their limits so that a foot stays in place, radians (4°).
const LIMIT_MARGIN: f32 = 0.07;
/// Highest speed at which toes bend and straighten, radians per second (430°).
const TOE_SPEED: f32 = 7.5;
/// How much deeper than its middle an edge of the sole may be in the floor, metres, as skin yields.
const EDGE_DEPTH: f32 = 0.006;
/// Iterations that take back the remaining slide. The first moves feet by up to 2 cm, which changes how ankle and toes bend,
/// so that the second moves them by up to 1 mm more.
const SLIDE_ITERATIONS: usize = 2;

/// Plants the feet of a clip of the rig: points in contact stay in place, nothing sinks deeper than `options.depth`, toes bend
/// instead of going through the floor. A foot keeps its rotation, except that its sole is laid flat while heel and ball touch,
/// and as far as the ankle's limits allow.
///
/// # Errors
/// [`Error`](crate::Error) naming a missing joint of legs or pelvis, or an option out of range.
pub fn plant(clip: &Clip, options: &FeetOptions) -> Result<(Clip, FeetReport)> {
    let (planted, found, mut report) = planted(clip, options)?;
    report.before = measure(clip, &found)?;
    report.after = measure(&planted, &Contacts { floor: 0.0, ..found.clone() })?;
    report.contacts = found;
    Ok((planted, report))
}

/// As [`plant`], for a clip whose last pose equals its first but for root motion, which is preserved: feet are planted as if
/// the clip repeated, so that contacts may extend over its ends.
///
/// # Errors
/// As [`plant`].
pub fn plant_loop(clip: &Clip, options: &FeetOptions) -> Result<(Clip, FeetReport)> {
    let cycle = clip.frame_count() - 1;
    if cycle == 0 {
        return plant(clip, options);
    }
    let (planted, found, mut report) = planted(&repeated(clip, 3)?, options)?;
    // Of three cycles keep the middle one, and its contacts, counted from its first frame.
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

/// The planted clip, the contacts of the input, and the report without its measures.
fn planted(clip: &Clip, options: &FeetOptions) -> Result<(Clip, Contacts, FeetReport)> {
    let found = contacts(clip, options)?;
    let rest = clip.skeleton();
    let legs = Leg::both(rest)?;
    let pelvis = rest.require_rig_joint(RigJoint::Pelvis)?;
    let blend = libm::roundf(options.blend * clip.frames_per_second() as f32) as usize;

    let corrected = |floor: f32| -> [Vec<Correction>; 2] {
        let soles = soles::tracks(clip, &legs, floor);
        std::array::from_fn(|f| corrections(&soles[f], &found.feet[f], legs[f].sole, blend))
    };
    // Laying feet flat changes the height of the ankles. The part that is common to all frames moves the whole body, so that
    // legs keep their bend.
    let floor = found.floor - common_rise(clip, &legs, &found, &corrected(found.floor));
    let mut feet = corrected(floor);
    let [left, right] = legs.each_ref().map(|leg| RoundSole::of(rest, leg));
    let planter = Planter {
        soles: [left?, right?],
        joints: with_ancestors(rest.parents(), legs.iter().map(|leg| leg.ball)),
        legs,
        rest,
        limits: JointLimits::of_rig(rest).widened(LIMIT_MARGIN),
        floor,
        options,
    };
    let (mut planted, mut drops) = planter.run(clip, &feet, pelvis, blend)?;
    for _ in 0..SLIDE_ITERATIONS {
        for (foot, corrections) in feet.iter_mut().enumerate() {
            let slips = slips(&planted, &planter.legs[foot], &found.feet[foot])?;
            for (correction, slip) in corrections.iter_mut().zip(bridged(&slips, blend)) {
                correction.shift -= slip;
            }
        }
        (planted, drops) = planter.run(clip, &feet, pelvis, blend)?;
    }
    let pelvis_drop = drops.iter().copied().fold(0.0, f32::max);
    Ok((planted, found, FeetReport { floor, pelvis_drop, ..FeetReport::default() }))
}

/// How far corrections lift standing ankles, metres: the median over feet and frames in which heel or ball touches; 0 when
/// there are none.
fn common_rise(clip: &Clip, legs: &[Leg; 2], found: &Contacts, feet: &[Vec<Correction>; 2]) -> f32 {
    let standing = |foot: usize, frame: usize| {
        found.feet[foot].iter().any(|contact| (contact.start..contact.end).contains(&frame))
    };
    let mut rises = Vec::new();
    for_each_pose(clip, legs, |frame, _, model| {
        for (foot, leg) in legs.iter().enumerate().filter(|(foot, _)| standing(*foot, frame)) {
            let (ankle, ball) = (model[leg.limb.end], model[leg.ball]);
            let moved = feet[foot][frame].apply(ankle.translation, leg.points(ankle, ball).joint);
            rises.push(moved.y - ankle.translation.y);
        }
    });
    let middle = rises.len() / 2;
    if rises.is_empty() { 0.0 } else { *rises.select_nth_unstable_by(middle, f32::total_cmp).1 }
}

/// What planting the frames of a clip depends on.
struct Planter<'a> {
    legs: [Leg; 2],
    soles: [RoundSole; 2],
    /// The legs' joints and all above them.
    joints: Vec<usize>,
    rest: &'a Skeleton,
    limits: JointLimits,
    floor: f32,
    options: &'a FeetOptions,
}

impl Planter<'_> {
    /// The clip with corrected feet, and how far the pelvis was lowered in each frame.
    fn run(
        &self,
        clip: &Clip,
        feet: &[Vec<Correction>; 2],
        pelvis: usize,
        blend: usize,
    ) -> Result<(Clip, Vec<f32>)> {
        let rest = clip.skeleton();
        let drops = self.pelvis_drops(clip, feet, blend);
        let mut rotations = Vec::with_capacity(clip.frame_count() * rest.len());
        let mut positions = Vec::with_capacity(clip.frame_count());
        let mut bends = [Vec::with_capacity(clip.frame_count()), Vec::with_capacity(clip.frame_count())];
        let mut pose = Pose::default();
        let mut model = Vec::new();
        for frame in 0..clip.frame_count() {
            clip.pose_into(frame, &mut pose);
            let corrections = [feet[0][frame], feet[1][frame]];
            let toes = self.frame(&mut pose, &mut model, pelvis, corrections, drops[frame]);
            rotations.extend(pose.locals.iter().map(|l| l.rotation));
            positions.push(pose.locals[pelvis].translation);
            bends.iter_mut().zip(toes).for_each(|(bends, bend)| bends.push(bend));
        }
        for (leg, bends) in self.legs.iter().zip(&mut bends) {
            ramped(bends, TOE_SPEED / clip.frames_per_second() as f32);
            self.bend_toes(leg, bends, &mut pose, &mut rotations);
        }
        let mut tracks = clip.translations().to_vec();
        tracks.retain(|track| track.joint as usize != pelvis);
        tracks.push(TranslationTrack { joint: pelvis as u32, values: positions });
        let planted =
            Clip::new(clip.name().to_owned(), rest.clone(), clip.frames_per_second(), rotations, tracks)?;
        Ok((planted, drops))
    }

    /// The goal of a foot, `model_from_joint`, before the pelvis is lowered: corrected and lifted out of the floor.
    fn goal(&self, foot: usize, model: &[RigidTransform], correction: &Correction) -> RigidTransform {
        let leg = &self.legs[foot];
        let (foot_joint, ball_joint) =
            (self.above_floor(model[leg.limb.end]), self.above_floor(model[leg.ball]));
        let sole = leg.points(foot_joint, ball_joint);
        let moved = correction.apply(foot_joint.translation, sole.joint);
        let rise = moved.y - foot_joint.translation.y;
        let ignored = rise.clamp(-IGNORED_RISE, IGNORED_RISE);
        let (heel, ball) = (correction.apply(sole.heel, sole.joint).y, sole.ball.y + correction.shift.y);
        let corrected = |joint: RigidTransform| RigidTransform {
            rotation: (correction.rotation() * joint.rotation).normalize(),
            translation: correction.apply(joint.translation, sole.joint),
        };
        let rim = self.soles[foot].lowest(&[corrected(foot_joint), corrected(ball_joint)]) + EDGE_DEPTH;
        let tilt = libm::fabsf((corrected(foot_joint).rotation * Vec3::X).y);
        let edges = leg.half_widths.map(|half| tilt * half - EDGE_DEPTH).map(|drop| drop.max(0.0));
        let lowest = (heel - edges[0]).min(ball - edges[1]).min(rim) - ignored;
        let lift = (-self.options.depth - lowest).max(0.0);
        RigidTransform {
            rotation: corrected(foot_joint).rotation,
            translation: moved + Vec3::Y * (lift - ignored),
        }
    }

    fn above_floor(&self, joint: RigidTransform) -> RigidTransform {
        RigidTransform { translation: joint.translation - Vec3::Y * self.floor, ..joint }
    }

    /// How far the pelvis is lowered in each frame so that both legs reach, smooth over time; metres.
    fn pelvis_drops(&self, clip: &Clip, feet: &[Vec<Correction>; 2], blend: usize) -> Vec<f32> {
        let mut needed = vec![0.0_f32; clip.frame_count()];
        for_each_pose(clip, &self.legs, |frame, pose, model| {
            for (foot, leg) in self.legs.iter().enumerate() {
                let goal = self.goal(foot, model, &feet[foot][frame]).translation;
                let hip = self.above_floor(model[leg.limb.upper]).translation;
                let reach = leg.limb.length(pose) * (1.0 - SOFTNESS);
                let level = (goal - hip).with_y(0.0).length();
                let down = libm::sqrtf((reach * reach - level * level).max(0.0));
                needed[frame] = needed[frame].max(hip.y - goal.y - down);
            }
            needed[frame] = needed[frame].min(self.options.pelvis_drop);
        });
        // The maximum over a window, then the mean of that: never less than needed.
        let radius = blend / 2;
        let window = |frame: usize| frame.saturating_sub(radius)..(frame + radius + 1).min(needed.len());
        let most: Vec<f32> =
            (0..needed.len()).map(|f| needed[window(f)].iter().copied().fold(0.0, f32::max)).collect();
        (0..most.len()).map(|f| most[window(f)].iter().sum::<f32>() / window(f).len() as f32).collect()
    }

    /// Moves the feet of a frame to their goals; returns how far the toes of each still have to bend, radians.
    fn frame(
        &self,
        pose: &mut Pose,
        model: &mut Vec<RigidTransform>,
        pelvis: usize,
        corrections: [Correction; 2],
        drop: f32,
    ) -> [f32; 2] {
        let parents = self.rest.parents();
        model_from_some_joints(parents, &pose.locals, &self.joints, model);
        let goals: [RigidTransform; 2] = std::array::from_fn(|f| self.goal(f, model, &corrections[f]));
        let parent = parents[pelvis].map_or(Rotation::IDENTITY, |p| model[p as usize].rotation);
        pose.locals[pelvis].translation -= parent.conjugate() * (Vec3::Y * (drop + self.floor));
        model_from_some_joints(parents, &pose.locals, &self.joints, model);
        for ((leg, goal), correction) in self.legs.iter().zip(goals).zip(corrections) {
            let pivot = if correction.on_heel { leg.heel } else { pose.locals[leg.ball].translation };
            self.reach(leg, pose, leg.model_from_parent(model), goal, pivot);
        }
        std::array::from_fn(|f| self.toe_bend(&self.legs[f], pose, self.legs[f].model_from_parent(model)))
    }

    /// Bends the leg to its goal; `parent` is `model_from_joint` of the hip's parent. If the ankle exceeds its limit, the foot
    /// is rotated back about `pivot`, a point in its space, and the leg is solved again.
    fn reach(
        &self,
        leg: &Leg,
        pose: &mut Pose,
        parent: RigidTransform,
        mut goal: RigidTransform,
        pivot: Vec3,
    ) {
        let fixed = goal.translation + goal.rotation * pivot;
        for _ in 0..4 {
            leg.limb.reach(pose, parent, &Reach { softness: SOFTNESS, ..Reach::to(goal) });
            if !self.limits.clamp_joint(self.rest, pose, leg.limb.end) {
                return;
            }
            goal.rotation = leg.limb.model_from_joints(pose, parent)[2].rotation;
            goal.translation = fixed - goal.rotation * pivot;
        }
        leg.limb.reach(pose, parent, &Reach { softness: SOFTNESS, ..Reach::to(goal) });
        self.limits.clamp_joint(self.rest, pose, leg.limb.end);
    }

    /// How far the toes bend up about the ball until their tip is out of the floor, radians; toes that point back under the foot
    /// come forwards.
    fn toe_bend(&self, leg: &Leg, pose: &Pose, parent: RigidTransform) -> f32 {
        let [_, _, foot] = leg.limb.model_from_joints(pose, parent);
        let ball = foot.then(pose.locals[leg.ball]);
        let (axis, toes) = (ball.rotation * Vec3::X, ball.rotation * leg.tip);
        // The lower side of toes on a foot that rolls aside.
        let edge = (libm::fabsf(axis.y) * leg.half_widths[1] - EDGE_DEPTH).max(0.0);
        let wanted = leg.clearance[1] - ball.translation.y - self.options.depth + edge;
        // The rising solution of toes.y · cos + (axis × toes).y · sin = wanted. The axis is level but for the foot's roll.
        let (cos, sin) = (toes.y, axis.cross(toes).y);
        let most = libm::sqrtf(cos * cos + sin * sin);
        if toes.y >= wanted || most < 1e-6 {
            return 0.0;
        }
        let angle = libm::atan2f(sin, cos) - libm::acosf((wanted / most).clamp(-1.0, 1.0));
        if angle < -FRAC_PI_2 { angle + TAU } else { angle.max(0.0) }
    }

    /// Bends the toes in every frame, within their limits.
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
