//! Scores of the generator on bodies of a split, and statistics of the sampled bodies beside the paper's.

use std::collections::BTreeMap;

use anthronet::condition::{Population, Request};
use anthronet::format::gltf::to_glb;
use anthronet::measure::{Definitions, MEASURE_COUNT, MeasureId, Measurements, Sex};
use anthronet::model::Model;
use anthronet::random::Random;
use anthronet::scene::{Scene, SceneOptions};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use crate::corpus::{Corpus, Gauge, Split, cage_of};
use crate::dataset::Bodies;
use crate::survey::{Survey, SurveyStatistics};
use crate::{Error, Result};

/// Scores of the generator, millimetres unless stated.
#[derive(Clone, Debug, Serialize)]
pub struct GeneratorScores {
    /// The split: `held-out` unless hyperparameters are being chosen.
    pub split: &'static str,
    /// Number of bodies.
    pub bodies: usize,
    /// Mean vertex distance on level 0, z = encoder mean.
    pub p2p_mm: f64,
    /// The same with z = 0: the variation that the measures do not determine.
    pub p2p_z0_mm: f64,
    /// Mean vertex distance of the body's own coefficients: the error of the shape space.
    pub p2p_shape_space_mm: f64,
    /// Mean absolute error of each measure before the solve, z = encoder mean; `mean` is over all.
    pub measures_mm: BTreeMap<String, f64>,
    /// Number of requests, with all measures given or a random part of them; measured again from the written .glb.
    pub requests: usize,
    /// Number of those that were refused.
    pub refused: usize,
    /// Largest error of a given measure over all requests.
    pub after_solve_max_mm: f64,
    /// Mean over requests of the largest error of a given measure.
    pub after_solve_mean_of_worst_mm: f64,
    /// Mean number of solve steps.
    pub solve_steps: f64,
    /// Mean absolute error of filled measures, by the measures given besides the sex.
    pub fill_mm: BTreeMap<String, f64>,
    /// Share of filled measures inside their 90 % interval, by the given measures.
    pub fill_coverage90: BTreeMap<String, f64>,
}

struct OfBody {
    p2p: f64,
    p2p_z0: f64,
    p2p_space: f64,
    errors: Measurements,
    // Largest error of a given measure and number of steps; `None` when refused.
    solved: Option<(f64, usize)>,
    fill: Vec<(f64, f64)>,
}

/// Given measures of the partial requests that the prior is scored on.
const PARTIAL: [(&str, &[&str]); 4] = [
    ("sex", &[]),
    ("height", &["height"]),
    ("height, waist", &["height", "waist_circumference"]),
    (
        "height, waist, chest, hip",
        &["height", "waist_circumference", "chest_circumference", "hip_circumference"],
    ),
];

