//! What drives each joint of the target. Spine and neck are shared out along their length.

use glam::Quat;

use super::fingers::relaxed;
use super::reference::Reference;
use super::{Driver, FingerMode, TransferOptions};
use crate::math::RigidTransform;
use crate::skeleton::humanoid::finger;

/// One driver per joint of the target.
pub(super) fn drivers(reference: &Reference, options: &TransferOptions) -> Vec<Driver> {
    let target = reference.joints.target;
    let mut drivers: Vec<Driver> = target.rest_rotations().map(Driver::Still).collect();
    let mut set = |name: &str, alignment: Quat| {
        let pair = reference.map.source_of(name).zip(target.find(name));
        if let Some((source, joint)) = pair {
            drivers[joint] = Driver::Joint(source, reference.offset(source, joint, alignment));
        }
    };
    for name in ["pelvis", "head", "clavicle_l", "clavicle_r"] {
        set(name, reference.trunk());
    }
    let mut hands = Vec::new();
    for side in ["l", "r"] {
        let arm = reference.arm(side);
        let leg = reference.leg(side, options.feet);
        let limbs = ["upperarm", "lowerarm", "hand", "thigh", "calf", "foot"];
        for (stem, alignment) in limbs.into_iter().zip(arm.into_iter().chain(leg)) {
            set(&format!("{stem}_{side}"), alignment);
        }
        set(&format!("ball_{side}"), leg[2]);
        hands.push((side, arm[2]));
    }
    for (side, hand) in hands {
        fingers(reference, options.fingers, side, hand, &mut drivers);
    }
    trunk(reference, &mut drivers);
    drivers
}

fn fingers(reference: &Reference, mode: FingerMode, side: &str, hand: Quat, drivers: &mut [Driver]) {
    if mode == FingerMode::Rest {
        return;
    }
    let target = reference.joints.target;
    let names = target.names();
    let of_hand: Vec<usize> =
        (0..names.len()).filter(|&j| finger(&names[j]).is_some() && names[j].ends_with(side)).collect();
    let source_of = |joint: usize| reference.map.source_of(&names[joint]);
    let told = of_hand.iter().filter(|&&j| !names[j].starts_with("thumb") && source_of(j).is_some()).count();
    let mut alignment = hand;
    for joint in of_hand {
        if names[joint].contains("_01_") {
            alignment = hand;
        }
        match source_of(joint).filter(|_| mode == FingerMode::Source && told >= 4) {
            Some(source) => {
                alignment = reference.finger(&names[joint], alignment);
                drivers[joint] = Driver::Joint(source, reference.offset(source, joint, alignment));
            }
            None => {
                if let Some(local) = relaxed(reference.joints, joint) {
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
    let ours = |names: &[&str]| names.iter().filter_map(|name| target.find(name)).collect::<Vec<_>>();
    let pelvis = map.source_of("pelvis");
    let (spine, neck) = (map.spine(), map.neck());
    let head = map.source_of("head");
    share(reference, pelvis, spine, &ours(&["spine_01", "spine_02", "spine_03"]), drivers);
    let chest = spine.last().copied().or(pelvis);
    match (neck, chest, head, target.find("neck_01")) {
        ([], Some(chest), Some(head), Some(joint)) => {
            let part = |source| (source, reference.offset(source, joint, reference.trunk()));
            drivers[joint] = Driver::Between([part(chest), part(head)], 0.5);
        }
        _ => share(reference, chest, neck, &ours(&["neck_01"]), drivers),
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
