//! The table of motion: every clip of a folder on bodies from small to tall, and the built-in clips.
//!
//! What feet do is measured on the skin, which knows nothing of the points that [`feet::plant`] holds.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anthronet::clip;
use anthronet::clip::BUILTIN;
use anthronet::condition::Request;
use anthronet::format::{self, Format, Motion, Purpose, ReadOptions};
use anthronet::model::Model;
use anthronet::pose::limits::JointLimits;
use anthronet::retarget::{self, RetargetOptions, feet};
use anthronet::skeleton::RestPose;
use rayon::prelude::*;
use serde::Serialize;

use super::soles::{SkinMeasure, Soles};
use crate::failure::{Failure, Result};
use crate::progress::bar;

/// Statures of the bodies, metres: from the first to the last in even steps.
const STATURES: [f64; 2] = [1.49, 1.99];

/// One clip, the worst over the bodies unless said; degrees and millimetres.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    clip: String,
    frames: usize,
    /// Joints of the motion that drive nothing.
    unmatched: usize,
    /// Mean over frames, limb bones and bodies.
    direction_mean_deg: f64,
    beyond_limits_deg: f64,
    beyond_limits_joint: Option<String>,
    /// The farthest that a limb turns in one frame beyond the motion, and where.
    jump_deg: f64,
    jump_at: Option<String>,
    /// Contacts of both feet, mean over the bodies.
    contacts: f64,
    /// The longest way of the skin that stands on the floor within one contact, before and after feet were held.
    slide_before_mm: f64,
    slide_mm: f64,
    /// The lowest vertex of a foot, under the floor.
    under_floor_before_mm: f64,
    under_floor_mm: f64,
    /// Vertices of frames that are nowhere.
    not_finite: usize,
}

/// The table, and the worst of all clips.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct MotionTable {
    bodies: usize,
    clips: usize,
    direction_mean_deg: f64,
    direction_worst_clip_mean_deg: f64,
    beyond_limits_deg: f64,
    jump_deg: f64,
    slide_mm: f64,
    under_floor_mm: f64,
    not_finite: usize,
    /// Vertices of both feet that are looked at, level of detail 1.
    foot_vertices: usize,
    rows: Vec<Row>,
}

/// Every motion file of the folder on this many bodies.
pub(crate) fn motion_table(folder: &Path, bodies: usize) -> Result<MotionTable> {
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
    let worst = |of: fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    let of_files = &rows[..files.len()];
    Ok(MotionTable {
        bodies: bodies.len(),
        clips: rows.len(),
        direction_mean_deg: of_files.iter().map(|r| r.direction_mean_deg).sum::<f64>() / files.len() as f64,
        direction_worst_clip_mean_deg: worst(|r| r.direction_mean_deg),
        beyond_limits_deg: worst(|r| r.beyond_limits_deg),
        jump_deg: worst(|r| r.jump_deg),
        slide_mm: worst(|r| r.slide_mm),
        under_floor_mm: worst(|r| r.under_floor_mm),
        not_finite: rows.iter().map(|r| r.not_finite).sum(),
        foot_vertices: bodies.first().map_or(0, |body| body.soles.vertex_count()),
        rows,
    })
}

/// The motion files of a folder, in the order of their names.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(|e| Failure::io("read", folder, &e))?;
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

/// A body as motion comes onto it.
struct OnBody {
    rest: Arc<RestPose>,
    soles: Soles,
}

/// Bodies of evenly spaced statures; the sex is the likelier one.
fn bodies_of(count: usize) -> Result<Vec<OnBody>> {
    let model = Model::from_environment()?;
    (0..count)
        .map(|i| {
            let t = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
            let mut request = Request::default();
            request.set("height", STATURES[0] + (STATURES[1] - STATURES[0]) * t)?;
            let body = model.generate(&request)?;
            let rest = Arc::new(RestPose::of_joints(body.joints())?);
            Ok(OnBody { soles: Soles::of(&body, &rest)?, rest })
        })
        .collect()
}

fn row(path: &Path, motion: &Motion, bodies: &[OnBody]) -> Result<Row> {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let mut row = Row::new(name);
    for body in bodies {
        let onto = |options: &RetargetOptions| {
            let done = retarget::retarget(&motion.clips, &body.rest, options);
            done.map_err(|e| Failure::failed(format!("{}: {e}", path.display())))
        };
        let (clips, report) = onto(&RetargetOptions::default())?;
        let (as_they_came, _) = onto(&RetargetOptions { feet: None, ..RetargetOptions::default() })?;
        row.unmatched = report.joints.unmatched.len();
        let share = 1.0 / (bodies.len() * report.clips.len()) as f64;
        for ((clip, came), quality) in clips.iter().zip(&as_they_came).zip(&report.clips) {
            row.frames = row.frames.max(quality.frames);
            row.direction_mean_deg += share * quality.direction.mean();
            row.beyond(quality.beyond_limits, quality.beyond_limits_joint.as_deref());
            if quality.jump.degrees > row.jump_deg {
                row.jump_deg = quality.jump.degrees;
                row.jump_at = quality.jump.joint.as_ref().map(|j| format!("{j} {}", quality.jump.frame));
            }
            if let Some(feet) = &quality.feet {
                let found = &feet.contacts;
                let before = body.soles.measure(came, found)?;
                let after = body.soles.measure(clip, &feet::Contacts { floor: 0.0, ..found.clone() })?;
                row.feet(found, &before, &after, share);
            }
        }
    }
    Ok(row)
}

