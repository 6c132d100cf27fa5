//! Tests of the whole training on small synthetic data.

use anthronet::measure::{MEASURE_COUNT, Sex};
use anthronet::network::config::{CONDITION_COUNT, GeneratorConfig};
use anthronet::network::{Decoder, Encoder};

use super::data::Frame;
use super::export::export;
use super::network::{Network, Norm};
use super::*;

const K: usize = 16;

fn sets() -> (TrainingSet, TrainingSet, ShapeStatistics) {
    let statistics = ShapeStatistics { vertex_count: 40, coefficient_std: vec![1.0; K], laplacian: None };
    (synthetic_set(1200, K, 1), synthetic_set(200, K, 2), statistics)
}

fn config(paper: bool) -> GeneratorConfig {
    let base = if paper { GeneratorConfig::paper() } else { GeneratorConfig::default() };
    GeneratorConfig { coefficients: K, width: 1, ..base }
}

fn options(folder: &tempfile::TempDir, epochs: usize) -> TrainingOptions {
    TrainingOptions {
        out_dir: folder.path().into(),
        epochs,
        threads: 1,
        quiet: true,
        batch: 64,
        ..TrainingOptions::default()
    }
}

#[test]
fn learns_with_and_without_linear_paths() {
    let (training, validation, statistics) = sets();
    for paper in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let out = train(&training, &validation, &statistics, &config(paper), &options(&folder, 12)).unwrap();
        let m = &out.metrics;
        // The mesh says more than the measures, and the network learned to say it.
        assert!(m.rms_mm < 0.7 * m.rms_z0_mm, "{m:?}");
        assert!(out.history.first().unwrap().rms_mm > m.rms_mm, "{:?}", out.history);
        assert_eq!(out.latent_std.len(), 10);
    }
}

#[test]
fn a_resumed_run_has_the_same_bits() {
    let (training, validation, mut statistics) = sets();
    let mut matrix = vec![0.0; K * K];
    (0..K).for_each(|i| matrix[i * K + i] = 1e-3);
    statistics.laplacian = Some(QuadraticForm { matrix, vector: vec![0.01; K], constant: 0.1 });
    let config = GeneratorConfig { gamma: 1e-4, ..config(false) };
    let go =
        |options: &TrainingOptions| train(&training, &validation, &statistics, &config, options).unwrap();
    let (whole, parts) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let expected = go(&options(&whole, 4));
    for stop_after in [Some(1), Some(3), None] {
        let options = TrainingOptions { stop_after, resume: true, threads: 2, ..options(&parts, 4) };
        let resumed = go(&options);
        assert_eq!(resumed.tensors == expected.tensors, stop_after.is_none());
    }
    // Another seed is another run.
    let other = TrainingOptions { seed: 2, resume: true, ..options(&parts, 4) };
    let message = train(&training, &validation, &statistics, &config, &other).unwrap_err().to_string();
    assert!(message.contains("another") || message.contains("other data"), "{message}");
}

#[test]
fn the_exported_network_is_the_trained_one() {
    let (training, validation, statistics) = sets();
    for paper in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let config = config(paper);
        train(&training, &validation, &statistics, &config, &options(&folder, 2)).unwrap();
        let frame = Frame::fit(&training, &config).unwrap();
        let mut network = Network::new(&config, &frame, 1).unwrap();
        let identity =
            crate::checkpoint::Identity::of(&training, &statistics, &config, &options(&folder, 2)).unwrap();
        let path = folder.path().join("generator.checkpoint.safetensors");
        crate::checkpoint::Checkpoint::read(&path, &identity).unwrap().restore(&mut network).unwrap();
        let tensors = export(&network, &frame, &config).unwrap();
        let decoder = Decoder::from_tensors(&config, &tensors).unwrap();
        let encoder = Encoder::from_tensors(&config, &tensors).unwrap();

        let rows: Vec<usize> = (0..20).collect();
        let batch = frame.prepare(&validation, true).batch(&rows).unwrap();
        let forward = network.forward(&batch, None, Norm::Running).unwrap();
        let offsets = batch.offsets.unwrap().to_vec2::<f32>().unwrap();
        let outputs = forward.output.to_vec2::<f32>().unwrap();
        let means = forward.mean.to_vec2::<f32>().unwrap();
        let log_variances = forward.log_variance.to_vec2::<f32>().unwrap();
        for i in rows {
            let condition = frame.condition(&validation, i);
            let measures: [f64; MEASURE_COUNT] = std::array::from_fn(|j| condition[j]);
            let sex = if condition[CONDITION_COUNT - 1] < 0.0 { Sex::Female } else { Sex::Male };
            let c: Vec<f64> =
                validation.coefficients[i * K..(i + 1) * K].iter().map(|&v| f64::from(v)).collect();
            let (mean, log_variance) = encoder.encode(&measures, sex, &c).unwrap();
            close(&mean, &means[i]);
            close(&log_variance, &log_variances[i]);
            let expected: Vec<f32> =
                (0..K).map(|j| offsets[i][j] + outputs[i][j] * frame.scale[j] as f32).collect();
            close(&decoder.decode_f64(&measures, sex, &mean), &expected);
        }
    }
}

/// Equal to 1e-4 of the largest number.
fn close(a: &[f64], b: &[f32]) {
    let largest = b.iter().fold(0.0_f32, |m, v| m.max(v.abs()));
    for (x, y) in a.iter().zip(b) {
        assert!((x - f64::from(*y)).abs() < 1e-4 * f64::from(largest), "{a:?} {b:?}");
    }
}

#[test]
fn contradictory_input_is_refused() {
    let (training, validation, statistics) = sets();
    let folder = tempfile::tempdir().unwrap();
    let options = options(&folder, 1);
    let refuse = |training: &TrainingSet, config: &GeneratorConfig| {
        train(training, &validation, &statistics, config, &options).unwrap_err().to_string()
    };
    let mut bad = training.clone();
    bad.measures.pop();
    assert!(refuse(&bad, &config(false)).contains("expected 43200 measures, got 43199"));
    let mut bad = training.clone();
    bad.coefficients[3 * K + 5] = f32::NAN;
    assert!(refuse(&bad, &config(false)).contains("coefficient 5 of body 3 is NaN"));
    assert!(refuse(&training, &GeneratorConfig::default()).contains("expected 300"));
}
