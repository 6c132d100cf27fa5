//! Measuring meshes of any level of detail with the trained model.

use anthronet::Error;
use anthronet::condition::{Fill, Request};
use anthronet::mesh::Lod;
use anthronet::model::Model;
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
