//! Built-in clips and held feet on bodies of the trained model.

use std::sync::Arc;

use anthronet::clip::{BUILTIN, Clip, builtin};
use anthronet::condition::Request;
use anthronet::measure::{MeasureId, Sex};
use anthronet::model::Model;
use anthronet::pose::limits::JointLimits;
use anthronet::retarget::feet;
use anthronet::retarget::feet::FeetOptions;
use anthronet::skeleton::Skeleton;

/// A small woman and a tall man.
fn bodies() -> Vec<(&'static str, Arc<Skeleton>)> {
    let model = Model::embedded().unwrap_or_else(|e| panic!("{e}"));
    [("small woman", Sex::Female, 1.49), ("tall man", Sex::Male, 1.99)]
        .map(|(name, sex, height)| {
            let mut request = Request { sex: Some(sex), ..Request::default() };
            let id = MeasureId::from_name("height").unwrap_or_else(|| panic!("no height"));
            request.measures[id.index()] = Some(height);
            let body = model.generate(&request).unwrap_or_else(|e| panic!("{e}"));
            (name, body.skeleton().clone())
        })
        .to_vec()
}

/// Radians that the worst joint of a clip is beyond its limits by.
fn beyond_limits(clip: &Clip) -> f32 {
    let limits = JointLimits::of_rig(clip.skeleton());
    (0..clip.frame_count())
        .flat_map(|frame| limits.excess(clip.skeleton(), &clip.pose(frame)))
        .fold(0.0, f32::max)
}

#[test]
fn built_in_clips_stand_and_stay_within_limits() {
    let options = FeetOptions { find_floor: false, ..FeetOptions::default() };
    for (body, rest) in bodies() {
        for name in BUILTIN {
            let clip = builtin(name, &rest).unwrap();
            assert_eq!(beyond_limits(&clip), 0.0, "{body} {name}");
            let found = feet::contacts(&clip, &options).unwrap();
            let measured = feet::measure(&clip, &found).unwrap();
            for foot in 0..2 {
                assert!(measured.contacts[foot] > 0, "{body} {name}: {measured:?}");
                assert!(measured.worst_slide[foot] < 0.01, "{body} {name}: {measured:?}");
                assert!(measured.deepest[foot] < 0.01, "{body} {name}: {measured:?}");
            }
        }
    }
}

/// A clip made for one body and played on another stands badly: feet slide, sink or hang. Held, it keeps what the
/// project promises: 1 cm of sliding a contact, 2 cm under the floor, 5° beyond limits.
#[test]
fn feet_of_another_bodys_clip_are_held() {
    let bodies = bodies();
    for (from, to) in [(0, 1), (1, 0)] {
        let ((_, source), (name, target)) = (&bodies[from], &bodies[to]);
        let walk = builtin("walk", source).unwrap();
        let rotations = (0..walk.frame_count()).flat_map(|f| walk.rotations(f).to_vec()).collect();
        let height = |rest: &Skeleton| rest.model_from_joints()[1].translation.y;
        let scale = height(target) / height(source);
        let mut tracks = walk.translations().to_vec();
        tracks.iter_mut().flat_map(|t| &mut t.values).for_each(|v| *v *= scale);
        let rate = walk.frames_per_second();
        let clip = Clip::new("other".into(), target.clone(), rate, rotations, tracks).unwrap();
        let (planted, report) = feet::plant(&clip, &FeetOptions::default()).unwrap();
        assert!(report.before.contacts.iter().all(|c| *c >= 2), "{name}: {report:?}");
        assert!(report.after.worst_slide.iter().all(|s| *s < 0.01), "{name}: {report:?}");
        assert!(report.after.deepest.iter().all(|d| *d < 0.02), "{name}: {report:?}");
        assert!(beyond_limits(&planted) < 5.0_f32.to_radians(), "{name}");
    }
}
