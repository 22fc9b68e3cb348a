//! Numbers made of bytes: occasionally any bits, and mostly numbers for close decisions.

use arbitrary::{Result, Unstructured};
use raywright::math::{DVec3, Vec3};

/// Range of magnitudes around 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any bits, NaN and infinities too.
    Any,
    /// Finite, zero or from 2⁻⁶⁰ to 2⁶⁰, so that no quotient of a few products leaves the range of an f64.
    Moderate,
}

/// An f32.
pub fn single(u: &mut Unstructured, range: Range) -> Result<f32> {
    let kind: u8 = u.arbitrary()?;
    let x = match kind % 8 {
        0 if range == Range::Any => f32::from_bits(u.arbitrary()?),
        0 | 1 => f32::from(u.arbitrary::<i16>()?) / 32768.0,
        // A grid, where many numbers coincide.
        2..=4 => f32::from(u.arbitrary::<i8>()? % 5),
        5 => f32::from(u.arbitrary::<i8>()?) / 16.0,
        // Beside the grid.
        6 => f32::from(u.arbitrary::<i8>()? % 4) * (1.0 + f32::from(u.arbitrary::<i8>()? % 3) * f32::EPSILON),
        _ => f32::from(u.arbitrary::<i16>()?) / 32768.0 * 2f32.powi(i32::from(u.arbitrary::<i8>()? % 40)),
    };
    Ok(x)
}

/// An f64.
pub fn double(u: &mut Unstructured, range: Range) -> Result<f64> {
    let kind: u8 = u.arbitrary()?;
    let x = match kind % 8 {
        0 if range == Range::Any => f64::from_bits(u.arbitrary()?),
        1 => u.arbitrary::<i64>()? as f64 / 2f64.powi(63),
        2 => f64::from(u.arbitrary::<i8>()? % 4) * (1.0 + f64::from(u.arbitrary::<i8>()? % 3) * f64::EPSILON),
        3 => f64::from(u.arbitrary::<i16>()?) / 32768.0 * 2f64.powi(i32::from(u.arbitrary::<i8>()? % 46)),
        _ => f64::from(single(u, range)?),
    };
    // A non-zero number must not be below the range.
    Ok(if range == Range::Moderate && x.abs() < 2f64.powi(-60) { 0.0 } else { x })
}

/// A point of f32.
pub fn single_point(u: &mut Unstructured, range: Range) -> Result<Vec3> {
    Ok(Vec3::new(single(u, range)?, single(u, range)?, single(u, range)?))
}

/// A point of f64.
pub fn double_point(u: &mut Unstructured, range: Range) -> Result<DVec3> {
    Ok(DVec3::new(double(u, range)?, double(u, range)?, double(u, range)?))
}

/// One of at least one choices.
pub fn one_of<T: Copy>(u: &mut Unstructured, some: &[T]) -> Result<T> {
    u.choose(some).copied()
}
