//! What of each face is seen: all that no other face is before.
//!
//! Where two planes are seen, the one is nearer on one side of a straight line, that on which their nearness is equal.
//! So what a face hides of another is convex: what lies within its outline, and on that side. It is taken out of the
//! other's outline, after Weiler and Atherton ("Hidden Surface Removal Using Polygon Area Sorting", 1977), and nothing
//! has to be sorted, nor do faces that pass through each other make a difference.

use super::beam::{LEAST, Seen};
use raywright_base::math::convex::{Convex, HalfPlane, area, take_out};
use raywright_base::workers::Cancel;

/// What of one of some faces is seen, in convex parts that do not overlap.
pub(super) fn visible(all: &[Seen], which: usize, cancel: &Cancel) -> Vec<Convex> {
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

/// Whether the rectangles around two faces share something.
fn overlap(a: &Seen, b: &Seen) -> bool {
    a.bounds[0].cmplt(b.bounds[1]).all() && b.bounds[0].cmplt(a.bounds[1]).all()
}

/// Where another face is before one; `None` if nowhere, and no half-plane if everywhere. Of faces in one plane, the one
/// with the lower number is.
fn nearer(mine: &Seen, other: &Seen) -> Option<Option<HalfPlane>> {
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