/// Scores a model on bodies of a split, given by their numbers.
///
/// # Errors
/// When a body cannot be generated for a reason other than an infeasible request.
pub fn generator(
    model: &Model,
    corpus: &Corpus,
    split: Split,
    numbers: &[u64],
    progress: &(dyn Fn() + Sync),
) -> Result<GeneratorScores> {
    let gauge = Gauge::new(model.definitions(), &corpus.subdivision);
    let count = numbers.len();
    let of_bodies = numbers
        .par_iter()
        .map(|&number| {
            let result = score(model, corpus, &gauge, number);
            progress();
            result
        })
        .collect::<Result<Vec<OfBody>>>()?;
    let n = count as f64;
    let mean = |of: &dyn Fn(&OfBody) -> f64| of_bodies.iter().map(of).sum::<f64>() / n;
    let mut measures_mm = BTreeMap::new();
    let mut total = 0.0;
    for id in MeasureId::all() {
        let error = mean(&|b| b.errors[id.index()]);
        total += error / MEASURE_COUNT as f64;
        measures_mm.insert(id.name().to_owned(), error);
    }
    measures_mm.insert("mean".into(), total);
    let solved: Vec<(f64, usize)> = of_bodies.iter().filter_map(|b| b.solved).collect();
    let met = solved.len().max(1) as f64;
    let fill = |k: usize, what: &dyn Fn(&(f64, f64)) -> f64| mean(&|b| what(&b.fill[k]));
    Ok(GeneratorScores {
        split: split.name(),
        bodies: count,
        p2p_mm: mean(&|b| b.p2p),
        p2p_z0_mm: mean(&|b| b.p2p_z0),
        p2p_shape_space_mm: mean(&|b| b.p2p_space),
        measures_mm,
        requests: count,
        refused: count - solved.len(),
        after_solve_max_mm: solved.iter().map(|s| s.0).fold(0.0, f64::max),
        after_solve_mean_of_worst_mm: solved.iter().map(|s| s.0).sum::<f64>() / met,
        solve_steps: solved.iter().map(|s| s.1 as f64).sum::<f64>() / met,
        fill_mm: PARTIAL.iter().enumerate().map(|(k, p)| (p.0.to_owned(), fill(k, &|f| f.0))).collect(),
        fill_coverage90: PARTIAL
            .iter()
            .enumerate()
            .map(|(k, p)| (p.0.to_owned(), fill(k, &|f| f.1)))
            .collect(),
    })
}

fn score(model: &Model, corpus: &Corpus, gauge: &Gauge<&Definitions>, number: u64) -> Result<OfBody> {
    let specimen = corpus.specimen(number);
    let cage = cage_of(&specimen.points);
    let truth = corpus.subdivision.refine(cage)?;
    let measures = gauge.read(&specimen.points);
    let own = model.shape_space().project(cage);
    let z = model.encode(&measures, specimen.sex, &own)?;
    let distance = |coefficients: &[f64]| -> Result<f64> {
        let body = model.shape_space().body(coefficients);
        Ok(1000.0 * mean_distance(&corpus.subdivision.refine(cage_of(&body))?, &truth))
    };
    let decoded = model.decode(&measures, specimen.sex, &z);
    let none = vec![0.0; model.latent_size()];
    let obtained = model.measures_of(&decoded);

    let mut request = Request { sex: Some(specimen.sex), ..Request::default() };
    // About half of the requests give only a part of the measures.
    let mut random = Random::new(number, 77);
    let keep = if random.uniform() < 0.5 { 1.0 } else { random.uniform() };
    for (slot, value) in request.measures.iter_mut().zip(measures) {
        *slot = (random.uniform() < keep).then_some(value);
    }
    Ok(OfBody {
        p2p: distance(&decoded)?,
        p2p_z0: distance(&model.decode(&measures, specimen.sex, &none))?,
        p2p_space: distance(&own)?,
        errors: std::array::from_fn(|i| 1000.0 * (obtained[i] - measures[i]).abs()),
        solved: solve(model, &request)?,
        fill: PARTIAL
            .iter()
            .map(|(_, given)| fill(model, &specimen.sex, &measures, given))
            .collect::<Result<_>>()?,
    })
}

/// Generates, writes a .glb, reads it again and measures: the largest error of a given measure, mm.
fn solve(model: &Model, request: &Request) -> Result<Option<(f64, usize)>> {
    let body = match model.generate(request) {
        Ok(body) => body,
        Err(anthronet::Error::Infeasible(_)) => return Ok(None),
        Err(e) => return Err(e.into()),
    };
    let glb = to_glb(&Scene::from_body(&body, &SceneOptions::default())?)?;
    let file = anthronet::format::read_meshes_from_bytes(&glb, "body.glb")?;
    let mesh = file.meshes.first().ok_or_else(|| Error::Invalid("the written .glb has no mesh".into()))?;
    let again = model.definitions().read_all(|v| glam::Vec3::from(mesh.positions[v as usize]).as_dvec3());
    let worst =
        request.given().map(|(id, asked)| 1000.0 * (again[id.index()] - asked).abs()).fold(0.0, f64::max);
    Ok(Some((worst, body.report().iterations)))
}

