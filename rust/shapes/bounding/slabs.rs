//! k-slabs: what lies between k pairs of parallel planes whose normals are the same for all (Kay and Kajiya, "Ray
//! Tracing Complex Scenes", 1986). Thin diagonal things fill them better than a box, and a ray's products with the
//! normals are made once for all.

use super::polytope::Polytope;
use super::{Across, Line, Volume};
use crate::math::DVec3;
use crate::math::robust::UNIT;

/// Between the planes along `K` directions: 3, those of the axes; 7, with the diagonals of a cube; 9, with those of its
/// faces; 13, with both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slabs<const K: usize> {
    low: [f64; K],
    high: [f64; K],
}

/// A ray's way along every direction.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay<const K: usize> {
    ways: [Across; K],
    /// The origin's largest coordinate.
    far: f64,
}

const ALL: [[f64; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
];

impl<const K: usize> Slabs<K> {
    /// The normals, not of unit length.
    pub const NORMALS: [DVec3; K] = {
        assert!(K == 3 || K == 7 || K == 9 || K == 13, "3, 7, 9 or 13 directions");
        let mut all = [DVec3::ZERO; K];
        let mut i = 0;
        while i < K {
            all[i] = DVec3::from_array(ALL[if K == 9 && i >= 3 { i + 4 } else { i }]);
            i += 1;
        }
        all
    };

    /// Along each normal, from where to where it goes.
    pub fn spans(&self) -> [[f64; 2]; K] {
        std::array::from_fn(|i| [self.low[i], self.high[i]])
    }

    /// The smallest slabs around two.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|i| self.low[i].min(other.low[i])),
            high: std::array::from_fn(|i| self.high[i].max(other.high[i])),
        }
    }

    /// The heights of a point, and what they may be off by: two roundings of sums of three coordinates.
    fn heights(point: DVec3) -> ([f64; K], f64) {
        let heights = Self::NORMALS.map(|n| n.dot(point));
        (heights, 6.0 * UNIT * point.abs().max_element())
    }

    fn polytope(&self) -> Polytope {
        let axis = |of: &[f64; K]| DVec3::new(of[0], of[1], of[2]);
        let mut all = Polytope::from_box(axis(&self.low), axis(&self.high));
        for i in 3..K {
            all.clip(Self::NORMALS[i], self.high[i]);
            all.clip(-Self::NORMALS[i], -self.low[i]);
        }
        all
    }
}

impl<const K: usize> Volume for Slabs<K> {
    type Ready = SlabRay<K>;

    fn around(points: &[DVec3]) -> Option<Self> {
        let mut all = Self { low: [f64::INFINITY; K], high: [f64::NEG_INFINITY; K] };
        for &point in points {
            let (heights, doubt) = Self::heights(point);
            for i in 0..K {
                // Along an axis nothing is rounded.
                let doubt = if i < 3 { 0.0 } else { doubt };
                all.low[i] = all.low[i].min(heights[i] - doubt);
                all.high[i] = all.high[i].max(heights[i] + doubt);
            }
        }
        (!points.is_empty()).then_some(all)
    }

    fn ready(line: &Line) -> SlabRay<K> {
        let ways = Self::NORMALS.map(|n| Across::new(line.origin, line.direction, n, 3.0));
        SlabRay { ways, far: line.origin.abs().max_element() }
    }

    fn meets(&self, line: &Line, ready: &SlabRay<K>) -> Option<f64> {
        let radius = (0..3).fold(0.0, |r: f64, i| r.max(self.low[i].abs()).max(self.high[i].abs()));
        // One coordinate of the direction is at least 1: beyond it the line is outside of the box.
        let reach = (ready.far + radius) * (1.0 + 4.0 * UNIT);
        let (mut enter, mut leave) = (line.t_min, line.t_max);
        for i in 0..K {
            let (near, far) = ready.ways[i].between(self.low[i], self.high[i], reach);
            enter = enter.max(near);
            leave = leave.min(far);
        }
        line.window(enter, leave)
    }

    fn contains(&self, point: DVec3) -> bool {
        let (heights, doubt) = Self::heights(point);
        (0..K).all(|i| {
            let doubt = if i < 3 { 0.0 } else { doubt };
            self.low[i] - doubt <= heights[i] && heights[i] <= self.high[i] + doubt
        })
    }

    fn half_area(&self) -> f64 {
        self.polytope().half_area()
    }

    fn volume(&self) -> f64 {
        self.polytope().volume()
    }
}
