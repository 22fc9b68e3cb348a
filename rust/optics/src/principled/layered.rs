//! The energy-conserving principled BSDF.

use super::facet_albedo::DielectricShares;
use super::{Gtr1, Look};
use crate::albedo::MirrorLoss;
use crate::bsdf_columns::LaneBsdf;
use crate::conductor::{above, made_up};
use crate::lobes::{Grazing, diffuse};
use crate::scalar_lanes::Looped;
use crate::{Bsdf, BsdfSample, Dielectric, Facets, Ggx, Rgb, Tinted, fresnel};
use raywright_base::math::DVec3;
use std::f64::consts::FRAC_1_PI;

/// The principled model (Burley, 2012 and 2015) with energy conservation. It is a mixture of metal, of a diffuse base
/// under a dielectric, and of a clear dielectric, each energy-conserving; the first two have a clear coat.
///
/// Losses of metal facets are compensated (Kulla and Conty, 2017). The base gets the light that facets above transmit,
/// (1 − R(wo)) (1 − R(wi)) / (π (1 − R̄)), and distributes it over azimuths like Burley's. The clear dielectric is
/// [`Dielectric`]. A coat with reflectance E(ω), k at most, transmits 1 − k to the layer below. The rest is scattered
/// diffusely in the base color, (k − E(wo)) (k − E(wi)) / (π (k − Ē)). Everything is reciprocal, and white if the base
/// is.
///
/// An opaque surface is the same on both sides.
#[derive(Clone, Copy, Debug)]
pub struct LayeredPrincipled {
    look: Look,
    /// Facets of metal; isotropic if there is no metal.
    facets: Ggx,
    /// Index of refraction below over that above.
    eta: f64,
    metallic: f64,
    /// Weight of the coat.
    coat: f64,
    gloss: Gtr1,
    /// One over π and the mean transmittance to the base.
    base: Rgb,
    /// Multiple scattering of metal, over π and the mean loss.
    multiple: Rgb,
}

/// Precomputed data of a direction above.
#[derive(Clone, Copy, Debug)]
struct LayerTerms {
    /// Loss of perfectly reflecting metal facets.
    lost: f64,
    /// Albedo of the dielectric facets over the base.
    reflected: Rgb,
    /// Albedo of the coat.
    coated: f64,
}

/// Sampling probabilities of the lobes; the clear dielectric has the rest.
#[derive(Clone, Copy, Debug)]
struct Shares {
    /// Facets of metal, and of the dielectric over the base.
    metal: f64,
    dielectric: f64,
    multiple: f64,
    coat: f64,
    matt: f64,
}

impl Shares {
    /// Cumulative probabilities.
    #[inline(always)]
    fn ends(&self) -> [f64; 5] {
        let mut end = 0.0;
        [self.metal, self.dielectric, self.multiple, self.coat, self.matt].map(|share| {
            end += share;
            end
        })
    }

    /// Probability of the clear dielectric.
    #[inline(always)]
    fn clear(&self) -> f64 {
        let left = 1.0 - self.ends()[4];
        // Drops a remainder that is only rounding.
        if left > 1e-12 { left } else { 0.0 }
    }
}

impl LayeredPrincipled {
    /// Creates the BSDF from its parameters, the index of refraction below over that above, a metalness, a coat and its
    /// gloss.
    pub fn new(look: Look, eta: f64, metallic: f64, [coat, gloss]: [f64; 2]) -> Self {
        // At an index of 1 there would be no surface.
        let eta = if (eta - 1.0).abs() < 1e-3 { 1.001 } else { fresnel::bounded(eta) };
        let facets = Ggx::new(look.slopes(look.roughness));
        let lost = MirrorLoss::new(facets).average();
        let mut made = Self {
            look,
            facets,
            eta,
            metallic,
            coat: 0.25 * coat,
            gloss: Gtr1::of_gloss(gloss),
            base: Rgb::ZERO,
            multiple: made_up(lost, look.base_color + (Rgb::ONE - look.base_color) / 21.0),
        };
        if made.bodies()[1] > 0.0 {
            let reaching = Rgb::ONE - made.dielectric().average();
            made.base = Rgb::splat(FRAC_1_PI) / reaching.at_least(Rgb::splat(1e-6));
        }
        made
    }