/// Mean absolute error (mm) of the filled measures, and the number inside their interval.
fn fill(
    model: &Model,
    sex: &anthronet::measure::Sex,
    measures: &Measurements,
    given: &[&str],
) -> Result<(f64, f64)> {
    let mut known = [None; MEASURE_COUNT];
    for name in given {
        let id = MeasureId::from_name(name).ok_or_else(|| Error::Invalid(format!("no measure {name}")))?;
        known[id.index()] = Some(measures[id.index()]);
    }
    let conditional = model.prior(Population::Synthetic).of(*sex).condition(&known)?;
    let (low, high) = conditional.interval90();
    let open: Vec<usize> = (0..MEASURE_COUNT).filter(|i| known[*i].is_none()).collect();
    let n = open.len() as f64;
    let error = open.iter().map(|&i| 1000.0 * (conditional.mean()[i] - measures[i]).abs()).sum::<f64>() / n;
    let inside = open.iter().filter(|&&i| (low[i]..=high[i]).contains(&measures[i])).count() as f64 / n;
    Ok((error, inside))
}

fn mean_distance(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(p, q)| DVec3::distance(p.as_dvec3(), q.as_dvec3())).sum::<f64>() / a.len() as f64
}

/// The paper's mean errors before the solve, millimetres ("generative_ablation_table").
const PAPERS: [(&str, f64); 6] = [
    ("chest_circumference", 46.9),
    ("hip_circumference", 9.79),
    ("waist_circumference", 12.3),
    ("arm_circumference_left", 6.22),
    ("calf_circumference_left", 4.53),
    ("thigh_circumference_left", 9.93),
];

impl GeneratorScores {
    /// The scores that a model file records, by name with the unit.
    pub fn summary(&self) -> BTreeMap<String, f64> {
        let measure = |name: &str| self.measures_mm.get(name).copied().unwrap_or(f64::NAN);
        let mut summary: BTreeMap<String, f64> =
            PAPERS.iter().map(|(name, _)| (format!("{name}_mm"), measure(name))).collect();
        summary.extend(
            [
                ("bodies", self.bodies as f64),
                ("refused", self.refused as f64),
                ("p2p_mm", self.p2p_mm),
                ("p2p_z0_mm", self.p2p_z0_mm),
                ("p2p_shape_space_mm", self.p2p_shape_space_mm),
                ("measures_mean_mm", measure("mean")),
                ("after_solve_max_mm", self.after_solve_max_mm),
            ]
            .map(|(name, value)| (name.to_owned(), value)),
        );
        summary
    }
}

impl std::fmt::Display for GeneratorScores {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "generator on {} {} bodies (the paper's number in brackets)", self.bodies, self.split)?;
        writeln!(f, "  mean vertex distance, z = encoder mean   {:8.3} mm  (3.83)", self.p2p_mm)?;
        writeln!(f, "  mean vertex distance, z = 0              {:8.3} mm", self.p2p_z0_mm)?;
        writeln!(f, "  mean vertex distance of the shape space  {:8.3} mm", self.p2p_shape_space_mm)?;
        writeln!(f, "measures before the solve, mean absolute error")?;
        for (name, error) in &self.measures_mm {
            let paper = PAPERS.iter().find(|p| p.0 == name).map_or(String::new(), |p| format!("  ({})", p.1));
            writeln!(f, "  {name:40} {error:8.3} mm{paper}")?;
        }
        writeln!(f, "after the solve, measured again from the written .glb")?;
        writeln!(f, "  requests, refused                        {:8} {}", self.requests, self.refused)?;
        writeln!(f, "  worst given measure of all               {:8.5} mm", self.after_solve_max_mm)?;
        writeln!(
            f,
            "  mean of each request's worst             {:8.5} mm",
            self.after_solve_mean_of_worst_mm
        )?;
        writeln!(f, "  steps                                    {:8.2}", self.solve_steps)?;
        writeln!(f, "measures that were not given: error, and share inside the 90 % interval")?;
        for (given, error) in &self.fill_mm {
            let inside = 100.0 * self.fill_coverage90.get(given).copied().unwrap_or(0.0);
            writeln!(f, "  given {given:34} {error:8.2} mm {inside:7.1} %")?;
        }
        Ok(())
    }
}

