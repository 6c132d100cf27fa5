//! Measurement noise: standard deviations, metres, whose squares are added to the diagonal of the prior's covariance.
//!
//! Each use of the prior has its own. [`FILL_NOISE`] and [`FEASIBILITY_NOISE`] differ for historical reasons: both model how
//! exactly a tape was read, and the next retraining should merge them. Until then both stay, as they affect the bodies that
//! requests give: the first fills open measures; the second refuses, corrects to the nearest and infers the sex.

/// Noise of given measures that predict open ones: a tape is read to about a millimetre. It also keeps differences of
/// nearly collinear measures (left and right) from being extrapolated.
pub const FILL_NOISE: f64 = 0.001;

/// Noise of given measures whose feasibility and sex are judged: half a centimetre, the largest error of rounding to
/// whole centimetres, so that rounding hardly counts against a request.
pub const FEASIBILITY_NOISE: f64 = 0.005;

/// Noise of all measures, given and filled, that [`SexPrior::project`](super::SexPrior::project) removes before the network
/// sees them: about the standard deviation of rounding to whole centimetres, as in the paper's tables, 10 mm / √12 = 2.9 mm.
pub const PROJECTION_NOISE: f64 = 0.003;
