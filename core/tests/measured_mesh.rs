//! Measuring meshes of any level of detail with the trained model.

use anthronet::Error;
use anthronet::condition::{Fill, Request};
use anthronet::format::measure_file;
use anthronet::mesh::Lod;
use anthronet::model::{MeasuredMesh, Model};
use glam::Vec3;

#[test]
fn every_level_reads_what_the_body_has() {
    let model = Model::embedded().unwrap();
    let person = model.generate(&Request { seed: 3, fill: Fill::Sample, ..Request::default() }).unwrap();
    let character = model.character();
    for lod in Lod::ALL {
        let vertices: Vec<Vec3> = match character.reduced(lod) {
            Some(mesh) => mesh.vertices.iter().map(|v| person.vertices()[*v as usize]).collect(),
            None => person.vertices()[..character.vertex_count(lod)].to_vec(),
        };
        let elsewhere: Vec<Vec3> = vertices.iter().map(|v| *v + Vec3::new(0.3, -0.9, 0.1)).collect();
        for vertices in [vertices, elsewhere] {
            let measured = model.measure_mesh(&vertices).unwrap();
            assert_eq!(measured.lod, lod);
            for (got, exact) in measured.measurements.iter().zip(person.measurements()) {
                // A twentieth of a millimetre: single precision of the vertices, and of the fit's coefficients.
                assert!((got - exact).abs() < 5e-5, "{lod:?}: {got} for {exact}");
            }
            // Grams: the same precision over two square metres of skin.
            assert!((measured.mass.mass_kg - person.mass().mass_kg).abs() < 0.05, "{lod:?}");
        }
    }
}

#[test]
fn what_is_no_body_is_refused() {
    let model = Model::embedded().unwrap();
    let message = |vertices: &[Vec3]| match model.measure_mesh(vertices) {
        Err(Error::Invalid { what: "body", message }) => message,
        other => panic!("{other:?}"),
    };
    assert!(message(&[Vec3::ZERO; 5]).contains("53514, 13380, "), "{}", message(&[]));
    for lod in Lod::ALL {
        for bad in [f32::NAN, f32::INFINITY, -1e30] {
            let mut vertices = vec![Vec3::ONE; model.character().vertex_count(lod)];
            vertices[7].y = bad;
            assert!(message(&vertices).starts_with("vertex 7: expected metres"), "{lod:?}");
        }
        // A single point, and noise: a number or a refusal, but no panic.
        let n = model.character().vertex_count(lod);
        let noise =
            (0..n as u32).map(|i| Vec3::splat((i.wrapping_mul(2_654_435_761) >> 24) as f32)).collect();
        for vertices in [vec![Vec3::ZERO; n], noise] {
            if let Ok(measured) = model.measure_mesh(&vertices) {
                assert!(measured.measurements.iter().all(|m| m.is_finite()), "{lod:?}");
            }
        }
    }
}

/// The vertices of a body at a level of detail.
fn vertices_of(model: &Model, lod: Lod) -> Vec<Vec3> {
    let person = model.generate(&Request { seed: 5, fill: Fill::Sample, ..Request::default() });
    let person = person.expect("a person");
    match model.character().reduced(lod) {
        Some(mesh) => mesh.vertices.iter().map(|v| person.vertices()[*v as usize]).collect(),
        None => person.vertices()[..model.character().vertex_count(lod)].to_vec(),
    }
}

/// Measures vertices in an OBJ file.
fn measured_file(model: &Model, vertices: &[Vec3]) -> anthronet::Result<MeasuredMesh> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("body.obj");
    let lines: String = vertices.iter().map(|v| format!("v {} {} {}\n", v.x, v.y, v.z)).collect();
    std::fs::write(&file, lines).expect("a file");
    measure_file(model, &file)
}

#[test]
fn a_body_in_another_unit_or_other_axes_is_measured_from_a_file() {
    let model = Model::embedded().unwrap();
    type Turn = fn(Vec3) -> Vec3;
    let turned: [(Turn, &str); 4] = [
        (|v| v, "axes +Y up and +Z forward"),
        (|v| Vec3::new(v.x, -v.z, v.y), "axes +Z up and -Y forward"),
        (|v| Vec3::new(-v.x, -v.y, v.z), "axes -Y up and +Z forward"),
        (|v| Vec3::new(v.y, v.z, v.x), "axes +X up and +Y forward"),
    ];
    for (lod, metres) in Lod::ALL.into_iter().cycle().zip([1.0, 0.1, 0.01, 0.001, 0.0254, 0.3048]) {
        let vertices = vertices_of(&model, lod);
        let ours = measured_file(&model, &vertices).unwrap();
        assert!(ours.warnings.is_empty());
        assert_eq!(ours, model.measure_mesh(&vertices).unwrap());
        for (turn, axes) in turned {
            let foreign: Vec<Vec3> = vertices.iter().map(|v| turn(*v / metres)).collect();
            let got = measured_file(&model, &foreign).unwrap();
            for (got, ours) in got.measurements.iter().zip(&ours.measurements) {
                assert!((got - ours).abs() < 5e-5, "{lod:?} {metres} {axes}: {got} for {ours}");
            }
            assert!((got.mass.mass_kg - ours.mass.mass_kg).abs() < 0.05, "{lod:?} {metres} {axes}");
            if foreign != vertices {
                assert_eq!(got.warnings, [format!("read with a unit of {metres} m, {axes}")]);
                let error = model.measure_mesh(&foreign).unwrap_err().to_string();
                assert!(error.contains("expected metres"), "{error}");
            }
        }
    }
}

#[test]
fn vertices_mirrored_or_in_another_order_and_unknown_units_and_axes_are_refused() {
    let model = Model::embedded().unwrap();
    for lod in Lod::ALL {
        let vertices = vertices_of(&model, lod);
        let n = vertices.len();
        let refused = |words: &str, changed: Vec<Vec3>| {
            let error = measured_file(&model, &changed).unwrap_err().to_string();
            assert!(error.contains(words), "{lod:?}: {error}");
            assert!(model.measure_mesh(&changed).is_err(), "{lod:?} {words}");
        };
        let each = |change: fn(Vec3) -> Vec3| vertices.iter().map(|v| change(*v)).collect::<Vec<Vec3>>();
        refused("mirrored", each(|v| Vec3::new(-v.x, v.y, v.z)));
        refused("mirrored", each(|v| Vec3::new(v.x, v.z, v.y)));
        refused("mirrored", each(|v| -v * 100.0));
        refused("order", vertices.iter().rev().copied().collect());
        refused("order", [&vertices[1..], &vertices[..1]].concat());
        refused("order", (0..n).map(|i| vertices[i * 7919 % n]).collect());
        let mut sorted = vertices.clone();
        sorted.sort_by(|a, b| a.y.total_cmp(&b.y));
        refused("order", sorted);
        refused("axes", each(|v| Vec3::new(0.8 * v.x + 0.6 * v.z, v.y, 0.8 * v.z - 0.6 * v.x)));
        refused("unit", each(|v| v * 0.01));
        refused("unit", each(|v| v * 20.0));
    }
}