/// Statistics of the measures of the sampled bodies, beside the paper's and a survey's.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// Number of bodies.
    pub bodies: usize,
    /// Number of drawn bodies that were left out as implausible.
    pub rejected: usize,
    /// Root mean square of the rows' z.
    pub rms_z: f64,
    /// One row per sex and measure.
    pub measures: Vec<StatisticsRow>,
}

/// One row of the table of statistics; metres.
#[derive(Clone, Debug, Serialize)]
pub struct StatisticsRow {
    /// The sex.
    pub sex: Sex,
    /// Measure, with its side.
    pub name: String,
    /// Mean, standard deviation, minimum, maximum of the bodies of that sex.
    pub ours: [f64; 4],
    /// Mean and standard deviation of the bodies when those as tall as people count as often as among people: statures are drawn
    /// evenly.
    pub as_tall: [f64; 2],
    /// Mean and standard deviation of the people of ANSUR II, where a column is the measure.
    pub people: Option<[f64; 2]>,
    /// Mean, standard deviation, minimum, maximum of the paper's 100k bodies of both sexes ("statistics-anthro"); some of its
    /// measures are taken elsewhere.
    pub paper: Option<[f64; 4]>,
    /// The mean of `as_tall` minus the people's, in the people's standard deviations.
    pub z: Option<f64>,
}

/// The paper's table "statistics-anthro": measure without side; mean, standard deviation, minimum, maximum, metres.
const PAPER: [(&str, [f64; 4]); 24] = [
    ("waist_circumference", [0.828, 0.174, 0.55, 1.250]),
    ("chest_circumference", [1.061, 0.159, 0.76, 1.522]),
    ("hip_circumference", [0.988, 0.154, 0.72, 1.368]),
    ("height", [1.760, 0.144, 1.49, 1.991]),
    ("shoulder_width", [0.295, 0.012, 0.248, 0.335]),
    ("torso_height_back", [0.376, 0.030, 0.310, 0.425]),
    ("torso_height_front", [0.324, 0.029, 0.256, 0.394]),
    ("head_circumference", [0.546, 0.009, 0.521, 0.554]),
    ("neck_circumference", [0.431, 0.044, 0.320, 0.541]),
    ("head_height", [0.245, 0.004, 0.232, 0.251]),
    ("neck_length_midline", [0.092, 0.013, 0.056, 0.115]),
    ("neck_length_lateral", [0.120, 0.012, 0.078, 0.141]),
    ("hand_size", [0.177, 0.011, 0.149, 0.197]),
    ("arm_circumference", [0.283, 0.052, 0.165, 0.409]),
    ("arm_length", [0.329, 0.029, 0.270, 0.395]),
    ("forearm_circumference", [0.270, 0.038, 0.184, 0.367]),
    ("forearm_length", [0.254, 0.027, 0.197, 0.300]),
    ("thigh_circumference", [0.551, 0.073, 0.395, 0.733]),
    ("thigh_length", [0.512, 0.046, 0.415, 0.590]),
    ("calf_circumference", [0.354, 0.042, 0.248, 0.458]),
    ("calf_length", [0.424, 0.040, 0.348, 0.504]),
    ("foot_width", [0.098, 0.007, 0.083, 0.115]),
    ("heel_to_ball_length", [0.198, 0.014, 0.169, 0.225]),
    ("heel_to_toe_length", [0.269, 0.019, 0.229, 0.306]),
];

/// The paper's mean, standard deviation, minimum and maximum of a measure, metres; `None` for one that it does not have.
pub fn paper_row(id: MeasureId) -> Option<[f64; 4]> {
    PAPER.iter().find(|row| row.0 == id.base_name()).map(|row| row.1)
}

