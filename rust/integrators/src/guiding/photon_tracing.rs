//! Tracing of guiding photons: through specular surfaces to matte ones.

use super::boundaries::{blocked, is_boundary};
use super::is_matt;
use super::photon::Photon;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::{AliasTable, Sampler, warp};
use raywright_base::workers::Cancel;
use raywright_optics::{AnyBsdf, Bsdf, BsdfSample};
use raywright_scene::{Geometry, Interaction, LightSample, LightSampleContext, RayOrigin, Scene, SurfaceInteraction};

/// Number of photons.
const SENT: u32 = 1 << 16;

/// Number of photons per batch.
const TOGETHER: u32 = 2048;

/// Maximum number of surfaces of a photon's path.
const SURFACES: u32 = 12;

/// Maximum number of matte bounces.
const MATT: u32 = 2;

/// Minimum density per solid angle of a specular direction: matte surfaces have at most 1/π.
const SHARP: f64 = 4.0;

/// Return the photons that reach matte surfaces through specular ones, in an order that depends on the scene alone.
/// Return `None` if canceled.
pub(super) fn photons(scene: &Scene, cancel: &Cancel) -> Option<Vec<Photon>> {
    if scene.lights().is_dark() {
        return Some(Vec::new());
    }
    let Some(targets) = Targets::new(scene) else { return Some(Vec::new()) };
    let part = |part| (!cancel.is_raised()).then(|| FlyingPhotons::new(scene, &targets, part).follow(scene));
    let parts = parallel::map((SENT / TOGETHER) as usize, |i| part(i as u32));
    let parts: Option<Vec<Vec<Photon>>> = parts.into_iter().collect();
    parts.map(|parts| parts.concat())
}

/// Return the mean direct irradiance at the photons.
pub(super) fn usual(scene: &Scene, photons: &[Photon]) -> f64 {
    /// Number of photons in the mean.
    const ASKED: usize = 4096;
    let (mut rays, mut arriving, mut asked) = (Vec::new(), Vec::new(), 0.0);
    for (number, photon) in (0..).zip(photons.iter().step_by(photons.len().div_ceil(ASKED).max(1))) {
        asked += 1.0;
        let mut sampler = Sampler::new(1, number, 0);
        let (receiver, choice) =
            (LightSampleContext { position: photon.position, normal: photon.normal, waves: None }, sampler.one(0));
        let Some(light) = scene.lights().sample(scene.geometry(), &receiver, choice, sampler.two(1)) else { continue };
        let brings = strength(&light) * light.direction.dot(photon.normal);
        if brings > 0.0 && brings.is_finite() {
            let from = RayOrigin::free(photon.position);
            rays.push(light.source.as_ref().map_or_else(|| from.ray(light.direction), |source| from.segment(source)));
            arriving.push(brings);
        }
    }
    let blocked = blocked(scene, &rays);
    arriving.iter().zip(&blocked).filter(|(_, blocked)| !**blocked).map(|(brings, _)| brings).sum::<f64>() / asked
}

/// Return radiance over density, averaged over the channels.
pub(super) fn strength(light: &LightSample) -> f64 {
    light.weight.mean()
}

/// Targets of emission: primitives that may be specular.
struct Targets {
    primitives: Vec<u32>,
    /// Choice by area.
    choice: AliasTable,
    area: f64,
}

impl Targets {
    fn new(scene: &Scene) -> Option<Self> {
        let geometry = scene.geometry();
        // Materials that vary over a surface may be specular somewhere.
        let may_be_sharp = |bsdf: AnyBsdf| !is_matt(&bsdf) || bsdf.roughness() == 0.0;
        let is_target = |shape: u32| {
            let material = scene.material(shape);
            let may_be = !material.is_passed() && material.constant().is_none_or(may_be_sharp);
            geometry.instances_of(shape).is_some() || may_be
        };
        let (mut primitives, mut areas) = (Vec::new(), Vec::new());
        for shape in (0..geometry.shapes() as u32).filter(|&shape| is_target(shape)) {
            for primitive in geometry.primitives_of(shape) {
                let area = area(geometry, primitive);
                if area.is_finite() && area > 0.0 {
                    primitives.push(primitive);
                    areas.push(area);
                }
            }
        }
        let choice = AliasTable::new(&areas)?;
        Some(Self { primitives, choice, area: areas.iter().sum() })
    }

    /// Sample a point on a target, with its normal; for an instance, a point in its bounding box, without a normal.
    fn point(&self, geometry: &Geometry, sampler: &mut Sampler) -> Option<(DVec3, Option<DVec3>)> {
        let primitive = self.primitives[self.choice.sample(sampler.one(0))];
        let u = sampler.two(1);
        if let Some((instances, instance)) = geometry.instance(primitive) {
            let bounds = instances.bounds(instance)?;
            let place = DVec3::new(u[0], u[1], sampler.one(5));
            return Some((bounds.min + (bounds.max - bounds.min) * place, None));
        }
        match geometry.shape(primitive) {
            Some(shape) => shape.sample(u).map(|drawn| (drawn.point.position, Some(drawn.point.normal))),
            None => {
                let place = geometry.position(primitive, warp::uniform_triangle(u));
                Some((place, Some(geometry.normal(primitive))))
            }
        }
    }
}

/// Return the area of a primitive; for an instance, half that of its bounding box.
fn area(geometry: &Geometry, primitive: u32) -> f64 {
    let Some((instances, instance)) = geometry.instance(primitive) else { return geometry.area(primitive) };
    instances.bounds(instance).map_or(0.0, |bounds| {
        let size = bounds.max - bounds.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    })
}

