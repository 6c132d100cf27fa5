//! Reads the motion clips beside the repository: people of ordinary size who stand upright on a floor.

mod common;

use anthronet::format::{self, ReadOptions};

#[test]
fn every_clip_is_a_person_on_a_floor() {
    for path in common::clips("clips of people on a floor") {
        let motion = format::motion::read(&path, &ReadOptions::default()).unwrap();
        let report = &motion.report;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for clip in &motion.clips {
            let joints = clip.skeleton().model_from_joints();
            let height =
                |y: &dyn Fn(f32, f32) -> f32, start: f32, joints: &[anthronet::math::RigidTransform]| {
                    joints.iter().map(|j| j.translation.y).fold(start, y)
                };
            let rest = height(&f32::max, f32::MIN, &joints) - height(&f32::min, f32::MAX, &joints);
            let parents = clip.skeleton().parents();
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
                clip.skeleton().len(),
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

#[test]
fn damaged_clips_do_no_harm() {
    let files = common::clips("damaged clips");
    for path in files.iter().filter(|path| path.extension().is_some_and(|e| e == "fbx")) {
        let bytes = std::fs::read(path).unwrap();
        for i in 0..40 {
            let at = i * bytes.len() / 40;
            assert!(
                format::motion::from_bytes(&bytes[..at], path, &ReadOptions::default()).is_err(),
                "cut at {at}"
            );
            for value in [0, 0x7f, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] = value;
                // Whether it is a motion is the file's luck; that this returns is what counts.
                if let Ok(motion) = format::motion::from_bytes(&damaged, path, &ReadOptions::default()) {
                    assert!(!motion.clips.is_empty());
                }
            }
        }
    }
}
