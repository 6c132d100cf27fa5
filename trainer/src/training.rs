//! Shared by the training of all networks: the optimiser, the learning-rate schedule, random order.

use std::sync::{Mutex, PoisonError};

use anthronet::random::Random;
use candle_core::{CpuStorage, InplaceOp2, Layout, Tensor, Var, bail};

use crate::{Error, Result};

/// Adam (Kingma and Ba, 2015) with the usual constants, one fused pass per variable.
#[derive(Debug)]
pub struct Adam {
    steps: u32,
    moments: Vec<Mutex<Moments>>,
}

/// Running first and second moments of one variable's gradient.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// Mean of the gradient.
    pub first: Vec<f32>,
    /// Mean of its square.
    pub second: Vec<f32>,
}

impl Adam {
    const BETA_1: f32 = 0.9;
    const BETA_2: f32 = 0.999;
    const EPSILON: f32 = 1e-8;

    /// A fresh optimiser for variables of the given sizes.
    pub fn new(sizes: impl IntoIterator<Item = usize>) -> Self {
        let moments = sizes.into_iter().map(|n| Moments { first: vec![0.0; n], second: vec![0.0; n] });
        Self { steps: 0, moments: moments.map(Mutex::new).collect() }
    }

    /// Continues from saved moments, in the order of the variables.
    pub fn resume(steps: u32, moments: Vec<Moments>) -> Self {
        Self { steps, moments: moments.into_iter().map(Mutex::new).collect() }
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// A copy of the moments, in the order of the variables.
    pub fn moments(&self) -> Vec<Moments> {
        self.moments.iter().map(|m| m.lock().unwrap_or_else(PoisonError::into_inner).clone()).collect()
    }

    /// Moves the variables (the same, in the same order, every time) against their gradients.
    ///
    /// # Errors
    /// When the variables are not those of [`Adam::new`], or candle fails.
    pub fn step<'a>(
        &mut self,
        variables: impl IntoIterator<Item = (&'a Var, &'a Tensor)>,
        rate: f64,
    ) -> Result<()> {
        self.steps += 1;
        let t = f64::from(self.steps);
        let correct_1 = 1.0 - libm::pow(f64::from(Self::BETA_1), t);
        let correct_2 = 1.0 - libm::pow(f64::from(Self::BETA_2), t);
        let mut moments = self.moments.iter();
        for (variable, gradient) in variables {
            let moments =
                moments.next().ok_or_else(|| Error::Invalid("more variables than Adam has".into()))?;
            let update = Update {
                moments,
                rate: (rate / correct_1) as f32,
                inverse_correct_2: (1.0 / correct_2) as f32,
            };
            variable.inplace_op2(&gradient.contiguous()?, &update)?;
        }
        Ok(())
    }
}

struct Update<'a> {
    moments: &'a Mutex<Moments>,
    rate: f32,
    inverse_correct_2: f32,
}

impl InplaceOp2 for Update<'_> {
    fn name(&self) -> &'static str {
        "adam"
    }

    fn cpu_fwd(
        &self,
        s1: &mut CpuStorage,
        l1: &Layout,
        s2: &CpuStorage,
        l2: &Layout,
    ) -> candle_core::Result<()> {
        let CpuStorage::F32(parameters) = s1 else { bail!("expected f32 parameters") };
        let (Some((from, to)), Some((g_from, g_to))) = (l1.contiguous_offsets(), l2.contiguous_offsets())
        else {
            bail!("expected contiguous parameters and gradients")
        };
        let parameters = &mut parameters[from..to];
        let gradient = &s2.as_slice::<f32>()?[g_from..g_to];
        let mut moments = self.moments.lock().unwrap_or_else(PoisonError::into_inner);
        let Moments { first, second } = &mut *moments;
        if gradient.len() != parameters.len() || first.len() != parameters.len() {
            bail!("adam: sizes {} {} {}", parameters.len(), gradient.len(), first.len());
        }
        let (b1, b2) = (Adam::BETA_1, Adam::BETA_2);
        for (((p, g), m), v) in parameters.iter_mut().zip(gradient).zip(first).zip(second) {
            *m = b1 * *m + (1.0 - b1) * g;
            *v = b2 * *v + (1.0 - b2) * g * g;
            *p -= self.rate * *m / ((*v * self.inverse_correct_2).sqrt() + Adam::EPSILON);
        }
        Ok(())
    }
}

