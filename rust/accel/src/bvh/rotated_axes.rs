//! Rotated axes along which triangles fill their boxes better than along the scene's axes.
//!
//! Rectangular geometry fits boxes along its own axes, and fills little of them along others. A room rotated by 45°
//! then takes several times the traversal time of an aligned one, or several times the memory if long primitives are
//! split. Rotating the rays is cheaper. So if boxes are much larger than their content, the frames of sampled triangles
//! are tried: a side, the perpendicular to it in the plane, and the normal. In rectangular geometry, half of the
//! triangles have the right frame. (One frame per box: Gottschalk, Lin and Manocha, "OBBTree", 1996.)
//!
//! The criterion is the total surface area of the boxes, to which the expected number of hit boxes is proportional.

use super::build::reference::SHARE;
use raywright_base::math::{Aabb, Axes, DVec3};
use raywright_base::parallel;
use std::ops::Range;

/// Other axes are used if they reduce the surface area to this fraction or less. For sticks along all four diagonals,
/// axes along one of them save a half, and splitting the sticks saves more.
pub const WORTHWHILE: f64 = 1.0 / 3.0;

/// Scenes with at most this many triangles have so few boxes that their axes do not matter.
const FEW: usize = 64;

/// Sample size for comparing axes.
const SAMPLE: usize = 1024;

/// The number of sampled triangles that propose frames, and the number used for their first comparison.
const TRIED: usize = 64;
const BY: usize = 128;

/// The number of frames compared on the whole sample.
const BEST: usize = 8;

/// A sampled triangle.
#[derive(Clone, Copy)]
struct Sampled {
    /// Two of its sides, in units in which its box along the scene's axes has a surface of 2.
    sides: [DVec3; 2],
}

impl Sampled {
    /// Its surface area along given axes, relative to the scene's.
    fn area(&self, axes: &Axes) -> f64 {
        let [b, c] = self.sides.map(|side| axes.to(side));
        let size = b.max(c).max(DVec3::ZERO) - b.min(c).min(DVec3::ZERO);
        (size.x * size.y + size.y * size.z + size.z * size.x) / (Axes::SCALE * Axes::SCALE)
    }

    /// A lower bound of its surface area along any axes: two opposite sides of a box contain a parallelogram of twice
    /// the triangle's area.
    fn least(&self) -> f64 {
        self.sides[0].cross(self.sides[1]).length()
    }

    /// The frames of its three sides.
    fn frames(self) -> impl Iterator<Item = Axes> {
        let [b, c] = self.sides;
        [(b, c), (c, b), (c - b, b)].into_iter().filter_map(|(along, beside)| Axes::new(along, beside))
    }
}

