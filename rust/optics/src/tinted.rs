//! Dielectrics with tinted reflection and transmission.

use super::bsdf_columns::{BsdfColumns, LaneBsdf};
use super::{Bsdf, BsdfSample, BsdfSampleLanes, Rgb, RgbLanes};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};

/// A BSDF whose reflection and transmission are multiplied by colors.
#[derive(Clone, Copy, Debug)]
pub struct Tinted<B: Bsdf> {
    /// The BSDF without tint.
    pub inner: B,
    /// Factor on reflection, 0 to 1.
    pub reflectance: Rgb,
    /// Factor on transmission, 0 to 1.
    pub transmittance: Rgb,
}

impl<B: Bsdf> Tinted<B> {
    #[inline]
    fn share(&self, is_through: bool) -> Rgb {
        Rgb::select(is_through, self.transmittance, self.reflectance)
    }
}

impl<B: Bsdf> Bsdf for Tinted<B> {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        let (value, pdf) = self.inner.evaluate(wo, wi);
        (value * self.share(wo.z * wi.z < 0.0), pdf)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        let drawn = self.inner.sample(wo, choice, u)?;
        Some(BsdfSample { weight: drawn.weight * self.share(drawn.is_through), ..drawn })
    }

    fn albedo(&self) -> Rgb {
        self.inner.albedo() * (self.reflectance + self.transmittance) * 0.5
    }

    #[inline]
    fn is_delta(&self) -> bool {
        self.inner.is_delta()
    }

    #[inline]
    fn transmits(&self) -> bool {
        self.inner.transmits()
    }

    #[inline]
    fn roughness(&self) -> f64 {
        self.inner.roughness()
    }
}

/// Tinted BSDFs in structure-of-arrays form, each with an outgoing direction.
#[derive(Clone, Debug)]
pub struct TintedLanes<L> {
    inner: L,
    reflectance: RgbLanes,
    transmittance: RgbLanes,
}

loops! {
    /// Tints values of other directions.
    fn tint(
        reflectance: &RgbLanes,
        transmittance: &RgbLanes,
        wo: &VectorLanes,
        wi: &VectorLanes,
        value: &mut RgbLanes,
    ) {
        for i in 0..LANES {
            let is_through = wo.get(i).z * wi.get(i).z < 0.0;
            value.set(i, value.get(i) * Rgb::select(is_through, transmittance.get(i), reflectance.get(i)));
        }
    }
}

loops! {
    /// Tints samples.
    fn leave(
        reflectance: &RgbLanes,
        transmittance: &RgbLanes,
        is_through: &[bool; LANES],
        weight: &mut RgbLanes,
    ) {
        for i in 0..LANES {
            weight.set(i, weight.get(i) * Rgb::select(is_through[i], transmittance.get(i), reflectance.get(i)));
        }
    }
}

impl<B: LaneBsdf + Clone + std::fmt::Debug> LaneBsdf for Tinted<B> {
    type Lanes = TintedLanes<B::Lanes>;
}

impl<B: LaneBsdf> BsdfColumns<Tinted<B>> for TintedLanes<B::Lanes> {
    const NONE: Self =
        Self { inner: <B::Lanes as BsdfColumns<B>>::NONE, reflectance: RgbLanes::ZERO, transmittance: RgbLanes::ZERO };

    #[inline]
    fn set(&mut self, lane: usize, of: &Tinted<B>, wo: DVec3) {
        self.inner.set(lane, &of.inner, wo);
        self.reflectance.set(lane, of.reflectance);
        self.transmittance.set(lane, of.transmittance);
    }

    fn evaluate<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Tinted<B>> + Copy,
        asks: &[bool; LANES],
        [wo, wi]: [&VectorLanes; 2],
        value: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) where
        B: 'a,
    {
        self.inner.evaluate(level, |lane| each(lane).map(|of| &of.inner), asks, [wo, wi], value, pdf);
        tint(level, &self.reflectance, &self.transmittance, wo, wi, value);
    }

    fn sample<'a>(
        &self,
        level: Level,
        each: impl Fn(usize) -> Option<&'a Tinted<B>> + Copy,
        asks: &[bool; LANES],
        wo: &VectorLanes,
        numbers: (&[f64; LANES], &Pairs),
        drawn: &mut BsdfSampleLanes,
    ) where
        B: 'a,
    {
        self.inner.sample(level, |lane| each(lane).map(|of| &of.inner), asks, wo, numbers, drawn);
        leave(level, &self.reflectance, &self.transmittance, &drawn.is_through, &mut drawn.weight);
    }
}
