//! `anthronet contact-sheet`: many different people in one picture, to judge the model by eye.

use std::path::PathBuf;

use anthronet::Body;
use anthronet::condition::{Fill, Population, Request, SexPrior};
use anthronet::format::write_atomic;
use anthronet::measure::{MeasureId, Sex};
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::random::Random;
use anthronet::scene::{Scene, SceneOptions, SkinTone};
use clap::Args;
use glam::Vec3;

use crate::failure::{Failure, Result};
use crate::figure;
use crate::file_set::FileSet;
use crate::files::check_extension;
use crate::render::{Image, LitFigure, Picture, Tile, View, draw_text, text_width};
use crate::terminal::bar;

/// Number of directions that light is gathered from; fewer than for a single picture, as figures are small.
const QUALITY: usize = 128;
/// Pixels per metre: the same for everyone, so that heights can be compared.
const SCALE: f32 = 180.0;
/// Widths of the three views of a person, pixels; the widest of people fit.
const VIEWS: [(View, usize); 3] = [(View::Front, 394), (View::Side, 124), (View::Back, 394)];
/// Height of the views; the tallest of people fit.
const FIGURE: usize = 404;
/// Close-ups: a joint, the offset of the tile's centre from it (metres, along the model's axes), the view, and the side
/// of the square shown, metres.
const CLOSE: [(&str, [f32; 3], View, f32); 6] = [
    ("head", [0.0, 0.06, 0.0], View::Front, 0.34),
    ("head", [0.0, 0.06, 0.0], View::Side, 0.34),
    ("neck_01", [0.0, -0.02, 0.0], View::ThreeQuarter, 0.46),
    ("upperarm_l", [0.0, -0.06, 0.0], View::Front, 0.36),
    ("middle_01_l", [0.01, 0.0, 0.01], View::Above, 0.28),
    ("pelvis", [0.0, -0.08, 0.0], View::Front, 0.52),
];
/// Side of a close-up, pixels.
const CLOSE_SIZE: usize = 200;
/// Height of the caption below the figures, pixels, and of a dot of its letters.
const CAPTION: usize = 32;
const TEXT: usize = 3;
/// Range of height, and of waist given the height, in standard deviations from the mean: waists vary more upwards than
/// downwards.
const RANGES: [[f64; 2]; 2] = [[-1.8, 1.8], [-1.7, 3.3]];
/// Skin tones of the people in turn: from the middle of the scale outwards, so that neighbours differ.
const TONES: [u8; 6] = [5, 4, 7, 3, 6, 8];
/// The stream of [`Random`] that the sheet is shuffled from.
const STREAM: u64 = 4;

/// Draw random people, both sexes, thin to heavy, short to tall, three views each, all at one scale.
#[derive(Args)]
#[command(after_help = "Examples:\n  anthronet contact-sheet -o people.png --count 24 --seed 1\n  \
                        anthronet contact-sheet -o closeups.png --close --count 12 --columns 2")]
pub(crate) struct Arguments {
    /// The picture to write, a .png.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: PathBuf,

    /// Number of people, 1 to 400.
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u16).range(1..=400))]
    count: u16,

    /// Seed of the random people.
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Show faces, necks, armpits, hands and hips instead of whole bodies.
    #[arg(long)]
    close: bool,

    /// Number of columns, 1 to 12.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=12))]
    columns: u16,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("-o", &arguments.output, &["png"])?;
    FileSet::default().model().writes("-o", Some(&arguments.output)).check()?;
    let model = Model::from_environment()?;
    let typical = Sex::ALL.map(|sex| Typical::of(model.prior(Population::default()).of(sex)));
    let people = people(usize::from(arguments.count), arguments.seed, &typical);
    let columns = usize::from(arguments.columns).min(people.len());
    let rows = people.len().div_ceil(columns);
    let [red, green, blue] = Picture::SHEET.backdrop[0];
    let [width, height] = cell(arguments.close);
    let mut sheet = Image::new(columns * width, rows * height, [red, green, blue]);
    let bar = bar(people.len(), "people");
    for (i, request) in people.iter().enumerate() {
        let body = model
            .generate(request)
            .map_err(|e| Failure::Input { input: format!("person {}", i + 1), source: Box::new(e) })?;
        let options = SceneOptions {
            lod: if arguments.close { Lod::Lod0 } else { Lod::Lod1 },
            skin_tone: SkinTone::monk(TONES[i % TONES.len()]).unwrap_or_default(),
            ..SceneOptions::default()
        };
        let figure = figure::from_scene(&Scene::from_body(&body, &options)?)?;
        let figure = LitFigure::new(figure, QUALITY);
        let (x0, y0) = (i % columns * width, i / columns * height);
        let tiles = if arguments.close { close_ups(&body) } else { whole_body() };
        let mut x = x0;
        for (tile, width) in tiles {
            sheet.paste(&Picture::SHEET.draw(&figure, &tile), x, y0);
            x += width;
        }
        let report = body.report();
        let stature = report.measures[MeasureId::HEIGHT.index()].obtained;
        let caption = format!("{}  {stature:.2} m  {:.0} kg", report.sex, report.mass_kg);
        let left = x0 + (width - text_width(&caption, TEXT).min(width)) / 2;
        draw_text(&mut sheet, left, y0 + height - CAPTION + 4, TEXT, [70, 72, 76], &caption);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(write_atomic(&arguments.output, &sheet.to_small_png()?)?)
}

