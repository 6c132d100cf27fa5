use std::sync::Arc;

use glam::Vec3;

use super::*;
use crate::clip::{Clip, builtin};
use crate::math::Rotation;
use crate::retarget::{Overrides, RetargetOptions, retarget_clip};
use crate::testing::bodies::bodies;

/// A skeleton of the rig as another file has it: names, parents, rest pose.
struct Rig {
    names: Vec<String>,
    parents: Vec<Option<u32>>,
    rest: Vec<RigidTransform>,
}

impl Rig {
    fn of(skeleton: &Skeleton) -> Self {
        let rest = skeleton.rest_pose().locals.clone();
        Self { names: skeleton.names().to_vec(), parents: skeleton.parents().to_vec(), rest }
    }

    fn at(&self, name: &str) -> usize {
        self.names.iter().position(|n| n == name).unwrap()
    }

    /// Removes a joint with all below it.
    fn without(mut self, name: &str) -> Self {
        let top = self.at(name);
        let mut gone = vec![false; self.names.len()];
        for joint in 0..gone.len() {
            gone[joint] = joint == top || self.parents[joint].is_some_and(|parent| gone[parent as usize]);
        }
        let place: Vec<u32> = gone
            .iter()
            .scan(0, |next, gone| {
                *next += u32::from(!gone);
                Some(*next - u32::from(!gone))
            })
            .collect();
        let mut kept = gone.iter().map(|gone| !gone);
        self.names.retain(|_| kept.next().unwrap());
        let mut kept = gone.iter().map(|gone| !gone);
        self.rest.retain(|_| kept.next().unwrap());
        let mut kept = gone.iter().map(|gone| !gone);
        self.parents.retain(|_| kept.next().unwrap());
        for parent in self.parents.iter_mut().flatten() {
            *parent = place[*parent as usize];
        }
        self
    }

    /// Hangs a chain of four joints below one; `first` in that joint's space, then bones of this length downwards in model space.
    fn with_chain(mut self, below: &str, name: &str, first: Vec3, bone: f32) -> Self {
        let mut parent = self.at(below) as u32;
        let mut model = Vec::new();
        crate::skeleton::model_from_joints(&self.parents, &self.rest, &mut model);
        let down = model[parent as usize].rotation.conjugate() * Vec3::NEG_Y;
        for i in 0..4 {
            let translation = if i == 0 { first } else { down * bone };
            self.names.push(format!("{name}{i}"));
            self.parents.push(Some(parent));
            self.rest.push(RigidTransform { translation, ..RigidTransform::IDENTITY });
            parent = self.names.len() as u32 - 1;
        }
        self
    }

    /// Leans a joint with all below it forwards, radians.
    fn leaning(mut self, name: &str, angle: f32) -> Self {
        let joint = self.at(name);
        let mut model = Vec::new();
        crate::skeleton::model_from_joints(&self.parents, &self.rest, &mut model);
        let above = model[self.parents[joint].unwrap() as usize].rotation;
        let lean = above.conjugate() * Rotation::from_rotation_x(angle) * above;
        self.rest[joint].rotation = lean * self.rest[joint].rotation;
        self
    }

    fn skeleton(self) -> Skeleton {
        let ends = vec![None; self.names.len()];
        Skeleton::new(self.names, self.parents, self.rest, ends).unwrap()
    }

    /// Two frames of the rest pose.
    fn clip(self) -> Clip {
        let poses = [&self.rest[..], &self.rest].concat();
        Clip::from_poses("still".into(), Arc::new(self.skeleton()), 30.0, &poses).unwrap()
    }

    fn confidence(self) -> Confidence {
        let skeleton = self.skeleton();
        let map = JointMap::find(&skeleton, &Overrides::new()).unwrap();
        let reference = ReferencePose { model: skeleton.model_from_joints(), frame: None, stands: true };
        Confidence::of(&map, &skeleton, &reference)
    }
}

fn rig() -> Rig {
    Rig::of(&bodies()[0].1)
}

#[test]
fn a_person_is_one_with_hair_and_a_dress_too() {
    for (body, skeleton) in bodies() {
        let confidence = Rig::of(&skeleton).confidence();
        assert!(confidence.value == 1.0 && confidence.doubts.is_empty(), "{body}: {confidence:?}");
    }
    let side = Vec3::new(0.1, 0.0, 0.0);
    let tails = rig().with_chain("head", "x_a", side, 0.4).with_chain("head", "x_b", -side, 0.4);
    assert_eq!(tails.confidence().value, 1.0, "from the head");
    let mut dress = rig();
    for name in ["x_a", "x_b", "x_c", "x_d"] {
        dress = dress.with_chain("pelvis", name, side, 0.22);
    }
    assert_eq!(dress.confidence().value, 1.0, "more than two");
    let named = rig().with_chain("pelvis", "tail_a", side, 0.22).with_chain("pelvis", "tail_b", -side, 0.22);
    assert_eq!(named.confidence().value, 1.0, "by name");
}

