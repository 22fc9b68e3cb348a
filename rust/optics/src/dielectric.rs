//! Glass, water and the like.

mod facet;
mod lanes;
mod open;

use super::bsdf::either;
use super::conductor::above;
use super::lobes::Grazing;
use super::losses::{Lossy, LostBetween};
use super::mirror::mirrored;
use super::split::{Bare, Share, Split, beyond};
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use facet::{Bent, Divided, Facet};
use raywright_base::math::{DVec3, in_lanes, select};

/// A dielectric interface, smooth or with isotropic microfacets (Walter et al., "Microfacet Models for Refraction
/// through Rough Surfaces", 2007), which reflects and refracts.
///
/// A refraction that starts at a facet seen from one side is mostly taken to get out where the facet is seen from the
/// other ([`Facets::refraction_geometry`]): light that other facets stop goes through them too, the more nearly
/// straight on the closer the index is to 1. So at index 1 a surface is clear however rough it is. What is still lost
/// is given back as `LostBetween` says.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<F: Lossy = Ggx, S: Split = Bare> {
    /// Index below over index above.
    eta: f64,
    rough: Option<Rough<F>>,
    /// How facets divide light.
    split: S,
}

/// How much what bare facets would reflect counts for which way is drawn, beside what these do: where a film reflects
/// nothing, they still do as far as other facets are in the way.
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

    /// How light goes on the side of `w` that facets lose and give back.
    #[inline]
    fn grazing(&self, w: DVec3) -> Grazing {
        Grazing::new(self.interface.scale(w))
    }

    /// What is known of light that goes to `wo`.
    #[inline]
    fn known(&self, wo: DVec3) -> Known {
        Known { lost: self.interface.loss(wo), crossing: self.interface.crossing(wo) }
    }

    /// Draws where light comes from that facets lost and give back, by a choice among what is lost; with the choices
    /// that lead to its side. None in the plane.
    #[inline]
    fn give_back(&self, known: &Known, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<(DVec3, [f64; 2])> {
        let Known { lost, crossing } = *known;
        let crossing = lost * crossing;
        let (side, choices) =
            if choice < crossing { (-wo.z.signum(), [0.0, crossing]) } else { (wo.z.signum(), [crossing, lost]) };
        let wi = self.grazing(DVec3::new(0.0, 0.0, side)).sample(u) * DVec3::new(1.0, 1.0, side);
        F::sees(wi).then_some((wi, choices))
    }
}

/// What is known of light that goes somewhere.
#[derive(Clone, Copy, Debug)]
struct Known {
    /// The share that facets lose.
    lost: f64,
    /// The share of that which is given back on the other side.
    crossing: f64,
}

in_lanes! {
    /// What is known of light that goes somewhere, a lane each.
    KnownLanes of Known { lost: f64, crossing: f64 }
}

/// One of the two single directions of a smooth interface.
struct Single<S> {
    wi: DVec3,
    /// What is left of light from there.
    weight: S,
    /// Whether it is the one on the other side.
    is_through: bool,
    /// Whether there is one: none where all is reflected, of which roundings leave a choice beyond.
    is_any: bool,
}

impl<S: Share> Single<S> {
    /// Chosen by a number, where this share is reflected, and with the index beyond over that on the side of `wo`.
    #[inline(always)]
    fn new(wo: DVec3, eta: f64, reflectance: S, choice: f64) -> Self {
        let chance = reflectance.chance();
        let is_mirrored = choice < chance;
        // Both are computed, and one is taken: lanes have no branches.
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
    /// Of the index of refraction below the surface over that above, `eta` > 0, and the roughness of GGX, 0 to 1.
    /// Below [`Facets::SMOOTH`], or with `eta` within 10⁻⁶ of 1, directions are single.
    pub fn new(eta: f64, alpha: f64) -> Self {
        Self::of(eta, Ggx::rough([alpha; 2]))
    }
}

impl<F: Lossy> Dielectric<F> {
    /// Of the index of refraction below the surface over that above, `eta` > 0, and facets that are alike in all
    /// directions. Without them, or with `eta` within 10⁻⁶ of 1, directions are single.
    pub fn of(eta: f64, facets: Option<F>) -> Self {
        Self::with(eta, facets, Bare)
    }
}

impl<F: Lossy, S: Split> Dielectric<F, S> {
    /// Nearer to 1 an index bends light by less than 10⁻⁶ radians at a rough surface, except within 10⁻³ of grazing. It
    /// then counts as smooth: Fresnel's reflection is all that can be told.
    const INVISIBLE: f64 = 1e-6;

    /// As [`Dielectric::of`], of an interface that divides light as it says.
    ///
    /// What facets lose and give back is that of bare ones, where something gives back at all. So that nothing is lost
    /// or gained, what lies on a facet changes how light is divided there only as far as none of it is stopped by other
    /// facets on either way (`open::openness`): of that part as much more is reflected as less goes through.
    pub fn with(eta: f64, facets: Option<F>, split: S) -> Self {
        let eta = fresnel::bounded(eta);
        let facets = facets.filter(|_| (eta - 1.0).abs() >= Self::INVISIBLE);
        Self { eta, rough: facets.map(|facets| Rough::new(facets, eta)), split }
    }

    /// The index below over the index above.
    #[inline]
    pub fn eta(&self) -> f64 {
        self.eta
    }

    /// The index beyond the surface over that on the side of `w`.
    #[inline]
    fn beyond(&self, w: DVec3) -> f64 {
        beyond(self.eta, w)
    }

    /// The share of light that is reflected at this cosine of incidence, on the side of `w`.
    #[inline]
    fn reflectance(&self, w: DVec3, cosine: f64) -> S::Share {
        self.split.reflectance(cosine, self.beyond(w), w.z > 0.0)
    }

    /// Whether what bare facets would reflect counts beside what these do.
    const WEIGHS_BARE: bool = F::Interface::GIVES_BACK && S::DIFFERS;

    /// How a facet on the side of `w` divides light at this cosine of incidence.
    #[inline]
    fn divided(&self, w: DVec3, cosine: f64) -> Divided<S::Share> {
        self.divide(self.reflectance(w, cosine), w, cosine)
    }

    /// The same, where it is known which share is reflected.
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

    /// What facets scatter between two directions that see each other by one of them, and what is given back of what
    /// they lose: the scattering function with its cosine, for radiance, and the density of a draw.
    #[inline]
    fn scattered(&self, rough: &Rough<F>, known: &Known, [wo, wi]: [DVec3; 2], facet: &Facet) -> (S::Share, f64) {
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
            (wi, Facet::between(&rough.facets, eta, [wo, wi]), choices)
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

impl Known {
    /// With what is given back, `back`, of what facets lose, of light that goes to `wo` and comes from `wi`, on whose
    /// side it goes about as `grazing` says; `eta` is the index beyond the surface.
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

    /// What is left of a choice among all, where it is not of what is lost.
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
                let facet = Facet::between(&rough.facets, self.beyond(wo), [wo, wi]);
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
