//! BSDFs in batches of sixteen lanes.

use super::BsdfMix;
use super::bsdf_mix::{Chosen, weighed, with_part};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use raywright_optics::{AnyBsdf, AnyBsdfLanes, BsdfColumns, BsdfSampleLanes, Rgb, RgbLanes};
use std::array::from_fn;
use std::borrow::Cow;

/// BSDFs of points, one per lane; some lanes may be empty.
///
/// Their parameters are in structure-of-arrays form. For mixtures, one array holds the first components of all lanes,
/// another the second ones, and so on.
#[derive(Clone, Debug, Default)]
pub struct BsdfLanes<'a> {
    /// The BSDF of each lane, borrowed if it is constant over its surface, otherwise one of `own`. A type for both
    /// would move hundreds of bytes for each reference.
    each: Vec<BsdfSource<'a>>,
    own: Vec<BsdfMix>,
    /// Mixture components, as many as any lane has had.
    parts: Vec<WeightedLobe>,
    is_mixed: [bool; LANES],
}

/// Where the BSDF of a lane is.
#[derive(Clone, Copy, Debug)]
enum BsdfSource<'a> {
    Elsewhere(&'a BsdfMix),
    Here(usize),
}

/// One component of the mixtures, in every lane.
#[derive(Clone, Debug)]
struct WeightedLobe {
    bsdf: AnyBsdfLanes,
    weight: RgbLanes,
    /// Sampling probability.
    probability: [f64; LANES],
}

impl WeightedLobe {
    /// An empty component.
    const NONE: Self = Self { bsdf: AnyBsdfLanes::NONE, weight: RgbLanes::ZERO, probability: [0.0; LANES] };
}

/// Adds components. Apart from other functions, since one that builds a component touches its 140 kB of the stack.
#[cold]
#[inline(never)]
fn make_room(parts: &mut Vec<WeightedLobe>, count: usize) {
    parts.resize(count, WeightedLobe::NONE);
}

loops! {
    /// Adds the value of a component.
    fn add(
        weight: &RgbLanes,
        probability: &[f64; LANES],
        of_part: &RgbLanes,
        density: &[f64; LANES],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let part = (weight.get(i), probability[i]);
            let (sum, drawn) = with_part((value.get(i), pdf[i]), part, (of_part.get(i), density[i]));
            value.set(i, sum);
            pdf[i] = drawn;
        }
    }
}

loops! {
    /// Factor on throughputs: of delta directions the sampled component's value, of others the value of the mixture.
    fn weigh(
        single: &[f64; LANES],
        times: &RgbLanes,
        value: &RgbLanes,
        density: &[f64; LANES],
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let of_single = weight.get(i) * times.get(i) / single[i];
            let is_single = pdf[i] == f64::INFINITY;
            weight.set(i, Rgb::select(is_single, of_single, value.get(i) / density[i]));
            pdf[i] = if is_single { pdf[i] } else { density[i] };
        }
    }
}

/// A component by its index.
#[inline]
fn part(bsdf: &BsdfMix, number: usize) -> Option<&AnyBsdf> {
    match bsdf {
        BsdfMix::One(bsdf) => (number == 0).then_some(bsdf),
        BsdfMix::Several(parts) => parts.get(number).map(|(_, bsdf)| bsdf),
    }
}

impl<'a> BsdfLanes<'a> {
    /// Empties all lanes.
    pub fn clear(&mut self) {
        self.each.clear();
        self.own.clear();
    }

    /// Fills the next lane.
    #[inline]
    pub fn push(&mut self, bsdf: Cow<'a, BsdfMix>) {
        let held = match bsdf {
            Cow::Borrowed(bsdf) => BsdfSource::Elsewhere(bsdf),
            Cow::Owned(bsdf) => {
                self.own.push(bsdf);
                BsdfSource::Here(self.own.len() - 1)
            }
        };
        self.each.push(held);
    }

