//! Dielectric interfaces such as glass and water.

mod dielectric_lanes;
mod facet;
mod masking_shadowing;

use super::bsdf::either;
use super::conductor::above;
use super::energy_loss::{Lossy, LostBetween};
use super::interface_split::{Bare, Share, Split, beyond};
use super::lobes::Grazing;
use super::mirror::mirrored;
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use facet::{Bent, Divided, Microfacet};
use raywright_base::math::{DVec3, in_lanes, select};

/// A dielectric interface, smooth or with isotropic microfacets, that reflects and refracts (Walter et al., "Microfacet
/// Models for Refraction through Rough Surfaces", 2007).
///
/// A refraction at a facet visible from one side is mostly assumed to escape if the facet is visible from the other
/// ([`Facets::refraction_geometry`]). Light blocked by other facets passes through them too, and the closer the index
/// is to 1 the less it is deflected. So at index 1 a rough surface is clear. The remaining loss is compensated by
/// `LostBetween`.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<F: Lossy = Ggx, S: Split = Bare> {
    /// Index of refraction below over index above.
    eta: f64,
    rough: Option<Rough<F>>,
    /// Division of light into reflection and transmission at a facet.
    split: S,
}

/// Weight of the bare facets' reflectance in the sampling probability. A film may reflect nothing where bare facets, as
/// far as other facets block them, still reflect.
const BARE: f64 = 0.25;

#[derive(Clone, Copy, Debug)]
struct Rough<F: Lossy> {
    facets: F,
    interface: F::Interface,
}

impl<F: Lossy> Rough<F> {
    fn new(facets: F, eta: f64) -> Self {
        Self { facets, interface: facets.interface(eta) }
    }

    /// Directional distribution of the compensation lobe on the side of `w`.
    #[inline]
    fn grazing(&self, w: DVec3) -> Grazing {
        Grazing::new(self.interface.scale(w))
    }

    /// Precomputes the losses for `wo`.
    #[inline]
    fn known(&self, wo: DVec3) -> FacetTerms {
        FacetTerms { lost: self.interface.loss(wo), crossing: self.interface.crossing(wo) }
    }

    /// Samples the compensation lobe with a choice within the lost energy. Also returns the range of choices of its
    /// side. `None` for a direction in the tangent plane.
    #[inline]
    fn give_back(&self, known: &FacetTerms, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<(DVec3, [f64; 2])> {
        let FacetTerms { lost, crossing } = *known;
        let crossing = lost * crossing;
        let (side, choices) =
            if choice < crossing { (-wo.z.signum(), [0.0, crossing]) } else { (wo.z.signum(), [crossing, lost]) };
        let wi = self.grazing(DVec3::new(0.0, 0.0, side)).sample(u) * DVec3::new(1.0, 1.0, side);
        F::sees(wi).then_some((wi, choices))
    }
}

/// Precomputed losses of a direction.
#[derive(Clone, Copy, Debug)]
struct FacetTerms {
    /// Share of energy lost by single scattering.
    lost: f64,
    /// Share of the lost energy that the compensation transmits.
    crossing: f64,
}

in_lanes! {
    /// Precomputed losses, one per lane.
    KnownLanes of FacetTerms { lost: f64, crossing: f64 }
}

/// A sampled delta direction of a smooth interface.
struct Single<S> {
    wi: DVec3,
    /// Sample weight.
    weight: S,
    /// True for the transmitted direction.
    is_through: bool,
    /// False if a rounding selects transmission under total reflection.
    is_any: bool,
}

impl<S: Share> Single<S> {
    /// Selects reflection or refraction by a choice number; `eta` is the index beyond over that on the side of `wo`.
    #[inline(always)]
    fn new(wo: DVec3, eta: f64, reflectance: S, choice: f64) -> Self {
        let chance = reflectance.chance();
        let is_mirrored = choice < chance;
        // Both are computed and one is selected, because lanes have no branches.
        let (bent, is_total) = fresnel::refracted(wo, DVec3::new(0.0, 0.0, 1f64.copysign(wo.z)), eta);
        let left = (reflectance.rest() / chance.rest()) * (1.0 / (eta * eta));
        Self {
            wi: select(is_mirrored, mirrored(wo), bent),
            weight: S::select(is_mirrored, reflectance / chance, left),
            is_through: !is_mirrored,
            is_any: is_mirrored | !is_total,
        }
    }
}

impl Dielectric {
    /// Creates an interface with relative index of refraction `eta` > 0, below over above, and GGX roughness, 0 to 1.
    /// Below [`Facets::SMOOTH`], or with `eta` within 10⁻⁶ of 1, it is specular.
    pub fn new(eta: f64, alpha: f64) -> Self {
        Self::of(eta, Ggx::rough([alpha; 2]))
    }
}

impl<F: Lossy> Dielectric<F> {
    /// Creates an interface with relative index of refraction `eta` > 0, below over above, and isotropic facets.
    /// Without them, or with `eta` within 10⁻⁶ of 1, it is specular.
    pub fn of(eta: f64, facets: Option<F>) -> Self {
        Self::with(eta, facets, Bare)
    }
}

impl<F: Lossy, S: Split> Dielectric<F, S> {
    /// Closer to 1, an index deflects light at a rough surface by less than 10⁻⁶ radians, except within 10⁻³ of
    /// grazing. Such a surface is treated as smooth; only Fresnel's reflection is visible.
    const INVISIBLE: f64 = 1e-6;

