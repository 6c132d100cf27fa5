//! Real clips on a body: limbs point where the source's point. Skipped where the clips are not.

mod common;

use anthronet::condition::Request;
use anthronet::format::ReadOptions;
use anthronet::format::motion::read;
use anthronet::measure::Sex;
use anthronet::model::Model;
use anthronet::retarget::{JointMap, Retargeter, TransferOptions, direction_error};

#[test]
fn limbs_of_real_clips_point_where_the_sources_point() {
    let paths = common::clips("limbs of real clips");
    if paths.is_empty() {
        return;
    }
    let request = Request { sex: Some(Sex::Female), ..Request::default() };
    let body = Model::embedded().unwrap().generate(&request).unwrap();
    let rest = body.skeleton().clone();
    let resting = rest.model_from_joints();
    let feet = ["foot_l", "foot_r", "ball_l", "ball_r"].map(|name| rest.find(name).unwrap());
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        for clip in read(&path, &ReadOptions::default()).unwrap().clips {
            let map = JointMap::find(clip.skeleton(), &Default::default()).unwrap();
            let options = TransferOptions::default();
            let retargeter = Retargeter::new(clip.skeleton(), rest.clone(), &map, &options).unwrap();
            let found = retargeter.retarget(&clip).unwrap();
            let error = direction_error(&clip, &found, &map);
            let report = map.report();
            println!(
                "{name}: {}, {} frames, scale {:.3}, limbs {:.4}° in the mean, {:.3}° at most; passed on {:?}, lost {:?}",
                report.vocabulary.as_deref().unwrap_or("no vocabulary"),
                found.frame_count(),
                retargeter.scale(),
                error.mean(),
                error.max(),
                report.passed_on,
                report.unmatched,
            );
            assert_eq!(error.limbs.len(), 8, "{name}: {report:?}");
            // Directions are transferred and not fitted: what remains is f32 and the stop of shortest arcs at 0.04°.
            assert!(error.max() < 0.1, "{name}: {error:?}");
            assert!((0.5..2.0).contains(&retargeter.scale()), "{name}: {}", retargeter.scale());
            // The floor is where the lowest foot of nearly all frames stands.
            let low = |frame: usize| {
                let model = found.pose(frame).model_from_joints(rest.parents());
                let heights = feet.iter().map(|&j| model[j].translation.y - resting[j].translation.y);
                heights.fold(f32::INFINITY, f32::min)
            };
            let below = (0..found.frame_count()).filter(|&f| low(f) < -1e-3).count();
            assert!(below * 40 < found.frame_count(), "{name}: {below} frames below the floor");
        }
    }
}
