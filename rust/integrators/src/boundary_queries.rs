//! The boundaries that a batch of rays hits: all hits around each, which [`Boundary`] tells media by.

use super::nesting::{Around, Boundary, Filling, MediumStack, around};
use raywright_accel::Crossings;
use raywright_base::math::{Hit, Ray};
use raywright_scene::Scene;

/// The boundaries of a batch.
#[derive(Debug, Default)]
pub(super) struct BoundaryQueries {
    /// What is around the hit of each ray, and the number of its window.
    around: Vec<(Around, usize)>,
    windows: Vec<Ray>,
    crossings: Crossings,
}

impl BoundaryQueries {
    /// Find the hits around each hit of these rays. [`Hit::MISS`] is none.
    pub fn find<F: Filling>(&mut self, scene: &Scene, rays: impl Iterator<Item = Ray>, hits: &[Hit]) {
        self.around.clear();
        self.windows.clear();
        for (ray, hit) in rays.zip(hits) {
            let around = if hit.is_hit() { around::<F>(scene, &ray, hit) } else { Around::Open };
            self.around.push((around, self.windows.len()));
            if let Around::Window(window) = around {
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
        let (around, window) = &self.around[i];
        let hits = match around {
            Around::Open => return None,
            Around::Nothing(_) => std::slice::from_ref(hit),
            Around::Window(_) => self.crossings.of_ray(*window),
        };
        Some((Boundary::new(scene, ray, media, hits), around.beyond(hit)))
    }
}
