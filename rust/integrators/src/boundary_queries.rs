//! The boundaries that a batch of rays hits: all hits around each, which [`Boundary`] tells media by.

use super::nesting::{Boundary, Filling, MediumStack, Vicinity, around};
use raywright_accel::Crossings;
use raywright_base::math::{Hit, Ray};
use raywright_scene::Scene;
use raywright_scene::materials::Interior;

/// The boundaries of a batch.
#[derive(Debug, Default)]
pub(super) struct BoundaryQueries {
    /// What is around the hit of each ray, and the number of its window.
    around: Vec<(Vicinity, usize)>,
    windows: Vec<Ray>,
    crossings: Crossings,
}

impl BoundaryQueries {
    /// Find the hits around each hit of these rays. [`Hit::MISS`] is none.
    pub fn find<F: Filling>(&mut self, scene: &Scene, rays: impl Iterator<Item = Ray>, hits: &[Hit]) {
        self.around.clear();
        self.windows.clear();
        for (ray, hit) in rays.zip(hits) {
            let around = if hit.is_hit() { around::<F>(scene, &ray, hit) } else { Vicinity::Open };
            self.around.push((around, self.windows.len()));
            if let Vicinity::Window(window) = around {
                self.windows.push(window);
            }
        }
        self.crossings = if self.windows.is_empty() { Crossings::default() } else { scene.crossings(&self.windows) };
    }

    /// Return the boundary that ray number `i` hits, in media, and the `t` from which it goes on; `None` for an open
    /// surface.
    pub fn boundary<F: Filling>(
        &self,
        scene: &Scene,
        i: usize,
        (ray, hit): (&Ray, &Hit),
        media: &MediumStack<F>,
    ) -> Option<(Boundary<F>, f64)> {
        let (crossed, beyond) = self.crossed(i, hit)?;
        Some((Boundary::new(scene, ray, media, crossed), beyond))
    }

    /// Return all hits around the hit of ray number `i`, and the `t` from which it goes on; `None` for an open surface.
    pub fn crossed<'h>(&'h self, i: usize, hit: &'h Hit) -> Option<(&'h [Hit], f64)> {
        let (around, window) = &self.around[i];
        let hits = match around {
            Vicinity::Open => return None,
            Vicinity::Nothing(_) => std::slice::from_ref(hit),
            Vicinity::Window(_) => self.crossings.of_ray(*window),
        };
        Some((hits, around.beyond(hit)))
    }
}

/// Return the index of refraction around each ray's hit, on the side away from the object's own interior. It is 1 for
/// misses and for materials that do not depend on it. Rays start in the media at their origins.
pub fn indices_outside(scene: &Scene, rays: &[Ray], hits: &[Hit]) -> Vec<f64> {
    let mut found = vec![1.0; rays.len()];
    if !scene.plan().needs().nested {
        return found;
    }
    let met: Vec<usize> = (0..rays.len()).filter(|&i| hits[i].is_hit()).collect();
    let whole: Vec<Ray> = met.iter().map(|&i| Ray { t_max: f64::INFINITY, ..rays[i] }).collect();
    let mut media = Vec::new();
    MediumStack::<Interior>::at(scene, &whole, &mut media);
    let (rays, hits): (Vec<Ray>, Vec<Hit>) = met.iter().map(|&i| (rays[i], hits[i])).unzip();
    let mut boundaries = BoundaryQueries::default();
    boundaries.find::<Interior>(scene, rays.iter().copied(), &hits);
    for (number, (&i, media)) in met.iter().zip(&media).enumerate() {
        match boundaries.boundary(scene, number, (&rays[number], &hits[number]), media) {
            None => found[i] = media.ior_around(scene, &hits[number]),
            Some((Boundary::Between { outside, .. }, _)) => found[i] = outside,
            Some((Boundary::None(_), _)) => {}
        }
    }
    found
}
