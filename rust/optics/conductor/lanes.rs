//! Metals by lane.

use super::{Conductor, Rough, above, mirrors};
use crate::math::{DVec3, LANES, VectorLanes};
use crate::optics::conductors::Reflectance;
use crate::optics::fresnel::ConductorIndex;
use crate::optics::lobes::Grazing;
use crate::optics::mirror::MirrorLanes;
use crate::optics::{BsdfSampleLanes, Facets, Ggx, Rgb, RgbLanes};
use crate::sampling::Pairs;
use crate::simd::{Level, loops};
use std::array::from_fn;

/// What is known of metals, a lane each, and of a direction that light goes to.
#[derive(Clone, Debug)]
pub struct ConductorLanes {
    is_rough: [bool; LANES],
    alpha: [[f64; LANES]; 2],
    multiple: RgbLanes,
    grazing: [[f64; LANES]; 2],
    /// Of those that are told by an index, this; the others are looked up.
    index: [RgbLanes; 2],
    is_by_index: [bool; LANES],
    wo: VectorLanes,
    /// What is lost of light to `wo`.
    lost: [f64; LANES],
}

loops! {
    /// How facets mirror between two directions, of metals with an index by what it says.
    fn mirror(
        of: &ConductorLanes,
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
    /// What smooth metals reflect, by their index.
    fn reflect(of: &ConductorLanes, reflectance: &mut RgbLanes) {
        for i in 0..LANES {
            let index = ConductorIndex::with([of.index[0].get(i), of.index[1].get(i)]);
            reflectance.set(i, index.reflectance(of.wo.get(i).z.abs()));
        }
    }
}

loops! {
    /// What is scattered, by what was told and looked up.
    fn scatter(
        of: &ConductorLanes,
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
            let (facets, grazing) = (of.facets(i), Grazing::with([of.grazing[0][i], of.grazing[1][i]]));
            let parts = (&facets, of.multiple.get(i), &grazing);
            let told = (density[i], reflectance.get(i));
            let (scattered, drawn) = Rough::scattered(parts, [above(o), above(w)], told, [of.lost[i], lost[i]]);
            let is_seen = asks[i] & mirrors::<Ggx>(o, w);
            value.set(i, Rgb::select(is_seen, scattered, Rgb::ZERO));
            pdf[i] = if is_seen { drawn } else { 0.0 };
        }
    }
}

loops! {
    /// Directions from which facets reflect, above.
    fn draw(of: &ConductorLanes, u: &Pairs, wi: &mut VectorLanes) {
        for i in 0..LANES {
            wi.set(i, of.facets(i).sample_reflection(above(of.wo.get(i)), [u[0][i], u[1][i]]));
        }
    }
}

loops! {
    /// From directions above to those on the side of `wo`, in the lanes that ask and are seen.
    fn turn(of: &ConductorLanes, asks: &[bool; LANES], wi: &mut VectorLanes, goes: &mut [bool; LANES]) {
        for i in 0..LANES {
            let (wo, drawn) = (of.wo.get(i), wi.get(i));
            goes[i] = asks[i] & Ggx::sees(wo) & (drawn.z > 0.0);
            wi.set(i, DVec3::new(drawn.x, drawn.y, drawn.z.copysign(wo.z)));
        }
    }
}

loops! {
    /// From what is scattered to what a throughput is multiplied by.
    fn weigh(pdf: &[f64; LANES], value: &mut RgbLanes) {
        for i in 0..LANES {
            value.set(i, value.get(i) / pdf[i]);
        }
    }
}

impl ConductorLanes {
    /// Of nothing yet.
    pub const NONE: Self = Self {
        is_rough: [false; LANES],
        alpha: [[1.0; LANES]; 2],
        multiple: RgbLanes::ZERO,
        grazing: [[1.0; LANES]; 2],
        index: [RgbLanes::ZERO; 2],
        is_by_index: [false; LANES],
        wo: VectorLanes::ZERO,
        lost: [0.0; LANES],
    };

