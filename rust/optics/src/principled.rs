//! The principled BSDFs.

mod coat;
mod diffuse_part;
mod facet_albedo;
mod layered;
mod layered_thin;

use coat::Gtr1;
pub use layered::LayeredPrincipled;
pub use layered_thin::LayeredPrincipledThin;

use super::bsdf_columns::LaneBsdf;
use super::conductor::above;
use super::lobes::diffuse;
use super::soa_lanes::Straight;
use super::{Bsdf, BsdfSample, Facets, Ggx, Once, Rgb, fresnel};
use raywright_base::math::{DVec3, in_lanes, select};
use std::f64::consts::FRAC_1_PI;

/// Parameters of the principled models at a point, each 0 to 1 unless stated otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Color of diffuse reflection, of metal and of transmission.
    pub base_color: Rgb,
    /// Luminance of the base color.
    pub luminance: f64,
    /// Roughness; the facets' α is its square, at least 0.001.
    pub roughness: f64,
    /// Anisotropy: highlights are longer along x than along y.
    pub anisotropic: f64,
    /// Transmitted share of the dielectric part.
    pub transmission: f64,
    /// Tint of dielectric highlights by the base color.
    pub specular_tint: f64,
    /// Sheen of cloth at grazing angles.
    pub sheen: f64,
    /// Tint of the sheen by the base color.
    pub sheen_tint: f64,
    /// Share of the flat lobe that approximates subsurface scattering.
    pub flatness: f64,
}

in_lanes! {
    /// Parameters, one set per lane.
    LookLanes of Look {
        base_color: Rgb,
        luminance: f64,
        roughness: f64,
        anisotropic: f64,
        transmission: f64,
        specular_tint: f64,
        sheen: f64,
        sheen_tint: f64,
        flatness: f64,
    }
}

impl Look {
    /// α along x and y for a roughness, with anisotropy.
    fn slopes(&self, roughness: f64) -> [f64; 2] {
        let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * self.anisotropic).sqrt());
        [(alpha / aspect).max(0.001), (alpha * aspect).max(0.001)]
    }

    /// Facets of a roughness, with anisotropy.
    fn facets(&self, roughness: f64) -> Once<Ggx> {
        Once::new(self.slopes(roughness))
    }

    /// Roughness of transmission through a sheet, which grows with the index of refraction (Burley, 2015, figure 15).
    fn roughness_through(&self, eta: f64) -> f64 {
        (0.65 * eta - 0.35).max(0.0) * self.roughness
    }

    /// Base color normalized to luminance 1.
    #[inline(always)]
    fn tint(&self) -> Rgb {
        if self.luminance > 0.0 { self.base_color / self.luminance } else { Rgb::ONE }
    }

    /// Diffuse part between two directions above, with its cosine: Burley's diffuse reflection, partly flattened after
    /// Hanrahan and Krueger, plus sheen.
    #[inline(always)]
    fn matt(&self, wo: DVec3, wi: DVec3, shares: [f64; 2]) -> Rgb {
        let half = (wo + wi).normalize_or(DVec3::Z);
        let cosine = wi.dot(half);
        let [o, i] = [wo.z, wi.z].map(fresnel::schlick_weight);
        let retro = 2.0 * self.roughness * cosine * cosine;
        let edges = (1.0 - 0.5 * i) * (1.0 - 0.5 * o) + retro * (o + i + o * i * (retro - 1.0));
        let [fo, fi] = [o, i].map(|weight| 1.0 - weight + weight * 0.5 * retro);
        let flat = 1.25 * (fo * fi * ((wo.z + wi.z).recip() - 0.5) + 0.5);
        let sheen = Rgb::splat(1.0 - self.sheen_tint) + self.tint() * self.sheen_tint;
        let [matt, cloth] = shares;
        (self.base_color * (matt * FRAC_1_PI * (edges + (flat - edges) * self.flatness))
            + sheen * (cloth * self.sheen * fresnel::schlick_weight(cosine.abs())))
            * wi.z
    }
}

