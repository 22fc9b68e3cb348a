//! Glass, water and the like.

mod lanes;
mod open;

pub use lanes::DielectricLanes;

use super::bsdf::either;
use super::conductor::above;
use super::lobes::Grazing;
use super::losses::{Lossy, LostBetween};
use super::mirror::mirrored;
use super::split::{Bare, Share, Split};
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use crate::math::select;
use glam::DVec3;

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

#[derive(Clone, Copy, Debug)]
struct Rough<F: Lossy> {
    facets: F,
    interface: F::Interface,
}

/// How much what bare facets would reflect counts for which way is drawn, beside what these do: where a film reflects
/// nothing, they still do as far as other facets are in the way.
const BARE: f64 = 0.25;

/// The index beyond a surface over that on the side of `w`, for the index below over that above.
#[inline(always)]
fn beyond(eta: f64, w: DVec3) -> f64 {
    if w.z > 0.0 { eta } else { 1.0 / eta }
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
    /// facets on either way ([`open::openness`]): of that part as much more is reflected as less goes through.
    pub fn with(eta: f64, facets: Option<F>, split: S) -> Self {
        let facets = facets.filter(|_| (eta - 1.0).abs() >= Self::INVISIBLE);
        Self { eta, rough: facets.map(|facets| Rough { facets, interface: facets.interface(eta) }), split }
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

    /// What bare facets would reflect of it, where that is not what these do, and what is lost is given back.
    #[inline]
    fn bare(&self, w: DVec3, cosine: f64) -> Option<f64> {
        if F::Interface::GIVES_BACK { self.split.bare(cosine, self.beyond(w)) } else { None }
    }

    /// How often a reflection is drawn at a facet on the side of `w`, of this reflectance there.
    #[inline]
    fn chance(&self, w: DVec3, cosine: f64, reflectance: S::Share) -> f64 {
        let chance = reflectance.chance();
        self.bare(w, cosine).map_or(chance, |bare| chance + BARE * (bare - chance))
    }

    /// What one scattering does: the scattering function with its cosine, for radiance, and the density of a draw.
    #[inline]
    fn single(&self, rough: &Rough<F>, wo: DVec3, wi: DVec3) -> (S::Share, f64) {
        let (eta, facets) = (self.beyond(wo), &rough.facets);
        if wo.z * wi.z > 0.0 {
            let (o, i) = (above(wo), above(wi));
            let (density, cosine) = facets.mirroring(o, i);
            let reflectance = self.reflectance(wo, cosine);
            let geometry = facets.reflection_geometry(o, i);
            let value = match self.bare(wo, cosine) {
                None => reflectance * density * geometry,
                Some(bare) => {
                    let open = open::openness(facets, wo, (wo + wi).normalize(), eta) / (4.0 * o.z);
                    (reflectance * open).plus(bare * (geometry - open)) * density
                }
            };
            return (value, facets.reflected_pdf(o, self.chance(wo, cosine, reflectance) * density));
        }
        // The facet's normal, on the side of wo; the length holds the Jacobian (Walter et al., 2007, eq. 16 and 17).
        let q = wo + wi * eta;
        let q = if q.z * wo.z < 0.0 { -q } else { q };
        let square = q.length_squared();
        if square == 0.0 {
            return (S::Share::NONE, 0.0);
        }
        let h = q / square.sqrt();
        let (o, i) = (wo.dot(h), -wi.dot(h));
        if o <= 0.0 || i <= 0.0 {
            return (S::Share::NONE, 0.0);
        }
        self.refraction(rough, wo, wi, h, [o, i], square)
    }

    /// Refraction at a facet of normal `h`, on the side of `wo`, with cosines to both directions and |wo + η wi|².
    #[inline]
    fn refraction(
        &self,
        rough: &Rough<F>,
        wo: DVec3,
        wi: DVec3,
        h: DVec3,
        [o, i]: [f64; 2],
        square: f64,
    ) -> (S::Share, f64) {
        let (eta, facets) = (self.beyond(wo), &rough.facets);
        let reflectance = self.reflectance(wo, o);
        let density = facets.density(h);
        let [seen, both] = facets.refraction_geometry(wo, wi);
        let pdf = self.chance(wo, o, reflectance).rest() * density * o * i / square * seen * eta * eta;
        let Some(bare) = self.bare(wo, o) else {
            let through = reflectance.rest() * density * o * i / square;
            return (through * both, pdf);
        };
        let open = open::openness(facets, wo, h, eta) / wo.z.abs();
        let through = (reflectance.rest() * open).plus(bare.rest() * (both - open));
        (through * density * o * i / square, pdf)
    }

    /// As [`Dielectric::single`], with what is given back of what facets lose.
    #[inline]
    fn both(&self, rough: &Rough<F>, wo: DVec3, wi: DVec3, (value, pdf): (S::Share, f64)) -> (S::Share, f64) {
        let lost = rough.interface.loss(wo);
        let back =
            rough.interface.given_back(lost, wo, wi) / if wo.z * wi.z < 0.0 { self.beyond(wo).powi(2) } else { 1.0 };
        let crossing = rough.interface.crossing(wo);
        let share = if wo.z * wi.z < 0.0 { crossing } else { 1.0 - crossing };
        let scale = rough.interface.scale(wi);
        (value.plus(back), (1.0 - lost) * pdf + lost * share * Grazing::new(scale).pdf(wi.z.abs()))
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
        let lost = rough.interface.loss(wo);
        let eta = self.beyond(wo);
        let (wi, single, choices) = if choice < lost {
            let crossing = lost * rough.interface.crossing(wo);
            let (side, choices) =
                if choice < crossing { (-wo.z.signum(), [0.0, crossing]) } else { (wo.z.signum(), [crossing, lost]) };
            let scale = rough.interface.scale(DVec3::new(0.0, 0.0, side));
            let wi = Grazing::new(scale).sample(u) * DVec3::new(1.0, 1.0, side);
            if !F::sees(wi) {
                return None;
            }
            (wi, self.single(rough, wo, wi), choices)
        } else {
            let choice = (choice - lost) / (1.0 - lost);
            let mut h = rough.facets.sample_visible(above(wo), u);
            h.z = h.z.copysign(wo.z);
            let o = wo.dot(h);
            let chance = self.chance(wo, o, self.reflectance(wo, o));
            let between = lost + (1.0 - lost) * chance;
            if choice < chance {
                let wi = h * (2.0 * o) - wo;
                if wi.z * wo.z <= 0.0 {
                    return None;
                }
                (wi, self.single(rough, wo, wi), [lost, between])
            } else {
                let wi = fresnel::refract(wo, h, eta)?;
                if wi.z * wo.z >= 0.0 || !F::sees(wi) {
                    return None;
                }
                // |wo + η wi| without the rounding of either: near index 1 it is all that tells directions apart.
                let e = (eta - 1.0) * (eta + 1.0);
                let g = (e + o * o).sqrt();
                (wi, self.refraction(rough, wo, wi, h, [o, g / eta], (e / (o + g)).powi(2)), [between, 1.0])
            }
        };
        let (value, pdf) = self.both(rough, wo, wi, single);
        let drawn = BsdfSample::new(wi, (value / pdf).rgb(), pdf).of_lobe(choices);
        (pdf > 0.0).then(|| if wo.z * wi.z < 0.0 { drawn.through(eta) } else { drawn })
    }
}

impl<F: Lossy, S: Split> Bsdf for Dielectric<F, S> {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        match &self.rough {
            Some(rough) if F::sees(wo) && F::sees(wi) => {
                let (value, pdf) = self.both(rough, wo, wi, self.single(rough, wo, wi));
                (value.rgb(), pdf)
            }
            _ => (Rgb::ZERO, 0.0),
        }
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
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
