//! Makes `model/standing.json` and `model/measures.json`: landmarks and planes become turns, loops and points of the mesh.
//!
//! A tape's loop is the cut of the mean body's surface, in the measure's stance, by the measure's plane, as places on edges:
//! planar on the mean body, so it reads there what a tape reads. (A loop of whole vertices zigzags: −9 mm at the neck.) The
//! chest is cut anew on every body, because no fixed loop stays on the bust; its candidate edges are those that
//! the nipple plane meets on some body, two rings wider.

use std::collections::BTreeSet;

use anthronet::Side;
use anthronet::measure::{Definition, Kind, Landmark, MeasureId, Point, Stance, Turn};
use anthronet::skeleton::{RigJoint, SidedJoint};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::corpus::{Corpus, cage_of};
use crate::{Error, Result};

/// An end of a length; landmarks with two sides are the measure's own unless `opposite`.
#[derive(Clone, Copy, Debug)]
struct End {
    mark: Mark,
    /// The joint that carries it as bone does; of a pair, the one on the landmark's side.
    bone: Option<SidedJoint>,
    opposite: bool,
}

#[derive(Clone, Copy, Debug)]
enum Mark {
    /// A landmark by its name without side.
    Landmark(&'static str),
    /// The mean of a landmark's two sides.
    Middle(&'static str),
    /// A vertex of the cage; given on the left.
    Vertex(u32),
    /// The lowest vertices of the heels.
    Floor,
}

const fn at(name: &'static str) -> End {
    End { mark: Mark::Landmark(name), bone: None, opposite: false }
}
const fn across(name: &'static str) -> End {
    End { mark: Mark::Landmark(name), bone: None, opposite: true }
}
const fn vertex(v: u32) -> End {
    End { mark: Mark::Vertex(v), bone: None, opposite: false }
}
const FLOOR: End = End { mark: Mark::Floor, bone: None, opposite: false };

impl End {
    const fn on(self, bone: SidedJoint) -> Self {
        Self { bone: Some(bone), ..self }
    }
}

/// A plane, and the loop of it that is meant.
#[derive(Clone, Copy, Debug)]
enum Plane {
    /// Through a mark; its loop nearest to that mark, or to a vertex.
    Through(Mark, Option<u32>, [f64; 3]),
    /// Through the mean of vertices, its loop nearest to the first of them.
    Around(&'static [u32], [f64; 3]),
}

/// How a measure is taken on the body; sided ones are given for the left.
#[derive(Clone, Copy, Debug)]
enum How {
    /// Distance between two ends.
    Straight(End, End),
    /// The same along an axis.
    Along([f64; 3], End, End),
    /// Distance between two ends along the line from one mark to another on the mean body.
    Parallel(End, End, [&'static str; 2]),
    /// Perimeter of a loop.
    Around(Plane),
    /// Extent of a loop along an axis.
    Wide([f64; 3], Plane),
    /// Extent along x of the arms' skin between the levels of two landmarks.
    Shoulders([&'static str; 2]),
    /// Horizontal cut over the torso at the mean of a landmark's two sides.
    Torso(&'static str),
    /// From the highest to the lowest point of the skin.
    Stature,
}
use How::{Along, Around, Parallel, Shoulders, Stature, Straight, Torso, Wide};
use Plane::Through;
use Stance::{Standing as S, TPose as T};

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

const ACROMION: End = at("acromion").on(SidedJoint::Clavicle);
const ELBOW: End = at("radiale").on(SidedJoint::Upperarm);

const fn level(name: &'static str) -> Plane {
    Through(Mark::Landmark(name), None, Y)
}
const HIPS: Plane = Through(Mark::Middle("buttock_point"), Some(10_854), Y);
const NECK_PLANE: [f64; 3] = [0.0, 0.939_692_6, 0.342_020_1];

/// Name without side, stance and how it is taken (left side).
#[rustfmt::skip]
const PLAN: &[(&str, Stance, How)] = &[
    ("waist_circumference", T, Around(level("omphalion"))),
    ("chest_circumference", S, Torso("bustpoint")),
    ("hip_circumference", S, Around(HIPS)),
    ("height", T, Stature),
    ("shoulder_width", S, Along(X, ACROMION, across("acromion").on(SidedJoint::Clavicle))),
    ("torso_height_back", T, Straight(at("cervicale"), vertex(4_181))),
    ("torso_height_front", T, Straight(at("suprasternale"), at("omphalion"))),
    ("head_circumference", T, Around(Plane::Around(HEAD, [0.0, 0.992_876_8, -0.119_145_2]))),
    ("neck_circumference", T, Around(Through(Mark::Landmark("infrathyroid"), None, NECK_PLANE))),
    ("head_height", T, Along(Y, at("vertex"), at("menton"))),
    ("neck_length_midline", T, Straight(vertex(791), at("suprasternale"))), // from under the chin
    ("neck_length_lateral", T, Straight(at("tragion"), at("cervicale"))),
    ("hand_size", T, Straight(at("stylion"), at("dactylion_3"))),
    ("arm_circumference", T, Around(Plane::Around(ARM, [0.979_287_8, -0.200_567_9, -0.027_712_8]))),
    ("arm_length", S, Straight(ACROMION, ELBOW)),
    ("forearm_circumference", T, Around(Plane::Around(FOREARM, [0.985_223_0, -0.171_276_5, 0.000_316_5]))),
    ("forearm_length", T, Straight(at("radiale"), at("stylion"))),
    ("thigh_circumference", S, Around(Through(Mark::Landmark("gluteal_fold"), None, Y))),
    ("thigh_length", T, Straight(at("trochanterion"), at("lateral_femoral_epicondyle"))),
    ("calf_circumference", T, Around(Plane::Around(CALF, [0.283_341_7, -0.943_886_8, -0.169_691_6]))),
    ("calf_length", T, Straight(at("lateral_femoral_epicondyle"), at("lateral_malleolus"))),
    ("foot_width", T, Straight(at("first_metatarsophalangeal"), at("fifth_metatarsophalangeal"))),
    ("heel_to_ball_length", T, Parallel(at("pternion"), at("first_metatarsophalangeal"), ["pternion", "acropodion"])),
    ("heel_to_toe_length", T, Straight(at("pternion"), at("acropodion"))),
];

/// What the sampling is fitted to besides the measures: columns of ANSUR II that such a body can show, with a weight, lower
/// where ours only resembles the survey's: it takes the side of the neck and the level of the hips' breadth elsewhere. Chest
/// breadth and depth are left out: the survey's make an oval whose girth is a fifth below its own.
#[rustfmt::skip]
const FITTED: &[(&str, f64, Stance, How)] = &[
    ("acromialheight", 1.0, S, Along(Y, ACROMION, FLOOR)),
    ("cervicaleheight", 1.0, S, Along(Y, at("cervicale"), FLOOR)),
    ("suprasternaleheight", 1.0, S, Along(Y, at("suprasternale"), FLOOR)),
    ("tenthribheight", 1.0, S, Along(Y, at("tenth_rib"), FLOOR)),
    ("waistheightomphalion", 1.0, S, Along(Y, at("omphalion"), FLOOR)),
    ("iliocristaleheight", 1.0, S, Along(Y, at("iliocristale"), FLOOR)),
    ("trochanterionheight", 0.3, S, Along(Y, at("trochanterion").on(SidedJoint::Thigh), FLOOR)),
    ("crotchheight", 1.0, S, Along(Y, at("crotch"), FLOOR)),
    ("kneeheightmidpatella", 1.0, S, Along(Y, at("midpatella"), FLOOR)),
    ("tibialheight", 1.0, S, Along(Y, at("tibiale"), FLOOR)),
    ("lateralmalleolusheight", 1.0, S, Along(Y, at("lateral_malleolus"), FLOOR)),
    ("bideltoidbreadth", 1.0, S, Shoulders(["acromion", "axilla"])),
    ("waistbreadth", 1.0, T, Wide(X, level("omphalion"))),
    ("waistdepth", 1.0, T, Wide(Z, level("omphalion"))),
    ("hipbreadth", 0.6, S, Wide(X, Through(Mark::Middle("trochanterion"), Some(10_932), Y))),
    ("buttockdepth", 1.0, S, Wide(Z, HIPS)),
    ("neckcircumferencebase", 0.1, T, Around(Plane::Around(NECK, [0.0, 0.882_947_6, 0.469_471_6]))),
    ("wristcircumference", 1.0, T, Around(Through(Mark::Landmark("stylion"), None, X))),
    ("lowerthighcircumference", 1.0, S, Around(Through(Mark::Landmark("suprapatella"), None, Y))),
    ("headlength", 1.0, T, Along(Z, at("glabella"), vertex(955))),
    ("bizygomaticbreadth", 1.0, T, Along(X, at("zygion"), across("zygion"))),
    ("mentonsellionlength", 1.0, T, Straight(at("menton"), at("sellion"))),
    ("tragiontopofhead", 1.0, T, Along(Y, at("vertex"), at("tragion"))),
    ("shoulderlength", 0.1, S, Straight(at("neck_side"), ACROMION)),
    ("span", 0.3, T, Along(X, at("dactylion_3"), across("dactylion_3"))),
    ("handbreadth", 1.0, T, Straight(at("metacarpale_2"), at("metacarpale_5"))),
    ("bimalleolarbreadth", 1.0, T, Straight(at("lateral_malleolus"), at("medial_malleolus"))),
];

/// Landmarks with weights.
type Weighted = &'static [(&'static str, f64)];

/// The turns from the T-pose to the standing body, of the left side, degrees, each with its centre: landmarks with weights, those
/// of the other side last.
///
/// Shoulders come down by 6° and arms by 78° in all, as arms hang beside the hips; legs are closed by the 5° that the T-pose
/// spreads them. Centres lie where the joints do: at the collarbone's inner end; below the acromion, two fifths of the way to the
/// hollow of the armpit; at the height of the trochanter, half as far from the middle (Harrington et al. 2007 have the hip joint
/// at 0.33 of the distance of the iliac spines plus 7 mm).
const TURNS: [(SidedJoint, f64, Weighted, Weighted); 3] = [
    (SidedJoint::Clavicle, -6.0, &[("suprasternale", 0.88), ("acromion", 0.12)], &[]),
    (SidedJoint::Upperarm, -72.0, &[("acromion", 0.62), ("axilla", 0.38)], &[]),
    (SidedJoint::Thigh, -5.0, &[("trochanterion", 0.76)], &[("trochanterion", 0.24)]),
];

// Vertices spread around each loop: their mean is the plane's origin.
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
const CALF: &[u32] = &[
    11336, 11353, 11351, 11350, 13008, 11349, 11348, 11345, 11337, 11344, 11346, 11347, 11352, 11342, 11343,
    11340, 11341, 11338, 11339, 11335,
];

/// Number of bodies that the mean body is taken over.
const MEAN_OF: u64 = 512;
/// Number of bodies searched for edges that the nipple plane meets, and for highest and lowest points.
const CUT_ON: u64 = 4_096;
/// Depth of the parts of the mean body that are searched for highest and lowest points, metres.
const ENDS: f64 = 0.04;
/// Vertices of the cage under the heels.
const UNDER_HEELS: [u32; 2] = crate::assets::HEELS;

/// The turns of `model/standing.json`.
///
/// # Errors
/// [`Error::Invalid`] for a landmark that does not exist.
pub fn turns(landmarks: &[Landmark]) -> Result<Vec<Turn>> {
    let mut turns = Vec::new();
    for side in Side::ALL {
        for (joint, degrees, own, opposite) in TURNS {
            let mut terms = Vec::new();
            for (of, side) in [(own, side), (opposite, side.mirrored())] {
                for (name, weight) in of {
                    let point = landmark(landmarks, name, Some(side))?;
                    terms.extend(point.0.iter().map(|(v, w)| (*v, w * weight)));
                }
            }
            let sign = if side == Side::Left { 1.0 } else { -1.0 };
            let joint = joint.on(side).name().to_owned();
            turns.push(Turn { joint, centre: Point(terms), degrees: sign * degrees });
        }
    }
    Ok(turns)
}

/// The point of a landmark, on this side if it has two.
fn landmark(landmarks: &[Landmark], name: &str, side: Option<Side>) -> Result<Point> {
    let sided = side.map(|side| format!("{name}{}", side.measure_suffix()));
    let found = landmarks.iter().find(|l| l.name == name || Some(&l.name) == sided.as_ref());
    found.map(|l| l.point.clone()).ok_or_else(|| Error::Invalid(format!("no landmark {name}")))
}

/// Defines measures on the mean body.
pub struct Definer<'a> {
    corpus: &'a Corpus,
    landmarks: &'a [Landmark],
    surface: Surface,
    /// The mean body in the T-pose, and standing.
    mean: [Vec<DVec3>; 2],
}

impl<'a> Definer<'a> {
    /// Computes the mean body.
    ///
    /// # Errors
    /// When the landmarks do not fit the mesh.
    pub fn new(corpus: &'a Corpus, landmarks: &'a [Landmark]) -> Result<Self> {
        let bodies: Vec<Vec<Vec3>> =
            (0..MEAN_OF).into_par_iter().map(|n| corpus.specimen(n).points).collect();
        let mut cage = vec![DVec3::ZERO; cage_of(&bodies[0]).len()];
        for body in &bodies {
            for (sum, p) in cage.iter_mut().zip(body) {
                *sum += p.as_dvec3() / MEAN_OF as f64;
            }
        }
        let mean = corpus.subdivision.refine_f64(&cage)?;
        let turns = turns(landmarks)?;
        let standing = corpus.with_standing(&turns, |standing| {
            let stands =
                |v: usize| standing.place(&Point(vec![(v as u32, 1.0)])).position(|v| mean[v as usize]);
            Ok((0..mean.len()).map(stands).collect())
        })?;
        Ok(Self { corpus, landmarks, surface: Surface::new(corpus), mean: [mean, standing] })
    }

    /// All measures of the catalogue.
    ///
    /// # Errors
    /// When a loop cannot be found: the landmarks do not fit the mesh.
    pub fn measures(&self) -> Result<Vec<Definition>> {
        MeasureId::all()
            .map(|id| {
                let row = PLAN.iter().find(|row| row.0 == id.base_name());
                let row = row.ok_or_else(|| Error::Invalid(format!("no landmarks for {id}")))?;
                self.define(id.name(), id.side(), row.1, row.2)
            })
            .collect()
    }

    /// Columns of ANSUR II that no measure of the catalogue is, as they are taken on the right side, and the weight of each.
    ///
    /// # Errors
    /// As [`measures`](Self::measures).
    pub fn columns(&self) -> Result<Vec<(Definition, f64)>> {
        FITTED.iter().map(|row| Ok((self.define(row.0, Some(Side::Right), row.2, row.3)?, row.1))).collect()
    }

    fn define(&self, name: &str, side: Option<Side>, stance: Stance, how: How) -> Result<Definition> {
        let mut definition = Definition {
            name: name.to_owned(),
            kind: Kind::Length,
            stance,
            points: Vec::new(),
            bones: Vec::new(),
            normal: DVec3::ZERO,
            axis: None,
            edges: Vec::new(),
        };
        let own = side.unwrap_or(Side::Left);
        let ends = |definition: &mut Definition, ends: [End; 2]| -> Result<()> {
            let mut bones = Vec::new();
            for end in ends {
                let side = if end.opposite { own.mirrored() } else { own };
                definition.points.push(self.point(end.mark, side)?);
                bones.push(end.bone.map(|joint| joint.on(side).name().to_owned()));
            }
            if bones.iter().any(Option::is_some) {
                definition.bones = bones;
            }
            Ok(())
        };
        let sided = |v: [f64; 3]| match own {
            Side::Left => DVec3::from(v),
            Side::Right => DVec3::from(v) * DVec3::new(-1.0, 1.0, 1.0),
        };
        match how {
            Straight(a, b) => ends(&mut definition, [a, b])?,
            Along(axis, a, b) => {
                ends(&mut definition, [a, b])?;
                definition.axis = Some(axis.into());
            }
            Parallel(a, b, line) => {
                ends(&mut definition, [a, b])?;
                let [from, to] = line.map(|name| self.place(stance, Mark::Landmark(name), own));
                definition.axis = Some(rounded((to? - from?).normalize_or(DVec3::Z)));
            }
            Around(plane) => {
                definition.kind = Kind::Tape;
                let (points, normal) = self.looped(name, stance, plane, own)?;
                (definition.points, definition.normal) = (points, normal);
            }
            Wide(axis, plane) => {
                definition.kind = Kind::Extent;
                definition.points = self.looped(name, stance, plane, own)?.0;
                definition.axis = Some(sided(axis).abs());
            }
            Shoulders([above, below]) => {
                definition.kind = Kind::Extent;
                let [high, low] =
                    [above, below].map(|name| self.place(stance, Mark::Landmark(name), Side::Left));
                let (high, low) = (high?.y, low?.y);
                let wide = self.place(stance, Mark::Landmark(above), Side::Left)?.x;
                let mean = self.mean_in(stance);
                let outer = (0..self.corpus.cage().vertex_count as u32).filter(|v| {
                    let p = mean[*v as usize];
                    p.x.abs() > wide && p.x.abs() < wide + 0.12 && p.y < high && p.y > low
                });
                definition.points = outer.map(|v| Point(vec![(v, 1.0)])).collect();
                definition.axis = Some(DVec3::X);
            }
            Torso(name) => {
                definition.kind = Kind::Slice;
                definition.normal = DVec3::Y;
                let sides = [
                    self.point(Mark::Landmark(name), Side::Left)?,
                    self.point(Mark::Landmark(name), Side::Right)?,
                ];
                definition.edges = self.surface.torso_cuts(self.corpus, &sides)?;
                definition.points = sides.to_vec();
            }
            Stature => {
                definition.kind = Kind::Extent;
                definition.points =
                    self.highest_and_lowest()?.into_iter().map(|v| Point(vec![(v, 1.0)])).collect();
                definition.axis = Some(DVec3::Y);
            }
        }
        Ok(definition)
    }

    fn mean_in(&self, stance: Stance) -> &[DVec3] {
        &self.mean[usize::from(stance == Stance::Standing)]
    }

    fn mirrored(&self, v: u32, side: Side) -> Result<u32> {
        match side {
            Side::Left => Ok(v),
            Side::Right => {
                let mirror = self.corpus.assets.mesh.mirror.get(&v).copied();
                mirror.ok_or_else(|| Error::Source(format!("hm08.mirror: vertex {v} has no mirror image")))
            }
        }
    }

    fn point(&self, mark: Mark, side: Side) -> Result<Point> {
        let mean_of = |points: [Point; 2]| {
            Point(points.iter().flat_map(|p| p.0.iter().map(|(v, w)| (*v, 0.5 * w))).collect())
        };
        Ok(match mark {
            Mark::Landmark(name) => landmark(self.landmarks, name, Some(side))?,
            Mark::Middle(name) => mean_of([
                landmark(self.landmarks, name, Some(Side::Left))?,
                landmark(self.landmarks, name, Some(Side::Right))?,
            ]),
            Mark::Vertex(v) => Point(vec![(self.mirrored(v, side)?, 1.0)]),
            Mark::Floor => mean_of(UNDER_HEELS.map(|v| Point(vec![(v, 1.0)]))),
        })
    }

    /// Where a mark lies on the mean body.
    fn place(&self, stance: Stance, mark: Mark, side: Side) -> Result<DVec3> {
        let mean = self.mean_in(stance);
        Ok(self.point(mark, side)?.position(|v| mean[v as usize]))
    }

    fn looped(&self, name: &str, stance: Stance, plane: Plane, side: Side) -> Result<(Vec<Point>, DVec3)> {
        let mean = self.mean_in(stance);
        let flip = DVec3::new(if side == Side::Right { -1.0 } else { 1.0 }, 1.0, 1.0);
        let (origin, near, normal) = match plane {
            Through(mark, near, normal) => {
                let origin = self.place(stance, mark, side)?;
                let near = match near {
                    Some(v) => mean[self.mirrored(v, side)? as usize],
                    None => origin,
                };
                (origin, near, normal)
            }
            Plane::Around(around, normal) => {
                let around = around.iter().map(|&v| self.mirrored(v, side)).collect::<Result<Vec<u32>>>()?;
                let origin = around.iter().map(|&v| mean[v as usize]).sum::<DVec3>() / around.len() as f64;
                (origin, mean[around[0] as usize], normal)
            }
        };
        let normal = (DVec3::from(normal) * flip).normalize_or(DVec3::Y);
        let points = self.surface.planar_loop(mean, origin, near, normal);
        let points =
            points.ok_or_else(|| Error::Invalid(format!("{name}: the plane does not cut a closed loop")))?;
        Ok((points, normal))
    }

    /// Vertices that are the highest or the lowest of some body, and two rings more.
    fn highest_and_lowest(&self) -> Result<BTreeSet<u32>> {
        let mean = self.mean_in(Stance::TPose);
        let heights = || mean.iter().map(|p| p.y);
        let (top, bottom) = (heights().fold(f64::MIN, f64::max), heights().fold(f64::MAX, f64::min));
        let near: Vec<u32> = (0..mean.len() as u32)
            .filter(|v| mean[*v as usize].y > top - ENDS || mean[*v as usize].y < bottom + ENDS)
            .collect();
        let met: BTreeSet<u32> = (0..CUT_ON)
            .into_par_iter()
            .flat_map_iter(|n| {
                let points = self.corpus.specimen(n).points;
                let y = |v: &u32| -> f32 {
                    self.corpus.subdivision.stencil(*v as usize).map(|(i, w)| points[i as usize].y * w).sum()
                };
                let high = near.iter().max_by(|a, b| y(a).total_cmp(&y(b)));
                let low = near.iter().min_by(|a, b| y(a).total_cmp(&y(b)));
                [high, low].into_iter().flatten().copied().collect::<Vec<_>>()
            })
            .collect();
        Ok(self.surface.widened(met, 2, |v| near.binary_search(&v).is_ok()))
    }
}

/// A direction with six decimals, still of unit length within 1e-6.
fn rounded(direction: DVec3) -> DVec3 {
    (direction * 1e6).round() / 1e6
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

    /// The loop in which the plane through `origin` cuts the surface, the one nearest to `near`.
    fn planar_loop(&self, mean: &[DVec3], origin: DVec3, near: DVec3, normal: DVec3) -> Option<Vec<Point>> {
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
        let start = next
            .keys()
            .copied()
            .min_by(|p, q| place(*p).1.distance(near).total_cmp(&place(*q).1.distance(near)))?;
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
    fn torso_cuts(&self, corpus: &Corpus, nipples: &[Point; 2]) -> Result<Vec<[u32; 2]>> {
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
                let terms = nipples.iter().flat_map(|p| &p.0);
                let level = terms.map(|(v, w)| y(*v) * *w as f32).sum::<f32>() / nipples.len() as f32;
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
        let wide = self.widened(met, 2, |v| torso[v as usize]);
        Ok(candidates
            .into_iter()
            .map(|e| self.edges[e])
            .filter(|e| e.iter().all(|v| wide.contains(v)))
            .collect())
    }

    /// These vertices and those within so many rings around them that are `allowed`.
    fn widened(&self, mut wide: BTreeSet<u32>, rings: usize, allowed: impl Fn(u32) -> bool) -> BTreeSet<u32> {
        for _ in 0..rings {
            let ring: Vec<u32> = self
                .triangles
                .iter()
                .filter(|t| t.iter().any(|v| wide.contains(v)))
                .flatten()
                .copied()
                .filter(|&v| allowed(v))
                .collect();
            wide.extend(ring);
        }
        wide
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
        for (name, _, how) in PLAN {
            if let Around(Plane::Around(around, normal)) = how {
                assert!(around.len() >= 20, "{name}");
                assert!((DVec3::from(*normal).length() - 1.0).abs() < 1e-6, "{name}");
            }
        }
    }

    #[test]
    fn columns_are_the_surveys() {
        let statistics = crate::survey::committed().unwrap();
        let women = &statistics["ansur2"].female;
        for (name, ..) in FITTED {
            women.column(name).unwrap();
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
        let origin = DVec3::new(0.0, 4.0, 0.0);
        let normal = DVec3::new(0.1, 1.0, 0.05).normalize_or(DVec3::Y);
        let cut = surface.planar_loop(&mean, origin, mean[at(4, 0) as usize], normal).unwrap();
        // Through every side's upright edge and its diagonal, and twice through the floor that it is tilted across.
        assert_eq!(cut.len(), 2 * sides as usize + 2);
        let place = |p: &Point| -> DVec3 { p.0.iter().map(|(v, w)| mean[*v as usize] * *w).sum() };
        for point in &cut {
            assert!((place(point) - origin).dot(normal).abs() < 1e-6, "{point:?}");
            assert!((point.0.iter().map(|p| p.1).sum::<f64>() - 1.0).abs() < 1e-12);
        }
        // Neighbours in the loop are neighbours on the tube.
        let longest = cut.iter().zip(cut.iter().cycle().skip(1)).map(|(a, b)| place(a).distance(place(b)));
        assert!(longest.fold(0.0, f64::max) < 0.6);
        // A plane beside the tube cuts nothing.
        assert!(surface.planar_loop(&mean, mean[0], mean[0], DVec3::Y).is_none());
    }
}
