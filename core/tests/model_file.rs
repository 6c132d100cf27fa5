//! Model files that are not: truncated, of another version, damaged. Each is an error that names the file.

use anthronet::Error;
use anthronet::model::{Model, ModelParts};

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
    assert_eq!(EMBEDDED[at], b'1');
    let mut bytes = EMBEDDED.to_vec();
    bytes[at] = b'7';
    assert!(refused(&bytes).contains("format version 1, got 7"));
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
    let damages: [(&str, Damage); 10] = [
        ("definitions", |p| p.definitions_hash = "0".repeat(64)),
        ("components", |p| p.deviations.truncate(299)),
        ("joint", |p| p.joint_mean.truncate(7)),
        ("joint", |p| p.joint_parents[3] = Some(60)),
        ("skin", |p| p.skin.1[0] = 999),
        ("finite", |p| p.mean[5] = f32::NAN),
        ("standardisation", |p| p.standardisation[1][2] = 0.0),
        ("ranges", |p| p.ranges[1] = 0.0),
        ("tensor", |p| drop(p.networks.remove("output.weight"))),
        ("level", |p| p.reduced[1].triangles[0][1] = 60_000),
    ];
    for (word, damage) in damages {
        let mut parts = whole.clone();
        damage(&mut parts);
        let error = Model::from_parts(&parts, "(memory)").map(drop).unwrap_err().to_string();
        assert!(error.contains("(memory)"), "{word}: {error}");
    }
}

#[test]
fn flipped_bytes_never_panic() {
    // A flip in the numbers may go unnoticed: it is a slightly other model. None may panic.
    let mut state = 1_u64;
    for _ in 0..12 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut bytes = EMBEDDED.to_vec();
        let at = (state >> 33) as usize % bytes.len().min(40_000);
        bytes[at] ^= 0x55;
        let _ = Model::from_bytes(&bytes);
    }
}

#[test]
fn writing_what_was_read_gives_the_same_bytes() {
    let parts = ModelParts::from_bytes(EMBEDDED, "(memory)").unwrap();
    assert_eq!(parts.to_bytes().unwrap(), EMBEDDED);
}
