//! Measures against true planar cuts of the same body: loops are an approximation, and this holds how good.

use anthronet::condition::{Fill, Request};
use anthronet::measure::{Definition, Kind, Sex};
use anthronet::model::Model;
use glam::{DVec2, DVec3};

/// Perimeter of the convex hull by gift wrapping: slow, and not the library's way.
fn hull_perimeter(points: &[DVec2]) -> f64 {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let Some(start) = (0..points.len()).min_by(|&a, &b| points[a].x.total_cmp(&points[b].x)) else {
        return 0.0;
    };
    let (mut at, mut sum) = (start, 0.0);
    for _ in 0..points.len() {
        let mut next = (at + 1) % points.len();
        for k in 0..points.len() {
            if (points[next] - points[at]).perp_dot(points[k] - points[at]) < 0.0 {
                next = k;
            }
        }
        sum += points[at].distance(points[next]);
        at = next;
        if at == start {
            break;
        }
    }
    sum
}

/// Where the plane cuts the triangulated surface, near `centre`.
fn cut(vertices: &[glam::Vec3], quads: &[[u32; 4]], centre: DVec3, normal: DVec3, reach: f64) -> Vec<DVec3> {
    let at = |v: u32| vertices[v as usize].as_dvec3();
    let mut out = Vec::new();
    for &[a, b, c, d] in quads {
        for [p, q] in [[a, b], [b, c], [c, d], [d, a], [a, c]] {
            // One order for both faces of an edge, so that both cut it at the very same place.
            let (x, y) = (at(p.min(q)), at(p.max(q)));
            let (h, k) = ((x - centre).dot(normal), (y - centre).dot(normal));
            if (h < 0.0) != (k < 0.0) {
                let place = x.lerp(y, h / (h - k));
                if place.distance(centre) < reach {
                    out.push(place);
                }
            }
        }
    }
    out
}

fn flat(points: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let (e1, e2) = normal.any_orthonormal_pair();
    points.iter().map(|p| DVec2::new(p.dot(e1), p.dot(e2))).collect()
}

#[test]
fn tapes_read_what_a_planar_cut_reads() {
    let model = Model::embedded().unwrap();
    let people: Vec<_> = (1..=24)
        .map(|seed| {
            let sex = Some(Sex::ALL[seed as usize % 2]);
            model.generate(&Request { sex, seed, fill: Fill::Sample, ..Request::default() }).unwrap()
        })
        .collect();
    // Bias and spread over people that are accepted, metres. The prototype's neck loop had -10 ± 10 mm.
    let limits = [
        ("waist_circumference", 0.006, 0.012),
        ("hip_circumference", 0.006, 0.008),
        ("head_circumference", 0.005, 0.006),
        ("neck_circumference", 0.006, 0.0095),
        ("arm_circumference_left", 0.004, 0.006),
        ("forearm_circumference_right", 0.004, 0.004),
        ("thigh_circumference_left", 0.004, 0.006),
        ("thigh_circumference_right", 0.004, 0.006),
        ("calf_circumference_left", 0.004, 0.005),
    ];
    for (name, bias, spread) in limits {
        let definition: &Definition = model.definitions().iter().find(|d| d.1.name == name).unwrap().1;
        assert_eq!(definition.kind, Kind::Tape);
        let errors: Vec<f64> = people
            .iter()
            .map(|body| {
                let at = |v: u32| body.vertices()[v as usize].as_dvec3();
                let tape = definition.read(at);
                let places: Vec<DVec3> = definition.points.iter().map(|p| p.position(at)).collect();
                let centre = places.iter().sum::<DVec3>() / places.len() as f64;
                let reach = 1.45 * places.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
                let quads = &body.character().subdivision().refined().quads;
                let mut plane = cut(body.vertices(), quads, centre, definition.normal, reach);
                // The other thigh is within reach.
                plane.retain(|p| !name.starts_with("thigh") || p.x * centre.x > 0.0);
                // The tape itself, by the slow hull: the definition is what it says.
                assert!((hull_perimeter(&flat(&places, definition.normal)) - tape).abs() < 1e-9);
                tape - hull_perimeter(&flat(&plane, definition.normal))
            })
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let deviation =
            (errors.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / errors.len() as f64).sqrt();
        println!("{name}: {:.1} ± {:.1} mm", 1000.0 * mean, 1000.0 * deviation);
        assert!(mean.abs() < bias && deviation < spread, "{name}: {mean} ± {deviation}");
    }
}

#[test]
fn the_chest_is_the_cut_at_the_nipples() {
    let model = Model::embedded().unwrap();
    let definition = model.definitions().iter().find(|d| d.1.name == "chest_circumference").unwrap().1;
    assert_eq!(definition.kind, Kind::Slice);
    let mut compared = 0;
    for seed in 1..=12 {
        let sex = Some(Sex::ALL[seed as usize % 2]);
        let body = model.generate(&Request { sex, seed, fill: Fill::Sample, ..Request::default() }).unwrap();
        let at = |v: u32| body.vertices()[v as usize].as_dvec3();
        let nipples: Vec<DVec3> = definition.points.iter().map(|p| p.position(at)).collect();
        let level = (nipples[0] + nipples[1]) / 2.0;
        // Anything at that height but the arms: nothing reaches farther out than the chest itself does.
        let quads = &body.character().subdivision().refined().quads;
        let armpit = body.skeleton().find("upperarm_l").unwrap();
        let arm = f64::from(body.skeleton().bind()[armpit].translation.y);
        if arm - level.y < 0.09 {
            println!("seed {seed}: left out, the arms hang into the plane");
            continue;
        }
        let plane = cut(body.vertices(), quads, level, DVec3::Y, 2.0);
        let whole = hull_perimeter(&flat(&plane, DVec3::Y));
        assert!((whole - definition.read(at)).abs() < 1e-6, "seed {seed}: {whole} {}", definition.read(at));
        compared += 1;
    }
    assert!(compared >= 8, "only {compared} of 12 chests were compared");
}
