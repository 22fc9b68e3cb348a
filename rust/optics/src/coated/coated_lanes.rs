//! Coated BRDFs in batches of lanes.

use super::{Coated, above, diffuse, mirrored, mirrors};
use crate::albedo::Tabulated;
use crate::bsdf_columns::{BsdfColumns, LaneBsdf};
use crate::{BsdfSampleLanes, Rgb, RgbLanes, fresnel};
use raywright_base::math::{DVec3, LANES, VectorLanes, select};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use std::array::from_fn;
use std::marker::PhantomData;

/// Coated BRDFs in structure-of-arrays form, each with an outgoing direction.
#[derive(Clone, Debug)]
pub struct CoatedLanes<F> {
    is_rough: [bool; LANES],
    alpha: [f64; LANES],
    eta: [f64; LANES],
    base: RgbLanes,
    average: [f64; LANES],
    wo: VectorLanes,
    /// Reflectance of the coat for `wo`, and sampling probability of the coat.
    reflectance: [f64; LANES],
    share: [f64; LANES],
    kind: PhantomData<F>,
}

impl<F: Tabulated> LaneBsdf for Coated<F> {
    type Lanes = CoatedLanes<F>;
}

loops! {
    /// Facets that mirror between two directions, and the reflectance of a smooth coat for the incident one.
    fn mirror<F: Tabulated>(
        of: &CoatedLanes<F>,
        wi: &VectorLanes,
        density: &mut [f64; LANES],
        cosine: &mut [f64; LANES],
        there: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (wo, wi) = (above(of.wo.get(i)), above(wi.get(i)));
            (density[i], cosine[i]) = of.facets(i).mirroring(wo, wi);
            there[i] = fresnel::dielectric(wi.z, of.eta[i]);
        }
    }
}

loops! {
    /// BRDF values from the precomputed and looked-up data.
    fn scatter<F: Tabulated>(
        of: &CoatedLanes<F>,
        wi: &VectorLanes,
        density: &[f64; LANES],
        cosine: &[f64; LANES],
        there: &[f64; LANES],
        asks: &[bool; LANES],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (o, w) = (of.wo.get(i), wi.get(i));
            let is_seen = asks[i] & mirrors::<F>(o, w);
            let (o, w, share) = (above(o), above(w), of.share[i]);
            let base = (of.base.get(i), of.average[i]);
            let (matt, by_cosine) = Coated::<F>::matt(base, share, w, [of.reflectance[i], there[i]]);
            let told = (density[i], cosine[i]);
            let coated = (&of.facets(i), of.eta[i]);
            let (coat, glossy) = Coated::glossy(coated, share, [o, w], told);
            let scattered = Rgb::select(of.is_rough[i], matt + coat, matt);
            let drawn = if of.is_rough[i] { glossy + by_cosine } else { by_cosine };
            value.set(i, Rgb::select(is_seen, scattered, Rgb::ZERO));
            pdf[i] = if is_seen { drawn } else { 0.0 };
        }
    }
}

loops! {
    /// Incident directions, in lanes with a set flag and a visible `wo`; `is_single` marks delta samples.
    fn draw<F: Tabulated>(
        of: &CoatedLanes<F>,
        choice: &[f64; LANES],
        u: &Pairs,
        asks: &[bool; LANES],
        wi: &mut VectorLanes,
        goes: &mut [bool; LANES],
        is_single: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let (wo, u) = (of.wo.get(i), [u[0][i], u[1][i]]);
            let (up, is_coat) = (above(wo), choice[i] < of.share[i]);
            let glossy = select(of.is_rough[i], of.facets(i).sample_reflection(up, u), mirrored(up));
            let drawn = select(is_coat, glossy, diffuse(up, u));
            goes[i] = asks[i] & F::sees(wo) & (drawn.z > 0.0);
            is_single[i] = goes[i] & is_coat & !of.is_rough[i];
            wi.set(i, DVec3::new(drawn.x, drawn.y, drawn.z.copysign(wo.z)));
        }
    }
}

loops! {
    /// Converts values to throughput factors; a delta sample has that of the coat.
    fn weigh<F: Tabulated>(
        of: &CoatedLanes<F>,
        is_single: &[bool; LANES],
        pdf: &mut [f64; LANES],
        value: &mut RgbLanes,
    ) {
        for i in 0..LANES {
            let single = Rgb::splat(of.reflectance[i] / of.share[i]);
            value.set(i, Rgb::select(is_single[i], single, value.get(i) / pdf[i]));
            pdf[i] = if is_single[i] { f64::INFINITY } else { pdf[i] };
        }
    }
}

impl<F: Tabulated> CoatedLanes<F> {
    #[inline(always)]
    fn facets(&self, lane: usize) -> F {
        F::with([self.alpha[lane]; 2])
    }
}

impl<F: Tabulated> BsdfColumns<Coated<F>> for CoatedLanes<F> {
    const NONE: Self = Self {
        is_rough: [false; LANES],
        alpha: [1.0; LANES],
        eta: [1.0; LANES],
        base: RgbLanes::ZERO,
        average: [0.0; LANES],
        wo: VectorLanes::ZERO,
        reflectance: [0.0; LANES],
        share: [0.0; LANES],
        kind: PhantomData,
    };

    #[inline]
    fn set(&mut self, lane: usize, plastic: &Coated<F>, wo: DVec3) {
        self.is_rough[lane] = plastic.rough.is_some();
        if let Some(rough) = &plastic.rough {
            self.alpha[lane] = rough.facets.alpha()[0];
        }
        (self.eta[lane], self.average[lane]) = (plastic.eta, plastic.average);
        self.base.set(lane, plastic.base);
        self.wo.set(lane, wo);
        let reflectance = plastic.reflectance(above(wo));
        (self.reflectance[lane], self.share[lane]) = (reflectance, plastic.share(reflectance));
    }

    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Coated<F>> + Copy,
        asks: &[bool; LANES],
        [_, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        F: 'a,
    {
        let [mut density, mut cosine, mut there] = [[0.0; LANES]; 3];
        mirror(level, self, wi, &mut density, &mut cosine, &mut there);
        for lane in (0..LANES).filter(|&lane| asks[lane] && self.is_rough[lane]) {
            if let Some(plastic) = each(lane) {
                there[lane] = plastic.reflectance(above(wi.get(lane)));
            }
        }
        scatter(level, self, wi, &density, &cosine, &there, asks, value, pdf);
    }

    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Coated<F>> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        F: 'a,
    {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        let [mut goes, mut is_single] = [[false; LANES]; 2];
        draw(level, self, choice, u, asks, wi, &mut goes, &mut is_single);
        let scatters = from_fn(|lane| goes[lane] && !is_single[lane]);
        self.evaluate(level, each, &scatters, [wo, wi], weight, pdf);
        weigh(level, self, &is_single, pdf, weight);
        (*eta, *is_through) = ([1.0; LANES], [false; LANES]);
    }
}
