//! Pictures of poses and motions: one moment, a sheet of several, or a file that plays.

use std::sync::Arc;

use anthronet::clip::{Clip, Sampler, Wrap};
use anthronet::format::write_atomic;
use anthronet::mesh::Lod;
use anthronet::retarget::feet::{FeetOptions, Standing, contacts, standing_points};
use anthronet::scene::{Scene, SceneSkinner};
use anthronet::skeleton::humanoid::native_name;
use anthronet::skeleton::{Pose, RigJoint};
use glam::{Vec2, Vec3};

use super::{Arguments, SIZE};
use crate::failure::{Failure, Result};
use crate::figure;
use crate::files::extension;
use crate::motion::{MotionArguments, add_clips};
use crate::pose::Moment;
use crate::render::{Animation, Floor, Image, LitFigure, Mark, Stage, View};
use crate::terminal::bar;

/// Number of directions that light is gathered from: for one moment, and for each of many.
const QUALITY: [usize; 2] = [256, 96];
/// Size of what plays and of a frame in a sheet without `--size`, pixels.
const PLAYS: (usize, usize) = (480, 480);
const CELL: usize = 320;
/// Frames of a sheet without `--frames`, and a second of what plays.
const FRAMES: usize = 8;
const RATE: f64 = 20.0;
/// Most frames of what plays.
const MOST: usize = 600;

/// One moment: its time, the pose, and where the feet stand.
struct Shot {
    seconds: Option<f64>,
    pose: Pose,
    feet: Vec<Standing>,
}

/// What is drawn.
enum Picture {
    /// One moment.
    Still,
    /// Moments side by side, in columns.
    Sheet,
    /// Moments one after the other, each for hundredths of a second.
    Plays(u16),
}

/// Draws the pose or motion that the options name, and writes the file.
pub(super) fn draw(arguments: &Arguments) -> Result<()> {
    // Small figures need no more than the cage.
    let one = arguments.pose.pose.is_some()
        || arguments.moments.time.or(arguments.moments.frame.map(|_| 0.0)).is_some();
    let mut scene = arguments.character(if one { Lod::Lod0 } else { Lod::Lod1 })?;
    let (picture, shots) = match arguments.pose.pose {
        Some(_) => (Picture::Still, vec![posed(&scene, arguments)?]),
        None => {
            let clip = clip(&mut scene, arguments)?;
            let (picture, times) = times(&clip, arguments)?;
            (picture, shots(&clip, &times))
        }
    };
    let still = matches!(picture, Picture::Still);
    let views =
        arguments.views(if still { &[View::Front, View::Side, View::Back] } else { &[View::ThreeQuarter] });
    let images = |size| draw_all(&scene, &shots, views, size, arguments.moments.follow);
    let bytes = match picture {
        Picture::Still => images(arguments.size.unwrap_or(SIZE))?.swap_remove(0).to_png()?,
        Picture::Sheet => {
            let [columns, rows] = layout(shots.len());
            let (width, height) = arguments.size.unwrap_or((columns * CELL, rows * CELL));
            let cell = ((width / columns).max(1), (height / rows).max(1));
            sheet(&images(cell)?, columns, (width, height)).to_small_png()?
        }
        Picture::Plays(delay) => {
            let animation = Animation { frames: images(arguments.size.unwrap_or(PLAYS))?, delay };
            if extension(&arguments.output) == "gif" { animation.to_gif()? } else { animation.to_apng()? }
        }
    };
    Ok(write_atomic(&arguments.output, &bytes)?)
}

