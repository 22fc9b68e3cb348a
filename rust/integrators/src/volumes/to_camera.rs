//! Light that comes to a camera through media.

use super::asking::at_once;
use super::course::Course;
use super::light_end::LightEnd;
use super::light_walk::{Drifting, MediaLightWalk, MediaVisitor};
use super::numbers::Numbers;
use super::vertex::Vertex;
use crate::light_paths::{Dimensions, EmissionDimensions, Limits, Onward, weight};
use crate::{Job, LightWorker, Splat};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, RayOrigin};

/// What one thread follows paths from lights with to where a camera sees them.
pub(crate) struct MediaLightPaths<'a> {
    walk: MediaLightWalk<'a>,
    connections: Connections<'a>,
}

/// How what they bring is weighed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Counting {
    /// In full.
    Full,
    /// Beside what is found in other ways, of so many paths for all that the camera's rays find.
    Beside(f64),
    /// In full for paths of so many vertices from the light, the camera being the other, and no others.
    Alone(u32),
    /// Not at all.
    Nothing,
}

/// What a camera sees of paths.
struct Connections<'a> {
    job: Job<'a>,
    emitters: &'a Emitters<'a>,
    counting: Counting,
    /// What the path that is on its way knows.
    end: Option<LightEnd>,
    splats: Vec<Splat>,
}

impl<'a> MediaLightPaths<'a> {
    pub fn new(job: Job<'a>, emitters: &'a Emitters<'a>, limits: Limits, counting: Counting) -> Self {
        let walk = MediaLightWalk::new(job.scene, emitters, limits, Some(job.camera));
        Self { walk, connections: Connections { job, emitters, counting, end: None, splats: Vec::new() } }
    }
}

impl LightWorker for MediaLightPaths<'_> {
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>) {
        self.connections.splats.clear();
        if self.connections.job.scene.plan().needs().waves {
            self.walk.set_waves(paths.iter_mut().map(|path| Waves::of(path.one(EmissionDimensions::WAVES))));
        }
        self.walk.follow(paths, cancel, &mut self.connections);
        splats.append(&mut self.connections.splats);
    }
}

impl Connections<'_> {
    /// How much it counts that the camera sees a path from a direction, with rays of a density.
    fn weigh(&self, at: &Vertex, path: &Drifting, (direction, distance): (DVec3, f64), seen: f64) -> f64 {
        match (self.counting, &self.end) {
            (Counting::Full, _) => 1.0,
            (Counting::Alone(light), _) => f64::from(u8::from(light == path.bounce + 1)),
            (Counting::Beside(paths), Some(end)) => {
                let comes = seen * at.cosine(direction) / paths;
                weight(end.others(self.emitters, at, &at.met_from(direction, distance), comes), 0.0)
            }
            _ => 0.0,
        }
    }
}

impl<'a> MediaVisitor<'a> for Connections<'a> {
    fn set_out(&mut self, _: &Drifting, light: &EmissionSample) {
        if let Counting::Beside(_) = self.counting {
            self.end = Some(LightEnd::of(self.emitters, light));
        }
    }

    fn go_on(&mut self, at: &Vertex<'a>, _: &Drifting, next: &Onward) {
        if let Some(end) = &mut self.end {
            end.go_on(self.emitters, at, next);
        }
    }

    /// Finds out where the camera sees light, and how much of it comes there.
    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &Drifting,
        numbers: &mut Numbers,
        dimensions: Dimensions,
        cancel: &Cancel,
    ) {
        if let Some(end) = &mut self.end {
            end.arrive(at);
        }
        if at.is_single() {
            return;
        }
        let Job { scene, camera, footprint, .. } = self.job;
        let lens = if camera.uses_lens() { numbers.two(dimensions.lens()) } else { [0.5; 2] };
        let Some(seen) = camera.connect(at.position(), lens, path.time) else { return };
        let way = seen.origin - at.position();
        let distance = way.length();
        let direction = way / distance;
        if direction.is_nan() || at.is_hidden_from(direction) {
            return;
        }
        let width = if scene.plan().needs().points.width { footprint.at(distance).width } else { 0.0 };
        let mut light = path.flux() * at.towards(direction, distance, width) * seen.density;
        if light.is_black() || !light.is_finite() {
            return;
        }
        light *= self.weigh(at, path, (direction, distance), seen.density);
        if light.is_black() {
            return;
        }
        let segment = at.leaving(at.origin().segment(&RayOrigin::free(seen.origin)), Ray::NO_TRIANGLE);
        let course = Course { roulette: at.is_in_medium(), ..Course::alone(scene, path.waves()) };
        let light = at_once(course.through(light, segment, at.media(direction), numbers, cancel));
        let light = path.waves().map_or(light, |waves| waves.seen(light));
        if light != Rgb::ZERO && light.is_finite() {
            self.splats.push(Splat { film: seen.film, light });
        }
    }
}
