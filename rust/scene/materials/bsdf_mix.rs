//! All that scatters light at a point.

use crate::math::DVec3;
use crate::optics::{AnyBsdf, Bsdf, BsdfSample, Conductor, Rgb};

/// All that scatters light at a point: one kind, or several that are weighed.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "what most surfaces have must not be allocated at every hit")]
pub enum BsdfMix {
    /// What most surfaces have.
    One(AnyBsdf),
    /// Several, of each its weight.
    Several(Vec<(Rgb, AnyBsdf)>),
}

impl<B: Into<AnyBsdf>> From<B> for BsdfMix {
    #[inline]
    fn from(bsdf: B) -> Self {
        Self::One(bsdf.into())
    }
}

impl BsdfMix {
    /// Two of them together, each with a weight.
    pub fn mixed(a: (Rgb, Self), b: (Rgb, Self)) -> Self {
        let mut all = Vec::new();
        for (weight, bsdf) in [a, b] {
            if weight.is_black() {
                continue;
            }
            match bsdf {
                Self::One(bsdf) => all.push((weight, bsdf)),
                Self::Several(parts) => all.extend(parts.into_iter().map(|(w, bsdf)| (w * weight, bsdf))),
            }
        }
        // What scatters nothing draws nothing, whatever its density says: it must not be chosen.
        all.retain(|(_, bsdf)| !bsdf.albedo().is_black());
        match all[..] {
            [(Rgb::ONE, bsdf)] => Self::One(bsdf),
            _ => Self::Several(all),
        }
    }

    /// About the share of light from everywhere that is scattered into other than single directions.
    pub fn matt_albedo(&self) -> Rgb {
        let of_one = |bsdf: &AnyBsdf| if bsdf.is_delta() { Rgb::ZERO } else { bsdf.albedo() };
        match self {
            Self::One(bsdf) => of_one(bsdf),
            Self::Several(parts) => parts.iter().map(|(weight, bsdf)| *weight * of_one(bsdf)).sum(),
        }
    }

    /// Calls with each rough metal, and its weight.
    pub fn dull_lobes(&self, mut each: impl FnMut(Rgb, &Conductor)) {
        let mut of_one = |weight: Rgb, bsdf: &AnyBsdf| match bsdf {
            AnyBsdf::Conductor(metal) if !metal.is_delta() => each(weight, metal),
            _ => {}
        };
        match self {
            Self::One(bsdf) => of_one(Rgb::ONE, bsdf),
            Self::Several(parts) => parts.iter().for_each(|(weight, bsdf)| of_one(*weight, bsdf)),
        }
    }

    /// Every single direction that light is scattered into, each with all of its weight, not over the chance to be
    /// drawn.
    pub fn delta_lobes(&self, wo: DVec3, mut each: impl FnMut(BsdfSample)) {
        match self {
            Self::One(bsdf) => delta_lobes(bsdf, Rgb::ONE, wo, &mut each),
            Self::Several(parts) => parts.iter().for_each(|(weight, bsdf)| delta_lobes(bsdf, *weight, wo, &mut each)),
        }
    }
}

/// Those of one kind, which have the least choices: one after the other.
fn delta_lobes(bsdf: &AnyBsdf, weight: Rgb, wo: DVec3, each: &mut impl FnMut(BsdfSample)) {
    let mut choice = 0.0;
    while choice < 1.0
        && let Some(drawn) = bsdf.sample(wo, || choice, [0.5; 2])
        && drawn.is_delta()
    {
        each(BsdfSample { weight: drawn.weight * weight * drawn.probability(), ..drawn });
        choice = drawn.choices[1];
    }
}

impl Bsdf for BsdfMix {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        match self {
            Self::One(bsdf) => bsdf.evaluate(wo, wi),
            Self::Several(parts) => {
                let (mut value, mut density, total) = (Rgb::ZERO, 0.0, share_of_all(parts));
                for (weight, bsdf) in parts {
                    let (of_part, pdf) = bsdf.evaluate(wo, wi);
                    value += *weight * of_part;
                    density += share(*weight) / total * pdf;
                }
                if total > 0.0 { (value, density) } else { (Rgb::ZERO, 0.0) }
            }
        }
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        match self {
            Self::One(bsdf) => bsdf.sample(wo, choice, u),
            Self::Several(parts) => {
                let total = share_of_all(parts);
                let mut left = choice() * total;
                let last = parts.iter().rposition(|(weight, _)| share(*weight) > 0.0)?;
                let (mut chosen, mut before) = (last, 0.0);
                for (i, (weight, _)) in parts[..last].iter().enumerate() {
                    let mine = share(*weight);
                    if left < mine {
                        chosen = i;
                        break;
                    }
                    left -= mine;
                    before += mine;
                }
                let (weight, bsdf) = &parts[chosen];
                let probability = share(*weight) / total;
                // What is left of the choice is as good as a new one.
                let rest = (left / share(*weight)).clamp(0.0, 1f64.next_down());
                let sample = bsdf.sample(wo, || rest, u)?;
                let is_end = |choice| chosen == last && choice == 1.0;
                let among_all = |choice| if is_end(choice) { 1.0 } else { (before + choice * share(*weight)) / total };
                let choices = sample.choices.map(among_all);
                if sample.is_delta() {
                    return Some(BsdfSample { weight: sample.weight * *weight / probability, choices, ..sample });
                }
                let (value, pdf) = self.evaluate(wo, sample.wi);
                (pdf > 0.0).then(|| BsdfSample { weight: value / pdf, pdf, choices, ..sample })
            }
        }
    }

    #[inline]
    fn prepare(&mut self, wo: DVec3) {
        match self {
            Self::One(bsdf) => bsdf.prepare(wo),
            Self::Several(parts) => parts.iter_mut().for_each(|(_, bsdf)| bsdf.prepare(wo)),
        }
    }

    fn albedo(&self) -> Rgb {
        match self {
            Self::One(bsdf) => bsdf.albedo(),
            Self::Several(parts) => parts.iter().map(|(weight, bsdf)| *weight * bsdf.albedo()).sum(),
        }
    }

    /// Of several, as much as their shares ask for.
    #[inline]
    fn again(&self) -> Rgb {
        match self {
            Self::One(bsdf) => bsdf.again(),
            Self::Several(parts) => {
                parts.iter().fold(Rgb::ONE, |again, (weight, bsdf)| again - *weight * (Rgb::ONE - bsdf.again()))
            }
        }
    }

    #[inline]
    fn is_delta(&self) -> bool {
        match self {
            Self::One(bsdf) => bsdf.is_delta(),
            Self::Several(parts) => parts.iter().all(|(_, bsdf)| bsdf.is_delta()),
        }
    }

    #[inline]
    fn transmits(&self) -> bool {
        match self {
            Self::One(bsdf) => bsdf.transmits(),
            Self::Several(parts) => parts.iter().any(|(_, bsdf)| bsdf.transmits()),
        }
    }

    #[inline]
    fn roughness(&self) -> f64 {
        match self {
            Self::One(bsdf) => bsdf.roughness(),
            Self::Several(parts) => parts.iter().map(|(_, bsdf)| bsdf.roughness()).fold(1.0, f64::min),
        }
    }

    #[inline]
    fn diffuse(&self) -> Option<Rgb> {
        if let Self::One(bsdf) = self { bsdf.diffuse() } else { None }
    }
}

/// How often a part of this weight is chosen, over that of the others.
fn share(weight: Rgb) -> f64 {
    weight.max()
}

fn share_of_all(parts: &[(Rgb, AnyBsdf)]) -> f64 {
    parts.iter().map(|(weight, _)| share(*weight)).sum()
}
