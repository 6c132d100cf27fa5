//! Mutated files: whatever bytes come, every reader returns in time, without a panic of ours, and with bounded memory.
//!
//! Each test changes small valid inputs, which each seed changes in one way. The ordinary run tries some hundred seeds. With
//! `ANTHRONET_FUZZ_SECONDS` each test goes on for that long, from the seed `ANTHRONET_FUZZ_SEED` on.

mod inputs;
mod mutate;

use std::cell::RefCell;
use std::env;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Once};
use std::time::{Duration, Instant};

use self::inputs::{Input, arm, person, written};
use self::mutate::Mutation;
use super::fbx::{binary::binary, tests::SMALL as FBX};
use super::motion::units_and_axes::tests::person as bvh_person;
use super::usd::motion::tests::OTHERS as USD;
use super::{
    Format, Purpose, ReadOptions, panic_becomes_error, read_meshes_from_bytes, read_motion_from_bytes,
    read_scene_from_bytes, write_scene_to_bytes,
};
use crate::condition::Request;
use crate::retarget::{JointMap, RetargetOptions, read_overrides, retarget};
use crate::scene::Scene;
use crate::skeleton::Skeleton;
use crate::space::Axis;
use crate::testing::bodies::bodies;
use crate::testing::memory::most_held;

/// How many seeds of each test the ordinary run tries.
const SEEDS: u64 = 150;
/// One input takes at most this long, even on a busy machine.
const TIME: Duration = Duration::from_secs(60);
/// And so much memory, bytes.
const MEMORY: usize = 1 << 28;

thread_local! {
    /// Where this thread panicked, and whether that becomes an error about a damaged file.
    static PANIC: RefCell<Option<(String, bool)>> = const { RefCell::new(None) };
}

/// Notes panics of the threads that read, which would otherwise fill the terminal; all others are reported as before.
fn note_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(READER) {
                return before(info);
            }
            PANIC.set(Some((info.to_string(), panic_becomes_error())));
        }));
    });
}

/// The name of the threads that read.
const READER: &str = "reader of mutated files";

/// Whether a panic is a fault: one that nothing catches, or one of ours that is taken for one of a parser.
fn is_fault((place, caught): &(String, bool)) -> bool {
    !caught || place.contains("core/src")
}

fn number(variable: &str) -> Option<u64> {
    env::var(variable).ok().map(|value| value.parse().unwrap())
}

/// Mutates inputs and has `read` read them, which returns whether they could be read.
fn fuzz(inputs: Vec<Input>, read: impl Fn(&[u8], &str) -> bool + Send + 'static) {
    note_panics();
    let seconds = number("ANTHRONET_FUZZ_SECONDS");
    let first = number("ANTHRONET_FUZZ_SEED").unwrap_or(0);
    let (sender, receiver) = channel();
    let work = move || read_all(&inputs, &read, first, seconds.map(Duration::from_secs), &sender);
    let reader = std::thread::Builder::new().name(READER.into()).spawn(work).unwrap();
    let mut last = first;
    loop {
        match receiver.recv_timeout(TIME) {
            Ok(seed) => last = seed,
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => panic!("seed {last} takes over {TIME:?}"),
            Err(_) => break,
        }
    }
    match reader.join() {
        Ok(faults) => assert!(faults.is_empty(), "{}", faults.join("\n")),
        Err(_) => panic!("seed {last}: the reader's thread ended"),
    }
}

/// Reads the mutated inputs of one seed after the other, and returns what went wrong with the first few.
fn read_all(
    inputs: &[Input],
    read: &impl Fn(&[u8], &str) -> bool,
    first: u64,
    time: Option<Duration>,
    sender: &Sender<u64>,
) -> Vec<String> {
    for input in inputs {
        assert!(read(&(input.whole)(&input.parts), input.path), "{} is no valid input", input.path);
    }
    let (start, mut faults) = (Instant::now(), Vec::new());
    let (mut understood, mut memory, mut longest) = (0, (0, 0), (Duration::ZERO, 0));
    let mut seed = first;
    let goes_on = |seed| time.map_or(seed < first + SEEDS, |time| start.elapsed() < time);
    while goes_on(seed) && faults.len() < 8 {
        sender.send(seed).unwrap();
        let (bytes, path) = mutated(inputs, seed);
        let began = Instant::now();
        let mut outcome = Ok(false);
        let held = most_held(|| outcome = panic::catch_unwind(AssertUnwindSafe(|| read(&bytes, path))));
        let panicked = PANIC.take().filter(is_fault).map(|(place, _)| place);
        if let Some(why) =
            panicked.or_else(|| (held > MEMORY).then(|| format!("{held} bytes of memory at once")))
        {
            faults.push(format!("seed {seed} ({path}, {} bytes): {why}", bytes.len()));
        }
        understood += u64::from(outcome.unwrap_or(false));
        memory = memory.max((held, seed));
        longest = longest.max((began.elapsed(), seed));
        seed += 1;
    }
    let count = seed - first;
    println!(
        "{count} inputs, {understood} of them valid; at most {} bytes (seed {}), {:?} (seed {})",
        memory.0, memory.1, longest.0, longest.1
    );
    faults
}

