//! Wavelengths of paths in place of red, green and blue.

use super::queues::own;
use crate::CameraSamples;
use crate::common_numbers::{COMMON_WAVES, spread};
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

impl PathWaves {
    /// Of a path that starts.
    pub fn new(first: Waves) -> Self {
        Self { first, now: first }
    }
}

impl WavesBlock {
    /// Of no paths.
    pub const NONE: Self =
        Self { waves: [None; LANES], around: [Dispersive::NONE; LANES], parting: [None; LANES], ends: [false; LANES] };
}

/// Draw wavelengths for some of the samples, in a scene that needs them. Known light has its own wavelengths.
///
/// Samples of a group have equal wavelengths, so that they can share. Groups are formed anew for each sample number, so
/// all groups of a number have equal wavelengths, by a seed: this stratifies the wavelengths of each pixel. Without
/// groups, each sample has its own wavelengths.
pub(super) fn draw(
    samples: &CameraSamples,
    some: Range<usize>,
    (groups, seed): (&[u32], u64),
    known: Option<&dyn KnownLight>,
    waves: &mut Vec<PathWaves>,
) {
    let Some(samplers) = &samples.samplers else { return };
    waves.clear();
    let (shares, mut groups, mut start) = (!groups.is_empty(), groups.iter(), some.start);
    while start < some.end {
        let mut sampler = samplers.get(start);
        let number = sampler.number();
        let first = known.and_then(|known| known.waves(number)).unwrap_or_else(|| {
            let u = if shares { spread(seed, number, COMMON_WAVES) } else { sampler.one(Dimensions::WAVES) };
            Waves::of(u)
        });
        let count = groups.next().map_or(1, |&count| count as usize);
        waves.extend(std::iter::repeat_n(PathWaves::new(first), count));
        start += count;
    }
}

/// Return the wavelengths that the path of a sample carries; `None` for red, green and blue.
pub(super) fn at(waves: &[PathWaves], sample: u32) -> Option<Waves> {
    waves.get(own(sample, waves.len() as u32) as usize).map(|waves| waves.now)
}

/// Converts radiances at the wavelengths of samples to RGB.
pub(super) fn see(waves: &[PathWaves], radiance: &mut [Rgb]) {
    for (light, waves) in radiance.iter_mut().zip(waves) {
        *light = waves.first.seen(*light);
    }
}
