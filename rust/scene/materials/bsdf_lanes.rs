//! How sixteen points scatter light.

use super::BsdfMix;
use crate::math::{DVec3, LANES, VectorLanes};
use crate::optics::{
    AnyBsdf, Bsdf, BsdfSampleLanes, Coated, CoatedLanes, Conductor, ConductorLanes, DielectricLanes, DiffuseLanes,
    MetallicRough, MetallicRoughLanes, MirrorLanes, RgbLanes, ThinDielectricLanes,
};
use crate::sampling::Pairs;
use crate::simd::Level;
use std::borrow::Cow;

/// How points scatter light, a lane each; there may be fewer than lanes.
///
/// Where all are of one kind that has loops over lanes, these answer; otherwise each is asked by itself.
#[derive(Clone, Debug)]
pub struct BsdfLanes<'a> {
    /// Borrowed where it is how all of a surface scatters.
    each: Vec<Cow<'a, BsdfMix>>,
    /// What all are that were prepared; nothing before the first.
    kind: Option<Kind>,
    diffuse: DiffuseLanes,
    mirrors: MirrorLanes,
    metals: ConductorLanes,
    glass: DielectricLanes,
    panes: ThinDielectricLanes,
    plastics: CoatedLanes,
    metallic_rough: MetallicRoughLanes,
}

/// What lanes have in columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Diffuse,
    Mirror,
    Metal,
    /// Smooth, but for a pane.
    Glass,
    Pane,
    Plastic,
    MetallicRough,
    /// Of several kinds, or of others.
    Other,
}

impl Default for BsdfLanes<'_> {
    /// None.
    fn default() -> Self {
        Self {
            each: Vec::with_capacity(LANES),
            kind: None,
            diffuse: DiffuseLanes::NONE,
            mirrors: MirrorLanes::NONE,
            metals: ConductorLanes::NONE,
            glass: DielectricLanes::NONE,
            panes: ThinDielectricLanes::NONE,
            plastics: CoatedLanes::NONE,
            metallic_rough: MetallicRoughLanes::NONE,
        }
    }
}

