//! BSDFs whose parameters are stored in lanes directly.

use super::bsdf_columns::BsdfColumns;
use super::{Bsdf, BsdfSample, BsdfSampleLanes, Rgb, RgbLanes};
use raywright_base::math::{DVec3, InLanes, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};

/// BSDFs without lookups and with few branches: all parameters are stored in lanes, and each lane evaluates the scalar
/// code.
#[derive(Clone, Debug)]
pub struct Straight<B: InLanes>(B::Lanes);

loops! {
    /// Evaluates the lanes with a set flag.
    fn scatter<B: Bsdf + InLanes>(
        all: &B::Lanes,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (scattered, density) = B::get(all, i).evaluate(wo.get(i), wi.get(i));
            value.set(i, Rgb::select(asks[i], scattered, Rgb::ZERO));
            pdf[i] = if asks[i] { density } else { 0.0 };
        }
    }
}

loops! {
    /// Samples the lanes with a set flag.
    fn draw<B: Bsdf + InLanes>(
        all: &B::Lanes,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        choice: &[f64; LANES],
        u: &Pairs,
        wi: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
        eta: &mut [f64; LANES],
        is_through: &mut [bool; LANES],
    ) {
        for i in 0..LANES {
            let drawn = B::get(all, i).sample(wo.get(i), &mut || choice[i], [u[0][i], u[1][i]]);
            let drawn = drawn.unwrap_or(BsdfSample::new(wo.get(i), Rgb::ZERO, 0.0));
            wi.set(i, drawn.wi);
            weight.set(i, drawn.weight);
            pdf[i] = if asks[i] { drawn.pdf } else { 0.0 };
            eta[i] = drawn.eta;
            is_through[i] = drawn.is_through;
        }
    }
}

impl<B: Bsdf + InLanes> BsdfColumns<B> for Straight<B>
where
    Self: Clone + std::fmt::Debug,
{
    const NONE: Self = Self(B::EMPTY);

    #[inline]
    fn set(&mut self, lane: usize, of: &B, _wo: DVec3) {
        of.put(&mut self.0, lane);
    }

    fn evaluate<'a>(
        &self,
        level: Level,
        _each: impl Fn(usize) -> Option<&'a B> + Copy,
        asks: &[bool; LANES],
        [wo, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        B: 'a,
    {
        scatter::<B>(level, &self.0, asks, wo, wi, value, pdf);
    }

    fn sample<'a>(
        &self,
        level: Level,
        _each: impl Fn(usize) -> Option<&'a B> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        (choice, u): (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        B: 'a,
    {
        let BsdfSampleLanes { wi, weight, pdf, eta, is_through } = drawn;
        draw::<B>(level, &self.0, asks, wo, choice, u, wi, weight, pdf, eta, is_through);
    }
}
