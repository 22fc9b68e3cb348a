//! Connections of light paths to the camera.

use super::adjoint::Onward;
use super::dimensions::{Dimensions, EmissionDimensions};
use super::light_ends::LightEnds;
use super::light_walk::{LightPath, LightWalk, Limits, Visitor};
use super::mis_weights::weight;
use super::vertex::Vertex;
use crate::media::medium_traversal::MediumTraversal;
use crate::media::path_numbers::PathNumbers;
use crate::shadows::Shadows;
use crate::{Job, LightWorker, Splat};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, Emitters, RayOrigin};

/// Per-thread state for tracing light paths to a camera.
pub(crate) struct LightPaths<'a> {
    walk: LightWalk<'a>,
    connections: Connections<'a>,
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
struct Connections<'a> {
    job: Job<'a>,
    counting: Counting<'a>,
    /// MIS partials of the paths.
    ends: LightEnds<'a>,
    /// True if every hit of a shadow ray occludes.
    is_plain: bool,
    /// In such scenes, shadow rays to the camera, their image positions, and their contributions.
    shadows: Shadows,
    seen: Vec<[f64; 2]>,
    light: Vec<Rgb>,
    splats: Vec<Splat>,
}

impl<'a> LightPaths<'a> {
    pub fn new(job: Job<'a>, emitters: &'a Emitters<'a>, limits: Limits, counting: Counting<'a>) -> Self {
        let walk = LightWalk::new(job.scene, emitters, limits, Some(job.camera));
        let connections = Connections {
            job,
            counting,
            ends: LightEnds::new(emitters),
            is_plain: Shadows::are_plain(job.scene),
            shadows: Shadows::default(),
            seen: Vec::new(),
            light: Vec::new(),
            splats: Vec::new(),
        };
        Self { walk, connections }
    }
}

impl LightWorker for LightPaths<'_> {
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>) {
        let Connections { job, counting, ends, .. } = &mut self.connections;
        let disk = if let Counting::Beside { disk: Some(disk), .. } = counting { Some(disk) } else { None };
        ends.begin(disk.into_iter().flat_map(|disk| paths.iter().map(|path| disk(path.number()))));
        if job.scene.plan().needs().waves {
            self.walk.set_waves(paths.iter_mut().map(|path| Waves::of(path.one(EmissionDimensions::WAVES))));
        }
        self.walk.follow(paths, cancel, &mut self.connections);
        splats.append(&mut self.connections.splats);
    }
}

impl Connections<'_> {
    fn is_weighted(&self) -> bool {
        matches!(self.counting, Counting::Beside { .. })
    }

    /// Return the weight of a connection to the camera, given the density of camera rays there.
    fn weigh(&self, at: &Vertex, path: &LightPath, (direction, distance): (DVec3, f64), seen: f64) -> f64 {
        match &self.counting {
            Counting::Full => 1.0,
            Counting::Alone(light) => f64::from(u8::from(*light == path.bounce + 1)),
            Counting::Beside { paths, .. } => {
                let comes = seen * at.cosine(direction) / paths;
                let (end, met) = (self.ends.end(path.number), at.met_from(direction, distance));
                weight(end.others(self.ends.emitters(), at, &met, comes), 0.0)
            }
            Counting::Nothing => 0.0,
        }
    }
}

impl<'a> Visitor<'a> for Connections<'a> {
    fn set_out(&mut self, path: &LightPath, light: &EmissionSample) {
        if self.is_weighted() {
            self.ends.set_out(path.number, light);
        }
    }

    fn go_on(&mut self, at: &Vertex<'a>, path: &LightPath, next: &Onward) {
        if self.is_weighted() {
            self.ends.go_on(path.number, at, next);
        }
    }

    /// Connect a vertex to the camera.
    fn meet(
        &mut self,
        at: &Vertex<'a>,
        path: &LightPath,
        numbers: &mut PathNumbers,
        dimensions: Dimensions,
        cancel: &Cancel,
    ) {
        if self.is_weighted() {
            self.ends.arrive(path.number, at);
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
        let see = |light: Rgb| path.waves().map_or(light, |waves| waves.seen(light));
        if self.is_plain {
            self.shadows.push(&segment);
            self.shadows.bring(self.seen.len() as u32, see(light));
            self.seen.push(seen.film);
            return;
        }
        let course = MediumTraversal { roulette: at.is_in_medium(), ..MediumTraversal::alone(scene, path.waves()) };
        let light = see(course.through(light, segment, at.media(direction), numbers, cancel));
        if light != Rgb::ZERO && light.is_finite() {
            self.splats.push(Splat { film: seen.film, light });
        }
    }

    /// Resolve the visibility of the queued connections.
    fn pause(&mut self) {
        if !self.is_plain {
            return;
        }
        self.light.clear();
        self.light.resize(self.seen.len(), Rgb::ZERO);
        self.shadows.add_unblocked(self.job.scene, &mut self.light);
        let splat = |(&film, &light): (&[f64; 2], &Rgb)| Splat { film, light };
        self.splats.extend(self.seen.iter().zip(&self.light).map(splat).filter(|splat| splat.light != Rgb::ZERO));
        self.shadows.clear();
        self.seen.clear();
    }
}
