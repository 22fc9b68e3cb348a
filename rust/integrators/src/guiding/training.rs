//! Training of a guide by paths from the camera.

use super::boundaries::{blocked, is_boundary};
use super::photon::Photon;
use super::photon_tracing::strength;
use super::{Guide, is_matt};
use crate::mis_weight::power_heuristic;
use crate::roulette;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::Sampler;
use raywright_base::simd::Level;
use raywright_base::workers::Cancel;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Camera, Interaction, LightSampleContext, LookupContext, Scene, SurfaceInteraction};

/// Numbers of paths by round.
const ROUNDS: [u32; 4] = [1 << 14, 1 << 13, 1 << 14, 1 << 15];

/// Number of paths per batch.
const TOGETHER: u32 = 2048;

/// Maximum number of surfaces of a path.
const SURFACES: u32 = 10;

/// Number of bounces after which roulette starts.
const ROULETTE: u32 = 3;

/// Index of the surface before the first.
const CAMERA: u32 = u32::MAX;

/// Chain of light from outside the scene.
const OUTSIDE: u64 = u64::MAX;

/// A visit of a path from the camera to a matte surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Visit {
    /// Light that the path found there, as a photon from the next surface. Its flux is an estimate, by the direction
    /// that the path took, of the irradiance that light sampling does not find (by the MIS weight), W/m².
    pub photon: Photon,
    /// Estimate of the direct irradiance, W/m².
    pub direct: f64,
    /// Ratio of radiance at the start of the path to radiance here.
    pub throughput: f64,
}

/// Return a guide that learns from paths from the camera in rounds (Müller, Gross and Novák, "Practical Path Guiding
/// for Efficient Light-Transport Simulation", 2017). Each round is guided by what the round before found, the first
/// round by `guide`. Return `None` without indirect light.
///
/// It depends on the scene and the camera alone.
pub(super) fn train(scene: &Scene, camera: &dyn Camera, guide: Option<&Guide>, cancel: &Cancel) -> Option<Guide> {
    let mut learned: Option<Guide> = None;
    for (round, paths) in (1..).zip(ROUNDS) {
        let level = Level::current().unwrap_or(Level::Scalar);
        let training = Training { scene, camera, guide: learned.as_ref().or(guide), round, level };
        let part = |part| if cancel.is_raised() { Vec::new() } else { training.follow(part) };
        let visits = parallel::map((paths / TOGETHER) as usize, |i| part(i as u32)).concat();
        if cancel.is_raised() {
            return None;
        }
        learned = Guide::of_visits(visits, scene.region().radius).or(learned);
    }
    learned
}

/// A round of training.
struct Training<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    guide: Option<&'a Guide>,
    round: u64,
    level: Level,
}

/// A surface on a path.
struct Vertex {
    /// Index of the surface before it.
    parent: u32,
    is_matt: bool,
    /// True if it is a mere boundary of media.
    is_boundary: bool,
    position: DVec3,
    normal: DVec3,
    shape: u32,
    /// Radiance that leaves the surface back along the path, other than that of `arriving`. Emission has the MIS weight
    /// of sampling the direction.
    radiance: f64,
    /// Direct irradiance.
    direct: f64,
    throughput: f64,
    /// Ratios of the scattered radiance, and of the irradiance, to the radiance that arrives along the next ray.
    scattered: f64,
    irradiance: f64,
    /// Radiance that arrives along the next ray, and from where.
    arriving: f64,
    target: DVec3,
    chain: u64,
}

/// The ray of a path to its next surface.
#[derive(Clone, Copy)]
struct Segment {
    number: u32,
    parent: u32,
    /// Density of the direction, and the normal that lights are sampled by at the start.
    pdf: f64,
    normal: DVec3,
    throughput: f64,
}

/// A sampled direction.
struct Next {
    direction: DVec3,
    /// BSDF times cosine over density, and cosine over density.
    scattered: f64,
    irradiance: f64,
    pdf: f64,
}

