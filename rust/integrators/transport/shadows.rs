//! Whether light that was drawn arrives.

use super::nesting::{Boundary, MediumStack, around};
use crate::math::{Hit, Ray};
use crate::optics::Rgb;
use crate::scene::textures::TexturePoint;
use crate::scene::{Scene, ShadingPoint, SurfacePoint};

/// Shadow rays of a batch, and what arrives along each if nothing lies on the way.
#[derive(Default)]
pub(super) struct Shadows {
    rays: Vec<Ray>,
    arriving: Vec<(u32, Rgb)>,
    /// What each starts in, in a scene of nested media.
    media: Vec<MediumStack>,
    occluded: Vec<bool>,
    hits: Vec<Hit>,
    windows: Vec<Ray>,
}

impl Shadows {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.arriving.clear();
        self.media.clear();
    }

    /// A ray along which this much arrives at a sample.
    #[inline]
    pub fn push(&mut self, ray: Ray, sample: u32, arriving: Rgb) {
        self.rays.push(ray);
        self.arriving.push((sample, arriving));
    }

    /// What the ray pushed last starts in.
    #[inline]
    pub fn set_media(&mut self, media: MediumStack) {
        self.media.push(media);
    }

    /// Adds to each sample what arrives at it, as if nothing were in the way.
    pub fn add_all(&mut self, radiance: &mut [Rgb]) {
        for &(sample, arriving) in &self.arriving {
            radiance[sample as usize] += arriving;
        }
    }

    /// Adds to each sample what arrives at it in a scene in which every hit blocks.
    pub fn add_unblocked(&mut self, scene: &Scene, radiance: &mut [Rgb]) {
        self.occluded.resize(self.rays.len(), false);
        scene.occluded(&self.rays, &mut self.occluded);
        for (&(sample, arriving), &occluded) in self.arriving.iter().zip(&self.occluded) {
            if !occluded {
                radiance[sample as usize] += arriving;
            }
        }
    }

    /// Adds to each sample what arrives at it through masks, dimmed by their opacity, and through surfaces that are
    /// none because another medium is there.
    pub fn add_through(&mut self, scene: &Scene, nested: bool, radiance: &mut [Rgb]) {
        // Light is added in the order of the rays, whichever of them are followed for longer.
        let mut on_way: Vec<usize> = (0..self.rays.len()).collect();
        while !on_way.is_empty() {
            let rays: Vec<Ray> = on_way.iter().map(|&i| self.rays[i]).collect();
            self.hits.clear();
            self.hits.resize(rays.len(), Hit::MISS);
            scene.intersect(&rays, &mut self.hits);
            self.windows.clear();
            if nested {
                let hits = rays.iter().zip(&self.hits).filter(|(_, hit)| hit.is_hit());
                self.windows.extend(hits.filter_map(|(ray, hit)| around(scene, ray, hit)));
            }
            let crossings = scene.crossings(&self.windows);
            let mut window = 0;
            let mut kept = 0;
            for i in 0..rays.len() {
                let (ray, hit, which) = (&rays[i], &self.hits[i], on_way[i]);
                if !hit.is_hit() {
                    continue;
                }
                if nested && around(scene, ray, hit).is_some() {
                    window += 1;
                    if let Boundary::None(media) = Boundary::new(scene, ray, &self.media[which], &crossings, window - 1)
                    {
                        self.rays[which].t_min = self.windows[window - 1].t_max.next_up();
                        self.media[which] = media;
                        on_way[kept] = which;
                        kept += 1;
                        continue;
                    }
                }
                let opacity = opacity(scene, ray, hit, &scene.geometry().surface(ray, hit));
                self.arriving[which].1 *= 1.0 - opacity;
                if opacity < 1.0 {
                    self.rays[which].t_min = hit.t.next_up();
                    on_way[kept] = which;
                    kept += 1;
                }
            }
            on_way.truncate(kept);
        }
        self.add_all(radiance);
    }
}

/// The share of rays that meet what is hit.
pub(super) fn opacity(scene: &Scene, ray: &Ray, hit: &Hit, surface: &SurfacePoint) -> f64 {
    let material = scene.material_at(surface);
    if material.is_opaque() {
        return 1.0;
    }
    let needs = material.needs();
    let texture: TexturePoint = ShadingPoint::new(scene.geometry(), ray, hit, surface, needs, 0.0).texture;
    material.opacity(&texture).clamp(0.0, 1.0)
}
