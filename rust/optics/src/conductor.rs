//! Conductors.

mod conductor_lanes;

use super::bsdf::either;
use super::conductors::{Metal, Reflectance};
use super::energy_loss::{Lossy, Lost};
use super::fresnel::ConductorIndex;
use super::lobes::Grazing;
use super::mirror::mirrored;
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

/// A conductor, smooth or with microfacets. Energy lost to interreflection between facets is compensated if the facets
/// provide their loss (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017). The BRDF is
/// reciprocal, and a perfect conductor is white at every roughness. Both sides reflect.
///
/// A measured metal has a spectral color ([`super::conductors::Curve`]) for single and multiple scattering, and a
/// channel may exceed 1.
#[derive(Clone, Copy, Debug)]
pub struct Conductor<F: Lossy = Ggx> {
    fresnel: Reflectance,
    rough: Option<RoughFacets<F>>,
}

#[derive(Clone, Copy, Debug)]
struct RoughFacets<F: Lossy> {
    facets: F,
    loss: F::Mirror,
    /// Directional distribution of multiple scattering.
    grazing: Grazing,
    /// Multiple scattering, over π and the mean loss.
    multiple: Rgb,
}

impl<F: Lossy> RoughFacets<F> {
    /// Value and density between two directions above, from the result of [`Facets::mirroring`], the reflectance there,
    /// and the losses of both directions.
    #[inline(always)]
    fn scattered(
        (facets, multiple, grazing): (&F, Rgb, &Grazing),
        [wo, wi]: [DVec3; 2],
        (density, reflectance): (f64, Rgb),
        [lost, lost_there]: [f64; 2],
    ) -> (Rgb, f64) {
        let single = density * facets.reflection_geometry(wo, wi);
        let value = reflectance * single + multiple * (lost * lost_there * wi.z);
        (value, (1.0 - lost) * facets.reflected_pdf(wo, density) + lost * grazing.pdf(wi.z))
    }
}

impl Conductor {
    /// Creates a conductor with complex index `eta` + i `k` relative to its surroundings, and GGX roughness along x and
    /// y, 0 to 1. Below [`Facets::SMOOTH`] it is specular.
    pub fn new(eta: Rgb, k: Rgb, alpha: [f64; 2]) -> Self {
        Self::of(Reflectance::Index(ConductorIndex::new(eta, k)), Ggx::rough(alpha))
    }

    /// Creates a measured metal in a medium of index `outside`, with GGX roughness.
    pub fn metal(metal: &'static Metal, outside: f64, alpha: [f64; 2]) -> Self {
        Self::of(Reflectance::of(metal, outside), Ggx::rough(alpha))
    }
}

impl<F: Lossy> Conductor<F> {
    /// Creates a conductor from its smooth reflectance and facets; specular without facets.
    pub fn of(fresnel: Reflectance, facets: Option<F>) -> Self {
        let rough = facets.map(|facets| {
            let loss = facets.mirror();
            let lost = loss.average();
            let multiple = fresnel.seen(|mean| made_up_of(lost, mean)).at_least(Rgb::ZERO);
            RoughFacets { facets, loss, grazing: Grazing::new(facets.mean_alpha()), multiple }
        });
        Self { fresnel, rough }
    }

    /// Reflectance at this cosine of incidence.
    #[inline]
    pub fn reflectance(&self, cosine: f64) -> Rgb {
        self.fresnel.at(cosine)
    }
}

/// Multiple scattering per unit of lost energy, for facets with this mean loss and reflectance, over π and the mean
/// loss. Each further scattering keeps F̄, and 1 − L̄ of that escapes.
#[inline]
pub(super) fn made_up(lost: f64, reflectance: Rgb) -> Rgb {
    let of = |share| made_up_of(lost, share);
    Rgb::new(of(reflectance[0]), of(reflectance[1]), of(reflectance[2]))
}

/// The same for one channel, or one wavelength.
#[inline]
fn made_up_of(lost: f64, reflectance: f64) -> f64 {
    if lost == 0.0 {
        return 0.0;
    }
    let colour = reflectance * reflectance * (1.0 - lost) / (1.0 - reflectance * lost);
    colour * (FRAC_1_PI / lost)
}

/// Returns whether facets can mirror one direction to another: both visible, on one side.
#[inline(always)]
pub(super) fn mirrors<F: Facets>(wo: DVec3, wi: DVec3) -> bool {
    F::sees(wo) & F::sees(wi) & (wo.z * wi.z > 0.0)
}

/// Mirrors a direction to the upper side, which is equivalent.
#[inline(always)]
pub(super) fn above(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, w.z.abs())
}

impl<F: Lossy> Bsdf for Conductor<F> {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        let Some(rough) = &self.rough else {
            return (Rgb::ZERO, 0.0);
        };
        if !mirrors::<F>(wo, wi) {
            return (Rgb::ZERO, 0.0);
        }
        let (wo, wi) = (above(wo), above(wi));
        let (density, cosine) = rough.facets.mirroring(wo, wi);
        let lost = [rough.loss.of(wo), rough.loss.of(wi)];
        let parts = (&rough.facets, rough.multiple, &rough.grazing);
        RoughFacets::scattered(parts, [wo, wi], (density, self.reflectance(cosine)), lost)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !F::sees(wo) {
            return None;
        }
        let Some(rough) = &self.rough else {
            return Some(BsdfSample::delta(mirrored(wo), self.reflectance(wo.z.abs())));
        };
        let up = above(wo);
        let lost = rough.loss.of(up);
        let is_multiple = choice() < lost;
        let mut wi = if is_multiple { rough.grazing.sample(u) } else { rough.facets.sample_reflection(up, u) };
        if wi.z <= 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        let (value, pdf) = self.evaluate(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::new(wi, value / pdf, pdf).of_lobe(either(lost, is_multiple)))
    }

    fn albedo(&self) -> Rgb {
        let average = self.fresnel.average();
        match &self.rough {
            None => average,
            Some(rough) => {
                let lost = rough.loss.average();
                average * (1.0 - lost) + rough.multiple * (PI * lost * lost)
            }
        }
    }

    fn repeat_correction(&self) -> Rgb {
        self.fresnel.repeat_correction()
    }

    fn is_delta(&self) -> bool {
        self.rough.is_none()
    }

    fn roughness(&self) -> f64 {
        self.rough.as_ref().map_or(0.0, |rough| rough.facets.mean_alpha())
    }
}
