//! The energy-conserving principled BSDF of a thin sheet.

use super::Look;
use super::facet_albedo::DielectricShares;
use crate::albedo::MirrorLoss;
use crate::bsdf_columns::LaneBsdf;
use crate::conductor::above;
use crate::lobes::{Grazing, diffuse};
use crate::scalar_lanes::Looped;
use crate::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use raywright_base::math::DVec3;
use std::f64::consts::FRAC_1_PI;

/// The principled model of a thin sheet (Burley, 2015) with energy conservation. Facets of one roughness reflect and
/// transmit. Their loss D(ω) is compensated equally on both sides, D(wo) D(wi) / (2π D̄). The diffuse part distributes
/// its light over azimuths like Burley's and conserves it. Both sides are alike.
#[derive(Clone, Copy, Debug)]
pub struct LayeredPrincipledThin {
    look: Look,
    /// Albedo of the facets.
    shares: DielectricShares,
    /// Share of diffuse light that is transmitted.
    diffuse_transmission: f64,
    /// One over 2π and the facets' mean loss; 0 if there is none.
    given_back: f64,
}

impl LayeredPrincipledThin {
    /// Creates the BSDF from its parameters, the index of refraction, and the transmitted share of diffuse light, 0 to
    /// 1.
    pub fn new(look: Look, eta: f64, diffuse_transmission: f64) -> Self {
        let eta = fresnel::bounded(eta);
        let shares = DielectricShares::new(&look, look.roughness, eta.max(1.0 / eta));
        let lost = if look.transmission > 0.0 { MirrorLoss::new(shares.facets).average() } else { 0.0 };
        let given_back = if lost > 0.0 { 0.5 * FRAC_1_PI / lost } else { 0.0 };
        Self { look, shares, diffuse_transmission, given_back }
    }

    /// Loss of facets for direction `w`, above.
    #[inline(always)]
    fn lost(&self, w: DVec3) -> f64 {
        if self.look.transmission > 0.0 { MirrorLoss::new(self.shares.facets).of(w) } else { 0.0 }
    }

    /// Sampling probabilities of facets, compensation and diffuse part, each reflected and transmitted.
    #[inline(always)]
    fn shares_of_lobes(&self, lost: f64) -> [[f64; 2]; 3] {
        let (sharp, across) = (self.look.transmission, self.diffuse_transmission);
        let facets = sharp * (1.0 - lost.min(0.9));
        let matt = 1.0 - sharp;
        [[0.5 * facets; 2], [0.5 * (sharp - facets); 2], [matt * (1.0 - across), matt * across]]
    }

    /// Directional distribution of the compensation lobe.
    #[inline(always)]
    fn grazing(&self) -> Grazing {
        Grazing::new(self.shares.facets.mean_alpha())
    }

    #[inline(always)]
    fn scattered(&self, wo: DVec3, wi: DVec3, lost: f64) -> (Rgb, f64) {
        let (look, is_through) = (&self.look, wo.z * wi.z < 0.0);
        let (o, i, sharp) = (above(wo), above(wi), look.transmission);
        let [facets, given_back, matt] = self.shares_of_lobes(lost).map(|lobe| lobe[usize::from(is_through)]);
        let tint = if is_through { look.base_color } else { Rgb::ONE };
        let (mut value, mut pdf) = (Rgb::ZERO, 0.0);
        if sharp > 0.0 {
            let shares = &self.shares;
            let (density, cosine) = shares.facets.mirroring(o, i);
            let reflected = shares.fresnel(cosine);
            let share = if is_through { Rgb::ONE - reflected } else { reflected };
            let once = share * (density * shares.facets.reflection_geometry(o, i));
            let again = lost * self.lost(i) * self.given_back * i.z;
            value += tint * (once + Rgb::splat(again)) * sharp;
            pdf += facets * shares.facets.reflected_pdf(o, density) + given_back * self.grazing().pdf(i.z);
        }
        let across = self.diffuse_transmission;
        value += if is_through { look.base_color * across } else { look.spread(o, i) * (1.0 - across) }
            * ((1.0 - sharp) * FRAC_1_PI * i.z);
        pdf += matt * i.z * FRAC_1_PI;
        (value, pdf)
    }
}

impl Bsdf for LayeredPrincipledThin {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !Ggx::sees(wo) || !Ggx::sees(wi) {
            return (Rgb::ZERO, 0.0);
        }
        self.scattered(wo, wi, self.lost(above(wo)))
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !Ggx::sees(wo) {
            return None;
        }
        let (choice, up) = (choice(), above(wo));
        let lost = self.lost(up);
        let mut ends = [0.0; 6];
        let mut sum = 0.0;
        for (end, share) in ends.iter_mut().zip(self.shares_of_lobes(lost).as_flattened()) {
            sum += share;
            *end = sum;
        }
        let lobe = ends.iter().position(|&end| choice < end).unwrap_or(5);
        let mut wi = match lobe {
            0 | 1 => self.shares.facets.sample_reflection(up, u),
            2 | 3 => self.grazing().sample(u),
            _ => diffuse(up, u),
        };
        if !(wi.z > 0.0 && Ggx::sees(wi)) {
            return None;
        }
        let is_through = lobe % 2 == 1;
        wi.z = wi.z.copysign(if is_through { -wo.z } else { wo.z });
        let (value, pdf) = self.scattered(wo, wi, lost);
        let choices = [if lobe == 0 { 0.0 } else { ends[lobe - 1] }, ends[lobe]];
        let drawn = BsdfSample::new(wi, value / pdf, pdf).of_lobe(choices);
        (pdf > 0.0).then(|| if is_through { drawn.through(1.0) } else { drawn })
    }

    fn albedo(&self) -> Rgb {
        self.look.base_color
    }

    fn transmits(&self) -> bool {
        true
    }

    fn roughness(&self) -> f64 {
        self.shares.facets.mean_alpha()
    }
}

impl LaneBsdf for LayeredPrincipledThin {
    type Lanes = Looped;
}
