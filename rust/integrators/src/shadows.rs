//! Shadow rays.

use raywright_base::math::{Hit, Ray, RayQueue};
use raywright_optics::Rgb;
use raywright_scene::{Scene, opacity_at};

/// Shadow rays of a batch with their contributions if unoccluded.
#[derive(Default)]
pub(super) struct Shadows {
    rays: RayQueue,
    arriving: Vec<(u32, Rgb)>,
    hits: Vec<Hit>,
}

impl Shadows {
    /// Remove all rays.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.arriving.clear();
    }

    /// Append a ray.
    #[inline]
    pub fn push(&mut self, ray: &Ray) {
        self.rays.push(ray);
    }

    /// Set the sample and the contribution of the next ray without one.
    #[inline]
    pub fn bring(&mut self, sample: u32, arriving: Rgb) {
        self.arriving.push((sample, arriving));
    }

    /// Add the contributions of rays through masks, attenuated by their opacity.
    pub fn add_through(&mut self, scene: &Scene, radiance: &mut [Rgb]) {
        // Light is added in the order of the rays, regardless of their number of segments.
        let mut on_way: Vec<usize> = (0..self.rays.len()).collect();
        while !on_way.is_empty() {
            let rays: Vec<Ray> = on_way.iter().map(|&i| self.rays.get(i)).collect();
            self.hits.clear();
            self.hits.resize(rays.len(), Hit::MISS);
            scene.intersect(&rays, &mut self.hits);
            let mut kept = 0;
            for i in 0..rays.len() {
                let (ray, hit, which) = (&rays[i], &self.hits[i], on_way[i]);
                if !hit.is_hit() {
                    continue;
                }
                let opacity = opacity(scene, ray, hit);
                self.arriving[which].1 *= 1.0 - opacity;
                if opacity < 1.0 {
                    self.rays.set_t_min(which, hit.t.next_up());
                    on_way[kept] = which;
                    kept += 1;
                }
            }
            on_way.truncate(kept);
        }
        for &(sample, arriving) in &self.arriving {
            radiance[sample as usize] += arriving;
        }
    }
}

/// Return the opacity at a hit.
pub(super) fn opacity(scene: &Scene, ray: &Ray, hit: &Hit) -> f64 {
    let material = scene.material_of(hit);
    if material.is_opaque() {
        return 1.0;
    }
    opacity_at(material, scene.geometry(), ray, hit, &scene.geometry().surface(ray, hit))
}
