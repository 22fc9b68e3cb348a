//! Approximate bounds of a triangle's parts between parallel planes, from the cuts of its edges.

use super::reference::Bounds;
use glam::Vec4;
use std::ops::RangeInclusive;

/// Compute the bounds of a reference's parts in a range of bins; `border` returns the lower border of a bin. They err
/// by f32 rounding. Earlier cuts across other axes are ignored.
#[inline(always)]
pub fn parts(
    corners: &[Vec4; 3],
    of: &Bounds,
    axis: usize,
    bins: RangeInclusive<usize>,
    border: impl Fn(usize) -> f32,
    mut give: impl FnMut(usize, &Bounds),
) {
    let edges = ChopEdges::new(corners, axis);
    let (first, last) = (*bins.start(), *bins.end());
    let (from, to) = (of.least().as_ref()[axis], of.greatest().as_ref()[axis]);
    // The first part begins at the reference's own border.
    let mut lower = if edges.at[0] < from { edges.section(from) } else { Bounds::point(edges.corners[0]) };
    let mut seen = usize::from(edges.at[1] < from);
    for bin in first..=last {
        let mut part = lower;
        let at = if bin < last { border(bin + 1) } else { to };
        if seen == 0 && edges.at[1] <= at {
            part.grow(&Bounds::point(edges.corners[1]));
            seen = 1;
        }
        lower = if edges.at[2] > at { edges.section(at) } else { Bounds::point(edges.corners[2]) };
        part.grow(&lower);
        let part = part.common(of);
        if !part.is_empty() {
            give(bin, &part);
        }
    }
}

/// A triangle's corners, sorted along an axis.
struct ChopEdges {
    corners: [Vec4; 3],
    at: [f32; 3],
    axis: usize,
}

impl ChopEdges {
    #[inline(always)]
    fn new(corners: &[Vec4; 3], axis: usize) -> Self {
        let at = |corner: &Vec4| corner.as_ref()[axis];
        let [mut a, mut b, mut c] = *corners;
        if at(&a) > at(&b) {
            (a, b) = (b, a);
        }
        if at(&b) > at(&c) {
            (b, c) = (c, b);
        }
        if at(&a) > at(&b) {
            (a, b) = (b, a);
        }
        Self { corners: [a, b, c], at: [at(&a), at(&b), at(&c)], axis }
    }

    /// The bounds of the triangle's intersection with a plane between its first and last corner.
    #[inline(always)]
    fn section(&self, at: f32) -> Bounds {
        let upper = usize::from(at > self.at[1]);
        let mut section = Bounds::point(self.cut(0, 2, at));
        section.grow(&Bounds::point(self.cut(upper, upper + 1, at)));
        section
    }

    /// The intersection of a plane with an edge.
    #[inline(always)]
    fn cut(&self, from: usize, to: usize, at: f32) -> Vec4 {
        let length = self.at[to] - self.at[from];
        let share = if length > 0.0 { (at - self.at[from]) / length } else { 0.0 };
        let mut cut = self.corners[from] + (self.corners[to] - self.corners[from]) * share;
        cut.as_mut()[self.axis] = at;
        cut
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::{Aabb, DVec3, Vec3};
    use raywright_shapes::triangle::clipped;

    fn point() -> impl Strategy<Value = Vec3> {
        let coordinate = || prop_oneof![4 => -1f32..1.0, 1 => (-2i32..=2).prop_map(|x| x as f32 / 2.0)];
        prop::array::uniform3(coordinate()).prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn parts_are_what_clipping_leaves(
            corners in [point(), point(), point()], axis in 0usize..3, count in 2usize..9,
        ) {
            let (min, max) =
                (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
            let width = (max[axis] - min[axis]) / count as f32;
            prop_assume!(width > 1e-3);
            let border = |bin: usize| min[axis] + width * bin as f32;
            let mut met = 0;
            let whole = Bounds::from(&Aabb { min, max });
            let wide = corners.map(|c| c.extend(0.0));
            parts(&wide, &whole, axis, 0..=count - 1, border, |bin, part| {
                met += 1;
                let mut slab = Aabb { min, max };
                (slab.min[axis], slab.max[axis]) = (border(bin), border(bin + 1).min(max[axis]));
                let (exact, part) = (clipped(corners.map(Vec3::as_dvec3), &slab), part.aabb());
                assert!((part.min - exact.min).abs().max_element() < 1e-5, "{part:?}, not {exact:?}");
                assert!((part.max - exact.max).abs().max_element() < 1e-5, "{part:?}, not {exact:?}");
            });
            prop_assert_eq!(met, count);
        }

        #[test]
        fn parts_of_pieces_hold_what_is_left(
            corners in [point(), point(), point()], ends in [point(), point()], axis in 0usize..3,
        ) {
            // A box around the triangle's center, which overlaps the triangle.
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let to = Aabb { min: middle - ends[0].abs(), max: middle + ends[1].abs() };
            let corners_of: [DVec3; 3] = corners.map(Vec3::as_dvec3);
            let piece = clipped(corners_of, &to);
            prop_assume!(!piece.is_empty());
            let width = (piece.max[axis] - piece.min[axis]) / 4.0;
            prop_assume!(width > 1e-3);
            let border = |bin: usize| piece.min[axis] + width * bin as f32;
            let mut found = [Aabb::EMPTY; 4];
            let wide = corners.map(|c| c.extend(0.0));
            parts(&wide, &Bounds::from(&piece), axis, 0..=3, border, |bin, part| found[bin] = part.aabb());
            for (bin, part) in found.iter().enumerate() {
                let mut slab = piece;
                (slab.min[axis], slab.max[axis]) = (border(bin), border(bin + 1).min(piece.max[axis]));
                let exact = clipped(corners_of, &slab);
                // Estimates may miss parts thinner than their error.
                if !exact.is_empty() && (exact.max - exact.min).min_element() > 1e-5 {
                    let grown = Aabb { min: part.min - Vec3::splat(1e-5), max: part.max + Vec3::splat(1e-5) };
                    prop_assert!(grown.contains(&exact), "{:?} does not hold {:?}", part, exact);
                    prop_assert!(piece.contains(part));
                }
            }
        }
    }
}
