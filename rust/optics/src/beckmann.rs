//! The Beckmann facet distribution.

use super::Facets;
use raywright_base::math::DVec3;
use raywright_base::math::erf::{FRAC_1_SQRT_PI, complement_integral, exceeded, scaled_complement};
use raywright_base::math::exponential::exp;
use std::f64::consts::FRAC_1_PI;

/// The facet distribution of a surface with normally distributed slopes (Beckmann and Spizzichino, "The Scattering of
/// Electromagnetic Waves from Rough Surfaces", 1963), with variance α²/2 along x and y.
///
/// With q = √(αx² x² + αy² y²) and a = z / q, Smith's Λ is (exp(−a²) / (a √π) − erfc(a)) / 2, so s(ω) = z + q i(a),
/// where i is the integral of erfc from a to infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beckmann {
    alpha: [f64; 2],
}

impl Beckmann {
    /// From this exponent on, exp(−e) times any factor that occurs underflows.
    const NOTHING: f64 = 700.0;

    /// Density of a normal whose slope in units of α has the square `e`, and whose cosine has the square `square`.
    #[inline(always)]
    fn at(&self, e: f64, square: f64) -> f64 {
        let [ax, ay] = self.alpha;
        // Also false for a vertical facet, whose `e` is infinite or NaN and whose `square` is 0.
        if e < Self::NOTHING { exp(-e) * FRAC_1_PI / (ax * ay * square * square) } else { 0.0 }
    }
}

impl Facets for Beckmann {
    #[inline(always)]
    fn new(alpha: [f64; 2]) -> Self {
        Self { alpha: alpha.map(|a| a.clamp(Self::SMOOTH, 1.0)) }
    }

    #[inline(always)]
    fn with(alpha: [f64; 2]) -> Self {
        Self { alpha }
    }

    #[inline(always)]
    fn alpha(&self) -> [f64; 2] {
        self.alpha
    }

    #[inline(always)]
    fn density(&self, h: DVec3) -> f64 {
        let [ax, ay] = self.alpha;
        let (x, y, square) = (h.x / ax, h.y / ay, h.z * h.z);
        self.at((x * x + y * y) / square, square)
    }

    /// From the unnormalized half vector, which has the same slopes.
    #[inline(always)]
    fn mirroring(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        let ([ax, ay], q) = (self.alpha, wo + wi);
        let length = q.length_squared();
        // The sum of nearly opposite directions in the tangent plane has no accurate direction.
        if length < 1e-60 {
            return (self.density(DVec3::Z), wo.z);
        }
        let (x, y, square) = (q.x / ax, q.y / ay, q.z * q.z);
        (self.at((x * x + y * y) / square, square / length), (0.5 * length.sqrt()).min(1.0))
    }

    #[inline(always)]
    fn stretch(&self, w: DVec3) -> f64 {
        let ([ax, ay], z) = (self.alpha, w.z.abs());
        let (x, y) = (ax * w.x, ay * w.y);
        let q = (x * x + y * y).sqrt();
        // From directly above nothing is masked.
        if z > 7.0 * q { z } else { z + q * complement_integral(z / q) }
    }

    /// Slopes along the direction to `wo` and across it are independent (Heitz and d'Eon, "Importance Sampling
    /// Microfacet-Based BSDFs using the Distribution of Visible Normals", 2014). Those across are sampled by inverting
    /// the error function, those along by `leaning`.
    #[inline(always)]
    fn sample_visible(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let [ax, ay] = self.alpha;
        let (x, y) = (ax * wo.x, ay * wo.y);
        let q = (x * x + y * y).sqrt();
        let (cos, sin) = if q > 0.0 { (x / q, y / q) } else { (1.0, 0.0) };
        let (along, across) = (leaning(wo.z, q, share(1.0 - u[1])), exceeded(share(u[0])));
        DVec3::new(ax * (cos * along - sin * across), ay * (sin * along + cos * across), 1.0).normalize()
    }
}

/// Clamps a random number so that the slope is finite.
#[inline(always)]
fn share(u: f64) -> f64 {
    u.clamp(1e-19, 1.0 - f64::EPSILON)
}

