//! What a person can do: the bounds of everything that a motion file says, whatever its format. Beyond them is damage, of which
//! one number would put a person where nobody finds it.

use glam::Vec3;

use super::raw::RawMotion;
use crate::error::Fault;

/// Farthest place from the origin, and longest bone, metres. Nobody walks as far in a clip; farther away single precision is
/// coarser than a millimetre.
const METRES: f64 = 1e4;
/// The same in millimetres, the smallest usual unit, as long as the file's is not known.
const UNITS: f64 = 1e7;
/// Longest way between two frames that is not worth a word, metres.
const JUMP: f64 = 100.0;
/// Largest angle, degrees: thousands of turns.
const DEGREES: f64 = 1e6;
/// Largest component of a quaternion, which is of unit length up to rounding.
const QUATERNION: f32 = 1e3;

/// Refuses angles in degrees that nobody turns by.
pub(crate) fn check_degrees(degrees: f64) -> Result<(), Fault> {
    check("an angle", degrees, DEGREES, "°")
}

/// Refuses lengths in the file's unit that are huge in any unit.
pub(crate) fn check_length(length: f64) -> Result<(), Fault> {
    check("a length", length, UNITS, "")
}

/// What is not finite is left to the checks of clips and skeletons.
fn check(what: &str, value: f64, most: f64, unit: &str) -> Result<(), Fault> {
    if value.is_finite() && value.abs() > most {
        let found = format!("{value}{unit}");
        return Err(Fault::too_large(what, found, format_args!("at most {most}{unit}")));
    }
    Ok(())
}

/// What to say of the first place in each take that is farther from the one before than anybody moves in a frame.
pub(super) fn jumps(raw: &RawMotion, metres: f64) -> Vec<String> {
    let of_take = |take: &super::raw::Take| {
        take.tracks.iter().find_map(|track| {
            let way = |pair: &[Vec3]| f64::from(pair[0].distance(pair[1])) * metres;
            let frame = track.values.windows(2).position(|pair| way(pair) > JUMP)?;
            let (joint, way) = (raw.skeleton.names().get(track.joint as usize)?, way(&track.values[frame..=frame + 1]));
            Some(format!(
                "`{}`: joint `{joint}` moves {way:.0} m from frame {frame} to frame {}, farther than anybody does",
                take.name,
                frame + 1
            ))
        })
    };
    raw.takes.iter().filter_map(of_take).collect()
}

/// Refuses bones, places and rotations that are no person's, in a unit of this many metres, or in any unit.
pub(super) fn check_motion(raw: &RawMotion, metres: Option<f64>) -> Result<(), Fault> {
    let names = raw.skeleton.names();
    let most = metres.map_or(UNITS, |metres| METRES / metres);
    let check = |v: Vec3, joint: usize, place: &dyn Fn() -> String| {
        let length = f64::from(v.abs().max_element());
        if !length.is_finite() || length <= most {
            return Ok(());
        }
        let joint = names.get(joint).map_or("", String::as_str);
        let (found, most) = match metres {
            Some(metres) => (format!("{:.3e} m", length * metres), format!("at most {METRES} m")),
            None => (format!("{length:.3e}"), format!("at most {UNITS:.0e} in any unit of length")),
        };
        Err(Fault::too_large(format_args!("joint `{joint}`, {}", place()), found, most))
    };
    let ends = raw.skeleton.ends();
    for (joint, local) in raw.skeleton.rest_pose().locals.iter().enumerate() {
        check(local.translation, joint, &|| "bone at rest".to_owned())?;
        check(ends[joint].unwrap_or_default(), joint, &|| "end of its bone".to_owned())?;
    }
    for take in &raw.takes {
        for track in &take.tracks {
            for (frame, v) in track.values.iter().enumerate() {
                check(*v, track.joint as usize, &|| format!("place in frame {frame} of `{}`", take.name))?;
            }
        }
        let huge =
            |q: &crate::math::Rotation| q.to_array().iter().any(|c| c.is_finite() && c.abs() > QUATERNION);
        if let Some(at) = take.rotations.iter().position(huge) {
            let (frame, joint) = (at / names.len(), &names[at % names.len()]);
            let what = format!("joint `{joint}`, rotation in frame {frame} of `{}`", take.name);
            return Err(Fault::too_large(what, take.rotations[at], "a unit quaternion"));
        }
    }
    Ok(())
}
