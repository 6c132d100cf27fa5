//! Model files that are not: truncated, of another version, damaged. Each is an error that names the file.

use anthronet::Error;
use anthronet::condition::Request;
use anthronet::model::{Model, ModelParts};
use anthronet::random::Random;

const EMBEDDED: &[u8] = include_bytes!("../../model/anthronet.safetensors");

fn refused(bytes: &[u8]) -> String {
    match Model::from_bytes(bytes) {
        Err(Error::Model { origin, message }) => {
            assert_eq!(origin, "(memory)");
            message
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("a broken model was opened"),
    }
}

#[test]
fn truncated_files_are_refused() {
    for length in [0, 1, 7, 8, 9, 100, 5_000, EMBEDDED.len() / 2, EMBEDDED.len() - 1] {
        refused(&EMBEDDED[..length]);
    }
}

#[test]
fn a_header_that_promises_too_much_is_refused_before_anything_is_allocated() {
    let mut bytes = EMBEDDED.to_vec();
    bytes[..8].copy_from_slice(&u64::MAX.to_le_bytes());
    refused(&bytes);
}

#[test]
fn another_version_is_named() {
    let mark: &[u8] = br#"format_version\":"#;
    let at = EMBEDDED.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
    assert_eq!(EMBEDDED[at], b'3');
    let mut bytes = EMBEDDED.to_vec();
    bytes[at] = b'7';
    assert!(refused(&bytes).contains("format version 3, got 7"));
}

#[test]
fn a_missing_file_is_named() {
    let error = Model::open("nowhere/model.safetensors").unwrap_err().to_string();
    assert!(error.contains("nowhere") && error.contains("read"), "{error}");
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let whole = ModelParts::from_bytes(EMBEDDED, "(memory)").unwrap();
    type Damage = fn(&mut ModelParts);
    let damages: [(&str, Damage); 13] = [
        ("measure definitions", |p| p.definitions_hash = "0".repeat(64)),
        ("299 deviations", |p| p.deviations.truncate(299)),
        ("joint arrays", |p| p.joint_mean.truncate(7)),
        ("joint", |p| p.joint_parents[3] = Some(60)),
        ("skin weights", |p| p.skin.1[0] = 999),
        ("finite", |p| p.mean[5] = f32::NAN),
        ("standardisation", |p| p.standardisation[1][2] = 0.0),
        ("ranges", |p| p.ranges[1] = 0.0),
        ("output.weight", |p| drop(p.networks.remove("output.weight"))),
        ("level of detail", |p| p.reduced[1].triangles[0][1] = 60_000),
        // An encoder that is not whole is damage, not a model without one.
        ("mesh.weight", |p| drop(p.networks.remove("mesh.weight"))),
        // Counts in the gigabytes are compared before anything is made from them.
        ("expected 4294967295 vertices", |p| {
            let others: usize = p.accessories.iter().map(|a| a.topology.vertex_count).sum();
            p.cage.vertex_count = u32::MAX as usize - others;
            p.accessories.iter_mut().for_each(|a| a.start += u32::MAX as usize - others - 13_380);
        }),
        ("does not follow", |p| p.accessories[0].topology.vertex_count = usize::MAX / 2),
    ];
    for (word, damage) in damages {
        let mut parts = whole.clone();
        damage(&mut parts);
        let error = Model::from_parts(&parts, "(memory)").map(drop).unwrap_err().to_string();
        assert!(error.contains("(memory)") && error.contains(word), "expected `{word}` in {error}");
    }
}

#[test]
fn a_file_that_promises_more_vertices_than_it_has_is_refused() {
    let mut parts = ModelParts::from_bytes(EMBEDDED, "(memory)").unwrap();
    parts.cage.vertex_count = 4_000_000_000;
    let message = refused(&parts.to_bytes().unwrap());
    assert!(message.contains("vertices, the mean body has 42408 coordinates"), "{message}");
}

#[test]
fn a_model_without_its_encoder_generates() {
    let mut parts = ModelParts::from_bytes(EMBEDDED, "(memory)").unwrap();
    let decoder = ["condition.", "decoder.", "output.", "skip."];
    parts.networks.retain(|name, _| decoder.iter().any(|own| name.starts_with(own)));
    let model = Model::from_bytes(&parts.to_bytes().unwrap()).unwrap();
    let body = model.generate(&Request::default()).unwrap();
    let error = model.encode(body.measurements(), body.sex(), body.coefficients()).unwrap_err();
    assert!(error.to_string().contains("the model has none"), "{error}");
}

#[test]
fn a_flipped_byte_is_found_wherever_it_is() {
    let header = 8 + u64::from_le_bytes(*EMBEDDED.first_chunk().unwrap()) as usize;
    let mark: &[u8] = br#"sha256\":\""#;
    let checksum = EMBEDDED.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
    let mut places = vec![0, 7, 8, header - 1, header, EMBEDDED.len() - 1, checksum, checksum + 63];
    let mut random = Random::new(1, 0);
    places.extend((0..8).map(|_| (random.bits() % header as u64) as usize));
    places.extend((0..24).map(|_| (random.bits() % EMBEDDED.len() as u64) as usize));
    let mut bytes = EMBEDDED.to_vec();
    for at in places {
        let bit = 1 << (random.bits() % 8);
        bytes[at] ^= bit;
        let message = refused(&bytes);
        if at >= header {
            assert!(message.contains("SHA-256") && message.contains("damaged"), "byte {at}: {message}");
        }
        bytes[at] ^= bit;
    }
    Model::from_bytes(&bytes).unwrap();
}

#[test]
fn the_model_is_smaller_than_promised() {
    assert!(EMBEDDED.len() < 20_000_000, "{} bytes", EMBEDDED.len());
}

/// The numbers of the card's table of scores and fills are those of the file.
#[test]
fn the_model_card_has_the_scores_of_the_file() {
    let scores = Model::embedded().unwrap().provenance().scores.clone();
    let card = include_str!("../../model/MODEL_CARD.md");
    for (row, score) in [
        ("mean vertex distance, z = encoder mean", "p2p_mm"),
        ("mean vertex distance, z = 0 (shape that the measures leave undetermined)", "p2p_z0_mm"),
        ("mean vertex distance of the shape space itself", "p2p_shape_space_mm"),
        ("mean error of the measures before the solve", "measures_mean_mm"),
        ("chest circumference before the solve", "chest_circumference_mm"),
        ("hip circumference before the solve", "hip_circumference_mm"),
        ("waist circumference before the solve", "waist_circumference_mm"),
        ("arm circumference before the solve (left)", "arm_circumference_left_mm"),
        ("calf circumference before the solve (left)", "calf_circumference_left_mm"),
        ("thigh circumference before the solve (left)", "thigh_circumference_left_mm"),
        (
            "worst given measure after the solve, measured again from the written .glb, 1000 requests (0 refused)",
            "after_solve_max_mm",
        ),
    ] {
        let start = format!("| {row} | ");
        let line =
            card.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("no row {row}"));
        let stated = line[start.len()..].split(' ').next().unwrap();
        let decimals = stated.split('.').nth(1).map_or(0, str::len);
        let score = scores.get(score).unwrap_or_else(|| panic!("the file has no score {score}"));
        assert_eq!(stated, format!("{score:.decimals$}"), "{row}");
    }
    assert_eq!((scores["bodies"], scores["refused"]), (1000.0, 0.0));
}

#[test]
fn writing_what_was_read_gives_the_same_bytes() {
    let parts = ModelParts::from_bytes(EMBEDDED, "(memory)").unwrap();
    assert_eq!(parts.to_bytes().unwrap(), EMBEDDED);
}