impl<'a> BsdfLanes<'a> {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.each.clear();
        self.kind = None;
    }

    /// Puts one into the next lane.
    #[inline]
    pub fn push(&mut self, bsdf: Cow<'a, BsdfMix>) {
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
        if let Cow::Owned(bsdf) = &mut self.each[lane] {
            bsdf.prepare(wo);
        }
        if self.kind == Some(Kind::Other) {
            return;
        }
        let kind = self.set(lane, wo);
        let is_other = self.kind.is_some_and(|others| others != kind);
        self.kind = Some(if is_other { Kind::Other } else { kind });
    }

    /// Puts that of a lane, and a direction, into the columns of its kind, and says which it is.
    #[inline]
    fn set(&mut self, lane: usize, wo: DVec3) -> Kind {
        let BsdfMix::One(bsdf) = &*self.each[lane] else { return Kind::Other };
        match bsdf {
            AnyBsdf::Diffuse(diffuse) => {
                self.diffuse.set(lane, diffuse);
                Kind::Diffuse
            }
            AnyBsdf::Mirror(mirror) => {
                self.mirrors.set(lane, mirror.reflectance);
                Kind::Mirror
            }
            AnyBsdf::Conductor(metal) => {
                self.metals.set(lane, metal, wo);
                Kind::Metal
            }
            AnyBsdf::Dielectric(glass) if self.glass.set(lane, glass) => Kind::Glass,
            AnyBsdf::ThinDielectric(pane) => {
                self.panes.set(lane, pane);
                Kind::Pane
            }
            AnyBsdf::Coated(plastic) => {
                self.plastics.set(lane, plastic, wo);
                Kind::Plastic
            }
            AnyBsdf::MetallicRough(of) => {
                self.metallic_rough.set(lane, of, wo);
                Kind::MetallicRough
            }
            _ => Kind::Other,
        }
    }

    fn metal(&self, lane: usize) -> Option<&Conductor> {
        match self.each.get(lane).map(Cow::as_ref) {
            Some(BsdfMix::One(AnyBsdf::Conductor(metal))) => Some(metal),
            _ => None,
        }
    }

    fn plastic(&self, lane: usize) -> Option<&Coated> {
        match self.each.get(lane).map(Cow::as_ref) {
            Some(BsdfMix::One(AnyBsdf::Coated(plastic))) => Some(plastic),
            _ => None,
        }
    }

    fn metallic_rough(&self, lane: usize) -> Option<&MetallicRough> {
        match self.each.get(lane).map(Cow::as_ref) {
            Some(BsdfMix::One(AnyBsdf::MetallicRough(of))) => Some(of),
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
        match self.kind {
            Some(Kind::Diffuse) => self.diffuse.evaluate(level, asks, wo, wi, value, pdf),
            Some(Kind::Metal) => self.metals.evaluate(level, |lane| self.metal(lane), asks, wi, value, pdf),
            Some(Kind::Plastic) => self.plastics.evaluate(level, |lane| self.plastic(lane), asks, wi, value, pdf),
            Some(Kind::MetallicRough) => {
                self.metallic_rough.evaluate(level, |lane| self.metallic_rough(lane), asks, wi, value, pdf);
            }
            // Single directions alone.
            None | Some(Kind::Mirror | Kind::Glass | Kind::Pane) => (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]),
            Some(Kind::Other) => {
                for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
                    let (of_lane, density) = bsdf.evaluate(wo.get(lane), wi.get(lane));
                    value.set(lane, of_lane);
                    pdf[lane] = density;
                }
            }
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
        let numbers = (choice, u);
        match self.kind {
            Some(Kind::Diffuse) => self.diffuse.sample(level, asks, wo, u, drawn),
            Some(Kind::Mirror) => self.mirrors.sample(level, asks, wo, drawn),
            Some(Kind::Metal) => self.metals.sample(level, |lane| self.metal(lane), asks, numbers, drawn),
            Some(Kind::Glass) => self.glass.sample(level, asks, wo, choice, drawn),
            Some(Kind::Pane) => self.panes.sample(level, asks, wo, choice, drawn),
            Some(Kind::Plastic) => self.plastics.sample(level, |lane| self.plastic(lane), asks, numbers, drawn),
            Some(Kind::MetallicRough) => {
                self.metallic_rough.sample(level, |lane| self.metallic_rough(lane), asks, numbers, drawn);
            }
            None | Some(Kind::Other) => {
                drawn.pdf = [0.0; LANES];
                for (lane, bsdf) in self.each.iter().enumerate().filter(|&(lane, _)| asks[lane]) {
                    let u = [u[0][lane], u[1][lane]];
                    drawn.set(lane, bsdf.sample(wo.get(lane), || choice[lane], u));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductors::metal;
    use crate::optics::{BsdfSample, Dielectric, Diffuse, Mirror, Rgb, ThinDielectric};
    use crate::sampling::Sampler;
    use crate::sampling::warp::uniform_sphere;
    use std::array::from_fn;

    /// The number of blocks of many kinds, after those of one.
    const MANY: u32 = 8;

    /// What scatters in a lane, by kind.
    fn bsdf(kind: u32, lane: usize) -> BsdfMix {
        let colour = [Rgb::new(0.2, 0.4, 0.9), Rgb::ZERO, Rgb::ONE, Rgb::new(0.0, 1.0, 0.5)][lane / 2 % 4];
        let alpha = [0.0, 0.3, 1e-4, 1.0, 0.05][lane % 5];
        let eta = [1.5, 1.0 / 1.5, 1.0, 1.0 + 1e-7, 1.0 - 1e-7, 2.4, 1.0 + 1e-3][lane % 7];
        match kind {
            0 => Diffuse { reflectance: colour }.into(),
            1 => Mirror { reflectance: colour }.into(),
            2 if lane.is_multiple_of(3) => Conductor::metal(metal("Au").unwrap(), 1.0, [alpha; 2]).into(),
            2 => Conductor::new(Rgb::new(0.2, 0.9, 1.1), Rgb::splat(3.0), [alpha, 0.2 * alpha]).into(),
            3 => Dielectric::new(eta, 0.0).into(),
            4 => Dielectric::new(eta, 0.3).into(),
            5 => ThinDielectric::new(eta).into(),
            6 => Coated::new(colour, eta.max(1.0), alpha).into(),
            7 => MetallicRough::new(colour, [0.0, 0.4, 1.0][lane % 3], alpha.sqrt()).into(),
            _ if lane % 9 == 8 => BsdfMix::mixed(
                (Rgb::splat(0.5), bsdf(7, lane)),
                (Rgb::splat(0.5), Diffuse { reflectance: Rgb::splat(0.5) }.into()),
            ),
            _ => bsdf(lane as u32 % 9, lane),
        }
    }

    /// Two directions: any, grazing, straight, in the plane, mirrored, opposite, or about the critical angle.
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
        for (turn, kind) in (0..32).flat_map(|turn| (0..=MANY).map(move |kind| (turn, kind))) {
            let mut sampler: [Sampler; LANES] = from_fn(|lane| Sampler::new(8, turn, lane as u32));
            let (mut all, mut to, mut from, mut u) =
                (BsdfLanes::default(), VectorLanes::ZERO, VectorLanes::ZERO, [[0.0; LANES]; 2]);
            // Fewer than lanes.
            for lane in 0..LANES - 3 {
                let [wo, wi] = directions(turn + lane as u32, &mut sampler[lane]);
                to.set(lane, wo);
                from.set(lane, wi);
                all.push(Cow::Owned(bsdf(kind, lane)));
                all.prepare(wo);
                [u[0][lane], u[1][lane]] = sampler[lane].two(5);
            }
            assert_eq!(all.kind == Some(Kind::Other), kind == 4 || kind == MANY);
            let choice = from_fn(|lane| sampler[lane].one(6));
            let asks = from_fn(|lane| lane < LANES - 3 && lane as u32 != turn % 16);
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let (mut value, mut pdf) = (RgbLanes::ZERO, [0.0; LANES]);
                all.evaluate(level, &asks, &to, &from, &mut value, &mut pdf);
                let mut drawn = BsdfSampleLanes::NONE;
                all.sample(level, &asks, &to, (&choice, &u), &mut drawn);
                for lane in (0..LANES).filter(|&lane| asks[lane]) {
                    let (one, wo) = (bsdf(kind, lane), to.get(lane));
                    let found = (value.get(lane), pdf[lane]);
                    assert_eq!(found, one.evaluate(wo, from.get(lane)), "{level:?} {kind} {turn} {lane}");
                    let wanted = one.sample(wo, || choice[lane], [u[0][lane], u[1][lane]]);
                    let told = |of: BsdfSample| (of.wi, of.weight, of.pdf, of.eta, of.is_through);
                    let found = drawn.get(lane);
                    assert_eq!(found.map(told), wanted.map(told), "{level:?} {kind} {turn} {lane}");
                }
                assert!((0..LANES).all(|lane| asks[lane] || drawn.get(lane).is_none()));
            }
        }
    }
}
