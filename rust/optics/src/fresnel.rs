//! Fresnel's equations.

use super::Rgb;
use glam::DVec3;

/// Reflectance of a dielectric for unpolarized light (Fresnel, 1823), at a `cosine` of incidence, 0 to 1. `eta` is the
/// index of refraction beyond the interface over that before it. The result is 1 beyond the critical angle.
///
/// Differences of nearly equal terms are avoided: with e = η² − 1 and g = η cos θt = √(e + c²), c − g is −e / (c + g).
/// So the relative error is some 10⁻¹⁵ however close η is to 1.
#[inline(always)]
pub fn dielectric(cosine: f64, eta: f64) -> f64 {
    let (c, e) = (cosine, (eta - 1.0) * (eta + 1.0));
    let square = e + c * c;
    // Both are computed and one is selected, because lanes have no branches.
    let g = square.sqrt();
    let sum = c + g;
    let s = e / (sum * sum);
    let p = e * (c * sum - 1.0) / (sum * (eta * eta * c + g));
    let partial = 0.5 * (s * s + p * p);
    // At η = 1 and exactly grazing incidence there is no reflection.
    let all = if e == 0.0 { 0.0 } else { 1.0 };
    if square <= 0.0 { all } else { partial }
}

/// Clamps a relative index of refraction to 10⁻⁶ to 10⁶. Beyond these, all but some 10⁻⁵ of light is reflected, and
/// squares soon overflow.
#[inline(always)]
pub fn bounded(eta: f64) -> f64 {
    eta.clamp(1e-6, 1e6)
}

/// Incident direction of light that leaves along `wo` after refraction at a facet with unit normal `h`, on the side of
/// `wo`. `eta` is the index of refraction on the far side over that on the side of `wo`. Returns `None` under total
/// reflection. The direction is normalized as accurately as `wo` and `h`, and its difference from −`wo` is accurate
/// even if `eta` is close to 1.
#[inline]
pub fn refract(wo: DVec3, h: DVec3, eta: f64) -> Option<DVec3> {
    let (wi, is_total) = refracted(wo, h, eta);
    (!is_total).then_some(wi)
}

/// Branch-free refraction: a direction, and true under total reflection.
#[inline(always)]
pub(super) fn refracted(wo: DVec3, h: DVec3, eta: f64) -> (DVec3, bool) {
    let (c, e) = (wo.dot(h), (eta - 1.0) * (eta + 1.0));
    let square = e + c * c;
    (-(wo + h * (e / (c + square.sqrt()))) / eta, square <= 0.0)
}

