//! Draws random people: MakeHuman slider values that cover the paper's table of statistics ("statistics-anthro").
//!
//! Sex, age, muscle, weight, proportions and ethnicity are drawn over their whole range; stature is drawn
//! uniformly and the height slider solved for it; local sliders vary around small biases that bring the means
//! of the measures to the paper's ([`crate::biases`]); heads grow with stature as people's do, not as bodies.

use std::collections::BTreeMap;

use anthronet::measure::Sex;
use anthronet::random::Random;
use anthronet::skeleton::SidedJoint;
use glam::Vec3;

use crate::assets::{Assets, CROWN, HEELS, Modifier, Target};
use crate::{Error, Result};

/// Shortest and tallest stature drawn, metres: the paper's table.
pub const STATURE: [f64; 2] = [1.49, 1.991];

const BIASES: &str = include_str!("sampling_bias.json");

/// The distribution of a local slider.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spread {
    Uniform(f64),
    /// Standard deviation; truncated at twice it.
    Normal(f64),
}

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
    locals: Vec<(Modifier, f64, Spread)>,
}

/// Difference between left and right of a sided slider, standard deviation.
const ASYMMETRY: f64 = 0.03;
/// Our own slider, and the standard deviation of its sides' difference: no other slider lets the toes of two feet differ.
const TOE_LENGTH: &str = "toe-length";
const TOE_ASYMMETRY: f64 = 0.12;

/// How much the three scales of the head fall with stature, slider per metre. MakeHuman's height slider enlarges the
/// head with the body, by a fifth from the shortest to the tallest; heads of people hardly grow with stature (their
/// circumference by 9 cm a metre in ANSUR II).
const HEAD_WITH_STATURE: f64 = 1.0;

/// The committed biases: the centre of each local slider, by MakeHuman's name. [`crate::biases`] fits them.
///
/// # Errors
/// [`Error::Invalid`] when the file is not what it should be.
pub fn committed_biases() -> Result<BTreeMap<String, f64>> {
    serde_json::from_str(BIASES).map_err(|e| Error::Invalid(format!("sampling_bias.json: {e}")))
}

impl Sampler {
    /// Prepares the sliders; adds our own toe length to the targets, which MakeHuman has no slider for.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the biases name an unknown slider.
    pub fn new(assets: &mut Assets) -> Result<Self> {
        let toes = toe_length(assets)?;
        assets.targets.add_procedural(TOE_LENGTH, "feet", toes);
        let sampled = |m: &Modifier| spread(m).map(|spread| (m.clone(), 0.0, spread));
        let mut sampler = Self { locals: assets.targets.modifiers.iter().filter_map(sampled).collect() };
        sampler.set_biases(&committed_biases()?)?;
        Ok(sampler)
    }

    /// Replaces the biases of the sliders that are named; the others keep theirs.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a slider that is unknown or not sampled.
    pub fn set_biases(&mut self, biases: &BTreeMap<String, f64>) -> Result<()> {
        for (name, value) in biases {
            let local = self.locals.iter_mut().find(|local| local.0.name == *name);
            let unknown =
                || Error::Invalid(format!("sampling_bias.json: {name} is no slider that is sampled"));
            local.ok_or_else(unknown)?.1 = *value;
        }
        Ok(())
    }

    /// Draws the person with this number of this seed; the same pair gives the same person everywhere.
    pub fn draw(&self, assets: &Assets, seed: u64, number: u64) -> Person {
        let mut rng = Random::new(seed, number);
        let sex = if rng.uniform() < 0.5 { Sex::Female } else { Sex::Male };
        let age = rng.uniform();
        let ages = [("young", 1.0 - age), ("old", age)];
        let muscles = three(beta(&mut rng, 0.7), ["minmuscle", "averagemuscle", "maxmuscle"]);
        let weights = three(beta(&mut rng, 0.65), ["minweight", "averageweight", "maxweight"]);
        let proportion = rng.uniform() * 2.0 - 1.0;
        let cups = three(rng.uniform(), ["mincup", "averagecup", "maxcup"]);
        let firmnesses = three(rng.uniform(), ["minfirmness", "averagefirmness", "maxfirmness"]);
        let races = dirichlet(&mut rng, ["african", "asian", "caucasian"]);
        let stature = STATURE[0] + (STATURE[1] - STATURE[0]) * rng.uniform();

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
        for (modifier, bias, spread) in &self.locals {
            let value = bias
                + with_stature(&modifier.name, stature)
                + match *spread {
                    Spread::Uniform(half) => half * (2.0 * rng.uniform() - 1.0),
                    Spread::Normal(deviation) => deviation * rng.normal().clamp(-2.0, 2.0),
                };
            let asymmetry = if modifier.name.starts_with(TOE_LENGTH) { TOE_ASYMMETRY } else { ASYMMETRY };
            for [negative, positive] in &modifier.pairs {
                let sided = if modifier.pairs.len() > 1 { asymmetry * rng.normal() } else { 0.0 };
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
        "head" | "neck" => Spread::Uniform(0.12),
        "forehead" => Spread::Normal(0.12),
        "cheek" | "chin" | "ears" | "eyebrows" | "eyes" | "mouth" | "nose" => Spread::Normal(0.2),
        _ if name.starts_with("measure-") => Spread::Uniform(0.35),
        _ => Spread::Uniform(0.245),
    })
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

/// Beta(a, a) for a < 1 (Jöhnk 1964).
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
        for a in [0.65, 0.7] {
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
        assert_eq!(of("head-fat-decr-incr", "head"), Some(Spread::Uniform(0.12)));
        assert_eq!(of("nose-hump-decr-incr", "nose"), Some(Spread::Normal(0.2)));
        assert_eq!(of("measure-waist-circ", "measure"), Some(Spread::Uniform(0.35)));
        assert_eq!(of("upperarm-fat", "arms"), Some(Spread::Uniform(0.245)));
        for left_out in ["torso-trans-in-out", "stomach-pregnant-decr-incr", "bulge-decr-incr"] {
            assert_eq!(of(left_out, "torso"), None, "{left_out}");
        }
    }
}
