//! Transmittance of rough coats with single scattering.

use super::{Facets, fresnel};
use raywright_base::math::DVec3;
use raywright_base::math::gauss::gauss;

/// Transmittance of dielectric facets with single refraction and masking on both sides, for light from the thinner side
/// by its cosine, and the mean internal reflectance.
///
/// There is no closed form. It is integrated when a material is prepared, by Gauss's rules over visible facets, and
/// stored at `NODES` cosines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Through {
    alpha: f64,
    /// Weight of the part of the table variable that depends on α.
    weight: f64,
    shares: [f32; NODES],
    average: f32,
    within: f32,
}

/// Number of stored cosines. Interpolation is within 0.0025 of the integral for indices from 1.05 on, and mostly within
/// 0.001.
const NODES: usize = 20;

impl Through {
    /// Integrates isotropic facets; `eta` ≥ 1 is the inner over the outer index of refraction.
    pub fn new(facets: &impl Facets, eta: f64) -> Self {
        let eta = fresnel::bounded(eta);
        let (alpha, seen) = (facets.mean_alpha(), VisibleFacets::new(facets));
        let mut through =
            Self { alpha, weight: 0.6 * alpha.sqrt().sqrt(), shares: [0.0; NODES], average: 0.0, within: 0.0 };
        for i in 0..NODES {
            let cosine = through.cosine(i as f64 / (NODES - 1) as f64).max(1e-7);
            through.shares[i] = seen.refracted(direction(cosine), eta) as f32;
        }
        through.average = even_light(0.0, 1.0, |cosine| through.share(cosine)) as f32;
        // Internal transmission stops near the critical angle, so the integral is split there.
        let critical = ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / eta;
        let within = |cosine| seen.reflected(direction(cosine), 1.0 / eta);
        through.within = (even_light(0.0, critical, within) + even_light(critical, 1.0, within)) as f32;
        through
    }

    /// Interpolates between the transmittances of smoother and rougher facets.
    pub fn between(a: &Self, b: &Self, part: f64) -> Self {
        let mixed = |a: f64, b: f64| a + (b - a) * part;
        let single = |a: f32, b: f32| mixed(f64::from(a), f64::from(b)) as f32;
        let mut shares = a.shares;
        shares.iter_mut().zip(b.shares).for_each(|(share, other)| *share = single(*share, other));
        Self {
            alpha: mixed(a.alpha, b.alpha),
            weight: mixed(a.weight, b.weight),
            shares,
            average: single(a.average, b.average),
            within: single(a.within, b.within),
        }
    }

    /// Transmittance for a cosine, by cubic interpolation (Catmull and Rom, 1974).
    #[inline(always)]
    pub fn share(&self, cosine: f64) -> f64 {
        let at = self.variable(cosine).clamp(0.0, 1.0) * (NODES - 1) as f64;
        let low = (at as usize).min(NODES - 2);
        let f = at - low as f64;
        let value = |i: usize| f64::from(self.shares[i]);
        let (b, c) = (value(low), value(low + 1));
        // Beyond either end the curvature is continued.
        let a = if low == 0 { 3.0 * (b - c) + value(2) } else { value(low - 1) };
        let d = if low == NODES - 2 { 3.0 * (c - b) + value(NODES - 3) } else { value(low + 2) };
        let cubic = b + 0.5 * f * (c - a + f * (2.0 * a - 5.0 * b + 4.0 * c - d + f * (3.0 * (b - c) + d - a)));
        cubic.clamp(0.0, 1.0)
    }

    /// Cosine-weighted average of the transmittance.
    #[inline(always)]
    pub fn average(&self) -> f64 {
        f64::from(self.average)
    }

    /// Cosine-weighted average of the internal reflectance.
    #[inline(always)]
    pub fn within(&self) -> f64 {
        f64::from(self.within)
    }

    /// Table variable from 0 to 1 for a cosine: dense at grazing incidence, and around α.
    #[inline(always)]
    fn variable(&self, c: f64) -> f64 {
        let square = self.alpha * self.alpha;
        (1.0 - self.weight) * c.sqrt() + self.weight * c * ((1.0 + square) / (c * c + square)).sqrt()
    }

    /// Cosine of a table variable.
    fn cosine(&self, variable: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.variable(middle) < variable { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

fn direction(cosine: f64) -> DVec3 {
    DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine)
}

/// Cosine-weighted integral between two cosines, ∫ f(μ) 2μ dμ, dense at both.
fn even_light(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let length = to - from;
    let term = |(t, weight): (f64, f64)| {
        let cosine = from + length * t * t * (3.0 - 2.0 * t);
        weight * 6.0 * t * (1.0 - t) * length * 2.0 * cosine * f(cosine)
    };
    gauss(32).into_iter().map(term).sum()
}

/// Visible facets at the points of Gauss's rules.
struct VisibleFacets<'a, F> {
    facets: &'a F,
    /// Random numbers of the facets, and weights.
    draws: Vec<([f64; 2], f64)>,
}

impl<'a, F: Facets> VisibleFacets<'a, F> {
    const ACROSS: usize = 16;
    const ALONG: usize = 32;

