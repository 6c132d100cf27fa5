//! The chi-squared distribution: of the squared Mahalanobis distance of an n-dimensional Gaussian from its mean.
//!
//! Closed forms for whole degrees of freedom (Abramowitz and Stegun, Handbook of Mathematical Functions, 26.4.4 and
//! 26.4.5), so that tails of 1e-12 are as accurate as those of 5 %.

/// Probability of a value above `x` with `n` degrees of freedom; 1 for x ≤ 0, and 0 for x > 0 and n = 0.
pub(crate) fn survival(x: f64, n: usize) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    if n == 0 {
        return 0.0;
    }
    let half = 0.5 * x;
    let decay = libm::exp(-half);
    if decay == 0.0 {
        return 0.0;
    }
    // Sum of half^k / Γ(k + 1) over k < n / 2: k = 0, 1, … for even n, k = 1/2, 3/2, … for odd n.
    let (mut term, mut order, tail) = if n.is_multiple_of(2) {
        (1.0, 0.0, 0.0)
    } else {
        (2.0 * (half / std::f64::consts::PI).sqrt(), 0.5, libm::erfc(half.sqrt()))
    };
    let mut sum = 0.0;
    for _ in 0..n / 2 {
        sum += term;
        order += 1.0;
        term *= half / order;
    }
    tail + decay * sum
}

/// The value that is exceeded with probability `tail`, 0 < tail < 1, with `n` degrees of freedom.
pub(crate) fn upper_quantile(tail: f64, n: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // exp underflows long before 1e4: the bound matters only for a tail of zero.
    while survival(high, n) > tail && high < 1e4 {
        low = high;
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if survival(middle, n) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_published_tables() {
        // Abramowitz and Stegun, table 26.8; the last two from the normal distribution at 1e-12 and from exp(-x/2).
        let table = [
            (1, 0.05, 3.84146),
            (2, 0.05, 5.99146),
            (3, 0.001, 16.2662),
            (10, 0.001, 29.588),
            (30, 0.001, 59.7031),
            (36, 0.5, 35.336),
            (1, 1e-12, 7.130_507_8 * 7.130_507_8),
            (2, 1e-12, 24.0 * std::f64::consts::LN_10),
        ];
        for (n, tail, x) in table {
            let quantile = upper_quantile(tail, n);
            assert!((quantile - x).abs() < 2e-5 * x, "{n} {tail}: {quantile} for {x}");
            assert!((survival(quantile, n) - tail).abs() < 1e-9 * tail);
        }
    }

    #[test]
    fn stays_a_probability_everywhere() {
        for n in 0..40 {
            for x in [-1.0, 0.0, 1e-300, 1e-3, 1.0, 30.0, 700.0, 1e4, 1e300, f64::INFINITY] {
                let p = survival(x, n);
                assert!((0.0..=1.0 + 1e-15).contains(&p), "{n} {x}: {p}");
            }
        }
        assert!(upper_quantile(0.0, 3).is_finite());
    }
}
