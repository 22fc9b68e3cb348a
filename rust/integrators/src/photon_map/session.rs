//! Integrator sessions of photon mapping.

use super::disk_coverage::cover;
use super::estimate::Estimate;
use super::kernel::Kernel;
use super::map_cache::Suitable;
use super::map_series::{Sending, Series};
use super::photon_tracing::{Maps, PhotonIndex, fly};
use super::radius::NEIGHBOURS;
use super::volume_estimate::room;
use super::volume_photon::VolumeIndex;
use crate::known_light::{Gather, KnownLight, Visit};
use crate::media::current_medium::Filled;
use crate::media::scattering::Scattering;
use crate::nesting::MediumStack;
use crate::path_settings::PathSettings;
use crate::wavefront::{Limits, Wavefront};
use crate::{Job, Session, Worker};
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::materials::BsdfMix;
use raywright_scene::{Emitters, Scene, SurfaceInteraction};
use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

/// Parameters of a photon-mapped picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub sending: Sending,
    pub nearest: Option<u32>,
    pub gather: u32,
    pub kernel: Kernel,
    pub scale: f64,
}

/// Shared data for taking samples.
struct Known<'a> {
    scene: &'a Scene,
    estimate: Estimate,
    /// Estimate parameters in media.
    among: Estimate,
    series: Series<'a, Maps>,
}

impl Known<'_> {
    fn matt<B: Bsdf>(&self, here: &SurfaceInteraction<B>, visit: Visit) -> Rgb {
        let Some(maps) = self.series.of(visit.number) else { return Rgb::ZERO };
        let time = || self.series.scene_time(visit.number);
        // With a fixed radius both maps use the same disk, which is probed once.
        let probed = Cell::new((f64::NAN, 0.0));
        let share = |squared: f64| {
            if probed.get().0 != squared {
                probed.set((squared, cover(self.scene, here, squared, self.estimate.kernel, time())));
            }
            probed.get().1
        };
        let gathered = |of| self.estimate.radiance(of, here, &visit, share);
        let light = gathered(&maps.caustic);
        if visit.looks_about { light } else { light + gathered(&maps.global) }
    }
}

impl KnownLight for Known<'_> {
    fn at_surface(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb {
        self.matt(here, visit)
    }

    fn waves(&self, number: u32) -> Option<Waves> {
        self.series.waves(number)
    }

    fn among(&self, here: &Scattering, media: &MediumStack<Filled>, time: f64, visit: Visit) -> Rgb {
        let Some(maps) = self.series.of(visit.number) else { return Rgb::ZERO };
        let share = |squared: f64| room(self.scene, here.position, media, squared, self.among.kernel, time);
        self.among.scattered(&maps.among, here, media, &visit, share)
    }
}

/// Maximum distance of nearest neighbors, as a multiple of their usual distance. Without it, lookups in regions with
/// hardly any photons would visit the whole map. Such regions are too dark to need as many photons.
const FARTHEST: f64 = 8.0;

/// Data shared by the workers of a picture.
pub(super) struct Mapped<'a> {
    job: Job<'a>,
    /// `None` if there are no lights or nothing scatters their light.
    emitters: Option<Emitters<'a>>,
    known: Arc<Known<'a>>,
    seen: Wavefront<'a>,
}

impl<'a> Mapped<'a> {
    pub fn new(job: Job<'a>, recipe: Recipe, radius: Option<f64>, cancel: &Cancel) -> Self {
        let Recipe { sending, nearest, gather, kernel, scale } = recipe;
        let limits = sending.limits;
        let emitters = job.scene.emitters().filter(|_| limits.max_depth.is_none_or(|depth| depth > 0));
        let series = Series::new(job, sending);
        let suitable = || series.suitable(emitters.as_ref(), cancel);
        let far = |count: u32| {
            let (suitable, more) = (suitable(), f64::from(count) / NEIGHBOURS as f64);
            Suitable { disk: FARTHEST * suitable.disk * more.sqrt(), ball: FARTHEST * suitable.ball * more.cbrt() }
        };
        let given = radius.map(|radius| Suitable { disk: radius, ball: radius });
        let (most, series) = match nearest {
            None => {
                let radii = given.unwrap_or_else(suitable);
                (
                    Suitable { disk: f64::INFINITY, ball: f64::INFINITY },
                    series.with_radius(radii.disk).with_ball(radii.ball),
                )
            }
            Some(count) => {
                let radii = given.unwrap_or_else(|| far(count));
                (Suitable { disk: radii.disk * radii.disk, ball: radii.ball * radii.ball }, series)
            }
        };
        let estimate = Estimate { nearest, most: most.disk, kernel, scale };
        let among = Estimate { most: most.ball, ..estimate };
        let known = Arc::new(Known { scene: job.scene, estimate, among, series });
        let gather = Some(Gather { rays: gather, caustic: sending.caustic });
        let Limits { max_depth, roulette_depth } = limits;
        let settings = PathSettings { gather, ..PathSettings::path(max_depth, roulette_depth) };
        let seen = Wavefront::new(job, settings, None, Some(Arc::clone(&known) as Arc<dyn KnownLight + 'a>));
        Self { job, emitters, known, seen }
    }
}

impl Session for Mapped<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        self.seen.worker()
    }

    fn at_once(&self) -> Option<u32> {
        Some(self.known.series.at_once())
    }

    fn before_samples(&self, numbers: Range<u32>, alone: bool, cancel: &Cancel) {
        let Some(emitters) = &self.emitters else { return };
        self.known.series.prepare(numbers, cancel, |flight, radius| {
            let found = fly(self.job.scene, emitters, self.job.camera, flight, alone, cancel);
            let [caustic, global] = found.surfaces.map(|photons| PhotonIndex::new(photons, radius));
            Some(Maps { caustic, global, among: VolumeIndex::new(found.among, self.known.series.ball(flight.number)) })
        });
    }

    fn time(&self, number: u32) -> Option<f64> {
        self.known.series.time(number)
    }
}