    /// Puts a metal into a lane, and a direction that light goes to.
    #[inline]
    pub fn set(&mut self, lane: usize, metal: &Conductor, wo: DVec3) {
        self.is_rough[lane] = metal.rough.is_some();
        if let Some(rough) = &metal.rough {
            [self.alpha[0][lane], self.alpha[1][lane]] = rough.facets.alpha();
            self.multiple.set(lane, rough.multiple);
            [self.grazing[0][lane], self.grazing[1][lane]] = rough.grazing.parts();
            self.lost[lane] = rough.lost(above(wo));
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

    #[inline(always)]
    fn facets(&self, lane: usize) -> Ggx {
        Ggx::with([self.alpha[0][lane], self.alpha[1][lane]])
    }

    /// What [`crate::optics::Bsdf::evaluate`] gives, in the lanes that ask, of the metals that were put there.
    pub fn evaluate<'a>(
        &self,
        level: Level,
        metals: impl Fn(usize) -> Option<&'a Conductor>,
        asks: &[bool; LANES],
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        let asks = &from_fn(|lane| asks[lane] && self.is_rough[lane]);
        if !asks.contains(&true) {
            (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]);
            return;
        }
        let ([mut density, mut cosine, mut lost], mut reflectance) = ([[0.0; LANES]; 3], RgbLanes::ZERO);
        mirror(level, self, wi, &mut density, &mut cosine, &mut reflectance);
        for lane in (0..LANES).filter(|&lane| asks[lane]) {
            let Some(metal) = metals(lane) else { continue };
            if let Some(rough) = &metal.rough {
                lost[lane] = rough.loss.of(above(wi.get(lane)));
            }
            if !self.is_by_index[lane] {
                reflectance.set(lane, metal.reflectance(cosine[lane]));
            }
        }
        scatter(level, self, wi, &density, &reflectance, &lost, asks, value, pdf);
    }

