//! Small valid files of every format, in parts.

use std::io::Cursor;
use std::sync::Arc;

use openusd::usdz::ArchiveWriter;

use crate::clip::{builtin, resample};
use crate::format::{Format, WriteOptions, write_scene_to_bytes};
use crate::scene::Scene;
use crate::testing::fuzz::Input;
use crate::testing::{bodies::bodies, scene};

/// A binary glTF by its JSON and its buffer.
pub(super) fn glb(path: &'static str, bytes: &[u8]) -> Input {
    let json = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let whole = |parts: &[Vec<u8>]| {
        let mut chunks = Vec::new();
        for (part, kind) in parts.iter().zip([b"JSON", b"BIN\0"]) {
            let length = part.len().next_multiple_of(4);
            chunks.extend((length as u32).to_le_bytes());
            chunks.extend(kind);
            chunks.extend(part);
            chunks.resize(chunks.len() + length - part.len(), b' ');
        }
        let head = [b"glTF".to_vec(), 2_u32.to_le_bytes().to_vec()].concat();
        let length = (12 + chunks.len() as u32).to_le_bytes().to_vec();
        [head, length, chunks].concat()
    };
    Input { path, parts: vec![bytes[20..json].to_vec(), bytes[json + 8..].to_vec()], whole }
}

/// A package by the crate file in it.
pub(super) fn usdz(layer: Vec<u8>) -> Input {
    let whole = |parts: &[Vec<u8>]| {
        let mut archive = ArchiveWriter::new(Cursor::new(Vec::new()));
        archive.add_layer("layer.usdc", &parts[0]).unwrap();
        archive.finish().unwrap().into_inner()
    };
    Input { path: "a.usdz", parts: vec![layer], whole }
}

/// An archive of arrays by its arrays: `poses` and `trans`.
pub(super) fn npz_of_a_motion() -> Input {
    let mut poses = vec![0.0_f32; 2 * 66];
    poses[0] = 1.5;
    poses[66] = 1.5;
    poses[66 + 12] = 1.0;
    let places = [0.0_f32, 0.0, 0.95, 0.1, 0.2, 0.95];
    let parts = vec![array("(2, 66)", &poses), array("(2, 3)", &places), array("()", &[60.0])];
    Input { path: "a.npz", parts, whole: |parts| zip(&["poses", "trans", "fps"], parts) }
}

fn array(shape: &str, values: &[f32]) -> Vec<u8> {
    let head = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// A zip archive of files that are not compressed.
fn zip(names: &[&str], files: &[Vec<u8>]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, file) in names.iter().zip(files) {
        let (name, at) = (format!("{name}.npy"), bytes.len() as u32);
        let mut head = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        head.extend(crc32(file).to_le_bytes());
        head.extend([(file.len() as u32).to_le_bytes(); 2].concat());
        head.extend((name.len() as u16).to_le_bytes());
        head.extend([0, 0]);
        bytes.extend([b"PK\x03\x04", &head[..], name.as_bytes(), file].concat());
        let more = [&[0; 10][..], &at.to_le_bytes()].concat();
        directory.extend([b"PK\x01\x02\x14\0", &head[..], &more, name.as_bytes()].concat());
    }
    let count = [(files.len() as u16).to_le_bytes(); 2].concat();
    let places = [(directory.len() as u32).to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
    [bytes, directory, b"PK\x05\x06\0\0\0\0".to_vec(), count, places, vec![0, 0]].concat()
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

/// A person who squats, with the meshes of an arm: some frames of a whole skeleton.
pub(super) fn person() -> Scene {
    let skeleton = Arc::clone(&bodies()[0].1);
    let clip = resample(&builtin("squat", &skeleton).unwrap(), 1.0).unwrap();
    Scene { name: "Person".into(), skeleton: Some(skeleton), clips: vec![clip], ..scene::arm(4) }
}

/// An arm with morph targets, textures and a motion.
pub(super) fn arm() -> Scene {
    let mut arm = scene::arm(4);
    arm.clips.push(scene::bent(&arm));
    scene::bulging(arm)
}

/// The bytes of a scene in a format.
pub(super) fn written(scene: &Scene, format: Format) -> Vec<u8> {
    write_scene_to_bytes(scene, format, &WriteOptions::default()).unwrap()
}
