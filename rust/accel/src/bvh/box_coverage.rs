//! Test whether boxes together cover a primitive.

use raywright_base::math::{Aabb, Vec3};

/// Maximum undetected gap between boxes, relative to the largest coordinate.
const GAP: f32 = 1.0 / (1u32 << 20) as f32;

/// Return whether boxes together cover a primitive with the box `whole`; `clip` bounds its part in a box.
///
/// The primitive's box is split along faces of the boxes until each piece is empty of the primitive, inside one of the
/// boxes, or not cut by any face. The boxes are first enlarged by 2⁻²⁰ of the largest coordinate, many times the error
/// of `clip`. Otherwise a piece beyond a face at the primitive's border might seem nonempty.
pub fn cover(boxes: &[Aabb], whole: &Aabb, clip: impl Fn(&Aabb) -> Aabb) -> bool {
    let gap = Vec3::splat(GAP * whole.min.abs().max(whole.max.abs()).max_element());
    let boxes: Vec<_> = boxes.iter().map(|b| Aabb { min: b.min - gap, max: b.max + gap }).collect();
    let mut open = vec![*whole];
    while let Some(piece) = open.pop() {
        let part = clip(&piece);
        if part.is_empty() || boxes.iter().any(|b| b.contains(&part)) {
            continue;
        }
        match boxes.iter().filter(|b| !b.intersection(part).is_empty()).find_map(|b| face(b, &part)) {
            Some((axis, at)) => {
                let (mut below, mut above) = (part, part);
                (below.max[axis], above.min[axis]) = (at, at);
                open.extend([below, above]);
            }
            None => return false,
        }
    }
    true
}

/// A face of a box that splits another one: its axis and position.
fn face(of: &Aabb, cut: &Aabb) -> Option<(usize, f32)> {
    let faces = (0..3).flat_map(|axis| [(axis, of.min[axis]), (axis, of.max[axis])]);
    faces.into_iter().find(|&(axis, at)| cut.min[axis] < at && at < cut.max[axis])
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::DVec3;
    use raywright_shapes::triangle::clipped;

    fn a_box(min: [f32; 3], max: [f32; 3]) -> Aabb {
        Aabb { min: Vec3::from(min), max: Vec3::from(max) }
    }

    #[test]
    fn what_fills_its_box_needs_all_of_it() {
        let whole = a_box([0.0; 3], [1.0; 3]);
        let (left, right) = (a_box([0.0; 3], [0.5, 1.0, 1.0]), a_box([0.5, 0.0, 0.0], [1.0; 3]));
        let fills = |to: &Aabb| whole.intersection(*to);
        assert!(cover(&[left, right], &whole, fills) && cover(&[whole], &whole, fills));
        assert!(!cover(&[left], &whole, fills) && !cover(&[], &whole, fills));
        let short = a_box([0.5, 0.0, 0.0], [1.0, 1.0, 0.99]);
        assert!(!cover(&[left, short], &whole, fills));
    }

    #[test]
    fn a_diagonal_needs_what_it_passes() {
        let corners = [DVec3::ZERO, DVec3::ONE, DVec3::splat(0.25)];
        let whole = a_box([0.0; 3], [1.0; 3]);
        let along = |at: f32, size: f32| a_box([at; 3], [at + size; 3]);
        let clip = |to: &Aabb| clipped(corners, to);
        assert!(cover(&[along(0.0, 0.5), along(0.5, 0.5)], &whole, clip));
        assert!(!cover(&[along(0.0, 0.5), along(0.5, 0.45)], &whole, clip));
        assert!(!cover(&[along(0.0, 0.45), along(0.5, 0.5)], &whole, clip));
    }
}
