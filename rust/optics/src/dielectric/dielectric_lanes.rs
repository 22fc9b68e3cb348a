//! Dielectric interfaces in batches of lanes.

use super::facet::{Bent, Divided, FacetLanes, Microfacet, seen};
use super::{Dielectric, FacetTerms, KnownLanes, Rough, Single};
use crate::bsdf_columns::{BsdfColumns, LaneBsdf};
use crate::energy_loss::{Lossy, LostBetween};
use crate::interface_split::{Share, Split, beyond};
use crate::lobes::{Grazing, GrazingLanes};
use crate::{BsdfSampleLanes, Facets, Rgb, RgbLanes};
use raywright_base::math::{DVec3, InLanes, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use std::array::from_fn;
use std::marker::PhantomData;

/// Dielectric interfaces in structure-of-arrays form, each with an outgoing direction.
#[derive(Clone, Debug)]
pub struct DielectricLanes<F> {
    /// Index of refraction below over index above.
    etas: [f64; LANES],
    is_rough: [bool; LANES],
    alpha: [f64; LANES],
    known: KnownLanes,
    /// Distributions of the compensation lobe, above and below.
    grazing: [GrazingLanes; 2],
    kind: PhantomData<F>,
}

impl<F: Lossy, S: Split> LaneBsdf for Dielectric<F, S> {
    type Lanes = DielectricLanes<F>;
}

loops! {
    /// Cosines of directions.
    fn cosine(wo: &VectorLanes, cosines: &mut [f64; LANES]) {
        for i in 0..LANES {
            cosines[i] = wo.get(i).z.abs();
        }
    }
}

loops! {
    /// Samples smooth interfaces with the given reflectances, in lanes with a set flag.
    fn draw<F: Facets, S: Share>(
        of: &DielectricLanes<F>,
        wo: &VectorLanes,
        reflectance: &S::Lanes,
        choice: &[f64; LANES],
        asks: &[bool; LANES],
        wi: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
        eta: &mut [f64; LANES],
        is_through: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let wo = wo.get(i);
            let over = beyond(of.etas[i], wo);
            let drawn = Single::new(wo, over, S::get(reflectance, i), choice[i]);
            wi.set(i, drawn.wi);
            weight.set(i, drawn.weight.rgb());
            pdf[i] = if asks[i] & F::sees(wo) & drawn.is_any { f64::INFINITY } else { 0.0 };
            eta[i] = if drawn.is_through { over } else { 1.0 };
            is_through[i] = drawn.is_through;
        }
    }
}

loops! {
    /// Samples visible facets, and the cosines to them.
    fn look<F: Facets>(
        of: &DielectricLanes<F>,
        wo: &VectorLanes,
        u: &Pairs,
        normal: &mut VectorLanes,
        cosines: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let wo = wo.get(i);
            let h = seen(&of.facets(i), wo, [u[0][i], u[1][i]]);
            normal.set(i, h);
            cosines[i] = wo.dot(h);
        }
    }
}

loops! {
    /// Reflects or refracts at facets by the given probabilities of reflection. Only lanes with a set flag and a valid
    /// direction are kept.
    fn bend<F: Facets>(
        of: &DielectricLanes<F>,
        wo: &VectorLanes,
        normal: &VectorLanes,
        chances: &[f64; LANES],
        choice: &[f64; LANES],
        asks: &[bool; LANES],
        wi: &mut VectorLanes,
        facets: &mut FacetLanes,
        goes: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let (wo, known) = (wo.get(i), FacetTerms::get(&of.known, i));
            let is_mirrored = known.rest(choice[i]) < chances[i];
            let bent = Bent::new(&of.facets(i), beyond(of.etas[i], wo), wo, normal.get(i), is_mirrored);
            wi.set(i, bent.wi);
            bent.facet.put(facets, i);
            goes[i] = asks[i] & F::sees(wo) & bent.is_any;
        }
    }
}

loops! {
    /// Facets that scatter between two directions.
    fn meet<F: Facets>(of: &DielectricLanes<F>, wo: &VectorLanes, wi: &VectorLanes, facets: &mut FacetLanes) {
        for i in 0..LANES {
            let (directions, eta) = ([wo.get(i), wi.get(i)], beyond(of.etas[i], wo.get(i)));
            let [mirroring, refracting] = [
                Microfacet::mirroring(&of.facets(i), directions),
                Microfacet::refracting(&of.facets(i), eta, directions),
            ];
            Microfacet::select(wo.get(i).z * wi.get(i).z < 0.0, refracting, mirroring).put(facets, i);
        }
    }
}

