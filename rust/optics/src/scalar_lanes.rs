//! Scalar evaluation of BSDFs lane by lane.

use super::bsdf_columns::BsdfColumns;
use super::{Bsdf, BsdfSampleLanes, RgbLanes};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};
use std::array::from_fn;

/// BSDFs that consist mainly of table lookups, or that few scenes have: lanes are evaluated one by one, in a loop that
/// is compiled for each level.
#[derive(Clone, Copy, Debug)]
pub struct Looped;

loops! {
    /// Evaluates the lanes with a set flag.
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
    /// Samples the lanes with a set flag.
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
