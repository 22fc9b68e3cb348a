//! Light that paths run into, weighed against having been drawn.

use super::direct_light::power_heuristic;
use super::queues::PathQueue;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_scene::textures::TexturePoint;
use raywright_scene::{LightSampleContext, Scene, SurfaceBlock};
use std::f32::consts::FRAC_1_PI;

/// The point and the normal that light was asked for where a path set out.
fn receiver(queue: &PathQueue, path: usize) -> LightSampleContext {
    let [x, y, z] = &queue.normal;
    let normal = if x.is_empty() { DVec3::ZERO } else { DVec3::new(x[path].into(), y[path].into(), z[path].into()) };
    LightSampleContext { position: queue.rays.origin(path), normal, waves: None }
}

fn throughput(queue: &PathQueue, path: usize) -> Rgb {
    let [r, g, b] = &queue.throughput;
    Rgb::new(r[path].into(), g[path].into(), b[path].into())
}

/// Adds what arrives from outside the scene along the rays of paths that meet nothing.
pub(super) fn add_outside(scene: &Scene, queue: &PathQueue, which: &[u32], radiance: &mut [Rgb]) {
    let lights = scene.lights();
    if let Some(arriving) = lights.constant_sky() {
        let [x, y, z] = &queue.normal;
        for &i in which {
            let i = i as usize;
            let [to_x, to_y, to_z] = queue.rays.direction.each_ref().map(|column| column[i]);
            let cosine = (to_x * x[i] + to_y * y[i] + to_z * z[i]).max(0.0);
            // 1 for a camera's ray, whose density is infinite.
            let weight = power_heuristic(queue.pdf[i], cosine * FRAC_1_PI);
            radiance[queue.sample[i] as usize] += throughput(queue, i) * arriving * f64::from(weight);
        }
        return;
    }
    for &i in which {
        let i = i as usize;
        let direction = queue.rays.direction(i);
        let arriving = lights.infinite_radiance(direction);
        if arriving.is_black() {
            continue;
        }
        let pdf = queue.pdf[i];
        let weight = if pdf == f32::INFINITY {
            1.0
        } else {
            power_heuristic(pdf, lights.infinite_pdf(&receiver(queue, i), direction) as f32)
        };
        radiance[queue.sample[i] as usize] += throughput(queue, i) * arriving * f64::from(weight);
    }
}

/// Adds what surfaces emit that paths have met.
pub(super) fn add_emitted(scene: &Scene, queue: &PathQueue, surfaces: &SurfaceBlock, radiance: &mut [Rgb]) {
    let lights = scene.lights();
    for lane in 0..surfaces.count {
        let shape = surfaces.shape[lane];
        if !lights.shines(shape) {
            continue;
        }
        let cosine = f64::from(surfaces.cosine[lane]) * if surfaces.is_front[lane] == 0 { -1.0 } else { 1.0 };
        let emission = lights.emission(shape).towards(cosine, &TexturePoint::NOWHERE);
        if emission.is_black() {
            continue;
        }
        let i = surfaces.index[lane] as usize;
        let pdf = queue.pdf[i];
        let weight = if pdf == f32::INFINITY {
            1.0
        } else {
            let ray = Ray::new(queue.rays.origin(i), queue.rays.direction(i));
            let t = (surfaces.position.get(lane) - ray.origin).length();
            let hit = Hit { t, primitive: surfaces.primitive[lane], ..Hit::MISS };
            let drawn = lights.surface_pdf(scene.geometry(), &receiver(queue, i), &ray, &hit, cosine);
            power_heuristic(pdf, drawn as f32)
        };
        radiance[queue.sample[i] as usize] += throughput(queue, i) * emission * f64::from(weight);
    }
}