/// Slope towards a viewer at height `z` and distance `q` that a share `u` of the visible facets exceeds, 0 < u < 1.
///
/// The visible density of slope t is (z + q t) exp(−t²) where that is positive, so slopes above x have the share S(x) =
/// z erfc(x) / 2 + q exp(−x²) / (2 √π). Newton's method on ln S, which is decreasing and concave: from any start, one
/// step passes the solution, and each further step approaches it from there.
fn leaning(z: f64, q: f64, u: f64) -> f64 {
    let half = 0.5 * q * FRAC_1_SQRT_PI;
    // The total visible share, (z + s) / 2, and the logarithm of the target.
    let all = if z > 7.0 * q { z } else { z + 0.5 * q * complement_integral(z / q) };
    let wanted = (u * all).ln();
    // At the horizon the solution is √(−ln u); elsewhere the slope is less.
    let most = (-u.ln()).sqrt();
    let mut x = start(z, q, u, all, most);
    for _ in 0..STEPS {
        let tail = scaled_complement(x.abs());
        // S and its slope, both over exp(−x²), which cancels in their quotient; and the logarithm of S.
        let (left, logarithm) = if x >= 0.0 {
            let left = 0.5 * z * tail + half;
            (left, left.ln() - x * x)
        } else {
            let whole = (x * x).exp();
            let left = z * (whole - 0.5 * tail) + half;
            (left, (left / whole).ln())
        };
        let step = (logarithm - wanted) * left / ((z + q * x) * FRAC_1_SQRT_PI);
        let next = (x + step).min(most);
        // Newton's method converges quadratically, so the remaining error is about the square of the last step.
        if (next - x).abs() < 1e-6 {
            return next;
        }
        x = next;
    }
    x
}

/// Iteration limit. 3 or 4 iterations are typical, and some 30 if the share is 1 up to roundings.
const STEPS: usize = 64;