impl Training<'_> {
    /// Follow a batch of paths, and return their visits.
    fn follow(&self, part: u32) -> Vec<Visit> {
        let (mut rays, mut segments) = (Vec::new(), Vec::new());
        for number in part * TOGETHER..(part + 1) * TOGETHER {
            let mut sampler = self.sampler(number, 0);
            let ([x, y], lens, time) = (sampler.two(0), sampler.two(1), sampler.one(2));
            let film = [x * f64::from(self.camera.width()), y * f64::from(self.camera.height())];
            let seen = self.camera.ray(film, lens, time);
            if seen.weight > 0.0 {
                rays.push(seen.ray);
                let (pdf, normal) = (f64::INFINITY, DVec3::ZERO);
                segments.push(Segment { number, parent: CAMERA, pdf, normal, throughput: 1.0 });
            }
        }
        let mut surfaces = Vec::new();
        for surface in 0..SURFACES {
            if rays.is_empty() {
                break;
            }
            let met = self.meet(&mut rays, &mut segments, surfaces.last_mut(), surface);
            surfaces.push(met);
        }
        collect(surfaces)
    }

    fn sampler(&self, number: u32, surface: u32) -> Sampler {
        Sampler::new(self.round, number, surface)
    }

    /// Take paths to their next surfaces, which are returned, and scatter them there.
    fn meet(
        &self,
        rays: &mut Vec<Ray>,
        segments: &mut Vec<Segment>,
        mut before: Option<&mut Vec<Vertex>>,
        surface: u32,
    ) -> Vec<Vertex> {
        let (scene, geometry) = (self.scene, self.scene.geometry());
        let mut hits = vec![Hit::MISS; rays.len()];
        scene.intersect(rays, &mut hits);
        let (mut vertices, mut next_rays, mut next_segments) = (Vec::new(), Vec::new(), Vec::new());
        let (mut shadow_rays, mut arriving) = (Vec::new(), Vec::new());
        for ((ray, hit), segment) in rays.iter().zip(&hits).zip(&*segments) {
            if !hit.is_hit() {
                let parent = before.as_mut().and_then(|before| before.get_mut(segment.parent as usize));
                parent.into_iter().for_each(|parent| self.leave(ray, segment, parent));
                continue;
            }
            let here = SurfaceInteraction::at(scene, ray, hit);
            let (index, mut sampler) = (vertices.len() as u32, self.sampler(segment.number, surface + 1));
            let emission = scene.emission_at(here.surface());
            let mut radiance = 0.0;
            if !emission.is_dark() {
                let sent = emission.sent(geometry, ray, hit, here.surface(), LookupContext::default).mean();
                let cosine = -ray.direction.dot(here.surface().normal);
                let receiver = segment.receiver(ray);
                let asked = || scene.lights().surface_pdf(geometry, &receiver, ray, hit, cosine);
                radiance = sent * segment.weight(asked);
            }
            let mut vertex = Vertex {
                parent: segment.parent,
                is_matt: is_matt(here.bsdf()),
                is_boundary: is_boundary(here.bsdf()),
                position: here.ray_origin().ray(here.normal()).origin,
                normal: here.shading_normal(),
                shape: here.surface().shape,
                radiance,
                direct: 0.0,
                throughput: segment.throughput,
                scattered: 0.0,
                irradiance: 0.0,
                arriving: 0.0,
                target: DVec3::ZERO,
                chain: 0,
            };
            if vertex.is_boundary {
                vertex.scattered = 1.0;
                next_rays.push(Ray { time: ray.time, ..here.ray_origin().ray(ray.direction) });
                next_segments.push(Segment { parent: index, ..*segment });
                vertices.push(vertex);
                continue;
            }
            if !here.bsdf().is_delta()
                && let Some((shadow, light)) = self.light(&here, ray.time, &mut sampler)
            {
                shadow_rays.push(shadow);
                arriving.push((index, light));
            }
            if let Some(next) = self.scatter(&here, vertex.is_matt, &mut sampler) {
                let throughput = segment.throughput * next.scattered;
                let survival = if surface < ROULETTE { 1.0 } else { roulette::survival(Rgb::splat(throughput), 1.0) };
                if throughput > 0.0 && sampler.one(6) < survival {
                    (vertex.scattered, vertex.irradiance) = (next.scattered / survival, next.irradiance / survival);
                    let (normal, throughput) = (here.light_context().normal, throughput / survival);
                    next_rays.push(Ray { time: ray.time, ..here.ray_origin().ray(next.direction) });
                    let Segment { number, .. } = *segment;
                    next_segments.push(Segment { number, parent: index, pdf: next.pdf, normal, throughput });
                }
            }
            vertices.push(vertex);
        }
        let blocked = blocked(scene, &shadow_rays);
        for ((index, [radiance, irradiance]), _) in arriving.into_iter().zip(blocked).filter(|(_, is)| !is) {
            let vertex: &mut Vertex = &mut vertices[index as usize];
            vertex.radiance += radiance;
            vertex.direct += irradiance;
        }
        (*rays, *segments) = (next_rays, next_segments);
        vertices
    }

    /// Let light from outside the scene arrive at the last surface.
    fn leave(&self, ray: &Ray, segment: &Segment, parent: &mut Vertex) {
        let lights = self.scene.lights();
        let sent = lights.infinite_radiance_at(ray.direction, None).mean();
        if sent > 0.0 {
            parent.arriving = sent * segment.weight(|| lights.infinite_pdf(&segment.receiver(ray), ray.direction));
            parent.target = ray.origin + ray.direction * (4.0 * self.scene.region().radius);
            parent.chain = OUTSIDE;
        }
    }

    /// Sample a light, and return the shadow ray, the scattered radiance and the irradiance.
    fn light(&self, here: &SurfaceInteraction, time: f64, sampler: &mut Sampler) -> Option<(Ray, [f64; 2])> {
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        let light = lights.sample(geometry, &here.light_context(), sampler.one(0), sampler.two(1))?;
        let (value, _) = here.evaluate(light.direction);
        let irradiance = strength(&light) * light.direction.dot(here.shading_normal()).abs();
        let radiance = (value * light.weight).mean();
        let from = here.ray_origin();
        let ray = light.source.as_ref().map_or_else(|| from.ray(light.direction), |source| from.segment(source));
        (radiance > 0.0 && radiance.is_finite()).then_some((Ray { time, ..ray }, [radiance, irradiance]))
    }

    /// Sample a direction, by the guide or by the BSDF.
    fn scatter(&self, here: &SurfaceInteraction, is_matt: bool, sampler: &mut Sampler) -> Option<Next> {
        let (mut choice, u) = (sampler.one(3), sampler.two(4));
        let local = self.guide.filter(|_| is_matt).and_then(|guide| guide.at(here.position()));
        let share = local.map_or(0.0, |local| local.share());
        let density = |pdf: f64, direction| match &local {
            Some(local) => pdf + share * (local.pdf(self.level, direction) - pdf),
            None => pdf,
        };
        let cosine = |direction: DVec3| direction.dot(here.shading_normal()).abs();
        if let Some(local) = local.filter(|_| choice < share) {
            let direction = local.sample(choice / share, u);
            let (value, pdf) = here.evaluate(direction);
            let both = density(pdf, direction);
            let (scattered, irradiance) = (value.mean() / both, cosine(direction) / both);
            return (pdf > 0.0).then_some(Next { direction, scattered, irradiance, pdf: both });
        }
        choice = ((choice - share) / (1.0 - share)).min(1f64.next_down());
        let next = here.sample(&mut || choice, u)?;
        if next.is_delta() {
            let (scattered, irradiance) = (next.weight.mean(), 0.0);
            return Some(Next { direction: next.wi, scattered, irradiance, pdf: next.pdf });
        }
        let both = density(next.pdf, next.wi);
        let (scattered, irradiance) = (next.weight.mean() * next.pdf / both, cosine(next.wi) / both);
        Some(Next { direction: next.wi, scattered, irradiance, pdf: both })
    }
}

