//! Surface share of a lookup disk.

use super::kernel::Kernel;
use super::photon::{FLAT, SAME_SIDE};
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::sampling::Sampler;
use raywright_optics::Bsdf;
use raywright_scene::{Interaction, Scene, SurfaceInteraction};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Number of rings of equal area, and of probes on each.
const RINGS: usize = 4;
const TURNS: usize = 4;

/// Return the kernel-weighted share of a disk, given its squared radius, that is surface with photons that would count.
/// There are no photons beyond a floor's edge or behind a wall on it. The estimate is divided by the existing area
/// (Jensen 2001), or it would be too dark.
///
/// Probe rays cross the disk perpendicularly, from the maximum photon distance above it to as far below. The probes of
/// the outermost of four rings go first: if all of them hit, the share is 1. A straight edge is missed only if less
/// than a tenth of the disk lies beyond it, and by chance.
pub(crate) fn cover<B: Bsdf>(
    scene: &Scene,
    here: &SurfaceInteraction<B>,
    squared: f64,
    kernel: Kernel,
    time: f64,
) -> f64 {
    let (position, frame) = (here.position(), Frame::new(here.normal()));
    // The rotation of the rings is pseudorandom and depends on the position alone.
    let bits = position.to_array().map(f64::to_bits);
    let mut sampler = Sampler::new(bits[0] ^ bits[1].rotate_left(21) ^ bits[2].rotate_left(42), 0, 0);
    let turn = sampler.one(0);
    let told = |ring: usize| {
        let share = (ring as f64 + 0.5) / RINGS as f64;
        let (far, high) = ((share * squared).sqrt(), ((1.0 - share) * squared).sqrt() / FLAT);
        let rays: [Ray; TURNS] = std::array::from_fn(|i| {
            let angle = (i as f64 + turn) * FRAC_PI_2 + ring as f64 * FRAC_PI_4 * 0.5;
            let (sin, cos) = angle.sin_cos();
            let above = position + frame.to_world(DVec3::new(far * cos, far * sin, high));
            Ray { t_max: 2.0 * high, time, ..Ray::new(above, -here.normal()) }
        });
        let mut hits = [Hit::MISS; TURNS];
        scene.intersect(&rays, &mut hits);
        // A sloped surface has more area than its projection.
        let area = |(ray, hit): (&Ray, &Hit)| {
            if !hit.is_hit() {
                return 0.0;
            }
            let cosine = scene.geometry().surface(ray, hit).normal.dot(here.normal()).abs();
            if cosine > SAME_SIDE { 1.0 / cosine } else { 0.0 }
        };
        let areas = rays.iter().zip(&hits).map(area);
        (areas.sum::<f64>() / TURNS as f64, kernel.weight(share, 1.0))
    };
    let (outermost, weight) = told(RINGS - 1);
    if (outermost - 1.0).abs() < 0.01 {
        return 1.0;
    }
    let (mut sum, mut all) = (outermost * weight, weight);
    for ring in 0..RINGS - 1 {
        let (area, weight) = told(ring);
        sum += area * weight;
        all += weight;
    }
    // The point itself is on a surface: its share is at least that of one probe.
    (sum / all).max(1.0 / (RINGS * TURNS) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_scene::SceneDescription;
    use raywright_scene::fixtures::{rectangle, scene, shape};

    /// Return a floor over x ≥ 0 and y ≥ 0.
    fn floor() -> Scene {
        let mesh = rectangle([0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
        scene(SceneDescription { shapes: vec![shape(mesh, [1.0; 3], 0.0)], ..Default::default() })
    }

    fn share(scene: &Scene, x: f64, y: f64, kernel: Kernel) -> f64 {
        let ray = Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
        let mut hits = [Hit::MISS];
        scene.intersect(&[ray], &mut hits);
        cover(scene, &SurfaceInteraction::at(scene, &ray, &hits[0]), 1.0, kernel, 0.0)
    }

    #[test]
    fn shares_are_those_of_disks() {
        // At an edge, in a corner, and half a radius from the edge: 1 - (π/3 - √3/4) / π. Sixteen probes are accurate
        // to a few hundredths each, and their mean over a thousand places to a thousandth, except for edges missed by
        // the outermost ring.
        let scene = floor();
        let places = 1000;
        let mean = |x: f64, y: Option<f64>, kernel| {
            let each = |i| share(&scene, x, y.unwrap_or(5.0 + 0.01 * f64::from(i)), kernel);
            (0..places).map(each).sum::<f64>() / f64::from(places)
        };
        for kernel in [Kernel::Box, Kernel::Cone, Kernel::Epanechnikov] {
            assert!((mean(1e-9, None, kernel) - 0.5).abs() < 0.01);
            assert_eq!(share(&scene, 5.0, 5.0, kernel), 1.0);
        }
        let half = mean(0.5, None, Kernel::Box);
        assert!((half - 0.804_498_890_522_115).abs() < 0.02, "{half}");
        let corner = mean(1e-9, Some(1e-9), Kernel::Box);
        assert!((corner - 0.25).abs() < 0.07, "{corner}");
    }
}
