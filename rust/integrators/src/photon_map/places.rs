//! Where photons are, for those that ask what is about a place.

use super::grid::HashedGrid;
use super::kd_tree::KdTree;
use raywright_base::math::DVec3;

/// Where photons are.
#[derive(Debug)]
pub(crate) enum Places {
    /// For all within a radius.
    Grid(HashedGrid),
    /// For the nearest.
    Tree(KdTree),
}

impl Places {
    /// For all within a radius, or for the nearest.
    pub fn new(positions: impl ExactSizeIterator<Item = DVec3> + Clone, radius: Option<f64>) -> Self {
        match radius {
            Some(radius) => Self::Grid(HashedGrid::new(positions, radius)),
            None => Self::Tree(KdTree::new(positions)),
        }
    }

    /// Adds what is about a place: all within the radius, or so many of the nearest, up to a distance whose square is
    /// told. Each comes with the square of its distance as it is measured, if it counts, and that of the radius, which
    /// is what comes back.
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
                // Where the farthest tells the radius, the others alone are counted: N − 1 of N (García et al., "On the
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
