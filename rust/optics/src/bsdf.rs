//! Interface of bidirectional scattering distribution functions (BSDFs), and their samples.

use super::Rgb;
use glam::DVec3;

/// The bidirectional scattering distribution function at a point of a surface.
///
/// Directions are unit vectors in the shading frame, with z along the normal. Both point away from the surface: `wo`
/// towards the viewer, `wi` towards the light. BRDFs reflect on both sides. The sign of `wo.z` tells a transmissive
/// BSDF the side: above (z > 0) or below.
///
/// Values are for radiance: across an interface, values and sample weights include the factor 1 / η², with η the index
/// of refraction on the side of `wi` over that on the side of `wo` (Veach, "Robust Monte Carlo Methods for Light
/// Transport Simulation", 1997, 5.2).
pub trait Bsdf {
    /// Evaluates the function times |cos θ| of `wi`, and the density of [`Bsdf::sample`] for `wi` by solid angle. Delta
    /// components are excluded from both. One call computes both, because callers mostly need both and they share work.
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64);

    /// Samples an incident direction. `choice`, uniform in [0, 1), selects the lobe and is called only if there are
    /// several; `u` selects the direction. Returns `None` if the sample scatters nothing. Delta lobes have the smallest
    /// choice numbers.
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample>;

    /// Approximate albedo for white light; its cosine-weighted average if known.
    fn albedo(&self) -> Rgb;

    /// Factor for light that such a surface has reflected before; 1 unless a channel's reflectance exceeds 1
    /// ([`super::conductors::Curve::repeat_correction`]).
    #[inline(always)]
    fn repeat_correction(&self) -> Rgb {
        Rgb::ONE
    }

    /// Returns whether all components are deltas, so that [`Bsdf::evaluate`] is 0 everywhere.
    #[inline(always)]
    fn is_delta(&self) -> bool {
        false
    }

    /// Returns whether light is transmitted.
    #[inline(always)]
    fn transmits(&self) -> bool {
        false
    }

    /// Roughness of the sharpest lobe, as the α of a microfacet distribution: 0 for a delta lobe, 1 for a hemispherical
    /// one.
    #[inline(always)]
    fn roughness(&self) -> f64 {
        1.0
    }

    /// Reflectance of a Lambertian BRDF; `None` for others.
    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        None
    }
}

/// A borrowed BSDF.
impl<B: Bsdf> Bsdf for &B {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        (**self).evaluate(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        (**self).sample(wo, choice, u)
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        (**self).albedo()
    }

    #[inline(always)]
    fn repeat_correction(&self) -> Rgb {
        (**self).repeat_correction()
    }

    #[inline(always)]
    fn is_delta(&self) -> bool {
        (**self).is_delta()
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        (**self).transmits()
    }

    #[inline(always)]
    fn roughness(&self) -> f64 {
        (**self).roughness()
    }

    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        (**self).diffuse()
    }
}

/// A sampled direction of a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Incident direction, in the shading frame; or in the world if a surface interaction sampled it.
    pub wi: DVec3,
    /// BSDF times cosine over density, the factor on the path's throughput.
    pub weight: Rgb,
    /// Density by solid angle. It is infinite for a delta direction, so that MIS gives the sample all the weight.
    pub pdf: f64,
    /// Index of refraction on the side of `wi` over that on the side of `wo`; 1 unless light is refracted. The weight
    /// includes 1 / eta², which Russian roulette should not count as energy loss.
    pub eta: f64,
    /// True if `wi` is on the opposite side from `wo`.
    pub is_through: bool,
    /// Half-open range of choice numbers that select its lobe.
    pub choices: [f64; 2],
}

impl BsdfSample {
    /// A sample of the only lobe, on the side of `wo`.
    #[inline(always)]
    pub fn new(wi: DVec3, weight: Rgb, pdf: f64) -> Self {
        Self { wi, weight, pdf, eta: 1.0, is_through: false, choices: [0.0, 1.0] }
    }

    /// A delta sample of the only lobe, on the side of `wo`.
    #[inline(always)]
    pub(super) fn delta(wi: DVec3, weight: Rgb) -> Self {
        Self::new(wi, weight, f64::INFINITY)
    }

    /// Marks the sample as transmitted into a medium with `eta` times the index of refraction.
    #[inline(always)]
    pub(super) fn through(self, eta: f64) -> Self {
        Self { eta, is_through: true, ..self }
    }

    /// Sets the range of choice numbers of its lobe.
    #[inline(always)]
    pub(super) fn of_lobe(self, choices: [f64; 2]) -> Self {
        Self { choices, ..self }
    }

    /// Probability of its lobe.
    #[inline]
    pub fn probability(&self) -> f64 {
        self.choices[1] - self.choices[0]
    }

    /// Returns whether it is a delta direction.
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.pdf == f64::INFINITY
    }
}

/// Choice numbers of the first of two lobes, which has this probability, or of the second.
#[inline(always)]
pub(super) fn either(first: f64, is_first: bool) -> [f64; 2] {
    if is_first { [0.0, first] } else { [first, 1.0] }
}