/// The motion: the clip of `--clip`, which may be one of the character's own, or the first of its own.
fn clip(scene: &mut Scene, arguments: &Arguments) -> Result<Clip> {
    let own = match arguments.motion.clips.first() {
        Some(name) => scene.clips.iter().find(|clip| clip.name() == name),
        None => scene.clips.first(),
    };
    if let Some(own) = own
        .filter(|_| !arguments.motion.clips.first().is_some_and(|name| std::path::Path::new(name).exists()))
    {
        return Ok(own.clone());
    }
    if arguments.motion.clips.is_empty() {
        let input = arguments.input.display();
        let option = arguments.moments.given().unwrap_or("-o");
        return Err(Failure::usage(format!("{option}: {input} has no motion, expected one with --clip")));
    }
    scene.clear_clips();
    add_clips(scene, &MotionArguments { clips: arguments.motion.clips.clone(), ..arguments.motion.clone() })?;
    let first = scene.clips.first().cloned();
    first.ok_or_else(|| {
        Failure::failed(format!("--clip {}: the file has no clip", arguments.motion.clips.join(", ")))
    })
}

/// The moments that are shown, seconds, and how.
fn times(clip: &Clip, arguments: &Arguments) -> Result<(Picture, Vec<f64>)> {
    let moments = &arguments.moments;
    let one = moments.time.map(|time| ("--time", Moment::Time(time)));
    if let Some((option, moment)) = one.or(moments.frame.map(|frame| ("--frame", Moment::Frame(frame)))) {
        let seconds = moment.seconds(clip).map_err(|why| Failure::usage(format!("{option}: {why}")))?;
        return Ok((Picture::Still, vec![seconds]));
    }
    let duration = clip.duration();
    let asked = moments.frames.map(usize::from);
    if !arguments.plays() {
        let count = asked.unwrap_or(FRAMES).min(clip.frame_count().max(1));
        let step = duration / (count.max(2) - 1) as f64;
        return Ok((Picture::Sheet, (0..count).map(|i| i as f64 * step).collect()));
    }
    // Players show a frame for whole hundredths of a second; most take less than two for ten.
    let wanted = match asked {
        Some(count) => duration / count as f64,
        None => 1.0 / arguments.motion.fps.unwrap_or(RATE).min(clip.frames_per_second()).min(50.0),
    };
    let delay = (wanted * 100.0).round().clamp(2.0, 60_000.0);
    let count = asked.unwrap_or((duration * 100.0 / delay).round() as usize).max(1);
    if count > MOST {
        let message = format!(
            "-o {}: {count} frames of {duration:.1} s, expected at most {MOST}: choose with --frames, or a lower --fps",
            arguments.output.display()
        );
        return Err(Failure::usage(message));
    }
    let step = duration / count as f64;
    Ok((Picture::Plays(delay as u16), (0..count).map(|i| i as f64 * step).collect()))
}

/// The moments of a clip.
fn shots(clip: &Clip, times: &[f64]) -> Vec<Shot> {
    let feet = feet(clip);
    let sampler = Sampler::new(clip, Wrap::Once);
    let shot = |seconds: &f64| {
        let frame = (seconds * clip.frames_per_second()).round() as usize;
        let feet = feet.get(frame).or(feet.last()).cloned().unwrap_or_default();
        Shot { seconds: Some(*seconds), pose: sampler.sample(*seconds), feet }
    };
    times.iter().map(shot).collect()
}

/// The pose of `--pose`.
fn posed(scene: &Scene, arguments: &Arguments) -> Result<Shot> {
    let rest = Arc::new(scene.skeleton_with_ends(|name| native_name(name).into_owned())?);
    let pose = arguments.pose.of(scene, &arguments.motion)?.unwrap_or_else(|| rest.rest_pose().clone());
    let clip = Clip::from_poses("pose".to_owned(), rest, RATE, &pose.locals)?;
    Ok(Shot { seconds: None, pose, feet: feet(&clip).swap_remove(0) })
}

