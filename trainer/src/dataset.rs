//! The data set: two hundred thousand bodies as coefficients, with their measures.

use std::path::Path;

use anthronet::measure::{Definitions, MEASURE_COUNT, Sex};
use faer::Mat;
use rayon::prelude::*;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use crate::basis::{Basis, COMPONENTS, flatten};
use crate::corpus::{Corpus, DATA_VERSION, Gauge, Plausible, SEED, Split};
use crate::sampling::centres_hash;
use crate::{Error, Result};

/// Number of drawn bodies; implausible ones among them are left out.
pub const DRAWN: u64 = 240_000;
const BATCH: u64 = 480;

/// Bodies of one split, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies {
    /// Numbers in the corpus.
    pub numbers: Vec<u64>,
    /// Coefficients, `COMPONENTS` per body, metres.
    pub coefficients: Vec<f32>,
    /// Measures, `MEASURE_COUNT` per body, metres.
    pub measures: Vec<f32>,
    /// 0 female, 1 male.
    pub sex: Vec<u8>,
}

/// Basis and bodies.
pub struct Dataset {
    /// The shape space.
    pub basis: Basis,
    /// Bodies of the training split.
    pub train: Bodies,
    /// Bodies of the validation split.
    pub validation: Bodies,
    /// Bodies of the held-out split.
    pub held_out: Bodies,
    /// Number of drawn bodies that were implausible.
    pub rejected: usize,
}

/// The numbers of the first `count` bodies of a split, those of the data set, without making it.
///
/// # Errors
/// As [`Plausible::new`].
pub fn first_of(corpus: &Corpus, definitions: &Definitions, split: Split, count: usize) -> Result<Vec<u64>> {
    let plausible = Plausible::new()?;
    let gauge = Gauge::new(definitions, &corpus.subdivision);
    let drawn: Vec<u64> = (0..DRAWN).filter(|&n| Split::of(n) == split).collect();
    let mut numbers = Vec::new();
    for batch in drawn.chunks(BATCH as usize) {
        if numbers.len() >= count {
            break;
        }
        let people = batch.par_iter().filter(|&&n| plausible.holds(&gauge.read(&corpus.specimen(n).points)));
        numbers.extend(people.copied().collect::<Vec<u64>>());
    }
    numbers.truncate(count);
    Ok(numbers)
}

impl Dataset {
    /// Reads the data set from the cache, or makes and caches it.
    ///
    /// # Errors
    /// When the corpus or the cache fails.
    pub fn load_or_make(
        corpus: &Corpus,
        definitions: &Definitions,
        cache: &Path,
        progress: &(dyn Fn(&str, u64, u64) + Sync),
    ) -> Result<Self> {
        let path = cache.join(format!(
            "dataset-v{DATA_VERSION}-{SEED}-{DRAWN}-{COMPONENTS}-{}-{}.safetensors",
            &definitions.hash()[..12],
            &centres_hash()[..12]
        ));
        if path.exists() {
            return Self::read(&path);
        }
        let basis = Basis::fit(corpus, &|what| progress(what, 0, 0))?;
        let mut dataset = Self::draw(corpus, definitions, basis, progress)?;
        dataset.rejected = DRAWN as usize - dataset.count();
        dataset.write(&path)?;
        Ok(dataset)
    }

    fn count(&self) -> usize {
        [&self.train, &self.validation, &self.held_out].iter().map(|b| b.numbers.len()).sum()
    }

    fn draw(
        corpus: &Corpus,
        definitions: &Definitions,
        basis: Basis,
        progress: &(dyn Fn(&str, u64, u64) + Sync),
    ) -> Result<Self> {
        let plausible = Plausible::new()?;
        let gauge = Gauge::new(definitions, &corpus.subdivision);
        let mut dataset = Self {
            basis,
            train: Bodies::default(),
            validation: Bodies::default(),
            held_out: Bodies::default(),
            rejected: 0,
        };
        for first in (0..DRAWN).step_by(BATCH as usize) {
            progress("measuring bodies", first, DRAWN);
            let numbers: Vec<u64> = (first..(first + BATCH).min(DRAWN)).collect();
            let specimens: Vec<_> = numbers
                .par_iter()
                .filter_map(|&n| {
                    let specimen = corpus.specimen(n);
                    let measures = gauge.read(&specimen.points);
                    plausible.holds(&measures).then(|| (n, specimen.sex, measures, flatten(&specimen.points)))
                })
                .collect();
            let points: Vec<Vec<f32>> = specimens.iter().map(|s| s.3.clone()).collect();
            let coefficients = dataset.basis.project(&points);
            for (j, (number, sex, measures, _)) in specimens.iter().enumerate() {
                let bodies = match Split::of(*number) {
                    Split::Train => &mut dataset.train,
                    Split::Validation => &mut dataset.validation,
                    Split::HeldOut => &mut dataset.held_out,
                };
                bodies.numbers.push(*number);
                bodies.coefficients.extend(coefficients.col(j).iter());
                bodies.measures.extend(measures.map(|m| m as f32));
                bodies.sex.push(sex.index() as u8);
            }
        }
        progress("measuring bodies", DRAWN, DRAWN);
        Ok(dataset)
    }

