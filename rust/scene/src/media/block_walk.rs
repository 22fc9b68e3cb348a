//! Traversal of a ray through a grid's majorant blocks.

use super::stretch::{Content, Stretch};
use super::{Coefficients, Field, Glow};
use raywright_base::math::{Affine, DVec3};
use raywright_optics::Rgb;

/// Bounds on the density of a grid medium in equal blocks.
///
/// Rays traverse it block by block (after Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
/// 1987). Empty blocks cost nothing and constant ones next to nothing. Other blocks are traversed cell by cell, where
/// densities are polynomials along the ray.
#[derive(Clone, Debug)]
pub(super) struct Majorants {
    blocks: [usize; 3],
    /// Minimum and maximum density of each block, the last axis fastest.
    ranges: Vec<[[f32; 3]; 2]>,
    /// One flag per block: true if the medium is constant in it.
    even: Vec<bool>,
    /// Along each axis, grid coordinates at 0 and at 1, and that of the last value.
    steps: [([f64; 2], f64); 3],
    /// One flag per block: true if anything in it emits independently of the density; empty if nothing does.
    bright: Vec<bool>,
    /// Coefficients at unit density.
    coefficients: Coefficients,
    /// Maximum size of a block in grid space.
    across: f64,
}

impl Majorants {
    /// Approximate number of values of a block along an axis.
    const BLOCK: usize = 8;

    /// Computes the bounds of a density, density-independent emission, and coefficients at unit density. `has_albedo`
    /// tells whether the albedo is a grid. `place` maps the unit cube to the grid.
    pub fn new(
        density: &Field,
        glow: Option<&Glow>,
        coefficients: &Coefficients,
        has_albedo: bool,
        place: &Affine,
    ) -> Self {
        let blocks = density.size().map(|n| n.div_ceil(Self::BLOCK));
        let bright = glow.map_or_else(Vec::new, |glow| glow.bright(blocks));
        let (ranges, mut even) = (density.ranges(blocks), Vec::new());
        for (block, &[least, most]) in ranges.iter().enumerate() {
            let glows = bright.get(block).is_some_and(|&glows| glows);
            even.push(least == most && !glows && (!has_albedo || most == [0.0; 3]));
        }
        let steps = [0, 1, 2].map(|axis| (density.steps(axis), (density.size()[axis] - 1) as f64));
        let sides = [0, 1, 2].map(|axis| DVec3::from_array(place.rows.map(|row| row[axis])) / blocks[axis] as f64);
        let across = sides.iter().map(|side| side.length()).sum();
        Self { blocks, ranges, even, steps, bright, coefficients: *coefficients, across }
    }

    /// Maximum density of each channel.
    pub fn densest(&self) -> Rgb {
        let most = |a: [f32; 3], [_, b]: &[[f32; 3]; 2]| [0, 1, 2].map(|i: usize| a[i].max(b[i]));
        Rgb::from_array(self.ranges.iter().fold([0.0; 3], most).map(f64::from))
    }

    /// Returns whether anything emits independently of the density.
    pub fn glows(&self) -> bool {
        self.bright.contains(&true)
    }

    pub fn across(&self) -> f64 {
        self.across
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.ranges.as_slice()) + size_of_val(self.even.as_slice()) + size_of_val(self.bright.as_slice())
    }

    /// Blocks whose optical depth varies by more than this are traversed cell by cell. In others residual ratio
    /// tracking needs so few lookups of the extinction that it takes a fraction of the time, and its error is
    /// negligible.
    const DEEP: f64 = 4.0;

    /// The content of a block.
    #[inline]
    fn content(&self, block: usize, spectra: Spectra) -> Content {
        let range = self.ranges[block].map(|density| Rgb::from_array(density.map(f64::from)));
        if self.even[block] && (spectra == Spectra::Linear || range[1].is_black()) {
            return Content::Even(self.coefficients.times(range[1]));
        }
        let [least, most] = range.map(|density| self.coefficients.extinction * density);
        let is_deep = spectra == Spectra::Closed || (most - least).max() * self.across > Self::DEEP;
        if spectra != Spectra::OfColours && is_deep {
            return Content::Cubic;
        }
        // In an emissive block, the majorant allows for about one lookup, however thin the medium is.
        let glows = !self.coefficients.emission.is_black() || self.bright.get(block).is_some_and(|&glows| glows);
        let most = if glows { most.at_least(Rgb::splat(1.0 / self.across)) } else { most };
        Content::Varies([if spectra == Spectra::OfColours { Rgb::ZERO } else { least }, most])
    }
}

/// Relation between the medium's extinction and its coefficients at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spectra {
    /// Equal, or proportional.
    Linear,
    /// Proportional to the density.
    OfDensity,
    /// Proportional to the density, in segments with closed forms only.
    Closed,
    /// Not proportional: extinction follows from the spectra of the coefficients' colors.
    OfColours,
}

