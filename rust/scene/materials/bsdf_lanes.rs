//! How sixteen points scatter light.

use super::BsdfMix;
use crate::math::{DVec3, LANES, VectorLanes};
use crate::optics::{AnyBsdf, Bsdf, BsdfSampleLanes, Conductor, ConductorLanes, RgbLanes};
use crate::sampling::Pairs;
use crate::simd::Level;

/// How points scatter light, a lane each; there may be fewer than lanes.
#[derive(Clone, Debug)]
pub struct BsdfLanes {
    each: Vec<BsdfMix>,
    /// Of rough metals, what lanes have of them.
    metals: ConductorLanes,
    /// Whether all are rough metals.
    are_metals: bool,
}

impl Default for BsdfLanes {
    /// None.
    fn default() -> Self {
        Self { each: Vec::with_capacity(LANES), metals: ConductorLanes::NONE, are_metals: true }
    }
}

impl BsdfLanes {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.each.clear();
        self.are_metals = true;
    }

    /// Puts one into the next lane.
    #[inline]
    pub fn push(&mut self, bsdf: BsdfMix) {
        self.each.push(bsdf);
    }

    /// That of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> &BsdfMix {
        &self.each[lane]
    }

    /// Prepares that of the last lane for a direction in its shading frame ([`Bsdf::prepare`]).
    #[inline]
    pub fn prepare(&mut self, wo: DVec3) {
        let lane = self.each.len() - 1;
        self.each[lane].prepare(wo);
        self.are_metals &= match &self.each[lane] {
            BsdfMix::One(AnyBsdf::Conductor(metal)) => self.metals.set(lane, metal, wo),
            _ => false,
        };
    }

    fn metal(&self, lane: usize) -> Option<&Conductor> {
        match self.each.get(lane) {
            Some(BsdfMix::One(AnyBsdf::Conductor(metal))) => Some(metal),
            _ => None,
        }
    }

    /// What [`Bsdf::evaluate`] gives for directions that they were prepared for and others, in shading frames, in the
    /// lanes that ask.
    pub fn evaluate(
        &self,
        level: Level,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        if self.are_metals {
            return self.metals.evaluate(level, |lane| self.metal(lane), asks, wi, value, pdf);
        }
        for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
            let (of_lane, density) = bsdf.evaluate(wo.get(lane), wi.get(lane));
            value.set(lane, of_lane);
            pdf[lane] = density;
        }
    }

    /// What [`Bsdf::sample`] gives for directions that they were prepared for, in shading frames, in the lanes that
    /// ask; nothing in the others.
    pub fn sample(
        &self,
        level: Level,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) {
        if self.are_metals {
            return self.metals.sample(level, |lane| self.metal(lane), asks, (choice, u), drawn);
        }
        drawn.pdf = [0.0; LANES];
        for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
            let u = [u[0][lane], u[1][lane]];
            drawn.set(lane, bsdf.sample(wo.get(lane), || choice[lane], u));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{BsdfSample, Dielectric, Diffuse, MetallicRough, Mirror, Rgb};
    use crate::sampling::Sampler;
    use crate::sampling::warp::uniform_sphere;
    use std::array::from_fn;

    /// What scatters in a lane: all of it metal, or of several kinds.
    fn kind(lane: usize, are_metals: bool) -> BsdfMix {
        let metal = |alpha: f64| Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::splat(3.0), [alpha; 2]);
        if are_metals {
            return metal(0.1 + 0.05 * lane as f64).into();
        }
        match lane % 6 {
            0 => metal(0.2).into(),
            1 => Diffuse { reflectance: Rgb::new(0.2, 0.4, 0.6) }.into(),
            2 => Dielectric::new(1.5, 0.3).into(),
            3 => Mirror { reflectance: Rgb::splat(0.9) }.into(),
            4 => MetallicRough::new(Rgb::splat(0.7), 0.5, 0.4).into(),
            _ => BsdfMix::mixed(
                (Rgb::splat(0.5), metal(0.4).into()),
                (Rgb::splat(0.5), Diffuse { reflectance: Rgb::splat(0.5) }.into()),
            ),
        }
    }

    #[test]
    fn lanes_answer_as_each_by_itself() {
        for (turn, are_metals) in (0..40).flat_map(|turn| [(turn, false), (turn, true)]) {
            let mut sampler: [Sampler; LANES] = from_fn(|lane| Sampler::new(8, turn, lane as u32));
            let (mut all, mut to, mut wi, mut u) =
                (BsdfLanes::default(), VectorLanes::ZERO, VectorLanes::ZERO, [[0.0; LANES]; 2]);
            // Fewer than lanes.
            for lane in 0..LANES - 3 {
                to.set(lane, uniform_sphere(sampler[lane].two(1)));
                all.push(kind(lane, are_metals));
                all.prepare(to.get(lane));
                wi.set(lane, uniform_sphere(sampler[lane].two(3)));
                [u[0][lane], u[1][lane]] = sampler[lane].two(5);
            }
            let choice = from_fn(|lane| sampler[lane].one(6));
            let asks = from_fn(|lane| lane < LANES - 3 && lane as u32 != turn % 16);
            let (mut value, mut pdf) = (RgbLanes::ZERO, [0.0; LANES]);
            all.evaluate(Level::Scalar, &asks, &to, &wi, &mut value, &mut pdf);
            let mut drawn = BsdfSampleLanes::NONE;
            all.sample(Level::Scalar, &asks, &to, (&choice, &u), &mut drawn);
            for lane in (0..LANES).filter(|&lane| asks[lane]) {
                let (one, wo) = (kind(lane, are_metals), to.get(lane));
                assert_eq!((value.get(lane), pdf[lane]), one.evaluate(wo, wi.get(lane)));
                let wanted = one.sample(wo, || choice[lane], [u[0][lane], u[1][lane]]);
                let told = |of: BsdfSample| (of.wi, of.weight, of.pdf, of.eta, of.is_through);
                assert_eq!(drawn.get(lane).map(told), wanted.map(told));
            }
            assert!((0..LANES).all(|lane| asks[lane] || drawn.get(lane).is_none()));
        }
    }
}
