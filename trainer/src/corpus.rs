//! Bodies by number: drawn, shaped, T-posed, refined and measured; the same number gives the same body on every machine.

use anthronet::measure::{
    Definition, Definitions, MeasureId, Measurements, Reading, Sex, Skin, Standing, Turn, expand_name,
};
use anthronet::mesh::{Subdivision, Topology};
use glam::{DVec3, Vec3};

use crate::Result;
use crate::assets::{Assets, CAGE_VERTICES, Wheel};
use crate::sampling::{Fixed, Sampler};
use crate::survey::Survey;
use crate::tpose::TPose;

/// Folder of downloads and of everything made from them.
pub const CACHE: &str = "target/anthronet";
/// The seed of the data set; part of its version.
pub const SEED: u64 = 20_230_907;
/// Version of the data set: increased whenever a number would give another body or other measures.
pub const DATA_VERSION: u32 = 5;

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
        self.fixed_specimen(number, Fixed::default())
    }

    /// As [`specimen`](Self::specimen), with some of it fixed instead of drawn.
    pub fn fixed_specimen(&self, number: u64, fixed: Fixed) -> Specimen {
        let person = self.sampler.draw_with(&self.assets, SEED, number, fixed);
        let mut points = self.sampler.shape(&self.assets, &person);
        self.tpose.apply(&self.assets, &mut points);
        Specimen { sex: person.sex, points }
    }

    /// Gives the standing body that these turns make, with the skin of the source.
    ///
    /// # Errors
    /// When a turn does not fit, and those of `take`.
    pub fn with_standing<T>(
        &self,
        turns: &[Turn],
        take: impl FnOnce(&Standing<'_>) -> Result<T>,
    ) -> Result<T> {
        let rig = &self.assets.rig;
        let joints: Vec<String> = rig.joints.iter().map(|joint| joint.name.clone()).collect();
        let parents: Vec<Option<u32>> = rig.joints.iter().map(|j| j.parent.map(|p| p as u32)).collect();
        let skin = self.assets.cage_skin()?;
        let weights = |vertex: u32| skin.refined(&self.subdivision, vertex as usize);
        let skin = Skin { joints: &joints, parents: &parents, weights: &weights };
        take(&Standing::new(turns, skin, self.subdivision.refined().vertex_count)?)
    }

    /// The library's definitions of the measures.
    ///
    /// # Errors
    /// None for the files that the library is built with.
    pub fn definitions(&self) -> Result<Definitions> {
        self.with_standing(&Standing::embedded_turns()?, |standing| Ok(Definitions::embedded(standing)?))
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
pub struct Gauge<R> {
    readings: R,
    // Surface vertex to index in `stencils`.
    place: Vec<u32>,
    stencils: Vec<Vec<(u32, f32)>>,
}

/// Readings of definitions that are not the library's.
pub struct Readings(Vec<Reading>);

impl Readings {
    /// Places the points of definitions.
    ///
    /// # Errors
    /// As [`Reading::new`].
    pub fn new<'a>(
        definitions: impl Iterator<Item = &'a Definition>,
        standing: &Standing<'_>,
    ) -> Result<Self> {
        let readings = definitions.map(|d| Reading::new(d, standing));
        Ok(Self(readings.collect::<anthronet::Result<_>>()?))
    }
}

impl<'a> Gauge<&'a Definitions> {
    /// Prepares to take all measures.
    pub fn new(definitions: &'a Definitions, subdivision: &Subdivision) -> Self {
        Self::over(definitions, definitions.vertices(), subdivision)
    }

    /// The measures of a body given its points.
    pub fn read(&self, points: &[Vec3]) -> Measurements {
        let refined = self.refined(points);
        self.readings.read_all(|v| refined[self.place[v as usize] as usize])
    }
}

impl Gauge<Readings> {
    /// Prepares to take these.
    pub fn of(readings: Readings, subdivision: &Subdivision) -> Self {
        let points = readings.0.iter().flat_map(|reading| reading.points());
        let vertices = points.flat_map(|point| point.terms().iter().map(|term| term.0)).collect();
        Self::over(readings, vertices, subdivision)
    }

    /// All values, metres.
    pub fn read_all(&self, points: &[Vec3]) -> Vec<f64> {
        let refined = self.refined(points);
        self.readings.0.iter().map(|r| r.read(|v| refined[self.place[v as usize] as usize])).collect()
    }
}

impl<R> Gauge<R> {
    fn over(readings: R, vertices: Vec<u32>, subdivision: &Subdivision) -> Self {
        let mut place = vec![u32::MAX; subdivision.refined().vertex_count];
        let mut stencils = Vec::new();
        for v in vertices {
            if place[v as usize] == u32::MAX {
                place[v as usize] = stencils.len() as u32;
                stencils.push(subdivision.stencil(v as usize).collect());
            }
        }
        Self { readings, place, stencils }
    }

    fn refined(&self, points: &[Vec3]) -> Vec<DVec3> {
        self.stencils
            .iter()
            .map(|s| s.iter().map(|&(i, w)| points[i as usize].as_dvec3() * f64::from(w)).sum())
            .collect()
    }
}

/// Range of each measure that a plausible person has: extreme combinations of sliders give a few bodies that are not.
///
/// Ranges are those of both surveys' people together, widened by a quarter of each end. Measures that no survey has are free.
pub struct Plausible(Vec<Option<[f64; 2]>>);

/// How far beyond the smallest and largest person of the surveys.
const BEYOND: [f64; 2] = [0.75, 1.25];

impl Plausible {
    /// By the committed statistics.
    ///
    /// # Errors
    /// As [`crate::survey::committed`].
    pub fn new() -> Result<Self> {
        let mut ranges: Vec<Option<[f64; 2]>> = vec![None; MeasureId::all().len()];
        let statistics = crate::survey::committed()?;
        for survey in Survey::ALL {
            for mapping in survey.mappings() {
                for sex in Sex::ALL {
                    let Some(of_sex) = statistics.get(survey.name()).map(|s| s.of(sex)) else { continue };
                    let quantiles = &of_sex.columns[of_sex.column(mapping.column)?].quantiles;
                    let (Some(low), Some(high)) = (quantiles.first(), quantiles.last()) else { continue };
                    for id in expand_name(mapping.measure).unwrap_or_default() {
                        let range = ranges[id.index()].get_or_insert([f64::INFINITY, 0.0]);
                        *range = [range[0].min(BEYOND[0] * low), range[1].max(BEYOND[1] * high)];
                    }
                }
            }
        }
        Ok(Self(ranges))
    }

    /// Whether a body is plausible as a person.
    pub fn holds(&self, measures: &Measurements) -> bool {
        let within = |(range, m): (&Option<[f64; 2]>, &f64)| {
            m.is_finite() && range.is_none_or(|[low, high]| (low..=high).contains(m))
        };
        self.0.iter().zip(measures).all(within)
    }
}

/// The cage's part of a body's points.
pub fn cage_of(points: &[Vec3]) -> &[Vec3] {
    &points[..CAGE_VERTICES]
}

#[cfg(test)]
mod tests {
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
        let plausible = Plausible::new().unwrap();
        let middle = |range: &Option<[f64; 2]>| range.map_or(0.3, |[low, high]| 0.5 * (low + high));
        let mean: Vec<f64> = plausible.0.iter().map(middle).collect();
        let mean = Measurements::try_from(mean.as_slice()).unwrap();
        assert!(plausible.holds(&mean));
        let arm = MeasureId::from_name("arm_circumference_right").unwrap().index();
        for (girth, expected) in [(0.114, false), (0.135, false), (0.19, true), (0.55, true), (0.7, false)] {
            let mut measures = mean;
            measures[arm] = girth;
            assert_eq!(plausible.holds(&measures), expected, "{girth}");
        }
        let mut measures = mean;
        measures[0] = f64::NAN;
        assert!(!plausible.holds(&measures));
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
