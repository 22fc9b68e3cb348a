//! Connections of light paths to the camera.

use super::adjoint::{Arrived, Onward};
use super::dimensions::{Dimensions, EmissionDimensions};
use super::light_walk::{Flying, LightWalk, Limits, Visitor};
use super::mis_weights::weight;
use super::partials::Partials;
use crate::nesting::MediumStack;
use crate::shadows::Shadows;
use crate::{Job, LightWorker, Splat};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Camera, EmissionSample, Emitters, Footprint, Interaction, RayOrigin, Scene};

/// Per-thread state for tracing light paths to a camera.
pub(crate) struct LightPaths<'a> {
    walk: LightWalk<'a>,
    connections: Connections<'a>,
}

/// MIS weighting of these connections.
pub(crate) struct Weighing<'a> {
    pub partials: Partials<'a>,
    /// Merging disk for a sample index, if vertices are merged ([`super::Partial::merging`]).
    pub disks: Option<Box<dyn Fn(u32) -> f64 + Send + 'a>>,
    /// Number of light paths per sample of the whole picture.
    pub paths: f64,
    /// The one strategy to show, unweighted: its vertex counts on the light's and the camera's side.
    pub alone: Option<[u32; 2]>,
}

/// Camera connections of a batch.
struct Connections<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    footprint: Footprint,
    /// True if materials need ray widths.
    widths: bool,
    /// True if the scene has masks; if media are nested.
    passes: bool,
    nested: bool,
    /// Shadow rays from surfaces to the camera.
    shadows: Shadows,
    /// Their image positions, and their contributions if unoccluded.
    seen: Vec<[f64; 2]>,
    light: Vec<Rgb>,
    /// `None` if all contributions have the weight 1.
    weighing: Option<Weighing<'a>>,
    splats: Vec<Splat>,
}

impl<'a> LightPaths<'a> {
    pub fn new(job: Job<'a>, emitters: &'a Emitters<'a>, limits: Limits, weighing: Option<Weighing<'a>>) -> Self {
        let Job { scene, camera, footprint, .. } = job;
        let walk = LightWalk::new(scene, emitters, limits, Some(camera));
        let connections = Connections {
            scene,
            camera,
            footprint,
            widths: scene.plan().needs().points.width,
            passes: walk.passes(),
            nested: walk.is_nested(),
            shadows: Shadows::default(),
            seen: Vec::new(),
            light: Vec::new(),
            weighing,
            splats: Vec::new(),
        };
        Self { walk, connections }
    }
}

impl LightWorker for LightPaths<'_> {
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>) {
        self.connections.splats.clear();
        if let Some(weighing) = &mut self.connections.weighing {
            let disks = weighing.disks.as_ref().map(|disk| paths.iter().map(|path| disk(path.number())));
            weighing.partials.begin(disks.into_iter().flatten());
        }
        if self.connections.scene.plan().needs().waves {
            self.walk.set_waves(paths.iter_mut().map(|path| Waves::of(path.one(EmissionDimensions::WAVES))));
        }
        self.walk.follow(paths, cancel, &mut self.connections);
        splats.append(&mut self.connections.splats);
    }
}

impl Weighing<'_> {
    /// Return the MIS weight of a connection to the camera in a direction at a distance.
    fn weigh(&mut self, arrived: &Arrived, path: &Flying, (direction, distance): (DVec3, f64), seen: f64) -> f64 {
        if let Some([light, camera]) = self.alone {
            return if camera == 1 && light == path.bounce + 1 { 1.0 } else { 0.0 };
        }
        let comes = seen * arrived.cosine(direction) / self.paths;
        let met = arrived.met_from(direction, distance, 0.0);
        let emitters = self.partials.emitters();
        weight(self.partials.end(path).others(emitters, arrived, &met, comes), 0.0)
    }
}

impl<'a> Visitor<'a> for Connections<'a> {
    fn set_out(&mut self, path: &Flying, light: &EmissionSample) {
        if let Some(weighing) = &mut self.weighing {
            weighing.partials.set_out(path, light);
        }
    }

    fn go_on(&mut self, arrived: &Arrived<'a>, path: &Flying, next: &Onward) {
        if let Some(weighing) = &mut self.weighing {
            weighing.partials.go_on(path, arrived, next);
        }
    }

    /// Connect a surface vertex to the camera, pending visibility.
    fn meet(
        &mut self,
        arrived: &Arrived<'a>,
        path: &Flying,
        through: &MediumStack,
        (sampler, dimensions): (&mut Sampler, Dimensions),
    ) {
        let here = &arrived.here;
        if let Some(weighing) = &mut self.weighing {
            weighing.partials.arrive(path, arrived);
        }
        if here.bsdf().is_delta() {
            return;
        }
        let lens = if self.camera.uses_lens() { sampler.two(dimensions.lens()) } else { [0.5; 2] };
        let Some(seen) = self.camera.connect(here.position(), lens, path.time) else { return };
        let way = seen.origin - here.position();
        let distance = way.length();
        let direction = way / distance;
        if direction.is_nan() || here.is_through(direction) && !here.bsdf().transmits() {
            return;
        }
        let width = if self.widths { self.footprint.at(distance).width } else { 0.0 };
        let mut light = path.flux * arrived.towards(direction, distance, width) * seen.density;
        if light.is_black() || !light.is_finite() {
            return;
        }
        if let Some(weighing) = &mut self.weighing {
            light *= weighing.weigh(arrived, path, (direction, distance), seen.density);
        }
        if let Some(waves) = &arrived.waves {
            light = waves.seen(light);
        }
        let segment = here.ray_origin().segment(&RayOrigin::free(seen.origin));
        let misses = [arrived.hit.primitive, Ray::NO_TRIANGLE];
        self.shadows.push(&Ray { time: arrived.ray.time, misses, ..segment });
        self.shadows.bring(self.seen.len() as u32, light);
        if self.nested {
            self.shadows.start_in(if here.is_through(direction) { *through } else { path.media });
        }
        self.seen.push(seen.film);
    }

    /// Resolve the visibility of the queued connections.
    fn pause(&mut self) {
        self.light.clear();
        self.light.resize(self.seen.len(), Rgb::ZERO);
        if self.passes {
            self.shadows.add_through(self.scene, self.nested, &mut self.light);
        } else {
            self.shadows.add_unblocked(self.scene, &mut self.light);
        }
        let splat = |(&film, &light): (&[f64; 2], &Rgb)| Splat { film, light };
        self.splats.extend(self.seen.iter().zip(&self.light).map(splat).filter(|splat| !splat.light.is_black()));
        self.shadows.clear();
        self.seen.clear();
    }
}