/// Start of the iteration: between the solutions for the horizon and for directly above or, if these are poor, near the
/// slope at which facets become visible.
fn start(z: f64, q: f64, u: f64, all: f64, most: f64) -> f64 {
    let above = z / (z + q);
    let guess = most + above * (exceeded(u) - most);
    if q * guess > -0.8 * z {
        return guess;
    }
    // Facets from there on leave out at least (x + a)² exp(−a²) q / (2 √π), a = z / q.
    let edge = z / q;
    let beyond = (2.0 * (1.0 - u) * all / (q * FRAC_1_SQRT_PI)).sqrt() * (0.5 * edge * edge).exp();
    (beyond - edge).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::chi_square::assert_frequencies;
    use std::f64::consts::PI;

    fn direction(cosine: f64, turn: f64) -> DVec3 {
        let sine = (1.0 - cosine * cosine).sqrt();
        DVec3::new(sine * turn.cos(), sine * turn.sin(), cosine)
    }

    const COSINES: [f64; 9] = [1.0, 0.99, 0.8, 0.5, 0.2, 0.05, 1e-3, 1e-6, 1e-30];

    /// Integral of a function over the facets' slopes in units of α, weighted by the distribution, by midpoints.
    fn over_slopes(reach: f64, steps: u32, f: impl Fn(f64, f64) -> f64) -> f64 {
        let step = 2.0 * reach / f64::from(steps);
        let at = |i: u32| -reach + (f64::from(i) + 0.5) * step;
        let weight = |x: f64, y: f64| FRAC_1_PI * (-x * x - y * y).exp() * step * step;
        (0..steps).flat_map(|i| (0..steps).map(move |j| (at(i), at(j)))).map(|(x, y)| weight(x, y) * f(x, y)).sum()
    }

    #[test]
    fn facets_cover_the_surface() {
        // ∫ D cos θ dω = 1 over slopes, where αx αy dx dy subtend a solid angle of cos³ θ.
        for alpha in [[0.001; 2], [0.1; 2], [1.0; 2], [0.02, 0.7]] {
            let facets = Beckmann::new(alpha);
            let step = 12.0 / 96.0;
            let mut sum = 0.0;
            for i in 0..96 * 96 {
                let (x, y) = (f64::from(i % 96) * step - 5.94, f64::from(i / 96) * step - 5.94);
                let h = DVec3::new(alpha[0] * x, alpha[1] * y, 1.0).normalize();
                sum += facets.density(h) * h.z.powi(4) * alpha[0] * alpha[1] * step * step;
            }
            assert!((sum - 1.0).abs() < 1e-12, "{alpha:?} {sum}");
        }
    }

    #[test]
    fn densities_are_those_of_the_formula() {
        // exp(−tan² θ / α²) / (π α² cos⁴ θ) (Walter et al., 2007).
        for (alpha, degrees) in [(0.1, 0.0f64), (0.1, 10.0), (0.5, 30.0), (1.0, 60.0), (0.9, 89.0)] {
            let cosine = degrees.to_radians().cos();
            let tangent = degrees.to_radians().tan();
            let expected = (-(tangent / alpha).powi(2)).exp() * FRAC_1_PI / (alpha * alpha * cosine.powi(4));
            let found = Beckmann::new([alpha; 2]).density(direction(cosine, 0.7));
            assert!((found / expected - 1.0).abs() < 1e-9 || expected < 1e-290, "{found} {expected}");
        }
        assert_eq!(Beckmann::new([0.1; 2]).density(DVec3::X), 0.0);
        assert_eq!(Beckmann::new([0.1; 2]).mirroring(DVec3::X, DVec3::X), (0.0, 1.0));
    }

    #[test]
    fn facets_that_mirror_are_those_of_the_half_vector() {
        for alpha in [[Beckmann::SMOOTH; 2], [0.01; 2], [0.3; 2], [1.0; 2], [1e-3, 0.7]] {
            let facets = Beckmann::new(alpha);
            for (cosine, turn) in
                [1.0, 0.9, 0.5, 0.1, 1e-3, 1e-9].into_iter().flat_map(|z| [0.0, 1.0, PI].map(|t| (z, t)))
            {
                let (wo, wi) = (direction(cosine, 0.3), direction(0.7 * cosine, 0.3 + turn));
                let h = (wo + wi).normalize();
                let (density, mirrored) = facets.mirroring(wo, wi);
                let known = 1e-15 / (wo + wi).length();
                // To the accuracy of the exponent, which is the squared slope over α.
                let slope = (h.x / alpha[0]).hypot(h.y / alpha[1]) / h.z;
                let bound = (1e-13 + 16.0 * known / alpha[0]) * (1.0 + slope) + 1e-15 * slope * slope;
                let expected = facets.density(h);
                assert!(
                    (density / expected - 1.0).abs() < bound || (expected < 1e-280 && density < 1e-270),
                    "{alpha:?} {wo} {wi} {density} {expected}"
                );
                assert!((mirrored - wo.dot(h)).abs() < 1e-15 + known, "{wo} {wi}");
            }
        }
        let (wo, wi) = (DVec3::new(1.0, 0.0, 1e-90), DVec3::new(-1.0, 0.0, 1e-90));
        assert_eq!(Beckmann::new([0.3; 2]).mirroring(wo, wi), (Beckmann::new([0.3; 2]).density(DVec3::Z), 1e-90));
    }

    #[test]
    fn masking_is_smiths() {
        // G₁ = cos θ over the projected area of facets that face the viewer, ∫ max(0, w · h) D dω; and s = 2 cos θ / G₁
        // − cos θ.
        for alpha in [[0.1; 2], [0.5; 2], [1.0; 2], [0.2, 0.9]] {
            let facets = Beckmann::new(alpha);
            for cosine in [1.0, 0.8, 0.3, 0.05, 1e-6] {
                let w = direction(cosine, 0.6);
                let facing = over_slopes(6.0, 1000, |x, y| (w.z + alpha[0] * w.x * x + alpha[1] * w.y * y).max(0.0));
                assert!((facets.masking(w) - cosine / facing).abs() < 2e-6, "{alpha:?} {cosine}");
                assert!((facets.stretch(w) - (2.0 * facing - w.z)).abs() < 2e-6, "{alpha:?} {cosine}");
            }
        }
        // 2 / (1 + erf(a) + exp(−a²) / (a √π)), a = 1 / (α tan θ) (Walter et al., 2007), with 12 digits.
        let truths = [(0.5, 0.5, 0.987_009_090_503), (1.0, 0.5, 0.874_897_597_220), (1.0, 0.1, 0.299_840_032_479)];
        for (alpha, cosine, truth) in truths {
            let found = Beckmann::new([alpha; 2]).masking(direction(cosine, 2.0));
            assert!((found - truth).abs() < 1e-11, "{alpha} {cosine} {found:.12}");
        }
        // At the horizon s is α / √π, and directly above 1.
        for alpha in [Beckmann::SMOOTH, 0.1, 1.0] {
            let facets = Beckmann::new([alpha; 2]);
            assert!((facets.stretch(DVec3::X) / (alpha * FRAC_1_SQRT_PI) - 1.0).abs() < 1e-10);
            assert_eq!(facets.stretch(DVec3::Z), 1.0);
        }
    }

    #[test]
    fn the_lean_exceeded_is_the_inverse() {
        let erfc = |x: f64| (-x * x).exp() * scaled_complement(x);
        for cosine in COSINES {
            for alpha in [1e-5, 1e-3, 0.1, 0.5, 1.0] {
                let (z, q) = (cosine, alpha * (1.0 - cosine * cosine).sqrt());
                let left = |x: f64| {
                    let upper = if x >= 0.0 { 0.5 * erfc(x) } else { 1.0 - 0.5 * erfc(-x) };
                    z * upper + 0.5 * q * FRAC_1_SQRT_PI * (-x * x).exp()
                };
                let all = if q > 0.0 && z < 7.0 * q { left(-z / q) } else { z };
                let mut last = f64::INFINITY;
                let tail = (3..20).rev().map(|k| 10f64.powi(-k));
                let head = (9..40).map(|k| 1.0 - 0.5f64.powi(k));
                for u in tail.chain((1..200).map(|k| f64::from(k) / 200.0)).chain(head) {
                    let x = leaning(z, q, u);
                    assert!(q * x >= -z * (1.0 + 1e-12) && x < last + 1e-9, "{cosine} {alpha} {u} {x} {last}");
                    let found = left(x) / all;
                    // A step of 10⁻¹² changes the share by 10⁻¹² times twice the slope.
                    assert!((found / u - 1.0).abs() < 1e-9, "{cosine} {alpha} {u} {x} {found}");
                    last = x;
                }
            }
        }
    }

    #[test]
    fn visible_facets_are_drawn_as_they_are_seen() {
        // Cells over slopes in units of α around the most visible facets, integrated from the density.
        for (alpha, cosine) in [([0.3; 2], 0.9), ([0.3; 2], 0.4), ([1.0; 2], 0.1), ([0.01; 2], 1e-3), ([0.1, 0.8], 0.3)]
            .into_iter()
            .chain([([1.0; 2], 1e-9), ([0.5; 2], 1.0)])
        {
            let (facets, wo) = (Beckmann::new(alpha), direction(cosine, 0.8));
            let (cells, reach, fine) = (12, 2.4, 12);
            let cell = |x: f64| ((x + reach) / (2.0 * reach) * f64::from(cells)).floor();
            let inside = |i: f64| (0.0..f64::from(cells)).contains(&i);
            let mut counts = vec![0; (cells * cells + 1) as usize];
            for number in 0..100_000 {
                let h = facets.sample_visible(wo, Sampler::new(6, 0, number).two(0));
                assert!((h.length() - 1.0).abs() < 1e-12 && h.z > 0.0 && wo.dot(h) > -1e-12);
                let (i, j) = (cell(h.x / h.z / alpha[0]), cell(h.y / h.z / alpha[1]));
                let at =
                    if inside(i) && inside(j) { i as usize * cells as usize + j as usize } else { counts.len() - 1 };
                counts[at] += 1;
            }
            let step = 2.0 * reach / f64::from(cells * fine);
            let mut expected = vec![0.0; counts.len()];
            for k in 0..cells * cells * fine * fine {
                let (i, j) = (k / (cells * fine), k % (cells * fine));
                let [x, y] = [i, j].map(|i| (f64::from(i) + 0.5) * step - reach);
                let h = DVec3::new(alpha[0] * x, alpha[1] * y, 1.0).normalize();
                let solid = alpha[0] * alpha[1] * step * step * h.z.powi(3);
                expected[(i / fine * cells + j / fine) as usize] += facets.visible_pdf(wo, h) * solid;
            }
            let sum: f64 = expected.iter().sum();
            *expected.last_mut().unwrap() = 1.0 - sum;
            assert!(sum < 1.0 && sum > 0.9, "{alpha:?} {cosine} {sum}");
            assert_frequencies(&counts, &expected);
        }
    }

    #[test]
    fn one_scattering_has_its_albedo() {
        // White facets, by quadrature over slopes.
        let truths = [
            (0.1, [1.0, 0.99985, 0.91291]),
            (0.3, [0.99971, 0.92329, 0.94146]),
            (0.5, [0.94300, 0.86936, 0.95503]),
            (1.0, [0.46159, 0.76657, 0.95280]),
        ];
        for (alpha, albedos) in truths {
            for (cosine, truth) in [1.0, 0.5, 0.1].into_iter().zip(albedos) {
                let (facets, wo) = (Beckmann::new([alpha; 2]), direction(cosine, 0.0));
                let mut sum = 0.0;
                for k in 0..400 * 400 {
                    let wi = facets.sample_reflection(wo, [k / 400, k % 400].map(|i| (f64::from(i) + 0.5) / 400.0));
                    if wi.z > 0.0 {
                        sum += facets.reflection_geometry(wo, wi) * 2.0 * (wo.z + facets.stretch(wo));
                    }
                }
                let albedo = sum / 160_000.0;
                assert!((albedo - truth).abs() < 2e-4, "{alpha} {cosine} {albedo}");
            }
        }
    }
}
