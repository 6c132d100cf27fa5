//! The driver of each joint of the target. Spine and neck are interpolated along their length.

use super::super::joint_map::{NECK, SPINE};
use super::bones::LIMB_BONES;
use super::fingers::relaxed;
use super::reference::Reference;
use super::{Driver, FingerMode, TransferOptions};
use crate::Side;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Finger, RigJoint, SidedJoint};

/// The drivers, one per joint of the target.
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
        for ((joint, _), alignment) in LIMB_BONES.into_iter().zip(arm.into_iter().chain(leg)) {
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
    let matched = beside_thumb.filter(|(_, ours, _)| source_of(*ours).is_some()).count();
    let mut alignment = hand;
    for (joint, ours, (finger, number)) in of_hand {
        if number == 1 {
            alignment = hand;
        }
        match source_of(ours).filter(|_| mode == FingerMode::Source && matched >= 4) {
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

/// Spine and neck: joints of a chain follow the source at the same fraction of its length, the first and the last one exactly.
/// If the source has one joint, the chain bends evenly from the joint before it.
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

/// Drives the joints `target` of a chain by the joints `source`; `before` is the source joint below the chain.
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
        let fractions = along(&rest.source_rest, source);
        let next = fractions.iter().position(|fraction| *fraction >= at).unwrap_or(source.len() - 1).max(1);
        let span = (fractions[next] - fractions[next - 1]).max(1e-6);
        let t = ((at - fractions[next - 1]) / span).clamp(0.0, 1.0);
        drivers[joint] = Driver::Between([part(source[next - 1], joint), part(source[next], joint)], t);
    }
    for driver in drivers {
        // At an end of the interpolation one joint is enough.
        if let Driver::Between([from, to], t) = *driver
            && (t == 0.0 || t == 1.0)
        {
            let (joint, offset) = if t == 0.0 { from } else { to };
            *driver = Driver::Joint(joint, offset);
        }
    }
}

/// Positions of joints along a chain as fractions of its length, 0 to 1; evenly spaced when it has no length.
fn along(model: &[RigidTransform], chain: &[usize]) -> Vec<f32> {
    let mut lengths = vec![0.0];
    for pair in chain.windows(2) {
        let step = model[pair[0]].translation.distance(model[pair[1]].translation);
        lengths.push(lengths.last().copied().unwrap_or(0.0) + step);
    }
    let whole = lengths.last().copied().unwrap_or(0.0);
    let last = (chain.len() - 1).max(1) as f32;
    lengths
        .iter()
        .enumerate()
        .map(|(i, length)| if whole > 1e-4 { length / whole } else { i as f32 / last })
        .collect()
}