/// Where the feet stand in every frame of a clip; nowhere, with a note, for a character without legs of the rig.
fn feet(clip: &Clip) -> Vec<Vec<Standing>> {
    let found = || {
        let rest = Arc::new(clip.skeleton().renamed(|name| native_name(name).into_owned())?);
        let rotations =
            (0..clip.frame_count()).flat_map(|frame| clip.rotations(frame).iter().copied()).collect();
        let tracks = clip.translations().to_vec();
        let clip = Clip::new(clip.name().to_owned(), rest, clip.frames_per_second(), rotations, tracks)?;
        // The floor of the picture, so that feet above it show as such.
        let options = FeetOptions { find_floor: false, ..FeetOptions::default() };
        standing_points(&clip, &contacts(&clip, &options)?)
    };
    found().unwrap_or_else(|error: anthronet::Error| {
        eprintln!("note: no marks under the feet: {error}");
        vec![Vec::new(); clip.frame_count()]
    })
}

/// All moments, seen from one place.
fn draw_all(
    scene: &Scene,
    shots: &[Shot],
    views: &[View],
    size: (usize, usize),
    follow: bool,
) -> Result<Vec<Image>> {
    let mut skinner = SceneSkinner::new(scene)?;
    let centres: Vec<Vec3> =
        shots.iter().map(|shot| if follow { place(scene, &shot.pose) } else { Vec3::ZERO }).collect();
    let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (shot, centre) in shots.iter().zip(&centres) {
        for at in skinner.pose(&shot.pose)?.iter().flat_map(|mesh| &mesh.positions) {
            let at = Vec3::from_array(*at) - *centre;
            bounds = (bounds.0.min(at), bounds.1.max(at));
        }
    }
    // The picture's origin is in the middle of the motion.
    let middle = ((bounds.0 + bounds.1) * 0.5).with_y(0.0);
    let stage = Stage::new((bounds.0 - middle, bounds.1 - middle), views, size);
    let quality = QUALITY[usize::from(shots.len() > 1)];
    let bar = bar(shots.len(), "frames");
    let mut images = Vec::with_capacity(shots.len());
    for (shot, centre) in shots.iter().zip(&centres) {
        let origin = *centre + middle;
        let meshes = skinner.pose(&shot.pose)?;
        let figure = LitFigure::new(figure::from_meshes(&meshes, &scene.materials, -origin)?, quality);
        let mark = |feet: &Standing| Mark { at: Vec2::new(feet.at.x, feet.at.z), foot: feet.side.index() };
        let marks = shot.feet.iter().map(mark).collect();
        let floor = Floor { origin: Vec2::new(origin.x, origin.z), marks };
        let caption = shot.seconds.map_or_else(String::new, |seconds| format!("{seconds:.2} s"));
        images.push(stage.draw(&figure, &floor, &caption));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(images)
}

/// Where a character is on the ground: its pelvis, or its first joint.
fn place(scene: &Scene, pose: &Pose) -> Vec3 {
    let Some(skeleton) = &scene.skeleton else { return Vec3::ZERO };
    let pelvis = skeleton.names().iter().position(|name| native_name(name) == RigJoint::Pelvis.name());
    let model = pose.model_from_joints(skeleton.parents());
    model.get(pelvis.unwrap_or_default()).map_or(Vec3::ZERO, |joint| joint.translation.with_y(0.0))
}

/// Columns and rows of a sheet of so many frames: somewhat wider than high.
fn layout(count: usize) -> [usize; 2] {
    let rows = (1..).find(|rows| rows * rows * 5 >= count * 2).unwrap_or(1);
    let columns = count.div_ceil(rows);
    [columns, count.div_ceil(columns)]
}

fn sheet(images: &[Image], columns: usize, (width, height): (usize, usize)) -> Image {
    let mut sheet = Image::new(width, height, crate::render::Picture::FINE.backdrop[0]);
    for (i, image) in images.iter().enumerate() {
        sheet.paste(image, i % columns * image.width, i / columns * image.height);
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_are_somewhat_wider_than_high() {
        for (count, expected) in
            [(1, [1, 1]), (2, [2, 1]), (5, [3, 2]), (8, [4, 2]), (12, [4, 3]), (24, [6, 4])]
        {
            assert_eq!(layout(count), expected, "{count}");
        }
    }
}
