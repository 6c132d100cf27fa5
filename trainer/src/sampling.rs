//! Draws random people: MakeHuman slider values around centres that make the mean person that of a survey.
//!
//! Sex, age, muscle, weight, proportions and ethnicity are drawn over their whole range; stature is drawn
//! uniformly and the height slider solved for it; local sliders vary together ([`crate::smoothness`]) around centres of each sex,
//! which bring the means of the measures to those of ANSUR II ([`crate::biases`]); heads grow with stature as people's do, not as
//! bodies.

use std::collections::BTreeMap;

use anthronet::measure::Sex;
use anthronet::random::Random;
use anthronet::skeleton::SidedJoint;
use faer::Mat;
use glam::Vec3;
use sha2::{Digest, Sha256};

use crate::assets::{Assets, CROWN, HEELS, Modifier, Target};
use crate::smoothness::{Bending, SmoothDraws};
use crate::{Error, Result};

/// Shortest and tallest stature drawn, metres: the paper's table.
pub const STATURE: [f64; 2] = [1.49, 1.991];

const CENTRES: &str = include_str!("sampling_bias.json");

/// A drawn person: blend shapes with their weights.
#[derive(Clone, Debug)]
pub struct Person {
    /// Sex.
    pub sex: Sex,
    /// Target numbers and weights, without those that set the stature.
    pub shapes: Vec<(usize, f32)>,
    /// Wanted stature, metres.
    pub stature: f64,
    /// Targets that shorten the person, with weights.
    shorter: Vec<(usize, f32)>,
    /// Targets that lengthen the person, with weights.
    taller: Vec<(usize, f32)>,
}

/// Draws people from a source of bodies.
pub struct Sampler {
    /// Local sliders, those of the body before those of the face.
    locals: Vec<Local>,
    draws: [SmoothDraws; 2],
    centres: [Macros; 2],
}

/// A local slider.
struct Local {
    modifier: Modifier,
    /// Its centre, per sex.
    centres: [f64; 2],
}

/// Medians of the sliders of the whole body, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Macros {
    muscle: f64,
    weight: f64,
}

/// Centres of all sliders that have one, by MakeHuman's name; [`MUSCLE`] and [`WEIGHT`] are medians from 0 to 1.
pub type Centres = BTreeMap<String, f64>;

/// Muscle and weight among the [`Centres`].
pub const MUSCLE: &str = "macro-muscle";
/// See [`MUSCLE`].
pub const WEIGHT: &str = "macro-weight";

/// Standard deviations of sliders of the body and of the face, and the price of bending of each group, which lowers them.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spread {
    Body(f64),
    Face(f64),
}
const STIFFNESS: [f64; 2] = [45.0, 20.0];

/// Shapes of the beta distributions of muscle and weight: below 1, builds at the ends are more frequent than in the middle.
const MUSCLE_SHAPE: f64 = 1.3;
const WEIGHT_SHAPE: f64 = 0.8;
/// Age from 25 to 90 years is a uniform number to this power: a third of the way at the mean.
const AGE_POWER: f64 = 1.8;

/// Difference between left and right of a sided slider, standard deviation.
const ASYMMETRY: f64 = 0.03;
/// Our own slider, and the standard deviation of its sides' difference: no other slider lets the toes of two feet differ.
const TOE_LENGTH: &str = "toe-length";
const TOE_ASYMMETRY: f64 = 0.12;

/// How much the three scales of the head fall with stature, slider per metre. MakeHuman's height slider enlarges the
/// head with the body, by a fifth from the shortest to the tallest; heads of people hardly grow with stature (their
/// circumference by 9 cm a metre in ANSUR II).
const HEAD_WITH_STATURE: f64 = 1.0;

/// The committed centres, female first. [`crate::biases`] fits them.
///
/// # Errors
/// [`Error::Invalid`] when the file is not what it should be.
pub fn committed_centres() -> Result<[Centres; 2]> {
    let mut of_sexes: BTreeMap<String, Centres> =
        serde_json::from_str(CENTRES).map_err(|e| Error::Invalid(format!("sampling_bias.json: {e}")))?;
    Ok(Sex::ALL.map(|sex| of_sexes.remove(sex.name()).unwrap_or_default()))
}

