//! Scattering by a single facet of a rough interface.

use super::{above, masking_shadowing};
use crate::interface_split::Share;
use crate::{Facets, fresnel};
use raywright_base::math::{DVec3, LANES, in_lanes, select};

/// A facet that mirrors or refracts one direction to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacet {
    /// Facet density about its normal; 0 if there is no such facet.
    pub density: f64,
    /// Cosines to both directions, each on its side of the facet.
    pub cosines: [f64; 2],
    /// |wo + η wi|², for refraction.
    pub square: f64,
}

in_lanes! {
    /// Facets, one per lane.
    FacetLanes of Microfacet { density: f64, cosines: [f64; 2], square: f64 }
}

impl FacetLanes {
    /// Cosines to the outgoing directions.
    pub(super) fn cosines(&self) -> &[f64; LANES] {
        &self.cosines[0]
    }
}

/// Samples the normal of a facet visible from `wo`, on its side.
#[inline(always)]
pub(super) fn seen<F: Facets>(facets: &F, wo: DVec3, u: [f64; 2]) -> DVec3 {
    let h = facets.sample_visible(above(wo), u);
    DVec3::new(h.x, h.y, h.z.copysign(wo.z))
}

impl Microfacet {
    /// The facet that mirrors one direction to another.
    #[inline(always)]
    pub fn mirroring<F: Facets>(facets: &F, [wo, wi]: [DVec3; 2]) -> Self {
        let (density, cosine) = facets.mirroring(above(wo), above(wi));
        Self { density, cosines: [cosine; 2], square: 1.0 }
    }

    /// The facet that refracts one direction to another; `eta` is the index beyond over that on the side of `wo`.
    #[inline(always)]
    pub fn refracting<F: Facets>(facets: &F, eta: f64, [wo, wi]: [DVec3; 2]) -> Self {
        // The facet's normal, on the side of wo; its length is needed in the Jacobian (Walter et al., 2007, eq. 16 and
        // 17).
        let q = wo + wi * eta;
        let q = select(q.z * wo.z < 0.0, -q, q);
        let square = q.length_squared();
        let is_any = square > 0.0;
        let h = q / if is_any { square.sqrt() } else { 1.0 };
        let (o, i) = (wo.dot(h), -wi.dot(h));
        let density = if is_any & (o > 0.0) & (i > 0.0) { facets.density(h) } else { 0.0 };
        Self { density, cosines: [o, i], square: if is_any { square } else { 1.0 } }
    }

    /// The facet for the sides of both directions.
    #[inline]
    pub fn between<F: Facets>(facets: &F, eta: f64, directions: [DVec3; 2]) -> Self {
        let [wo, wi] = directions;
        if wo.z * wi.z < 0.0 { Self::refracting(facets, eta, directions) } else { Self::mirroring(facets, directions) }
    }

    /// Branch-free selection.
    #[inline(always)]
    pub fn select(first: bool, a: Self, b: Self) -> Self {
        let of = |a: f64, b: f64| if first { a } else { b };
        Self {
            density: of(a.density, b.density),
            cosines: [of(a.cosines[0], b.cosines[0]), of(a.cosines[1], b.cosines[1])],
            square: of(a.square, b.square),
        }
    }

    /// Value and density of reflection; `eta` is the index beyond over that on the side of `wo`.
    #[inline(always)]
    pub fn mirrored<F: Facets, S: Share>(
        &self,
        facets: &F,
        divided: &Divided<S>,
        eta: f64,
        [wo, wi]: [DVec3; 2],
    ) -> (S, f64) {
        let (o, i) = (above(wo), above(wi));
        let geometry = facets.reflection_geometry(o, i);
        let seen = match divided.bare {
            None => divided.reflectance * self.density * geometry,
            Some(bare) => {
                let open = masking_shadowing::openness(facets, wo, (wo + wi).normalize(), eta) / (4.0 * o.z);
                // The open part cannot exceed the geometry factor, except for rounding.
                let open = open.min(geometry);
                (divided.reflectance * open).plus(bare * (geometry - open)) * self.density
            }
        };
        (seen, facets.reflected_pdf(o, divided.chance * self.density))
    }

    /// Value and density of refraction; zero if there is none.
    #[inline(always)]
    pub fn refracted<F: Facets, S: Share>(
        &self,
        facets: &F,
        divided: &Divided<S>,
        eta: f64,
        [wo, wi]: [DVec3; 2],
    ) -> (S, f64) {
        let Self { density, cosines: [o, i], square } = *self;
        let [seen, both] = facets.refraction_geometry(wo, wi);
        let through = match divided.bare {
            None => divided.reflectance.rest() * density * o * i / square * both,
            Some(bare) => {
                let q = wo + wi * eta;
                let h = q.normalize() * (q.z * wo.z).signum();
                let open = (masking_shadowing::openness(facets, wo, h, eta) / wo.z.abs()).min(both);
                let rest = (divided.reflectance.rest() * open).plus((1.0 - bare) * (both - open));
                rest * density * o * i / square
            }
        };
        let drawn = divided.chance.rest() * density * o * i / square * seen * eta * eta;
        let is_any = density > 0.0;
        (S::select(is_any, through, S::NONE), if is_any { drawn } else { 0.0 })
    }
}

/// Division of light at a facet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Divided<S> {
    /// Reflectance.
    pub reflectance: S,
    /// Sampling probability of reflection.
    pub chance: f64,
    /// Reflectance of a bare facet, if it differs and losses are compensated.
    pub bare: Option<f64>,
}

impl<S: Share> Divided<S> {
    /// Division from the reflectance alone.
    #[inline(always)]
    pub fn of(reflectance: S) -> Self {
        Self { reflectance, chance: reflectance.chance(), bare: None }
    }
}

/// An incident direction that a facet scatters to `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    pub wi: DVec3,
    pub facet: Microfacet,
    /// True for refraction.
    pub is_through: bool,
    /// True if the direction is on the correct side.
    pub is_any: bool,
}

impl Bent {
    /// Reflects or refracts at a facet with normal `h`, on the side of `wo`; `eta` is the index beyond.
    #[inline(always)]
    pub fn new<F: Facets>(facets: &F, eta: f64, wo: DVec3, h: DVec3, is_mirrored: bool) -> Self {
        let o = wo.dot(h);
        let mirrored = h * (2.0 * o) - wo;
        // Both are computed and one is selected, because lanes have no branches.
        let (bent, is_total) = fresnel::refracted(wo, h, eta);
        // |wo + η wi| without rounding either; near index 1 the small difference carries all information.
        let e = (eta - 1.0) * (eta + 1.0);
        let g = (e + o * o).sqrt();
        let root = e / (o + g);
        let refracting = Microfacet { density: facets.density(h), cosines: [o, g / eta], square: root * root };
        let goes_through = !is_total & (bent.z * wo.z < 0.0) & F::sees(bent);
        Self {
            wi: select(is_mirrored, mirrored, bent),
            facet: Microfacet::select(is_mirrored, Microfacet::mirroring(facets, [wo, mirrored]), refracting),
            is_through: !is_mirrored,
            is_any: if is_mirrored { mirrored.z * wo.z > 0.0 } else { goes_through },
        }
    }
}
