//! A medium that differs from place to place, by numbers on a grid.

use super::stretches::{Content, Stretch, Stretches};
use super::{Coefficients, Medium, Values};
use crate::math::{Affine, DVec3, Ray};
use crate::optics::{Phase, Rgb};

/// A medium whose density is given on a regular grid: where the density is 1, it does to light what its coefficients
/// say. Outside of the grid there is nothing.
///
/// Rays go through it block by block, each with the greatest density in it (after Amanatides and Woo, "A Fast Voxel
/// Traversal Algorithm for Ray Tracing", 1987), so that what is empty costs nothing and what is thin next to nothing.
#[derive(Clone, Debug)]
pub struct GridMedium {
    density: Values<1>,
    /// What it gives off by itself, if that does not go with the density.
    glow: Option<Values<3>>,
    coefficients: Coefficients,
    phase: Phase,
    /// From the space of the grid to the unit cube.
    into: Affine,
    blocks: [usize; 3],
    /// The greatest density in each block, and the greatest glow.
    densest: Vec<f32>,
    brightest: Vec<f32>,
    /// How long a block is across at most, in the space of the grid.
    across: f64,
}

impl GridMedium {
    /// How many numbers a block has along an axis, about: a block of 8 has 512, and its majorant a byte for each 128.
    const BLOCK: usize = 8;

    /// A medium of a density, of what it does to light where that is 1, and of what it gives off by itself beside. The
    /// matrix takes the unit cube to the grid.
    ///
    /// # Errors
    /// If something is negative or not finite, or the matrix has no inverse: what, in a few words.
    pub fn new(
        density: Values<1>,
        glow: Option<Values<3>>,
        coefficients: Coefficients,
        phase: Phase,
        matrix: [[f64; 4]; 3],
    ) -> Result<Self, String> {
        if !coefficients.is_physical() {
            return Err("coefficients must be finite and not negative".into());
        }
        let place = Affine::from_matrix(matrix);
        let into = place.inverse().map_err(|why| format!("transform has no inverse: {why}"))?;
        let blocks = density.size().map(|n| n.div_ceil(Self::BLOCK));
        let densest = density.greatest(blocks);
        let brightest = glow.as_ref().map_or_else(Vec::new, |glow| glow.greatest(blocks));
        let sides = [0, 1, 2].map(|axis| DVec3::from_array(place.rows.map(|row| row[axis])) / blocks[axis] as f64);
        let across = sides.iter().map(|side| side.length()).sum();
        let medium = Self { density, glow, coefficients, phase, into, blocks, densest, brightest, across };
        let greatest = f64::from(medium.densest.iter().copied().fold(0.0, f32::max));
        if !(coefficients.extinction * greatest).is_finite() {
            return Err("density times a coefficient must be finite".into());
        }
        Ok(medium)
    }

    /// What there is in a block.
    #[inline]
    fn content(&self, block: usize) -> Content {
        let density = f64::from(self.densest[block]);
        let glows = self.brightest.get(block).is_some_and(|&glow| glow > 0.0);
        if density == 0.0 && !glows {
            return Content::Even(Coefficients::NONE);
        }
        let majorant = self.coefficients.extinction * density;
        // Where it glows, it is asked for about once in a block, however thin it is.
        let glows = glows || !self.coefficients.emission.is_black();
        Content::Varies(if glows { majorant.at_least(Rgb::splat(1.0 / self.across)) } else { majorant })
    }
}

impl Medium for GridMedium {
    fn phase(&self) -> Phase {
        self.phase
    }

    fn scatters(&self) -> bool {
        !self.coefficients.scattering.is_black()
    }

    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        Stretches::blocks(BlockWalk::new(self, self.into.point(ray.origin), self.into.vector(ray.direction), span))
    }

    #[inline]
    fn at(&self, point: DVec3) -> Coefficients {
        let within = self.into.point(point);
        let mut here = self.coefficients.times(self.density.value(within)[0]);
        if let Some(glow) = &self.glow {
            here.emission += Rgb::from_array(glow.value(within));
        }
        here
    }

    fn bytes(&self) -> usize {
        self.density.bytes()
            + self.glow.as_ref().map_or(0, Values::bytes)
            + size_of_val(self.densest.as_slice())
            + size_of_val(self.brightest.as_slice())
    }
}

/// A ray on its way through the blocks of a grid.
#[derive(Clone, Debug)]
pub(super) struct BlockWalk<'m> {
    medium: &'m GridMedium,
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
    fn new(medium: &'m GridMedium, origin: DVec3, direction: DVec3, [start, end]: [f64; 2]) -> Self {
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
            medium,
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
            let count = medium.blocks[axis] as f64;
            let place = ((origin[axis] + direction[axis] * first) * count).clamp(0.0, count);
            walk.block[axis] = (place as usize).min(medium.blocks[axis] - 1);
            walk.is_up[axis] = direction[axis] > 0.0;
            if direction[axis] != 0.0 {
                let face = (walk.block[axis] + usize::from(walk.is_up[axis])) as f64 / count;
                walk.next[axis] = (face - origin[axis]) / direction[axis];
                walk.step[axis] = 1.0 / (count * direction[axis].abs());
            }
        }
        walk
    }

    #[inline]
    pub(super) fn next(&mut self) -> Option<Stretch> {
        let nothing = Content::Even(Coefficients::NONE);
        if let Some(end) = self.enters.take() {
            return Some(Stretch { end, content: nothing });
        }
        if self.is_past {
            let end = std::mem::replace(&mut self.end, f64::NAN);
            return (!end.is_nan()).then_some(Stretch { end, content: nothing });
        }
        let [_, y, z] = self.medium.blocks;
        let content = self.medium.content((self.block[0] * y + self.block[1]) * z + self.block[2]);
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
        let (block, count) = (self.block[axis], self.medium.blocks[axis]);
        // What rounding puts a hair's breadth beyond the last block is in it still.
        self.block[axis] = if self.is_up[axis] { (block + 1).min(count - 1) } else { block.saturating_sub(1) };
        Some(Stretch { end, content })
    }
}