impl Segment {
    fn receiver(&self, ray: &Ray) -> LightSampleContext {
        LightSampleContext { position: ray.origin, normal: self.normal, waves: None }
    }

    /// Return the MIS weight of light along the ray, given the density of light sampling.
    fn weight(&self, asked: impl FnOnce() -> f64) -> f64 {
        if self.pdf == f64::INFINITY { 1.0 } else { power_heuristic(self.pdf, asked()) }
    }
}

/// Carry light back along the paths to the camera, and return the visits to matte surfaces.
fn collect(mut surfaces: Vec<Vec<Vertex>>) -> Vec<Visit> {
    let mut visits = Vec::new();
    while let Some(last) = surfaces.pop() {
        let mut before = surfaces.last_mut();
        for vertex in last {
            if let Some(parent) = before.as_mut().and_then(|before| before.get_mut(vertex.parent as usize)) {
                parent.arriving = vertex.radiance + vertex.scattered * vertex.arriving;
                (parent.target, parent.chain) = match vertex.is_boundary {
                    true => (vertex.target, vertex.chain),
                    false => (vertex.position, vertex.shape.into()),
                };
            }
            if vertex.is_matt {
                let Vertex { position, normal, target, chain, direct, throughput, .. } = vertex;
                let flux = vertex.arriving * vertex.irradiance;
                let flux = if flux.is_finite() { flux } else { 0.0 };
                visits.push(Visit { photon: Photon { position, normal, target, flux, chain }, direct, throughput });
            }
        }
    }
    visits
}
