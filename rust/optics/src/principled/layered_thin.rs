//! The principled model of a sheet with all of its light.

use super::Look;
use super::shares::DielectricShares;
use crate::albedo::MirrorLoss;
use crate::bsdf_columns::LaneBsdf;
use crate::conductor::above;
use crate::lobes::{Grazing, diffuse};
use crate::looped::Looped;
use crate::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use raywright_base::math::DVec3;
use std::f64::consts::FRAC_1_PI;

/// The principled model of a sheet (Burley, 2015) without gain or loss. What facets neither reflect nor let through,
/// 1 − R(ω) − T(ω) = D(ω), is given back on both sides alike, D(wo) D(wi) / (2π D̄); what is matt spreads its light
/// over azimuths as Burley's does, and keeps it. Both sides are alike.
#[derive(Clone, Copy, Debug)]
pub struct LayeredPrincipledThin {
    look: Look,
    /// Of what is reflected, and of what goes through.
    roughness: [f64; 2],
    eta: f64,
    /// The share of what is matt that is scattered on the other side.
    diffuse_transmission: f64,
    /// One over 2π and the mean of what is neither reflected nor let through; 0 where that is nothing.
    given_back: Rgb,
}

impl LayeredPrincipledThin {
    /// Of a look, the index of refraction, and the share of what is matt that goes through, 0 to 1.
    pub fn new(look: Look, eta: f64, diffuse_transmission: f64) -> Self {
        let eta = fresnel::bounded(eta);
        // What goes through rougher facets than reflect would be more, at grazing angles, than these leave.
        let roughness = [look.roughness, look.roughness_through(eta).min(look.roughness)];
        let mut made = Self { look, roughness, eta: eta.max(1.0 / eta), diffuse_transmission, given_back: Rgb::ZERO };
        if look.transmission > 0.0 {
            let [reflected, through] = [0, 1].map(|k| made.shares(k).average());
            let lost = MirrorLoss::new(made.shares(1).facets).average();
            let left = through + Rgb::splat(lost) - reflected;
            let of = |left: f64| if left > 1e-9 { 0.5 * FRAC_1_PI / left } else { 0.0 };
            made.given_back = Rgb::new(of(left[0]), of(left[1]), of(left[2]));
        }
        made
    }

    /// What facets of what is reflected, or of what goes through, reflect.
    #[inline(always)]
    fn shares(&self, which: usize) -> DielectricShares {
        DielectricShares::new(&self.look, self.roughness[which], self.eta)
    }

    /// What facets neither reflect nor let through of light from `w`, above.
    #[inline(always)]
    fn left(&self, w: DVec3) -> Rgb {
        if self.look.transmission == 0.0 {
            return Rgb::ZERO;
        }
        let lost = MirrorLoss::new(self.shares(1).facets).of(w);
        let [reflected, through] = [0, 1].map(|k| self.shares(k).of(w.z));
        (through + Rgb::splat(lost) - reflected).at_least(Rgb::ZERO)
    }

    /// The probability of each lobe: facets, what these give back, and what is matt; of each what is reflected and what
    /// goes through.
    #[inline(always)]
    fn shares_of_lobes(&self, left: Rgb) -> [[f64; 2]; 3] {
        let (sharp, across) = (self.look.transmission, self.diffuse_transmission);
        let facets = sharp * (1.0 - left.max().min(0.9));
        let matt = 1.0 - sharp;
        [[0.5 * facets; 2], [0.5 * (sharp - facets); 2], [matt * (1.0 - across), matt * across]]
    }

    /// Directions in which light is given back.
    #[inline(always)]
    fn grazing(&self) -> Grazing {
        Grazing::new(self.shares(1).facets.mean_alpha())
    }

    #[inline(always)]
    fn scattered(&self, wo: DVec3, wi: DVec3, left: Rgb) -> (Rgb, f64) {
        let (look, is_through) = (&self.look, wo.z * wi.z < 0.0);
        let (o, i, sharp) = (above(wo), above(wi), look.transmission);
        let [facets, given_back, matt] = self.shares_of_lobes(left).map(|lobe| lobe[usize::from(is_through)]);
        let tint = if is_through { look.base_color } else { Rgb::ONE };
        let (mut value, mut pdf) = (Rgb::ZERO, 0.0);
        if sharp > 0.0 {
            let shares = self.shares(usize::from(is_through));
            let (density, cosine) = shares.facets.mirroring(o, i);
            let reflected = shares.fresnel(cosine);
            let share = if is_through { Rgb::ONE - reflected } else { reflected };
            let once = share * (density * shares.facets.reflection_geometry(o, i));
            value += tint * (once + left * self.left(i) * self.given_back * i.z) * sharp;
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
        self.scattered(wo, wi, self.left(above(wo)))
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !Ggx::sees(wo) {
            return None;
        }
        let (choice, up) = (choice(), above(wo));
        let left = self.left(up);
        let mut ends = [0.0; 6];
        let mut sum = 0.0;
        for (end, share) in ends.iter_mut().zip(self.shares_of_lobes(left).as_flattened()) {
            sum += share;
            *end = sum;
        }
        let lobe = ends.iter().position(|&end| choice < end).unwrap_or(5);
        let mut wi = match lobe {
            0 | 1 => self.shares(lobe).facets.sample_reflection(up, u),
            2 | 3 => self.grazing().sample(u),
            _ => diffuse(up, u),
        };
        if !(wi.z > 0.0 && Ggx::sees(wi)) {
            return None;
        }
        let is_through = lobe % 2 == 1;
        wi.z = wi.z.copysign(if is_through { -wo.z } else { wo.z });
        let (value, pdf) = self.scattered(wo, wi, left);
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
        self.shares(0).facets.mean_alpha()
    }
}

impl LaneBsdf for LayeredPrincipledThin {
    type Lanes = Looped;
}
