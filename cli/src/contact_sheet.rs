//! `anthronet contact-sheet`: many different people on one picture, for judging the model by eye.

use std::path::PathBuf;

use anthronet::condition::Fill;
use anthronet::measure::Sex;
use clap::Args;
use glam::Vec3;

use crate::backend::{self, Model, Person, Random, Usual};
use crate::failure::{Failure, Result};
use crate::progress::bar;
use crate::render::{Image, LitFigure, Picture, Tile, View, draw_text, text_width};
use crate::request::{RequestArguments, check_ending};

/// Directions that the light is gathered from; fewer than for a single picture, as figures are small.
const QUALITY: usize = 128;
/// Pixels per metre: the same for everyone, so that heights compare.
const SCALE: f32 = 180.0;
/// Widths of the three views of a person, pixels; the widest of people fit.
const VIEWS: [(View, usize); 3] = [(View::Front, 394), (View::Side, 124), (View::Back, 394)];
/// Height of the views; the tallest of people fit.
const FIGURE: usize = 404;
/// What close-ups show: a joint, how far from it (metres, along the model's axes) the middle of the tile lies, from
/// where and how much of it, metres.
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
/// How far from the mean, in standard deviations, the shortest and tallest are asked for, and the thinnest and heaviest
/// for their height: waists reach far up and not far down.
const REACH: [[f64; 2]; 2] = [[-1.8, 1.8], [-1.7, 3.3]];
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

    /// How many people, 1 to 400.
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u16).range(1..=400))]
    count: u16,

    /// Another seed, other people.
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Show faces, necks, armpits, hands and hips instead of whole bodies.
    #[arg(long)]
    close: bool,

    /// People beside each other, 1 to 12.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=12))]
    columns: u16,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_ending("-o", &arguments.output, &["png"])?;
    let model = Model::open()?;
    let people = people(usize::from(arguments.count), arguments.seed, |sex| model.usual(sex));
    let columns = usize::from(arguments.columns).min(people.len());
    let rows = people.len().div_ceil(columns);
    let [red, green, blue] = Picture::SHEET.backdrop[0];
    let [width, height] = cell(arguments.close);
    let mut sheet = Image::new(columns * width, rows * height, [red, green, blue]);
    let bar = bar(people.len(), "people");
    for (i, request) in people.iter().enumerate() {
        let name = format!("person {}", i + 1);
        let in_person = |failure: Failure| Failure::failed(format!("{name}: {failure}"));
        let person = model.generate(&backend::request(request)?, request).map_err(in_person)?;
        // Skin tones from the middle of the scale outwards, so that neighbours differ.
        let tone = [5, 4, 7, 3, 6, 8][i % 6].to_string();
        let lod = if arguments.close { 0 } else { 1 };
        let figure = LitFigure::new(person.figure(lod, Some(&tone))?, QUALITY);
        let (x0, y0) = (i % columns * width, i / columns * height);
        let tiles = if arguments.close { close_ups(&person) } else { whole_body() };
        let mut x = x0;
        for (tile, width) in tiles {
            sheet.paste(&Picture::SHEET.draw(&figure, &tile), x, y0);
            x += width;
        }
        let summary = person.summary();
        let caption = format!("{}  {:.2} m  {:.0} kg", summary.sex, summary.height, summary.mass_kg);
        let left = x0 + (width - text_width(&caption, TEXT).min(width)) / 2;
        draw_text(&mut sheet, left, y0 + height - CAPTION + 4, TEXT, [70, 72, 76], &caption);
        bar.inc(1);
    }
    bar.finish_and_clear();
    backend::write(&arguments.output, &sheet.to_small_png()?)
}

/// Width and height of what one person takes, pixels.
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

fn close_ups(person: &Person) -> Vec<(Tile, usize)> {
    CLOSE
        .map(|(joint, offset, view, span)| {
            let place = person.joint(joint).unwrap_or_default() + Vec3::from(offset);
            (Tile::close_up(CLOSE_SIZE, view, place, span), CLOSE_SIZE)
        })
        .into()
}

/// A Latin hypercube over height and waist for each sex: every stratum of either occurs once. The waist is drawn
/// around what is usual for the height.
fn people(count: usize, seed: u64, usual: impl Fn(Sex) -> Usual) -> Vec<RequestArguments> {
    let mut random = Random::new(seed, STREAM);
    let mut targets: [Vec<(f64, f64)>; 2] = [count.div_ceil(2), count / 2].map(|n| {
        let mut columns = REACH.map(|[low, high]| {
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
            let sex = [Sex::Female, Sex::Male][i % 2];
            let (h, w) = targets[i % 2].pop().unwrap_or_default();
            let usual = usual(sex);
            let rho = usual.correlation;
            let w = rho * h + (1.0 - rho * rho).max(0.0).sqrt() * w;
            RequestArguments {
                sex: Some(sex),
                measures: vec![
                    ("height".to_owned(), usual.height.0 + h * usual.height.1),
                    ("waist_circumference".to_owned(), usual.waist.0 + w * usual.waist.1),
                ],
                seed: Some(seed.wrapping_mul(10_007).wrapping_add(i as u64 + 1).max(1)),
                fill: Some(Fill::Sample),
                nearest: true,
                ..RequestArguments::default()
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_occurs_once_and_seeds_differ() {
        let usual = |_| Usual { height: (0.0, 1.0), waist: (0.0, 1.0), correlation: 0.0 };
        let sheet = people(24, 1, usual);
        assert_eq!(sheet.len(), 24);
        for sex in [Sex::Female, Sex::Male] {
            for (k, [low, high]) in REACH.into_iter().enumerate() {
                let mut strata: Vec<i64> = sheet
                    .iter()
                    .filter(|p| p.sex == Some(sex))
                    .map(|p| (12.0 * (p.measures[k].1 - low) / (high - low)).floor() as i64)
                    .collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..12).collect::<Vec<_>>());
            }
        }
        let values = |seed| people(5, seed, usual).iter().map(|p| p.measures[0].1).collect::<Vec<_>>();
        assert_eq!(values(3), values(3));
        assert_ne!(values(3), values(4));
    }
}
