//! The skeleton and the cage's skin weights: MakeHuman's `game_engine` rig with eyes, jaw and twist joints.
//!
//! Eyes and jaw come from MakeHuman's `default` rig. Twist joints spread the roll of a limb along it: they are
//! leaves of the limb's joint, and the limb's weight is split over joint and helpers by where a vertex lies
//! along the bone. Where the *near* end must not roll (upper arm, thigh) the helpers sit there and undo the
//! joint's roll; where the *far* end must follow the next joint (forearm, calf) they sit there and add it.

use std::collections::BTreeMap;

use anthronet::Side;
use anthronet::skeleton::{Finger, RigJoint, SidedJoint};
use glam::Vec3;
use serde::Deserialize;

use super::{BaseMesh, Wheel};
use crate::{Error, Result};

/// A joint of the rig, without a position.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSource {
    /// Name, UE-like: `upperarm_l`.
    pub name: String,
    /// Parent in the list; parents come first.
    pub parent: Option<usize>,
}

/// Joints, the raw vertices whose mean is each joint's head and tail, and skin weights.
pub struct Rig {
    /// Joints, parents first.
    pub joints: Vec<JointSource>,
    /// Raw vertices whose mean is the joint. Twist joints lie between head and tail of their parent: see
    /// [`Rig::twists`].
    pub heads: Vec<Vec<u32>>,
    /// Raw vertices whose mean is the joint's far end.
    pub tails: Vec<Vec<u32>>,
    /// Twist joints: joint, and how far along its parent bone it sits, `0..1`.
    pub twists: Vec<(usize, f32)>,
    /// Per surface point (cage, accessories), joints and weights that sum to one.
    pub weights: Vec<Vec<(u16, f32)>>,
}

/// Smaller weights are dropped: MakeHuman has stray ones of 1e-5 without visible effect.
const LEAST_WEIGHT: f32 = 1e-4;

#[derive(Deserialize)]
struct Bone {
    head: End,
    tail: End,
    parent: String,
}

#[derive(Deserialize)]
struct End {
    strategy: String,
    cube_name: Option<String>,
    vertex_index: Option<u32>,
    vertex_indices: Option<Vec<u32>>,
}

#[derive(Deserialize)]
struct Weights {
    weights: BTreeMap<String, Vec<(u32, f32)>>,
}

/// The joints that the source's rig has, depth first, so that parents come first and limbs stay together. Twist joints are
/// put in after their limbs.
fn order() -> impl Iterator<Item = RigJoint> {
    use SidedJoint as J;
    let middle = [
        RigJoint::Root,
        RigJoint::Pelvis,
        RigJoint::Spine01,
        RigJoint::Spine02,
        RigJoint::Spine03,
        RigJoint::Neck01,
        RigJoint::Head,
        RigJoint::Jaw,
    ];
    let sided = |side: Side| {
        let arm = [J::Clavicle, J::Upperarm, J::Lowerarm, J::Hand].into_iter();
        let fingers = Finger::ALL.into_iter().flat_map(Finger::joints);
        let limbs = arm.chain(fingers).chain([J::Thigh, J::Calf, J::Foot, J::Ball]);
        limbs.map(move |joint| joint.on(side))
    };
    middle.into_iter().chain(J::Eye.both()).chain(Side::ALL.into_iter().flat_map(sided))
}

/// Twist helpers of a limb, their places along it, and whether they undo (near end) or add (far end) roll.
struct TwistPlan {
    limb: SidedJoint,
    helpers: &'static [(SidedJoint, f32)],
    undo: bool,
}

const TWISTS: [TwistPlan; 4] = [
    TwistPlan {
        limb: SidedJoint::Upperarm,
        helpers: &[(SidedJoint::UpperarmTwist01, 0.0), (SidedJoint::UpperarmTwist02, 0.5)],
        undo: true,
    },
    TwistPlan {
        limb: SidedJoint::Lowerarm,
        helpers: &[(SidedJoint::LowerarmTwist01, 0.5), (SidedJoint::LowerarmTwist02, 1.0)],
        undo: false,
    },
    TwistPlan { limb: SidedJoint::Thigh, helpers: &[(SidedJoint::ThighTwist01, 0.0)], undo: true },
    TwistPlan { limb: SidedJoint::Calf, helpers: &[(SidedJoint::CalfTwist01, 1.0)], undo: false },
];

