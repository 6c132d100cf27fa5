//! Which array holds what. Tools name the same parameters of the body models differently, and with words around them: `poses`,
//! `smpl_poses`, `pose_world`, `pred_rotmat`, `smpl_params_global/body_pose`.

/// What an array holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// All joints.
    Whole,
    /// The pelvis alone.
    Root,
    /// The joints between pelvis and hands.
    Body,
    Jaw,
    Eyes,
    LeftEye,
    RightEye,
    Hands,
    LeftHand,
    RightHand,
    /// The place of the body.
    Place,
}

/// The axes of an array, in the order of preference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Frame {
    /// The world's.
    World,
    Unsaid,
    /// The camera's.
    Camera,
}

/// An array of a known part.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Named {
    pub(super) part: Part,
    pub(super) frame: Frame,
    /// The number of the person in the name.
    pub(super) person: Option<u32>,
    /// Place in [`WORDS`]: of two names for one part the earlier one counts.
    rank: usize,
    pub(super) name: String,
}

/// Names of parts, as words. Where several fit a name, that of most words does.
const WORDS: [(&str, Part); 41] = [
    ("poses", Part::Whole),
    ("fullpose", Part::Whole),
    ("full pose", Part::Whole),
    ("pose", Part::Whole),
    ("thetas", Part::Whole),
    ("theta", Part::Whole),
    ("pose aa", Part::Whole),
    ("pose rotmat", Part::Whole),
    ("poses rotmat", Part::Whole),
    ("rotmat", Part::Whole),
    ("rotmats", Part::Whole),
    ("root orient", Part::Root),
    ("global orient", Part::Root),
    ("global orientation", Part::Root),
    ("root pose", Part::Root),
    ("pose root", Part::Root),
    ("poses root", Part::Root),
    ("pose body", Part::Body),
    ("body pose", Part::Body),
    ("poses body", Part::Body),
    ("pose jaw", Part::Jaw),
    ("jaw pose", Part::Jaw),
    ("pose eye", Part::Eyes),
    ("leye pose", Part::LeftEye),
    ("reye pose", Part::RightEye),
    ("pose hand", Part::Hands),
    ("poses hand", Part::Hands),
    ("hand pose", Part::Hands),
    ("left hand pose", Part::LeftHand),
    ("right hand pose", Part::RightHand),
    ("lhand pose", Part::LeftHand),
    ("rhand pose", Part::RightHand),
    ("trans", Part::Place),
    ("transl", Part::Place),
    ("translation", Part::Place),
    ("root trans", Part::Place),
    ("root transl", Part::Place),
    ("root translation", Part::Place),
    ("cam trans", Part::Place),
    ("cam transl", Part::Place),
    ("cam t", Part::Place),
];

/// Words around the names that say nothing.
const NEUTRAL: [&str; 9] =
    ["smpl", "smplx", "smplh", "pred", "params", "person", "people", "track", "subject"];
const WORLD: [&str; 3] = ["world", "global", "w"];
const CAMERA: [&str; 4] = ["incam", "cam", "camera", "c"];

/// What an array of this name holds; `None` for others, such as shapes and cameras.
pub(super) fn named(name: &str) -> Option<Named> {
    let lower = name.to_lowercase();
    let words: Vec<&str> = lower.split(['_', '/', '.', '-', ' ']).filter(|word| !word.is_empty()).collect();
    let fits = WORDS.iter().enumerate().filter_map(|(rank, (known, part))| {
        let known: Vec<&str> = known.split(' ').collect();
        let at = words.windows(known.len()).position(|window| window == known)?;
        let around = words[..at].iter().chain(&words[at + known.len()..]).copied();
        let (mut frame, mut person) = (Frame::Unsaid, None);
        if known[0] == "cam" {
            frame = Frame::Camera;
        }
        for word in around {
            let number =
                NEUTRAL.iter().find_map(|neutral| word.strip_prefix(neutral)).unwrap_or(word).parse().ok();
            match word {
                _ if NEUTRAL.contains(&word) => {}
                _ if number.is_some() && person.is_none() => person = number,
                _ if WORLD.contains(&word) => frame = Frame::World,
                // The pose of a camera is no person's.
                "cam" | "camera" if *part == Part::Whole => return None,
                _ if CAMERA.contains(&word) => frame = Frame::Camera,
                _ => return None,
            }
        }
        Some((known.len(), Named { part: *part, frame, person, rank, name: name.to_owned() }))
    });
    // The earlier one of equal length.
    fits.reduce(|best, next| if next.0 > best.0 { next } else { best }).map(|(_, named)| named)
}

/// The array of a part in these axes.
pub(super) fn find(arrays: &[Named], part: Part, frame: Frame) -> Option<&Named> {
    arrays.iter().filter(|array| array.part == part && array.frame == frame).min_by_key(|array| array.rank)
}

/// The array of a part that does not depend on axes: in these if there is one.
pub(super) fn find_any(arrays: &[Named], part: Part, frame: Frame) -> Option<&Named> {
    let others =
        || arrays.iter().filter(|array| array.part == part).min_by_key(|array| (array.frame, array.rank));
    find(arrays, part, frame).or_else(others)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_tools_are_known() {
        let cases = [
            ("poses", Part::Whole, Frame::Unsaid, None),
            ("smpl_poses", Part::Whole, Frame::Unsaid, None),
            ("smpl_thetas", Part::Whole, Frame::Unsaid, None),
            ("pose_world", Part::Whole, Frame::World, None),
            ("pred_rotmat", Part::Whole, Frame::Unsaid, None),
            ("poses_1", Part::Whole, Frame::Unsaid, Some(1)),
            ("person12/pose_world", Part::Whole, Frame::World, Some(12)),
            ("global_orient", Part::Root, Frame::Unsaid, None),
            ("poses_root_world", Part::Root, Frame::World, None),
            ("smpl_params_incam/global_orient", Part::Root, Frame::Camera, None),
            ("smpl_params_global.body_pose", Part::Body, Frame::World, None),
            ("left_hand_pose", Part::LeftHand, Frame::Unsaid, None),
            ("pred_cam_t", Part::Place, Frame::Camera, None),
            ("cam_trans", Part::Place, Frame::Camera, None),
            ("trans_world", Part::Place, Frame::World, None),
            ("transl", Part::Place, Frame::Unsaid, None),
        ];
        for (name, part, frame, person) in cases {
            let found = named(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!((found.part, found.frame, found.person), (part, frame, person), "{name}");
        }
        for other in [
            "betas",
            "camera_pose",
            "cam_pose",
            "object_poses",
            "obj_trans",
            "pose_est_fields",
            "pred_cam",
            "",
        ] {
            assert_eq!(named(other), None, "{other}");
        }
    }
}
