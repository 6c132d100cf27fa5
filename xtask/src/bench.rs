//! `cargo xtask bench`: the library's benchmarks, and the performance targets: skinning beside numpy, PyTorch and a plain copy,
//! and whole runs of the released command. Each target is printed with its limit, the measured time and whether it is met.

use crate::environment;
use crate::requests::{self, README};
use crate::tools::{self, cargo};
use anyhow::{Context as _, Result, anyhow};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Number of frames of the written motion, and number of runs: the minimum counts, as other processes only add time.
const FRAMES: usize = 300;
const RUNS: usize = 7;
/// File extension, whether with motion, and limit of the wall-clock time of the whole process, seconds.
const FILES: [(&str, bool, f64); 3] = [("glb", false, 0.6), ("glb", true, 1.0), ("usdc", true, 3.0)];

pub(crate) fn run(rest: &[String]) -> Result<()> {
    tools::run(cargo("bench").args(["--package", "anthronet"]).args(rest))?;
    // Arguments select some of the benchmarks: run only those.
    if !rest.is_empty() {
        return Ok(());
    }
    let failures: Vec<_> = [skinning(), files()].into_iter().filter_map(Result::err).collect();
    tools::all_succeeded(&failures)
}

fn skinning() -> Result<()> {
    tools::run(cargo("build").args(["--release", "--package", "anthronet", "--example", "skin_dump"]))?;
    let program = tools::target().join("release/examples/skin_dump");
    let program = program.with_extension(std::env::consts::EXE_EXTENSION);
    let mut command = Command::new(environment::bench_python()?);
    command.arg(tools::root().join("tests/skin_speed.py")).arg(program);
    tools::run(&mut command)
}

/// A body of level of detail 0, without and with retargeted motion; times of the whole process.
fn files() -> Result<()> {
    let anthronet = tools::command_line()?;
    let folder = tools::target().join("bench");
    let clip = folder.join("frames.bvh");
    tools::write(&clip, &longer(&tools::read(&tools::root().join(requests::BVH))?)?)?;
    let mut missed = Vec::new();
    for (extension, moves, most) in FILES {
        let out = folder.join(format!("frames.{extension}"));
        let clip = moves.then_some(clip.as_path());
        let what = if moves { format!("{FRAMES} frames") } else { "a person".to_owned() };
        let least = (0..RUNS).map(|_| seconds(&anthronet, clip, &out)).collect::<Result<Vec<f64>>>()?;
        let least = least.into_iter().fold(f64::INFINITY, f64::min);
        let bytes = std::fs::metadata(&out).with_context(|| out.display().to_string())?.len();
        let met = if least <= most { "met" } else { "MISSED" };
        println!(
            "{what} on level 0 to .{extension}, whole process: bar {most:.1} s, measured {least:.3} s ({:.1} MB), {met}",
            bytes as f64 / 1e6
        );
        missed.extend(
            (least > most)
                .then(|| format!("{what} to .{extension} took {least:.3} s, at most {most} s expected")),
        );
    }
    if missed.is_empty() { Ok(()) } else { Err(anyhow!(missed.join("; "))) }
}

fn seconds(anthronet: &Path, clip: Option<&Path>, out: &Path) -> Result<f64> {
    let mut command = Command::new(anthronet);
    command.arg("generate").args(README).arg("-o").arg(out);
    if let Some(clip) = clip {
        command.arg("--clip").arg(clip);
    }
    let start = Instant::now();
    tools::output(&mut command)?;
    Ok(start.elapsed().as_secs_f64())
}

/// The motion file, with its frames repeated.
fn longer(bvh: &str) -> Result<String> {
    let cannot = || format!("{}: expected MOTION, Frames, Frame Time and frames", requests::BVH);
    let (head, motion) = bvh.split_once("MOTION\n").with_context(cannot)?;
    let mut lines = motion.lines();
    let (_, time) = (lines.next().with_context(cannot)?, lines.next().with_context(cannot)?);
    let frames: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
    let all: Vec<&str> =
        frames.iter().copied().cycle().take(if frames.is_empty() { 0 } else { FRAMES }).collect();
    Ok(format!("{head}MOTION\nFrames: {}\n{time}\n{}\n", all.len(), all.join("\n")))
}
