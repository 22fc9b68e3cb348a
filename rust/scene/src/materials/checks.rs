//! Range checks of material parameters.

use crate::textures::{Quantity, Value};

fn expected(least: f64, most: f64) -> String {
    match (least, most) {
        (f64::MIN_POSITIVE, f64::MAX) => "be finite and above 0".to_owned(),
        (0.0, f64::MAX) => "be finite and not negative".to_owned(),
        (f64::MIN, f64::MAX) => "be finite".to_owned(),
        (least, f64::MAX) => format!("be finite and at least {least}"),
        (least, most) => format!("lie between {least} and {most}"),
    }
}

/// Checks that all values are within a range.
///
/// # Errors
/// The range of the values, and the expected range.
pub(super) fn within<T: Quantity>(name: &str, value: &Value<T>, least: f64, most: f64) -> Result<(), String> {
    if value.is_within(least, most) {
        return Ok(());
    }
    let [low, high] = value.range();
    Err(format!("{name} must {}, got {low} to {high}", expected(least, most)))
}

/// Checks that a number is within a range.
///
/// # Errors
/// As [`within`].
pub(super) fn number(name: &str, value: f64, least: f64, most: f64) -> Result<(), String> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(format!("{name} must {}, got {value}", expected(least, most)))
}
