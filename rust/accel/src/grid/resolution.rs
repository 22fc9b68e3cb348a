//! How many cells a grid has.

use super::PAD;
use raywright_base::math::{Aabb, Vec3};

/// How many cells a grid is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// So many cells a primitive, as nearly cubes as can be: the cube-root rule (Cleary and Wyvill 1988), by which a
    /// grid in space has ∛(density · n) cells along an axis, one over a plane √(density · n), and one along a line
    /// density · n.
    Density(f32),
    /// So many along the longest side, and cells that are as nearly cubes as can be.
    Longest(u32),
    /// So many along each axis.
    Each([u32; 3]),
}

impl Resolution {
    /// The most cells along an axis.
    pub const MOST: u32 = 4096;

    /// The most cells in all.
    pub const MOST_IN_ALL: usize = 1 << 27;

    /// The cells along each axis of a box in box units with `count` primitives in it.
    ///
    /// Fewer than asked for where there would be more than can be, or where they would be thinner than eight times what
    /// is listed around each: then everything would stand everywhere.
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

/// The side of cubes of which so many fill a box. Along an axis that is thinner than a cube there is one, and the
/// others share them.
fn cell_width(mut extent: [f32; 3], cells: f32) -> f32 {
    extent.sort_by(f32::total_cmp);
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

/// How many of a width fit along each axis, about.
fn cubes(extent: [f32; 3], width: f32) -> [u32; 3] {
    extent.map(|e| if width > 0.0 { (e / width).round() as u32 } else { 1 })
}

/// About a third as many in all.
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
        // A sheet that is thinner than its cells.
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
