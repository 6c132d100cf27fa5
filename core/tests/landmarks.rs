//! Landmarks on a thousand bodies of the trained model: each stays where its name says.

use std::sync::Mutex;

use anthronet::Side;
use anthronet::condition::{Fill, Request};
use anthronet::measure::Sex;
use anthronet::model::Model;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A body's landmarks by name, metres, and its vertices.
struct Marked<'a> {
    model: &'a Model,
    positions: Vec<DVec3>,
    vertices: Vec<Vec3>,
}

impl Marked<'_> {
    fn at(&self, name: &str) -> DVec3 {
        let index = self.model.landmarks().iter().position(|landmark| landmark.name == name);
        self.positions[index.unwrap_or_else(|| panic!("no landmark {name}"))]
    }

    fn on(&self, base: &str, side: Side) -> DVec3 {
        self.at(&format!("{base}{}", side.measure_suffix()))
    }
}

/// Calls `check` with people of both sexes, drawn over the whole range of the model.
fn on_a_thousand(check: impl Fn(&Marked<'_>, &str) + Sync) {
    let model = Model::embedded().unwrap_or_else(|e| panic!("{e}"));
    (0..1_000_u64).into_par_iter().for_each(|seed| {
        let sex = Sex::ALL[(seed % 2) as usize];
        let request = Request { sex: Some(sex), seed, fill: Fill::Sample, ..Request::default() };
        let body = model.generate(&request).unwrap_or_else(|e| panic!("{e}"));
        let vertices = body.vertices().to_vec();
        let positions = model.landmarks().positions(|v| vertices[v as usize].as_dvec3());
        check(&Marked { model: &model, positions, vertices }, &format!("{sex} of seed {seed}"));
    });
}

/// Landmarks from top to bottom.
const DOWN: [&[&str]; 4] = [
    &["vertex", "glabella", "sellion", "menton", "infrathyroid", "suprasternale", "omphalion", "crotch"],
    &["vertex", "tragion", "gonion", "neck_side", "acromion", "axilla", "tenth_rib", "iliocristale"],
    &["iliocristale", "anterior_superior_iliac_spine", "trochanterion", "gluteal_fold", "suprapatella"],
    &["suprapatella", "midpatella", "tibiale", "medial_malleolus", "pternion"],
];
/// Landmarks from the middle outwards along the arm of the T-pose.
const OUT: [&str; 7] =
    ["neck_side", "acromion", "olecranon", "radiale", "stylion", "metacarpale_2", "dactylion_3"];

/// One test, as drawing the people takes longest.
#[test]
fn landmarks_stay_where_their_names_say() {
    let worst = Mutex::new(vec![(0.0_f64, String::new()); FURTHEST.len()]);
    on_a_thousand(|body, who| {
        keep_their_order(body, who);
        are_symmetric(body, who);
        slips(body, who, &worst);
    });
    let worst = worst.into_inner().unwrap();
    let beyond: Vec<_> = worst.iter().zip(FURTHEST).filter(|(worst, row)| worst.0 >= row.3).collect();
    assert!(beyond.is_empty(), "{beyond:#?}");
}

fn keep_their_order(body: &Marked<'_>, who: &str) {
    for side in Side::ALL {
        let at = |base: &&str| {
            let central = body.model.landmarks().find(base).is_some();
            if central { body.at(base) } else { body.on(base, side) }
        };
        for names in DOWN {
            for pair in names.windows(2) {
                let [above, below] = [at(&pair[0]), at(&pair[1])];
                assert!(above.y > below.y, "{who}: {pair:?} {above} {below}");
            }
        }
        for pair in OUT.windows(2) {
            let [inner, outer] = [at(&pair[0]), at(&pair[1])].map(|p| p.x * f64::from(side.sign()));
            assert!(inner < outer, "{who}: {pair:?} {inner} {outer}");
        }
    }
}

/// Sides of the sources' bodies differ by a standard deviation of 3 % of a slider, toes by 12 %.
fn are_symmetric(body: &Marked<'_>, who: &str) {
    for landmark in body.model.landmarks().iter() {
        let position = body.at(&landmark.name);
        match Side::split_measure_name(&landmark.name) {
            (_, None) => assert!(position.x.abs() < 0.003, "{who}: {} {position}", landmark.name),
            (base, Some(Side::Left)) => {
                let other = body.on(base, Side::Right);
                let apart = position.distance(other * DVec3::new(-1.0, 1.0, 1.0));
                assert!(apart < 0.03, "{who}: {base} {apart}");
            }
            _ => {}
        }
    }
}

/// Landmarks that are the furthest point of their part in a direction, the part (within so many metres of the landmark), and
/// how far beyond it another point of the part may lie, metres: a quarter more than on the worst of these people.
#[rustfmt::skip]
const FURTHEST: &[(&str, DVec3, f64, f64)] = &[
    ("vertex", DVec3::Y, 0.2, 0.006),
    ("menton", DVec3::NEG_Y, 0.012, 0.0065),
    ("bustpoint", DVec3::Z, 0.02, 0.009),
    ("buttock_point", DVec3::NEG_Z, 0.08, 0.022),
    ("pternion", DVec3::NEG_Z, 0.06, 0.0065),
    ("acropodion", DVec3::Z, 0.2, 0.004),
    ("dactylion_3", DVec3::X, 0.2, 0.002),
    ("lateral_malleolus", DVec3::X, 0.02, 0.006),
    ("medial_malleolus", DVec3::NEG_X, 0.02, 0.006),
    ("crotch", DVec3::NEG_Y, 0.008, 0.008),
];

/// Keeps the worst slip of each row of [`FURTHEST`], metres, and whose it is.
fn slips(body: &Marked<'_>, who: &str, worst: &Mutex<Vec<(f64, String)>>) {
    for (row, &(base, direction, part, _)) in FURTHEST.iter().enumerate() {
        let central = body.model.landmarks().find(base).is_some();
        for side in if central { &Side::ALL[..1] } else { &Side::ALL } {
            let name = if central { base.to_owned() } else { format!("{base}{}", side.measure_suffix()) };
            let direction = direction * DVec3::new(f64::from(side.sign()), 1.0, 1.0);
            let from = body.at(&name);
            let nearby = body.vertices.iter().map(|v| v.as_dvec3() - from).filter(|d| d.length() < part);
            let furthest = nearby.map(|d| d.dot(direction)).fold(0.0, f64::max);
            let mut worst = worst.lock().unwrap_or_else(|e| panic!("{e}"));
            if furthest > worst[row].0 {
                worst[row] = (furthest, format!("{who}: {name}"));
            }
        }
    }
}