/// What a seed makes of one of the inputs.
fn mutated(inputs: &[Input], seed: u64) -> (Vec<u8>, &'static str) {
    let mut mutation = Mutation::new(seed);
    let input = &inputs[mutation.below(inputs.len())];
    let mut parts = input.parts.clone();
    let part = mutation.below(parts.len() + 1);
    match parts.get_mut(part) {
        Some(part) => {
            mutation.change(part);
            ((input.whole)(&parts), input.path)
        }
        None => {
            let mut bytes = (input.whole)(&parts);
            mutation.change(&mut bytes);
            (bytes, input.path)
        }
    }
}

/// Reads a file for every purpose that its format serves, and takes on what was read.
fn read_file(bytes: &[u8], path: &str, body: &Arc<Skeleton>) -> bool {
    let format = Format::of_extension(path.rsplit('.').next().unwrap()).unwrap();
    let mut understood = false;
    if format.serves(Purpose::ReadMotion)
        && let Ok(motion) = read_motion_from_bytes(bytes, path, &ReadOptions::default())
    {
        understood = true;
        if let Ok((clips, _)) = retarget(&motion.clips, body, &RetargetOptions::default()) {
            assert_eq!(clips.len(), motion.clips.len());
        }
    }
    if format.serves(Purpose::ReadScene)
        && let Ok(scene) = read_scene_from_bytes(bytes, path)
    {
        understood = true;
        scene.validate().unwrap();
        write_scene_to_bytes(&scene, Format::Glb, &Default::default()).unwrap();
    }
    if format.serves(Purpose::ReadMeshes) {
        understood |= read_meshes_from_bytes(bytes, path).is_ok();
    }
    understood
}

fn fuzz_files(inputs: Vec<Input>) {
    let body = Arc::clone(&bodies()[0].1);
    fuzz(inputs, move |bytes, path| read_file(bytes, path, &body));
}

#[test]
fn bvh() {
    fuzz_files(vec![Input::plain("a.bvh", bvh_person(0.01, Axis::Y))]);
}

#[test]
fn fbx() {
    fuzz_files(vec![Input::plain("a.fbx", FBX), Input::plain("a.fbx", binary(FBX))]);
}

#[test]
fn gltf() {
    let still = Scene { clips: Vec::new(), ..person() };
    let inputs = vec![
        Input::glb("a.glb", &written(&person(), Format::Glb)),
        Input::glb("a.glb", &written(&arm(), Format::Glb)),
        Input::glb("a.vrma", &written(&person(), Format::Vrma)),
        Input::glb("a.vrm", &written(&still, Format::Vrm)),
    ];
    fuzz_files(inputs);
}

#[test]
fn usd_text() {
    let arm = written(&arm(), Format::Usda);
    fuzz_files(vec![Input::plain("a.usda", USD), Input::plain("a.usda", arm)]);
}

#[test]
fn usd_crate() {
    let scenes = [person(), arm()];
    fuzz_files(scenes.map(|scene| Input::plain("a.usdc", written(&scene, Format::Usdc))).into());
}

#[test]
fn usd_package() {
    fuzz_files(vec![Input::usdz(written(&arm(), Format::Usdc))]);
}

#[test]
fn npz() {
    fuzz_files(vec![Input::npz()]);
}

#[test]
fn obj() {
    fuzz_files(vec![Input::plain("a.obj", written(&arm(), Format::Obj))]);
}

#[test]
fn mapping() {
    let json = r#"{"upperarm_l": "upperarm_r", "head": null, "spine_01": "Spine02", "thigh_l": "thigh_l"}"#;
    let body = Arc::clone(&bodies()[0].1);
    fuzz(vec![Input::plain("mapping.json", json)], move |bytes, path| {
        let Ok(text) = std::str::from_utf8(bytes) else { return false };
        let mapping = read_overrides(text, path.as_ref());
        mapping.is_ok_and(|mapping| JointMap::find(&body, &mapping).is_ok() || !mapping.is_empty())
    });
}

#[test]
fn request() {
    let json = r#"{"sex": "female", "measures": {"height": 1.7, "arm_length": 0.7, "arm_length_left": 0.71,
        "waist_circumference": null}, "seed": 7, "z": [0.5, -1e-3], "fill": "sample", "nearest": true}"#;
    fuzz(vec![Input::plain("request.json", json)], |bytes, _| {
        let Ok(text) = std::str::from_utf8(bytes) else { return false };
        let request = Request::from_json(text);
        request.is_ok_and(|request| Request::from_json(&request.to_json()).unwrap() == request)
    });
}
