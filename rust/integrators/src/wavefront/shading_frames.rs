//! Shading frames of sixteen surfaces.

use raywright_base::math::{DVec3, Frame, Hit, LANES, PathRays, Ray, SingleLanes, VectorLanes};
use raywright_base::simd::{Level, loops};
use raywright_optics::{Bsdf, Diffuse, Null, Rgb};
use raywright_scene::{
    Geometry, SurfaceBlock, SurfaceInteraction, SurfaceInteractionLanes, SurfaceLanes, SurfacePoint,
};

/// Frames of surfaces, a lane each.
pub(super) struct ShadingFrames {
    /// In scenes whose shading normals may differ from those of their surfaces, or whose materials vary, what there is
    /// to know of each interaction; otherwise the surfaces suffice.
    interactions: Option<Box<Interactions>>,
    /// Directions back along the rays, in the frames.
    pub wo: VectorLanes,
}

struct Interactions {
    rays: [Ray; LANES],
    hits: [Hit; LANES],
    surfaces: SurfaceLanes,
    lanes: SurfaceInteractionLanes,
}

/// The frame of a surface without shading normals, with z on the side of its own normal.
#[inline(always)]
fn frame(surfaces: &SurfaceBlock, lane: usize) -> Frame {
    let normal = surfaces.normal.get(lane).as_dvec3() * if surfaces.is_front[lane] == 0 { -1.0 } else { 1.0 };
    Frame::new(unit(normal))
}

/// A vector of length 1 in f32, of length 1 in f64.
#[inline(always)]
fn unit(v: DVec3) -> DVec3 {
    v * (1.5 - 0.5 * v.length_squared())
}

loops! {
    /// The directions back along rays.
    fn turn_back(surfaces: &SurfaceBlock, wo: &mut VectorLanes) {
        for i in 0..LANES {
            wo.set(i, frame(surfaces, i).to_local(unit(-surfaces.direction.get(i).as_dvec3())));
        }
    }
}

loops! {
    /// Directions in the frames of surfaces.
    fn turn(surfaces: &SurfaceBlock, direction: &SingleLanes, wi: &mut VectorLanes) {
        for i in 0..LANES {
            wi.set(i, frame(surfaces, i).to_local(unit(direction.get(i).as_dvec3())));
        }
    }
}

loops! {
    /// Directions of the frames of surfaces in the world.
    fn turn_out(surfaces: &SurfaceBlock, wi: &VectorLanes, direction: &mut SingleLanes) {
        for i in 0..LANES {
            direction.set(i, frame(surfaces, i).to_world(wi.get(i)).as_vec3());
        }
    }
}

loops! {
    /// Interactions of rays with surfaces.
    fn interact(directions: &SingleLanes, lanes: &mut SurfaceInteractionLanes) {
        for i in 0..LANES {
            let surface = lanes.surface(i);
            let ray = Ray::new(surface.position, unit(directions.get(i).as_dvec3()));
            let normal = (surface.shading_normal, None);
            lanes.set(i, &SurfaceInteraction::with(&ray, surface, normal, Diffuse { reflectance: Rgb::ZERO }));
        }
    }
}

loops! {
    /// Directions in the frames of interactions, and how much light from there counts: 0 below a horizon.
    fn see(
        lanes: &SurfaceInteractionLanes,
        direction: &SingleLanes,
        wi: &mut VectorLanes,
        counts: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (local, fading) = lanes.faded(i, Null).seen_from(unit(direction.get(i).as_dvec3()));
            wi.set(i, local);
            counts[i] = fading;
        }
    }
}

loops! {
    /// Directions of the frames of interactions in the world, and how much light along them counts.
    fn go(
        lanes: &SurfaceInteractionLanes,
        wi: &VectorLanes,
        pdf: &[f64; LANES],
        direction: &mut SingleLanes,
        counts: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (world, fading) = lanes.faded(i, Null).goes_to(wi.get(i), pdf[i] == f64::INFINITY);
            direction.set(i, world.as_vec3());
            counts[i] = fading;
        }
    }
}

impl Interactions {
    /// Those of shading normals that are used as given, which loops over lanes do not know.
    fn as_given(&self) -> impl Iterator<Item = (usize, SurfaceInteraction<Null>)> {
        (0..LANES).filter(|&lane| self.lanes.is_as_given(lane)).map(|lane| (lane, self.lanes.get(lane, Null)))
    }
}

impl ShadingFrames {
    /// Of surfaces without shading normals, or of any.
    pub fn new(are_flat: bool) -> Self {
        let surfaces = SurfaceLanes::NONE;
        let lanes = SurfaceInteractionLanes::at(&surfaces);
        let rays = [Ray::new(DVec3::ZERO, DVec3::Z); LANES];
        let any = || Box::new(Interactions { rays, hits: [Hit::MISS; LANES], surfaces, lanes });
        Self { interactions: (!are_flat).then(any), wo: VectorLanes::ZERO }
    }

