//! Areas of surfaces of revolution, and sampling by area.

use super::{ProfileCurve, Revolution};
use crate::Drawn;
use raywright_base::math::Affine;
use std::f64::consts::{PI, TAU};

impl Revolution {
    /// The areas of base cap, side and tip cap.
    fn areas(&self) -> [f64; 3] {
        let (_, height) = self.frame();
        let [base, tip] = self.radii();
        let side = match self.profile {
            ProfileCurve::Straight { .. } => PI * (base + tip) * height.hypot(tip - base),
            ProfileCurve::Parabola { tip } => {
                let (square, whole) = parabola(tip, height);
                2.0 / 3.0 * PI * tip * tip / square * whole
            }
        };
        let cap = |radius: f64| if self.capped { PI * radius * radius } else { 0.0 };
        [cap(base), side, cap(tip)]
    }

    /// The total area.
    pub(crate) fn area(&self) -> f64 {
        self.areas().iter().sum()
    }

    /// Sample a point uniformly by area.
    pub(crate) fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let areas = self.areas();
        let whole: f64 = areas.iter().sum();
        let [low, high] = self.breaks();
        let (_, height) = self.frame();
        // The first number chooses the part; its remainder is uniform again.
        let left = u[0] * whole;
        let v = if left < areas[0] {
            // A disk is uniform in the squared radius.
            (low * (left / areas[0]).sqrt()).min(low.next_down())
        } else if left >= areas[0] + areas[1] && areas[2] > 0.0 {
            let share = ((left - areas[0] - areas[1]) / areas[2]).clamp(0.0, 1.0);
            (1.0 - (1.0 - high) * share.sqrt()).max(high.next_up())
        } else {
            let share = ((left - areas[0]) / areas[1]).clamp(0.0, 1.0);
            let along = match self.profile {
                ProfileCurve::Straight { base, tip } => {
                    // A cone, too, is uniform in the squared radius, and a cylinder in the height. One formula without
                    // cancellation serves both.
                    let radius = (base * base + share * (tip - base) * (tip + base)).max(0.0).sqrt();
                    if share > 0.0 { share * (base + tip) / (base + radius) } else { 0.0 }
                }
                ProfileCurve::Parabola { tip } => {
                    let (square, whole) = parabola(tip, height);
                    ((share * whole).ln_1p() * (2.0 / 3.0)).exp_m1().sqrt() / square.sqrt()
                }
            };
            (low + (high - low) * along).clamp(low, high)
        };
        (whole > 0.0).then(|| Drawn { point: self.at([u[1], v]), pdf: 1.0 / whole })
    }

    /// The area under an affine map, to a relative error of about 10⁻⁹.
    ///
    /// A cap has a closed form. The stretch of a straight side depends on the angle alone, and that of a paraboloid
    /// also on the radius. It is summed over ever more angles until the sum is stable. For a smooth function of period
    /// 1 this converges faster than any power (Trefethen and Weideman 2014).
    pub(crate) fn area_under(&self, map: &Affine) -> f64 {
        let (frame, height) = self.frame();
        let [base, _, tip] = self.areas();
        let caps = (base + tip) * map.cofactors(frame.normal).length();
        let [x, y, z] = [frame.tangent, frame.bitangent, frame.normal].map(|axis| map.cofactors(axis));
        // The mean stretch over a ring of normals with radial part `out` and axial part `up`.
        let ring = |out: f64, up: f64| {
            around(|angle| {
                let (sin, cos) = (TAU * angle).sin_cos();
                ((x * cos + y * sin) * out + z * up).length()
            })
        };
        caps + match self.profile {
            ProfileCurve::Straight { base, tip } => PI * (base + tip) * ring(height, base - tip),
            ProfileCurve::Parabola { tip } => {
                // dA = 2π r √(r² + 4 h² s²) s ds along the profile (r s, h s²).
                simpson(|s| TAU * tip * s * ring(2.0 * height * s, -tip))
            }
        }
    }
}

/// With k = 2 h / r: the squared slope k² of the parabola at its rim, and (1 + k²)^(3/2) − 1.
fn parabola(radius: f64, height: f64) -> (f64, f64) {
    let square = (2.0 * height / radius).powi(2);
    (square, (1.5 * square.ln_1p()).exp_m1())
}

/// The mean of a function of period 1 by the trapezoidal rule with ever more points.
fn around(f: impl Fn(f64) -> f64) -> f64 {
    let sum = |count: u32, shift: f64| (0..count).map(|i| f((f64::from(i) + shift) / f64::from(count))).sum::<f64>();
    let (mut count, mut total) = (16, sum(16, 0.0));
    loop {
        let mean = total / f64::from(count);
        total += sum(count, 0.5);
        count *= 2;
        if (total / f64::from(count) - mean).abs() <= 1e-13 * mean || count >= 1 << 16 {
            return total / f64::from(count);
        }
    }
}

/// The integral over [0, 1] by Simpson's rule with ever smaller steps, extrapolated (Romberg 1955).
fn simpson(f: impl Fn(f64) -> f64) -> f64 {
    let mut steps = 1u32;
    let mut row = vec![0.5 * (f(0.0) + f(1.0))];
    loop {
        let middle: f64 = (0..steps).map(|i| f((f64::from(i) + 0.5) / f64::from(steps))).sum();
        let mut next = vec![0.5 * (row[0] + middle / f64::from(steps))];
        let mut power = 1.0;
        for last in &row {
            power *= 4.0;
            let better = next[next.len() - 1];
            next.push(better + (better - last) / (power - 1.0));
        }
        steps *= 2;
        let (old, new) = (row[row.len() - 1], next[next.len() - 1]);
        if (steps >= 16 && (new - old).abs() <= 1e-12 * new.abs()) || steps >= 1 << 10 {
            return new;
        }
        row = next;
    }
}