    fn new(facets: &'a F) -> Self {
        let along = gauss(Self::ALONG);
        // The first number is symmetric about the xz plane; the tail of the second is stretched, 1 − u = t³.
        let draw = |x: f64, across: f64, t: f64, along: f64| ([0.5 * x, 1.0 - t * t * t], across * along * 3.0 * t * t);
        let of_row = |(x, across): (f64, f64)| along.iter().map(move |&(t, along)| draw(x, across, t, along));
        let draws = gauss(Self::ACROSS).into_iter().flat_map(of_row).collect();
        Self { facets, draws }
    }

    /// Mean of a function of the facets' normals, over the facets visible from `w` in the xz plane.
    fn mean(&self, w: DVec3, value: impl Fn(DVec3) -> f64) -> f64 {
        self.draws.iter().map(|&(u, weight)| weight * value(self.facets.sample_visible(w, u))).sum()
    }

    /// Transmittance for direction `w`; the index is that beyond over that on the side of `w`.
    fn refracted(&self, w: DVec3, eta: f64) -> f64 {
        self.mean(w, |h| match fresnel::refract(w, h, eta) {
            Some(wi) if wi.z < 0.0 => (1.0 - fresnel::dielectric(w.dot(h), eta)) * self.facets.masking(wi),
            _ => 0.0,
        })
    }

    /// Reflectance for direction `w`.
    fn reflected(&self, w: DVec3, eta: f64) -> f64 {
        self.mean(w, |h| {
            let wi = h * (2.0 * w.dot(h)) - w;
            if wi.z > 0.0 { fresnel::dielectric(w.dot(h), eta) * self.facets.masking(wi) } else { 0.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Beckmann, Ggx};

    #[test]
    fn shares_are_the_integrals() {
        // By quadrature over slopes (Beckmann) and over caps (GGX), at cosines of 0.001, 0.1, 0.5 and 1.
        let beckmann = [
            (0.05, [0.21770, 0.45529, 0.91037, 0.96000]),
            (0.3, [0.67689, 0.73148, 0.90133, 0.95977]),
            (1.0, [0.59798, 0.67396, 0.86618, 0.94737]),
        ];
        let ggx = [
            (0.05, [0.43314, 0.51114, 0.90917, 0.95980]),
            (0.3, [0.63730, 0.71433, 0.88635, 0.95279]),
            (1.0, [0.26733, 0.36103, 0.65142, 0.88064]),
        ];
        for i in 0..3 {
            for (through, truths) in [
                (Through::new(&Beckmann::new([beckmann[i].0; 2]), 1.5), beckmann[i].1),
                (Through::new(&Ggx::new([ggx[i].0; 2]), 1.5), ggx[i].1),
            ] {
                for (cosine, truth) in [1e-3, 0.1, 0.5, 1.0].into_iter().zip(truths) {
                    let found = through.share(cosine);
                    assert!((found - truth).abs() < 2.5e-3, "{through:?} {cosine} {found} {truth}");
                }
            }
        }
    }

    #[test]
    fn hardly_rough_is_smooth() {
        for eta in [1.01, 1.33, 1.5, 3.0] {
            let through = Through::new(&Beckmann::new([1e-4; 2]), eta);
            for cosine in [0.05, 0.3, 0.7, 1.0] {
                assert!(
                    (through.share(cosine) - 1.0 + fresnel::dielectric(cosine, eta)).abs() < 2.5e-3,
                    "{eta} {cosine}"
                );
            }
            assert!((through.average() - 1.0 + fresnel::dielectric_average(eta)).abs() < 1e-3, "{eta}");
            assert!(
                (through.within() - fresnel::dielectric_average(1.0 / eta)).abs() < 3e-3,
                "{eta} {}",
                through.within()
            );
        }
    }

    #[test]
    fn what_goes_in_and_out_and_is_reflected_is_no_more_than_all() {
        // Diffuse transmittance from inside equals that from outside over η² (Stokes, 1849). The rest is lost, and the
        // loss grows with the roughness of the coat.
        let kept = |through: Through, eta: f64| through.within() + through.average() / (eta * eta);
        for eta in [1.05, 1.5, 2.5] {
            let mut last = [1.002; 2];
            for alpha in [0.01, 0.1, 0.3, 0.6, 1.0] {
                let (ggx, beckmann) = (Ggx::new([alpha; 2]), Beckmann::new([alpha; 2]));
                let now = [kept(Through::new(&ggx, eta), eta), kept(Through::new(&beckmann, eta), eta)];
                assert!(now[0] < last[0] && now[1] < last[1] + 1e-3, "{alpha} {eta} {now:?} {last:?}");
                assert!(now[1] > now[0] && now[0] > 0.2, "{alpha} {eta} {now:?}");
                last = now;
            }
        }
    }

    #[test]
    fn between_two_is_what_lies_between() {
        let [a, b, exact] =
            [13.0, 14.0, 13.5].map(|root: f64| Through::new(&Ggx::new([(root / 24.0).powi(2); 2]), 1.5));
        let mixed = Through::between(&a, &b, 0.5);
        for cosine in [0.01, 0.2, 0.9] {
            let (found, truth) = (mixed.share(cosine), exact.share(cosine));
            assert!((found - truth).abs() < 1.5e-3, "{cosine} {found} {truth}");
        }
        assert!((mixed.within() - exact.within()).abs() < 1e-3);
    }
}
