//! Bodies by number: draw, shape, T-pose, refine and measure, the same for the same number everywhere.

use anthronet::measure::{Definitions, Measurements, Sex};
use anthronet::mesh::{Subdivision, Topology};
use glam::{DVec3, Vec3};

use crate::Result;
use crate::assets::{Assets, CAGE_VERTICES, Wheel};
use crate::evaluation::paper_row;
use crate::sampling::Sampler;
use crate::tpose::TPose;

/// Where downloads and everything made from them are kept.
pub const CACHE: &str = "target/anthronet";
/// The seed of the data set; part of its version.
pub const SEED: u64 = 20_230_907;
/// Raised whenever the same number would give another body or other measures.
pub const DATA_VERSION: u32 = 3;

/// The endless list of bodies.
pub struct Corpus {
    /// The source of bodies.
    pub assets: Assets,
    /// The surface that measures are defined on.
    pub subdivision: Subdivision,
    sampler: Sampler,
    tpose: TPose,
}

/// One body of the list.
pub struct Specimen {
    /// Sex.
    pub sex: Sex,
    /// Points of [`Assets`] in the T-pose, pelvis at the origin, metres.
    pub points: Vec<Vec3>,
}

/// What a body is for. Nothing is ever fitted to held-out bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Basis, prior and networks are fitted to these.
    Train,
    /// Settings are chosen on these.
    Validation,
    /// Scores are told on these.
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
    /// When the source cannot be had or is not what it should be.
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
    // Surface vertex -> place in `stencils`.
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

    /// The 36 measures of a body given its points.
    pub fn read(&self, points: &[Vec3]) -> Measurements {
        let refined: Vec<DVec3> = self
            .stencils
            .iter()
            .map(|s| s.iter().map(|&(i, w)| points[i as usize].as_dvec3() * f64::from(w)).sum())
            .collect();
        self.definitions.read_all(|v| refined[self.place[v as usize] as usize])
    }
}

/// Whether a body is a person at all: sliders that pile up make a few that are nobody.
///
/// The limits are the paper's extremes ("statistics-anthro"), widened by a tenth of each measure's range, and
/// never narrower than what a factor of 0.82–1.22 leaves; arms below 0.165 m of girth, for one, are nobody's.
pub fn plausible(measures: &Measurements) -> bool {
    measures.iter().enumerate().all(|(i, &m)| {
        let [_, _, low, high] = paper_row(i);
        let slack = 0.1 * (high - low);
        m >= (low - slack).min(low * 0.82) && m <= (high + slack).max(high * 1.22)
    })
}

/// The cage's part of a body's points.
pub fn cage_of(points: &[Vec3]) -> &[Vec3] {
    &points[..CAGE_VERTICES]
}