/// Photons in flight, and their next rays.
#[derive(Default)]
struct FlyingPhotons {
    rays: Vec<Ray>,
    flying: Vec<Flying>,
}

/// The state of a photon.
#[derive(Clone, Copy)]
struct Flying {
    number: u32,
    flux: f64,
    /// True for light from a single direction or point: after delta scattering alone, no path can find it.
    is_single: bool,
    /// The last surface, and a hash of the surfaces before.
    target: DVec3,
    chain: u64,
    /// Number of specular bounces since the light or the last matte surface, and number of matte bounces.
    sharp: u32,
    matt: u32,
}

impl FlyingPhotons {
    /// Start one batch of the photons.
    fn new(scene: &Scene, targets: &Targets, part: u32) -> Self {
        let mut all = Self::default();
        for number in part * TOGETHER..(part + 1) * TOGETHER {
            all.send(scene, targets, number);
        }
        all
    }

    /// Send a photon from a light to a point on a target.
    fn send(&mut self, scene: &Scene, targets: &Targets, number: u32) -> Option<()> {
        let mut sampler = Sampler::new(0, number, 0);
        let geometry = scene.geometry();
        let (point, normal) = targets.point(geometry, &mut sampler)?;
        let receiver = LightSampleContext::free(point);
        let light = scene.lights().sample(geometry, &receiver, sampler.one(2), sampler.two(3))?;
        let ray = match &light.source {
            Some(source) => source.ray(-light.direction),
            None => Ray::new(point + light.direction * (4.0 * scene.region().radius), -light.direction),
        };
        // The photon may hit a surface in front of the point, so closed surfaces count twice.
        let cosine = normal.map_or(0.5, |normal| normal.dot(light.direction).abs());
        let flux = strength(&light) * cosine * targets.area / f64::from(SENT);
        if flux > 0.0 && flux.is_finite() {
            self.rays.push(Ray { time: sampler.one(4), ..ray });
            let is_single = light.pdf == f64::INFINITY;
            self.flying.push(Flying { number, flux, is_single, target: point, chain: 0, sharp: 0, matt: 0 });
        }
        Some(())
    }

    /// Trace all photons to their ends.
    fn follow(mut self, scene: &Scene) -> Vec<Photon> {
        let (mut hits, mut fallen) = (Vec::new(), Vec::new());
        for surface in 0..SURFACES {
            hits.clear();
            hits.resize(self.rays.len(), Hit::MISS);
            scene.intersect(&self.rays, &mut hits);
            let mut kept = 0;
            for i in 0..self.rays.len() {
                if !hits[i].is_hit() {
                    continue;
                }
                let here = SurfaceInteraction::at(scene, &self.rays[i], &hits[i]);
                let one = &self.flying[i];
                if one.sharp > 0 && is_matt(here.bsdf()) {
                    fallen.push(Photon {
                        position: here.ray_origin().ray(here.normal()).origin,
                        normal: here.shading_normal(),
                        target: one.target,
                        flux: one.flux,
                        chain: one.chain,
                    });
                }
                if let Some((ray, one)) = one.scattered(&here, &self.rays[i], surface) {
                    (self.rays[kept], self.flying[kept]) = (ray, one);
                    kept += 1;
                }
            }
            self.rays.truncate(kept);
            self.flying.truncate(kept);
        }
        fallen
    }
}

impl Flying {
    /// Scatter a photon at the surface of an index on its path; return `None` if it ends there.
    fn scattered(&self, here: &SurfaceInteraction, before: &Ray, surface: u32) -> Option<(Ray, Self)> {
        let ray = |direction| Ray { time: before.time, ..here.ray_origin().ray(direction) };
        if is_boundary(here.bsdf()) {
            return Some((ray(before.direction), *self));
        }
        let mut sampler = Sampler::new(0, self.number, surface + 1);
        let (next, counts) = branch(here, sampler.one(0), sampler.two(1))?;
        let is_sharp = next.pdf >= SHARP;
        let goes_on = if is_sharp {
            surface > 0 || !self.is_single || next.pdf < f64::INFINITY
        } else {
            // Caustics are seen in mirrors and through glass like lamps.
            self.sharp > 0 && self.matt < MATT
        };
        // Refraction preserves flux, although it changes radiance.
        let flux = self.flux * counts * (next.weight * (next.eta * next.eta)).mean();
        if !goes_on || flux <= 0.0 || !flux.is_finite() {
            return None;
        }
        let link = 2 * u64::from(here.surface().shape) + u64::from(next.is_through);
        let links = if is_sharp { self.chain } else { 1 };
        // The odd constant nearest to 2⁶⁴ over the golden ratio, as in Knuth's multiplicative hashing.
        let chain = (links ^ link).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        let (sharp, matt) = if is_sharp { (self.sharp + 1, self.matt) } else { (0, self.matt + 1) };
        Some((ray(next.wi), Self { flux, target: here.position(), chain, sharp, matt, ..*self }))
    }
}

/// Sample a photon's direction and return its weight. Of several lobes, the first and the last each have a probability
/// of at least a quarter. Reflection by glass would be rare otherwise, but is as bright at its destination as
/// transmission.
fn branch(here: &SurfaceInteraction, choice: f64, u: [f64; 2]) -> Option<(BsdfSample, f64)> {
    let choice = if choice < 0.5 {
        2.0 * choice
    } else if choice < 0.75 {
        0.0
    } else {
        1f64.next_down()
    };
    let next = here.sample(&mut || choice, u)?;
    let is_end = |is_it| if is_it { 0.25 } else { 0.0 };
    let ends = is_end(next.choices[0] == 0.0) + is_end(next.choices[1] == 1.0);
    let likely = next.probability();
    Some((next, likely / (0.5 * likely + ends)))
}
