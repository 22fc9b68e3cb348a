//! Share of a facet's light that no other facet blocks.

use super::above;
use crate::{Facets, fresnel};
use glam::DVec3;

/// Share of the facets about `h` whose light escapes on both sides, reflected or refracted. The four directions are
/// `wo`, its mirror image, and the two directions that these refract to; `eta` is the index beyond over that on the
/// side of `wo`. The share is the same from all four.
///
/// It is the smaller of the shares visible to reflections on both sides, and thus at most that of refractions.
pub fn openness<F: Facets>(facets: &F, wo: DVec3, h: DVec3, eta: f64) -> f64 {
    let Some(through) = fresnel::refract(wo, h, eta) else { return 0.0 };
    let mirrored = |w: DVec3| h * (2.0 * w.dot(h)) - w;
    let on = |w: DVec3| {
        let other = mirrored(w);
        let seen = || facets.reflection_geometry(above(w), above(other)) * 4.0 * w.z.abs();
        if w.z * other.z > 0.0 && F::sees(w) && F::sees(other) { seen() } else { 0.0 }
    };
    if through.z * wo.z < 0.0 { on(wo).min(on(through)) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Beckmann, Ggx};
    use raywright_base::sampling::Sampler;

    fn is_the_same_for_all_four<F: Facets>() {
        let mut open = 0;
        for number in 0..400 {
            let mut sampler = Sampler::new(5, 0, number);
            let facets = F::new([0.1 + 0.9 * sampler.one(0); 2]);
            let (eta, [a, b]) = (1.1 + sampler.one(1), sampler.two(2));
            let wo = DVec3::new((1.0 - a * a).sqrt(), 0.0, a);
            let h = facets.sample_visible(wo, [b, sampler.one(4)]);
            let through = fresnel::refract(wo, h, eta).unwrap();
            let mirrored = |w: DVec3| h * (2.0 * w.dot(h)) - w;
            let share = openness(&facets, wo, h, eta);
            open += i32::from(share > 0.0);
            // From below, the facet has the opposite normal and the index is inverted.
            for (w, h, eta) in [(mirrored(wo), h, eta), (through, -h, 1.0 / eta), (mirrored(through), -h, 1.0 / eta)] {
                assert!((openness(&facets, w, h, eta) - share).abs() < 1e-9, "{wo} {h} {eta}");
            }
            // It does not exceed the share of any path.
            let other = mirrored(wo);
            if other.z > 0.0 {
                assert!(share <= facets.reflection_geometry(wo, other) * 4.0 * wo.z + 1e-12);
            }
            if through.z < 0.0 {
                assert!(share <= facets.refraction_geometry(wo, through)[1] * wo.z + 1e-12);
            }
        }
        assert!(open > 200);
    }

    #[test]
    fn facets_are_as_open_to_all_four_ways() {
        is_the_same_for_all_four::<Ggx>();
        is_the_same_for_all_four::<Beckmann>();
    }
}
