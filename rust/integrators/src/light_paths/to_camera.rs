//! Connections of light paths to the camera.

use super::light_ends::LightEnds;
use super::mis_weights::weight;
use crate::dimensions::EmissionDimensions;
use crate::path_vertices::Onward;
use crate::wavefront::{
    Arrival, Connection, Limits, Subpath, SubpathEmission, SubpathSink, SubpathWavefront, Times, VertexContext,
};
use crate::{Job, LightWorker, Splat};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, RayOrigin};
use std::f64::consts::FRAC_1_PI;

/// Per-thread state for tracing light paths to a camera.
pub(crate) struct LightPaths<'a> {
    wavefront: SubpathWavefront<'a>,
    connections: CameraConnections<'a>,
}

/// Weighting of camera connections.
pub(crate) enum Counting<'a> {
    /// Unweighted.
    Full,
    /// MIS with the other strategies.
    Beside {
        /// Number of light paths per sample of the whole picture.
        paths: f64,
        /// Merging disk for a sample index, if vertices are merged ([`super::Partial::merging`]).
        disk: Option<Box<dyn Fn(u32) -> f64 + Send + 'a>>,
    },
    /// Only paths with a number of light vertices, unweighted; the camera is the only other vertex.
    Alone(u32),
    /// None.
    Nothing,
}

/// Camera connections of a batch.
struct CameraConnections<'a> {
    job: Job<'a>,
    counting: Counting<'a>,
    /// MIS partials of the paths.
    ends: LightEnds<'a>,
    /// Wavelengths of the paths; empty for RGB.
    waves: Vec<Waves>,
    splats: Vec<Splat>,
}

impl<'a> LightPaths<'a> {
    pub fn new(job: Job<'a>, emitters: &'a Emitters<'a>, limits: Limits, counting: Counting<'a>) -> Self {
        let wavefront = SubpathWavefront::of_lights(job.scene, limits);
        let connections =
            CameraConnections { job, counting, ends: LightEnds::new(emitters), waves: Vec::new(), splats: Vec::new() };
        Self { wavefront, connections }
    }
}

impl LightWorker for LightPaths<'_> {
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>) {
        let CameraConnections { job, counting, ends, .. } = &mut self.connections;
        let disk = if let Counting::Beside { disk: Some(disk), .. } = counting { Some(disk) } else { None };
        ends.begin(disk.into_iter().flat_map(|disk| paths.iter().map(|path| disk(path.number()))));
        if job.scene.plan().needs().waves {
            let waves = &mut self.connections.waves;
            waves.clear();
            waves.extend(paths.iter_mut().map(|path| Waves::of(path.one(EmissionDimensions::WAVES))));
            self.wavefront.set_waves(waves.iter().copied());
        }
        let (emitters, camera) = (self.connections.ends.emitters(), Some(self.connections.job.camera));
        let emission = SubpathEmission { emitters, camera, times: &Times::Drawn };
        self.wavefront.follow_light(paths, &emission, cancel, &mut self.connections);
        splats.append(&mut self.connections.splats);
    }
}

impl CameraConnections<'_> {
    fn is_weighted(&self) -> bool {
        matches!(self.counting, Counting::Beside { .. })
    }

    /// Return the weight of a connection to the camera, given the density of camera rays there.
    fn weigh(&self, at: &Arrival, path: &Subpath, (direction, distance): (DVec3, f64), seen: f64) -> f64 {
        match &self.counting {
            Counting::Full => 1.0,
            Counting::Alone(light) => f64::from(u8::from(*light == path.bounce + 1)),
            Counting::Beside { paths, .. } => {
                let at = at.vertex();
                let comes = seen * at.cosine(direction) / paths;
                let (end, met) = (self.ends.end(path.number), at.met_from(direction, distance));
                weight(end.others(self.ends.emitters(), at, &met, comes), 0.0)
            }
            Counting::Nothing => 0.0,
        }
    }
}

impl<'a> SubpathSink<'a> for CameraConnections<'a> {
    fn set_out(&mut self, path: &Subpath, light: &EmissionSample) {
        if self.is_weighted() {
            self.ends.set_out(path.number, light);
        }
    }

    fn go_on(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, next: &Onward) {
        if self.is_weighted() {
            self.ends.go_on(path.number, at.vertex(), next);
        }
    }

    /// Connect a vertex to the camera.
    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, context: &mut VertexContext<'_>) {
        if self.is_weighted() {
            self.ends.arrive(path.number, at.vertex());
        }
        if at.diffuse.is_none() && at.vertex().is_single() {
            return;
        }
        let Job { scene, camera, footprint, .. } = self.job;
        let lens = if camera.uses_lens() { context.two(context.dimensions.lens()) } else { [0.5; 2] };
        let position = at.origin.position();
        let Some(seen) = camera.connect(position, lens, path.time) else { return };
        let way = seen.origin - position;
        let distance = way.length();
        let direction = way / distance;
        if direction.is_nan() {
            return;
        }
        let width = if scene.plan().needs().points.width { footprint.at(distance).width } else { 0.0 };
        let share = match at.diffuse.filter(|_| width == 0.0) {
            Some(reflectance) => reflectance * (FRAC_1_PI * direction.dot(at.normal).max(0.0)),
            None if at.vertex().is_hidden_from(direction) => return,
            None => at.vertex().towards(direction, distance, width),
        };
        let light = path.beta * share * seen.density;
        if light.is_black() || !light.is_finite() {
            return;
        }
        let light = light * self.weigh(at, path, (direction, distance), seen.density);
        let segment = at.leaving(at.origin.segment(&RayOrigin::free(seen.origin)), Ray::NO_TRIANGLE);
        context.connect(at, &segment, light, seen.film);
    }

    fn receive(&mut self, connection: &Connection, light: Rgb) {
        let light = self.waves.get(connection.sample as usize).map_or(light, |waves| waves.seen(light));
        self.splats.push(Splat { film: connection.film, light });
    }
}
