//! Functions that are asked one after the other.

use super::bsdf_columns::BsdfColumns;
use super::{Bsdf, BsdfSampleLanes, RgbLanes};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use std::array::from_fn;

/// Functions of a kind that looks up more than it computes, or that few scenes have: lanes ask one after the other,
/// in a loop that is compiled for each level as any.
#[derive(Clone, Copy, Debug)]
pub struct Looped;

loops! {
    /// What each scatters, in the lanes that ask.
    fn scatter<B: Bsdf>(
        each: &[Option<&B>; LANES],
        wo: &VectorLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            if let Some(of) = each[i] {
                let (scattered, density) = of.evaluate(wo.get(i), wi.get(i));
                value.set(i, scattered);
                pdf[i] = density;
            }
        }
    }
}

loops! {
    /// What each draws, in the lanes that ask.
    fn draw<B: Bsdf>(
        each: &[Option<&B>; LANES],
        wo: &VectorLanes,
        choice: &[f64; LANES],
        u: &Pairs,
        drawn: &mut BsdfSampleLanes,
    ) {
        for i in 0..LANES {
            if let Some(of) = each[i] {
                drawn.set(i, of.sample(wo.get(i), &mut || choice[i], [u[0][i], u[1][i]]));
            }
        }
    }
}

impl<B: Bsdf> BsdfColumns<B> for Looped {
    const NONE: Self = Self;

    #[inline]
    fn set(&mut self, _lane: usize, _of: &B, _wo: DVec3) {}

    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a B> + Copy,
        asks: &[bool; LANES],
        [wo, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        B: 'a,
    {
        (*value, *pdf) = (RgbLanes::ZERO, [0.0; LANES]);
        let each = from_fn(|lane| if asks[lane] { each(lane) } else { None });
        scatter(level, &each, wo, wi, value, pdf);
    }

    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a B> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        B: 'a,
    {
        drawn.pdf = [0.0; LANES];
        let each = from_fn(|lane| if asks[lane] { each(lane) } else { None });
        draw(level, &each, wo, choice, u, drawn);
    }
}
