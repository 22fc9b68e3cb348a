//! Pictures by photon maps.

use super::cover::cover;
use super::estimate::Estimate;
use super::kernel::Kernel;
use super::maps::{Maps, PhotonIndex, fly};
use super::radius::NEIGHBOURS;
use super::series::{Sending, Series};
use crate::integrators::transport::{Gather, MattLight, Settings, Visit};
use crate::integrators::{Job, Session, Worker};
use crate::optics::Rgb;
use crate::scene::materials::BsdfMix;
use crate::scene::{Emitters, Scene, SurfaceInteraction};
use crate::workers::Cancel;
use std::ops::Range;
use std::sync::Arc;

/// How a picture is made of photons.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub sending: Sending,
    pub nearest: Option<u32>,
    pub gather: u32,
    pub kernel: Kernel,
    pub scale: f64,
}

/// What samples are being taken by.
struct Known<'a> {
    scene: &'a Scene,
    estimate: Estimate,
    series: Series<'a, Maps>,
}

impl MattLight for Known<'_> {
    fn radiance(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb {
        let Some(maps) = self.series.of(visit.number) else { return Rgb::ZERO };
        let time = || self.series.scene_time(visit.number);
        let share = |squared: f64| cover(self.scene, here, squared, self.estimate.kernel, time());
        let gathered = |of| self.estimate.radiance(of, here, &visit, share);
        let light = gathered(&maps.caustic);
        if visit.looks_about { light } else { light + gathered(&maps.global) }
    }
}

/// How many times as far nearest photons are looked for as they lie where most are. Where there are hardly any, the
/// whole map would be looked through at each place, and light is too dark there to need as many.
const FARTHEST: f64 = 8.0;

/// What workers on a picture share.
pub(super) struct Mapped<'a> {
    job: Job<'a>,
    /// None where nothing shines, or no photon would be kept.
    emitters: Option<Emitters<'a>>,
    known: Arc<Known<'a>>,
    seen: Box<dyn Session + 'a>,
}

impl<'a> Mapped<'a> {
    pub fn new(job: Job<'a>, recipe: Recipe, radius: Option<f64>, cancel: &Cancel) -> Self {
        let Recipe { sending, nearest, gather, kernel, scale } = recipe;
        let limits = sending.limits;
        let emitters = job.scene.emitters().filter(|_| limits.max_depth.is_none_or(|depth| depth > 1));
        let series = Series::new(job, sending);
        let suitable = || series.suitable(emitters.as_ref(), cancel);
        let mut most = f64::INFINITY;
        let series = match nearest {
            None => {
                let radius = radius.unwrap_or_else(suitable);
                series.with_radius(radius)
            }
            Some(count) => {
                let far = || FARTHEST * suitable() * (f64::from(count) / NEIGHBOURS as f64).sqrt();
                let far = radius.unwrap_or_else(far);
                most = far * far;
                series
            }
        };
        let estimate = Estimate { nearest, most, kernel, scale };
        let known = Arc::new(Known { scene: job.scene, estimate, series });
        let gather = Some(Gather { rays: gather, caustic: sending.caustic });
        let settings = Settings { gather, ..Settings::path(limits.max_depth, limits.roulette_depth) };
        let seen = settings.begin_with(job, Arc::clone(&known) as Arc<dyn MattLight + 'a>);
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
            let [caustic, global] = fly(self.job.scene, emitters, self.job.camera, flight, alone, cancel);
            let index = |photons| PhotonIndex::new(photons, radius);
            Some(Maps { caustic: index(caustic), global: index(global) })
        });
    }

    fn time(&self, number: u32) -> Option<f64> {
        self.known.series.time(number)
    }
}
