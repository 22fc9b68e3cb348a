//! The way of a ray through the blocks of a grid.

use super::stretch::{Content, Stretch};
use super::{Coefficients, Field, Glow};
use raywright_base::math::{Affine, DVec3};
use raywright_optics::Rgb;

/// The most that there is in each of many equal blocks of a grid.
///
/// Rays go through it block by block, each with the greatest density in it (after Amanatides and Woo, "A Fast Voxel
/// Traversal Algorithm for Ray Tracing", 1987), so that what is empty costs nothing and what is thin next to nothing.
#[derive(Clone, Debug)]
pub(super) struct Majorants {
    blocks: [usize; 3],
    /// The greatest density in each, the last axis fastest.
    densest: Vec<[f32; 3]>,
    /// Whether anything glows in each whatever the density; none where nothing does.
    bright: Vec<bool>,
    /// The extinction at unit density, and whether what glows goes with the density.
    extinction: Rgb,
    is_glowing: bool,
    /// How long a block is across at most, in the space of the grid.
    across: f64,
}

impl Majorants {
    /// How many numbers a block has along an axis, about.
    const BLOCK: usize = 8;

    /// Of a density, of what glows beside it, and of what the medium does to light at unit density, whether it glows
    /// along with it. `place` takes the unit cube to the grid.
    pub fn new(
        density: &Field,
        glow: Option<&Glow>,
        coefficients: &Coefficients,
        is_glowing: bool,
        place: &Affine,
    ) -> Self {
        let blocks = density.size().map(|n| n.div_ceil(Self::BLOCK));
        let densest = density.greatest(blocks);
        let bright = glow.map_or_else(Vec::new, |glow| glow.bright(blocks));
        let sides = [0, 1, 2].map(|axis| DVec3::from_array(place.rows.map(|row| row[axis])) / blocks[axis] as f64);
        let across = sides.iter().map(|side| side.length()).sum();
        Self { blocks, densest, bright, extinction: coefficients.extinction, is_glowing, across }
    }

    /// The greatest density of each colour.
    pub fn densest(&self) -> Rgb {
        let most = |a: [f32; 3], b: &[f32; 3]| [0, 1, 2].map(|i: usize| a[i].max(b[i]));
        Rgb::from_array(self.densest.iter().fold([0.0; 3], most).map(f64::from))
    }

    /// Whether anything glows anywhere whatever the density.
    pub fn glows(&self) -> bool {
        self.bright.contains(&true)
    }

    pub fn across(&self) -> f64 {
        self.across
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.densest.as_slice()) + size_of_val(self.bright.as_slice())
    }

    /// What there is in a block.
    #[inline]
    fn content(&self, block: usize) -> Content {
        let density = self.densest[block];
        let glows = self.bright.get(block).is_some_and(|&glows| glows);
        if density == [0.0; 3] && !glows {
            return Content::Even(Coefficients::NONE);
        }
        let majorant = self.extinction * Rgb::from_array(density.map(f64::from));
        // Where it glows, it is asked for about once in a block, however thin it is.
        let glows = glows || self.is_glowing;
        Content::Varies(if glows { majorant.at_least(Rgb::splat(1.0 / self.across)) } else { majorant })
    }
}

/// A ray on its way through the blocks of a grid.
#[derive(Clone, Debug)]
pub(super) struct BlockWalk<'m> {
    majorants: &'m Majorants,
    /// Whether there is nothing left but what lies outside.
    is_past: bool,
    /// Where it enters the grid, if it has not yet.
    enters: Option<f64>,
    /// Where it leaves the grid, or ends in it.
    leaves: f64,
    end: f64,
    block: [usize; 3],
    /// The `t` at which it comes to the next block along each axis, and how far that is from one to the next.
    next: [f64; 3],
    step: [f64; 3],
    is_up: [bool; 3],
}

impl<'m> BlockWalk<'m> {
    pub fn new(majorants: &'m Majorants, origin: DVec3, direction: DVec3, [start, end]: [f64; 2]) -> Self {
        let (mut first, mut last) = (start, end);
        for axis in 0..3 {
            if direction[axis] == 0.0 {
                if !(0.0..=1.0).contains(&origin[axis]) {
                    last = f64::NEG_INFINITY;
                }
                continue;
            }
            let [a, b] = [0.0, 1.0].map(|face| (face - origin[axis]) / direction[axis]);
            first = first.max(a.min(b));
            last = last.min(a.max(b));
        }
        let is_past = first >= last;
        let mut walk = Self {
            majorants,
            is_past,
            enters: (first > start).then_some(first),
            leaves: last,
            end,
            block: [0; 3],
            next: [f64::INFINITY; 3],
            step: [0.0; 3],
            is_up: [false; 3],
        };
        if is_past {
            walk.enters = None;
            return walk;
        }
        for axis in 0..3 {
            let count = majorants.blocks[axis] as f64;
            let place = ((origin[axis] + direction[axis] * first) * count).clamp(0.0, count);
            walk.block[axis] = (place as usize).min(majorants.blocks[axis] - 1);
            walk.is_up[axis] = direction[axis] > 0.0;
            if direction[axis] != 0.0 {
                let face = (walk.block[axis] + usize::from(walk.is_up[axis])) as f64 / count;
                walk.next[axis] = (face - origin[axis]) / direction[axis];
                walk.step[axis] = 1.0 / (count * direction[axis].abs());
            }
        }
        walk
    }
}

impl Iterator for BlockWalk<'_> {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        let nothing = Content::Even(Coefficients::NONE);
        if let Some(end) = self.enters.take() {
            return Some(Stretch { end, content: nothing });
        }
        if self.is_past {
            let end = std::mem::replace(&mut self.end, f64::NAN);
            return (!end.is_nan()).then_some(Stretch { end, content: nothing });
        }
        let [_, y, z] = self.majorants.blocks;
        let content = self.majorants.content((self.block[0] * y + self.block[1]) * z + self.block[2]);
        let [a, b, c] = self.next;
        let axis = if a <= b && a <= c {
            0
        } else if b <= c {
            1
        } else {
            2
        };
        let end = self.next[axis];
        if end >= self.leaves {
            self.is_past = true;
            return Some(Stretch { end: self.leaves, content });
        }
        self.next[axis] += self.step[axis];
        let (block, count) = (self.block[axis], self.majorants.blocks[axis]);
        // What rounding puts a hair's breadth beyond the last block is in it still.
        self.block[axis] = if self.is_up[axis] { (block + 1).min(count - 1) } else { block.saturating_sub(1) };
        Some(Stretch { end, content })
    }
}