    fn write(&self, path: &Path) -> Result<()> {
        let rows = self.basis.mean.len();
        let flat: Vec<f32> = (0..rows)
            .flat_map(|i| (0..COMPONENTS).map(move |j| (i, j)))
            .map(|ij| self.basis.rows[ij])
            .collect();
        let mut tensors: Vec<(String, Dtype, Vec<usize>, &[u8])> = vec![
            ("basis.mean".into(), Dtype::F32, vec![rows], bytemuck::cast_slice(&self.basis.mean)),
            ("basis.rows".into(), Dtype::F32, vec![rows, COMPONENTS], bytemuck::cast_slice(&flat)),
            ("basis.std".into(), Dtype::F64, vec![COMPONENTS], bytemuck::cast_slice(&self.basis.std)),
        ];
        for (name, b) in
            [("train", &self.train), ("validation", &self.validation), ("held_out", &self.held_out)]
        {
            let n = b.numbers.len();
            tensors.push((format!("{name}.numbers"), Dtype::U64, vec![n], bytemuck::cast_slice(&b.numbers)));
            tensors.push((
                format!("{name}.coefficients"),
                Dtype::F32,
                vec![n, COMPONENTS],
                bytemuck::cast_slice(&b.coefficients),
            ));
            tensors.push((
                format!("{name}.measures"),
                Dtype::F32,
                vec![n, MEASURE_COUNT],
                bytemuck::cast_slice(&b.measures),
            ));
            tensors.push((format!("{name}.sex"), Dtype::U8, vec![n], &b.sex));
        }
        let views = tensors
            .iter()
            .map(|(name, dtype, shape, data)| {
                TensorView::new(*dtype, shape.clone(), data)
                    .map(|v| (name.clone(), v))
                    .map_err(|e| Error::Invalid(format!("data set: {name}: {e}")))
            })
            .collect::<Result<Vec<_>>>()?;
        let partial = path.with_extension("partial");
        safetensors::serialize_to_file(views, None, &partial)
            .map_err(|e| Error::Invalid(format!("{}: {e}", partial.display())))?;
        std::fs::rename(&partial, path).map_err(Error::io(path))
    }

    fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(Error::io(path))?;
        let fail = |e: &dyn std::fmt::Display| {
            Error::Invalid(format!("{}: {e}: delete the file to make it again", path.display()))
        };
        let file = SafeTensors::deserialize(&bytes).map_err(|e| fail(&e))?;
        let get = |name: &str| file.tensor(name).map_err(|e| fail(&e));
        let rows: Vec<f32> = bytemuck::pod_collect_to_vec(get("basis.rows")?.data());
        let mean: Vec<f32> = bytemuck::pod_collect_to_vec(get("basis.mean")?.data());
        if rows.len() != mean.len() * COMPONENTS {
            return Err(fail(&"basis has the wrong size"));
        }
        let split = |name: &str| -> Result<Bodies> {
            Ok(Bodies {
                numbers: bytemuck::pod_collect_to_vec(get(&format!("{name}.numbers"))?.data()),
                coefficients: bytemuck::pod_collect_to_vec(get(&format!("{name}.coefficients"))?.data()),
                measures: bytemuck::pod_collect_to_vec(get(&format!("{name}.measures"))?.data()),
                sex: get(&format!("{name}.sex"))?.data().to_vec(),
            })
        };
        let mut dataset = Self {
            basis: Basis {
                rows: Mat::from_fn(mean.len(), COMPONENTS, |i, j| rows[i * COMPONENTS + j]),
                mean,
                std: bytemuck::pod_collect_to_vec(get("basis.std")?.data()),
            },
            train: split("train")?,
            validation: split("validation")?,
            held_out: split("held_out")?,
            rejected: 0,
        };
        dataset.rejected = DRAWN as usize - dataset.count();
        Ok(dataset)
    }
}

impl Bodies {
    /// Sex of a body.
    pub fn sex(&self, i: usize) -> Sex {
        if self.sex[i] == 0 { Sex::Female } else { Sex::Male }
    }

    /// Measures of a body, metres.
    pub fn measures(&self, i: usize) -> &[f32] {
        &self.measures[i * MEASURE_COUNT..(i + 1) * MEASURE_COUNT]
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bodies(numbers: &[u64]) -> Bodies {
        let n = numbers.len();
        Bodies {
            numbers: numbers.to_vec(),
            coefficients: (0..n * COMPONENTS).map(|i| i as f32 * 1e-3).collect(),
            measures: (0..n * MEASURE_COUNT).map(|i| i as f32 * 1e-2).collect(),
            sex: numbers.iter().map(|n| (n % 2) as u8).collect(),
        }
    }

    #[test]
    fn what_was_written_is_read_and_damage_is_named() {
        let basis = Basis {
            mean: vec![0.5; 6],
            rows: Mat::from_fn(6, COMPONENTS, |i, j| (i * COMPONENTS + j) as f32),
            std: vec![0.25; COMPONENTS],
        };
        let written = Dataset {
            basis,
            train: bodies(&[0, 1, 2, 3]),
            validation: bodies(&[7]),
            held_out: bodies(&[13, 33]),
            rejected: 0,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dataset.safetensors");
        written.write(&path).unwrap();
        let read = Dataset::read(&path).unwrap();
        assert_eq!(read.basis.mean, written.basis.mean);
        assert_eq!(read.basis.std, written.basis.std);
        assert!(
            (0..6).all(|i| (0..COMPONENTS).all(|j| read.basis.rows[(i, j)] == written.basis.rows[(i, j)]))
        );
        assert_eq!(
            (&read.train, &read.validation, &read.held_out),
            (&written.train, &written.validation, &written.held_out)
        );
        assert_eq!(read.rejected, DRAWN as usize - 7);
        assert_eq!((read.held_out.len(), read.held_out.sex(0)), (2, Sex::Male));
        assert_eq!(read.train.measures(1), &written.train.measures[MEASURE_COUNT..2 * MEASURE_COUNT]);

        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let Err(error) = Dataset::read(&path) else { panic!("half a data set was read") };
        assert!(error.to_string().contains("delete the file"), "{error}");
    }
}
