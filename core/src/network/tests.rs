//! The networks on small random weights.

use super::config::GeneratorConfig;
use super::fourier::FourierConfig;
use super::{Decoder, Encoder, Shapes, Tensor, Tensors, decoder_shapes, encoder_shapes};
use crate::measure::{MEASURE_COUNT, Sex};
use crate::random::Random;

fn tiny(skip: bool, components: usize) -> GeneratorConfig {
    GeneratorConfig {
        fourier: FourierConfig { components, sigma: 0.1, seed: 3 },
        width: 1,
        skip,
        latent_skip: skip,
        coefficients: 7,
        ..GeneratorConfig::default()
    }
}

fn random(shapes: &Shapes, rng: &mut Random, out: &mut Tensors) {
    for (name, shape) in shapes {
        let scale = 1.0 / (shape[0] as f64).sqrt();
        let count = shape.iter().product();
        let data = (0..count).map(|_| (rng.normal() * scale) as f32).collect();
        out.insert(name.clone(), Tensor { shape: shape.clone(), data });
    }
}

fn tensors(config: &GeneratorConfig) -> Tensors {
    let mut rng = Random::new(5, 0);
    let mut out = Tensors::new();
    random(&decoder_shapes(config), &mut rng, &mut out);
    random(&encoder_shapes(config), &mut rng, &mut out);
    out
}

fn measures() -> [f64; MEASURE_COUNT] {
    std::array::from_fn(|i| (i as f64 - 17.0) / 12.0)
}

#[test]
fn jacobian_matches_differences() {
    for (skip, components) in [(true, 0), (false, 2)] {
        let config = tiny(skip, components);
        let decoder = Decoder::from_tensors(&config, &tensors(&config)).unwrap();
        let z: Vec<f64> = (0..10).map(|i| 0.3 * f64::from(i) - 1.0).collect();
        let (value, jacobian) = decoder.decode_with_jacobian(&measures(), Sex::Male, &z);
        assert_eq!(value, decoder.decode_f64(&measures(), Sex::Male, &z));
        let h = 1e-7;
        for i in 0..MEASURE_COUNT {
            let (mut low, mut high) = (measures(), measures());
            low[i] -= h;
            high[i] += h;
            let low = decoder.decode_f64(&low, Sex::Male, &z);
            let high = decoder.decode_f64(&high, Sex::Male, &z);
            for k in 0..7 {
                let difference = (high[k] - low[k]) / (2.0 * h);
                // Rounding of differences of size 1e-7 in f64; no unit changes sign within the step.
                assert!((difference - jacobian[i * 7 + k]).abs() < 1e-6, "{i} {k}");
            }
        }
    }
}

#[test]
fn wrong_tensors_are_named() {
    let config = tiny(true, 0);
    let good = tensors(&config);
    for name in decoder_shapes(&config).keys() {
        let mut missing = good.clone();
        missing.remove(name);
        let message = Decoder::from_tensors(&config, &missing).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains("missing"), "{message}");
    }
    let change = |name: &str, f: fn(&mut Tensor)| {
        let mut bad = good.clone();
        f(bad.get_mut(name).unwrap());
        Decoder::from_tensors(&config, &bad).unwrap_err().to_string()
    };
    assert!(change("output.bias", |t| t.shape = vec![9]).contains("expected shape [7], got [9]"));
    assert!(change("output.bias", |t| t.data.truncate(6)).contains("expected 7 values, got 6"));
    assert!(change("skip.weight", |t| t.data[3] = f32::NAN).contains("finite"));
}

#[test]
fn odd_latent_vectors_are_padded() {
    let config = tiny(true, 0);
    let decoder = Decoder::from_tensors(&config, &tensors(&config)).unwrap();
    let zero = decoder.decode(&measures(), Sex::Female, &[0.0; 10]);
    assert_eq!(zero, decoder.decode(&measures(), Sex::Female, &[]));
    assert_eq!(zero, decoder.decode(&measures(), Sex::Female, &[0.0; 30]));
    assert_ne!(zero, decoder.decode(&measures(), Sex::Male, &[]));
}

#[test]
fn the_encoder_checks_the_number_of_coefficients() {
    let config = tiny(true, 1);
    let encoder = Encoder::from_tensors(&config, &tensors(&config)).unwrap();
    let (mean, log_variance) = encoder.encode(&measures(), Sex::Female, &[0.01; 7]).unwrap();
    assert_eq!((mean.len(), log_variance.len()), (10, 10));
    let message = encoder.encode(&measures(), Sex::Female, &[0.01; 8]).unwrap_err().to_string();
    assert!(message.contains("expected 7, got 8"), "{message}");
}