    /// Like [`Dielectric::of`], with a given division of light.
    ///
    /// Loss and compensation are those of bare facets. To conserve energy, a film changes the division at a facet only
    /// for the light that no other facet blocks, reflected or refracted (`masking_shadowing::openness`). Within that
    /// part, reflection gains the energy that transmission loses.
    pub fn with(eta: f64, facets: Option<F>, split: S) -> Self {
        let eta = fresnel::bounded(eta);
        let facets = facets.filter(|_| (eta - 1.0).abs() >= Self::INVISIBLE);
        Self { eta, rough: facets.map(|facets| Rough::new(facets, eta)), split }
    }

    /// Index of refraction below over index above.
    #[inline]
    pub fn eta(&self) -> f64 {
        self.eta
    }

    /// Index of refraction beyond the surface over that on the side of `w`.
    #[inline]
    fn beyond(&self, w: DVec3) -> f64 {
        beyond(self.eta, w)
    }

    /// Reflectance at this cosine of incidence, on the side of `w`.
    #[inline]
    fn reflectance(&self, w: DVec3, cosine: f64) -> S::Share {
        self.split.reflectance(cosine, self.beyond(w), w.z > 0.0)
    }

    /// True if the bare facets' reflectance is needed too.
    const WEIGHS_BARE: bool = F::Interface::GIVES_BACK && S::DIFFERS;

    /// Division of light at a facet, for this cosine of incidence on the side of `w`.
    #[inline]
    fn divided(&self, w: DVec3, cosine: f64) -> Divided<S::Share> {
        self.divide(self.reflectance(w, cosine), w, cosine)
    }

    /// Division of light for a known reflectance.
    #[inline(always)]
    fn divide(&self, reflectance: S::Share, w: DVec3, cosine: f64) -> Divided<S::Share> {
        let divided = Divided::of(reflectance);
        if Self::WEIGHS_BARE {
            let bare = fresnel::dielectric(cosine, self.beyond(w));
            Divided { chance: divided.chance + BARE * (bare - divided.chance), bare: Some(bare), ..divided }
        } else {
            divided
        }
    }

    /// Value and density between two mutually visible directions: single scattering by one facet, plus compensation.
    /// The value includes the cosine and is for radiance.
    #[inline]
    fn scattered(
        &self,
        rough: &Rough<F>,
        known: &FacetTerms,
        [wo, wi]: [DVec3; 2],
        facet: &Microfacet,
    ) -> (S::Share, f64) {
        let (eta, divided) = (self.beyond(wo), self.divided(wo, facet.cosines[0]));
        let once = if wo.z * wi.z < 0.0 {
            facet.refracted(&rough.facets, &divided, eta, [wo, wi])
        } else {
            facet.mirrored(&rough.facets, &divided, eta, [wo, wi])
        };
        let back = rough.interface.given_back(known.lost, wo, wi);
        known.with_given_back(once, [wo, wi], eta, back, &rough.grazing(wi))
    }

