//! Test whether an implicit surface is closed within its box.

use super::Bounds;
use super::tape::Tape;
use raywright_base::math::Interval;

/// Maximum depth of quartering a face of the box if interval arithmetic leaves its sign open.
const DEPTH: u32 = 6;

/// Return whether the function's sign is constant on the faces of the box.
///
/// Interval arithmetic excludes parts of a face. At the maximum depth the signs at the corners decide, so a surface
/// that only touches the box counts as closed.
pub fn is_closed(tape: &Tape, bounds: &Bounds) -> bool {
    let [min, max] = [bounds.min.to_array(), bounds.max.to_array()];
    (0..3).all(|axis| {
        [min[axis], max[axis]].into_iter().all(|at| {
            let mut face = [0, 1, 2].map(|k| [min[k], max[k]]);
            face[axis] = [at; 2];
            keeps_its_sign(tape, face, axis, DEPTH)
        })
    })
}

/// Return whether the sign is constant over a rectangle normal to an axis.
fn keeps_its_sign(tape: &Tape, ends: [[f64; 2]; 3], axis: usize, depth: u32) -> bool {
    let over = ends.map(|[low, high]| Interval::new(low, high));
    if !tape.value(&over, &mut Vec::new()).contains(0.0) {
        return true;
    }
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let corner = |i: usize, j: usize| {
        let mut at = ends.map(|[low, _]| low);
        (at[u], at[v]) = (ends[u][i], ends[v][j]);
        tape.value(&at, &mut Vec::new())
    };
    let corners = [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)];
    if corners.iter().any(|&value| value < 0.0) && corners.iter().any(|&value| value > 0.0) {
        return false;
    }
    let middle = |k: usize| 0.5 * ends[k][0] + 0.5 * ends[k][1];
    depth == 0
        || [0, 1].into_iter().all(|i| {
            [0, 1].into_iter().all(|j| {
                let mut part = ends;
                part[u][1 - i] = middle(u);
                part[v][1 - j] = middle(v);
                keeps_its_sign(tape, part, axis, depth - 1)
            })
        })
}
