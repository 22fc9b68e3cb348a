//! Photons as data for inspection.

use super::path_vertices::Point;
use super::wavefront::{
    Arrival, Limits, Subpath, SubpathEmission, SubpathSink, SubpathWavefront, Times, VertexContext,
};
use raywright_base::math::{DVec3, Ray};
use raywright_base::parallel;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{EmissionSample, Scene};

/// Light at a surface, or at a point of a medium that absorbs or scatters it.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Position.
    pub position: DVec3,
    /// Unit direction of propagation.
    pub direction: DVec3,
    /// Unit geometric normal on the side of incidence; zero in a medium.
    pub normal: DVec3,
    /// Flux, W.
    pub power: Rgb,
    /// Shape, and primitive of the shape; `None` in a medium.
    pub surface: Option<(u32, u32)>,
    /// Index of the light path.
    pub path: u32,
    /// Number of previous scattering events.
    pub bounces: u32,
    /// Bit mask of the first 64 scattering events: specular ones.
    pub sharp: u64,
    /// Bit mask of the first 64 scattering events: those in media.
    pub adrift: u64,
}

/// Light paths: a photon at each surface, and at each absorption or scattering in a medium.
#[derive(Clone, Debug, Default)]
pub struct Photons {
    /// Photons ordered by path, and along each path.
    pub photons: Vec<Photon>,
    /// Emitted flux, W.
    pub emitted: Rgb,
    /// Part of the flux that leaves the scene, directly or after scattering.
    pub escaped: Rgb,
    /// Part of the flux that media absorb.
    pub absorbed: Rgb,
}

/// Trace light paths of a scene, each with its own random numbers of a seed. A path has at most `max_depth` photons;
/// roulette starts after `roulette_depth`.
///
/// The result depends on the seed alone, not on threads. After a cancellation it returns soon, and the result must be
/// discarded.
pub fn photons(
    scene: &Scene,
    count: u32,
    (max_depth, roulette_depth): (Option<u32>, u32),
    seed: u64,
    cancel: &Cancel,
) -> Photons {
    /// Paths per batch; it affects the order of summation of the escaped flux.
    const TOGETHER: u32 = 4096;
    let Some(emitters) = scene.emitters() else { return Photons::default() };
    let limits = Limits { max_depth, roulette_depth };
    let follow = |chunk: u32| {
        let paths = chunk * TOGETHER..count.min((chunk + 1).saturating_mul(TOGETHER));
        let mut samplers: Vec<Sampler> = paths.clone().map(|path| Sampler::new(seed, path, 0)).collect();
        let mut seen =
            PhotonRecorder { scene, first: paths.start, share: 1.0 / f64::from(count), ..PhotonRecorder::new(scene) };
        if cancel.is_raised() {
            return seen.found;
        }
        let emission = SubpathEmission { emitters: &emitters, camera: None, times: &Times::Drawn };
        SubpathWavefront::of_lights(scene, limits).follow_light(&mut samplers, &emission, cancel, &mut seen);
        seen.found.photons.sort_unstable_by_key(|photon| (photon.path, photon.bounces));
        seen.found
    };
    let chunks: Vec<Photons> = parallel::map(count.div_ceil(TOGETHER) as usize, |chunk| follow(chunk as u32));
    chunks.into_iter().fold(Photons::default(), |mut all, chunk| {
        all.photons.extend(chunk.photons);
        all.emitted += chunk.emitted;
        all.escaped += chunk.escaped;
        all.absorbed += chunk.absorbed;
        all
    })
}

/// A sink that records photons.
struct PhotonRecorder<'a> {
    scene: &'a Scene,
    /// Index of the first path, and the share of the light per path.
    first: u32,
    share: f64,
    /// [`Photon::sharp`] and [`Photon::adrift`] of each path.
    chains: Vec<[u64; 2]>,
    found: Photons,
}

impl<'a> PhotonRecorder<'a> {
    fn new(scene: &'a Scene) -> Self {
        Self { scene, first: 0, share: 1.0, chains: Vec::new(), found: Photons::default() }
    }