/// The twist helpers of this joint and the side they are on; `None` for a joint without.
fn twists_of(joint: RigJoint) -> Option<(&'static TwistPlan, Side)> {
    let plan = TWISTS.iter().find(|plan| joint.sided() == Some(plan.limb))?;
    Some((plan, joint.side()?))
}

impl Rig {
    /// Reads rig and weights.
    ///
    /// # Errors
    /// [`Error::Source`] naming the bone.
    pub fn read(wheel: &mut Wheel, mesh: &BaseMesh) -> Result<Self> {
        let game: BTreeMap<String, Bone> = json(wheel, "rigs/standard/rig.game_engine.json")?;
        let default: BTreeMap<String, Bone> = json(wheel, "rigs/standard/rig.default.json")?;
        let game_weights: Weights = json(wheel, "rigs/standard/weights.game_engine.json")?;
        let default_weights: Weights = json(wheel, "rigs/standard/weights.default.json")?;

        let mut rig = Self {
            joints: Vec::new(),
            heads: Vec::new(),
            tails: Vec::new(),
            twists: Vec::new(),
            weights: vec![],
        };
        for joint in order() {
            let head = RigJoint::Head.name();
            let (bone, parent) = match joint {
                RigJoint::Sided(SidedJoint::Eye, Side::Left) => (&default["eye.L"], head),
                RigJoint::Sided(SidedJoint::Eye, Side::Right) => (&default["eye.R"], head),
                RigJoint::Jaw => (&default["jaw"], head),
                _ => {
                    let bone = game
                        .get(joint.name())
                        .ok_or_else(|| Error::Source(format!("rig.game_engine.json has no bone {joint}")))?;
                    (bone, bone.parent.as_str())
                }
            };
            let parent = rig.joints.iter().position(|j| j.name == parent);
            let head = if joint == RigJoint::Root {
                // The rig puts Root behind the body; the ground between the feet is what engines expect.
                group(mesh, "joint-ground")?
            } else {
                bone.head.vertices(mesh)?
            };
            let tail = bone.tail.vertices(mesh)?;
            let limb = rig.joints.len();
            rig.joints.push(JointSource { name: joint.name().to_owned(), parent });
            rig.heads.push(head.clone());
            rig.tails.push(tail.clone());
            let Some((plan, side)) = twists_of(joint) else { continue };
            for &(helper, place) in plan.helpers {
                rig.twists.push((rig.joints.len(), place));
                rig.joints.push(JointSource { name: helper.on(side).name().to_owned(), parent: Some(limb) });
                rig.heads.push(head.clone());
                rig.tails.push(tail.clone());
            }
        }
        rig.weights = rig.skin(mesh, &game_weights, &default_weights, &default)?;
        Ok(rig)
    }

    /// The joint with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// The index of this joint.
    ///
    /// # Errors
    /// [`Error::Source`] naming the joint when the rig has none of that name.
    pub fn require(&self, name: &str) -> Result<usize> {
        self.find(name).ok_or_else(|| Error::Source(format!("the rig has no joint {name}")))
    }