fn builtin_row(name: &str, bodies: &[OnBody]) -> Result<Row> {
    let mut row = Row::new(name.to_owned());
    for OnBody { rest, soles } in bodies {
        let clip = clip::builtin(name, rest)?;
        row.frames = clip.frame_count();
        let options = feet::FeetOptions { find_floor: false, ..feet::FeetOptions::default() };
        let found = feet::contacts(&clip, &options)?;
        let measured = soles.measure(&clip, &found)?;
        row.feet(&found, &measured, &measured, 1.0 / bodies.len() as f64);
        let (excess, joint) = retarget::worst_limit_excess(&JointLimits::of_rig(rest), &clip);
        let name = joint.and_then(|j| rest.names().get(j)).map(String::as_str);
        row.beyond(f64::from(excess).to_degrees(), name);
    }
    Ok(row)
}

impl Row {
    fn new(clip: String) -> Self {
        Self {
            clip,
            frames: 0,
            unmatched: 0,
            direction_mean_deg: 0.0,
            beyond_limits_deg: 0.0,
            beyond_limits_joint: None,
            jump_deg: 0.0,
            jump_at: None,
            contacts: 0.0,
            slide_before_mm: 0.0,
            slide_mm: 0.0,
            under_floor_before_mm: 0.0,
            under_floor_mm: 0.0,
            not_finite: 0,
        }
    }

    fn beyond(&mut self, degrees: f64, joint: Option<&str>) {
        if degrees > self.beyond_limits_deg {
            self.beyond_limits_deg = degrees;
            self.beyond_limits_joint = joint.map(str::to_owned);
        }
    }

    fn feet(&mut self, found: &feet::Contacts, before: &SkinMeasure, after: &SkinMeasure, share: f64) {
        let mm = |metres: f32| 1000.0 * f64::from(metres);
        self.contacts += share * found.feet.iter().map(Vec::len).sum::<usize>() as f64;
        self.slide_before_mm = self.slide_before_mm.max(mm(before.slide));
        self.slide_mm = self.slide_mm.max(mm(after.slide));
        self.under_floor_before_mm = self.under_floor_before_mm.max(mm(before.deepest));
        self.under_floor_mm = self.under_floor_mm.max(mm(after.deepest));
        self.not_finite += after.not_finite;
    }
}

impl MotionTable {
    /// As text, the worst over the bodies.
    pub(crate) fn to_text(&self) -> String {
        let mut out = format!(
            "{} clips on {} bodies; the worst over the bodies, in brackets before feet were held; feet measured on {} vertices \
             of the skin\n",
            self.clips, self.bodies, self.foot_vertices
        );
        let _ = writeln!(
            out,
            "  {:24} {:>6} {:>9} {:>14} {:>21} {:>8} {:>16} {:>16}",
            "clip",
            "frames",
            "direction",
            "beyond limits",
            "jump in one frame",
            "contacts",
            "slide a stride",
            "under the floor"
        );
        for r in &self.rows {
            let joint = r.beyond_limits_joint.as_deref().unwrap_or("");
            let _ = writeln!(
                out,
                "  {:24} {:6} {:7.2} ° {:6.2} ° {:>12} {:5.1} ° {:>15} {:5.0} {:6.1} mm ({:.0}) {:6.1} mm ({:.0})",
                r.clip,
                r.frames,
                r.direction_mean_deg,
                r.beyond_limits_deg,
                joint,
                r.jump_deg,
                r.jump_at.as_deref().unwrap_or(""),
                r.contacts,
                r.slide_mm,
                r.slide_before_mm,
                r.under_floor_mm,
                r.under_floor_before_mm
            );
        }
        let _ = writeln!(
            out,
            "direction of limbs, mean {:.2} °, of the worst clip {:.2} °; beyond limits {:.2} °; jump in one frame \
             {:.1} °; slide a stride {:.1} mm; under the floor {:.1} mm; {} vertices not finite",
            self.direction_mean_deg,
            self.direction_worst_clip_mean_deg,
            self.beyond_limits_deg,
            self.jump_deg,
            self.slide_mm,
            self.under_floor_mm,
            self.not_finite
        );
        out
    }

    /// As JSON.
    pub(crate) fn to_json(&self) -> Result<String> {
        let text = serde_json::to_string_pretty(self);
        Ok(text.map_err(|e| Failure::failed(format!("the table: {e}")))? + "\n")
    }
}
