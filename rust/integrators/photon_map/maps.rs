//! Maps of photons, as they are made.

use super::grid::HashedGrid;
use super::kd_tree::KdTree;
use super::photon::StoredPhoton;
use super::store::Counted;
use crate::integrators::is_matt;
use crate::integrators::light_paths::{Arrived, Dimensions, Flying, LightWalk, Limits, Times, Visitor};
use crate::integrators::nesting::MediumStack;
use crate::sampling::Sampler;
use crate::scene::{Camera, EmissionSample, Emitters, Scene};
use crate::workers::Cancel;
use rayon::prelude::*;

/// How photons of one map are sent.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrators) struct Flight {
    /// How many paths start at lights.
    pub paths: u32,
    pub limits: Limits,
    /// Whether those that have come by way of sharp surfaces alone have a map of their own.
    pub caustic: bool,
    pub seed: u64,
    /// Which of all maps of the seed.
    pub number: u32,
    /// When all are on their way, while the shutter is open, if anything moves.
    pub time: Option<f64>,
}

/// Photons, and where they are found.
#[derive(Debug)]
pub(in crate::integrators) struct PhotonIndex {
    pub photons: Vec<StoredPhoton>,
    pub places: Places,
}

#[derive(Debug)]
pub(in crate::integrators) enum Places {
    /// For all within a radius.
    Grid(HashedGrid),
    /// For the nearest.
    Tree(KdTree),
}

impl PhotonIndex {
    /// For all within a radius, or for the nearest.
    pub fn new(photons: Vec<StoredPhoton>, radius: Option<f64>) -> Self {
        let positions = photons.iter().map(|photon| photon.position);
        let places = match radius {
            Some(radius) => Places::Grid(HashedGrid::new(positions, radius)),
            None => Places::Tree(KdTree::new(positions)),
        };
        Self { photons, places }
    }
}

/// Photons of one flight: those that matt surfaces get by way of sharp ones alone, if they are kept apart, and all
/// others that have been scattered.
#[derive(Debug)]
pub(in crate::integrators) struct Maps {
    pub caustic: PhotonIndex,
    pub global: PhotonIndex,
}

impl Counted for Maps {
    fn count(&self) -> usize {
        self.caustic.photons.len() + self.global.photons.len()
    }
}

/// Follows the paths of a flight, by all threads of the current pool or by this one alone: some thousands at a time,
/// for each of which a visitor is made who is told of them. What they are told depends on the flight alone. Of no use
/// once it is cancelled.
pub(in crate::integrators) fn flown<'a, V: Visitor<'a> + Send>(
    scene: &'a Scene,
    emitters: &'a Emitters<'a>,
    camera: &'a dyn Camera,
    flight: &Flight,
    (alone, cancel): (bool, &Cancel),
    visitor: impl Fn(usize) -> V + Sync,
) -> Vec<V> {
    /// Paths that are followed together.
    const TOGETHER: u32 = 4096;
    /// Paths from lights are numbered as pixels that no picture has.
    const BEYOND: u32 = 1 << 31;
    let follow = |chunk: u32| {
        let paths = chunk * TOGETHER..flight.paths.min((chunk + 1).saturating_mul(TOGETHER));
        let mut samplers: Vec<Sampler> =
            paths.map(|path| Sampler::new(flight.seed, BEYOND | path, flight.number)).collect();
        let mut visitor = visitor(samplers.len());
        if !cancel.is_raised() {
            let mut walk = LightWalk::new(scene, emitters, flight.limits, Some(camera));
            walk.set_times(flight.time.map_or(Times::Drawn, Times::All));
            walk.follow(&mut samplers, cancel, &mut visitor);
        }
        visitor
    };
    let chunks = 0..flight.paths.div_ceil(TOGETHER);
    if alone { chunks.map(follow).collect() } else { chunks.into_par_iter().with_max_len(1).map(follow).collect() }
}

