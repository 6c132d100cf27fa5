//! The same request gives the same bytes through every door: this crate's library opened as any program opens it, and
//! the Rust library itself; and a list for all other hosts to compare themselves with.
//!
//! The list lies in `target/tmp/same_bytes` after the test has run:
//!
//! - `requests.jsonl`: one request a line, as `anthronet_request_from_json` reads it.
//! - `sha256.txt`: one line for each. Line i, counted from 0, is the SHA-256 in hexadecimal of the body as `glb` in
//!   memory at level of detail i mod 4 and otherwise default options, every tenth (i mod 10 = 3) with the built-in clip
//!   `walk`; or `error` and the code of the call that failed.
//! - `unity_sha256.txt`: likewise, of what a mesh in Unity's space holds at that level: for every part the vertices
//!   (position and normal, six floats each), texture coordinates, triangles, joints and weights, four a vertex; then for
//!   every joint its inverse bind matrix and its place in its parent (quaternion and translation). Numbers as in memory.
//!
//! `ANTHRONET_REQUESTS` asks for fewer requests, as under valgrind; then no list is left.
//!
//! A host reads the first, prints lines like those of the second, and is right when they are equal:
//! `tests/c/same_bytes.c` is the shortest example.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![expect(unsafe_code, reason = "calls a C ABI")]

#[allow(dead_code, reason = "each test uses its part of it")]
mod library;

use std::ffi::{c_char, c_void};
use std::fmt::Write;
use std::path::Path;

use anthronet::Body;
use anthronet::clip::builtin;
use anthronet::condition::{Fill, Request};
use anthronet::format::{Format, WriteOptions, write_atomic, write_scene_to_bytes};
use anthronet::measure::{MEASURE_COUNT, MeasureId, Sex};
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::random::Random;
use anthronet::scene::{Layout, Scene, SceneOptions};
use anthronet::space::Space;
use libloading::{Library, Symbol};
use library::{ErrorOut, library};
use sha2::{Digest, Sha256};

const COUNT: usize = 200;

/// Both sexes and neither, from no measure to all of them, of somebody there could be and of nobody.
fn requests(model: &Model, count: usize) -> Vec<Request> {
    let mut random = Random::new(4, 200);
    (0..count)
        .map(|i| {
            let sex = [Some(Sex::Female), Some(Sex::Male), None][i % 3];
            let someone = Request { sex, seed: 1000 + i as u64, fill: Fill::Sample, ..Request::default() };
            let body = model.generate(&someone).unwrap();
            let mut request = Request { sex, nearest: i % 5 == 0, ..Request::default() };
            let given = if i == COUNT - 1 { MEASURE_COUNT } else { i % 9 };
            for _ in 0..given {
                let place = random.bits() as usize % MEASURE_COUNT;
                // In millimetres, as a tape says it. Every seventh request mixes its measures up, by up to two fifths.
                let mixed = if i % 7 == 6 { 0.6 + 0.8 * random.uniform() } else { 1.0 };
                let metres = (body.measurements()[place] * mixed * 1000.0).round() / 1000.0;
                request.measures[MeasureId::from_index(place).unwrap().index()] = Some(metres);
            }
            if i % 2 == 1 {
                request.seed = random.bits() >> 12;
            }
            if i % 4 >= 2 {
                request.fill = Fill::Sample;
            }
            request
        })
        .collect()
}