/// Schlick's reflectance at a facet's cosine, from that at normal incidence. `eta` is the index beyond over that
/// before; towards the thinner side the refracted cosine is used.
#[inline(always)]
fn schlick(normal: Rgb, cosine: f64, eta: f64) -> Rgb {
    let weight = if eta > 1.0 {
        fresnel::schlick_weight(cosine)
    } else {
        fresnel::schlick_weight((1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt())
    };
    normal + (Rgb::ONE - normal) * weight
}

/// Reflectance at normal incidence.
#[inline(always)]
fn at_normal(eta: f64) -> f64 {
    ((eta - 1.0) / (eta + 1.0)).powi(2)
}

/// The principled model (Burley, "Physically Based Shading at Disney", 2012, and "Extending the Disney BRDF to a BSDF
/// with Integrated Subsurface Scattering", 2015) as in Mitsuba 3: from plastic to metal to glass, under a clear coat.
/// GGX facets scatter once, so rough surfaces lose energy; grazing light may gain some.
///
/// An opaque surface is the same on both sides. A transmissive one has its front on the side of the normals, and its
/// back only reflects and refracts.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    look: Look,
    facets: Once<Ggx>,
    /// Index of refraction below over that above.
    eta: f64,
    metallic: f64,
    coat: f64,
    gloss: Gtr1,
    solid: bool,
}

impl Principled {
    /// Creates the BSDF from its parameters, the index of refraction below over that above, a metalness, a coat and its
    /// gloss. `solid` tells whether the material transmits anywhere.
    pub fn new(look: Look, eta: f64, metallic: f64, [coat, gloss]: [f64; 2], solid: bool) -> Self {
        // At an index of 1 there would be no surface.
        let eta = if (eta - 1.0).abs() < 1e-3 { 1.001 } else { fresnel::bounded(eta) };
        let gloss = Gtr1::of_gloss(gloss);
        Self { look, facets: look.facets(look.roughness), eta, metallic, coat, gloss, solid }
    }

    /// Index of refraction below over that above.
    pub fn eta(&self) -> f64 {
        self.eta
    }

    /// Weights of diffuse reflection and of transmission.
    #[inline(always)]
    fn bodies(&self) -> [f64; 2] {
        let through = self.look.transmission;
        [(1.0 - self.metallic) * (1.0 - through), (1.0 - self.metallic) * through]
    }

    /// Reflectance of facets at a cosine.
    #[inline(always)]
    fn reflectance(&self, is_front: bool, cosine: f64) -> Rgb {
        let look = &self.look;
        if !is_front {
            return Rgb::splat(self.bodies()[1] * fresnel::dielectric(cosine, 1.0 / self.eta));
        }
        let (tint, plain) = (look.specular_tint, 1.0 - self.metallic);
        Rgb::splat(plain * (1.0 - tint) * fresnel::dielectric(cosine, self.eta))
            + schlick(look.base_color, cosine, self.eta) * self.metallic
            + schlick(look.tint() * at_normal(self.eta), cosine, self.eta) * (plain * tint)
    }

    /// Sampling probabilities of the diffuse part and of the coat; facets have the rest.
    #[inline(always)]
    fn shares(&self, is_front: bool) -> [f64; 2] {
        if !is_front {
            return [0.0; 2];
        }
        let [matt, _] = self.bodies();
        let coat = 0.25 * self.coat;
        let sum = 1.0 + coat + matt;
        [matt / sum, coat / sum]
    }

    /// Probability that a sampled facet reflects, at a cosine.
    #[inline(always)]
    fn reflecting(&self, is_front: bool, cosine: f64) -> f64 {
        let [_, through] = self.bodies();
        if is_front {
            1.0 - through * (1.0 - fresnel::dielectric(cosine, self.eta))
        } else {
            fresnel::dielectric(cosine, 1.0 / self.eta)
        }
    }

    /// Returns whether a direction is on the front, and the index of refraction beyond the surface.
    #[inline(always)]
    fn side(&self, wo: DVec3) -> (bool, f64) {
        let is_front = wo.z > 0.0 || !self.solid;
        (is_front, if is_front { self.eta } else { 1.0 / self.eta })
    }

