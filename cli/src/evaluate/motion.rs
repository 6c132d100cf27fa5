//! Retargets every motion file of a folder to bodies from small to tall, and makes the built-in clips for them.
//!
//! Feet are measured on the skin, independently of the points that [`feet::plant`] holds in place.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anthronet::clip;
use anthronet::clip::BUILTIN;
use anthronet::condition::Request;
use anthronet::format::{self, Format, Motion, Purpose, ReadOptions};
use anthronet::model::Model;
use anthronet::pose::limits::JointLimits;
use anthronet::retarget::{self, RetargetOptions, feet};
use anthronet::skeleton::Skeleton;
use rayon::prelude::*;

use super::soles::Soles;
use super::table::{MotionTable, Row};
use crate::failure::{Failure, Result};
use crate::terminal::bar;

/// Statures of the bodies, metres: from the first to the last in even steps.
const STATURES: [f64; 2] = [1.49, 1.99];

/// Retargets every motion file of the folder to this many bodies.
pub(super) fn table(folder: &Path, bodies: usize) -> Result<MotionTable> {
    let files = files(folder)?;
    let bodies = bodies_of(bodies)?;
    let bar = bar(files.len() + BUILTIN.len(), "clips");
    let mut rows = files
        .par_iter()
        .map(|path| {
            let motion = format::read_motion(path, &ReadOptions::default())?;
            let row = row(path, &motion, &bodies)?;
            bar.inc(1);
            Ok(row)
        })
        .collect::<Result<Vec<Row>>>()?;
    for name in BUILTIN {
        rows.push(builtin_row(name, &bodies)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let foot_vertices = bodies.first().map_or(0, |body| body.soles.vertex_count());
    Ok(MotionTable::new(rows, files.len(), bodies.len(), foot_vertices))
}

/// The motion files of a folder, in the order of their names.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(|e| Failure::io("read", folder, e))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| Format::of_path(path, Purpose::ReadMotion).is_ok())
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(Failure::failed(format!("{}: expected motion files, found none", folder.display())));
    }
    Ok(files)
}

/// What of a body the evaluation needs.
struct Target {
    skeleton: Arc<Skeleton>,
    soles: Soles,
}

/// Bodies of evenly spaced statures; the sex is the likelier one.
fn bodies_of(count: usize) -> Result<Vec<Target>> {
    let model = Model::from_environment()?;
    (0..count)
        .map(|i| {
            let t = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
            let mut request = Request::default();
            request.set("height", STATURES[0] + (STATURES[1] - STATURES[0]) * t)?;
            let body = model.generate(&request)?;
            let skeleton = body.skeleton().clone();
            Ok(Target { soles: Soles::of(&body, &skeleton)?, skeleton })
        })
        .collect()
}

/// How contacts are found whose slide is measured: on the motion before feet are planted, and not by the options of planting,
/// so that the number does not fall because planting overlooks a contact.
fn contact_options() -> feet::FeetOptions {
    feet::FeetOptions {
        height: 0.03,
        speed: 0.25,
        shortest: 0.1,
        stray: 0.08,
        ..feet::FeetOptions::default()
    }
}

fn row(path: &Path, motion: &Motion, bodies: &[Target]) -> Result<Row> {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let mut row = Row::new(name);
    for body in bodies {
        let retarget = |options: &RetargetOptions| {
            retarget::retarget(&motion.clips, &body.skeleton, options).map_err(|e| Failure::in_file(path, e))
        };
        let (clips, report) = retarget(&RetargetOptions::default())?;
        let (unplanted, _) = retarget(&RetargetOptions { feet: None, ..RetargetOptions::default() })?;
        row.unmatched = report.joints.unmatched.len();
        let share = 1.0 / (bodies.len() * report.clips.len()) as f64;
        for ((clip, unplanted), quality) in clips.iter().zip(&unplanted).zip(&report.clips) {
            row.add_quality(quality, share);
            let contacts = feet::contacts(unplanted, &contact_options())?;
            let before = body.soles.measure(unplanted, &contacts)?;
            let after = body.soles.measure(clip, &feet::Contacts { floor: 0.0, ..contacts.clone() })?;
            row.add_feet(&contacts, &before, &after, share);
        }
    }
    Ok(row)
}

fn builtin_row(name: &str, bodies: &[Target]) -> Result<Row> {
    let mut row = Row::new(name.to_owned());
    for Target { skeleton, soles } in bodies {
        let clip = clip::builtin(name, skeleton)?;
        row.frames = clip.frame_count();
        let options = feet::FeetOptions { find_floor: false, ..contact_options() };
        let contacts = feet::contacts(&clip, &options)?;
        let measured = soles.measure(&clip, &contacts)?;
        row.add_feet(&contacts, &measured, &measured, 1.0 / bodies.len() as f64);
        let (excess, joint) = retarget::worst_limit_excess(&JointLimits::of_rig(skeleton), &clip);
        let name = joint.and_then(|j| skeleton.names().get(j)).map(String::as_str);
        row.add_limit_excess(f64::from(excess).to_degrees(), name);
    }
    Ok(row)
}
