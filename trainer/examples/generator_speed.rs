//! Trains a generator on synthetic bodies: for the speed of training and for trying out its options.
//!
//! `cargo run --release -p anthronet-trainer --example generator_speed -- [key=value]…`, where the keys are those
//! of the configuration (JSON values) and `count`, `epochs`, `batch`, `rate`, `warmup`, `freeze`, `threads`,
//! `paper`, and `data` (a data set file of the trainer in place of the synthetic bodies).

use std::collections::BTreeMap;
use std::time::Instant;

use anthronet::measure::MEASURE_COUNT;
use anthronet::network::config::GeneratorConfig;
use anthronet_trainer::generator::{ShapeStatistics, TrainingOptions, TrainingSet, synthetic_set, train};
use safetensors::SafeTensors;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut options = TrainingOptions { epochs: 3, quiet: true, ..TrainingOptions::default() };
    let mut count = 20_000;
    let mut data = None;
    let mut json: BTreeMap<String, serde_json::Value> = BTreeMap::new();
    for argument in std::env::args().skip(1) {
        let (key, value) = argument.split_once('=').ok_or("expected key=value")?;
        match key {
            "count" => count = value.parse()?,
            "data" => data = Some(std::fs::read(value)?),
            "epochs" => options.epochs = value.parse()?,
            "batch" => options.batch = value.parse()?,
            "rate" => options.learning_rate = value.parse()?,
            "warmup" => options.warmup = value.parse()?,
            "freeze" => options.freeze_norm = value.parse()?,
            "threads" => options.threads = value.parse()?,
            "seed" => options.seed = value.parse()?,
            _ => drop(json.insert(key.into(), serde_json::from_str(value)?)),
        }
    }
    let config: GeneratorConfig = if json.remove("paper").is_some() {
        GeneratorConfig::paper()
    } else {
        serde_json::from_value(serde_json::to_value(json)?)?
    };
    let k = config.coefficients;
    let statistics = ShapeStatistics { vertex_count: 13_380, coefficient_std: vec![1.0; k], laplacian: None };
    let (training, validation) = match data {
        Some(bytes) => {
            let file = SafeTensors::deserialize(&bytes)?;
            let (training, validation) =
                (read(&file, "train", k, count)?, read(&file, "validation", k, 2000)?);
            count = training.count;
            (training, validation)
        }
        None => (synthetic_set(count, k, 1), synthetic_set(2000, k, 2)),
    };
    options.out_dir = std::env::temp_dir().join(format!("generator_speed_{}", std::process::id()));
    let start = Instant::now();
    let out = train(&training, &validation, &statistics, &config, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    std::fs::remove_dir_all(&options.out_dir)?;
    for m in &out.history {
        let (rms, z0, sampled) = (m.rms_mm, m.rms_z0_mm, m.rms_sampled_mm);
        println!("{:4}  rms {rms:.3}  z0 {z0:.3}  sampled {sampled:.3}  kl {:.1}", m.epoch, m.divergence);
    }
    println!("latent std {:.2?}", out.latent_std);
    println!("{seconds:.1} s, {:.0} bodies/s", (count * options.epochs) as f64 / seconds);
    Ok(())
}

/// At most `most` bodies of one split of a data set.
fn read(
    file: &SafeTensors<'_>,
    split: &str,
    k: usize,
    most: usize,
) -> Result<TrainingSet, Box<dyn std::error::Error>> {
    let get = |name: &str| file.tensor(&format!("{split}.{name}"));
    let mut sex = get("sex")?.data().to_vec();
    sex.truncate(most);
    let count = sex.len();
    let mut coefficients: Vec<f32> = bytemuck::pod_collect_to_vec(get("coefficients")?.data());
    let mut measures: Vec<f32> = bytemuck::pod_collect_to_vec(get("measures")?.data());
    coefficients.truncate(count * k);
    measures.truncate(count * MEASURE_COUNT);
    Ok(TrainingSet { count, k, coefficients, measures, sex })
}
