//! Photon tracing.

use super::map_cache::PhotonCount;
use super::photon::StoredPhoton;
use super::photon_lookup::Places;
use super::volume_photon::{VolumeIndex, VolumePhoton};
use crate::path_vertices::Point;
use crate::wavefront::{
    Arrival, Limits, Subpath, SubpathEmission, SubpathSink, SubpathWavefront, Times, VertexContext,
};
use raywright_base::parallel;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_scene::{Camera, EmissionSample, Emitters, Scene};

/// Parameters for tracing the photons of one map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonPass {
    /// Number of light paths.
    pub paths: u32,
    pub limits: Limits,
    /// Store caustic photons (those that arrive through specular surfaces alone) in a separate map.
    pub caustic: bool,
    pub seed: u64,
    /// Index of the map among those of the seed.
    pub number: u32,
    /// Time within the shutter interval of all photons, if anything moves.
    pub time: Option<f64>,
    /// Wavelengths of all photons; `None` for RGB.
    pub waves: Option<Waves>,
}

/// Photons with their lookup structure.
#[derive(Debug)]
pub(crate) struct PhotonIndex {
    pub photons: Vec<StoredPhoton>,
    pub places: Places,
}

impl PhotonIndex {
    /// Build a lookup structure for a given radius, or for nearest neighbors.
    pub fn new(photons: Vec<StoredPhoton>, radius: Option<f64>) -> Self {
        let places = Places::new(photons.iter().map(|photon| photon.position), radius);
        Self { photons, places }
    }
}

/// Photon maps of one flight: caustic photons on matte surfaces if separate, all other indirect photons on matte
/// surfaces, and all photons in media.
#[derive(Debug)]
pub(crate) struct Maps {
    pub caustic: PhotonIndex,
    pub global: PhotonIndex,
    pub among: VolumeIndex,
}

impl PhotonCount for Maps {
    fn count(&self) -> usize {
        self.caustic.photons.len() + self.global.photons.len() + self.among.photons.len()
    }
}

/// Photons of one flight, ordered by path.
#[derive(Default)]
pub(super) struct Flown {
    /// Surface photons: caustic ones if separate, and others.
    pub surfaces: [Vec<StoredPhoton>; 2],
    /// Photons in media.
    pub among: Vec<VolumePhoton>,
}

/// Trace the paths of a flight in chunks of some thousands, on all threads of the current pool or on this one alone,
/// with one sink per chunk. Results depend on the flight alone. After a cancellation they are incomplete and must be
/// discarded.
pub(crate) fn flown<'a, S: SubpathSink<'a> + Send>(
    scene: &'a Scene,
    emitters: &'a Emitters<'a>,
    camera: &'a dyn Camera,
    flight: &PhotonPass,
    (alone, cancel): (bool, &Cancel),
    sink: impl Fn(usize) -> S + Sync,
) -> Vec<S> {
    /// Number of paths per chunk.
    const TOGETHER: u32 = 4096;
    /// Light paths use pixel indices beyond those of any picture.
    const BEYOND: u32 = 1 << 31;
    let follow = |chunk: u32| {
        let paths = chunk * TOGETHER..flight.paths.min((chunk + 1).saturating_mul(TOGETHER));
        let mut samplers: Vec<Sampler> =
            paths.map(|path| Sampler::new(flight.seed, BEYOND | path, flight.number)).collect();
        let mut sink = sink(samplers.len());
        if !cancel.is_raised() {
            let mut wavefront = SubpathWavefront::of_lights(scene, flight.limits);
            wavefront.set_waves(flight.waves.into_iter().flat_map(|waves| std::iter::repeat_n(waves, samplers.len())));
            let times = flight.time.map_or(Times::Drawn, Times::All);
            let emission = SubpathEmission { emitters, camera: Some(camera), times: &times };
            wavefront.follow_light(&mut samplers, &emission, cancel, &mut sink);
        }
        sink
    };
    let chunks = flight.paths.div_ceil(TOGETHER);
    if alone { (0..chunks).map(follow).collect() } else { parallel::map(chunks as usize, |chunk| follow(chunk as u32)) }
}

