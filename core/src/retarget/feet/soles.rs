//! Positions of the soles in every frame of a clip.

use super::for_each_pose;
use crate::clip::Clip;
use crate::pose::{Leg, Sole};

/// The soles of a clip, left and right, one per frame, with heights above `floor`.
pub(crate) fn tracks(clip: &Clip, legs: &[Leg; 2], floor: f32) -> [Vec<Sole>; 2] {
    let mut tracks = [Vec::with_capacity(clip.frame_count()), Vec::with_capacity(clip.frame_count())];
    for_each_pose(clip, legs, |_, _, model| {
        for (leg, track) in legs.iter().zip(&mut tracks) {
            let mut sole = leg.points(model[leg.limb.end], model[leg.ball]);
            for point in [&mut sole.heel, &mut sole.ball, &mut sole.tip, &mut sole.joint] {
                point.y -= floor;
            }
            track.push(sole);
        }
    });
    tracks
}