/// Width and height of the cell of one person, pixels.
fn cell(close: bool) -> [usize; 2] {
    match close {
        true => [CLOSE.len() * CLOSE_SIZE, CLOSE_SIZE + CAPTION],
        false => [VIEWS.iter().map(|(_, width)| width).sum(), FIGURE + CAPTION],
    }
}

/// The tiles of one person with their widths.
fn whole_body() -> Vec<(Tile, usize)> {
    VIEWS.map(|(view, width)| (Tile::at_scale(width, FIGURE, view, SCALE, 15.0, 0.0), width)).into()
}

fn close_ups(body: &Body) -> Vec<(Tile, usize)> {
    let place = |name: &str| {
        let skeleton = body.skeleton();
        skeleton.find(name).map_or(Vec3::ZERO, |joint| skeleton.bind()[joint].translation.into())
    };
    CLOSE
        .map(|(joint, offset, view, span)| {
            (Tile::close_up(CLOSE_SIZE, view, place(joint) + Vec3::from(offset), span), CLOSE_SIZE)
        })
        .into()
}

/// Mean and standard deviation (metres) of two measures of one sex, and their correlation.
#[derive(Clone, Copy)]
struct Typical {
    height: (f64, f64),
    waist: (f64, f64),
    correlation: f64,
}

impl Typical {
    fn of(prior: &SexPrior) -> Self {
        let [h, w] = [MeasureId::HEIGHT, MeasureId::WAIST].map(MeasureId::index);
        let mean = prior.mean();
        let covariance = |a: usize, b: usize| prior.covariance()[a * mean.len() + b];
        let (sh, sw) = (covariance(h, h).sqrt(), covariance(w, w).sqrt());
        let correlation = covariance(h, w) / (sh * sw).max(1e-12);
        Self { height: (mean[h], sh), waist: (mean[w], sw), correlation }
    }
}

/// A Latin hypercube over height and waist for each sex: every stratum of either occurs once. The waist is drawn
/// around its mean given the height.
fn people(count: usize, seed: u64, typical: &[Typical; 2]) -> Vec<Request> {
    let mut random = Random::new(seed, STREAM);
    let mut targets: [Vec<(f64, f64)>; 2] = [count.div_ceil(2), count / 2].map(|n| {
        let mut columns = RANGES.map(|[low, high]| {
            let mut strata: Vec<f64> =
                (0..n).map(|i| low + (high - low) * (i as f64 + random.uniform()) / n as f64).collect();
            for i in (1..n).rev() {
                strata.swap(i, (random.uniform() * (i + 1) as f64) as usize);
            }
            strata
        });
        let [heights, waists] = &mut columns;
        heights.drain(..).zip(waists.drain(..)).collect()
    });
    (0..count)
        .map(|i| {
            let sex = Sex::ALL[i % 2];
            let (h, w) = targets[i % 2].pop().unwrap_or_default();
            let Typical { height, waist, correlation: rho } = typical[sex.index()];
            let w = rho * h + (1.0 - rho * rho).max(0.0).sqrt() * w;
            let mut request = Request {
                sex: Some(sex),
                seed: seed.wrapping_mul(10_007).wrapping_add(i as u64 + 1).max(1),
                fill: Fill::Sample,
                nearest: true,
                ..Request::default()
            };
            request.measures[MeasureId::HEIGHT.index()] = Some(height.0 + h * height.1);
            request.measures[MeasureId::WAIST.index()] = Some(waist.0 + w * waist.1);
            request
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use anthronet::condition::QUANTILE_COUNT;
    use anthronet::measure::MEASURE_COUNT;

    use super::*;

    #[test]
    fn every_stratum_occurs_once_and_seeds_differ() {
        let typical = [Typical { height: (0.0, 1.0), waist: (0.0, 1.0), correlation: 0.0 }; 2];
        let sheet = people(24, 1, &typical);
        assert_eq!(sheet.len(), 24);
        for sex in Sex::ALL {
            for (id, [low, high]) in [MeasureId::HEIGHT, MeasureId::WAIST].into_iter().zip(RANGES) {
                let mut strata: Vec<i64> = sheet
                    .iter()
                    .filter(|p| p.sex == Some(sex))
                    .filter_map(|p| p.measures[id.index()])
                    .map(|value| (12.0 * (value - low) / (high - low)).floor() as i64)
                    .collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..12).collect::<Vec<_>>());
            }
        }
        let values = |seed| people(5, seed, &typical).iter().map(|p| p.measures).collect::<Vec<_>>();
        assert_eq!(values(3), values(3));
        assert_ne!(values(3), values(4));
    }

    #[test]
    fn typical_reads_the_covariance() {
        let count = MEASURE_COUNT;
        let [h, w] = [MeasureId::HEIGHT, MeasureId::WAIST].map(MeasureId::index);
        let mut mean = vec![1.0; count];
        let mut covariance: Vec<f64> = vec![0.0; count * count];
        for i in 0..count {
            covariance[i * count + i] = 0.01;
        }
        (mean[h], mean[w]) = (1.7, 0.8);
        covariance[w * count + w] = 0.04;
        (covariance[h * count + w], covariance[w * count + h]) = (0.01, 0.01);
        let quantiles = vec![0.0; count * QUANTILE_COUNT];
        let typical = Typical::of(&SexPrior::new(&mean, &covariance, &quantiles).unwrap());
        assert_eq!((typical.height.0, typical.waist.0), (1.7, 0.8));
        assert!((typical.height.1 - 0.1).abs() < 1e-12 && (typical.waist.1 - 0.2).abs() < 1e-12);
        assert!((typical.correlation - 0.5).abs() < 1e-12);
    }
}