impl Statistics {
    /// The statistics of some splits of the data set, beside the people of a survey.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the survey lacks a column that a measure is.
    pub fn of(
        splits: &[&Bodies],
        rejected: usize,
        survey: Survey,
        people: &SurveyStatistics,
    ) -> Result<Self> {
        let mappings = survey.mappings();
        let mut measures = Vec::new();
        for sex in Sex::ALL {
            let of_sex = people.of(sex);
            let column = |id: MeasureId| -> Result<Option<[f64; 2]>> {
                let mapping = mappings.iter().find(|mapping| mapping.measure == id.base_name());
                let found = mapping.map(|m| Ok::<_, Error>(&of_sex.columns[of_sex.column(m.column)?]));
                Ok(found.transpose()?.map(|c| [c.mean, c.deviation]))
            };
            let bodies: Vec<&[f32]> = splits
                .iter()
                .flat_map(|b| (0..b.len()).filter(|&i| b.sex(i) == sex).map(|i| b.measures(i)))
                .collect();
            let stature = |row: &[f32]| f64::from(row[MeasureId::HEIGHT.index()]);
            let weights: Vec<f64> = match column(MeasureId::HEIGHT)? {
                Some([mean, deviation]) => bodies
                    .iter()
                    .map(|row| libm::exp(-0.5 * libm::pow((stature(row) - mean) / deviation, 2.0)))
                    .collect(),
                None => vec![1.0; bodies.len()],
            };
            for id in MeasureId::all() {
                let values = || bodies.iter().map(|row| f64::from(row[id.index()]));
                let even = spread(values().map(|v| (v, 1.0)));
                let as_tall = spread(values().zip(weights.iter().copied()));
                let least = values().fold(f64::INFINITY, f64::min);
                let people = column(id)?;
                measures.push(StatisticsRow {
                    sex,
                    name: id.name().to_owned(),
                    ours: [even[0], even[1], least, values().fold(0.0, f64::max)],
                    as_tall,
                    people,
                    paper: paper_row(id),
                    z: people.map(|[mean, deviation]| (as_tall[0] - mean) / deviation),
                });
            }
        }
        let squares: Vec<f64> = measures.iter().filter_map(|row| row.z).map(|z| z * z).collect();
        Ok(Self {
            bodies: splits.iter().map(|b| b.len()).sum(),
            rejected,
            rms_z: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
            measures,
        })
    }
}

/// Mean and standard deviation of values with weights.
fn spread(values: impl Iterator<Item = (f64, f64)> + Clone) -> [f64; 2] {
    let total: f64 = values.clone().map(|v| v.1).sum();
    let mean = values.clone().map(|(v, w)| v * w).sum::<f64>() / total;
    [mean, (values.map(|(v, w)| w * (v - mean) * (v - mean)).sum::<f64>() / total).sqrt()]
}

