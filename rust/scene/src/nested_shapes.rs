//! Detection of shapes inside other dielectrics.

use super::{Geometry, Material, Prototype};
use raywright_accel::Primitives;
use raywright_base::math::DVec3;
use std::ops::BitOr;

/// Flags for shapes that may be inside an interior or touch it, by their boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Standing {
    /// A sheet without interior whose BSDF depends on its surroundings.
    pub sheets: bool,
    /// A second interior with its own index of refraction.
    pub glass: bool,
}

impl BitOr for Standing {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self { sheets: self.sheets | other.sheets, glass: self.glass | other.glass }
    }
}

/// A box by its lower and upper corner.
type Extent = [DVec3; 2];

impl Standing {
    /// Computes the flags of all shapes of a geometry with these materials.
    pub fn of<'a>(geometry: &Geometry, materials: impl Iterator<Item = &'a dyn Material>) -> Self {
        let (mut glass, mut sheets) = (Vec::new(), Vec::new());
        let mut found = Self::default();
        for (shape, material) in (0u32..).zip(materials) {
            let boxes = geometry.primitives_of(shape).filter_map(|one| geometry.bounds(one));
            let boxes = boxes.map(|bounds| [bounds.min, bounds.max]);
            match geometry.instances_of(shape) {
                Some(instances) => {
                    let prototype = instances.prototype();
                    found = found | Self::within(prototype);
                    let [is_glass, is_sheet] = contents(prototype);
                    if is_glass || is_sheet {
                        let boxes: Vec<Extent> = boxes.collect();
                        glass.extend(boxes.iter().filter(|_| is_glass));
                        sheets.extend(boxes.iter().filter(|_| is_sheet && !is_glass));
                    }
                }
                None if material.interior().is_some() => glass.extend(boxes.reduce(union)),
                None if material.minds_outside() => sheets.extend(boxes.reduce(union)),
                None => {}
            }
        }
        let count = glass.len();
        glass.extend(sheets);
        let (glass, sheets) = glass.split_at(count);
        found | Self { sheets: share(glass, sheets), glass: share(glass, &[]) }
    }

    /// Computes the flags within a prototype.
    fn within(prototype: &Prototype) -> Self {
        Self::of(prototype.geometry(), prototype.appearances().map(|(material, _)| material))
    }
}

/// Returns whether a prototype contains an interior, and whether it contains a sheet whose BSDF depends on its
/// surroundings.
fn contents(prototype: &Prototype) -> [bool; 2] {
    let geometry = prototype.geometry();
    let each =
        prototype.appearances().enumerate().map(|(shape, (material, _))| match geometry.instances_of(shape as u32) {
            Some(instances) => contents(instances.prototype()),
            None => [material.interior().is_some(), material.minds_outside()],
        });
    each.fold([false; 2], |[a, b], [c, d]| [a | c, b | d])
}

fn union(a: Extent, b: Extent) -> Extent {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Boxes nearer than this share of their greatest coordinate count as overlapping: several times the reach within
/// which surfaces are one boundary ([`super::RayOrigin::reach`]).
const NEAR: f64 = 1e-10;

/// Returns whether any two of `some` boxes overlap or, with `others`, one of each. A sweep along an axis tests boxes
/// that begin before another ends.
fn share(some: &[Extent], others: &[Extent]) -> bool {
    let widened = |&[low, high]: &Extent| {
        let room = NEAR * low.abs().max(high.abs()).max_element();
        [low - room, high + room]
    };
    let mut all: Vec<(Extent, bool)> = some.iter().map(|one| (widened(one), false)).collect();
    all.extend(others.iter().map(|one| (widened(one), true)));
    if others.is_empty() && all.len() < 2 {
        return false;
    }
    all.sort_unstable_by(|(a, _), (b, _)| a[0].x.total_cmp(&b[0].x));
    all.iter().enumerate().any(|(i, (a, is_other))| {
        let near = all[i + 1..].iter().take_while(|(b, _)| b[0].x <= a[1].x);
        let mut counted = near.filter(|(_, other)| if others.is_empty() { true } else { other != is_other });
        counted.any(|(b, _)| a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all())
    })
}