    /// Weights of metal, diffuse base and clear dielectric.
    #[inline(always)]
    fn bodies(&self) -> [f64; 3] {
        let (plain, through) = (1.0 - self.metallic, self.look.transmission);
        [self.metallic, plain * (1.0 - through), plain * through]
    }

    /// The dielectric over the base. From inside the denser medium it is assumed to reflect as from outside.
    #[inline(always)]
    fn dielectric(&self) -> DielectricShares {
        DielectricShares::new(&self.look, self.look.roughness, self.eta.max(1.0 / self.eta))
    }

    /// The clear dielectric. Its transmission has the square root of the base color, because light crosses two
    /// surfaces.
    #[inline(always)]
    fn clear(&self) -> Tinted<Dielectric> {
        let inner = Dielectric::of(self.eta, Some(self.dielectric().facets));
        Tinted { inner, reflectance: Rgb::ONE, transmittance: self.look.base_color.sqrt() }
    }

    /// Maximum and mean albedo of the coat.
    #[inline(always)]
    fn coat_bounds(&self) -> [f64; 2] {
        [self.coat * self.gloss.albedo(1.0), self.coat * self.gloss.albedo_average()]
    }

    #[inline(always)]
    fn known(&self, w: DVec3) -> LayerTerms {
        let [metal, matt, _] = self.bodies();
        LayerTerms {
            lost: if metal > 0.0 { MirrorLoss::new(self.facets).of(w) } else { 0.0 },
            reflected: if matt > 0.0 { self.dielectric().of(w.z) } else { Rgb::ZERO },
            coated: if self.coat > 0.0 { self.coat * self.gloss.albedo(w.z) } else { 0.0 },
        }
    }

    /// Sampling probabilities for `wo`, above.
    #[inline(always)]
    fn shares(&self, known: &LayerTerms, wo: DVec3) -> Shares {
        let ([metal, matt, clear], color) = (self.bodies(), self.look.base_color.max());
        let [most, _] = self.coat_bounds();
        let opaque = metal + matt;
        let mirrored = color + (1.0 - color) * fresnel::schlick_weight(wo.z);
        let lobes = [
            (1.0 - most) * metal * mirrored * (1.0 - known.lost),
            (1.0 - most) * matt * known.reflected.max(),
            (1.0 - most) * metal * color * known.lost,
            opaque * known.coated,
            (1.0 - most) * matt * color.max(self.look.sheen) * (1.0 - known.reflected.min())
                + opaque * color * (most - known.coated).max(0.0),
        ];
        let sum: f64 = lobes.iter().sum();
        let scale = if sum > 0.0 { opaque / (opaque.max(1e-300) * (sum + clear)) } else { 0.0 };
        let [metal, dielectric, multiple, coat, matt] = lobes.map(|lobe| lobe * scale);
        Shares { metal, dielectric, multiple, coat, matt }
    }

    /// Value and density without the clear dielectric, between two directions above, with the cosine.
    #[inline(always)]
    fn opaque(&self, shares: &Shares, [o, i]: [DVec3; 2], [of_o, of_i]: [&LayerTerms; 2]) -> (Rgb, f64) {
        let [metal, matt, _] = self.bodies();
        let (mut value, mut pdf) = (Rgb::ZERO, shares.matt * i.z * FRAC_1_PI);
        if metal > 0.0 {
            let (density, cosine) = self.facets.mirroring(o, i);
            let once = density * self.facets.reflection_geometry(o, i);
            let again = self.multiple * (of_o.lost * of_i.lost * i.z);
            value = (fresnel::schlick(cosine, self.look.base_color) * once + again) * metal;
            let grazing = Grazing::new(self.facets.mean_alpha());
            pdf += shares.metal * self.facets.reflected_pdf(o, density) + shares.multiple * grazing.pdf(i.z);
        }
        if matt > 0.0 {
            let coat = self.dielectric();
            let (density, cosine) = coat.facets.mirroring(o, i);
            let once = density * coat.facets.reflection_geometry(o, i);
            let reaching = (Rgb::ONE - of_o.reflected) * (Rgb::ONE - of_i.reflected);
            value += (coat.fresnel(cosine) * once + self.look.spread(o, i) * reaching * self.base * i.z) * matt;
            pdf += shares.dielectric * coat.facets.reflected_pdf(o, density);
        }
        if self.coat > 0.0 {
            let [most, mean] = self.coat_bounds();
            let half = (o + i).normalize_or(DVec3::Z);
            let (density, cosine) = (self.gloss.density(half), o.dot(half));
            let rest = (most - of_o.coated) * (most - of_i.coated) / (most - mean);
            let coat = self.coat * self.gloss.reflected(density, cosine, [o, i]);
            let over = Rgb::splat(coat) + self.look.base_color * (rest * FRAC_1_PI * i.z);
            value = value * (1.0 - most) + over * (metal + matt);
            pdf += shares.coat * density * half.z / (4.0 * cosine);
        }
        (value, pdf)
    }