    fn skin(
        &self,
        mesh: &BaseMesh,
        game: &Weights,
        default: &Weights,
        default_rig: &BTreeMap<String, Bone>,
    ) -> Result<Vec<Vec<(u16, f32)>>> {
        let (head, jaw) = (self.require(RigJoint::Head.name())?, self.require(RigJoint::Jaw.name())?);
        let mut dense = vec![BTreeMap::<usize, f32>::new(); mesh.raw_positions.len()];
        for (name, list) in &game.weights {
            let joint = self.require(name)?;
            for &(v, w) in list {
                *dense[v as usize].entry(joint).or_insert(0.0) += w;
            }
        }
        // What belongs to the default rig's jaw (lower lip, chin) moves with ours; its weight is taken from the head's.
        let mut jaw_share = vec![0.0_f32; mesh.raw_positions.len()];
        for (name, list) in &default.weights {
            if hangs_below(default_rig, name, "jaw") {
                for &(v, w) in list {
                    jaw_share[v as usize] += w;
                }
            }
        }
        for (v, weights) in dense.iter_mut().enumerate() {
            let of_head = weights.get(&head).copied().unwrap_or(0.0);
            let moved = of_head.min(jaw_share[v]);
            if moved > 0.0 {
                weights.insert(head, of_head - moved);
                weights.insert(jaw, moved);
            }
        }
        // Rigid parts.
        let rigid = [
            ("helper-l-eye", SidedJoint::Eye.on(Side::Left)),
            ("helper-r-eye", SidedJoint::Eye.on(Side::Right)),
            ("helper-upper-teeth", RigJoint::Head),
            ("helper-lower-teeth", RigJoint::Jaw),
            ("helper-tongue", RigJoint::Jaw),
        ];
        for (name, joint) in rigid {
            let joint = self.require(joint.name())?;
            for v in group(mesh, name)? {
                dense[v as usize] = BTreeMap::from([(joint, 1.0)]);
            }
        }
        self.spread_twist(mesh, &mut dense)?;
        Ok(mesh
            .raw_of_surface
            .iter()
            .map(|&raw| {
                let weights = &dense[raw as usize];
                let sum: f32 = weights.values().sum();
                let kept: Vec<_> = weights.iter().filter(|(_, w)| **w / sum >= LEAST_WEIGHT).collect();
                let sum: f32 = kept.iter().map(|(_, w)| **w).sum();
                kept.into_iter().map(|(&j, &w)| (j as u16, w / sum)).collect()
            })
            .collect())
    }

    /// Splits the limbs' weights over their twist joints by hat functions along the bone.
    fn spread_twist(&self, mesh: &BaseMesh, dense: &mut [BTreeMap<usize, f32>]) -> Result<()> {
        let mean = |vertices: &[u32]| -> Vec3 {
            vertices.iter().map(|&v| mesh.raw_positions[v as usize]).sum::<Vec3>() / vertices.len() as f32
        };
        for (limb, joint) in self.joints.iter().enumerate() {
            let Some((plan, _)) = RigJoint::from_name(&joint.name).and_then(twists_of) else { continue };
            // Positions of the nodes along the bone, in order: helpers, and the limb itself at the other end.
            let mut nodes: Vec<(f32, usize)> =
                plan.helpers.iter().enumerate().map(|(i, (_, place))| (*place, limb + 1 + i)).collect();
            nodes.push((if plan.undo { 1.0 } else { 0.0 }, limb));
            nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (start, end) = (mean(&self.heads[limb]), mean(&self.tails[limb]));
            let axis = (end - start) / (end - start).length_squared();
            for (v, weights) in dense.iter_mut().enumerate() {
                let Some(of_limb) = weights.remove(&limb) else { continue };
                let t = (mesh.raw_positions[v] - start).dot(axis).clamp(0.0, 1.0);
                for (joint, share) in hat(&nodes, t) {
                    *weights.entry(joint).or_insert(0.0) += of_limb * share;
                }
            }
        }
        Ok(())
    }
}

/// Piecewise linear shares of the nodes around `t`, smoothed (3t² − 2t³) so that no crease shows at a node.
fn hat(nodes: &[(f32, usize)], t: f32) -> Vec<(usize, f32)> {
    for pair in nodes.windows(2) {
        let ((a, first), (b, second)) = (pair[0], pair[1]);
        if t <= b {
            let s = ((t - a) / (b - a)).clamp(0.0, 1.0);
            let s = s * s * (3.0 - 2.0 * s);
            return [(first, 1.0 - s), (second, s)].into_iter().filter(|(_, w)| *w > 0.0).collect();
        }
    }
    nodes.last().map(|&(_, joint)| (joint, 1.0)).into_iter().collect()
}

fn hangs_below(rig: &BTreeMap<String, Bone>, name: &str, ancestor: &str) -> bool {
    let mut current = name;
    for _ in 0..rig.len() {
        if current == ancestor {
            return true;
        }
        match rig.get(current) {
            Some(bone) => current = &bone.parent,
            None => return false,
        }
    }
    false
}

fn group(mesh: &BaseMesh, name: &str) -> Result<Vec<u32>> {
    mesh.groups
        .get(name)
        .filter(|v| !v.is_empty())
        .cloned()
        .ok_or_else(|| Error::Source(format!("basemesh_vertex_groups.json has no group {name}")))
}

