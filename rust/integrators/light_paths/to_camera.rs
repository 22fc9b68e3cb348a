//! Light that comes to a camera.

use super::adjoint::Arrived;
use super::dimensions::Dimensions;
use super::walk::{Flying, LightWalk, Limits, Visitor};
use crate::integrators::nesting::MediumStack;
use crate::integrators::shadows::Shadows;
use crate::integrators::{Job, LightWorker, Splat};
use crate::math::Ray;
use crate::optics::{Bsdf, Rgb};
use crate::sampling::Sampler;
use crate::scene::{Camera, Emitters, Encounter, Footprint, RayOrigin, Scene};
use crate::workers::Cancel;

/// What one thread follows paths from lights with to where a camera sees them.
pub(in crate::integrators) struct LightPaths<'a> {
    walk: LightWalk<'a>,
    connections: Connections<'a>,
}

/// What a camera sees of paths.
struct Connections<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    footprint: Footprint,
    /// Whether anybody asks how wide the camera's rays are.
    widths: bool,
    /// Whether there is anything that rays may pass, and whether media lie in one another.
    passes: bool,
    nested: bool,
    /// From surfaces to the camera.
    shadows: Shadows,
    /// What these bring, and where to.
    seen: Vec<[f64; 2]>,
    light: Vec<Rgb>,
    splats: Vec<Splat>,
}

impl<'a> LightPaths<'a> {
    pub fn new(job: Job<'a>, emitters: &'a Emitters<'a>, limits: Limits) -> Self {
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
            splats: Vec::new(),
        };
        Self { walk, connections }
    }
}

impl LightWorker for LightPaths<'_> {
    fn follow(&mut self, paths: &mut [Sampler], cancel: &Cancel, splats: &mut Vec<Splat>) {
        self.connections.splats.clear();
        self.walk.follow(paths, cancel, &mut self.connections);
        splats.append(&mut self.connections.splats);
    }
}

impl Visitor for Connections<'_> {
    /// Finds out where the camera sees light that has come to a surface, if nothing lies between.
    fn meet(
        &mut self,
        arrived: &Arrived,
        path: &Flying,
        through: &MediumStack,
        (sampler, dimensions): (&mut Sampler, Dimensions),
    ) {
        let here = &arrived.here;
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
        let light = path.flux * arrived.towards(direction, distance, width) * seen.density;
        if light.is_black() || !light.is_finite() {
            return;
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

    /// Finds out which of them nothing lies between.
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