loops! {
    /// Values of facets, from looked-up reflectances and losses.
    fn scatter<F: Facets, S: Share>(
        of: &DielectricLanes<F>,
        wo: &VectorLanes,
        wi: &VectorLanes,
        facets: &FacetLanes,
        reflectance: &S::Lanes,
        back: &[f64; LANES],
        asks: &[bool; LANES],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (o, w, facet) = (wo.get(i), wi.get(i), Microfacet::get(facets, i));
            let (divided, eta) = (Divided::of(S::get(reflectance, i)), beyond(of.etas[i], o));
            let mirrored = facet.mirrored(&of.facets(i), &divided, eta, [o, w]);
            let refracted = facet.refracted(&of.facets(i), &divided, eta, [o, w]);
            let is_through = o.z * w.z < 0.0;
            let once = (
                S::select(is_through, refracted.0, mirrored.0),
                if is_through { refracted.1 } else { mirrored.1 },
            );
            let [up, down] = InLanes::get(&of.grazing, i);
            let (known, grazing) = (FacetTerms::get(&of.known, i), if w.z < 0.0 { down } else { up });
            let (scattered, drawn) = known.with_given_back(once, [o, w], eta, back[i], &grazing);
            value.set(i, Rgb::select(asks[i], scattered.rgb(), Rgb::ZERO));
            pdf[i] = if asks[i] { drawn } else { 0.0 };
        }
    }
}

loops! {
    /// Converts values to throughput factors, and finds the side.
    fn weigh<F: Facets>(
        of: &DielectricLanes<F>,
        wo: &VectorLanes,
        wi: &VectorLanes,
        pdf: &[f64; LANES],
        value: &mut RgbLanes,
        eta: &mut [f64; LANES],
        is_through: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            value.set(i, value.get(i) / pdf[i]);
            is_through[i] = wo.get(i).z * wi.get(i).z < 0.0;
            eta[i] = if is_through[i] { beyond(of.etas[i], wo.get(i)) } else { 1.0 };
        }
    }
}

impl<F: Facets> DielectricLanes<F> {
    #[inline(always)]
    fn facets(&self, lane: usize) -> F {
        F::with([self.alpha[lane]; 2])
    }
}

impl<F: Lossy> DielectricLanes<F> {
    /// Values of facets in lanes with a set flag and two visible directions.
    fn scattered<'a, S: Split + 'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Dielectric<F, S>> + Copy,
        asks: &[bool; LANES],
        [wo, wi]: [&VectorLanes; 2],
        facets: &FacetLanes,
        (value, pdf): (&mut RgbLanes, &mut [f64; LANES]),
    ) where
        F: 'a,
    {
        if Dielectric::<F, S>::WEIGHS_BARE {
            // The openness of facets needs branches.
            (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]);
            for lane in (0..LANES).filter(|&lane| asks[lane]) {
                let Some((of, rough)) = each(lane).and_then(|of| Some((of, of.rough.as_ref()?))) else { continue };
                let directions = [wo.get(lane), wi.get(lane)];
                let known = FacetTerms::get(&self.known, lane);
                let (scattered, drawn) = of.scattered(rough, &known, directions, &Microfacet::get(facets, lane));
                value.set(lane, scattered.rgb());
                pdf[lane] = drawn;
            }
            return;
        }
        let reflectance = self.reflectances(level, each, asks, wo, facets.cosines());
        let mut back = [0.0; LANES];
        for lane in (0..LANES).filter(|&lane| asks[lane]) {
            if let Some(Rough { interface, .. }) = each(lane).and_then(|of| of.rough.as_ref()) {
                back[lane] = interface.given_back(self.known.lost[lane], wo.get(lane), wi.get(lane));
            }
        }
        scatter::<F, S::Share>(level, self, wo, wi, facets, &reflectance, &back, asks, value, pdf);
    }

    /// Reflectances at cosines of incidence, in lanes with a set flag.
    fn reflectances<'a, S: Split + 'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Dielectric<F, S>>,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        cosines: &[f64; LANES],
    ) -> <S::Share as InLanes>::Lanes
    where
        F: 'a,
    {
        let mut shares = <S::Share as InLanes>::EMPTY;
        S::reflectances(level, |lane| each(lane).map(|of| &of.split), asks, (&self.etas, wo), cosines, &mut shares);
        shares
    }

    /// Sampling probabilities of reflection at cosines of incidence, in lanes with a set flag.
    fn chances<'a, S: Split + 'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Dielectric<F, S>> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        cosines: &[f64; LANES],
    ) -> [f64; LANES]
    where
        F: 'a,
    {
        let reflectance = self.reflectances(level, each, asks, wo, cosines);
        from_fn(|lane| {
            let share = S::Share::get(&reflectance, lane);
            match each(lane).filter(|_| asks[lane]) {
                Some(of) => of.divide(share, wo.get(lane), cosines[lane]).chance,
                None => share.chance(),
            }
        })
    }

    /// Samples smooth interfaces, in lanes with a set flag.
    fn sample_smooth<'a, S: Split + 'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Dielectric<F, S>>,
        asks: &[bool; LANES],
        (wo, choice): (&VectorLanes, &[f64; LANES]),
        drawn: &mut BsdfSampleLanes,
    ) where
        F: 'a,
    {
        let mut cosines = [0.0; LANES];
        cosine(level, wo, &mut cosines);
        let reflectance = self.reflectances(level, each, asks, wo, &cosines);
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        draw::<F, S::Share>(level, self, wo, &reflectance, choice, asks, wi, weight, pdf, eta, is_through);
    }
}

