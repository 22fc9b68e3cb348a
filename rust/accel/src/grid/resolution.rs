//! The resolution of grids.

use super::PAD;
use raywright_base::math::{Aabb, Vec3};

/// How the number of cells is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Cells per primitive, with nearly cubic cells: the cube-root rule (Cleary and Wyvill 1988). A grid in space has
    /// ∛(density · n) cells along an axis, one over a plane √(density · n), and one along a line density · n.
    Density(f32),
    /// Cells along the longest side, with nearly cubic cells.
    Longest(u32),
    /// Cells along each axis.
    Each([u32; 3]),
}

impl Resolution {
    /// Maximum number of cells along an axis.
    pub const MOST: u32 = 4096;

    /// Maximum total number of cells.
    pub const MOST_IN_ALL: usize = 1 << 27;

    /// The cells along each axis of a box in box units with `count` primitives.
    ///
    /// The result is limited by the maximum numbers, and cells are at least eight PAD thick: thinner cells would
    /// reference almost everything.
    pub fn cells(self, bounds: &Aabb, count: usize) -> [u32; 3] {
        let extent = (bounds.max - bounds.min).max(Vec3::ZERO).to_array();
        let most = extent.map(|e| ((e / (8.0 * PAD)) as u32).clamp(1, Self::MOST));
        let wanted = match self {
            Self::Density(density) => {
                let cells = (density * count as f32).clamp(1.0, Self::MOST_IN_ALL as f32);
                cubes(extent, cell_width(extent, cells))
            }
            Self::Longest(n) => cubes(extent, extent.into_iter().fold(0.0, f32::max) / n as f32),
            Self::Each(n) => n,
        };
        let mut cells = [0, 1, 2].map(|axis| wanted[axis].clamp(1, most[axis]));
        while cells.iter().map(|&n| n as usize).product::<usize>() > Self::MOST_IN_ALL {
            cells = coarser(cells);
        }
        cells
    }
}

/// The side length of cubes, given the number that fill a box. An axis thinner than a cube has one cell, and the other
/// axes share the cells.
fn cell_width(mut extent: [f32; 3], cells: f32) -> f32 {
    extent.sort_unstable_by(f32::total_cmp);
    let [a, b, c] = extent.map(f64::from);
    let cells = f64::from(cells);
    let (space, plane) = ((a * b * c / cells).cbrt(), (b * c / cells).sqrt());
    let width = if a >= space && a > 0.0 {
        space
    } else if b >= plane && b > 0.0 {
        plane
    } else {
        c / cells
    };
    width as f32
}

/// The number of cells of a given width along each axis, rounded.
fn cubes(extent: [f32; 3], width: f32) -> [u32; 3] {
    extent.map(|e| if width > 0.0 { (e / width).round() as u32 } else { 1 })
}

/// About a third as many cells in total.
pub fn coarser(cells: [u32; 3]) -> [u32; 3] {
    cells.map(|n| (n * 7 / 10).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(extent: [f32; 3]) -> Aabb {
        Aabb { min: Vec3::ZERO, max: Vec3::from(extent) }
    }

    #[test]
    fn the_cube_root_rule_in_space_over_a_plane_and_along_a_line() {
        let by = |extent, count| Resolution::Density(4.0).cells(&of(extent), count);
        assert_eq!(by([1.0, 1.0, 1.0], 2000), [20, 20, 20]);
        assert_eq!(by([2.0, 1.0, 0.5], 2000), [40, 20, 10]);
        assert_eq!(by([1.0, 0.0, 1.0], 2500), [100, 1, 100]);
        assert_eq!(by([0.0, 2.0, 0.0], 100), [1, 400, 1]);
        assert_eq!(by([0.0; 3], 100), [1, 1, 1]);
        assert_eq!(by([1.0; 3], 0), [1, 1, 1]);
        // A sheet thinner than its cells.
        assert_eq!(by([1.0, 1.0, 1e-3], 2500), [100, 100, 1]);
    }

    #[test]
    fn what_is_given_is_taken_as_far_as_it_can_be() {
        let bounds = of([2.0, 1.0, 0.01]);
        assert_eq!(Resolution::Longest(64).cells(&bounds, 1), [64, 32, 1]);
        assert_eq!(Resolution::Each([5, 6, 7]).cells(&bounds, 1), [5, 6, 7]);
        assert_eq!(Resolution::Each([5, 6, 7]).cells(&of([1.0, 1.0, 0.0]), 1), [5, 6, 1]);
        let all = Resolution::Each([u32::MAX; 3]).cells(&of([4.0; 3]), 1);
        let count: usize = all.iter().map(|&n| n as usize).product();
        assert!(count <= Resolution::MOST_IN_ALL && count > Resolution::MOST_IN_ALL / 4, "{all:?}");
    }
}
