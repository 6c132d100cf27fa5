//! Makes `model/measures.json`: landmarks and planes, chosen by hand, become loops on the mean body.
//!
//! A tape's loop is the cut of the mean body's surface by the measure's plane, as places on edges: planar on the
//! mean body, so it reads there what a tape reads. (A loop of whole vertices zigzags: −9 mm at the neck.) The
//! chest is cut anew on every body, because no fixed loop stays on the bust; its candidate edges are those that
//! the nipple plane meets on some body, two rings wider.

use std::collections::BTreeSet;

use anthronet::Side;
use anthronet::measure::{Definition, Kind, MeasureId, Point};
use anthronet::skeleton::{RigJoint, SidedJoint};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::assets::{CROWN, HEELS};
use crate::corpus::{Corpus, cage_of};
use crate::{Error, Result};

/// The definition of a measure on the body; sided ones are given for the left.
enum Landmarks {
    /// Distance between two vertices.
    Straight(u32, u32),
    /// Vertical distance between a vertex and the mean of two.
    Vertical(u32, [u32; 2]),
    /// Loop through the mean of the vertices; normal.
    Loop(&'static [u32], [f64; 3]),
    /// Horizontal cut at the mean of two vertices, over the torso.
    Torso([u32; 2]),
}
use Landmarks::{Loop, Straight, Torso, Vertical};

const NIPPLES: [u32; 2] = [1_840, 8_512];

/// Name without side, and definition (left side).
#[rustfmt::skip]
const PLAN: &[(&str, Landmarks)] = &[
    ("waist_circumference", Loop(WAIST, [0.0, 1.0, 0.0])),
    ("chest_circumference", Torso(NIPPLES)),
    ("hip_circumference", Loop(HIP, [0.0, 1.0, 0.0])),
    ("height", Vertical(CROWN, HEELS)),
    ("shoulder_width", Straight(8_235, 1_557)),       // acromia
    ("torso_height_back", Straight(1_539, 4_181)),    // seventh cervical vertebra to waist
    ("torso_height_front", Straight(1_528, 4_121)),   // suprasternal notch to waist
    ("head_circumference", Loop(HEAD, [0.0, 0.992_876_8, -0.119_145_2])),
    ("neck_circumference", Loop(NECK, [0.0, 0.882_947_6, 0.469_471_6])),
    ("head_height", Vertical(CROWN, [5_296, 5_296])), // to the chin
    ("neck_length_midline", Straight(791, 1_528)),    // under the chin to the notch
    ("neck_length_lateral", Straight(11_882, 8_188)), // below the ear to the side of the neck
    ("hand_size", Straight(10_548, 8_787)),           // wrist to tip of the middle finger
    ("arm_circumference", Loop(ARM, [0.979_287_8, -0.200_567_9, -0.027_712_8])),
    ("arm_length", Straight(8_235, 10_063)),          // acromion to elbow
    ("forearm_circumference", Loop(FOREARM, [0.985_223_0, -0.171_276_5, 0.000_316_5])),
    ("forearm_length", Straight(10_063, 10_548)),     // elbow to wrist
    ("thigh_circumference", Loop(THIGH, [-0.278_090_2, 0.958_940_1, -0.055_675_9])),
    ("thigh_length", Straight(10_902, 11_248)),       // iliac spine to knee
    ("calf_circumference", Loop(CALF, [0.283_341_7, -0.943_886_8, -0.169_691_6])),
    ("calf_length", Straight(11_248, 13_036)),        // knee to ankle
    ("foot_width", Straight(12_390, 12_793)),         // across the balls
    ("heel_to_ball_length", Straight(12_453, 12_390)),
    ("heel_to_toe_length", Straight(12_453, 11_551)),
];

// Vertices spread around each loop: their mean is the plane's origin.
const WAIST: &[u32] = &[
    4108, 4113, 4118, 4121, 10763, 10760, 10757, 10777, 10776, 10779, 10780, 10778, 10781, 10771, 10773,
    10772, 10775, 10774, 10814, 10834, 10816, 10817, 10818, 10819, 10820, 10821, 4181, 4180, 4179, 4178,
    4177, 4176, 4175, 4196, 4173, 4131, 4132, 4129, 4130, 4128, 4138, 4135, 4137, 4136, 4133, 4134,
];
const HIP: &[u32] = &[
    4226, 4227, 4228, 4229, 4230, 4231, 4232, 10866, 10865, 10864, 10863, 10862, 10861, 10875, 10868, 10924,
    10923, 10926, 10925, 10927, 10928, 10967, 10970, 10971, 10969, 10968, 10985, 4341, 4361, 4343, 4344,
    4346, 4345, 4342, 4298, 4297, 4295, 4296, 4293, 4294, 4234, 4242,
];
const HEAD: &[u32] = &[
    229, 230, 233, 235, 234, 7007, 7006, 7003, 7002, 7004, 11868, 10411, 7443, 11810, 7034, 11842, 7040,
    11997, 12160, 12004, 12003, 12002, 7577, 7570, 7660, 11977, 7700, 11984, 11988, 7651, 7652, 7653, 7739,
    7718, 955, 1026, 1047, 954, 953, 952, 5388, 5384, 1006, 5376, 963, 865, 872, 5403, 5404, 5405, 5563,
    5398, 271, 5233, 265, 5199, 720, 3743, 5260, 231,
];
const NECK: &[u32] = &[
    757, 758, 821, 827, 833, 839, 845, 851, 1040, 1032, 857, 7724, 7732, 7562, 7556, 7550, 7544, 7538, 7532,
    7477, 7476, 7491, 7490, 7497, 7632, 10357, 7522, 7519, 7516, 7520, 7518, 809, 805, 807, 802, 806, 810,
    3689, 930, 778, 771, 772,
];
const ARM: &[u32] = &[
    8396, 8397, 8398, 8388, 8387, 8386, 10431, 8385, 8384, 8389, 8383, 8393, 8392, 8391, 8390, 8394, 8395,
    8399, 10455, 10516,
];
const FOREARM: &[u32] = &[
    10103, 10113, 10112, 10111, 10527, 10465, 10114, 10110, 10109, 10105, 10106, 10107, 10108, 10098, 10104,
    10099, 10100, 10541, 10101, 10102,
];
const THIGH: &[u32] = &[
    11069, 11073, 11072, 11075, 11074, 11077, 11076, 11086, 11081, 11080, 11078, 11071, 11079, 11082, 11083,
    12994, 11084, 11085, 11087, 11070,
];
const CALF: &[u32] = &[
    11336, 11353, 11351, 11350, 13008, 11349, 11348, 11345, 11337, 11344, 11346, 11347, 11352, 11342, 11343,
    11340, 11341, 11338, 11339, 11335,
];

/// Number of bodies that the mean body is taken over.
const MEAN_OF: u64 = 512;
/// Number of bodies searched for edges that the nipple plane meets.
const CUT_ON: u64 = 4_096;

/// Defines all measures on the mean body.
///
/// # Errors
/// When a loop cannot be found: the landmarks do not fit the mesh.
pub fn definitions(corpus: &Corpus, mirror: &dyn Fn(u32) -> Option<u32>) -> Result<Vec<Definition>> {
    let bodies: Vec<Vec<Vec3>> = (0..MEAN_OF).into_par_iter().map(|n| corpus.specimen(n).points).collect();
    let mut cage = vec![DVec3::ZERO; cage_of(&bodies[0]).len()];
    for body in &bodies {
        for (sum, p) in cage.iter_mut().zip(body) {
            *sum += p.as_dvec3() / MEAN_OF as f64;
        }
    }
    let mean = corpus.subdivision.refine_f64(&cage)?;
    let surface = Surface::new(corpus);
    let mut out = Vec::new();
    for id in MeasureId::all() {
        let name = id.name();
        let right = id.side() == Some(Side::Right);
        let (_, landmarks) = PLAN
            .iter()
            .find(|p| p.0 == id.base_name())
            .ok_or_else(|| Error::Invalid(format!("no landmarks for {name}")))?;
        let side = |v: u32| -> Result<u32> {
            if !right {
                return Ok(v);
            }
            mirror(v).ok_or_else(|| Error::Source(format!("hm08.mirror: vertex {v} has no mirror image")))
        };
        let one = |v: u32| -> Result<Point> { Ok(Point(vec![(side(v)?, 1.0)])) };
        let mut definition = Definition {
            name: name.to_owned(),
            kind: Kind::Length,
            points: Vec::new(),
            normal: DVec3::ZERO,
            axis: None,
            edges: Vec::new(),
        };
        match landmarks {
            Straight(a, b) => definition.points = vec![one(*a)?, one(*b)?],
            Vertical(a, [b, c]) => {
                let low = if b == c { one(*b)? } else { Point(vec![(*b, 0.5), (*c, 0.5)]) };
                definition.points = vec![one(*a)?, low];
                definition.axis = Some(DVec3::Y);
            }
            Loop(around, normal) => {
                let flip = DVec3::new(if right { -1.0 } else { 1.0 }, 1.0, 1.0);
                definition.kind = Kind::Tape;
                definition.normal = (DVec3::from(*normal) * flip).normalize_or(DVec3::Y);
                let around: Vec<u32> = around.iter().map(|&v| side(v)).collect::<Result<_>>()?;
                definition.points = surface
                    .planar_loop(&mean, &around, definition.normal)
                    .ok_or_else(|| Error::Invalid(format!("{name}: the plane does not cut a closed loop")))?;
            }
            Torso(nipples) => {
                definition.kind = Kind::Slice;
                definition.normal = DVec3::Y;
                definition.points = nipples.iter().map(|&v| one(v)).collect::<Result<_>>()?;
                definition.edges = surface.torso_cuts(corpus, *nipples)?;
            }
        }
        out.push(definition);
    }
    Ok(out)
}

/// The triangulated finest surface's edges: those of the quads and their diagonals 0–2.
struct Surface {
    edges: Vec<[u32; 2]>,
    // Faces (triangles) by their edges, to walk a loop.
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    fn new(corpus: &Corpus) -> Self {
        let mut edges = Vec::new();
        let mut triangles = Vec::new();
        for &[a, b, c, d] in &corpus.subdivision.refined().quads {
            for [p, q] in [[a, b], [b, c], [c, d], [d, a], [a, c]] {
                edges.push([p.min(q), p.max(q)]);
            }
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        edges.sort_unstable();
        edges.dedup();
        Self { edges, triangles }
    }

    /// The loop in which the plane through the mean of `around` cuts the surface, nearest to those vertices.
    fn planar_loop(&self, mean: &[DVec3], around: &[u32], normal: DVec3) -> Option<Vec<Point>> {
        let origin = around.iter().map(|&v| mean[v as usize]).sum::<DVec3>() / around.len() as f64;
        let height = |v: u32| (mean[v as usize] - origin).dot(normal);
        let crossed = |a: u32, b: u32| (height(a) < 0.0) != (height(b) < 0.0);
        // Each crossed triangle joins two crossed edges.
        let key = |a: u32, b: u32| [a.min(b), a.max(b)];
        let mut next: std::collections::BTreeMap<[u32; 2], Vec<[u32; 2]>> = Default::default();
        for &[a, b, c] in &self.triangles {
            let cut: Vec<[u32; 2]> = [[a, b], [b, c], [c, a]]
                .iter()
                .filter(|e| crossed(e[0], e[1]))
                .map(|e| key(e[0], e[1]))
                .collect();
            if let [p, q] = cut[..] {
                next.entry(p).or_default().push(q);
                next.entry(q).or_default().push(p);
            }
        }
        let place = |[a, b]: [u32; 2]| {
            let t = height(a) / (height(a) - height(b));
            (t, mean[a as usize].lerp(mean[b as usize], t))
        };
        let first = mean[around[0] as usize];
        let start = next
            .keys()
            .copied()
            .min_by(|p, q| place(*p).1.distance(first).total_cmp(&place(*q).1.distance(first)))?;
        let mut order = vec![start];
        let (mut previous, mut current) = (start, *next.get(&start)?.first()?);
        while current != start {
            order.push(current);
            let step = next.get(&current)?.iter().copied().find(|n| *n != previous)?;
            (previous, current) = (current, step);
            if order.len() > 2_000 {
                return None;
            }
        }
        Some(
            order
                .into_iter()
                .map(|edge| {
                    // Rounded to keep the file readable; a micrometre is far below any relevant precision.
                    let t = (place(edge).0 * 1e6).round() / 1e6;
                    Point(vec![(edge[0], 1.0 - t), (edge[1], t)])
                })
                .collect(),
        )
    }

    /// Edges of the torso that the nipple plane meets on some body, and two rings more.
    fn torso_cuts(&self, corpus: &Corpus, nipples: [u32; 2]) -> Result<Vec<[u32; 2]>> {
        let rig = &corpus.assets.rig;
        let of_torso = |name: &str| {
            use RigJoint as R;
            // Eyes move no skin, so counting them makes no difference.
            let sided = |joint| matches!(joint, SidedJoint::Clavicle | SidedJoint::Eye);
            match RigJoint::from_name(name) {
                Some(R::Root | R::Pelvis | R::Spine01 | R::Spine02 | R::Spine03) => true,
                joint => joint.and_then(RigJoint::sided).is_some_and(sided),
            }
        };
        // Torso share of each surface vertex, by refining the cage's.
        let share: Vec<Vec3> = rig.weights[..corpus.cage().vertex_count]
            .iter()
            .map(|w| {
                let torso: f32 = w
                    .iter()
                    .filter(|(j, _)| of_torso(&rig.joints[usize::from(*j)].name))
                    .map(|(_, w)| w)
                    .sum();
                Vec3::splat(torso)
            })
            .collect();
        let torso: Vec<bool> = corpus.subdivision.refine(&share)?.iter().map(|s| s.x > 0.5).collect();
        let candidates: Vec<usize> =
            (0..self.edges.len()).filter(|&e| self.edges[e].iter().all(|&v| torso[v as usize])).collect();
        let met: BTreeSet<u32> = (0..CUT_ON)
            .into_par_iter()
            .map(|n| {
                let points = corpus.specimen(n).points;
                let y = |v: u32| -> f32 {
                    corpus.subdivision.stencil(v as usize).map(|(i, w)| points[i as usize].y * w).sum()
                };
                let level = nipples.iter().map(|&v| y(v)).sum::<f32>() / nipples.len() as f32;
                candidates
                    .iter()
                    .map(|&e| self.edges[e])
                    .filter(|&[a, b]| (y(a) < level) != (y(b) < level))
                    .flatten()
                    .collect::<BTreeSet<u32>>()
            })
            .reduce(BTreeSet::new, |mut a, mut b| {
                a.append(&mut b);
                a
            });
        let mut wide = met;
        for _ in 0..2 {
            let ring: Vec<u32> = self
                .triangles
                .iter()
                .filter(|t| t.iter().any(|v| wide.contains(v)))
                .flatten()
                .copied()
                .filter(|&v| torso[v as usize])
                .collect();
            wide.extend(ring);
        }
        Ok(candidates
            .into_iter()
            .map(|e| self.edges[e])
            .filter(|e| e.iter().all(|v| wide.contains(v)))
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_measure_has_its_landmarks() {
        for id in MeasureId::all() {
            let base = id.base_name();
            assert_eq!(PLAN.iter().filter(|p| p.0 == base).count(), 1, "{base}");
        }
        for (name, landmarks) in PLAN {
            if let Loop(around, normal) = landmarks {
                assert!(around.len() >= 20, "{name}");
                assert!((DVec3::from(*normal).length() - 1.0).abs() < 1e-6, "{name}");
            }
        }
    }

    #[test]
    fn a_tilted_plane_cuts_a_tube_in_one_planar_loop() {
        // A tube of 12 sides and 8 floors around the y axis, radius 1.
        let (sides, floors) = (12_u32, 8_u32);
        let at = |floor: u32, side: u32| floor * sides + side % sides;
        let mut triangles = Vec::new();
        for floor in 0..floors {
            for side in 0..sides {
                let [a, b, c, d] =
                    [at(floor, side), at(floor, side + 1), at(floor + 1, side + 1), at(floor + 1, side)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let mean: Vec<DVec3> = (0..(floors + 1) * sides)
            .map(|v| {
                let angle = f64::from(v % sides) * std::f64::consts::TAU / f64::from(sides);
                DVec3::new(libm::cos(angle), f64::from(v / sides), libm::sin(angle))
            })
            .collect();
        let surface = Surface { edges: Vec::new(), triangles };
        let around: Vec<u32> = (0..sides).map(|side| at(4, side)).collect();
        let normal = DVec3::new(0.1, 1.0, 0.05).normalize_or(DVec3::Y);
        let cut = surface.planar_loop(&mean, &around, normal).unwrap();
        // Through every side's upright edge and its diagonal, and twice through the floor that it is tilted across.
        assert_eq!(cut.len(), 2 * sides as usize + 2);
        let place = |p: &Point| -> DVec3 { p.0.iter().map(|(v, w)| mean[*v as usize] * *w).sum() };
        let origin = DVec3::new(0.0, 4.0, 0.0);
        for point in &cut {
            assert!((place(point) - origin).dot(normal).abs() < 1e-6, "{point:?}");
            assert!((point.0.iter().map(|p| p.1).sum::<f64>() - 1.0).abs() < 1e-12);
        }
        // Neighbours in the loop are neighbours on the tube.
        let longest = cut.iter().zip(cut.iter().cycle().skip(1)).map(|(a, b)| place(a).distance(place(b)));
        assert!(longest.fold(0.0, f64::max) < 0.6);
        // A plane beside the tube cuts nothing.
        assert!(surface.planar_loop(&mean, &[at(0, 0)], DVec3::Y).is_none());
    }
}
