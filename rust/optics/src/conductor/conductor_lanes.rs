//! Conductors in batches of lanes.

use super::{Conductor, RoughFacets, above, mirrored, mirrors};
use crate::bsdf_columns::{BsdfColumns, LaneBsdf};
use crate::conductors::Reflectance;
use crate::energy_loss::{Lossy, Lost};
use crate::fresnel::ConductorIndex;
use crate::lobes::{Grazing, GrazingLanes};
use crate::{BsdfSampleLanes, Rgb, RgbLanes};
use raywright_base::math::{DVec3, InLanes, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use std::array::from_fn;
use std::marker::PhantomData;

/// Conductors in structure-of-arrays form, each with an outgoing direction.
#[derive(Clone, Debug)]
pub struct ConductorLanes<F> {
    is_rough: [bool; LANES],
    alpha: [[f64; LANES]; 2],
    multiple: RgbLanes,
    grazing: GrazingLanes,
    /// Complex index of refraction, in lanes that are given by one; others are looked up.
    index: [RgbLanes; 2],
    is_by_index: [bool; LANES],
    wo: VectorLanes,
    /// Loss for `wo`.
    lost: [f64; LANES],
    kind: PhantomData<F>,
}

impl<F: Lossy> LaneBsdf for Conductor<F> {
    type Lanes = ConductorLanes<F>;
}

loops! {
    /// Facets that mirror between two directions, with the reflectance of lanes given by an index.
    fn mirror<F: Lossy>(
        of: &ConductorLanes<F>,
        wi: &VectorLanes,
        density: &mut [f64; LANES],
        cosine: &mut [f64; LANES],
        reflectance: &mut RgbLanes,
    ) {
        for i in 0..LANES {
            (density[i], cosine[i]) = of.facets(i).mirroring(above(of.wo.get(i)), above(wi.get(i)));
        }
        for i in 0..LANES {
            let index = ConductorIndex::with([of.index[0].get(i), of.index[1].get(i)]);
            reflectance.set(i, index.reflectance(cosine[i]));
        }
    }
}

loops! {
    /// Reflectance of smooth conductors given by an index.
    fn reflect<F: Lossy>(of: &ConductorLanes<F>, reflectance: &mut RgbLanes) {
        for i in 0..LANES {
            let index = ConductorIndex::with([of.index[0].get(i), of.index[1].get(i)]);
            reflectance.set(i, index.reflectance(of.wo.get(i).z.abs()));
        }
    }
}

loops! {
    /// BRDF values from the precomputed and looked-up data.
    fn scatter<F: Lossy>(
        of: &ConductorLanes<F>,
        wi: &VectorLanes,
        density: &[f64; LANES],
        reflectance: &RgbLanes,
        lost: &[f64; LANES],
        asks: &[bool; LANES],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (o, w) = (of.wo.get(i), wi.get(i));
            let (facets, grazing) = (of.facets(i), Grazing::get(&of.grazing, i));
            let parts = (&facets, of.multiple.get(i), &grazing);
            let told = (density[i], reflectance.get(i));
            let (scattered, drawn) = RoughFacets::scattered(parts, [above(o), above(w)], told, [of.lost[i], lost[i]]);
            let is_seen = asks[i] & mirrors::<F>(o, w);
            value.set(i, Rgb::select(is_seen, scattered, Rgb::ZERO));
            pdf[i] = if is_seen { drawn } else { 0.0 };
        }
    }
}

loops! {
    /// Samples incident directions by facet reflection, above.
    fn draw<F: Lossy>(of: &ConductorLanes<F>, u: &Pairs, wi: &mut VectorLanes) {
        for i in 0..LANES {
            wi.set(i, of.facets(i).sample_reflection(above(of.wo.get(i)), [u[0][i], u[1][i]]));
        }
    }
}

loops! {
    /// Mirrors directions to the side of `wo`, in lanes with a set flag and a visible `wo`.
    fn turn<F: Lossy>(of: &ConductorLanes<F>, asks: &[bool; LANES], wi: &mut VectorLanes, goes: &mut [bool; LANES]) {
        for i in 0..LANES {
            let (wo, drawn) = (of.wo.get(i), wi.get(i));
            goes[i] = asks[i] & F::sees(wo) & (drawn.z > 0.0);
            wi.set(i, DVec3::new(drawn.x, drawn.y, drawn.z.copysign(wo.z)));
        }
    }
}

loops! {
    /// Converts values to throughput factors.
    fn weigh(pdf: &[f64; LANES], value: &mut RgbLanes) {
        for i in 0..LANES {
            value.set(i, value.get(i) / pdf[i]);
        }
    }
}