impl<F: Lossy, S: Split> BsdfColumns<Dielectric<F, S>> for DielectricLanes<F> {
    const NONE: Self = Self {
        etas: [1.0; LANES],
        is_rough: [false; LANES],
        alpha: [1.0; LANES],
        known: FacetTerms::EMPTY,
        grazing: [Grazing::EMPTY; 2],
        kind: PhantomData,
    };

    #[inline]
    fn set(&mut self, lane: usize, of: &Dielectric<F, S>, wo: DVec3) {
        self.etas[lane] = of.eta;
        self.is_rough[lane] = of.rough.is_some();
        if let Some(rough) = &of.rough {
            self.alpha[lane] = rough.facets.alpha()[0];
            rough.known(wo).put(&mut self.known, lane);
            [DVec3::Z, -DVec3::Z].map(|w| rough.grazing(w)).put(&mut self.grazing, lane);
        }
    }

    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Dielectric<F, S>> + Copy,
        asks: &[bool; LANES],
        [wo, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        F: 'a,
        S: 'a,
    {
        let is_seen = |lane: usize| F::sees(wo.get(lane)) && F::sees(wi.get(lane));
        let asks = &from_fn(|lane| asks[lane] && self.is_rough[lane] && is_seen(lane));
        if !asks.contains(&true) {
            (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]);
            return;
        }
        let mut facets = Microfacet::EMPTY;
        meet(level, self, wo, wi, &mut facets);
        self.scattered(level, each, asks, [wo, wi], &facets, (value, pdf));
    }

    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Dielectric<F, S>> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        F: 'a,
        S: 'a,
    {
        let are = |rough: bool| from_fn(|lane| asks[lane] && self.is_rough[lane] == rough);
        let [smooth, rough]: [[bool; LANES]; 2] = [false, true].map(are);
        if !rough.contains(&true) {
            return self.sample_smooth(level, each, &smooth, (wo, choice), drawn);
        }
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = &mut *drawn;
        let (mut normal, mut cosines, mut facets) = (VectorLanes::ZERO, [0.0; LANES], Microfacet::EMPTY);
        look(level, self, wo, u, &mut normal, &mut cosines);
        let chances = self.chances(level, each, &rough, wo, &cosines);
        let mut goes = [false; LANES];
        bend::<F>(level, self, wo, &normal, &chances, choice, &rough, wi, &mut facets, &mut goes);
        for lane in (0..LANES).filter(|&lane| rough[lane] && choice[lane] < self.known.lost[lane]) {
            let (wo, known, u) = (wo.get(lane), FacetTerms::get(&self.known, lane), [u[0][lane], u[1][lane]]);
            goes[lane] = false;
            let rough = each(lane).and_then(|of| of.rough.as_ref()).filter(|_| F::sees(wo));
            if let Some((from, _)) = rough.and_then(|rough| rough.give_back(&known, wo, choice[lane], u)) {
                goes[lane] = true;
                wi.set(lane, from);
                Microfacet::between(&self.facets(lane), beyond(self.etas[lane], wo), [wo, from]).put(&mut facets, lane);
            }
        }
        self.scattered(level, each, &goes, [wo, wi], &facets, (weight, pdf));
        weigh(level, self, wo, wi, pdf, weight, eta, is_through);
        if smooth.contains(&true) {
            let mut single = BsdfSampleLanes::NONE;
            self.sample_smooth(level, each, &smooth, (wo, choice), &mut single);
            drawn.take(&smooth, &single);
        }
    }
}