#[test]
fn what_is_lacking_is_named() {
    let one_arm = rig().without("upperarm_l").confidence();
    assert_eq!(one_arm.doubts, ["it lacks the left arm"]);
    assert!(one_arm.value > LEAST_CONFIDENCE && one_arm.value < 1.0);
    let short = rig().without("lowerarm_r").confidence();
    assert_eq!(short.doubts, ["it lacks the right forearm"]);
    let legs = rig().without("spine_01").confidence();
    assert_eq!(legs.doubts, ["it lacks the trunk, the head, the left arm, the right arm"]);
    assert!(legs.value < LEAST_CONFIDENCE);
}

#[test]
fn more_legs_are_an_animals() {
    let side = Vec3::new(0.1, 0.0, 0.0);
    let four =
        rig().with_chain("pelvis", "x_a", side, 0.22).with_chain("pelvis", "x_b", -side, 0.22).confidence();
    assert_eq!(four.doubts, ["it has two more legs, `x_a0` and `x_b0`"]);
    assert!(four.value < LEAST_CONFIDENCE);
    let tail = Vec3::new(0.0, 0.0, -0.1);
    let with_tail = rig().with_chain("pelvis", "x_a", side, 0.22).with_chain("pelvis", "x_b", -side, 0.22);
    let with_tail = with_tail.with_chain("pelvis", "x_c", tail, 0.22).confidence();
    assert_eq!(with_tail.doubts, four.doubts, "a tail is no leg");
    let behind = rig().with_chain("pelvis", "x_d", tail, 0.01);
    let behind = behind.with_chain("x_d3", "x_a", side, 0.22).with_chain("x_d3", "x_b", -side, 0.22);
    assert_eq!(behind.confidence().doubts, four.doubts, "a centaur's hang from another trunk");
    let short =
        rig().with_chain("pelvis", "x_a", side, 0.1).with_chain("pelvis", "x_b", -side, 0.1).confidence();
    assert_eq!(short.value, 1.0);
}

#[test]
fn proportions_and_directions_tell_too() {
    let mut long = rig();
    for name in ["lowerarm_l", "lowerarm_r", "hand_l", "hand_r"] {
        let joint = long.at(name);
        long.rest[joint].translation *= 4.0;
    }
    let long = long.confidence();
    assert!(long.value < 1.0 && long.doubts[0].starts_with("its arms are 2."), "{long:?}");
    let mut confidence = rig().confidence();
    let off = |degrees: [f64; 2]| {
        let bone = |(bone, mean): (&str, f64)| BoneError { bone: bone.to_owned(), mean, max: 180.0 };
        let limbs = ["calf_l", "calf_r"].into_iter().zip(degrees).map(bone).collect();
        DirectionError { limbs, ..DirectionError::default() }
    };
    confidence.compare("walk", &off([2.0, 29.0]));
    assert_eq!(confidence.value, 1.0);
    confidence.compare("walk", &off([2.0, 35.4]));
    assert_eq!(confidence.doubts, ["`calf_r` of `walk` is 35° off on average"]);
    let before = confidence.value;
    confidence.compare("run", &off([30.0, 32.8]));
    assert_eq!(confidence.doubts[1], "bones of `run` are 31° off on average");
    assert!(confidence.value < before && before < 1.0);
}

#[test]
fn what_is_more_likely_no_person_is_refused_unless_it_is_forced_or_mapped() {
    let body = Arc::clone(&bodies()[0].1);
    let legs = rig().without("spine_01").clip();
    let (_, report) = retarget_clip(&legs, &body, &RetargetOptions::default()).unwrap();
    assert_eq!(report.confidence.doubts, ["it lacks the trunk, the head, the left arm, the right arm"]);
    let check = |options: &RetargetOptions| report.check(options);
    let error = check(&RetargetOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no person") && error.contains("lacks the trunk"), "{error}");
    check(&RetargetOptions { force: true, ..Default::default() }).unwrap();
    let mapping = Overrides::from([("pelvis".into(), Some("pelvis".into()))]);
    check(&RetargetOptions { mapping, ..Default::default() }).unwrap();
    // On all fours nobody stands, which only force accepts.
    let fours = rig().leaning("spine_01", 1.5).clip();
    let error = retarget_clip(&fours, &body, &RetargetOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no person stands"), "{error}");
    let forced = RetargetOptions { force: true, ..Default::default() };
    let (_, report) = retarget_clip(&fours, &body, &forced).unwrap();
    assert_eq!(report.confidence.doubts[0], "no person stands in it");
}

#[test]
fn the_report_of_retargeting_has_it() {
    let skeleton = Arc::new(bodies()[0].1.clone());
    let walk = builtin("walk", &skeleton).unwrap();
    let (_, report) = retarget_clip(&walk, &skeleton, &RetargetOptions::default()).unwrap();
    assert_eq!(report.confidence, Confidence { value: 1.0, doubts: Vec::new() });
}
