//! What stands in glass.

use super::{Geometry, Material, Prototype};
use raywright_accel::Primitives;
use raywright_base::math::DVec3;
use std::ops::BitOr;

/// Which shapes may stand within what has an index of refraction of its own, or at its surface, as far as boxes tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Standing {
    /// Shapes that enclose nothing and scatter by what is around them.
    pub sheets: bool,
    /// Others that have an index of refraction of their own.
    pub glass: bool,
}

impl BitOr for Standing {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self { sheets: self.sheets | other.sheets, glass: self.glass | other.glass }
    }
}

/// A box from its least corner to its greatest.
type Extent = [DVec3; 2];

impl Standing {
    /// Of all shapes of a geometry, of these materials.
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

    /// Within a prototype.
    fn within(prototype: &Prototype) -> Self {
        Self::of(prototype.geometry(), prototype.appearances().map(|(material, _)| material))
    }
}

/// Whether anything in a prototype has an index of refraction of its own, and whether anything else scatters by what is
/// around it.
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

/// Whether two of some boxes have a point in common or, if there are others, one of some and one of the others: along
/// an axis, those that begin before another ends are looked at.
fn share(some: &[Extent], others: &[Extent]) -> bool {
    let mut all: Vec<(Extent, bool)> = some.iter().map(|&one| (one, false)).collect();
    all.extend(others.iter().map(|&one| (one, true)));
    if others.is_empty() && all.len() < 2 {
        return false;
    }
    all.sort_by(|(a, _), (b, _)| a[0].x.total_cmp(&b[0].x));
    all.iter().enumerate().any(|(i, (a, is_other))| {
        let near = all[i + 1..].iter().take_while(|(b, _)| b[0].x <= a[1].x);
        let mut counted = near.filter(|(_, other)| if others.is_empty() { true } else { other != is_other });
        counted.any(|(b, _)| a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all())
    })
}
