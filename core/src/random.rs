//! Reproducible random numbers: the same seed gives the same bits on every machine.
//!
//! The bits are ChaCha8's, which its algorithm defines completely. Normal numbers are made from them by the Box–Muller
//! transform with `libm`, as the standard library's logarithm and cosine differ in the last bit between platforms.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A generator of uniform and normal numbers; generators of different (seed, stream) are independent.
#[derive(Clone, Debug)]
pub struct Random {
    bits: ChaCha8Rng,
    /// The second number of the last Box–Muller transform, which makes two at a time.
    spare: Option<f64>,
}

impl Random {
    /// The generator of this seed and stream. Each purpose has its own stream, so that its numbers do not change when
    /// another purpose draws more or fewer.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut bits = ChaCha8Rng::from_seed(key);
        bits.set_stream(stream);
        Self { bits, spare: None }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.bits.next_u64()
    }

    /// Uniform in the open interval (0, 1): odd multiples of 2⁻⁵³.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) * (1.0 / (1u64 << 52) as f64)
    }

    /// Normal with mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        let angle = std::f64::consts::TAU * self.uniform();
        self.spare = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }

    /// `count` independent numbers of [`normal`](Self::normal).
    pub fn normals(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.normal()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_always_gives_these_numbers() {
        let mut random = Random::new(7, 1);
        assert_eq!(random.bits(), BITS);
        assert_eq!(random.normal().to_bits(), NORMAL);
    }

    const BITS: u64 = 17_236_010_905_523_606_670;
    const NORMAL: u64 = 4_609_655_796_443_936_700;

    #[test]
    fn streams_and_seeds_differ() {
        let draw = |seed, stream| Random::new(seed, stream).normals(4);
        assert_eq!(draw(3, 1), draw(3, 1));
        assert_ne!(draw(3, 1), draw(3, 2));
        assert_ne!(draw(3, 1), draw(4, 1));
    }

    #[test]
    fn moments_are_those_of_a_normal_distribution() {
        let x = Random::new(1, 0).normals(200_000);
        let moment = |k: i32| x.iter().map(|v| v.powi(k)).sum::<f64>() / x.len() as f64;
        // Standard errors of these four at 200,000 draws: 0.002, 0.003, 0.009, 0.022; tolerances are about four of them.
        assert!(moment(1).abs() < 0.009 && (moment(2) - 1.0).abs() < 0.013);
        assert!(moment(3).abs() < 0.035 && (moment(4) - 3.0).abs() < 0.09);
    }

    #[test]
    fn uniform_stays_inside_its_open_interval() {
        let mut random = Random::new(2, 0);
        assert!((0..10_000).map(|_| random.uniform()).all(|u| u > 0.0 && u < 1.0));
    }
}
