//! A medium that differs from place to place, by numbers on a grid.

use super::stretch::{Content, Stretch};
use super::{Coefficients, Medium, Stretches, Values};
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

    fn glows(&self) -> bool {
        !self.coefficients.emission.is_black() || self.brightest.iter().any(|&most| most > 0.0)
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

#[cfg(test)]
mod tests {
    use super::super::At;
    use super::*;
    use crate::sampling::{Sampler, warp};

    const UNIT: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    fn grid(size: [usize; 3], at: At, density: Vec<f32>, matrix: [[f64; 4]; 3]) -> GridMedium {
        let values = Values::new(size, at, density.into_iter().map(|v| [v]).collect()).unwrap();
        let absorbing = Coefficients::new(Rgb::ONE, Rgb::ZERO, Rgb::ZERO);
        GridMedium::new(values, None, absorbing, Phase::Isotropic, matrix).unwrap()
    }

    /// The optical depth along a ray to `t`, by a rule that is exact where densities are cubic between so many points.
    fn depth(medium: &GridMedium, ray: &Ray, to: f64, pieces: u32) -> f64 {
        let step = to / f64::from(pieces);
        let [(a, wa), (b, wb)] = [(-(1.0f64 / 3.0).sqrt(), 0.5), ((1.0f64 / 3.0).sqrt(), 0.5)];
        let middle = |i: u32| (f64::from(i) + 0.5) * step;
        let at = |t: f64| medium.at(ray.at(t)).extinction[1];
        (0..pieces).map(|i| step * (wa * at(middle(i) + 0.5 * step * a) + wb * at(middle(i) + 0.5 * step * b))).sum()
    }

    #[test]
    fn numbers_at_corners_are_interpolated_along_each_axis() {
        // d[x][y][z] = [[[0, 1], [2, 3]], [[4, 0], [1, 6]]]: along the diagonal √3 · 29/12.
        let cube = grid([2; 3], At::Corners, vec![0.0, 1.0, 2.0, 3.0, 4.0, 0.0, 1.0, 6.0], UNIT);
        let ray = Ray::new(DVec3::ZERO, DVec3::ONE);
        assert!((3f64.sqrt() * depth(&cube, &ray, 1.0, 1) - 4.18578945162479).abs() < 1e-12);
        for (x, y, z, value) in [(0.0, 0.0, 1.0, 1.0), (0.0, 1.0, 0.0, 2.0), (1.0, 0.0, 0.0, 4.0), (1.0, 1.0, 1.0, 6.0)]
        {
            assert_eq!(cube.at(DVec3::new(x, y, z)).extinction, Rgb::splat(value));
        }
        // In the middle of cells, they are those of the cells up to the faces.
        let cells = grid([2, 1, 1], At::Centres, vec![1.0, 3.0], UNIT);
        for (x, value) in [(0.0, 1.0), (0.25, 1.0), (0.5, 2.0), (0.75, 3.0), (1.0, 3.0)] {
            assert_eq!(cells.at(DVec3::new(x, 0.3, 0.9)).extinction, Rgb::splat(value));
        }
    }

    #[test]
    fn optical_depths_are_those_of_the_densities() {
        // 0.4 z from 0 to 3: linear, as the grid is.
        let linear = grid([1, 1, 2], At::Corners, vec![0.0, 1.2], [UNIT[0], UNIT[1], [0.0, 0.0, 3.0, 0.0]]);
        // Of a number that f32 rounds.
        assert!((depth(&linear, &Ray::new(DVec3::ZERO, DVec3::Z), 3.0, 1) - 1.8).abs() < 1e-7);
        // 1 + 0.9 sin 20x, and 3 exp(−(0.7² + s²) / 0.5) from s = −1 to 2: so many numbers that what lies between is
        // off by less than their rounding.
        let count = 20_001;
        let along =
            |f: &dyn Fn(f64) -> f64| (0..count).map(|i| f(f64::from(i) / f64::from(count - 1)) as f32).collect();
        let ray = Ray::new(DVec3::new(0.0, 0.5, 0.5), DVec3::X);
        let waves = along(&|x| 1.0 + 0.9 * (20.0 * x).sin());
        let waves = grid([count as usize, 1, 1], At::Corners, waves, UNIT);
        assert!((depth(&waves, &ray, 1.0, 20_000) - 1.0266363072184).abs() < 1e-7);
        let bump = along(&|x| 3.0 * (-(0.49 + (3.0 * x - 1.0).powi(2)) / 0.5).exp());
        let bump = grid([count as usize, 1, 1], At::Corners, bump, [[3.0, 0.0, 0.0, -1.0], UNIT[1], UNIT[2]]);
        let ray = Ray { origin: DVec3::new(-1.0, 0.5, 0.5), ..ray };
        assert!((depth(&bump, &ray, 3.0, 20_000) - 1.37899961954379).abs() < 1e-7);
    }

    #[test]
    fn stretches_follow_on_one_another_and_nothing_in_one_is_denser_than_it_says() {
        let size = [19, 33, 8];
        let numbers = (0..19 * 33 * 8).map(|i| Sampler::new(5, 0, i).one(0));
        let dense = |u: f64| if u < 0.6 { 0.0 } else { u as f32 };
        let matrix = [[2.0, 0.5, 0.0, 1.0], [0.0, 3.0, 0.1, -1.0], [0.3, 0.0, 1.0, 0.0]];
        for at in [At::Corners, At::Centres] {
            let medium = grid(size, at, numbers.clone().map(dense).collect(), matrix);
            for draw in 0..300 {
                let mut sampler = Sampler::new(6, 0, draw);
                let origin = DVec3::new(2.0, 0.5, 0.6) + warp::uniform_sphere(sampler.two(0)) * 4.0 * sampler.one(1);
                let ray = Ray::new(origin, warp::uniform_sphere(sampler.two(2)));
                let (mut start, mut in_blocks) = (0.25, 0.0);
                for stretch in medium.stretches(&ray, [0.25, 9.0]) {
                    assert!(stretch.end >= start - 1e-12 && stretch.end <= 9.0);
                    for step in 0..8 {
                        let t = start + (stretch.end - start) * (f64::from(step) + 0.5) / 8.0;
                        let within = medium.into.point(ray.at(t));
                        let is_inside = within.cmpge(DVec3::ZERO).all() && within.cmple(DVec3::ONE).all();
                        match stretch.content {
                            Content::Varies(most) => {
                                assert!(medium.at(ray.at(t)).extinction[0] <= most[0] + 1e-12);
                                in_blocks += (stretch.end - start) / 8.0;
                            }
                            Content::Even(nothing) => {
                                assert_eq!(nothing, Coefficients::NONE);
                                assert!(!is_inside || medium.at(ray.at(t)).extinction.is_black());
                            }
                        }
                    }
                    start = stretch.end;
                }
                assert_eq!(start, 9.0);
                assert!(in_blocks <= 8.75);
            }
        }
    }

    #[test]
    fn what_is_empty_or_of_one_cell_is_so() {
        let empty = grid([40, 1, 1], At::Corners, vec![0.0; 40], UNIT);
        let ray = Ray::new(DVec3::new(-1.0, 0.5, 0.5), DVec3::X);
        let nothing = |stretch: Stretch| matches!(stretch.content, Content::Even(here) if here == Coefficients::NONE);
        assert!(empty.stretches(&ray, [0.0, f64::INFINITY]).all(nothing));
        let one = grid([1; 3], At::Centres, vec![2.5], UNIT);
        let dense: Vec<_> = one.stretches(&ray, [0.0, f64::INFINITY]).map(|s| (s.end, nothing(s))).collect();
        assert_eq!(dense, [(1.0, true), (2.0, false), (f64::INFINITY, true)]);
        assert_eq!(one.at(DVec3::splat(0.9)).extinction, Rgb::splat(2.5));
    }

    #[test]
    fn memory_is_that_of_the_numbers_and_little_more() {
        // Of 512³ numbers the blocks take 1/128 more: 541 MB in all.
        let medium = grid([64; 3], At::Corners, vec![0.0; 1 << 18], UNIT);
        let whole = medium.bytes() * 512;
        assert!(whole <= 600_000_000, "{whole}");
    }

    #[test]
    fn refuses_what_is_no_density_and_what_lies_nowhere() {
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            let why = Values::new([1, 2, 2], At::Corners, vec![[1.0], [0.0], [1.0], [bad]]).unwrap_err();
            assert!(why.contains("[0, 1, 1]"), "{why}");
        }
        assert!(Values::<1>::new([0, 1, 1], At::Corners, vec![]).is_err());
        assert!(Values::new([2, 1, 1], At::Corners, vec![[1.0]]).is_err());
        let flat = [UNIT[0], UNIT[1], [0.0; 4]];
        let values = Values::new([1; 3], At::Corners, vec![[1.0]]).unwrap();
        let new = |coefficients, matrix| GridMedium::new(values.clone(), None, coefficients, Phase::Isotropic, matrix);
        assert!(new(Coefficients::NONE, flat).is_err());
        assert!(new(Coefficients::new(Rgb::ONE, Rgb::splat(f64::NAN), Rgb::ZERO), UNIT).is_err());
        assert!(new(Coefficients::NONE, UNIT).is_ok());
    }
}