/// SHA-256 of the committed centres, in hexadecimal.
pub fn centres_hash() -> String {
    Sha256::digest(CENTRES).iter().map(|b| format!("{b:02x}")).collect()
}

/// What is fixed of a person instead of drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fixed {
    /// The sex.
    pub sex: Option<Sex>,
    /// Mean and standard deviation of a normal distribution of the stature, metres.
    pub stature: Option<[f64; 2]>,
    /// The middle of everything else.
    pub middle: bool,
}

impl Sampler {
    /// Prepares the sliders; adds our own to the targets, which MakeHuman does not have.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the centres name an unknown slider.
    pub fn new(assets: &mut Assets) -> Result<Self> {
        let toes = toe_length(assets)?;
        assets.targets.add_procedural(TOE_LENGTH, "feet", toes);
        let bending = Bending::new(&assets.mesh.cage, &assets.base);
        let mut locals = Vec::new();
        let mut draws = Vec::new();
        for (face, stiffness) in [false, true].into_iter().zip(STIFFNESS) {
            let of_group = assets.targets.modifiers.iter().filter_map(|modifier| match spread(modifier)? {
                Spread::Body(deviation) if !face => Some((modifier, deviation)),
                Spread::Face(deviation) if face => Some((modifier, deviation)),
                _ => None,
            });
            let of_group: Vec<(&Modifier, f64)> = of_group.collect();
            draws.push(SmoothDraws::new(&bending, &assets.targets, &of_group, stiffness)?);
            locals.extend(of_group.iter().map(|(m, _)| Local { modifier: (*m).clone(), centres: [0.0; 2] }));
        }
        let draws = <[SmoothDraws; 2]>::try_from(draws)
            .map_err(|_| Error::Invalid("sliders of a third kind".into()))?;
        let middle = Macros { muscle: 0.5, weight: 0.5 };
        let mut sampler = Self { locals, draws, centres: [middle; 2] };
        for (sex, centres) in Sex::ALL.into_iter().zip(committed_centres()?) {
            sampler.set_centres(sex, &centres)?;
        }
        Ok(sampler)
    }

    /// Replaces the centres of the sliders that are named; the others keep theirs.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a slider that is unknown or not sampled.
    pub fn set_centres(&mut self, sex: Sex, centres: &Centres) -> Result<()> {
        for (name, value) in centres {
            match name.as_str() {
                MUSCLE => self.centres[sex.index()].muscle = *value,
                WEIGHT => self.centres[sex.index()].weight = *value,
                name => {
                    let local = self.locals.iter_mut().find(|local| local.modifier.name == name);
                    let unknown =
                        || Error::Invalid(format!("sampling_bias.json: {name} is no slider that is sampled"));
                    local.ok_or_else(unknown)?.centres[sex.index()] = *value;
                }
            }
        }
        Ok(())
    }

    /// Names of the local sliders, and their precision: the inverse covariance that they are drawn with.
    pub fn precision(&self) -> (Vec<&str>, Mat<f64>) {
        let names: Vec<&str> = self.locals.iter().map(|local| local.modifier.name.as_str()).collect();
        let [body, face] = [0, 1].map(|group| &self.draws[group].precision);
        let n = body.nrows();
        let precision = Mat::from_fn(names.len(), names.len(), |i, j| match (i < n, j < n) {
            (true, true) => body[(i, j)],
            (false, false) => face[(i - n, j - n)],
            _ => 0.0,
        });
        (names, precision)
    }

    /// Draws the person with this number of this seed; the same pair gives the same person everywhere.
    pub fn draw(&self, assets: &Assets, seed: u64, number: u64) -> Person {
        self.draw_with(assets, seed, number, Fixed::default())
    }

