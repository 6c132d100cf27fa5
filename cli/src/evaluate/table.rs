//! The table of retargeted clips, as text and as JSON.

use std::fmt::Write as _;

use anthronet::retarget::ClipReport;
use anthronet::retarget::feet::Contacts;
use serde::Serialize;

use super::soles::SkinMeasure;
use crate::failure::Result;

/// One clip: maxima over the bodies unless stated otherwise; degrees and millimetres.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    clip: String,
    pub(super) frames: usize,
    /// Source joints without a target.
    pub(super) unmatched: usize,
    /// Mean over frames, limb bones and bodies.
    direction_mean_deg: f64,
    /// Mean over frames, bodies, and hips, spine, shoulders, neck and head.
    trunk_mean_deg: f64,
    /// Mean over frames, bodies, and rolls of palms and soles.
    rolls_mean_deg: f64,
    /// The part of the body with the largest mean over the frames, and that mean.
    worst_part: Option<String>,
    worst_part_deg: f64,
    beyond_limits_deg: f64,
    beyond_limits_joint: Option<String>,
    /// The largest rotation of a limb in one frame beyond that of the motion, and where.
    jump_deg: f64,
    jump_at: Option<String>,
    /// Contacts of both feet, mean over the bodies.
    contacts: f64,
    /// The longest slide of the skin on the floor within a stride and a contact, before and after foot planting.
    slide_before_mm: f64,
    slide_mm: f64,
    /// Depth of the lowest vertex of a foot under the floor.
    under_floor_before_mm: f64,
    under_floor_mm: f64,
    /// Vertices with coordinates that are not finite, over all frames.
    not_finite: usize,
}

/// The table, and the maxima over all clips.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MotionTable {
    bodies: usize,
    clips: usize,
    direction_mean_deg: f64,
    direction_worst_clip_mean_deg: f64,
    trunk_worst_clip_mean_deg: f64,
    rolls_worst_clip_mean_deg: f64,
    worst_part_deg: f64,
    beyond_limits_deg: f64,
    jump_deg: f64,
    slide_mm: f64,
    under_floor_mm: f64,
    not_finite: usize,
    /// Number of measured vertices of both feet, level of detail 1.
    foot_vertices: usize,
    rows: Vec<Row>,
}