/// Sends photons, as [`flown`], and gives those that came by way of sharp surfaces alone and the others.
pub(super) fn fly<'a>(
    scene: &'a Scene,
    emitters: &'a Emitters<'a>,
    camera: &'a dyn Camera,
    flight: &Flight,
    alone: bool,
    cancel: &Cancel,
) -> [Vec<StoredPhoton>; 2] {
    let share = 1.0 / f64::from(flight.paths);
    let storing = |_| Storing { share, caustic: flight.caustic, chains: Vec::new(), stored: Default::default() };
    let parts = flown(scene, emitters, camera, flight, (alone, cancel), storing);
    parts.into_iter().fold(Default::default(), |[mut caustic, mut global], part| {
        let [c, g] = part.stored;
        caustic.extend(c);
        global.extend(g);
        [caustic, global]
    })
}

/// Keeps what comes to matt surfaces.
struct Storing {
    share: f64,
    caustic: bool,
    /// Of each path, whether all surfaces that it has been scattered at were sharp.
    chains: Vec<bool>,
    stored: [Vec<StoredPhoton>; 2],
}

impl Visitor<'_> for Storing {
    fn set_out(&mut self, path: &Flying, _: &EmissionSample) {
        self.chains.resize(path.number as usize + 1, true);
    }

    fn meet(&mut self, arrived: &Arrived, path: &Flying, _: &MediumStack, _: (&mut Sampler, Dimensions)) {
        // What comes straight from a light is found by asking that.
        if path.bounce == 1 {
            return;
        }
        let is_sharp = &mut self.chains[path.number as usize];
        *is_sharp &= path.is_sharp;
        if is_matt(arrived.here.bsdf()) {
            let photon = StoredPhoton::arrived(arrived, path, self.share);
            self.stored[usize::from(!(self.caustic && *is_sharp))].push(photon);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Rgb;
    use crate::scene::fixtures::{cornell, furnace};

    fn flight(paths: u32, limits: Limits) -> Flight {
        Flight { paths, limits, caustic: true, seed: 3, number: 0, time: None }
    }

    #[test]
    fn stored_power_is_the_series_of_bounces() {
        // Of what six walls send, each meeting absorbs the share 1 − ρ: without first ones, emitted ρ / (1 − ρ) is
        // stored.
        let (_, camera) = cornell(8, 8);
        let (scene, rho) = (furnace(0.7, 1.0), 0.7);
        let emitters = scene.emitters().unwrap();
        let all = Limits { max_depth: None, roulette_depth: 4 };
        let [caustic, global] = fly(&scene, &emitters, &camera, &flight(100_000, all), false, &Cancel::default());
        assert!(caustic.is_empty());
        let stored: Rgb = global.iter().map(|photon| photon.power(false)).sum();
        let expected = 24.0 * std::f64::consts::PI * rho / (1.0 - rho);
        // Before roulette, all are alike; after it a path brings what is left, 0.7⁴ of all, with a standard deviation
        // of about its mean: of 100,000 it is known to 0.1 %.
        assert!((stored.mean() / expected - 1.0).abs() < 0.004, "{stored:?}");
        // Each bounce leaves the share ρ, exactly, as long as there is no roulette.
        let exact = Limits { max_depth: Some(6), roulette_depth: u32::MAX };
        let [_, global] = fly(&scene, &emitters, &camera, &flight(2000, exact), true, &Cancel::default());
        let of = |bounces| {
            global.iter().filter(|p| p.bounces == bounces).map(|photon| photon.power(false)).sum::<Rgb>().mean()
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
        let places = |all: &[Vec<StoredPhoton>; 2]| all[1].iter().map(|photon| photon.position).collect::<Vec<_>>();
        assert_eq!(places(&a), places(&b));
        let other = Flight { number: 1, ..flight };
        assert_ne!(places(&fly(&scene, &emitters, &camera, &other, true, &Cancel::default())), places(&a));
    }
}
