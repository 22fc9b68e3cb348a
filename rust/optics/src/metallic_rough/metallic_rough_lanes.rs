//! Metallic-roughness BRDFs in batches of lanes.

use super::{Ends, MetallicRough, above, diffuse, mirrored, mirrors};
use crate::bsdf_columns::{BsdfColumns, LaneBsdf};
use crate::lobes::{Grazing, GrazingLanes};
use crate::{BsdfSampleLanes, Facets, Ggx, Rgb, RgbLanes, fresnel};
use raywright_base::math::{DVec3, InLanes, LANES, VectorLanes, select};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use std::array::from_fn;

/// Metallic-roughness BRDFs in structure-of-arrays form, each with an outgoing direction.
#[derive(Clone, Debug)]
pub struct MetallicRoughLanes {
    is_rough: [bool; LANES],
    alpha: [f64; LANES],
    base: RgbLanes,
    multiple: RgbLanes,
    f0: RgbLanes,
    f90: [f64; LANES],
    /// Reflectances of the dielectric at normal and grazing incidence.
    dielectric: [[f64; LANES]; 2],
    grazing: GrazingLanes,
    wo: VectorLanes,
    /// Single-scattering albedos of `wo`, and sampling probabilities of single and multiple scattering.
    once: [[f64; LANES]; 2],
    shares: [[f64; LANES]; 2],
}

impl LaneBsdf for MetallicRough {
    type Lanes = MetallicRoughLanes;
}

loops! {
    /// Facets that mirror between two directions, and Schlick's weight of the incident one.
    fn mirror(
        of: &MetallicRoughLanes,
        wi: &VectorLanes,
        density: &mut [f64; LANES],
        cosine: &mut [f64; LANES],
        schlick: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (wo, wi) = (above(of.wo.get(i)), above(wi.get(i)));
            (density[i], cosine[i]) = of.facets(i).mirroring(wo, wi);
            schlick[i] = fresnel::schlick_weight(wi.z);
        }
    }
}

loops! {
    /// BRDF values from the precomputed and looked-up data.
    fn scatter(
        of: &MetallicRoughLanes,
        wi: &VectorLanes,
        density: &[f64; LANES],
        cosine: &[f64; LANES],
        schlick: &[f64; LANES],
        kept: &[f64; LANES],
        asks: &[bool; LANES],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (o, w) = (of.wo.get(i), wi.get(i));
            let is_seen = asks[i] & mirrors::<Ggx>(o, w);
            let (o, w, shares) = (above(o), above(w), [of.shares[0][i], of.shares[1][i]]);
            let once = [(of.once[0][i], of.once[1][i]), (schlick[i], kept[i])];
            let grazing = of.grazing(i);
            let dielectric = Ends { normal: of.dielectric[0][i], grazing: of.dielectric[1][i] };
            let parts = (of.base.get(i), of.multiple.get(i), &grazing, dielectric);
            let (wide, [spread, matt]) = MetallicRough::wide(parts, shares, w, once);
            let told = (density[i], cosine[i]);
            let facets = (&of.facets(i), of.f0.get(i), of.f90[i]);
            let (glossy, facet) = MetallicRough::glossy(facets, shares[0], [o, w], told);
            let scattered = Rgb::select(of.is_rough[i], wide + glossy, wide);
            let drawn = if of.is_rough[i] { facet + spread + matt } else { spread + matt };
            value.set(i, Rgb::select(is_seen, scattered, Rgb::ZERO));
            pdf[i] = if is_seen { drawn } else { 0.0 };
        }
    }
}

loops! {
    /// Samples incident directions above: by facet reflection, or by cosine.
    fn draw(of: &MetallicRoughLanes, choice: &[f64; LANES], u: &Pairs, wi: &mut VectorLanes) {
        for i in 0..LANES {
            let (up, u) = (above(of.wo.get(i)), [u[0][i], u[1][i]]);
            let glossy = select(of.is_rough[i], of.facets(i).sample_reflection(up, u), mirrored(up));
            wi.set(i, select(choice[i] < of.shares[0][i], glossy, diffuse(up, u)));
        }
    }
}

