//! Camera subpaths: their MIS partials, emission that they hit, and their connections and merges.

use super::camera_end::CameraEnd;
use super::light_vertices::LightVertices;
use super::vertex_merging::{MergeMap, Merging};
use super::{Bidirection, PathStrategy};
use crate::path_vertices::{Arrived, Onward, Point, Vertex};
use crate::wavefront::{Arrival, Connection, Limits, Subpath, SubpathSink, VertexContext};
use crate::{CameraSample, Job};
use raywright_base::math::Ray;
use raywright_optics::Rgb;
use raywright_scene::{Emitters, LightSampleContext, LookupContext};
use std::sync::Arc;

/// The sink of camera subpaths.
pub(super) struct CameraSubpaths<'a> {
    pub(super) job: Job<'a>,
    pub(super) emitters: Option<&'a Emitters<'a>>,
    limits: Limits,
    pub(super) alone: Option<PathStrategy>,
    /// Number of light subpaths per camera sample of the whole picture.
    paths: f64,
    /// True if samples are spread over time.
    moves: bool,
    /// Vertices of light subpaths, if there are any.
    pub(super) vertices: Option<LightVertices<'a>>,
    /// Vertex merging if enabled, and the maps of the current samples.
    merging: Option<&'a Merging<'a>>,
    maps: Vec<(u32, Arc<MergeMap>)>,
    ends: Vec<CameraEnd>,
    pub(super) radiance: Vec<Rgb>,
}

impl<'a> CameraSubpaths<'a> {
    pub fn new(shared: &'a Bidirection<'a>, vertices: Option<LightVertices<'a>>) -> Self {
        let Bidirection { job, limits, alone, .. } = *shared;
        let (scene, camera) = (job.scene, job.camera);
        Self {
            job,
            emitters: shared.emitters.as_ref(),
            limits,
            alone,
            paths: f64::from(camera.width()) * f64::from(camera.height()),
            moves: scene.geometry().moves() || camera.uses_time(),
            vertices,
            merging: shared.merging.as_ref(),
            maps: Vec::new(),
            ends: Vec::new(),
            radiance: Vec::new(),
        }
    }

    /// Begin with the subpaths of some samples, and look up their maps.
    pub fn begin(&mut self, samples: &[CameraSample]) {
        self.radiance.clear();
        self.radiance.resize(samples.len(), Rgb::ZERO);
        self.maps.clear();
        self.ends.clear();
        for sample in samples {
            let number = sample.sampler.number();
            let disk = self.merging.map_or(0.0, |merging| merging.disk(number));
            self.ends.push(CameraEnd::new(sample.ray.origin, disk));
            if let Some(merging) = self.merging
                && !self.maps.iter().any(|(other, _)| *other == number)
            {
                self.maps.extend(merging.map(number).map(|map| (number, map)));
            }
        }
    }

    /// Return the light merged at a vertex.
    fn merge(&self, at: &Vertex, path: &Subpath, context: &VertexContext, most: Option<u32>) -> Rgb {
        let (Some(merging), Some(arrived)) = (self.merging, at.matte()) else { return Rgb::ZERO };
        let number = context.sampler().map_or(0, |sampler| sampler.number());
        let Some((_, map)) = self.maps.iter().find(|(other, _)| *other == number) else { return Rgb::ZERO };
        let alone = match self.alone {
            None => None,
            // The merged vertex belongs to both subpaths. The light and this surface are not bounces of the photon.
            Some(PathStrategy { vertices: [light, camera], merges: true })
                if camera == path.bounce + 2 && light > 2 =>
            {
                Some(light - 2)
            }
            Some(_) => return Rgb::ZERO,
        };
        path.beta * merging.found(map, (at, arrived), (path, self.end(path)), most, alone)
    }

    /// Return the MIS state of a subpath.
    pub fn end(&self, path: &Subpath) -> &CameraEnd {
        &self.ends[path.number as usize]
    }