    /// As [`draw`](Self::draw), with some of it fixed.
    pub fn draw_with(&self, assets: &Assets, seed: u64, number: u64, fixed: Fixed) -> Person {
        let mut rng = Random::new(seed, number);
        let drawn = if rng.uniform() < 0.5 { Sex::Female } else { Sex::Male };
        let sex = fixed.sex.unwrap_or(drawn);
        let middle = |value: f64, middle: f64| if fixed.middle { middle } else { value };
        let age = middle(libm::pow(rng.uniform(), AGE_POWER), 1.0 / (1.0 + AGE_POWER));
        let ages = [("young", 1.0 - age), ("old", age)];
        let centres = self.centres[sex.index()];
        let muscle = with_median(middle(beta(&mut rng, MUSCLE_SHAPE), 0.5), centres.muscle);
        let weight = with_median(middle(beta(&mut rng, WEIGHT_SHAPE), 0.5), centres.weight);
        let muscles = three(muscle, ["minmuscle", "averagemuscle", "maxmuscle"]);
        let weights = three(weight, ["minweight", "averageweight", "maxweight"]);
        let proportion = middle(rng.uniform() * 2.0 - 1.0, 0.0);
        let cups = three(middle(rng.uniform(), 0.5), ["mincup", "averagecup", "maxcup"]);
        let firmnesses = three(middle(rng.uniform(), 0.5), ["minfirmness", "averagefirmness", "maxfirmness"]);
        let mut races = dirichlet(&mut rng, ["african", "asian", "caucasian"]);
        if fixed.middle {
            races = races.map(|(race, _)| (race, 1.0 / 3.0));
        }
        let place = rng.uniform();
        let stature = match fixed.stature {
            Some([mean, _]) if fixed.middle => mean,
            Some([mean, deviation]) => mean + deviation * rng.normal(),
            None => STATURE[0] + (STATURE[1] - STATURE[0]) * place,
        };

        let mut person = Person { sex, shapes: Vec::new(), stature, shorter: Vec::new(), taller: Vec::new() };
        let set = &assets.targets;
        let add = |list: &mut Vec<(usize, f32)>, key: String, weight: f64| {
            if let Some(number) = set.number(&key).filter(|_| weight != 0.0) {
                list.push((number, weight as f32));
            }
        };
        for (age, wa) in ages {
            for (race, wr) in races {
                add(&mut person.shapes, format!("macrodetails/{race}-{sex}-{age}"), wr * wa);
            }
            for (muscle, wm) in muscles {
                for (weight, ww) in weights {
                    let w = wa * wm * ww;
                    let build = format!("{sex}-{age}-{muscle}-{weight}");
                    add(&mut person.shapes, format!("macrodetails/universal-{build}"), w);
                    let (kind, wp) =
                        if proportion < 0.0 { ("uncommon", -proportion) } else { ("ideal", proportion) };
                    add(
                        &mut person.shapes,
                        format!("macrodetails/proportions/{build}-{kind}proportions"),
                        w * wp,
                    );
                    add(&mut person.shorter, format!("macrodetails/height/{build}-minheight"), w);
                    add(&mut person.taller, format!("macrodetails/height/{build}-maxheight"), w);
                    for (cup, wc) in cups {
                        for (firmness, wf) in firmnesses {
                            add(&mut person.shapes, format!("breast/{build}-{cup}-{firmness}"), w * wc * wf);
                        }
                    }
                }
            }
        }
        let drawn = self.draws.iter().flat_map(|group| group.draw(&mut rng)).collect::<Vec<f64>>();
        for (Local { modifier, centres }, drawn) in self.locals.iter().zip(drawn) {
            let value = centres[sex.index()] + with_stature(&modifier.name, stature) + middle(drawn, 0.0);
            let asymmetry = if modifier.name.starts_with(TOE_LENGTH) { TOE_ASYMMETRY } else { ASYMMETRY };
            for [negative, positive] in &modifier.pairs {
                let sided = if modifier.pairs.len() > 1 { asymmetry * rng.normal() } else { 0.0 };
                let sided = middle(sided, 0.0);
                let value = value + sided;
                let target = if value < 0.0 { negative } else { positive };
                if let Some(number) = target {
                    person.shapes.push((*number, value.abs() as f32));
                }
            }
        }
        person
    }

