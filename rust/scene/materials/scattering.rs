//! All that scatters light at a point.

use crate::math::DVec3;
use crate::optics::{Bsdf, BsdfSample, Rgb};

/// All that scatters light at a point: one kind, or several that are weighed. Directions as [`Bsdf`] has them.
#[derive(Clone, Debug)]
pub enum Scattering {
    /// What most surfaces have.
    One(Bsdf),
    /// Several, of each its weight.
    Several(Vec<(Rgb, Bsdf)>),
}

impl<B: Into<Bsdf>> From<B> for Scattering {
    #[inline]
    fn from(bsdf: B) -> Self {
        Self::One(bsdf.into())
    }
}

impl Scattering {
    /// Two of them together, each with a weight.
    pub fn mixed(a: (Rgb, Self), b: (Rgb, Self)) -> Self {
        let mut all = Vec::new();
        for (weight, scattering) in [a, b] {
            if weight == Rgb::ZERO {
                continue;
            }
            match scattering {
                Self::One(bsdf) => all.push((weight, bsdf)),
                Self::Several(parts) => all.extend(parts.into_iter().map(|(w, bsdf)| (w * weight, bsdf))),
            }
        }
        // What scatters nothing draws nothing, whatever its density says: it must not be chosen.
        all.retain(|(_, bsdf)| bsdf.albedo() != Rgb::ZERO);
        match all[..] {
            [(Rgb::ONE, bsdf)] => Self::One(bsdf),
            _ => Self::Several(all),
        }
    }

    /// About the share of white light that is scattered, as [`Bsdf::albedo`] has it.
    pub fn albedo(&self) -> Rgb {
        match self {
            Self::One(bsdf) => bsdf.albedo(),
            Self::Several(parts) => parts.iter().map(|(weight, bsdf)| *weight * bsdf.albedo()).sum(),
        }
    }

    /// About the share of light from everywhere that is scattered into other than single directions.
    pub fn matt_albedo(&self) -> Rgb {
        let of_one = |bsdf: &Bsdf| if bsdf.is_delta() { Rgb::ZERO } else { bsdf.albedo() };
        match self {
            Self::One(bsdf) => of_one(bsdf),
            Self::Several(parts) => parts.iter().map(|(weight, bsdf)| *weight * of_one(bsdf)).sum(),
        }
    }

    /// What all of it is to be multiplied by for light that came to such a surface before, as [`Bsdf::again`] has it;
    /// of several, as much as their shares ask for.
    #[inline]
    pub fn again(&self) -> Rgb {
        match self {
            Self::One(bsdf) => bsdf.again(),
            Self::Several(parts) => {
                parts.iter().fold(Rgb::ONE, |again, (weight, bsdf)| again - *weight * (Rgb::ONE - bsdf.again()))
            }
        }
    }

    /// Whether all of it goes in single directions, so that [`Scattering::evaluate`] is 0 everywhere.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::One(bsdf) => bsdf.is_delta(),
            Self::Several(parts) => parts.iter().all(|(_, bsdf)| bsdf.is_delta()),
        }
    }

    /// Whether light goes through to the other side.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Self::One(bsdf) => bsdf.transmits(),
            Self::Several(parts) => parts.iter().any(|(_, bsdf)| bsdf.transmits()),
        }
    }

    /// How rough its sharpest part is, as [`Bsdf::roughness`] has it.
    #[inline]
    pub fn roughness(&self) -> f64 {
        match self {
            Self::One(bsdf) => bsdf.roughness(),
            Self::Several(parts) => parts.iter().map(|(_, bsdf)| bsdf.roughness()).fold(1.0, f64::min),
        }
    }

    /// Computes beforehand what goes by `wo` alone, as [`Bsdf::prepare`] does.
    #[inline]
    pub fn prepare(&mut self, wo: DVec3) {
        match self {
            Self::One(bsdf) => bsdf.prepare(wo),
            Self::Several(parts) => parts.iter_mut().for_each(|(_, bsdf)| bsdf.prepare(wo)),
        }
    }

    /// The scattering function times |cos θ| of `wi`, and the density with which [`Scattering::sample`] draws `wi`,
    /// both without what has a single direction.
    #[inline]
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
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

    /// Draws where the light comes from: `choice` among the parts (only asked for when there are several), `u` for the
    /// direction. `None` if the draw scatters nothing.
    #[inline]
    pub fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        match self {
            Self::One(bsdf) => bsdf.sample(wo, choice, u),
            Self::Several(parts) => {
                let total = share_of_all(parts);
                let mut left = choice() * total;
                let last = parts.iter().rposition(|(weight, _)| share(*weight) > 0.0)?;
                let mut chosen = last;
                for (i, (weight, _)) in parts[..last].iter().enumerate() {
                    let mine = share(*weight);
                    if left < mine {
                        chosen = i;
                        break;
                    }
                    left -= mine;
                }
                let (weight, bsdf) = &parts[chosen];
                let probability = share(*weight) / total;
                // What is left of the choice is as good as a new one.
                let rest = (left / share(*weight)).clamp(0.0, 1f64.next_down());
                let sample = bsdf.sample(wo, || rest, u)?;
                if sample.pdf == f64::INFINITY {
                    return Some(BsdfSample { weight: sample.weight * *weight / probability, ..sample });
                }
                let (value, pdf) = self.evaluate(wo, sample.wi);
                (pdf > 0.0).then(|| BsdfSample { weight: value / pdf, pdf, ..sample })
            }
        }
    }
}

/// How often a part of this weight is chosen, over that of the others.
fn share(weight: Rgb) -> f64 {
    weight.max_element()
}

fn share_of_all(parts: &[(Rgb, Bsdf)]) -> f64 {
    parts.iter().map(|(weight, _)| share(*weight)).sum()
}