loops! {
    /// Specular directions, in lanes with a set flag.
    fn mirror_all<F: Lossy>(
        of: &ConductorLanes<F>,
        asks: &[bool; LANES],
        wi: &mut VectorLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let wo = of.wo.get(i);
            wi.set(i, mirrored(wo));
            pdf[i] = if asks[i] & F::sees(wo) { f64::INFINITY } else { 0.0 };
        }
    }
}

impl<F: Lossy> ConductorLanes<F> {
    #[inline(always)]
    fn facets(&self, lane: usize) -> F {
        F::with([self.alpha[0][lane], self.alpha[1][lane]])
    }

    /// Samples smooth conductors, in lanes with a set flag.
    fn sample_smooth<'a>(
        &self,
        level: Level,
        metals: impl Fn(usize) -> Option<&'a Conductor<F>>,
        asks: &[bool; LANES],
        drawn: &mut BsdfSampleLanes,
    ) where
        F: 'a,
    {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        reflect(level, self, weight);
        for lane in (0..LANES).filter(|&lane| asks[lane] && !self.is_by_index[lane]) {
            if let Some(metal) = metals(lane) {
                weight.set(lane, metal.reflectance(self.wo.get(lane).z.abs()));
            }
        }
        mirror_all(level, self, asks, wi, pdf);
        (*eta, *is_through) = ([1.0; LANES], [false; LANES]);
    }
}

impl<F: Lossy> BsdfColumns<Conductor<F>> for ConductorLanes<F> {
    const NONE: Self = Self {
        is_rough: [false; LANES],
        alpha: [[1.0; LANES]; 2],
        multiple: RgbLanes::ZERO,
        grazing: Grazing::EMPTY,
        index: [RgbLanes::ZERO; 2],
        is_by_index: [false; LANES],
        wo: VectorLanes::ZERO,
        lost: [0.0; LANES],
        kind: PhantomData,
    };

    #[inline]
    fn set(&mut self, lane: usize, metal: &Conductor<F>, wo: DVec3) {
        self.is_rough[lane] = metal.rough.is_some();
        if let Some(rough) = &metal.rough {
            [self.alpha[0][lane], self.alpha[1][lane]] = rough.facets.alpha();
            self.multiple.set(lane, rough.multiple);
            rough.grazing.put(&mut self.grazing, lane);
            self.lost[lane] = rough.loss.of(above(wo));
        }
        self.is_by_index[lane] = false;
        if let Reflectance::Index(index) = &metal.fresnel {
            let [real, imaginary2] = index.parts();
            self.index[0].set(lane, real);
            self.index[1].set(lane, imaginary2);
            self.is_by_index[lane] = true;
        }
        self.wo.set(lane, wo);
    }

    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Conductor<F>> + Copy,
        asks: &[bool; LANES],
        [_, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        F: 'a,
    {
        let asks = &from_fn(|lane| asks[lane] && self.is_rough[lane]);
        if !asks.contains(&true) {
            (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]);
            return;
        }
        let ([mut density, mut cosine, mut lost], mut reflectance) = ([[0.0; LANES]; 3], RgbLanes::ZERO);
        mirror(level, self, wi, &mut density, &mut cosine, &mut reflectance);
        for lane in (0..LANES).filter(|&lane| asks[lane]) {
            let Some(metal) = each(lane) else { continue };
            if let Some(rough) = &metal.rough {
                lost[lane] = rough.loss.of(above(wi.get(lane)));
            }
            if !self.is_by_index[lane] {
                reflectance.set(lane, metal.reflectance(cosine[lane]));
            }
        }
        scatter(level, self, wi, &density, &reflectance, &lost, asks, value, pdf);
    }

    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Conductor<F>> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        F: 'a,
    {
        let are = |rough: bool| from_fn(|lane| asks[lane] && self.is_rough[lane] == rough);
        let [smooth, rough]: [[bool; LANES]; 2] = [false, true].map(are);
        if !rough.contains(&true) {
            return self.sample_smooth(level, each, &smooth, drawn);
        }
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = &mut *drawn;
        draw(level, self, u, wi);
        for lane in (0..LANES).filter(|&lane| rough[lane] && choice[lane] < self.lost[lane]) {
            let grazing = Grazing::get(&self.grazing, lane);
            wi.set(lane, grazing.sample([u[0][lane], u[1][lane]]));
        }
        let mut goes = [false; LANES];
        turn(level, self, &rough, wi, &mut goes);
        self.evaluate(level, each, &goes, [wo, wi], weight, pdf);
        weigh(level, pdf, weight);
        (*eta, *is_through) = ([1.0; LANES], [false; LANES]);
        if smooth.contains(&true) {
            let mut single = BsdfSampleLanes::NONE;
            self.sample_smooth(level, each, &smooth, &mut single);
            drawn.take(&smooth, &single);
        }
    }
}