/// Cosine-weighted average of a dielectric's reflectance, ∫ 2 F(μ) μ dμ, in closed form (Walsh, 1926; Duntley, 1942).
/// `eta` is the index of refraction beyond the interface over that before it. The relative error is below 2e-3 from η =
/// 1 + 1e-9 on, and below 1e-9 from η = 1.01 on.
pub fn dielectric_average(eta: f64) -> f64 {
    if eta < 1.0 {
        // Transmission is equal in both directions, except for the solid angle, which is η² times larger in the denser
        // medium.
        return 1.0 - (1.0 - dielectric_average(1.0 / eta)) * eta * eta;
    }
    let n = eta;
    if n - 1.0 < 1e-4 {
        // The closed form cancels here. To first order in e = η² − 1, the factor is ∫ 2 t (√(1 + t²) − t)⁴ dt = 1/6.
        return (n - 1.0) * (n + 1.0) / 6.0;
    }
    if n > 1e4 {
        // 1 − 16 / (3η) to first order, which avoids high powers of η.
        return 1.0 - 16.0 / (3.0 * n);
    }
    let (n2, n4) = (n * n, n * n * n * n);
    let plus = n2 + 1.0;
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * (n2 - 1.0).powi(2) / plus.powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / (plus * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / (plus * (n4 - 1.0).powi(2)) * n.ln()
}

/// The square of a conductor's index of refraction η + ik.
#[derive(Clone, Copy, Debug)]
pub struct ConductorIndex {
    /// Real part, η² − k².
    real: Rgb,
    /// Square of the imaginary part, 4 η² k².
    imaginary2: Rgb,
}

impl ConductorIndex {
    /// Creates it from `eta` + i `k` relative to the surroundings, per channel.
    #[inline]
    pub fn new(eta: Rgb, k: Rgb) -> Self {
        let (eta2, k2) = (eta * eta, k * k);
        Self { real: eta2 - k2, imaginary2: 4.0 * eta2 * k2 }
    }

    /// Creates it from its parts.
    #[inline(always)]
    pub(super) fn with([real, imaginary2]: [Rgb; 2]) -> Self {
        Self { real, imaginary2 }
    }

    /// Its parts.
    #[inline(always)]
    pub(super) fn parts(&self) -> [Rgb; 2] {
        [self.real, self.imaginary2]
    }

    /// Reflectance of unpolarized light at a `cosine` of incidence (Born and Wolf, "Principles of Optics", 14.2).
    #[inline(always)]
    pub fn reflectance(&self, cosine: f64) -> Rgb {
        let (c, c2) = (cosine, cosine * cosine);
        let s2 = (1.0 - c) * (1.0 + c);
        let real = self.real - s2;
        // a² + b² = |η² − sin²θ| for the complex η.
        let norm = root(real * real + self.imaginary2);
        let a = root(((norm + real) * 0.5).at_least(Rgb::ZERO));
        // One polarization is (sum − twice) / (sum + twice), and the other is that times (even − odd) / (even + odd);
        // this is their mean.
        let (sum, twice) = (norm + c2, 2.0 * c * a);
        let (even, odd) = (c2 * norm + s2 * s2, s2 * twice);
        ((sum - twice) * even / ((sum + twice) * (even + odd))).clamp(Rgb::ZERO, Rgb::ONE)
    }

    /// Cosine-weighted average of the reflectance, by Gauss's four-point rule for the weight 2μ. The error is below
    /// 1e-3 for the metals in [`super::conductors`].
    pub fn average(&self) -> Rgb {
        let mut sum = Rgb::ZERO;
        for (node, weight) in GAUSS_COSINE {
            sum += weight * self.reflectance(node);
        }
        sum
    }
}

/// Square roots of all channels.
#[inline(always)]
fn root(x: Rgb) -> Rgb {
    Rgb::new(x[0].sqrt(), x[1].sqrt(), x[2].sqrt())
}

/// Reflectance of a conductor with index `eta` + i `k`; see [`ConductorIndex::reflectance`].
#[inline]
pub fn conductor(cosine: f64, eta: Rgb, k: Rgb) -> Rgb {
    ConductorIndex::new(eta, k).reflectance(cosine)
}

/// Nodes and weights of Gauss's rule on [0, 1] for the weight function 2μ: exact up to μ⁷.
const GAUSS_COSINE: [(f64, f64); 4] = [
    (0.139_759_864_343_780_57, 0.062_361_941_900_016_116),
    (0.416_409_567_631_083_17, 0.259_695_095_216_464_94),
    (0.723_156_986_361_876_2, 0.406_929_136_020_543),
    (0.942_895_803_885_482_3, 0.271_013_826_862_976_04),
];

/// Schlick's weight between a reflectance at normal incidence and 1 ("An Inexpensive BRDF Model for Physically-based
/// Rendering", 1994): F = F₀ + (1 − F₀) (1 − cos θ)⁵.
#[inline(always)]
pub fn schlick_weight(cosine: f64) -> f64 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's approximation for a reflectance `f0` at normal incidence.
#[inline(always)]
pub fn schlick(cosine: f64, f0: Rgb) -> Rgb {
    schlick_between(cosine, f0, 1.0)
}

/// Schlick's approximation with a reflectance `f90` at grazing incidence.
#[inline(always)]
pub fn schlick_between(cosine: f64, f0: Rgb, f90: f64) -> Rgb {
    f0 + (Rgb::splat(f90) - f0) * schlick_weight(cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_reflects_as_in_born_and_wolf() {
        // n = 1.5 by Fresnel's equations, from outside and from inside.
        let truths = [(0.0, 0.04), (30.0, 0.041522626), (45.0, 0.050239911), (56.309932474, 0.073964497)];
        let grazing = [(60.0, 0.089186713), (75.0, 0.253060563), (85.0, 0.612799645), (89.99, 0.998985895)];
        for (degrees, truth) in truths.into_iter().chain(grazing) {
            assert!((dielectric(f64::to_radians(degrees).cos(), 1.5) - truth).abs() < 1e-9, "{degrees}");
        }
        for (degrees, truth) in
            [(0.0, 0.04), (30.0, 0.055190167), (41.0, 0.379751266), (41.8, 0.890771921), (42.0, 1.0)]
        {
            assert!((dielectric(f64::to_radians(degrees).cos(), 1.0 / 1.5) - truth).abs() < 2e-9, "{degrees}");
        }
    }

    #[test]
    fn keeps_its_digits_near_index_one_and_at_the_critical_angle() {
        // At normal incidence it is ((η − 1) / (η + 1))².
        for less in [1e-3f64, 1e-7, 1e-12] {
            let eta = 1.0 + less;
            let truth = ((eta - 1.0) / (eta + 1.0)).powi(2);
            assert!((dielectric(1.0, eta) / truth - 1.0).abs() < 1e-13);
        }
        for cosine in [0.0, 1e-300, 0.5, 1.0] {
            assert_eq!(dielectric(cosine, 1.0), 0.0);
        }
        for eta in [1.0f64 + 1e-7, 1.5, 10.0] {
            let critical = ((eta - 1.0) * (eta + 1.0)).sqrt() / eta;
            for near in [critical.next_down(), critical, critical.next_up()] {
                // 1 − F varies as the square root of the distance.
                assert!((dielectric(near, 1.0 / eta) - 1.0).abs() < 1e-3);
            }
            assert_eq!(dielectric(critical * 0.99, 1.0 / eta), 1.0);
        }
    }

    #[test]
    fn both_ways_reflect_alike() {
        // Reflectance at θ equals that at the refracted angle from the other side (Stokes, 1849).
        for eta in [1.0 + 1e-9, 1.3, 4.0] {
            for cosine in [1e-6, 0.1, 0.7, 1.0f64] {
                let wo = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                let wi = refract(wo, DVec3::Z, eta).unwrap();
                assert!((wi.length() - 1.0).abs() < 1e-15 && (wo.x + eta * wi.x).abs() < 1e-15);
                let (one, two) = (dielectric(cosine, eta), dielectric(-wi.z, 1.0 / eta));
                assert!((one / two - 1.0).abs() < 1e-6, "{one} {two}");
            }
        }
        assert!((refract(DVec3::new(0.5, 0.0, 0.75f64.sqrt()), DVec3::Z, 1.5).unwrap().x + 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn averages_are_the_integrals() {
        // Walsh's and Duntley's value for 1.5.
        assert!((dielectric_average(1.5) - 0.09177795934235121).abs() < 1e-12);
        for eta in [1.0 + 1e-8, 1.00005, 1.0002, 1.01, 1.33, 3.0, 50.0, 2e4] {
            // Midpoints in t with μ = t³, dense where an index near 1 reflects.
            let steps = 200_000;
            let mean: f64 = (0..steps)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(steps);
                    6.0 * t.powi(5) * dielectric(t.powi(3), eta) / f64::from(steps)
                })
                .sum();
            let bound = if eta < 1.001 { 2e-3 } else { 2e-7 };
            assert!((dielectric_average(eta) / mean - 1.0).abs() < bound, "{eta} {mean} {}", dielectric_average(eta));
            let within = 1.0 - (1.0 - mean) / (eta * eta);
            assert!((dielectric_average(1.0 / eta) - within).abs() < 1e-7);
        }
        assert_eq!(dielectric_average(1.0), 0.0);
    }

    #[test]
    fn metals_reflect_as_in_born_and_wolf() {
        let (eta, k) = (Rgb::splat(0.2), Rgb::splat(3.9));
        assert!((conductor(1.0, eta, k)[0] - 0.9519519519519519).abs() < 1e-14);
        let truth = 0.5 * (0.991742522 + 0.905072375);
        assert!((conductor(f64::to_radians(80.0).cos(), eta, k)[0] - truth).abs() < 1e-9);
        // A conductor without absorption is a dielectric.
        for cosine in [0.0, 0.01, 0.4, 1.0] {
            let one = conductor(cosine, Rgb::splat(1.7), Rgb::ZERO)[1];
            assert!((one - dielectric(cosine, 1.7)).abs() < 1e-14);
        }
    }
}
