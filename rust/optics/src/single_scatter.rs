//! Single-scattering facets.

use super::Facets;
use raywright_base::math::{DVec3, InLanes};

/// Facets with uncorrelated masking and shadowing, G₂ = G₁(wo) G₁(wi), and no compensation of interreflection: the
/// original model of Walter et al. ("Microfacet Models for Refraction through Rough Surfaces", 2007).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Once<F>(F);

impl<F: InLanes> InLanes for Once<F> {
    type Lanes = F::Lanes;
    const EMPTY: F::Lanes = F::EMPTY;

    #[inline(always)]
    fn get(lanes: &F::Lanes, lane: usize) -> Self {
        Self(F::get(lanes, lane))
    }

    #[inline(always)]
    fn put(&self, lanes: &mut F::Lanes, lane: usize) {
        self.0.put(lanes, lane);
    }
}

impl<F: Facets> Facets for Once<F> {
    #[inline(always)]
    fn new(alpha: [f64; 2]) -> Self {
        Self(F::new(alpha))
    }

    #[inline(always)]
    fn with(alpha: [f64; 2]) -> Self {
        Self(F::with(alpha))
    }

    #[inline(always)]
    fn alpha(&self) -> [f64; 2] {
        self.0.alpha()
    }

    #[inline(always)]
    fn density(&self, h: DVec3) -> f64 {
        self.0.density(h)
    }

    #[inline(always)]
    fn mirroring(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        self.0.mirroring(wo, wi)
    }

    #[inline(always)]
    fn stretch(&self, w: DVec3) -> f64 {
        self.0.stretch(w)
    }

    #[inline(always)]
    fn sample_visible(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        self.0.sample_visible(wo, u)
    }

    #[inline(always)]
    fn reflection_geometry(&self, wo: DVec3, wi: DVec3) -> f64 {
        // For either direction, G₁ = 2 z / (z + s).
        wi.z / ((wo.z + self.stretch(wo)) * (wi.z + self.stretch(wi)))
    }

    #[inline(always)]
    fn refraction_geometry(&self, wo: DVec3, wi: DVec3) -> [f64; 2] {
        let seen = 2.0 / (wo.z.abs() + self.stretch(wo));
        [seen, seen * self.masking(wi)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Beckmann, Ggx};
    use super::*;

    /// By midpoints over visible facets, with a stretched tail: 1 − u is this power.
    fn albedo(facets: &impl Facets, cosine: f64, power: i32) -> f64 {
        let wo = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let mut sum = 0.0;
        for k in 0..400 * 400 {
            let [v, t] = [k / 400, k % 400].map(|i| (f64::from(i) + 0.5) / 400.0);
            let wi = facets.sample_reflection(wo, [v, 1.0 - t.powi(power)]);
            if wi.z > 0.0 {
                sum += f64::from(power)
                    * t.powi(power - 1)
                    * facets.reflection_geometry(wo, wi)
                    * 2.0
                    * (wo.z + facets.stretch(wo));
            }
        }
        sum / 160_000.0
    }

    #[test]
    fn one_scattering_has_its_albedo() {
        // White facets, by quadratures over slopes and over visible facets; for GGX compare Heitz et al. (2016).
        let truths = [
            (0.1, [0.98831, 0.96912, 0.87275], [1.0, 0.99985, 0.91232]),
            (0.3, [0.87736, 0.81813, 0.84233], [0.99971, 0.92329, 0.93141]),
            (0.5, [0.68786, 0.68601, 0.77228], [0.94300, 0.86894, 0.93609]),
            (1.0, [0.30685, 0.40914, 0.55791], [0.46159, 0.75630, 0.90193]),
        ];
        for (alpha, ggx, beckmann) in truths {
            for (i, cosine) in [1.0, 0.5, 0.1].into_iter().enumerate() {
                let found = albedo(&Once::<Ggx>::new([alpha; 2]), cosine, 4);
                assert!((found - ggx[i]).abs() < 2e-4, "{alpha} {cosine} {found}");
                let found = albedo(&Once::<Beckmann>::new([alpha; 2]), cosine, 1);
                assert!((found - beckmann[i]).abs() < 2e-4, "{alpha} {cosine} {found}");
            }
        }
    }

    #[test]
    fn masking_and_shadowing_are_independent() {
        let wo = DVec3::new(0.6, 0.0, 0.8);
        for height in [0.9, 0.1, 1e-9] {
            let wi = DVec3::new(0.0, (1.0f64 - height * height).sqrt(), height);
            let (once, all) = (Once::<Beckmann>::new([0.4, 0.9]), Beckmann::new([0.4, 0.9]));
            let both = all.masking(wo) * all.masking(wi);
            assert!((once.reflection_geometry(wo, wi) * 4.0 * wo.z / both - 1.0).abs() < 1e-12);
            assert!(once.reflection_geometry(wo, wi) <= all.reflection_geometry(wo, wi));
            let [seen, through] = once.refraction_geometry(wo, -wi);
            assert!((seen * wo.z / all.masking(wo) - 1.0).abs() < 1e-12);
            assert!((through * wo.z / both - 1.0).abs() < 1e-12);
        }
    }
}