    fn begin(&mut self, path: u32, flux: Rgb) {
        self.found.emitted += flux * self.share;
        self.chains.resize(path as usize + 1, [0; 2]);
    }

    /// Make the photon of a path; `is` says how it was scattered last.
    fn photon(&mut self, path: u32, bounces: u32, is: [bool; 2], flux: Rgb) -> Photon {
        let chain = &mut self.chains[path as usize];
        if (1..=u64::BITS).contains(&bounces) {
            for (chain, is) in chain.iter_mut().zip(is) {
                *chain |= u64::from(is) << (bounces - 1);
            }
        }
        let [sharp, adrift] = *chain;
        Photon {
            position: DVec3::ZERO,
            direction: DVec3::ZERO,
            normal: DVec3::ZERO,
            power: flux * self.share,
            surface: None,
            path: self.first + path,
            bounces,
            sharp,
            adrift,
        }
    }
}

impl<'a> SubpathSink<'a> for PhotonRecorder<'a> {
    fn set_out(&mut self, path: &Subpath, _: &EmissionSample) {
        self.begin(path.number, path.beta);
    }

    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, _: &mut VertexContext<'_>) {
        let is_in_medium = at.is_in_medium();
        let flux = match is_in_medium.then(|| &at.vertex().point) {
            Some(Point::Medium { medium, came, .. }) => *came * medium.extinction,
            _ => path.beta,
        };
        let photon = self.photon(path.number, path.bounce - 1, [path.is_sharp, path.is_adrift], flux);
        self.found.photons.push(Photon {
            position: at.origin.position(),
            direction: at.before,
            normal: at.normal,
            surface: (!is_in_medium).then(|| self.scene.geometry().locate(at.primitive)),
            ..photon
        });
    }

    fn absorb(&mut self, flux: Rgb) {
        self.found.absorbed += flux * self.share;
    }

    fn leave(&mut self, path: &Subpath, _: &Ray) {
        self.found.escaped += path.beta * self.share;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_scene::fixtures::{cornell, furnace};

    #[test]
    fn light_that_sets_out_arrives_or_escapes() {
        let (scene, _) = cornell(8, 8);
        let limits = (Some(1), u32::MAX);
        let found = photons(&scene, 20_000, limits, 3, &Cancel::default());
        let first: Rgb = found.photons.iter().filter(|p| p.bounces == 0).map(|p| p.power).sum();
        let off = (first + found.escaped - found.emitted).abs().max();
        assert!(off < 1e-9 * found.emitted.max(), "{off}");
        // With one lamp all paths carry equal power: π times area and radiance in total.
        let power = std::f64::consts::PI * 0.09 * 15.0;
        assert!((found.emitted.mean() / power - 1.0).abs() < 1e-5, "{:?}", found.emitted);
        assert!(found.photons.iter().all(|p| p.bounces == 0 && p.sharp == 0));
        assert!(found.photons.is_sorted_by_key(|p| (p.path, p.bounces)));
    }

    #[test]
    fn what_arrives_in_a_furnace_is_its_series() {
        // Six walls of area 4 emit π each and reflect half of the incident light: 24 π / (1 − ½) arrive in total.
        let found = photons(&furnace(0.5, 1.0), 100_000, (None, 4), 1, &Cancel::default());
        let arrived: Rgb = found.photons.iter().map(|p| p.power).sum();
        let expected = 24.0 * std::f64::consts::PI / 0.5;
        // Before roulette all paths carry equal power, and afterward 1/8 of all is left. Each path carries that with a
        // standard deviation below its mean: 100,000 paths give it to 0.05 %.
        assert!((arrived.mean() / expected - 1.0).abs() < 0.002, "{arrived:?}");
        assert!(found.escaped.is_black());
        let again = photons(&furnace(0.5, 1.0), 100_000, (None, 4), 1, &Cancel::default());
        assert_eq!(again.photons.len(), found.photons.len());
    }

    #[test]
    fn light_ends_where_nothing_absorbs_it() {
        let found = photons(&furnace(1.0, 1.0), 64, (None, u32::MAX), 1, &Cancel::default());
        assert!(found.photons.iter().any(|p| p.bounces > 4000));
    }
}
