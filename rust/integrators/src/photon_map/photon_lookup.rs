//! Photon lookup by position.

use super::hashed_grid::HashedGrid;
use super::kd_tree::PointKdTree;
use raywright_base::math::DVec3;

/// A lookup structure for photon positions.
#[derive(Debug)]
pub(crate) enum Places {
    /// For lookups of all photons within a radius.
    Grid(HashedGrid),
    /// For lookups of the nearest photons.
    Tree(PointKdTree),
}

impl Places {
    /// Build a grid for a given radius, else a kd-tree.
    pub fn new(positions: impl ExactSizeIterator<Item = DVec3> + Clone, radius: Option<f64>) -> Self {
        match radius {
            Some(radius) => Self::Grid(HashedGrid::new(positions, radius)),
            None => Self::Tree(PointKdTree::new(positions)),
        }
    }

    /// Append the photons around a place: all within the radius, or the `count` nearest within a maximum squared
    /// distance. Each has its squared distance as measured; `measure` can reject photons. Return the squared radius.
    pub fn gather(
        &self,
        place: DVec3,
        (nearest, most): (Option<u32>, f64),
        measured: impl Fn(u32, f64) -> Option<f64>,
        mut add: impl FnMut(u32, f64, f64),
    ) -> f64 {
        match self {
            Self::Grid(grid) => {
                let radius = grid.radius() * grid.radius();
                grid.within(place, |number, squared| {
                    if let Some(squared) = measured(number, squared) {
                        add(number, squared, radius);
                    }
                });
                radius
            }
            Self::Tree(tree) => {
                let (count, mut found) = (nearest.unwrap_or(u32::MAX) as usize, Vec::new());
                tree.nearest(place, count, most, measured, &mut found);
                // If the farthest photon sets the radius, the other N − 1 are counted (García et al., "On the
                // Convergence of Density Estimation for Radiative Transfer", 2012).
                let radius = match found.last() {
                    Some(farthest) if found.len() == count || most == f64::INFINITY => farthest.squared,
                    _ => most,
                };
                for near in &found {
                    add(near.number, near.squared, radius);
                }
                radius
            }
        }
    }
}
