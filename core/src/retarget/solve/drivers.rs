//! What drives each joint of the target. Spine and neck are shared out along their length.

use super::super::joint_map::{NECK, SPINE};
use super::bones::LIMBS;
use super::fingers::relaxed;
use super::reference::Reference;
use super::{Driver, FingerMode, TransferOptions};
use crate::Side;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Finger, RigJoint, SidedJoint};

/// One driver per joint of the target.
pub(super) fn drivers(reference: &Reference, options: &TransferOptions) -> Vec<Driver> {
    let target = reference.joints.target;
    let mut drivers: Vec<Driver> = target.rest_rotations().map(Driver::Still).collect();
    let mut set = |ours: RigJoint, alignment: Rotation| {
        let pair = reference.map.source_of(ours).zip(target.rig_joint(ours));
        if let Some((source, joint)) = pair {
            drivers[joint] = Driver::Joint(source, reference.offset(source, joint, alignment));
        }
    };
    for joint in [RigJoint::Pelvis, RigJoint::Head].into_iter().chain(SidedJoint::Clavicle.both()) {
        set(joint, reference.trunk());
    }
    let mut hands = Vec::new();
    for side in Side::ALL {
        let arm = reference.arm(side);
        let leg = reference.leg(side, options.feet);
        for ((joint, _), alignment) in LIMBS.into_iter().zip(arm.into_iter().chain(leg)) {
            set(joint.on(side), alignment);
        }
        set(SidedJoint::Ball.on(side), leg[2]);
        hands.push((side, arm[2]));
    }
    for (side, hand) in hands {
        fingers(reference, options.fingers, side, hand, &mut drivers);
    }
    trunk(reference, &mut drivers);
    drivers
}

fn fingers(reference: &Reference, mode: FingerMode, side: Side, hand: Rotation, drivers: &mut [Driver]) {
    if mode == FingerMode::Rest {
        return;
    }
    let target = reference.joints.target;
    let of_hand: Vec<(usize, RigJoint, (Finger, usize))> = target
        .rig_joints()
        .enumerate()
        .filter_map(|(joint, ours)| Some((joint, ours.filter(|ours| ours.side() == Some(side))?)))
        .filter_map(|(joint, ours)| Some((joint, ours, ours.finger()?)))
        .collect();
    let source_of = |ours: RigJoint| reference.map.source_of(ours);
    let beside_thumb = of_hand.iter().filter(|(.., (finger, _))| *finger != Finger::Thumb);
    let told = beside_thumb.filter(|(_, ours, _)| source_of(*ours).is_some()).count();
    let mut alignment = hand;
    for (joint, ours, (finger, number)) in of_hand {
        if number == 1 {
            alignment = hand;
        }
        match source_of(ours).filter(|_| mode == FingerMode::Source && told >= 4) {
            Some(source) => {
                alignment = reference.finger(ours, alignment);
                drivers[joint] = Driver::Joint(source, reference.offset(source, joint, alignment));
            }
            None => {
                if let Some(local) = relaxed(reference.joints, joint, finger, number) {
                    drivers[joint] = Driver::Still(local);
                }
            }
        }
    }
}

/// Spine and neck: the first and the last joint of a chain follow those of the source, those between what the source
/// does at the same part of the way. A source of one joint bends evenly from the joint before the chain.
fn trunk(reference: &Reference, drivers: &mut [Driver]) {
    let (map, target) = (reference.map, reference.joints.target);
    let ours = |joints: &[RigJoint]| joints.iter().filter_map(|j| target.rig_joint(*j)).collect::<Vec<_>>();
    let pelvis = map.source_of(RigJoint::Pelvis);
    let (spine, neck) = (map.spine(), map.neck());
    let head = map.source_of(RigJoint::Head);
    share(reference, pelvis, spine, &ours(&SPINE), drivers);
    let chest = spine.last().copied().or(pelvis);
    match (neck, chest, head, target.rig_joint(RigJoint::Neck01)) {
        ([], Some(chest), Some(head), Some(joint)) => {
            let part = |source| (source, reference.offset(source, joint, reference.trunk()));
            drivers[joint] = Driver::Between([part(chest), part(head)], 0.5);
        }
        _ => share(reference, chest, neck, &ours(&NECK), drivers),
    }
}

fn share(
    reference: &Reference,
    before: Option<usize>,
    source: &[usize],
    target: &[usize],
    drivers: &mut [Driver],
) {
    let (Some(before), [first, ..]) = (before, source) else { return };
    let part = |from: usize, joint: usize| (from, reference.offset(from, joint, reference.trunk()));
    let rest = reference.joints;
    for (i, &joint) in target.iter().enumerate() {
        if source.len() == 1 {
            let t = (i + 1) as f32 / target.len() as f32;
            drivers[joint] = Driver::Between([part(before, joint), part(*first, joint)], t);
            continue;
        }
        let at = if target.len() == 1 { 0.5 } else { along(&rest.target_rest, target)[i] };
        let places = along(&rest.source_rest, source);
        let next = places.iter().position(|place| *place >= at).unwrap_or(source.len() - 1).max(1);
        let span = (places[next] - places[next - 1]).max(1e-6);
        let t = ((at - places[next - 1]) / span).clamp(0.0, 1.0);
        drivers[joint] = Driver::Between([part(source[next - 1], joint), part(source[next], joint)], t);
    }
    for driver in drivers {
        // An end of the way is one joint.
        if let Driver::Between([from, to], t) = *driver
            && (t == 0.0 || t == 1.0)
        {
            let (joint, offset) = if t == 0.0 { from } else { to };
            *driver = Driver::Joint(joint, offset);
        }
    }
}

/// Where joints stand along a chain, 0 the first and 1 the last; evenly when they are all in one place.
fn along(model: &[RigidTransform], chain: &[usize]) -> Vec<f32> {
    let mut way = vec![0.0];
    for pair in chain.windows(2) {
        let step = model[pair[0]].translation.distance(model[pair[1]].translation);
        way.push(way.last().copied().unwrap_or(0.0) + step);
    }
    let whole = way.last().copied().unwrap_or(0.0);
    let last = (chain.len() - 1).max(1) as f32;
    way.iter().enumerate().map(|(i, w)| if whole > 1e-4 { w / whole } else { i as f32 / last }).collect()
}
