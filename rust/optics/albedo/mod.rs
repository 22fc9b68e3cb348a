//! How much light microfacets scatter once: the rest meets further facets, and a rough surface has to make up for it.
//!
//! What is lost has no closed form. It is tabulated by integrating once (`quadrature.rs`, in tests, which also writes
//! the tables) in variables in which it is smooth, down to no roughness at all: near grazing a surface of roughness α
//! behaves at angle θ as every other with the same α tan θ.

mod coat;
mod interface;
mod mirror;
#[cfg(test)]
mod quadrature;
mod schlick;
mod tables;

pub use coat::{coat, coat_average};
pub use interface::Interface;
pub use mirror::MirrorLoss;
pub use schlick::{schlick_share, schlick_share_average};

use super::{Facets, Ggx};
use glam::DVec3;

/// x = z / s(ω) = 1 / √(1 + α² tan² θ).
#[inline]
fn x_of(ggx: &Ggx, w: DVec3) -> f64 {
    (w.z.abs() / ggx.stretch(w)).min(1.0)
}

/// A variable from 0 to 1 for x: dense at grazing, as √x, and near x = 1.
#[inline]
fn of_x(x: f64) -> f64 {
    0.5 * (x.sqrt() + x * x * x)
}

/// A variable from 0 to 1 for a roughness: in α² at first, as losses grow.
#[inline]
fn of_alpha(alpha: f64) -> f64 {
    1.3 * alpha * alpha / (alpha * alpha + 0.3)
}

/// A variable from 0 to 1 for a roughness where what changes with it changes from the first.
#[inline]
fn of_alpha_power(alpha: f64) -> f64 {
    alpha.powf(0.7)
}

/// About the cosine at which facets are met that reflect to a direction of this cosine: at grazing, that of a slope of
/// α.
#[inline]
fn effective_cosine(alpha: f64, cosine: f64) -> f64 {
    let square = FACET_SLOPE * alpha * alpha;
    ((cosine * cosine + square) / (1.0 + square)).sqrt()
}

/// What makes the tables of what differs from [`effective_cosine`]'s reflectance the flattest.
const FACET_SLOPE: f64 = 0.6;

/// Where a variable from 0 to 1 lies between `count` values: the lower one's number, and how far on.
#[inline]
fn between(variable: f64, count: usize) -> (usize, f64) {
    let at = variable.clamp(0.0, 1.0) * (count - 1) as f64;
    // To 32 bits and back, which processors convert at once.
    let low = (at as i32).min(count as i32 - 2);
    (low as usize, at - f64::from(low))
}

/// The value of a table of shares in 65535ths between its entries, linear in each variable.
#[inline]
fn plane(table: &[u16], sizes: [usize; 2], at: [f64; 2]) -> f64 {
    within(table, sizes[1], between(at[0], sizes[0]), between(at[1], sizes[1]))
}

/// The same where it is known between which entries, of a table with rows of so many.
#[inline]
fn within(table: &[u16], columns: usize, (i, f): (usize, f64), (j, g): (usize, f64)) -> f64 {
    let four = &table[i * columns + j..][..columns + 2];
    let row = |k: usize| f64::from(four[k]) * (1.0 - g) + f64::from(four[k + 1]) * g;
    (row(0) * (1.0 - f) + row(columns) * f) / 65535.0
}

/// The same of a table of three variables.
#[inline]
fn volume(table: &[u16], sizes: [usize; 3], at: [f64; 3]) -> f64 {
    let (i, f) = between(at[0], sizes[0]);
    let rest = [sizes[1], sizes[2]];
    let layer = |i: usize| plane(&table[i * rest[0] * rest[1]..(i + 1) * rest[0] * rest[1]], rest, [at[1], at[2]]);
    layer(i) * (1.0 - f) + layer(i + 1) * f
}

/// The value between entries of a table of averages.
#[inline]
fn averages(table: &[f64], sizes: [usize; 2], at: [f64; 2]) -> f64 {
    let ((i, f), (j, g)) = (between(at[0], sizes[0]), between(at[1], sizes[1]));
    let row = |i: usize| table[i * sizes[1] + j] * (1.0 - g) + table[i * sizes[1] + j + 1] * g;
    row(i) * (1.0 - f) + row(i + 1) * f
}
