//! How exactly given measures are believed: standard deviations, metres, that stand beside the prior's covariance.
//!
//! Each question to the prior has its own. That [`FILL_ERROR`] and [`JUDGING_ERROR`] differ has grown: both say how exactly a
//! tape was read, and the next retraining should make them one. Until then they stay, as either decides which bodies
//! come of a request: the first fills what is left open, the second refuses, pulls to the nearest, and guesses the sex.

/// When given measures predict those that were left open: a tape reads to about a millimetre. It also keeps nearly collinear
/// measures (left and right) from being extrapolated.
pub const FILL_ERROR: f64 = 0.001;

/// When given measures are judged, whether one person has them and of which sex: half a centimetre, which rounding to whole
/// centimetres is off by at most, so that rounding hardly tells against a request.
pub const JUDGING_ERROR: f64 = 0.005;

/// What [`SexPrior::project`](super::SexPrior::project) takes off all measures, given and filled, before the network sees
/// them: about the standard deviation of rounding to whole centimetres, 10 mm / √12 = 2.9 mm, as the paper's tables are.
pub const PROJECTION_ERROR: f64 = 0.003;