    #[inline(always)]
    fn reflected(&self, is_front: bool, o: DVec3, i: DVec3) -> (Rgb, f64) {
        let [matt, coat] = self.shares(is_front);
        let (density, cosine) = self.facets.mirroring(o, i);
        let mut value = self.reflectance(is_front, cosine) * (density * self.facets.reflection_geometry(o, i));
        let drawn = self.reflecting(is_front, cosine) * self.facets.reflected_pdf(o, density);
        let mut pdf = (1.0 - matt - coat) * drawn;
        if is_front {
            let [body, _] = self.bodies();
            if body > 0.0 {
                value += self.look.matt(o, i, [body, 1.0 - self.metallic]);
                pdf += matt * i.z * FRAC_1_PI;
            }
            if self.coat > 0.0 {
                let half = (o + i).normalize_or(DVec3::Z);
                let (density, cosine) = (self.gloss.density(half), o.dot(half));
                let masked = Ggx::new([Gtr1::MASKED; 2]);
                let fresnel = schlick(Rgb::splat(Gtr1::COAT), cosine, self.eta);
                value += fresnel * (0.25 * self.coat * density * masked.masking(o) * masked.masking(i) * i.z);
                pdf += coat * density * half.z / (4.0 * cosine);
            }
        }
        (value, pdf)
    }

    #[inline(always)]
    fn refracted(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        let (is_front, eta) = self.side(wo);
        let [_, through] = self.bodies();
        let q = wo + wi * eta;
        let q = if q.z * wo.z < 0.0 { -q } else { q };
        let square = q.length_squared();
        let h = q / square.sqrt();
        let (o, i) = (wo.dot(h), -wi.dot(h));
        if through == 0.0 || square == 0.0 || o <= 0.0 || i <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let crossing = self.facets.density(h) * o * i / square;
        let [seen, both] = self.facets.refraction_geometry(wo, wi);
        let fresnel = fresnel::dielectric(o, eta);
        let [matt, coat] = self.shares(is_front);
        let drawn = (1.0 - matt - coat) * (1.0 - self.reflecting(is_front, o));
        (
            self.look.base_color.sqrt() * (through * (1.0 - fresnel) * crossing * both),
            drawn * crossing * seen * eta * eta,
        )
    }
}

impl Bsdf for Principled {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !Ggx::sees(wo) || !Ggx::sees(wi) {
            return (Rgb::ZERO, 0.0);
        }
        let (is_front, _) = self.side(wo);
        if !is_front && self.bodies()[1] == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        if wo.z * wi.z > 0.0 {
            self.reflected(is_front, above(wo), above(wi))
        } else if self.solid {
            self.refracted(wo, wi)
        } else {
            (Rgb::ZERO, 0.0)
        }
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        let (is_front, eta) = self.side(wo);
        if !Ggx::sees(wo) || (!is_front && self.bodies()[1] == 0.0) {
            return None;
        }
        let (choice, up) = (choice(), above(wo));
        let [matt, coat] = self.shares(is_front);
        let smooth = matt + coat;
        // All are computed and one is selected, because lanes have no branches.
        let (gloss, half) = (self.gloss.sample(u), self.facets.sample_visible(up, u));
        let cosine = up.dot(half);
        let between = smooth + (1.0 - smooth) * self.reflecting(is_front, cosine);
        let (bent, is_total) = fresnel::refracted(up, half, eta);
        let (is_matt, is_smooth) = (choice < matt, choice < smooth);
        let beyond = !is_smooth & (choice >= between);
        let sharp = select(beyond, bent, half * (2.0 * cosine) - up);
        let coated = select(is_smooth, gloss * (2.0 * up.dot(gloss)) - up, sharp);
        let mut wi = select(is_matt, diffuse(up, u), coated);
        let of_facet = if beyond { [between, 1.0] } else { [smooth, between] };
        let of_rest = if is_smooth { [matt, smooth] } else { of_facet };
        let choices = if is_matt { [0.0, matt] } else { of_rest };
        if (beyond & is_total) | ((wi.z > 0.0) == beyond) | !Ggx::sees(wi) {
            return None;
        }
        wi.z = wi.z.abs().copysign(if beyond { -wo.z } else { wo.z });
        let (value, pdf) = self.evaluate(wo, wi);
        let drawn = BsdfSample::new(wi, value / pdf, pdf).of_lobe(choices);
        (pdf > 0.0).then(|| if beyond { drawn.through(eta) } else { drawn })
    }

    fn albedo(&self) -> Rgb {
        self.look.base_color
    }

    fn transmits(&self) -> bool {
        self.solid
    }

    fn roughness(&self) -> f64 {
        self.facets.mean_alpha()
    }
}