impl End {
    fn vertices(&self, mesh: &BaseMesh) -> Result<Vec<u32>> {
        match (self.strategy.as_str(), &self.cube_name, self.vertex_index, &self.vertex_indices) {
            ("CUBE", Some(cube), ..) => group(mesh, cube),
            ("VERTEX", _, Some(v), _) => Ok(vec![v]),
            ("MEAN", .., Some(list)) if !list.is_empty() => Ok(list.clone()),
            (other, ..) => Err(Error::Source(format!("rig: unknown joint strategy {other}"))),
        }
    }
}

fn json<T: serde::de::DeserializeOwned>(wheel: &mut Wheel, name: &str) -> Result<T> {
    serde_json::from_str(&wheel.read_text(name)?).map_err(|e| Error::Source(format!("{name}: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joints_stand_in_the_order_of_the_model() {
        let with_twists = |joint: RigJoint| {
            let helpers =
                twists_of(joint).map(|(plan, side)| plan.helpers.iter().map(move |(j, _)| j.on(side)));
            [joint].into_iter().chain(helpers.into_iter().flatten())
        };
        let names: Vec<&str> = order().flat_map(with_twists).map(RigJoint::name).collect();
        let model = anthronet::model::Model::embedded().unwrap();
        assert_eq!(names, model.character().joint_tree().names());
    }

    #[test]
    fn shares_along_a_limb_sum_to_one_and_do_not_jump() {
        let nodes = [(0.0, 7), (0.5, 8), (1.0, 6)];
        let share = |t: f32, joint: usize| -> f32 {
            hat(&nodes, t).iter().filter(|(j, _)| *j == joint).map(|(_, w)| w).sum()
        };
        for i in 0..=200 {
            let t = i as f32 / 200.0;
            let sum: f32 = hat(&nodes, t).iter().map(|(_, w)| w).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{t}");
            for joint in [6, 7, 8] {
                // The steepest a smoothed ramp over half a limb gets is 1.5 / 0.5.
                assert!((share(t + 0.005, joint) - share(t, joint)).abs() < 0.0151, "{t}");
            }
        }
        assert_eq!((share(0.0, 7), share(0.5, 8), share(1.0, 6)), (1.0, 1.0, 1.0));
    }

    #[test]
    fn ends_name_their_vertices() {
        let mesh = BaseMesh {
            raw_positions: Vec::new(),
            cage: Default::default(),
            accessories: Vec::new(),
            raw_of_surface: Vec::new(),
            groups: BTreeMap::from([("joint-knee".to_owned(), vec![4, 5]), ("empty".to_owned(), vec![])]),
            mirror: BTreeMap::new(),
        };
        let end = |json: &str| serde_json::from_str::<End>(json).unwrap().vertices(&mesh);
        assert_eq!(end(r#"{"strategy": "CUBE", "cube_name": "joint-knee"}"#).unwrap(), [4, 5]);
        assert_eq!(end(r#"{"strategy": "VERTEX", "vertex_index": 9}"#).unwrap(), [9]);
        assert_eq!(end(r#"{"strategy": "MEAN", "vertex_indices": [1, 2]}"#).unwrap(), [1, 2]);
        for (bad, named) in [
            (r#"{"strategy": "CUBE", "cube_name": "joint-tail"}"#, "joint-tail"),
            (r#"{"strategy": "CUBE", "cube_name": "empty"}"#, "empty"),
            (r#"{"strategy": "MEAN", "vertex_indices": []}"#, "MEAN"),
            (r#"{"strategy": "GUESS"}"#, "GUESS"),
        ] {
            let message = end(bad).unwrap_err().to_string();
            assert!(message.contains(named), "{message}");
        }
    }

    #[test]
    fn ancestors_are_found_and_circles_end() {
        let end = || r#"{"strategy": "VERTEX", "vertex_index": 0}"#;
        let bone = |parent: &str| -> Bone {
            let json = format!(r#"{{"head": {}, "tail": {}, "parent": "{parent}"}}"#, end(), end());
            serde_json::from_str(&json).unwrap()
        };
        let rig = BTreeMap::from([
            ("jaw".to_owned(), bone("head")),
            ("head".to_owned(), bone("")),
            ("a".to_owned(), bone("b")),
            ("b".to_owned(), bone("a")),
        ]);
        assert!(hangs_below(&rig, "jaw", "head") && hangs_below(&rig, "jaw", "jaw"));
        assert!(!hangs_below(&rig, "head", "jaw") && !hangs_below(&rig, "a", "head"));
    }
}
