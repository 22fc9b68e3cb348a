//! Mixtures of BSDFs.

use raywright_base::math::DVec3;
use raywright_optics::{AnyBsdf, Bsdf, BsdfSample, Conductor, Rgb};

/// The BSDF of a point: a single one, or a weighted mixture.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "what most surfaces have must not be allocated at every hit")]
pub enum BsdfMix {
    /// A single BSDF, the common case.
    One(AnyBsdf),
    /// Several BSDFs with their weights.
    Several(Vec<(Rgb, AnyBsdf)>),
}

impl<B: Into<AnyBsdf>> From<B> for BsdfMix {
    #[inline]
    fn from(bsdf: B) -> Self {
        Self::One(bsdf.into())
    }
}

impl BsdfMix {
    /// A weighted mixture of two.
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
        // A component that scatters nothing must not be selected, because its sampled density would be meaningless.
        all.retain(|(_, bsdf)| !bsdf.albedo().is_black());
        match all[..] {
            [(Rgb::ONE, bsdf)] => Self::One(bsdf),
            _ => Self::Several(all),
        }
    }

    /// Approximate albedo of the non-delta components.
    pub fn matt_albedo(&self) -> Rgb {
        let of_one = |bsdf: &AnyBsdf| if bsdf.is_delta() { Rgb::ZERO } else { bsdf.albedo() };
        match self {
            Self::One(bsdf) => of_one(bsdf),
            Self::Several(parts) => parts.iter().map(|(weight, bsdf)| *weight * of_one(bsdf)).sum(),
        }
    }

    /// Calls `each` with every rough conductor and its weight.
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

    /// Calls `each` with every delta direction. Weights are not divided by the sampling probability.
    pub fn delta_lobes(&self, wo: DVec3, mut each: impl FnMut(BsdfSample)) {
        match self {
            Self::One(bsdf) => delta_lobes(bsdf, Rgb::ONE, wo, &mut each),
            Self::Several(parts) => parts.iter().for_each(|(weight, bsdf)| delta_lobes(bsdf, *weight, wo, &mut each)),
        }
    }
}

/// Enumerates the delta directions of one BSDF in the order of their choice numbers.
fn delta_lobes(bsdf: &AnyBsdf, weight: Rgb, wo: DVec3, each: &mut dyn FnMut(BsdfSample)) {
    let mut choice = 0.0;
    while choice < 1.0
        && let Some(drawn) = bsdf.sample(wo, &mut || choice, [0.5; 2])
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
                let mut sum = (Rgb::ZERO, 0.0);
                for (weight, probability, bsdf) in weighed(parts) {
                    sum = with_part(sum, (weight, probability), bsdf.evaluate(wo, wi));
                }
                sum
            }
        }
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        match self {
            Self::One(bsdf) => bsdf.sample(wo, choice, u),
            Self::Several(parts) => {
                let chosen = Chosen::new(parts, choice())?;
                let (weight, bsdf) = &parts[chosen.part];
                let sample = bsdf.sample(wo, &mut || chosen.rest, u)?;
                let choices = sample.choices.map(|choice| chosen.among_all(choice));
                if sample.is_delta() {
                    let weight = sample.weight * *weight / chosen.probability();
                    return Some(BsdfSample { weight, choices, ..sample });
                }
                let (value, pdf) = self.evaluate(wo, sample.wi);
                (pdf > 0.0).then(|| BsdfSample { weight: value / pdf, pdf, choices, ..sample })
            }
        }
    }

    fn albedo(&self) -> Rgb {
        match self {
            Self::One(bsdf) => bsdf.albedo(),
            Self::Several(parts) => parts.iter().map(|(weight, bsdf)| *weight * bsdf.albedo()).sum(),
        }
    }

    /// For a mixture, 1 minus the weighted sum of the components' differences from 1.
    #[inline]
    fn repeat_correction(&self) -> Rgb {
        match self {
            Self::One(bsdf) => bsdf.repeat_correction(),
            Self::Several(parts) => parts
                .iter()
                .fold(Rgb::ONE, |again, (weight, bsdf)| again - *weight * (Rgb::ONE - bsdf.repeat_correction())),
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

/// Sampling weight of a component.
fn share(weight: Rgb) -> f64 {
    weight.max()
}

/// Components with their weights and sampling probabilities; components of probability 0 are skipped.
pub(super) fn weighed(parts: &[(Rgb, AnyBsdf)]) -> impl Iterator<Item = (Rgb, f64, &AnyBsdf)> {
    let total: f64 = parts.iter().map(|(weight, _)| share(*weight)).sum();
    let all = if total > 0.0 { parts } else { &[] };
    all.iter().map(move |(weight, bsdf)| (*weight, share(*weight) / total, bsdf))
}

/// Adds a component with a weight and a probability to a value and a density.
#[inline(always)]
pub(super) fn with_part(sum: (Rgb, f64), (weight, probability): (Rgb, f64), part: (Rgb, f64)) -> (Rgb, f64) {
    (sum.0 + weight * part.0, sum.1 + probability * part.1)
}

/// A sampled component.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen {
    /// Its index.
    pub part: usize,
    /// The remaining random number, uniform again.
    pub rest: f64,
    /// Sampling weights: the sum before it, its own, and the total.
    shares: [f64; 3],
    is_last: bool,
}

impl Chosen {
    /// Selects a component; `None` if all weights are 0.
    pub fn new(parts: &[(Rgb, AnyBsdf)], choice: f64) -> Option<Self> {
        let total: f64 = parts.iter().map(|(weight, _)| share(*weight)).sum();
        let last = parts.iter().rposition(|(weight, _)| share(*weight) > 0.0)?;
        let (mut left, mut part, mut before) = (choice * total, last, 0.0);
        for (i, (weight, _)) in parts[..last].iter().enumerate() {
            let mine = share(*weight);
            if left < mine {
                part = i;
                break;
            }
            left -= mine;
            before += mine;
        }
        let mine = share(parts[part].0);
        let rest = (left / mine).clamp(0.0, 1f64.next_down());
        Some(Self { part, rest, shares: [before, mine, total], is_last: part == last })
    }

    /// Probability of the component.
    #[inline]
    pub fn probability(&self) -> f64 {
        self.shares[1] / self.shares[2]
    }

    /// Maps a choice number within the component to one of the mixture.
    fn among_all(&self, choice: f64) -> f64 {
        let [before, mine, total] = self.shares;
        if self.is_last && choice == 1.0 { 1.0 } else { (before + choice * mine) / total }
    }
}