/// The principled model of a thin sheet (Burley, 2015) as in Mitsuba 3: a leaf, paper, a bubble. Both sides are alike,
/// and light is transmitted straight or scattered to the other side.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    look: Look,
    /// Facets of reflection and of transmission.
    facets: [Once<Ggx>; 2],
    eta: f64,
    /// Share of diffuse light that is transmitted.
    diffuse_transmission: f64,
}

impl PrincipledThin {
    /// Creates the BSDF from its parameters, the index of refraction, and the transmitted share of diffuse light, 0 to
    /// 1.
    pub fn new(look: Look, eta: f64, diffuse_transmission: f64) -> Self {
        let eta = fresnel::bounded(eta);
        let through = look.facets(look.roughness_through(eta));
        Self { look, facets: [look.facets(look.roughness), through], eta, diffuse_transmission }
    }

    /// Cumulative sampling probabilities of the lobes: specular and diffuse, each reflected and transmitted.
    #[inline(always)]
    fn ends(&self) -> [f64; 4] {
        let sharp = self.look.transmission;
        [0.5 * sharp, sharp, 1.0 - (1.0 - sharp) * self.diffuse_transmission, 1.0]
    }
}

impl Bsdf for PrincipledThin {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !Ggx::sees(wo) || !Ggx::sees(wi) {
            return (Rgb::ZERO, 0.0);
        }
        let (look, is_through) = (&self.look, wo.z * wi.z < 0.0);
        let (o, i, sharp) = (above(wo), above(wi), look.transmission);
        let (mut value, mut pdf) = (Rgb::ZERO, 0.0);
        if sharp > 0.0 {
            let facets = if is_through { self.facets[1] } else { self.facets[0] };
            let (density, cosine) = facets.mirroring(o, i);
            let plain = fresnel::dielectric(cosine, self.eta);
            let share = if is_through {
                look.base_color * (1.0 - plain)
            } else {
                let tinted = schlick(look.tint() * at_normal(self.eta), cosine, self.eta);
                Rgb::splat(plain) * (1.0 - look.specular_tint) + tinted * look.specular_tint
            };
            value += share * (sharp * density * facets.reflection_geometry(o, i));
            pdf += 0.5 * sharp * facets.reflected_pdf(o, density);
        }
        let (matt, across) = (1.0 - sharp, self.diffuse_transmission);
        if is_through {
            value += look.base_color * (matt * across * FRAC_1_PI * i.z);
        } else {
            value += look.matt(o, i, [matt * (1.0 - across); 2]);
        }
        pdf += matt * if is_through { across } else { 1.0 - across } * i.z * FRAC_1_PI;
        (value, pdf)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !Ggx::sees(wo) {
            return None;
        }
        let (choice, up) = (choice(), above(wo));
        let [mirrored, sharp, matt, all] = self.ends();
        let (is_sharp, is_first) = (choice < sharp, choice < if choice < sharp { mirrored } else { matt });
        // Both are computed and one is selected, because lanes have no branches.
        let facets = if is_first { self.facets[0] } else { self.facets[1] };
        let mut wi = select(is_sharp, facets.sample_reflection(up, u), diffuse(up, u));
        if !(wi.z > 0.0 && Ggx::sees(wi)) {
            return None;
        }
        let is_through = !is_first;
        let of_sharp = if is_first { [0.0, mirrored] } else { [mirrored, sharp] };
        let of_matt = if is_first { [sharp, matt] } else { [matt, all] };
        let choices = if is_sharp { of_sharp } else { of_matt };
        wi.z = wi.z.copysign(if is_through { -wo.z } else { wo.z });
        let (value, pdf) = self.evaluate(wo, wi);
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
        self.facets[0].mean_alpha()
    }
}

in_lanes! {
    /// Such BSDFs, one per lane.
    PrincipledLanes of Principled {
        look: Look,
        facets: Once<Ggx>,
        eta: f64,
        metallic: f64,
        coat: f64,
        gloss: Gtr1,
        solid: bool,
    }
}

impl LaneBsdf for Principled {
    type Lanes = Straight<Self>;
}

in_lanes! {
    /// Such sheets, one per lane.
    PrincipledThinLanes of PrincipledThin { look: Look, facets: [Once<Ggx>; 2], eta: f64, diffuse_transmission: f64 }
}

impl LaneBsdf for PrincipledThin {
    type Lanes = Straight<Self>;
}

#[cfg(test)]
mod tests;