    /// The BSDF of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> &BsdfMix {
        self.held(self.each[lane])
    }

    #[inline]
    fn held<'b>(&'b self, held: BsdfSource<'b>) -> &'b BsdfMix {
        match held {
            BsdfSource::Elsewhere(bsdf) => bsdf,
            BsdfSource::Here(number) => &self.own[number],
        }
    }

    /// Copies the BSDF of the last lane, with an outgoing direction in its shading frame, into the arrays. Only
    /// prepared lanes may be evaluated or sampled.
    #[inline]
    pub fn prepare(&mut self, wo: DVec3) {
        let lane = self.each.len() - 1;
        if self.parts.is_empty() {
            make_room(&mut self.parts, 1);
        }
        let bsdf = match self.each[lane] {
            BsdfSource::Elsewhere(bsdf) => bsdf,
            BsdfSource::Here(number) => &self.own[number],
        };
        match bsdf {
            BsdfMix::One(bsdf) => {
                self.is_mixed[lane] = false;
                self.parts[0].bsdf.set(lane, bsdf, wo);
            }
            BsdfMix::Several(parts) => {
                self.is_mixed[lane] = true;
                if self.parts.len() < parts.len() {
                    make_room(&mut self.parts, parts.len());
                }
                self.parts.iter_mut().for_each(|part| part.probability[lane] = 0.0);
                for (part, (weight, probability, bsdf)) in self.parts.iter_mut().zip(weighed(parts)) {
                    part.bsdf.set(lane, bsdf, wo);
                    part.weight.set(lane, weight);
                    part.probability[lane] = probability;
                }
            }
        }
    }

    /// [`raywright_optics::Bsdf::evaluate`] for the prepared directions and others, in shading frames. Lanes whose flag
    /// is not set get 0.
    pub fn evaluate(
        &self,
        level: Level,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        let [mixed, one] = self.are_mixed(asks);
        if !mixed.contains(&true) {
            return self.evaluate_part(level, 0, &one, [wo, wi], value, pdf);
        }
        let ([mut sum, mut some], [mut density, mut drawn]) = ([RgbLanes::ZERO; 2], [[0.0; LANES]; 2]);
        for (number, part) in self.parts.iter().enumerate() {
            let asks = from_fn(|lane| mixed[lane] && part.probability[lane] > 0.0);
            self.evaluate_part(level, number, &asks, [wo, wi], &mut some, &mut drawn);
            add(level, &part.weight, &part.probability, &some, &drawn, &mut sum, &mut density);
        }
        if one.contains(&true) {
            self.evaluate_part(level, 0, &one, [wo, wi], value, pdf);
        } else {
            (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]);
        }
        for lane in (0..LANES).filter(|&lane| mixed[lane]) {
            value.set(lane, sum.get(lane));
            pdf[lane] = density[lane];
        }
    }

    /// [`raywright_optics::Bsdf::sample`] for the prepared directions, in shading frames. Lanes whose flag is not set
    /// get no sample.
    pub fn sample(
        &self,
        level: Level,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) {
        let [mixed, one] = self.are_mixed(asks);
        if !mixed.contains(&true) {
            return self.sample_part(level, 0, &one, wo, (choice, u), drawn);
        }
        drawn.pdf = [0.0; LANES];
        let mut some = BsdfSampleLanes::NONE;
        if one.contains(&true) {
            self.sample_part(level, 0, &one, wo, (choice, u), &mut some);
            drawn.take(&one, &some);
        }
        let (mut rest, mut times, mut single) = (*choice, RgbLanes::ZERO, [1.0; LANES]);
        let chosen: [Option<usize>; LANES] = from_fn(|lane| {
            let BsdfMix::Several(parts) = self.get_if(mixed[lane], lane)? else { return None };
            let chosen = Chosen::new(parts, choice[lane])?;
            (rest[lane], single[lane]) = (chosen.rest, chosen.probability());
            times.set(lane, parts[chosen.part].0);
            Some(chosen.part)
        });
        let mut of_mixed = BsdfSampleLanes::NONE;
        for number in 0..self.parts.len() {
            let asks = chosen.map(|part| part == Some(number));
            if asks.contains(&true) {
                self.sample_part(level, number, &asks, wo, (&rest, u), &mut some);
                of_mixed.take(&asks, &some);
            }
        }
        let goes = from_fn(|lane| mixed[lane] && of_mixed.pdf[lane] > 0.0 && of_mixed.pdf[lane] < f64::INFINITY);
        let (mut value, mut density) = (RgbLanes::ZERO, [0.0; LANES]);
        if goes.contains(&true) {
            self.evaluate(level, &goes, wo, &of_mixed.wi, &mut value, &mut density);
        }
        weigh(level, &single, &times, &value, &density, &mut of_mixed.weight, &mut of_mixed.pdf);
        drawn.take(&mixed, &of_mixed);
    }

    /// Splits the lanes with a set flag into mixtures and single BSDFs.
    #[inline]
    fn are_mixed(&self, asks: &[bool; LANES]) -> [[bool; LANES]; 2] {
        [true, false].map(|mixed| from_fn(|lane| asks[lane] && self.is_mixed[lane] == mixed))
    }

    #[inline]
    fn get_if(&self, asks: bool, lane: usize) -> Option<&BsdfMix> {
        if asks { self.each.get(lane).map(|&held| self.held(held)) } else { None }
    }

    fn evaluate_part(
        &self,
        level: Level,
        number: usize,
        asks: &[bool; LANES],
        directions: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        let each = |lane: usize| self.each.get(lane).and_then(|&held| part(self.held(held), number));
        match self.parts.get(number) {
            Some(part) => part.bsdf.evaluate(level, each, asks, directions, value, pdf),
            None => (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]),
        }
    }

    fn sample_part(
        &self,
        level: Level,
        number: usize,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        numbers: (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) {
        let each = |lane: usize| self.each.get(lane).and_then(|&held| part(self.held(held), number));
        match self.parts.get(number) {
            Some(part) => part.bsdf.sample(level, each, asks, wo, numbers, drawn),
            None => drawn.pdf = [0.0; LANES],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::warp::uniform_sphere;
    use raywright_optics::{
        Bsdf, BsdfSample, Coated, Dielectric, Diffuse, MetallicRough, Mirror, OrenNayar, ThinDielectric,
    };
    use std::array::from_fn;

    /// The BSDF of a lane: one of several kinds, or a mixture of two or three that may include a delta BSDF.
    fn bsdf(turn: u32, lane: usize) -> BsdfMix {
        let one = |kind: usize| -> BsdfMix {
            let colour = [Rgb::new(0.2, 0.4, 0.9), Rgb::ONE, Rgb::new(0.0, 1.0, 0.5)][(kind + lane) % 3];
            match kind % 7 {
                0 => Diffuse { reflectance: colour }.into(),
                1 => Mirror { reflectance: colour }.into(),
                2 => Dielectric::new(1.5, [0.0, 0.3][lane % 2]).into(),
                3 => ThinDielectric::new(1.5).into(),
                4 => Coated::new(colour, 1.5, [0.0, 0.1][lane % 2]).into(),
                5 => MetallicRough::within(colour, 0.4, 0.5, [1.0, 1.33][lane % 2]).into(),
                _ => OrenNayar::new(colour, 0.6).into(),
            }
        };
        let (kind, turn) = (lane % 5, turn as usize);
        let two = |a: usize, b: usize| BsdfMix::mixed((Rgb::splat(0.25), one(a)), (Rgb::new(0.75, 0.5, 0.1), one(b)));
        match turn % 4 {
            0 => one(kind + turn),
            1 => two(turn, turn / 4),
            2 if kind < 2 => one(turn),
            2 => two(kind, turn + lane),
            _ => BsdfMix::mixed((Rgb::splat(0.5), two(lane, turn)), (Rgb::splat(0.5), one(kind))),
        }
    }

    /// Two directions: arbitrary, grazing, normal, in the plane, mirrored, opposite, or near the critical angle.
    fn directions(turn: u32, sampler: &mut Sampler) -> [DVec3; 2] {
        let [wo, wi] = [1, 3].map(|dimension| uniform_sphere(sampler.two(dimension)));
        match turn % 8 {
            0 => [DVec3::new(wo.x, wo.y, 1e-9 * wo.z).normalize(), wi],
            1 => [DVec3::Z.copysign(wo), wi],
            2 => [DVec3::X, wi],
            3 => [wo, DVec3::new(-wo.x, -wo.y, wo.z)],
            4 => [wo, -wo],
            5 => [DVec3::new((1.0 / 1.5) * (1.0 + 1e-16 * (wi.x * 4.0).round()), 0.0, -(5f64 / 9.0).sqrt()), wi],
            _ => [wo, wi],
        }
    }

    #[test]
    fn lanes_answer_as_each_by_itself() {
        for turn in 0..128 {
            let mut sampler: [Sampler; LANES] = from_fn(|lane| Sampler::new(8, turn, lane as u32));
            let (mut all, mut to, mut from, mut u) =
                (BsdfLanes::default(), VectorLanes::ZERO, VectorLanes::ZERO, [[0.0; LANES]; 2]);
            // Some lanes stay empty.
            for lane in 0..LANES - 3 {
                let [wo, wi] = directions(turn + lane as u32, &mut sampler[lane]);
                to.set(lane, wo);
                from.set(lane, wi);
                all.push(Cow::Owned(bsdf(turn, lane)));
                all.prepare(wo);
                [u[0][lane], u[1][lane]] = sampler[lane].two(5);
            }
            let choice = from_fn(|lane| sampler[lane].one(6));
            let asks = from_fn(|lane| lane < LANES - 3 && lane as u32 != turn % 16);
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let (mut value, mut pdf) = (RgbLanes::ZERO, [0.0; LANES]);
                all.evaluate(level, &asks, &to, &from, &mut value, &mut pdf);
                let mut drawn = BsdfSampleLanes::NONE;
                all.sample(level, &asks, &to, (&choice, &u), &mut drawn);
                for lane in (0..LANES).filter(|&lane| asks[lane]) {
                    let (one, wo) = (bsdf(turn, lane), to.get(lane));
                    let found = (value.get(lane), pdf[lane]);
                    assert_eq!(found, one.evaluate(wo, from.get(lane)), "{level:?} {turn} {lane}");
                    let wanted = one.sample(wo, &mut || choice[lane], [u[0][lane], u[1][lane]]);
                    let told = |of: BsdfSample| (of.wi, of.weight, of.pdf, of.eta, of.is_through);
                    let found = drawn.get(lane);
                    assert_eq!(found.map(told), wanted.map(told), "{level:?} {turn} {lane}");
                }
                assert!((0..LANES).all(|lane| asks[lane] || drawn.get(lane).is_none()));
            }
        }
    }
}