    /// Total value and density.
    #[inline(always)]
    fn scattered(&self, wo: DVec3, wi: DVec3, known: &LayerTerms, shares: &Shares) -> (Rgb, f64) {
        let [metal, matt, clear] = self.bodies();
        let (mut value, mut pdf) = (Rgb::ZERO, 0.0);
        if metal + matt > 0.0 && wo.z * wi.z > 0.0 {
            let (o, i) = (above(wo), above(wi));
            (value, pdf) = self.opaque(shares, [o, i], [known, &self.known(i)]);
        }
        if clear > 0.0 {
            let (of_clear, density) = self.clear().evaluate(wo, wi);
            value += of_clear * clear;
            pdf += shares.clear() * density;
        }
        (value, pdf)
    }
}

impl Bsdf for LayeredPrincipled {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !Ggx::sees(wo) || !Ggx::sees(wi) {
            return (Rgb::ZERO, 0.0);
        }
        let known = self.known(above(wo));
        self.scattered(wo, wi, &known, &self.shares(&known, above(wo)))
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !Ggx::sees(wo) {
            return None;
        }
        let (choice, up) = (choice(), above(wo));
        let known = self.known(up);
        let shares = self.shares(&known, up);
        let (ends, clear) = (shares.ends(), shares.clear());
        let opaque = ends[4];
        let (wi, choices, eta) = if choice < opaque || clear <= 0.0 {
            let lobe = ends.iter().position(|&end| choice < end).unwrap_or(4);
            let mut wi = match lobe {
                0 => self.facets.sample_reflection(up, u),
                1 => self.dielectric().facets.sample_reflection(up, u),
                2 => Grazing::new(self.facets.mean_alpha()).sample(u),
                3 => {
                    let half = self.gloss.sample(u);
                    half * (2.0 * up.dot(half)) - up
                }
                _ => diffuse(up, u),
            };
            if wi.z <= 0.0 {
                return None;
            }
            wi.z = wi.z.copysign(wo.z);
            (wi, [if lobe == 0 { 0.0 } else { ends[lobe - 1] }, ends[lobe]], 1.0)
        } else {
            let of_clear = ((choice - opaque) / clear).clamp(0.0, 1.0 - f64::EPSILON);
            let drawn = self.clear().sample(wo, &mut || of_clear, u)?;
            (drawn.wi, drawn.choices.map(|end| opaque + clear * end), drawn.eta)
        };
        if !Ggx::sees(wi) {
            return None;
        }
        let (value, pdf) = self.scattered(wo, wi, &known, &shares);
        let drawn = BsdfSample::new(wi, value / pdf, pdf).of_lobe(choices);
        (pdf > 0.0).then(|| if wo.z * wi.z < 0.0 { drawn.through(eta) } else { drawn })
    }

    fn albedo(&self) -> Rgb {
        self.look.base_color
    }

    fn transmits(&self) -> bool {
        self.bodies()[2] > 0.0
    }

    fn roughness(&self) -> f64 {
        self.facets.mean_alpha()
    }
}

impl LaneBsdf for LayeredPrincipled {
    type Lanes = Looped;
}