impl Row {
    pub(super) fn new(clip: String) -> Self {
        Self {
            clip,
            frames: 0,
            unmatched: 0,
            direction_mean_deg: 0.0,
            trunk_mean_deg: 0.0,
            rolls_mean_deg: 0.0,
            worst_part: None,
            worst_part_deg: 0.0,
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

    /// Adds one clip on one body; `share` is its weight in the means.
    pub(super) fn add_quality(&mut self, quality: &ClipReport, share: f64) {
        self.frames = self.frames.max(quality.frames);
        let direction = &quality.direction;
        self.direction_mean_deg += share * direction.mean();
        self.trunk_mean_deg += share * direction.trunk_mean();
        self.rolls_mean_deg += share * direction.roll_mean();
        if let Some(worst) = direction.worst.as_ref().filter(|worst| worst.mean > self.worst_part_deg) {
            self.worst_part_deg = worst.mean;
            self.worst_part = Some(worst.bone.clone());
        }
        self.add_limit_excess(quality.beyond_limits, quality.beyond_limits_joint.as_deref());
        let jump = &quality.jump;
        if jump.degrees > self.jump_deg {
            self.jump_deg = jump.degrees;
            self.jump_at = jump.joint.as_ref().map(|joint| format!("{joint} {}", jump.frame));
        }
    }

    pub(super) fn add_limit_excess(&mut self, degrees: f64, joint: Option<&str>) {
        if degrees > self.beyond_limits_deg {
            self.beyond_limits_deg = degrees;
            self.beyond_limits_joint = joint.map(str::to_owned);
        }
    }

    pub(super) fn add_feet(
        &mut self,
        contacts: &Contacts,
        before: &SkinMeasure,
        after: &SkinMeasure,
        share: f64,
    ) {
        let mm = |metres: f32| 1000.0 * f64::from(metres);
        self.contacts += share * contacts.feet.iter().map(Vec::len).sum::<usize>() as f64;
        self.slide_before_mm = self.slide_before_mm.max(mm(before.slide));
        self.slide_mm = self.slide_mm.max(mm(after.slide));
        self.under_floor_before_mm = self.under_floor_before_mm.max(mm(before.deepest));
        self.under_floor_mm = self.under_floor_mm.max(mm(after.deepest));
        self.not_finite += after.not_finite;
    }
}

impl MotionTable {
    /// The first `files` rows are of motion files, the others of built-in clips.
    pub(super) fn new(rows: Vec<Row>, files: usize, bodies: usize, foot_vertices: usize) -> Self {
        let worst = |of: fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
        let of_files = &rows[..files];
        Self {
            bodies,
            clips: rows.len(),
            direction_mean_deg: of_files.iter().map(|r| r.direction_mean_deg).sum::<f64>() / files as f64,
            direction_worst_clip_mean_deg: worst(|r| r.direction_mean_deg),
            trunk_worst_clip_mean_deg: worst(|r| r.trunk_mean_deg),
            rolls_worst_clip_mean_deg: worst(|r| r.rolls_mean_deg),
            worst_part_deg: worst(|r| r.worst_part_deg),
            beyond_limits_deg: worst(|r| r.beyond_limits_deg),
            jump_deg: worst(|r| r.jump_deg),
            slide_mm: worst(|r| r.slide_mm),
            under_floor_mm: worst(|r| r.under_floor_mm),
            not_finite: rows.iter().map(|r| r.not_finite).sum(),
            foot_vertices,
            rows,
        }
    }

    /// As text.
    pub(super) fn to_text(&self) -> String {
        let mut out = format!(
            "{} clips on {} bodies; maxima over the bodies, in brackets before foot planting; feet measured on {} vertices of \
             the skin\n",
            self.clips, self.bodies, self.foot_vertices
        );
        let _ = writeln!(
            out,
            "  {:24} {:>6} {:>9} {:>9} {:>9} {:>19} {:>14} {:>21} {:>8} {:>16} {:>16}",
            "clip",
            "frames",
            "direction",
            "trunk",
            "rolls",
            "worst part",
            "beyond limits",
            "jump in one frame",
            "contacts",
            "slide per stride",
            "under the floor"
        );
        for r in &self.rows {
            let joint = r.beyond_limits_joint.as_deref().unwrap_or("");
            let _ = writeln!(
                out,
                "  {:24} {:6} {:7.2} ° {:7.2} ° {:7.2} ° {:6.2} ° {:>10} {:6.2} ° {:>12} {:5.1} ° {:>15} {:5.0} {:6.1} mm ({:.0}) {:6.1} mm ({:.0})",
                r.clip,
                r.frames,
                r.direction_mean_deg,
                r.trunk_mean_deg,
                r.rolls_mean_deg,
                r.worst_part_deg,
                r.worst_part.as_deref().unwrap_or(""),
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
            "direction of limbs, mean {:.2} °, of the worst clip {:.2} °; of the trunk {:.2} °, rolls {:.2} °, worst part \
             {:.2} °; beyond limits {:.2} °; jump in one frame \
             {:.1} °; slide per stride {:.1} mm; under the floor {:.1} mm; {} vertices not finite",
            self.direction_mean_deg,
            self.direction_worst_clip_mean_deg,
            self.trunk_worst_clip_mean_deg,
            self.rolls_worst_clip_mean_deg,
            self.worst_part_deg,
            self.beyond_limits_deg,
            self.jump_deg,
            self.slide_mm,
            self.under_floor_mm,
            self.not_finite
        );
        out
    }

    /// As JSON.
    pub(super) fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}
