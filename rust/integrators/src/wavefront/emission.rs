//! Light that paths run into, weighed against having been drawn.

use super::direct_light::power_heuristic;
use super::queues::{Flags, PathQueue};
use super::waves::{self, PathWaves};
use raywright_base::math::{DVec3, Hit, LANES, Ray};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::textures::TexturePoint;
use raywright_scene::{LightSampleContext, LookupContext, Scene, SurfaceBlock};
use std::f32::consts::FRAC_1_PI;

/// The point and the normal that light was asked for where a path set out.
fn receiver(queue: &PathQueue, waves: &[PathWaves], path: usize) -> LightSampleContext {
    let [x, y, z] = &queue.normal;
    let normal = if x.is_empty() { DVec3::ZERO } else { DVec3::new(x[path].into(), y[path].into(), z[path].into()) };
    LightSampleContext { position: queue.vertex(path), normal, waves: waves_of(queue, waves, path) }
}

/// The wavelengths of a path; `None` for red, green and blue.
fn waves_of(queue: &PathQueue, waves: &[PathWaves], path: usize) -> Option<Waves> {
    waves::at(waves, queue.sample[path])
}

/// Return whether emission at the end of a path was part of the look-up that its final gather ray started from.
fn is_known(queue: &PathQueue, path: usize) -> bool {
    queue.flags.get(path).is_some_and(|flags| flags & Flags::IS_LIT != 0)
}

/// Return whether each of few lights was sampled at the start of a path's ray.
fn asked_each(queue: &PathQueue, path: usize) -> bool {
    queue.flags.get(path).is_some_and(|flags| flags & Flags::ASKED_EACH != 0)
}

fn throughput(queue: &PathQueue, path: usize) -> Rgb {
    let [r, g, b] = &queue.throughput;
    Rgb::new(r[path].into(), g[path].into(), b[path].into())
}

/// Adds what arrives from outside the scene along the rays of paths that meet nothing.
pub(super) fn add_outside(
    scene: &Scene,
    (queue, waves): (&PathQueue, &[PathWaves]),
    which: &[u32],
    radiance: &mut [Rgb],
) {
    let lights = scene.lights();
    let constant = lights.constant_sky();
    for &i in which {
        let i = i as usize;
        if is_known(queue, i) {
            continue;
        }
        let pdf = queue.pdf[i];
        let [x, y, z] = queue.normal.each_ref().map(|column| column.get(i).copied().unwrap_or(0.0));
        if let Some(arriving) = constant.filter(|_| pdf == f32::INFINITY || x * x + y * y + z * z > 0.0) {
            let [to_x, to_y, to_z] = queue.rays.direction.each_ref().map(|column| column[i]);
            let cosine = (to_x * x + to_y * y + to_z * z).max(0.0);
            // 1 for a camera's ray, whose density is infinite.
            let weight = power_heuristic(pdf, cosine * FRAC_1_PI);
            radiance[queue.sample[i] as usize] += throughput(queue, i) * arriving * f64::from(weight);
            continue;
        }
        let direction = queue.rays.direction(i);
        let arriving = lights.infinite_radiance_at(direction, waves_of(queue, waves, i).as_ref());
        if arriving.is_black() {
            continue;
        }
        let weight = |drawn: f64| f64::from(power_heuristic(pdf, drawn as f32));
        let arriving = if pdf == f32::INFINITY {
            arriving
        } else if asked_each(queue, i) {
            lights.outside_weighed(&receiver(queue, waves, i), direction, weight)
        } else {
            arriving * weight(lights.infinite_pdf(&receiver(queue, waves, i), direction))
        };
        radiance[queue.sample[i] as usize] += throughput(queue, i) * arriving;
    }
}

/// Adds what surfaces emit that paths have met, with rays so wide.
pub(super) fn add_emitted(
    scene: &Scene,
    (queue, hits, waves): (&PathQueue, &[Hit], &[PathWaves]),
    surfaces: &SurfaceBlock,
    width: &[f32; LANES],
    radiance: &mut [Rgb],
) {
    let lights = scene.lights();
    for lane in 0..surfaces.count {
        let shape = surfaces.shape[lane];
        let is_instance = !hits.is_empty() && scene.geometry().instances_of(shape).is_some();
        if !(is_instance || lights.shines(shape)) || is_known(queue, surfaces.index[lane] as usize) {
            continue;
        }
        let cosine = f64::from(surfaces.cosine[lane]) * if surfaces.is_front[lane] == 0 { -1.0 } else { 1.0 };
        let emission = if is_instance || lights.emission(shape).needs().any() {
            let (ray, hit) = scene.geometry().hit_of_lane((&queue.rays, hits), surfaces, lane);
            let surface = scene.geometry().surface(&ray, &hit);
            scene.emission_at(&surface).sent(scene.geometry(), &ray, &hit, &surface, || {
                let waves = waves_of(queue, waves, surfaces.index[lane] as usize);
                LookupContext { width: width[lane].into(), waves }
            })
        } else {
            lights.emission(shape).towards(cosine, &TexturePoint::NOWHERE)
        };
        if emission.is_black() {
            continue;
        }
        let i = surfaces.index[lane] as usize;
        let pdf = queue.pdf[i];
        let weight = if pdf == f32::INFINITY {
            1.0
        } else {
            let (geometry, receiver) = (scene.geometry(), receiver(queue, waves, i));
            let (ray, hit) = if is_instance {
                let (ray, hit) = geometry.hit_of_lane((&queue.rays, hits), surfaces, lane);
                let way = (ray.origin - receiver.position).length();
                (Ray { origin: receiver.position, ..ray }, Hit { t: hit.t + way, ..hit })
            } else {
                let ray = Ray::new(receiver.position, queue.rays.direction(i));
                let t = (surfaces.position.get(lane) - ray.origin).length();
                (ray, Hit { t, primitive: surfaces.primitive[lane], ..Hit::MISS })
            };
            let drawn = if asked_each(queue, i) {
                lights.own_pdf(geometry, &receiver, &ray, &hit, cosine)
            } else {
                lights.surface_pdf(geometry, &receiver, &ray, &hit, cosine)
            };
            power_heuristic(pdf, drawn as f32)
        };
        radiance[queue.sample[i] as usize] += throughput(queue, i) * emission * f64::from(weight);
    }
}
