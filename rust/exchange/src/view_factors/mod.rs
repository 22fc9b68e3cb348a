//! View factors: which share of the light that leaves one face, even and from its front, comes to the front of another.

mod balance;
mod by_rays;
mod clusters;
mod coincident;
mod contour;
mod distant;
mod facet;
mod flats;
mod fronts;
mod hinge;
mod matrix;
mod pair;
mod partly;
mod pieces;
mod reconcile;
mod rounds;
mod shaft;
mod sparse;
#[cfg(test)]
mod tests;
mod told;

pub use distant::Quadrature;
pub use facet::Facet;
pub use flats::{SharedPlane, shared_planes};
pub use fronts::Fronts;
pub use matrix::{Matrix, matrix};
pub use pair::pair;
pub use sparse::{Sparse, sparse};

use raywright_accel::Primitives;
use raywright_scene::Scene;

/// How well what is sampled is to be known.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// Rays between two faces that something may lie between.
    pub rays: u32,
    /// Rays from a face whose whole row is sampled.
    pub row_rays: u32,
    /// The standard error that no view factor exceeds, if rays can do it.
    pub error: Option<f64>,
    /// The same as a share of the greatest factor of either row, as far as a number of rays can do it.
    pub relative: Option<f64>,
    /// Picks the random numbers.
    pub seed: u64,
}

/// What two faces exchange, the area of each times its view factor to the other, as sampled.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sampled {
    /// Which.
    pub faces: [u32; 2],
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// An upper bound.
    pub most: f64,
}

/// All primitives as triangles that send; those that are none have no area here.
fn facets(scene: &Scene) -> Vec<Facet> {
    let geometry = scene.geometry();
    (0..geometry.count() as u32).map(|primitive| Facet::new(geometry.corners(primitive))).collect()
}

/// The areas of all primitives; 0 of what cannot be hit.
pub fn areas(scene: &Scene) -> Vec<f64> {
    let geometry = scene.geometry();
    let area = |primitive| {
        geometry.shape(primitive).map_or_else(|| Facet::new(geometry.corners(primitive)).area, |s| s.area())
    };
    (0..geometry.count() as u32).map(area).map(|area| if area.is_finite() { area } else { 0.0 }).collect()
}