/// Traversal of the cells of a block.
#[derive(Clone, Copy, Debug)]
struct CellWalk {
    /// Start of the cell and end of the block.
    t: f64,
    end: f64,
    /// Next cell border along each axis, and its `t`.
    next: [f64; 3],
    at: [f64; 3],
}

/// Traversal of the blocks of a grid.
#[derive(Clone, Debug)]
pub(super) struct BlockWalk<'m> {
    majorants: &'m Majorants,
    spectra: Spectra,
    /// Grid coordinates along each axis at `t` 0, and their rate per `t`.
    origin: [f64; 3],
    rate: [f64; 3],
    /// Current `t`, and the traversal of the cells there.
    t: f64,
    cells: Option<CellWalk>,
    /// True if only the space outside remains.
    is_past: bool,
    /// Entry into the grid, until it is reached.
    enters: Option<f64>,
    /// Exit from the grid, or the end within it.
    leaves: f64,
    end: f64,
    block: [usize; 3],
    /// The `t` of the next block border along each axis, and the distance between borders.
    next: [f64; 3],
    step: [f64; 3],
    is_up: [bool; 3],
}

impl<'m> BlockWalk<'m> {
    pub fn new(
        majorants: &'m Majorants,
        spectra: Spectra,
        origin: DVec3,
        direction: DVec3,
        [start, end]: [f64; 2],
    ) -> Self {
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
        let steps = |axis: usize| majorants.steps[axis].0;
        let per = |axis: usize| steps(axis)[1] - steps(axis)[0];
        let mut walk = Self {
            majorants,
            spectra,
            origin: [0, 1, 2].map(|axis| steps(axis)[0] + per(axis) * origin[axis]),
            rate: [0, 1, 2].map(|axis| per(axis) * direction[axis]),
            t: first,
            cells: None,
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

    /// Starts the traversal of cells in a block that ends at a `t`.
    fn enter(&self, end: f64) -> CellWalk {
        let mut cells = CellWalk { t: self.t, end, next: [f64::NAN; 3], at: [f64::INFINITY; 3] };
        for axis in 0..3 {
            let (here, last) = (self.origin[axis] + self.rate[axis] * self.t, self.majorants.steps[axis].1);
            if self.rate[axis] > 0.0 {
                cells.next[axis] = (here.floor() + 1.0).max(0.0);
            } else if self.rate[axis] < 0.0 {
                cells.next[axis] = (here.ceil() - 1.0).min(last);
            }
            self.find(axis, &mut cells);
        }
        cells
    }

    /// Finds the `t` of the next border along an axis.
    fn find(&self, axis: usize, cells: &mut CellWalk) {
        let next = cells.next[axis];
        let is_within = (0.0..=self.majorants.steps[axis].1).contains(&next);
        cells.at[axis] = if is_within { (next - self.origin[axis]) / self.rate[axis] } else { f64::INFINITY };
    }

    /// End of the next cell; true if the block ends there.
    #[inline]
    fn cell(&self, cells: &mut CellWalk) -> (f64, bool) {
        loop {
            let [a, b, c] = cells.at;
            let axis = if a <= b && a <= c {
                0
            } else if b <= c {
                1
            } else {
                2
            };
            let end = cells.at[axis];
            if end >= cells.end {
                return (cells.end, true);
            }
            cells.next[axis] += 1f64.copysign(self.rate[axis]);
            self.find(axis, cells);
            // Rounding may place a border before the current `t`; such a cell is empty.
            if end > cells.t {
                cells.t = end;
                return (end, false);
            }
        }
    }

    /// Advances to the next block.
    #[inline]
    fn block(&mut self) -> Option<Stretch> {
        let nothing = Content::Even(Coefficients::NONE);
        if let Some(end) = self.enters.take() {
            return Some(Stretch { end, content: nothing });
        }
        if self.is_past {
            let end = std::mem::replace(&mut self.end, f64::NAN);
            return (!end.is_nan()).then_some(Stretch { end, content: nothing });
        }
        let [_, y, z] = self.majorants.blocks;
        let content = self.majorants.content((self.block[0] * y + self.block[1]) * z + self.block[2], self.spectra);
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
        // Rounding may step just beyond the last block; clamp to it.
        self.block[axis] = if self.is_up[axis] { (block + 1).min(count - 1) } else { block.saturating_sub(1) };
        Some(Stretch { end, content })
    }
}

impl Iterator for BlockWalk<'_> {
    type Item = Stretch;

    #[inline]
    fn next(&mut self) -> Option<Stretch> {
        if let Some(mut cells) = self.cells {
            let (end, is_last) = self.cell(&mut cells);
            (self.t, self.cells) = (end, (!is_last).then_some(cells));
            return Some(Stretch { end, content: Content::Cubic });
        }
        let stretch = self.block()?;
        if matches!(stretch.content, Content::Cubic) {
            self.cells = Some(self.enter(stretch.end));
            return self.next();
        }
        self.t = stretch.end;
        Some(stretch)
    }
}
