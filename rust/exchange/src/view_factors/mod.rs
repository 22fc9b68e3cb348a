//! View factors: the fraction of diffuse light leaving the front of one face that reaches the front of another.

mod balance;
mod clusters;
mod coincident;
mod contour;
mod distant;
mod facet;
mod flat_faces;
mod hinge;
mod hit_fronts;
mod matrix;
mod pair;
mod pair_pieces;
mod partly_visible_pairs;
mod proportion_error;
mod ray_rounds;
mod reconcile;
mod row_sampler;
mod shaft;
mod sparse;
#[cfg(test)]
mod tests;

pub use distant::Quadrature;
pub use facet::Facet;
pub use flat_faces::{SharedPlane, shared_planes};
pub use hit_fronts::Fronts;
pub use matrix::{Matrix, matrix};
pub use pair::pair;
pub use sparse::{Sparse, sparse};

use raywright_accel::Primitives;
use raywright_scene::Scene;

/// The accuracy of sampled entries.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// Rays for a pair of faces with a potential blocker.
    pub rays: u32,
    /// Rays for a face with a sampled row.
    pub row_rays: u32,
    /// Maximum standard error of any view factor, as far as rays can achieve it.
    pub error: Option<f64>,
    /// The same relative to the greatest factor of either row, within a maximum number of rays.
    pub relative: Option<f64>,
    /// The random seed.
    pub seed: u64,
}

/// The sampled exchange of two faces: the area of either times its view factor to the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sampled {
    /// The faces.
    pub faces: [u32; 2],
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// An upper bound.
    pub most: f64,
}

/// All primitives as one-sided triangles; other shapes have no area here.
fn facets(scene: &Scene) -> Vec<Facet> {
    let geometry = scene.geometry();
    (0..geometry.count() as u32).map(|primitive| Facet::new(geometry.corners(primitive))).collect()
}

/// The areas of all primitives; 0 for those that cannot be hit.
pub fn areas(scene: &Scene) -> Vec<f64> {
    let geometry = scene.geometry();
    let area = |primitive| {
        geometry.shape(primitive).map_or_else(|| Facet::new(geometry.corners(primitive)).area, |s| s.area())
    };
    (0..geometry.count() as u32).map(area).map(|area| if area.is_finite() { area } else { 0.0 }).collect()
}
