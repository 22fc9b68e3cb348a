//! Connections of light paths in media to the camera.

use super::light_partials::LightEnd;
use super::light_walk::{Drifting, MediaLightWalk, MediaVisitor};
use super::medium_traversal::MediumTraversal;
use super::vertex::Vertex;
use crate::light_paths::{Dimensions, EmissionDimensions, Limits, Onward, weight};
use crate::media::path_numbers::PathNumbers;
use crate::{Job, LightWorker, Splat};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, RayOrigin};

/// Per-thread state for tracing light paths to a camera.
pub(crate) struct MediaLightPaths<'a> {
    walk: MediaLightWalk<'a>,
    connections: Connections<'a>,
}

/// Weighting of camera connections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Counting {
    /// Unweighted.
    Full,
    /// MIS with the other strategies, for a number of light paths per sample of the whole picture.
    Beside(f64),
    /// Only paths with a number of light vertices, unweighted; the camera is the only other vertex.
    Alone(u32),
    /// None.
    Nothing,
}

/// Camera connections.
struct Connections<'a> {
    job: Job<'a>,
    emitters: &'a Emitters<'a>,
    counting: Counting,
    /// MIS partials of the current path.
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
    /// Return the weight of a connection to the camera, given the density of camera rays there.
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

    /// Connect a vertex to the camera and attenuate the light on the segment.
    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &Drifting,
        numbers: &mut PathNumbers,
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
        let course = MediumTraversal { roulette: at.is_in_medium(), ..MediumTraversal::alone(scene, path.waves()) };
        let light = course.through(light, segment, at.media(direction), numbers, cancel);
        let light = path.waves().map_or(light, |waves| waves.seen(light));
        if light != Rgb::ZERO && light.is_finite() {
            self.splats.push(Splat { film: seen.film, light });
        }
    }
}