impl std::fmt::Display for Statistics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{} bodies ({} rejected); metres", self.bodies, self.rejected)?;
        writeln!(
            f,
            "ours: all; as tall as people: mean and deviation; people: ANSUR II's; paper: its bodies of both sexes"
        )?;
        writeln!(
            f,
            "z: ours as tall as people minus the people's, in the people's deviations; rms {:.2}",
            self.rms_z
        )?;
        let titles = |columns: &[&str]| columns.iter().map(|c| format!(" {c:>6}")).collect::<String>();
        let four = titles(&["mean", "std", "min", "max"]);
        let two = titles(&["mean", "std"]);
        for sex in Sex::ALL {
            writeln!(f, "\n{sex:28}{four} |{two} |{two} |{four} | {:>5}", "z")?;
            for row in self.measures.iter().filter(|row| row.sex == sex) {
                let numbers = |of: &[f64]| of.iter().map(|v| format!(" {v:6.3}")).collect::<String>();
                let people = row.people.map_or_else(|| titles(&["–", "–"]), |of| numbers(&of));
                let paper = row.paper.map_or_else(|| titles(&["–"; 4]), |of| numbers(&of));
                let z = row.z.map_or_else(String::new, |z| format!("{z:5.2}"));
                let (ours, as_tall) = (numbers(&row.ours), numbers(&row.as_tall));
                writeln!(f, "{:28}{ours} |{as_tall} |{people} |{paper} | {z:>5}", row.name)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_have_the_promised_fields() {
        let scores = GeneratorScores {
            split: "held-out",
            bodies: 2,
            p2p_mm: 1.5,
            p2p_z0_mm: 9.0,
            p2p_shape_space_mm: 0.25,
            measures_mm: BTreeMap::from([("mean".into(), 0.2), ("chest_circumference".into(), 1.25)]),
            requests: 2,
            refused: 0,
            after_solve_max_mm: 0.001,
            after_solve_mean_of_worst_mm: 0.0005,
            solve_steps: 2.0,
            fill_mm: BTreeMap::from([("sex".into(), 35.0)]),
            fill_coverage90: BTreeMap::from([("sex".into(), 0.9)]),
        };
        let json = serde_json::to_value(&scores).unwrap();
        let keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
        for promised in ["bodies", "p2p_mm", "p2p_z0_mm", "measures_mm", "after_solve_max_mm"] {
            assert!(keys.contains(&promised), "{keys:?}");
        }
        assert_eq!(json["measures_mm"]["mean"], 0.2);
        assert_eq!(json["split"], "held-out");
        let summary = scores.summary();
        assert_eq!((summary["chest_circumference_mm"], summary["measures_mean_mm"]), (1.25, 0.2));
        let text = scores.to_string();
        assert!(text.contains("chest_circumference") && text.contains("1.250 mm  (46.9)"), "{text}");
    }

    #[test]
    fn statistics_tell_how_far_the_means_are() {
        let committed = crate::survey::committed().unwrap();
        let people = &committed["ansur2"];
        // Per sex two bodies about a mean that is one of the people's deviations above theirs, but for the stature.
        let mut bodies = Bodies { numbers: (0..4).collect(), sex: vec![0, 0, 1, 1], ..Bodies::default() };
        for sex in Sex::ALL {
            let of_sex = people.of(sex);
            for sign in [-1.0, 1.0] {
                bodies.measures.extend(MeasureId::all().map(|id| {
                    let mapping = Survey::Ansur2.mappings().into_iter().find(|m| m.measure == id.base_name());
                    let column = mapping.map(|m| &of_sex.columns[of_sex.column(m.column).unwrap()]);
                    let [mean, deviation] = column.map_or([1.0, 0.1], |c| [c.mean, c.deviation]);
                    let above = if id == MeasureId::HEIGHT { 0.0 } else { deviation };
                    (mean + above + sign * 0.01) as f32
                }));
            }
        }
        let statistics = Statistics::of(&[&bodies], 3, Survey::Ansur2, people).unwrap();
        assert_eq!((statistics.bodies, statistics.rejected), (4, 3));
        assert_eq!(statistics.measures.len(), 2 * MEASURE_COUNT);
        for row in &statistics.measures {
            let expected = if row.name == "height" { 0.0 } else { 1.0 };
            assert!(row.z.is_none_or(|z| (z - expected).abs() < 1e-3), "{row:?}");
            assert_eq!(row.z.is_some(), row.people.is_some());
            assert!((row.ours[1] - 0.01).abs() < 1e-6 && (row.ours[3] - row.ours[2] - 0.02).abs() < 1e-6);
        }
        let mapped = statistics.measures.iter().filter(|row| row.z.is_some()).count() as f64;
        assert!((statistics.rms_z - ((mapped - 2.0) / mapped).sqrt()).abs() < 1e-3);
        assert!(statistics.to_string().contains("waist_circumference"));
    }
}