loops! {
    /// Mirrors directions to the side of `wo`, in lanes with a set flag and a visible `wo`; `is_single` marks delta
    /// samples.
    fn turn(
        of: &MetallicRoughLanes,
        choice: &[f64; LANES],
        asks: &[bool; LANES],
        wi: &mut VectorLanes,
        goes: &mut [bool; LANES],
        is_single: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let (wo, drawn) = (of.wo.get(i), wi.get(i));
            goes[i] = asks[i] & Ggx::sees(wo) & (drawn.z > 0.0);
            is_single[i] = goes[i] & (choice[i] < of.shares[0][i]) & !of.is_rough[i];
            wi.set(i, DVec3::new(drawn.x, drawn.y, drawn.z.copysign(wo.z)));
        }
    }
}

loops! {
    /// Converts values to throughput factors; a delta sample has that of the facets.
    fn weigh(of: &MetallicRoughLanes, is_single: &[bool; LANES], pdf: &mut [f64; LANES], value: &mut RgbLanes) {
        for i in 0..LANES {
            let single = fresnel::schlick_between(of.wo.get(i).z.abs(), of.f0.get(i), of.f90[i]) / of.shares[0][i];
            value.set(i, Rgb::select(is_single[i], single, value.get(i) / pdf[i]));
            pdf[i] = if is_single[i] { f64::INFINITY } else { pdf[i] };
        }
    }
}

impl MetallicRoughLanes {
    #[inline(always)]
    fn facets(&self, lane: usize) -> Ggx {
        Ggx::with([self.alpha[lane]; 2])
    }

    #[inline(always)]
    fn grazing(&self, lane: usize) -> Grazing {
        Grazing::get(&self.grazing, lane)
    }
}

impl BsdfColumns<MetallicRough> for MetallicRoughLanes {
    const NONE: Self = Self {
        is_rough: [false; LANES],
        alpha: [1.0; LANES],
        base: RgbLanes::ZERO,
        multiple: RgbLanes::ZERO,
        f0: RgbLanes::ZERO,
        f90: [1.0; LANES],
        dielectric: [[0.0; LANES]; 2],
        grazing: Grazing::EMPTY,
        wo: VectorLanes::ZERO,
        once: [[0.0; LANES]; 2],
        shares: [[0.0; LANES]; 2],
    };

    #[inline]
    fn set(&mut self, lane: usize, of: &MetallicRough, wo: DVec3) {
        self.is_rough[lane] = of.rough.is_some();
        if let Some(rough) = &of.rough {
            self.alpha[lane] = rough.ggx.alpha()[0];
        }
        self.base.set(lane, of.base);
        self.multiple.set(lane, of.multiple);
        self.f0.set(lane, of.f0());
        self.f90[lane] = of.f90();
        [self.dielectric[0][lane], self.dielectric[1][lane]] = [of.dielectric.normal, of.dielectric.grazing];
        of.grazing.put(&mut self.grazing, lane);
        self.wo.set(lane, wo);
        let once = of.once(above(wo));
        (self.once[0][lane], self.once[1][lane]) = once;
        [self.shares[0][lane], self.shares[1][lane]] = of.shares(once);
    }

    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a MetallicRough> + Copy,
        asks: &[bool; LANES],
        [_, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        let ([mut density, mut cosine, mut schlick], mut kept) = ([[0.0; LANES]; 3], [1.0; LANES]);
        mirror(level, self, wi, &mut density, &mut cosine, &mut schlick);
        for lane in (0..LANES).filter(|&lane| asks[lane] && self.is_rough[lane]) {
            if let Some(of) = each(lane) {
                (schlick[lane], kept[lane]) = of.once(above(wi.get(lane)));
            }
        }
        scatter(level, self, wi, &density, &cosine, &schlick, &kept, asks, value, pdf);
    }

    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a MetallicRough> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        draw(level, self, choice, u, wi);
        let is_multiple = |lane: usize| {
            let [facets, metal] = [self.shares[0][lane], self.shares[1][lane]];
            (facets..facets + metal).contains(&choice[lane])
        };
        for lane in (0..LANES).filter(|&lane| asks[lane] && is_multiple(lane)) {
            wi.set(lane, self.grazing(lane).sample([u[0][lane], u[1][lane]]));
        }
        let [mut goes, mut is_single] = [[false; LANES]; 2];
        turn(level, self, choice, asks, wi, &mut goes, &mut is_single);
        let scatters = from_fn(|lane| goes[lane] && !is_single[lane]);
        self.evaluate(level, each, &scatters, [wo, wi], weight, pdf);
        weigh(level, self, &is_single, pdf, weight);
        (*eta, *is_through) = ([1.0; LANES], [false; LANES]);
    }
}
