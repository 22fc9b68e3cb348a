//! The bounds of a light tree's children in columns, and their importance to a receiver.
//!
//! Importances are f32. They only have to be the same in a draw and in its probability, and above 0 wherever light
//! arrives: what is near a limit counts as within it.

use super::{LightBounds, LightSampleContext};
use raywright_base::math::single::{choose, greater, lesser, mask};
use raywright_base::math::{LANES, SingleLanes, VectorLanes};
use raywright_base::simd::{Level, loops};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Bounds of up to eight children ([`LightBounds`]). Lengths but those of the centers are in the tree's unit, half of
/// the extent of all lights.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct WideBounds {
    /// Center of each box in the world, by axis.
    centre: [[f64; WIDTH]; 3],
    /// Radius of the sphere around each box, and its square.
    radius: [f32; WIDTH],
    square: [f32; WIDTH],
    axis: [[f32; WIDTH]; 3],
    /// Cosine and sine of the half angle of the normal cone.
    cos_cone: [f32; WIDTH],
    sin_cone: [f32; WIDTH],
    /// All bits if there is a normal cone.
    has_cone: [u32; WIDTH],
    cos_reach: [f32; WIDTH],
    intensity: [f32; WIDTH],
    /// Least importance where light may arrive; 0 if there is no child.
    least: [f32; WIDTH],
}

/// Importance of each child to a receiver.
pub(super) struct Importances([f32; WIDTH]);

/// A receiver in f32: its unit normal, or all bits if light reaches it from all directions.
struct Receiver {
    position: [f64; 3],
    normal: [f32; 3],
    is_free: u32,
    scale: f64,
}

/// Cosines that are less than a limit by no more count as within it: several times their rounding.
const ROUNDING: f32 = 2e-6;

/// Importances are between these, so that no sum of them is 0 or infinite.
const RANGE: [f32; 2] = [1e-30, 1e30];

impl WideBounds {
    /// The bounds of up to eight children, with the scale from the world to the tree's unit.
    pub fn new<'a>(children: impl Iterator<Item = &'a LightBounds>, scale: f64) -> Self {
        let none = [0.0; WIDTH];
        let mut wide = Self {
            centre: [[0.0; WIDTH]; 3],
            radius: none,
            square: none,
            axis: [none; 3],
            cos_cone: none,
            sin_cone: none,
            has_cone: [0; WIDTH],
            cos_reach: none,
            intensity: none,
            least: none,
        };
        for (i, bounds) in children.enumerate() {
            let centre = bounds.centre();
            let radius = (0.5 * (bounds.max * scale - bounds.min * scale).length()) as f32;
            for axis in 0..3 {
                wide.centre[axis][i] = centre[axis];
                wide.axis[axis][i] = bounds.axis[axis] as f32;
            }
            (wide.radius[i], wide.square[i]) = (radius, radius * radius);
            wide.cos_cone[i] = bounds.cos_cone as f32;
            wide.sin_cone[i] = (1.0 - bounds.cos_cone * bounds.cos_cone).max(0.0).sqrt() as f32;
            wide.has_cone[i] = mask(bounds.cos_cone > -1.0);
            wide.cos_reach[i] = bounds.cos_reach as f32 - ROUNDING;
            wide.intensity[i] = bounds.intensity as f32;
            wide.least[i] = RANGE[0];
        }
        wide
    }

    /// Estimates of the contribution of each child; 0 only if there is none.
    #[inline]
    pub fn importances(&self, level: Level, scale: f64, receiver: &LightSampleContext) -> Importances {
        let receiver = Receiver {
            position: receiver.position.to_array(),
            normal: receiver.normal.as_vec3().to_array(),
            is_free: mask(receiver.is_free()),
            scale,
        };
        let mut found = Importances([0.0; WIDTH]);
        importances(level, self, &receiver, &mut found.0);
        found
    }
}

