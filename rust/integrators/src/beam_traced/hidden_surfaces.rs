//! Hidden surface removal.
//!
//! Two visible planes have equal nearness on a straight line, and one is nearer on each side of it. So the part of a
//! face hidden by another is convex: the inside of the other's outline on that side. It is subtracted from the face's
//! outline, after Weiler and Atherton ("Hidden Surface Removal Using Polygon Area Sorting", 1977). No sorting is
//! needed, and intersecting faces need no special case.

use super::beam::{LEAST, VisibleFace};
use raywright_base::math::convex::{Convex, HalfPlane, area, take_out};
use raywright_base::workers::Cancel;

/// Return the visible part of a face, as disjoint convex polygons.
pub(super) fn visible(all: &[VisibleFace], which: usize, cancel: &Cancel) -> Vec<Convex> {
    let mine = &all[which];
    let mut parts = vec![mine.outline.clone()];
    for (number, other) in all.iter().enumerate() {
        if number == which || !overlap(mine, other) {
            continue;
        }
        let Some(nearer) = nearer(mine, other) else { continue };
        let region: Vec<HalfPlane> = nearer.into_iter().chain(other.sides.iter().copied()).collect();
        let mut left = Vec::with_capacity(parts.len());
        for part in parts {
            take_out(part, &region, &mut left);
        }
        left.retain(|part| area(part) > LEAST);
        parts = left;
        if parts.is_empty() || cancel.is_raised() {
            break;
        }
    }
    parts
}

/// Return whether the bounding rectangles of two faces overlap.
fn overlap(a: &VisibleFace, b: &VisibleFace) -> bool {
    a.bounds[0].cmplt(b.bounds[1]).all() && b.bounds[0].cmplt(a.bounds[1]).all()
}

/// Return the half-plane where another face is in front; `None` if nowhere, and no half-plane if everywhere. Of
/// coplanar faces the one with the lower index is in front.
fn nearer(mine: &VisibleFace, other: &VisibleFace) -> Option<Option<HalfPlane>> {
    let line = other.nearness - mine.nearness;
    let size = other.nearness.abs() + mine.nearness.abs();
    let (mut least, mut most, mut noise) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
    for corner in &mine.outline {
        let value = line.dot(corner.extend(1.0));
        (least, most) = (least.min(value), most.max(value));
        noise = noise.max(size.dot(corner.abs().extend(1.0)));
    }
    let slack = 1e-13 * noise;
    if most <= slack {
        let is_first = least >= -slack && other.primitive < mine.primitive;
        return is_first.then_some(None);
    }
    Some((least < -slack).then_some(HalfPlane { line, slack }))
}