/// Trace photons and return the stored ones.
pub(super) fn fly<'a>(
    scene: &'a Scene,
    emitters: &'a Emitters<'a>,
    camera: &'a dyn Camera,
    flight: &PhotonPass,
    alone: bool,
    cancel: &Cancel,
) -> Flown {
    let share = 1.0 / f64::from(flight.paths);
    let storing = |_| Storing { share, caustic: flight.caustic, chains: Vec::new(), stored: Flown::default() };
    let parts = flown(scene, emitters, camera, flight, (alone, cancel), storing);
    parts.into_iter().fold(Flown::default(), |mut all, part| {
        for (all, part) in all.surfaces.iter_mut().zip(part.stored.surfaces) {
            all.extend(part);
        }
        all.among.extend(part.stored.among);
        all
    })
}

/// A sink that stores photons at matte surfaces and scattering events in media.
struct Storing {
    share: f64,
    caustic: bool,
    /// For each path, true if all its bounces so far were specular.
    chains: Vec<bool>,
    stored: Flown,
}

impl<'a> SubpathSink<'a> for Storing {
    fn set_out(&mut self, path: &Subpath, _: &EmissionSample) {
        self.chains.resize(path.number as usize + 1, true);
    }

    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, _: &mut VertexContext<'_>) {
        let bounces = path.bounce - 1;
        if bounces > 0 {
            self.chains[path.number as usize] &= path.is_sharp;
        }
        let is_in_medium = at.is_in_medium();
        // Light at the first surface is direct, and found by light sampling.
        if !is_in_medium && bounces == 0 {
            return;
        }
        let at = at.vertex();
        if let Point::Medium { here, came, .. } = &at.point {
            let power = (*came * self.share, path.single);
            self.stored.among.push(VolumePhoton::new(here, power, path.again, bounces, &at.media));
        }
        if let Some(arrived) = at.matte() {
            let power = (path.beta * self.share, path.single);
            let photon = StoredPhoton::arrived(arrived, power, bounces, path.again);
            let is_sharp = self.chains[path.number as usize];
            self.stored.surfaces[usize::from(!(self.caustic && is_sharp))].push(photon);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_optics::Rgb;
    use raywright_scene::fixtures::{cornell, furnace};

    fn flight(paths: u32, limits: Limits) -> PhotonPass {
        PhotonPass { paths, limits, caustic: true, seed: 3, number: 0, time: None, waves: None }
    }

    #[test]
    fn stored_power_is_the_series_of_bounces() {
        // Each bounce in a closed furnace absorbs the share 1 − ρ. Without direct light, the stored power is emitted
        // power times ρ / (1 − ρ).
        let (_, camera) = cornell(8, 8);
        let (scene, rho) = (furnace(0.7, 1.0), 0.7);
        let emitters = scene.emitters().unwrap();
        let all = Limits { max_depth: None, roulette_depth: 4 };
        let found = fly(&scene, &emitters, &camera, &flight(100_000, all), false, &Cancel::default());
        let [caustic, global] = found.surfaces;
        assert!(caustic.is_empty());
        let stored: Rgb = global.iter().map(|photon| photon.power(false, false)).sum();
        let expected = 24.0 * std::f64::consts::PI * rho / (1.0 - rho);
        // Before roulette starts, all paths carry equal power. Then each carries 0.7⁴ of it with a standard deviation
        // of about its mean: 100,000 paths give it to 0.1 %.
        assert!((stored.mean() / expected - 1.0).abs() < 0.004, "{stored:?}");
        // Without roulette, each bounce leaves exactly the share ρ.
        let exact = Limits { max_depth: Some(6), roulette_depth: u32::MAX };
        let found = fly(&scene, &emitters, &camera, &flight(2000, exact), true, &Cancel::default());
        let [_, global] = found.surfaces;
        let of = |bounces| {
            global.iter().filter(|p| p.bounces == bounces).map(|photon| photon.power(false, false)).sum::<Rgb>().mean()
        };
        for bounces in 1..6 {
            let expected = 24.0 * std::f64::consts::PI * rho.powi(bounces as i32);
            assert!((of(bounces) / expected - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn threads_change_no_photon() {
        let (scene, camera) = cornell(8, 8);
        let emitters = scene.emitters().unwrap();
        let flight = flight(10_000, Limits { max_depth: None, roulette_depth: 2 });
        let [a, b] = [true, false].map(|alone| fly(&scene, &emitters, &camera, &flight, alone, &Cancel::default()));
        let places = |all: &Flown| all.surfaces[1].iter().map(|photon| photon.position).collect::<Vec<_>>();
        assert_eq!(places(&a), places(&b));
        let other = PhotonPass { number: 1, ..flight };
        assert_ne!(places(&fly(&scene, &emitters, &camera, &other, true, &Cancel::default())), places(&a));
    }
}
