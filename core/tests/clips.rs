//! Reads the motion clips beside the repository: people of ordinary size who stand upright on a floor.

use std::path::PathBuf;

use anthronet::clip::{self, ReadOptions};

/// The folder of shared data, where there is one.
fn clips() -> Option<Vec<PathBuf>> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared");
    let shared = std::env::var_os("ANTHRONET_SHARED").map_or_else(|| beside.into(), PathBuf::from);
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(shared.join("data/clips")).ok()?.flatten().map(|entry| entry.path()).collect();
    files.sort();
    Some(files)
}

#[test]
fn every_clip_is_a_person_on_a_floor() {
    let Some(files) = clips() else {
        println!("skipped: there is no folder shared/data/clips beside the repository");
        return;
    };
    for path in files {
        let motion = clip::read(&path, &ReadOptions::default()).unwrap();
        let report = &motion.report;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for clip in &motion.clips {
            let joints = clip.rest().model_from_joints();
            let height = |y: &dyn Fn(f32, f32) -> f32, start: f32, joints: &[anthronet::pose::Local]| {
                joints.iter().map(|j| j.translation.y).fold(start, y)
            };
            let rest = height(&f32::max, f32::MIN, &joints) - height(&f32::min, f32::MAX, &joints);
            let parents = clip.rest().parents();
            let mut lows: Vec<f32> = (0..clip.frame_count())
                .map(|f| height(&f32::min, f32::MAX, &clip.pose(f).model_from_joints(parents)))
                .collect();
            let root = clip.pose(0).locals[0].translation.y;
            lows.sort_by(f32::total_cmp);
            let low = lows[lows.len() / 20];
            println!(
                "{name} `{}`: {} frames at {:.3} ({:?}), {} joints, {} ({:?}), {} up ({:?}), stature {:.2}, rest {rest:.2}, \
                 root at {root:.2}, lowest joints {low:.3}; {:?}",
                clip.name(),
                clip.frame_count(),
                clip.frames_per_second(),
                report.rate_found,
                clip.rest().len(),
                report.unit,
                report.unit_found,
                report.up,
                report.up_found,
                report.stature,
                report.warnings,
            );
            assert!((1.4..2.1).contains(&report.stature), "{name}: stature {}", report.stature);
            // Most stand on a floor at zero; some climb, and some floors lie a little off.
            assert!((-0.2..0.4).contains(&low), "{name}: lowest joints at {low}");
        }
    }
}