impl WideBounds {
    /// Estimate of the contribution of a child. All light is placed at the centers. The angles to the lights' normals
    /// and to the receiver's horizon are the most favorable within the bounds. Sines and cosines are multiplied by the
    /// distance, which avoids divisions and keeps the square roots independent.
    #[inline(always)]
    fn importance(&self, i: usize, receiver: &Receiver) -> f32 {
        let Receiver { position, normal, is_free, scale } = receiver;
        let x = ((position[0] - self.centre[0][i]) * scale) as f32;
        let y = ((position[1] - self.centre[1][i]) * scale) as f32;
        let z = ((position[2] - self.centre[2][i]) * scale) as f32;
        let square = x * x + y * y + z * z;
        let inverse = 1.0 / square;
        let (sin_ball, cos_ball) = (self.radius[i], greater(square - self.square[i], 0.0).sqrt());
        // The angle to the nearest normal, reduced by the angle of the bounding sphere.
        let cos = self.axis[0][i] * x + self.axis[1][i] * y + self.axis[2][i] * z;
        let sin = greater(square - cos * cos, 0.0).sqrt();
        let (cos_cone, sin_cone) = (self.cos_cone[i], self.sin_cone[i]);
        let (sin_off, cos_off) = (sin * cos_cone - cos * sin_cone, cos * cos_cone + sin * sin_cone);
        let nearest = (cos_off * cos_ball + sin_off * sin_ball) * inverse;
        let nearest = choose(mask(cos_off >= cos_ball), 1.0, nearest);
        let nearest = choose(mask(cos >= cos_cone * square.sqrt()), 1.0, nearest);
        let is_missed = mask(nearest < self.cos_reach[i]) & self.has_cone[i];
        let emitted = self.intensity[i] * inverse * choose(self.has_cone[i], nearest, 1.0);
        // The same at the receiver.
        let cos = -(normal[0] * x + normal[1] * y + normal[2] * z);
        let sin = greater(square - cos * cos, 0.0).sqrt();
        let above = (cos * cos_ball + sin * sin_ball) * inverse;
        let above = choose(mask(cos >= cos_ball) | *is_free, 1.0, above) + ROUNDING;
        let is_missed = is_missed | mask(above < 0.0);
        // Within the sphere around the box every direction is possible.
        let is_within = mask(square <= self.square[i]);
        let importance = choose(is_within, self.intensity[i] / self.square[i], emitted * above);
        // NaN at the center of a light without extent, where the first is the least.
        let importance = choose(mask(importance > self.least[i]), importance, self.least[i]);
        choose(is_missed & !is_within, 0.0, lesser(importance, RANGE[1]))
    }
}

loops! {
    fn importances(of: &WideBounds, receiver: &Receiver, found: &mut [f32; WIDTH]) {
        for i in 0..WIDTH {
            found[i] = of.importance(i, receiver);
        }
    }
}

/// Children that were chosen for sixteen receivers.
pub(super) struct ChosenLanes {
    /// Undefined where no child contributes.
    pub lane: [u32; LANES],
    /// The probability of each; 0 where no child contributes.
    pub share: [f64; LANES],
}

loops! {
    /// [`Importances::choose`] for sixteen receivers of normals that are 0 if light reaches them from all directions.
    pub(super) fn choose_children(
        of: &WideBounds,
        count: usize,
        scale: f64,
        position: &VectorLanes,
        normal: &SingleLanes,
        u: &[f64; LANES],
        chosen: &mut ChosenLanes,
    ) {
        let mut found = [[0.0; LANES]; WIDTH];
        let mut sum = [0.0; LANES];
        for child in 0..count.min(WIDTH) {
            for i in 0..LANES {
                let normal = normal.get(i);
                let receiver = Receiver {
                    position: position.get(i).to_array(),
                    normal: normal.to_array(),
                    is_free: mask(normal.x == 0.0) & mask(normal.y == 0.0) & mask(normal.z == 0.0),
                    scale,
                };
                found[child][i] = of.importance(child, &receiver);
            }
            for i in 0..LANES {
                sum[i] += f64::from(found[child][i]);
            }
        }
        let (mut rest, mut kept, mut number) = ([0.0; LANES], [0.0; LANES], [0; LANES]);
        for i in 0..LANES {
            rest[i] = u[i] * sum[i];
        }
        // Among those that contribute, the first with less before it, or the last.
        let mut is_open = [u32::MAX; LANES];
        for child in 0..count.min(WIDTH) {
            let importances = found[child];
            for i in 0..LANES {
                let here = is_open[i] & mask(importances[i] > 0.0);
                number[i] = child as u32 & here | number[i] & !here;
                kept[i] = choose(here, importances[i], kept[i]);
                is_open[i] &= !(here & mask(rest[i] < f64::from(importances[i])));
            }
            for i in 0..LANES {
                rest[i] -= f64::from(choose(is_open[i], importances[i], 0.0));
            }
        }
        for i in 0..LANES {
            chosen.lane[i] = number[i];
            chosen.share[i] = if sum[i] > 0.0 { f64::from(kept[i]) / sum[i] } else { 0.0 };
        }
    }
}

impl Importances {
    fn sum(&self) -> f64 {
        self.0.iter().map(|&importance| f64::from(importance)).sum()
    }

    /// Probability of a child.
    pub fn share(&self, lane: usize) -> f64 {
        let sum = self.sum();
        if sum > 0.0 { f64::from(self.0[lane]) / sum } else { 0.0 }
    }

    /// Selects a child by a number in [0, 1), which it leaves as one; returns it with its probability. `None` if none
    /// contributes.
    #[inline]
    pub fn choose(&self, u: &mut f64) -> Option<(usize, f64)> {
        let sum = self.sum();
        if sum <= 0.0 {
            return None;
        }
        let mut rest = *u * sum;
        let mut chosen = 0;
        for (lane, &importance) in self.0.iter().enumerate().filter(|(_, importance)| **importance > 0.0) {
            chosen = lane;
            if rest < importance.into() {
                break;
            }
            rest -= f64::from(importance);
        }
        let importance = f64::from(self.0[chosen]);
        // If roundings pass the last child, that one is chosen.
        *u = (rest / importance).clamp(0.0, 1.0 - f64::EPSILON / 2.0);
        Some((chosen, importance / sum))
    }
}