    /// The person's points in MakeHuman's pose, with the drawn stature; metres.
    pub fn shape(&self, assets: &Assets, person: &Person) -> Vec<Vec3> {
        let mut points = assets.base.clone();
        for &(number, weight) in &person.shapes {
            assets.targets.get(number).add_to(&mut points, weight);
        }
        // Stature is linear in the height slider on either side of its middle.
        let stature = |points: &[Vec3]| {
            let y = |v: u32| points[v as usize].y;
            f64::from(y(CROWN) - 0.5 * (y(HEELS[0]) + y(HEELS[1])))
        };
        let now = stature(&points);
        let side = if person.stature < now { &person.shorter } else { &person.taller };
        let mut change = vec![Vec3::ZERO; points.len()];
        for &(number, weight) in side {
            assets.targets.get(number).add_to(&mut change, weight);
        }
        let per_slider = stature(&change);
        if per_slider.abs() > 1e-6 {
            let slider = ((person.stature - now) / per_slider) as f32;
            for (p, d) in points.iter_mut().zip(&change) {
                *p += *d * slider;
            }
        }
        points
    }
}

/// The distribution of each kind of slider; `None` for those that are not sampled: translations of whole parts, which
/// only move the body in space, pregnancy, and the genital bulge.
fn spread(modifier: &Modifier) -> Option<Spread> {
    let name = modifier.name.as_str();
    let whole_part = ["torso-trans", "hip-trans", "neck-trans", "head-trans", "hand-trans", "foot-trans"];
    if whole_part.iter().any(|p| name.starts_with(p))
        || ["stomach-pregnant", "bulge-", "leg-valgus", "hand-fingers-distance"]
            .iter()
            .any(|p| name.starts_with(p))
    {
        return None;
    }
    Some(match modifier.group.as_str() {
        "head" => Spread::Body(0.3),
        "neck" => Spread::Body(0.1),
        "forehead" => Spread::Face(0.4),
        "cheek" | "chin" | "ears" | "eyebrows" | "eyes" | "mouth" | "nose" => Spread::Face(0.7),
        _ => Spread::Body(0.25),
    })
}

/// A number from 0 to 1 whose distribution has the median ½, bent so that it has this median.
fn with_median(value: f64, median: f64) -> f64 {
    libm::pow(value, libm::log(median) / libm::log(0.5))
}

/// The part of a slider's value that depends on stature.
fn with_stature(name: &str, stature: f64) -> f64 {
    let middle = 0.5 * (STATURE[0] + STATURE[1]);
    if name.starts_with("head-scale-") { -HEAD_WITH_STATURE * (stature - middle) } else { 0.0 }
}

/// Weights of three stops of a slider from 0 to 1.
fn three(value: f64, names: [&'static str; 3]) -> [(&'static str, f64); 3] {
    let t = 2.0 * value;
    if t < 1.0 {
        [(names[0], 1.0 - t), (names[1], t), (names[2], 0.0)]
    } else {
        [(names[0], 0.0), (names[1], 2.0 - t), (names[2], t - 1.0)]
    }
}

/// Toes of the left and the right foot longer by a quarter at weight one: what lies before the ball is stretched
/// forwards.
fn toe_length(assets: &Assets) -> Result<[Target; 2]> {
    let mut feet = [Target::default(), Target::default()];
    let heads = assets.mesh.raw_of_surface.len();
    for (target, ball) in feet.iter_mut().zip(SidedJoint::Ball.both()) {
        let ball = assets.rig.require(ball.name())?;
        let start = assets.base[heads + ball];
        for (p, influences) in assets.rig.weights.iter().enumerate() {
            let ahead = assets.base[p].z - start.z;
            if ahead > 0.0 && influences.iter().any(|&(j, _)| usize::from(j) == ball) {
                // Quadratic at first, so that the stretch starts without a crease.
                let soft = ahead * ahead / (ahead + 0.01);
                target.points.push(p as u32);
                target.deltas.push(Vec3::Z * 0.25 * soft);
            }
        }
        let toe_tip = heads + assets.rig.joints.len() + ball;
        target.points.push(toe_tip as u32);
        target.deltas.push(Vec3::Z * 0.25 * (assets.base[toe_tip].z - start.z).max(0.0));
    }
    Ok(feet)
}

