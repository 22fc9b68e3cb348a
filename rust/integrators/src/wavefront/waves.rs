//! Wavelengths of paths in place of red, green and blue.

use crate::CameraSamples;
use crate::dimensions::Dimensions;
use crate::known_light::KnownLight;
use crate::terminate_wavelengths::Parting;
use raywright_base::math::LANES;
use raywright_optics::spectra::Waves;
use raywright_optics::{Dispersive, Rgb};
use std::ops::Range;

/// Wavelengths of the path of a sample.
#[derive(Clone, Copy)]
pub(super) struct PathWaves {
    /// Those that it started with.
    first: Waves,
    /// Those that it carries: the hero's alone where dispersion has ended the others.
    pub now: Waves,
}

/// Wavelengths of sixteen paths at surfaces.
pub(super) struct WavesBlock {
    /// `None` for red, green and blue.
    pub waves: [Option<Waves>; LANES],
    /// The dispersion outside of the objects.
    pub around: [Dispersive; LANES],
    /// Dispersion that waits for the direction of a path; and true where it does not wait.
    pub parting: [Option<Parting>; LANES],
    pub ends: [bool; LANES],
}

impl WavesBlock {
    /// Of no paths.
    pub const NONE: Self =
        Self { waves: [None; LANES], around: [Dispersive::NONE; LANES], parting: [None; LANES], ends: [false; LANES] };
}

/// Wavelengths of some of the samples, in a scene that needs them: those of known light, if there is any.
pub(super) fn draw(
    samples: &CameraSamples,
    some: Range<usize>,
    known: Option<&dyn KnownLight>,
    waves: &mut Vec<PathWaves>,
) {
    let Some(samplers) = &samples.samplers else { return };
    waves.clear();
    waves.extend(some.map(|i| {
        let mut sampler = samplers.get(i);
        let of_known = known.and_then(|known| known.waves(sampler.number()));
        let first = of_known.unwrap_or_else(|| Waves::of(sampler.one(Dimensions::WAVES)));
        PathWaves { first, now: first }
    }));
}

/// Converts radiances at the wavelengths of samples to RGB.
pub(super) fn see(waves: &[PathWaves], radiance: &mut [Rgb]) {
    for (light, waves) in radiance.iter_mut().zip(waves) {
        *light = waves.first.seen(*light);
    }
}
