//! Bodies by number: drawn, shaped, T-posed, refined and measured; the same number gives the same body on every machine.

use anthronet::measure::{Definitions, MeasureId, Measurements, Sex};
use anthronet::mesh::{Subdivision, Topology};
use glam::{DVec3, Vec3};

use crate::Result;
use crate::assets::{Assets, CAGE_VERTICES, Wheel};
use crate::evaluation::paper_row;
use crate::sampling::Sampler;
use crate::tpose::TPose;

/// Folder of downloads and of everything made from them.
pub const CACHE: &str = "target/anthronet";
/// The seed of the data set; part of its version.
pub const SEED: u64 = 20_230_907;
/// Version of the data set: increased whenever a number would give another body or other measures.
pub const DATA_VERSION: u32 = 4;

/// The endless list of bodies.
pub struct Corpus {
    /// The source of bodies.
    pub assets: Assets,
    /// The surface that measures are defined on.
    pub subdivision: Subdivision,
    pub(crate) sampler: Sampler,
    tpose: TPose,
}

/// One body of the list.
pub struct Specimen {
    /// Sex.
    pub sex: Sex,
    /// Points of [`Assets`] in the T-pose, pelvis at the origin, metres.
    pub points: Vec<Vec3>,
}

/// The split that a body belongs to. Basis, prior and networks never see a held-out body. The definitions of the measures
/// do not depend on the split: [`crate::measures`] cuts its loops on the mean of the first 512 bodies of all splits, and
/// collects the chest's candidate edges on the first 4,096.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Basis, prior and networks are fitted to these.
    Train,
    /// Hyperparameters are chosen on these.
    Validation,
    /// Scores are reported on these.
    HeldOut,
}

impl Split {
    /// The fixed split: one body in twenty is for validation, another is held out.
    pub fn of(number: u64) -> Self {
        match number % 20 {
            7 => Self::Validation,
            13 => Self::HeldOut,
            _ => Self::Train,
        }
    }

    /// Its name in scores and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Validation => "validation",
            Self::HeldOut => "held-out",
        }
    }
}

impl Corpus {
    /// Opens the source of bodies, downloading it when needed.
    ///
    /// # Errors
    /// When the source is not available or not what it should be.
    pub fn open(cache: &std::path::Path) -> Result<Self> {
        let mut wheel = Wheel::open_or_fetch(cache)?;
        let mut assets = Assets::load(&mut wheel)?;
        let sampler = Sampler::new(&mut assets)?;
        let tpose = TPose::new(&assets)?;
        let subdivision = Subdivision::new(&assets.mesh.cage)?;
        Ok(Self { assets, subdivision, sampler, tpose })
    }

    /// The body with this number.
    pub fn specimen(&self, number: u64) -> Specimen {
        let person = self.sampler.draw(&self.assets, SEED, number);
        let mut points = self.sampler.shape(&self.assets, &person);
        self.tpose.apply(&self.assets, &mut points);
        Specimen { sex: person.sex, points }
    }

    /// The cage's topology.
    pub fn cage(&self) -> &Topology {
        &self.assets.mesh.cage
    }

    /// Number of surface points: cage and accessories.
    pub fn surface_points(&self) -> usize {
        self.assets.mesh.raw_of_surface.len()
    }
}

/// Measures bodies without refining the vertices that no measure needs.
pub struct Gauge<'a> {
    definitions: &'a Definitions,
    // Surface vertex to index in `stencils`.
    place: Vec<u32>,
    stencils: Vec<Vec<(u32, f32)>>,
}

impl<'a> Gauge<'a> {
    /// Prepares to measure.
    pub fn new(definitions: &'a Definitions, subdivision: &Subdivision) -> Self {
        let mut place = vec![u32::MAX; subdivision.refined().vertex_count];
        let mut stencils = Vec::new();
        for (_, definition) in definitions.iter() {
            for v in definition.vertices() {
                if place[v as usize] == u32::MAX {
                    place[v as usize] = stencils.len() as u32;
                    stencils.push(subdivision.stencil(v as usize).collect());
                }
            }
        }
        Self { definitions, place, stencils }
    }

    /// The measures of a body given its points.
    pub fn read(&self, points: &[Vec3]) -> Measurements {
        let refined: Vec<DVec3> = self
            .stencils
            .iter()
            .map(|s| s.iter().map(|&(i, w)| points[i as usize].as_dvec3() * f64::from(w)).sum())
            .collect();
        self.definitions.read_all(|v| refined[self.place[v as usize] as usize])
    }
}

/// Whether a body is plausible as a person: extreme combinations of sliders give a few that are not.
///
/// The limits are the paper's extremes ("statistics-anthro"), widened by a tenth of each measure's range, and
/// never narrower than a factor of 0.82–1.22; upper arms below 0.135 m of circumference, for example, are refused. Measures
/// that the paper does not have are free.
pub fn plausible(measures: &Measurements) -> bool {
    MeasureId::all().zip(measures).all(|(id, &m)| {
        let Some([_, _, low, high]) = paper_row(id) else { return true };
        let slack = 0.1 * (high - low);
        m >= (low - slack).min(low * 0.82) && m <= (high + slack).max(high * 1.22)
    })
}

/// The cage's part of a body's points.
pub fn cage_of(points: &[Vec3]) -> &[Vec3] {
    &points[..CAGE_VERTICES]
}

#[cfg(test)]
mod tests {
    use anthronet::measure::MEASURE_COUNT;

    use super::*;

    #[test]
    fn the_split_is_by_number_and_no_body_is_in_two() {
        let of = |split| (0..240_000).filter(|&n| Split::of(n) == split).count();
        assert_eq!(of(Split::HeldOut), 12_000);
        assert_eq!(of(Split::Validation), 12_000);
        assert_eq!(of(Split::Train), 216_000);
        assert_eq!(
            (Split::of(13), Split::of(33), Split::of(7)),
            (Split::HeldOut, Split::HeldOut, Split::Validation)
        );
        let names = [Split::Train, Split::Validation, Split::HeldOut].map(Split::name);
        assert_eq!(names, ["train", "validation", "held-out"]);
    }

    #[test]
    fn bodies_with_stick_thin_arms_are_implausible() {
        let mut mean: Measurements = [0.0; MEASURE_COUNT];
        for (id, mean) in MeasureId::all().zip(&mut mean) {
            *mean = paper_row(id).map_or(0.0, |row| row[0]);
        }
        assert!(plausible(&mean));
        let arm = MeasureId::from_name("arm_circumference_right").unwrap().index();
        for (girth, expected) in [(0.114, false), (0.135, false), (0.136, true), (0.49, true), (0.51, false)]
        {
            let mut measures = mean;
            measures[arm] = girth;
            assert_eq!(plausible(&measures), expected, "{girth}");
        }
        let mut measures = mean;
        measures[0] = f64::NAN;
        assert!(!plausible(&measures));
    }

    #[test]
    fn a_gauge_reads_what_the_whole_surface_reads() {
        let model = anthronet::model::Model::embedded().unwrap();
        let subdivision = model.character().subdivision();
        let body = model.shape_space().body(&vec![0.01; model.shape_space().components()]);
        let surface = subdivision.refine(cage_of(&body)).unwrap();
        let whole = model.definitions().read_all(|v| surface[v as usize].as_dvec3());
        let read = Gauge::new(model.definitions(), subdivision).read(&body);
        for (a, b) in whole.iter().zip(read) {
            // A micrometre: the whole surface is rounded to f32.
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