/// Beta(a, a) (Jöhnk 1964); efficient for a up to about 1.
fn beta(random: &mut Random, a: f64) -> f64 {
    loop {
        let (x, y) = (libm::pow(random.uniform(), 1.0 / a), libm::pow(random.uniform(), 1.0 / a));
        if x + y > 0.0 && x + y <= 1.0 {
            return x / (x + y);
        }
    }
}

/// Dirichlet(1): normalised exponentials.
fn dirichlet<const N: usize>(random: &mut Random, names: [&'static str; N]) -> [(&'static str, f64); N] {
    let draws = names.map(|n| (n, -libm::log(random.uniform())));
    let sum: f64 = draws.iter().map(|d| d.1).sum();
    draws.map(|(n, d)| (n, d / sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_of_a_slider_share_it() {
        let names = ["min", "average", "max"];
        for (value, expected) in
            [(0.0, [1.0, 0.0, 0.0]), (0.25, [0.5, 0.5, 0.0]), (0.5, [0.0, 1.0, 0.0]), (1.0, [0.0, 0.0, 1.0])]
        {
            assert_eq!(three(value, names).map(|s| s.1), expected);
        }
    }

    #[test]
    fn draws_have_the_distributions_they_are_named_for() {
        let mut random = Random::new(5, 0);
        let n = 20_000;
        for a in [MUSCLE_SHAPE, WEIGHT_SHAPE] {
            let draws: Vec<f64> = (0..n).map(|_| beta(&mut random, a)).collect();
            assert!(draws.iter().all(|x| (0.0..=1.0).contains(x)));
            let mean = draws.iter().sum::<f64>() / f64::from(n);
            let variance = draws.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / f64::from(n);
            // Beta(a, a): mean ½, variance 1 / (4 (2a + 1)); five standard errors are below 0.013 and 0.005.
            assert!((mean - 0.5).abs() < 0.013 && (variance - 0.25 / (2.0 * a + 1.0)).abs() < 0.005);
        }
        let mut sums = [0.0; 3];
        for _ in 0..n {
            let shares = dirichlet(&mut random, ["a", "b", "c"]).map(|s| s.1);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            sums = std::array::from_fn(|i| sums[i] + shares[i] / f64::from(n));
        }
        // Five standard errors of a mean of uniform Dirichlet shares are 0.0083.
        assert!(sums.iter().all(|s| (s - 1.0 / 3.0).abs() < 0.0083), "{sums:?}");
    }

    #[test]
    fn only_the_scales_of_the_head_know_the_stature() {
        let scales = [
            "head-scale-depth-decr-incr|head",
            "head-scale-horiz-decr-incr|head",
            "head-scale-vert-decr-incr|head",
        ];
        for name in scales {
            let [shortest, tallest] = STATURE.map(|stature| with_stature(name, stature));
            assert!(shortest > 0.2 && (shortest + tallest).abs() < 1e-12, "{name}: {shortest} {tallest}");
        }
        for name in
            ["head-back-scale-depth-decr-incr|head", "neck-scale-vert-decr-incr|neck", "hand-scale|hands"]
        {
            assert_eq!(with_stature(name, STATURE[0]), 0.0, "{name}");
        }
    }

    #[test]
    fn sliders_vary_by_their_kind() {
        let of = |name: &str, group: &str| {
            spread(&Modifier { name: format!("{name}|{group}"), group: group.to_owned(), pairs: Vec::new() })
        };
        assert_eq!(of("head-fat-decr-incr", "head"), Some(Spread::Body(0.3)));
        assert_eq!(of("nose-hump-decr-incr", "nose"), Some(Spread::Face(0.7)));
        assert_eq!(of("measure-waist-circ", "measure"), Some(Spread::Body(0.25)));
        for left_out in ["torso-trans-in-out", "stomach-pregnant-decr-incr", "bulge-decr-incr"] {
            assert_eq!(of(left_out, "torso"), None, "{left_out}");
        }
    }

    #[test]
    fn medians_move_and_ends_stay() {
        for median in [0.3, 0.5, 0.7] {
            assert!((with_median(0.5, median) - median).abs() < 1e-12);
            assert_eq!([with_median(0.0, median), with_median(1.0, median)], [0.0, 1.0]);
        }
    }
}