    /// What [`crate::optics::Bsdf::sample`] gives, in the lanes that ask; nothing in the others.
    pub fn sample<'a>(
        &self,
        level: Level,
        metals: impl Fn(usize) -> Option<&'a Conductor>,
        asks: &[bool; LANES],
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) {
        let are = |rough: bool| from_fn(|lane| asks[lane] && self.is_rough[lane] == rough);
        let [smooth, rough]: [[bool; LANES]; 2] = [false, true].map(are);
        if !rough.contains(&true) {
            return self.sample_smooth(level, metals, &smooth, drawn);
        }
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = &mut *drawn;
        draw(level, self, u, wi);
        for lane in (0..LANES).filter(|&lane| rough[lane] && choice[lane] < self.lost[lane]) {
            let grazing = Grazing::with([self.grazing[0][lane], self.grazing[1][lane]]);
            wi.set(lane, grazing.sample([u[0][lane], u[1][lane]]));
        }
        let mut goes = [false; LANES];
        turn(level, self, &rough, wi, &mut goes);
        self.evaluate(level, &metals, &goes, wi, weight, pdf);
        weigh(level, pdf, weight);
        (*eta, *is_through) = ([1.0; LANES], [false; LANES]);
        if smooth.contains(&true) {
            let mut mirrored = BsdfSampleLanes::NONE;
            self.sample_smooth(level, metals, &smooth, &mut mirrored);
            (0..LANES).filter(|&lane| smooth[lane]).for_each(|lane| drawn.set(lane, mirrored.get(lane)));
        }
    }

    /// The same in lanes that ask and have smooth metals.
    fn sample_smooth<'a>(
        &self,
        level: Level,
        metals: impl Fn(usize) -> Option<&'a Conductor>,
        asks: &[bool; LANES],
        drawn: &mut BsdfSampleLanes,
    ) {
        let mut reflectance = RgbLanes::ZERO;
        reflect(level, self, &mut reflectance);
        for lane in (0..LANES).filter(|&lane| asks[lane] && !self.is_by_index[lane]) {
            if let Some(metal) = metals(lane) {
                reflectance.set(lane, metal.reflectance(self.wo.get(lane).z.abs()));
            }
        }
        let asks = from_fn(|lane| asks[lane] && Ggx::sees(self.wo.get(lane)));
        MirrorLanes(reflectance).sample_all(level, &asks, &self.wo, drawn);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductors::metal;
    use crate::optics::{Bsdf, BsdfSample};
    use crate::sampling::Sampler;
    use crate::sampling::warp::uniform_sphere;

    /// Metals of an index and measured ones, alike in all directions and brushed, or some of them smooth, or all.
    fn metals(turn: u32) -> [Conductor; LANES] {
        from_fn(|lane| {
            let rough = [[0.3; 2], [1e-4; 2], [0.05, 0.6], [1.0; 2]][lane % 4];
            let alpha = if (turn % 3) as usize > lane % 2 { [0.0; 2] } else { rough };
            match metal("gold") {
                Some(gold) if lane / 4 % 2 == 1 => Conductor::metal(gold, if lane < 8 { 1.0 } else { 1.33 }, alpha),
                _ => Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2), alpha),
            }
        })
    }

    /// Of some lanes, two directions, three numbers, and whether it asks.
    fn case(turn: u32) -> [([DVec3; 2], [f64; 3], bool); LANES] {
        from_fn(|lane| {
            let mut sampler = Sampler::new(3, turn, lane as u32);
            let [mut wo, mut wi] = [0, 1].map(|k| uniform_sphere(sampler.two(2 * k + 1)));
            match turn % 8 {
                // Grazing, in the plane, opposite in it, and mirrored exactly.
                0 => wo = DVec3::new(wo.x, wo.y, 1e-9 * wo.z).normalize(),
                1 => wi = DVec3::new(1.0, 0.0, 0.0),
                2 => (wo, wi) = (DVec3::new(1.0, 0.0, 1e-90), DVec3::new(-1.0, 0.0, 1e-90)),
                3 => wi = DVec3::new(-wo.x, -wo.y, wo.z),
                _ => (),
            }
            let [a, b] = sampler.two(7);
            ([wo, wi], [sampler.one(9), a, b], lane as u32 != turn % 16)
        })
    }

    #[test]
    fn lanes_have_the_bits_of_one() {
        for turn in 0..200 {
            let (metals, case) = (metals(turn), case(turn));
            let (mut lanes, mut wi, mut u) = (ConductorLanes::NONE, VectorLanes::ZERO, [[0.0; LANES]; 2]);
            let prepared = from_fn::<_, LANES, _>(|lane| {
                let mut metal = metals[lane];
                metal.prepare(case[lane].0[0]);
                lanes.set(lane, &metal, case[lane].0[0]);
                wi.set(lane, case[lane].0[1]);
                [u[0][lane], u[1][lane]] = [case[lane].1[1], case[lane].1[2]];
                metal
            });
            let (choice, asks) = (case.map(|of| of.1[0]), case.map(|of| of.2));
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let metal = |lane: usize| Some(&prepared[lane]);
                let (mut value, mut pdf) = (RgbLanes::ZERO, [f64::NAN; LANES]);
                lanes.evaluate(level, metal, &asks, &wi, &mut value, &mut pdf);
                let mut drawn = BsdfSampleLanes::NONE;
                lanes.sample(level, metal, &asks, (&choice, &u), &mut drawn);
                for lane in 0..LANES {
                    let (one, [wo, wi], drawn) = (&metals[lane], case[lane].0, drawn.get(lane));
                    if !asks[lane] {
                        assert!(value.get(lane).is_black() && pdf[lane] == 0.0 && drawn.is_none());
                        continue;
                    }
                    assert_eq!((value.get(lane), pdf[lane]), one.evaluate(wo, wi), "{level:?} {turn} {lane}");
                    let wanted = one.sample(wo, || choice[lane], [u[0][lane], u[1][lane]]);
                    let told = |of: BsdfSample| (of.wi, of.weight, of.pdf, of.eta, of.is_through);
                    assert_eq!(drawn.map(told), wanted.map(told), "{level:?} {turn} {lane}");
                }
            }
        }
    }
}