    #[inline]
    fn smooth_sample(&self, wo: DVec3, choice: f64) -> Option<BsdfSample> {
        let eta = self.beyond(wo);
        let reflectance = self.reflectance(wo, wo.z.abs());
        let Single { wi, weight, is_through, is_any } = Single::new(wo, eta, reflectance, choice);
        let drawn = BsdfSample::delta(wi, weight.rgb()).of_lobe(either(reflectance.chance(), !is_through));
        is_any.then(|| if is_through { drawn.through(eta) } else { drawn })
    }

    #[inline]
    fn rough_sample(&self, rough: &Rough<F>, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let (known, eta) = (rough.known(wo), self.beyond(wo));
        let (wi, facet, choices) = if choice < known.lost {
            let (wi, choices) = rough.give_back(&known, wo, choice, u)?;
            (wi, Microfacet::between(&rough.facets, eta, [wo, wi]), choices)
        } else {
            let h = facet::seen(&rough.facets, wo, u);
            let chance = self.divided(wo, wo.dot(h)).chance;
            let bent = Bent::new(&rough.facets, eta, wo, h, known.rest(choice) < chance);
            let between = known.lost + (1.0 - known.lost) * chance;
            let choices = if bent.is_through { [between, 1.0] } else { [known.lost, between] };
            if !bent.is_any {
                return None;
            }
            (bent.wi, bent.facet, choices)
        };
        let (value, pdf) = self.scattered(rough, &known, [wo, wi], &facet);
        let drawn = BsdfSample::new(wi, (value / pdf).rgb(), pdf).of_lobe(choices);
        (pdf > 0.0).then(|| if wo.z * wi.z < 0.0 { drawn.through(eta) } else { drawn })
    }
}

impl FacetTerms {
    /// Adds the compensation `back` for light from `wi` to `wo` to a value and density. `grazing` is the compensation's
    /// distribution on the side of `wi`; `eta` is the index of refraction beyond the surface.
    #[inline(always)]
    fn with_given_back<S: Share>(
        &self,
        (value, pdf): (S, f64),
        [wo, wi]: [DVec3; 2],
        eta: f64,
        back: f64,
        grazing: &Grazing,
    ) -> (S, f64) {
        let is_through = wo.z * wi.z < 0.0;
        let back = back / if is_through { eta * eta } else { 1.0 };
        let share = if is_through { self.crossing } else { 1.0 - self.crossing };
        (value.plus(back), (1.0 - self.lost) * pdf + self.lost * share * grazing.pdf(wi.z.abs()))
    }

    /// Rescales a choice number that did not select the compensation lobe.
    #[inline(always)]
    fn rest(&self, choice: f64) -> f64 {
        (choice - self.lost) / (1.0 - self.lost)
    }
}

impl<F: Lossy, S: Split> Bsdf for Dielectric<F, S> {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        match &self.rough {
            Some(rough) if F::sees(wo) && F::sees(wi) => {
                let facet = Microfacet::between(&rough.facets, self.beyond(wo), [wo, wi]);
                let (value, pdf) = self.scattered(rough, &rough.known(wo), [wo, wi], &facet);
                (value.rgb(), pdf)
            }
            _ => (Rgb::ZERO, 0.0),
        }
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !F::sees(wo) {
            return None;
        }
        match &self.rough {
            None => self.smooth_sample(wo, choice()),
            Some(rough) => self.rough_sample(rough, wo, choice(), u),
        }
    }

    fn albedo(&self) -> Rgb {
        Rgb::ONE
    }

    fn is_delta(&self) -> bool {
        self.rough.is_none()
    }

    fn transmits(&self) -> bool {
        true
    }

    fn roughness(&self) -> f64 {
        self.rough.as_ref().map_or(0.0, |rough| rough.facets.mean_alpha())
    }
}