fn hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(digest: &[u8]) -> String {
    digest.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

/// Whether a request of the list gets a clip.
fn walks(number: usize) -> bool {
    number % 10 == 3
}

/// Through the Rust library: the file and what Unity holds.
fn direct(model: &Model, request: &Request, number: usize) -> anthronet::Result<[String; 2]> {
    let body = model.generate(request)?;
    let lod = Lod::ALL[number % 4];
    let mut scene = Scene::from_body(&body, &SceneOptions { lod, ..SceneOptions::default() })?;
    if walks(number) {
        scene.clips.push(builtin("walk", &body.skeleton().clone())?);
    }
    let file = hash(&write_scene_to_bytes(&scene, Format::Glb, &WriteOptions::default())?);
    Ok([file, in_unity(&body, scene)?])
}

fn in_unity(body: &Body, scene: Scene) -> anthronet::Result<String> {
    let space = Space::Unity;
    let mut sha = Sha256::new();
    for part in scene.into_buffers(Layout::Render, space)? {
        let vertices: Vec<_> =
            part.positions.iter().zip(&part.normals).map(|(position, normal)| [*position, *normal]).collect();
        sha.update(bytemuck::cast_slice(&vertices));
        sha.update(bytemuck::cast_slice(&part.uvs));
        sha.update(bytemuck::cast_slice(&part.triangles));
        // What an unused influence names is nobody's business.
        let weights = &part.influences.weights;
        let used =
            part.influences.joints.iter().zip(weights).map(|(joint, w)| if *w > 0.0 { *joint } else { 0 });
        sha.update(bytemuck::cast_slice(&used.collect::<Vec<_>>()));
        sha.update(bytemuck::cast_slice(weights));
    }
    let skeleton = body.skeleton();
    let joints = skeleton.bind().iter().zip(skeleton.parents()).zip(&skeleton.rest_pose().locals);
    for ((model_from_joint, parent), local) in joints {
        let bind = space.joint_from_model_matrix(model_from_joint.inverse().into());
        let local = local.parent_from_joint_in(space, *parent);
        sha.update(bytemuck::cast_slice(&bind.to_cols_array()));
        sha.update(bytemuck::cast_slice(&local.rotation.to_array()));
        sha.update(bytemuck::cast_slice(&local.translation.to_array()));
    }
    Ok(hex(&sha.finalize()))
}

/// `anthronet_export_options`.
#[repr(C)]
struct ExportOptions {
    struct_size: u32,
    lod: u32,
    others: [u32; 5],
    clip_count: u32,
    clips: *const Handle,
}

type Handle = *mut c_void;
type Open = unsafe extern "C" fn(*mut Handle, ErrorOut) -> i32;
type FromJson = unsafe extern "C" fn(*const c_char, u64, *mut Handle, ErrorOut) -> i32;
type Generate = unsafe extern "C" fn(Handle, Handle, *mut Handle, ErrorOut) -> i32;
type Export =
    unsafe extern "C" fn(Handle, *const ExportOptions, *const c_char, u64, *mut Handle, ErrorOut) -> i32;
type Builtin = unsafe extern "C" fn(*const c_char, u64, Handle, *mut Handle, ErrorOut) -> i32;
type Data = unsafe extern "C" fn(Handle, *mut *const u8, *mut u64, ErrorOut) -> i32;
type Free = unsafe extern "C" fn(Handle);

const NOBODY: ErrorOut = std::ptr::null_mut();

/// The shared library with its model.
struct Shared {
    library: &'static Library,
    model: Handle,
}

impl Shared {
    fn open() -> Self {
        let library = library();
        let mut model = std::ptr::null_mut();
        // SAFETY: here and below, the types are those of the header, which the tests in C are compiled with.
        let code = unsafe {
            let open: Symbol<Open> = library.get("anthronet_model_open_embedded").unwrap();
            open(&raw mut model, NOBODY)
        };
        assert_eq!(code, 0);
        Self { library, model }
    }

    /// A hash, or the code of the call that failed.
    fn hash(&self, json: &str, number: usize) -> Result<String, i32> {
        let done = |code| if code == 0 { Ok(()) } else { Err(code) };
        let [mut request, mut body, mut clip, mut bytes] = [std::ptr::null_mut(); 4];
        let mut make = || unsafe {
            let from_json: Symbol<FromJson> = self.library.get("anthronet_request_from_json").unwrap();
            let generate: Symbol<Generate> = self.library.get("anthronet_generate").unwrap();
            let export: Symbol<Export> = self.library.get("anthronet_export_memory").unwrap();
            let data: Symbol<Data> = self.library.get("anthronet_bytes_data").unwrap();
            done(from_json(json.as_ptr().cast(), json.len() as u64, &raw mut request, NOBODY))?;
            done(generate(self.model, request, &raw mut body, NOBODY))?;
            if walks(number) {
                let builtin: Symbol<Builtin> = self.library.get("anthronet_clip_builtin").unwrap();
                done(builtin(c"walk".as_ptr(), 4, body, &raw mut clip, NOBODY))?;
            }
            let options = ExportOptions {
                struct_size: size_of::<ExportOptions>() as u32,
                lod: number as u32 % 4,
                others: [0; 5],
                clip_count: walks(number).into(),
                clips: &raw const clip,
            };
            done(export(body, &raw const options, c"glb".as_ptr(), 3, &raw mut bytes, NOBODY))?;
            let (mut start, mut length) = (std::ptr::null(), 0);
            done(data(bytes, &raw mut start, &raw mut length, NOBODY))?;
            Ok(hash(std::slice::from_raw_parts(start, length as usize)))
        };
        let made = make();
        self.free("anthronet_request_free", request);
        self.free("anthronet_body_free", body);
        self.free("anthronet_clip_free", clip);
        self.free("anthronet_bytes_free", bytes);
        made
    }

    fn free(&self, function: &str, handle: Handle) {
        // SAFETY: as above; each handle once.
        unsafe { self.library.get::<Free>(function).unwrap()(handle) };
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.free("anthronet_model_free", self.model);
    }
}

#[test]
fn the_shared_library_gives_the_bytes_of_the_crate() {
    let (shared, model) = (Shared::open(), Model::embedded().unwrap());
    let (mut list, mut hashes, mut unity, mut refused) = (String::new(), String::new(), String::new(), 0);
    let count = std::env::var("ANTHRONET_REQUESTS").map_or(COUNT, |count| count.parse().unwrap());
    for (i, request) in requests(&model, count).iter().enumerate() {
        let json = request.to_json();
        assert!(!json.contains('\n'), "a request of more than one line");
        let line = match (direct(&model, request, i), shared.hash(&json, i)) {
            (Ok([ours, in_unity]), Ok(theirs)) => {
                assert_eq!(ours, theirs, "request {i}: {json}");
                unity += &(in_unity + "\n");
                ours
            }
            (Err(_), Err(code)) => {
                refused += 1;
                unity += &format!("error {code}\n");
                format!("error {code}")
            }
            (ours, theirs) => panic!("request {i}: {ours:?} here, {theirs:?} there: {json}"),
        };
        list += &(json + "\n");
        hashes += &(line + "\n");
    }
    if count < COUNT {
        return;
    }
    assert!((1..COUNT / 4).contains(&refused), "{refused} requests are refused");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("same_bytes");
    std::fs::create_dir_all(&folder).unwrap();
    // Whole or not at all: a host may be reading the same list of an earlier run.
    for (name, text) in [("requests.jsonl", list), ("sha256.txt", hashes), ("unity_sha256.txt", unity)] {
        write_atomic(folder.join(name), text.as_bytes()).unwrap();
    }
}
