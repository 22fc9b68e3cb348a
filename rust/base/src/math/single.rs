//! f32 functions for light transport, written without branches for loops over sixteen lanes.

use super::Vec3;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// A mask of all bits or none. SSE2 has no vectors of bool, nor a blend by them.
#[inline(always)]
pub fn mask(is: bool) -> u32 {
    u32::from(is).wrapping_neg()
}

/// Select the first if the mask is set, else the second.
#[inline(always)]
pub fn choose(mask: u32, first: f32, second: f32) -> f32 {
    f32::from_bits(first.to_bits() & mask | second.to_bits() & !mask)
}

/// Select the first vector if the mask is set, else the second.
#[inline(always)]
pub fn choose_vector(mask: u32, first: Vec3, second: Vec3) -> Vec3 {
    Vec3::new(choose(mask, first.x, second.x), choose(mask, first.y, second.y), choose(mask, first.z, second.z))
}

/// The maximum of two numbers other than NaN.
#[inline(always)]
pub fn greater(a: f32, b: f32) -> f32 {
    choose(mask(a > b), a, b)
}

/// The minimum of two numbers other than NaN.
#[inline(always)]
pub fn lesser(a: f32, b: f32) -> f32 {
    choose(mask(a < b), a, b)
}

/// The sine and the cosine of an angle between −π/4 and π/4, to within 2⁻²³ of 1.
#[inline(always)]
pub fn sin_cos_eighth(x: f32) -> [f32; 2] {
    let z = x * x;
    let sin = x + x * z * (-1.0 / 6.0 + z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z * (1.0 / 362_880.0))));
    let cos = 1.0 - 0.5 * z + z * z * (1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40_320.0)));
    [sin, cos]
}

/// The sine and the cosine of an angle in quarter turns, from 0 to 4, to within 2⁻²² of 1.
#[inline(always)]
pub fn sin_cos_quarters(quarters: f32) -> [f32; 2] {
    /// Adding this rounds a small number to an integer in the last bits.
    const WHOLE: f32 = 12_582_912.0;
    let shifted = quarters + WHOLE;
    let [sin, cos] = sin_cos_eighth((quarters - (shifted - WHOLE)) * FRAC_PI_2);
    let turns = shifted.to_bits();
    let is_odd = mask(turns & 1 == 1);
    let (a, b) = (choose(is_odd, cos, sin), choose(is_odd, sin, cos));
    [f32::from_bits(a.to_bits() ^ (turns & 2) << 30), f32::from_bits(b.to_bits() ^ (turns.wrapping_add(1) & 2) << 30)]
}

/// The angle of a point in the upper half-plane from +x, from 0 to π, to a relative error of 2⁻²¹; NaN at the origin.
#[inline(always)]
pub fn upper_angle(y: f32, x: f32) -> f32 {
    /// tan π/8.
    const EIGHTH: f32 = 0.414_213_57;
    let width = x.abs();
    let is_steep = mask(y > width);
    let (over, under) = (lesser(y, width), greater(y, width));
    // Rotated by an eighth of a turn if it exceeds a sixteenth, so that a few terms suffice.
    let is_far = mask(over > EIGHTH * under);
    let tangent = choose(is_far, over - under, over) / choose(is_far, over + under, under);
    let z = tangent * tangent;
    let series = z * (-0.333_329_5 + z * (0.199_777_1 + z * (-0.138_776_86 + z * 0.080_537_45)));
    let angle = choose(is_far, FRAC_PI_4, 0.0) + (tangent + tangent * series);
    let angle = choose(is_steep, FRAC_PI_2 - angle, angle);
    choose(mask(x < 0.0), PI - angle, angle)
}

/// Radius, and sine and cosine of the angle, of a point in the unit disk; see [`crate::sampling::warp::uniform_disk`].
#[inline(always)]
fn concentric(u: [f32; 2]) -> (f32, [f32; 2]) {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let is_wide = mask(a.abs() > b.abs());
    let (radius, other) = (choose(is_wide, a, b), choose(is_wide, b, a));
    let ratio = choose(mask(radius == 0.0), 0.0, other / radius);
    let [sin, cos] = sin_cos_eighth(FRAC_PI_4 * ratio);
    (radius, [choose(is_wide, sin, cos), choose(is_wide, cos, sin)])
}

/// A direction about +z with density cos θ / π.
#[inline(always)]
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let (radius, [sin, cos]) = concentric(u);
    // 1 − r² would lose the digits of grazing directions.
    let height = ((1.0 - radius) * (1.0 + radius)).sqrt();
    Vec3::new(radius * cos, radius * sin, height)
}

/// Weights of a triangle's second and third corner, uniform in area; see
/// [`crate::sampling::warp::uniform_triangle`].
#[inline(always)]
pub fn uniform_triangle([x, y]: [f32; 2]) -> [f32; 2] {
    let is_above = mask(y > x);
    [choose(is_above, 0.5 * x, x - 0.5 * y), choose(is_above, y - 0.5 * x, 0.5 * y)]
}

/// Transform a vector from the local frame of a unit normal to the world; see [`super::Frame::new`].
#[inline(always)]
pub fn to_world(normal: Vec3, local: Vec3) -> Vec3 {
    let sign = 1f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = Vec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    tangent * local.x + bitangent * local.y + normal * local.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DVec3, Frame};
    use crate::sampling::{Sampler, warp};

    #[test]
    fn turns_and_angles_are_those_of_f64() {
        for i in 0..=4000 {
            let quarters = i as f32 / 1000.0;
            let (sin, cos) = (f64::from(quarters) * std::f64::consts::FRAC_PI_2).sin_cos();
            let [s, c] = sin_cos_quarters(quarters).map(f64::from);
            assert!((s - sin).abs() < 2.5e-7 && (c - cos).abs() < 2.5e-7, "{quarters}");
            for length in [1e-20, 1.0, 3e15] {
                let part = 0.5 * f64::from(quarters) * std::f64::consts::FRAC_PI_2;
                let (y, x) = (length * part.sin().max(0.0), length * part.cos());
                let (y, x) = (y as f32, x as f32);
                let wanted = f64::from(y).atan2(x.into());
                let got = f64::from(upper_angle(y, x));
                assert!((got - wanted).abs() <= 5e-7 * wanted + 1e-30, "{y} {x}: {got}, not {wanted}");
            }
        }
    }

    #[test]
    fn warps_are_those_of_f64() {
        for i in 0..2000 {
            let mut sampler = Sampler::new(3, 0, i);
            let u = sampler.two(0);
            let single = u.map(|u| u as f32);
            assert!((cosine_hemisphere(single).as_dvec3() - warp::cosine_hemisphere(u)).length() < 3e-3);
            // Same inputs, same results to some ulps.
            let same = single.map(f64::from);
            assert!((cosine_hemisphere(single).as_dvec3() - warp::cosine_hemisphere(same)).length() < 1e-3);
            let ([v, w], [a, b]) = (uniform_triangle(single), warp::uniform_triangle(same));
            assert!((f64::from(v) - a).abs() < 1e-7 && (f64::from(w) - b).abs() < 1e-7);
            let normal = warp::uniform_sphere(sampler.two(1));
            let local = DVec3::new(0.3, -0.2, 0.7);
            let world = to_world(normal.as_vec3(), local.as_vec3()).as_dvec3();
            assert!((world - Frame::new(normal).to_world(local)).length() < 1e-5);
        }
    }
}