/// The one-cycle schedule (Smith and Topin, "Super-convergence", 2018): a cosine up, then a cosine down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneCycle {
    /// The highest rate.
    pub peak: f64,
    /// Fraction of all steps until the peak.
    pub warmup: f64,
    /// Total number of steps.
    pub steps: usize,
}

impl OneCycle {
    /// The learning rate of a step, from 0.
    pub fn rate(&self, step: usize) -> f64 {
        let position = step as f64 / self.steps.max(1) as f64;
        let (from, to, t) = if position < self.warmup {
            (0.04, 1.0, position / self.warmup)
        } else {
            (1.0, 1e-5, (position - self.warmup) / (1.0 - self.warmup).max(1e-9))
        };
        let blend = 0.5 - 0.5 * libm::cos(std::f64::consts::PI * t.clamp(0.0, 1.0));
        self.peak * (from + (to - from) * blend)
    }
}

/// The random numbers of one epoch, which follow from the seed and the epoch alone: a resumed run needs no saved
/// generator. Stream 0 of a seed is left to the network's start.
pub fn epoch_random(seed: u64, epoch: usize) -> Random {
    Random::new(seed, epoch as u64 + 1)
}

/// 0..count in random order (Fisher–Yates).
pub fn random_order(random: &mut Random, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        // The bias of the high product is below 2⁻⁴⁰ for any data set that fits in memory.
        let j = ((u128::from(random.bits()) * (i as u128 + 1)) >> 64) as usize;
        order.swap(i, j);
    }
    order
}

/// Draws from N(0, 1), rounded to what the networks compute in.
pub fn random_normals(random: &mut Random, count: usize) -> Vec<f32> {
    (0..count).map(|_| random.normal() as f32).collect()
}

#[cfg(test)]
mod tests {
    use candle_core::Device;

    use super::*;

    #[test]
    fn adam_finds_a_minimum() {
        let x = Var::from_tensor(&Tensor::new(&[3.0_f32, -2.0], &Device::Cpu).unwrap()).unwrap();
        let goal = Tensor::new(&[1.0_f32, 5.0], &Device::Cpu).unwrap();
        let mut adam = Adam::new([2]);
        let schedule = OneCycle { peak: 0.3, warmup: 0.2, steps: 300 };
        for step in 0..300 {
            let loss = (x.as_tensor() - &goal).unwrap().sqr().unwrap().sum_all().unwrap();
            let gradients = loss.backward().unwrap();
            adam.step([(&x, gradients.get(&x).unwrap())], schedule.rate(step)).unwrap();
        }
        let found = x.to_vec1::<f32>().unwrap();
        assert!((found[0] - 1.0).abs() < 1e-3 && (found[1] - 5.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn the_cycle_rises_and_falls() {
        let cycle = OneCycle { peak: 0.005, warmup: 0.25, steps: 1000 };
        assert!((cycle.rate(0) - 0.0002).abs() < 1e-12);
        assert!((cycle.rate(250) - 0.005).abs() < 1e-12);
        assert!(cycle.rate(999) < 1e-7);
        assert!((1..250).all(|s| cycle.rate(s) > cycle.rate(s - 1)));
        assert!((251..1000).all(|s| cycle.rate(s) < cycle.rate(s - 1)));
    }

    #[test]
    fn order_is_a_permutation_of_the_seed() {
        let order = random_order(&mut epoch_random(4, 2), 1000);
        assert_eq!(order, random_order(&mut epoch_random(4, 2), 1000));
        assert_ne!(order, random_order(&mut epoch_random(4, 3), 1000));
        let mut sorted = order;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..1000));
    }
}
