//! `anthronet contact-sheet`: many different people on one picture, for judging the model by eye.

use std::path::PathBuf;

use clap::Args;

use crate::backend::{self, Model, Random, Usual};
use crate::failure::{Failure, Result};
use crate::progress::bar;
use crate::render::{Image, LitFigure, Picture, Tile, View, draw_text, text_width};
use crate::request::{FillChoice, RequestArguments, SexChoice, check_ending};

/// Directions that the light is gathered from; fewer than for a single picture, as figures are small.
const QUALITY: usize = 128;
/// Pixels per metre: the same for everyone, so that heights compare.
const SCALE: f32 = 76.0;
/// Cell of one person, pixels; the tallest and widest of people fit.
const CELL: [usize; 2] = [384, 200];
/// Widths of the three views within a cell.
const VIEWS: [(View, usize); 3] = [(View::Front, 166), (View::Side, 52), (View::Back, 166)];
/// Height of the caption below the figures, pixels.
const CAPTION: usize = 26;
/// How far from the mean the shortest, tallest, thinnest and heaviest are asked for, in standard deviations.
const REACH: f64 = 1.8;
/// The stream of [`Random`] that the sheet is shuffled from.
const STREAM: u64 = 4;

/// Draw random people, both sexes, thin to heavy, short to tall, three views each, all at one scale.
#[derive(Args)]
#[command(after_help = "Example:\n  anthronet contact-sheet -o people.png --count 24 --seed 1")]
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
    let mut sheet = Image::new(columns * CELL[0], rows * CELL[1], [red, green, blue]);
    let bar = bar(people.len(), "people");
    for (i, request) in people.iter().enumerate() {
        let name = format!("person {}", i + 1);
        let in_person = |failure: Failure| Failure::failed(format!("{name}: {failure}"));
        let person = model.generate(&backend::request(request)?, false).map_err(in_person)?;
        // Skin tones from the middle of the scale outwards, so that neighbours differ.
        let tone = [5, 4, 7, 3, 6, 8][i % 6].to_string();
        let figure = LitFigure::new(person.figure(1, Some(&tone))?, QUALITY);
        let (x0, y0) = (i % columns * CELL[0], i / columns * CELL[1]);
        let mut x = x0;
        for (view, width) in VIEWS {
            let tile = Tile::at_scale(width, CELL[1] - CAPTION, view, SCALE, 15.0, 0.0);
            sheet.paste(&Picture::SHEET.draw(&figure, &tile), x, y0);
            x += width;
        }
        let summary = person.summary();
        let caption = format!("{}  {:.2} m  {:.0} kg", summary.sex, summary.height, summary.mass_kg);
        let left = x0 + (CELL[0] - text_width(&caption, 2).min(CELL[0])) / 2;
        draw_text(&mut sheet, left, y0 + CELL[1] - CAPTION + 4, 2, [70, 72, 76], &caption);
        bar.inc(1);
    }
    bar.finish_and_clear();
    backend::write(&arguments.output, &sheet.to_png()?)
}

/// A Latin hypercube over height and waist for each sex: every stratum of either occurs once. The waist is drawn
/// around what is usual for the height.
fn people(count: usize, seed: u64, usual: impl Fn(SexChoice) -> Usual) -> Vec<RequestArguments> {
    let mut random = Random::new(seed, STREAM);
    let mut targets: [Vec<(f64, f64)>; 2] = [count.div_ceil(2), count / 2].map(|n| {
        let mut columns = [(); 2].map(|()| {
            let mut strata: Vec<f64> =
                (0..n).map(|i| REACH * (2.0 * (i as f64 + random.uniform()) / n as f64 - 1.0)).collect();
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
            let sex = [SexChoice::Female, SexChoice::Male][i % 2];
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
                fill: Some(FillChoice::Sample),
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
        for sex in [SexChoice::Female, SexChoice::Male] {
            for k in 0..2 {
                let mut strata: Vec<i64> = sheet
                    .iter()
                    .filter(|p| p.sex == Some(sex))
                    .map(|p| ((p.measures[k].1 / REACH + 1.0) * 6.0).floor() as i64)
                    .collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..12).collect::<Vec<_>>());
            }
        }
        let values = |seed| people(5, seed, usual).iter().map(|p| p.measures[0].1).collect::<Vec<_>>();
        assert_eq!(values(3), values(3));
        assert_ne!(values(3), values(4));
    }

    #[test]
    fn the_views_fill_the_cell() {
        assert_eq!(VIEWS.iter().map(|(_, width)| width).sum::<usize>(), CELL[0]);
    }
}