/// The axes with the least surface area of the triangles' boxes, if the sample shows a sufficient gain. `boxes` are
/// those along the scene's axes, empty for other primitives.
///
/// The result does not depend on the number of threads.
pub fn find(boxes: &[Aabb], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Option<Axes> {
    let sample = sample(boxes, corners);
    let mean =
        |sample: &[Sampled], area: &dyn Fn(&Sampled) -> f64| sample.iter().map(area).sum::<f64>() / sample.len() as f64;
    if sample.is_empty() || mean(&sample, &Sampled::least) > WORTHWHILE {
        return None;
    }
    let some = |count: usize| sample.iter().step_by(sample.len().div_ceil(count)).copied();
    let by: Vec<_> = some(BY).collect();
    let mut frames: Vec<_> =
        some(TRIED).flat_map(Sampled::frames).map(|axes| (mean(&by, &|one| one.area(&axes)), axes)).collect();
    frames.sort_by(|a, b| a.0.total_cmp(&b.0));
    let judged = frames.iter().take(BEST).map(|(_, axes)| (mean(&sample, &|one| one.area(axes)), *axes));
    let (area, axes) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (area <= WORTHWHILE).then_some(axes)
}

/// Sample triangles in proportion to the surface area of their boxes, so that the mean of the areas' ratios is the
/// ratio of the total areas. Empty for few triangles.
fn sample(boxes: &[Aabb], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Vec<Sampled> {
    let area = |b: &Aabb| if b.is_empty() { 0.0 } else { f64::from(b.half_area()) };
    if boxes.len() <= FEW {
        return Vec::new();
    }
    // Prefix sums of the surface area over chunks of boxes.
    let of_share = |share: Range<usize>| boxes[share].iter().map(area).sum::<f64>();
    let mut shares = parallel::map_chunks(boxes.len(), SHARE, of_share);
    let mut before = 0.0;
    for share in &mut shares {
        before += std::mem::replace(share, before);
    }
    let step = before / SAMPLE as f64;
    if step <= f64::MIN_POSITIVE {
        return Vec::new();
    }
    let of_share = |share: Range<usize>| {
        let mut at = shares[share.start / SHARE];
        let (mut of_share, mut next) = (Vec::new(), ((at / step).floor() + 1.0) * step);
        for (p, aabb) in share.clone().zip(&boxes[share]) {
            let own = area(aabb);
            at += own;
            while own > 0.0 && at >= next {
                let [a, b, c] = corners(p as u32);
                let scale = 1.0 / own.sqrt();
                of_share.push(Sampled { sides: [(b - a) * scale, (c - a) * scale] });
                next += step;
            }
        }
        of_share
    };
    parallel::map_chunks(boxes.len(), SHARE, of_share).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::Region;
    use raywright_base::sampling::philox4x32;
    use raywright_base::workers;

    /// A vector in [−1, 1]³.
    fn triple(i: u32) -> DVec3 {
        let [x, y, z, _] = philox4x32([i, 0, 0, 0], [3, 3]).map(|bits| f64::from(bits) / f64::from(1u32 << 31) - 1.0);
        DVec3::new(x, y, z)
    }

    /// Long thin right triangles along given axes, and as many small ones of any orientation.
    fn sticks(axes: [DVec3; 3], count: u32) -> Vec<[DVec3; 3]> {
        let stick = |i: u32| {
            let (from, way) = (triple(i), i as usize % 3);
            let aside = axes[(way + 1 + i as usize / 3 % 2) % 3];
            [from, from + 0.5 * axes[way], from + 0.003 * aside]
        };
        let crumb = |i: u32| [0, 1, 2].map(|k| triple(i) + 0.003 * triple(3 * i + k + 50_000));
        (0..count).map(stick).chain((0..count).map(|i| crumb(i + 10_000))).collect()
    }

    fn found(triangles: &[[DVec3; 3]]) -> Option<Axes> {
        let region = Region::around(triangles.iter().flatten().copied());
        let boxes: Vec<_> = triangles.iter().map(|&corners| region.aabb(corners)).collect();
        let find = || find(&boxes, |p| triangles[p as usize].map(|c| region.to_box(c)));
        let [one, three] = [1, 3].map(|threads| workers::pool(Some(threads)).unwrap().install(find));
        assert_eq!(one, three);
        one
    }

    #[test]
    fn sticks_at_right_angles_say_how_they_lie() {
        for turn in 0..5 {
            let x = triple(turn + 90_000).normalize();
            let y = x.cross(triple(turn + 91_000)).normalize();
            let own = [x, y, x.cross(y)];
            for count in [33, 20_000] {
                let axes = found(&sticks(own, count)).unwrap();
                for stick in own {
                    // Parallel to one axis exactly.
                    let along = axes.to(stick).abs();
                    assert!((along.max_element() - Axes::SCALE).abs() < 1e-9, "{axes:?}, {own:?}");
                    assert!((along.element_sum() - Axes::SCALE).abs() < 1e-9, "{axes:?}, {own:?}");
                }
            }
        }
    }

    #[test]
    fn what_lies_along_the_axes_or_any_way_stays_as_it_is() {
        let straight = [DVec3::X, DVec3::Y, DVec3::Z];
        assert_eq!(found(&sticks(straight, 3000)), None);
        let any_way: Vec<_> = (0..3000)
            .map(|i| {
                let (from, along) = (triple(i), 0.3 * triple(i + 20_000).normalize());
                [from, from + along, from + 0.01 * along.any_orthonormal_vector()]
            })
            .collect();
        assert_eq!(found(&any_way), None);
        let small: Vec<_> = (0..3000).map(|i| [0, 1, 2].map(|k| triple(i) + 0.01 * triple(3 * i + k + 5000))).collect();
        assert_eq!(found(&small), None);
        let turned = [DVec3::new(0.6, 0.8, 0.0), DVec3::new(-0.8, 0.6, 0.0), DVec3::Z];
        assert_eq!(found(&sticks(turned, 32)), None, "few");
        assert_eq!(found(&[]), None);
        assert_eq!(found(&[[DVec3::ONE; 3]; 100]), None, "without area");
        assert_eq!(found(&[[DVec3::ZERO, DVec3::ONE, DVec3::ONE * 2.0]; 100]), None, "without triangles");
    }
}