    /// Return the density of camera rays at the first vertex, per area perpendicular to them, in pixels.
    fn seen(&self, at: &Vertex, context: &VertexContext) -> f64 {
        let camera = self.job.camera;
        let lens = if camera.uses_lens() { context.two(1) } else { [0.5; 2] };
        let time = if self.moves { context.one(3) } else { 0.0 };
        camera.connect(at.position(), lens, time).map_or(0.0, |seen| seen.density)
    }

    /// Return the weighted emission of a surface that a subpath hits.
    fn emitted(&self, arrived: &Arrived, path: &Subpath, width: f64) -> Rgb {
        let (scene, Arrived { ray, hit, .. }) = (self.job.scene, arrived);
        let (geometry, surface) = (scene.geometry(), arrived.here.surface());
        let emission = scene.emission_at(surface);
        if emission.is_dark() {
            return Rgb::ZERO;
        }
        let sent = emission.sent(geometry, ray, hit, surface, || LookupContext { width, waves: path.waves });
        if sent.is_black() || path.bounce == 0 && self.alone.is_none() {
            return sent;
        }
        sent * match (self.alone, self.emitters.and_then(|emitters| emitters.of_hit(ray, hit, surface))) {
            (Some(_), _) => self.full(0, path.bounce + 2),
            (None, Some(departure)) => {
                let (end, cosine) = (self.end(path), -ray.direction.dot(surface.normal));
                let receiver = LightSampleContext { waves: path.waves, ..end.receiver };
                let asked = scene.lights().surface_pdf(geometry, &receiver, ray, hit, cosine);
                end.partial.of_found(asked, &departure)
            }
            (None, None) => 1.0,
        }
    }
}

impl<'a> SubpathSink<'a> for CameraSubpaths<'a> {
    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, context: &mut VertexContext<'_>) {
        let (number, vertex) = (path.number as usize, at.vertex());
        if let Point::Surface { arrived, .. } = &vertex.point {
            let emitted = path.arriving * self.emitted(arrived, path, at.width);
            self.radiance[number] += emitted;
        }
        if self.limits.max_depth.is_some_and(|most| path.bounce >= most) {
            return;
        }
        let first = (path.bounce == 0).then(|| (self.paths, self.seen(vertex, context)));
        self.ends[number].arrive(vertex, first);
        let Some(emitters) = self.emitters.filter(|_| !vertex.is_single()) else { return };
        self.ask(emitters, at, path, context);
        let most = self.limits.max_depth.map(|depth| depth - path.bounce - 1);
        for light in self.vertices.iter().flat_map(|light| light.of(path.number)) {
            if most.is_none_or(|most| light.bounce <= most) {
                self.connect(emitters, at, path, light, context);
            }
        }
        let merged = self.merge(vertex, path, context, most);
        self.radiance[number] += merged;
    }

    fn go_on(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, next: &Onward) {
        self.ends[path.number as usize].go_on(at.vertex(), next);
    }

    /// Add the weighted light of infinite lights.
    fn leave(&mut self, path: &Subpath, ray: &Ray) {
        let (lights, direction) = (self.job.scene.lights(), ray.direction.normalize());
        let arriving = lights.infinite_radiance_at(direction, path.waves.as_ref());
        if arriving.is_black() {
            return;
        }
        let weight = match (self.alone, self.emitters) {
            (None, _) if path.bounce == 0 => 1.0,
            (Some(_), _) => self.full(0, path.bounce + 2),
            (None, Some(emitters)) => {
                let end = self.end(path);
                let receiver = LightSampleContext { waves: path.waves, ..end.receiver };
                let asked = lights.infinite_pdf(&receiver, direction);
                end.partial.of_found(asked, &emitters.of_environment(direction))
            }
            (None, None) => 1.0,
        };
        self.radiance[path.number as usize] += path.beta * arriving * weight;
    }

    fn glow(&mut self, sample: u32, light: Rgb) {
        self.radiance[sample as usize] += light;
    }

    fn receive(&mut self, connection: &Connection, light: Rgb) {
        self.radiance[connection.sample as usize] += light;
    }
}