    /// Sets the frames of surfaces that rays have met.
    pub fn meet(&mut self, level: Level, geometry: &Geometry, met: (&PathRays, &[Hit]), surfaces: &SurfaceBlock) {
        let Some(all) = &mut self.interactions else { return turn_back(level, surfaces, &mut self.wo) };
        for lane in 0..LANES {
            (all.rays[lane], all.hits[lane]) = geometry.hit_of_lane(met, surfaces, lane);
        }
        geometry.surface_lanes(level, &all.rays, &all.hits, &mut all.surfaces);
        all.lanes.set_surfaces(&all.surfaces);
        interact(level, &surfaces.direction, &mut all.lanes);
        self.wo = *all.lanes.wo_lanes();
    }

    /// Replaces the interaction of a lane by one that a function makes of its ray and hit, if it makes one.
    pub fn replace<B: Bsdf>(
        &mut self,
        lane: usize,
        make: impl FnOnce(&Ray, &Hit, SurfacePoint) -> SurfaceInteraction<B>,
    ) -> Option<B> {
        let all = self.interactions.as_mut()?;
        let here = make(&all.rays[lane], &all.hits[lane], all.surfaces.get(lane));
        all.lanes.set(lane, &here);
        self.wo.set(lane, here.wo());
        Some(here.into_bsdf())
    }

    /// The interaction of a lane by a BSDF, with its ray and hit, where more is known than of its block.
    pub fn interaction<B: Bsdf>(&self, lane: usize, bsdf: B) -> Option<(&Ray, &Hit, SurfaceInteraction<B>)> {
        self.interactions.as_ref().map(|all| (&all.rays[lane], &all.hits[lane], all.lanes.get(lane, bsdf)))
    }

    /// The surface of a lane, where more is known than of its block.
    pub fn surface(&self, lane: usize) -> Option<SurfacePoint> {
        self.interactions.as_ref().map(|all| all.surfaces.get(lane))
    }

    /// The shading normal of a lane on the side that its ray came from, and whether that was bent towards the ray.
    pub fn normal(&self, surfaces: &SurfaceBlock, lane: usize) -> (DVec3, bool) {
        match &self.interactions {
            Some(all) => {
                let here = all.lanes.faded(lane, Null);
                (here.shading_normal(), here.is_bent())
            }
            None => (surfaces.normal.get(lane).as_dvec3(), false),
        }
    }

    /// Return whether shading and geometric normal of a lane are equal.
    pub fn is_flat(&self, lane: usize) -> bool {
        self.interactions.as_ref().is_none_or(|all| all.lanes.get(lane, Null).is_flat())
    }

    /// Mean curvature of a lane, where widths of rays are known.
    pub fn curvature(&self, lane: usize) -> f64 {
        self.interactions.as_ref().map_or(0.0, |all| all.lanes.curvature(lane))
    }

    /// Directions to lights in the frames, and how much light from there counts: 0 below a horizon.
    pub fn look(
        &self,
        level: Level,
        surfaces: &SurfaceBlock,
        direction: &SingleLanes,
        wi: &mut VectorLanes,
        counts: &mut [f64; LANES],
    ) {
        match &self.interactions {
            Some(all) => {
                see(level, &all.lanes, direction, wi, counts);
                for (lane, here) in all.as_given() {
                    counts[lane] = here.seen_from(unit(direction.get(lane).as_dvec3())).1;
                }
            }
            None => {
                turn(level, surfaces, direction, wi);
                *counts = [1.0; LANES];
            }
        }
    }

    /// Directions drawn in the frames, in the world, and how much light along them counts.
    pub fn leave(
        &self,
        level: Level,
        surfaces: &SurfaceBlock,
        (wi, pdf): (&VectorLanes, &[f64; LANES]),
        direction: &mut SingleLanes,
        counts: &mut [f64; LANES],
    ) {
        match &self.interactions {
            Some(all) => {
                go(level, &all.lanes, wi, pdf, direction, counts);
                for (lane, here) in all.as_given() {
                    counts[lane] = here.goes_to(wi.get(lane), pdf[lane] == f64::INFINITY).1;
                }
            }
            None => {
                turn_out(level, surfaces, wi, direction);
                *counts = [1.0; LANES];
            }
        }
    }

    /// A direction of the frame of a lane in the world.
    pub fn to_world(&self, surfaces: &SurfaceBlock, lane: usize, wi: DVec3) -> DVec3 {
        match &self.interactions {
            Some(all) => all.lanes.get(lane, Null).goes_to(wi, false).0,
            None => frame(surfaces, lane).to_world(wi),
        }
    }

    /// A direction in the frame of a lane, and how much light from there counts.
    pub fn to_local(&self, surfaces: &SurfaceBlock, lane: usize, direction: DVec3) -> (DVec3, f64) {
        match &self.interactions {
            Some(all) => all.lanes.get(lane, Null).seen_from(direction),
            None => (frame(surfaces, lane).to_local(direction), 1.0),
        }
    }
}
