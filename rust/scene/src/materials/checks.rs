//! What parameters of materials may be, in words.

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

/// Whether all values lie between two numbers.
///
/// # Errors
/// What they are, and what was expected.
pub(super) fn within<T: Quantity>(name: &str, value: &Value<T>, least: f64, most: f64) -> Result<(), String> {
    if value.is_within(least, most) {
        return Ok(());
    }
    let [low, high] = value.range();
    Err(format!("{name} must {}, got {low} to {high}", expected(least, most)))
}

/// Whether a number lies between two.
///
/// # Errors
/// As [`within`].
pub(super) fn number(name: &str, value: f64, least: f64, most: f64) -> Result<(), String> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(format!("{name} must {}, got {value}", expected(least, most)))
}
