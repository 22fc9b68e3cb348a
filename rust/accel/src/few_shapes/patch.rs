//! Triangles and quadrilaterals, prepared as patches of a plane with edges as lines.

use super::unit;
use raywright_base::math::DVec3;

/// Half of the distance between neighboring f32 numbers in [1, 2).
pub(super) const UNIT: f32 = 1.0 / (1u32 << 24) as f32;

/// A 2D line as a normal and an offset: a point's signed distance is its dot product with the normal, less the offset.
pub(super) type EdgeLine = ([f32; 2], f32);

/// A triangle, or a convex planar quadrilateral of two triangles, projected along an axis.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// The two axes of the projection, and the axis most parallel to the normal.
    pub axes: [usize; 3],
    /// The plane: `slopes` · (coordinates along the first two axes) + coordinate along the third = `height`.
    pub slopes: [f32; 2],
    pub height: f32,
    /// Its part of all error bounds ([`super::test`]).
    pub unit: f32,
    pub outline: Outline,
    /// Its edges, as lines with the patch on their negative side. Of a parallelogram, the first two pass through its
    /// center.
    pub edges: [EdgeLine; 4],
    /// Distances from the center of a parallelogram to its edges.
    pub reach: [f32; 2],
    /// The diagonal of two triangles, with the first on its negative side.
    pub diagonal: EdgeLine,
    /// The triangles, and their primitives; of one triangle, twice the same.
    pub halves: [Option<Half>; 2],
    pub primitives: [u32; 2],
}

/// The shape of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outline {
    Triangle,
    Parallelogram,
    Quadrilateral,
}

/// One of the triangles of a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Half {
    pub primitive: u32,
    pub corners: [DVec3; 3],
}

/// The corners in order of the quadrilateral that two triangles form; the first and the third belong to one triangle
/// each. `None` if it is not convex, or not planar to within f32 rounding.
pub(super) fn outline(halves: &[Half; 2]) -> Option<[DVec3; 4]> {
    let [first, second] = halves;
    let (a, b) = (first.corners, second.corners);
    let [own, other] = shared(a, b)?;
    let all = [a[own], a[(own + 1) % 3], b[other], a[(own + 2) % 3]];
    let normal = (a[1] - a[0]).cross(a[2] - a[0]).try_normalize()?;
    let is_flat = normal.dot(b[other] - a[own]).abs() <= 2.0 * f64::from(UNIT) * extent(halves);
    let turns = |i: usize| (all[(i + 1) % 4] - all[i]).cross(all[(i + 2) % 4] - all[(i + 1) % 4]).dot(normal) > 0.0;
    (is_flat && (0..4).all(turns)).then_some(all)
}

/// The largest coordinate of some triangles.
fn extent(halves: &[Half]) -> f64 {
    let sizes = halves.iter().flat_map(|half| half.corners).map(|corner| corner.abs().max_element());
    sizes.fold(0.0, f64::max)
}

/// The unshared corner of each of two triangles, if they share the other two.
fn shared(a: [DVec3; 3], b: [DVec3; 3]) -> Option<[usize; 2]> {
    let own = |of: [DVec3; 3], other: [DVec3; 3]| {
        let mut own = (0..3).filter(|&i| !other.contains(&of[i]));
        own.next().filter(|_| own.next().is_none())
    };
    Some([own(a, b)?, own(b, a)?])
}

impl Patch {
    /// `None` for degenerate triangles.
    pub fn new(halves: [Option<Half>; 2]) -> Option<Self> {
        let [a, b, c] = halves[0]?.corners;
        let extent = halves.iter().flatten().map(|half| extent(&[*half])).fold(0.0, f64::max);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let z = if normal.x.abs() == normal.abs().max_element() {
            0
        } else {
            if normal.y.abs() > normal.z.abs() { 1 } else { 2 }
        };
        let [x, y] = [(z + 1) % 3, (z + 2) % 3];
        // Seen from the normal's side, or mirrored.
        let turn = 1f64.copysign(normal[z]);
        let line = |from: DVec3, to: DVec3| -> EdgeLine {
            let along = to - from;
            let (across_x, across_y) = (turn * along[y], -turn * along[x]);
            let length = across_x.hypot(across_y);
            let (across_x, across_y) = (across_x / length, across_y / length);
            ([across_x as f32, across_y as f32], (across_x * from[x] + across_y * from[y]) as f32)
        };
        let first = halves[0]?.primitive;
        let (outline, edges, reach, diagonal, primitives) = match halves {
            [Some(one), Some(other)] => {
                let all = outline(&[one, other])?;
                let mut edges = [0, 1, 2, 3].map(|i| line(all[i], all[(i + 1) % 4]));
                let (center, skew) = (0.5 * (all[0] + all[2]), all[0] - all[1] + all[2] - all[3]);
                let mut reach = [0.0; 2];
                let is_parallelogram = skew.abs().max_element() <= 2.0 * f64::from(UNIT) * extent;
                if is_parallelogram {
                    for (i, reach) in reach.iter_mut().enumerate() {
                        edges[i] = line(center, center + all[i + 1] - all[i]);
                        let across = edges[i].0.map(f64::from);
                        let from = all[i] - center;
                        *reach = (across[0] * from[x] + across[1] * from[y]).abs() as f32;
                    }
                }
                let outline = if is_parallelogram { Outline::Parallelogram } else { Outline::Quadrilateral };
                (outline, edges, reach, line(all[1], all[3]), [first, other.primitive])
            }
            _ => {
                let edges = [line(a, b), line(b, c), line(c, a), line(c, a)];
                (Outline::Triangle, edges, [0.0; 2], line(a, b), [first; 2])
            }
        };
        let slopes = [normal[x] / normal[z], normal[y] / normal[z]];
        let height = slopes[0] * a[x] + slopes[1] * a[y] + a[z];
        let slopes = slopes.map(|slope| slope as f32);
        Some(Self {
            axes: [x, y, z],
            slopes,
            height: height as f32,
            unit: unit(extent as f32),
            outline,
            edges,
            reach,
            diagonal,
            halves,
            primitives,
        })
    }
}
