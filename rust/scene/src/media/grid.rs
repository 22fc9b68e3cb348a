//! A heterogeneous medium on a grid.

use super::block_walk::{BlockWalk, Majorants, Spectra};
use super::{Coefficients, Cubic, Field, Glow, Medium, Stretches};
use raywright_base::math::{Affine, DVec3, Ray};
use raywright_optics::{Phase, Rgb};

/// A medium with its density on a regular grid. Its coefficients are those at density 1, scaled by the density; outside
/// the grid is vacuum.
#[derive(Clone, Debug)]
pub struct GridMedium {
    density: Field,
    /// Single-scattering albedo, if it varies.
    albedo: Option<Field>,
    /// Emission that is not proportional to the density.
    glow: Option<Glow>,
    coefficients: Coefficients,
    phase: Phase,
    /// Map from grid space to the unit cube.
    into: Affine,
    majorants: Majorants,
}

/// Values of the grids at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Here {
    pub density: Rgb,
    pub albedo: Option<Rgb>,
}

impl GridMedium {
    /// Creates a medium from a density, coefficients at density 1, and density-independent emission. The matrix maps
    /// the unit cube to the grid. An albedo grid gives the scattered share of the extinction.
    ///
    /// # Errors
    /// A short reason if something is negative or not finite, or the matrix has no inverse.
    pub fn new(
        density: Field,
        albedo: Option<Field>,
        glow: Option<Glow>,
        coefficients: Coefficients,
        phase: Phase,
        matrix: [[f64; 4]; 3],
    ) -> Result<Self, String> {
        if !coefficients.is_physical() {
            return Err("coefficients must be finite and not negative".into());
        }
        let place = Affine::from_matrix(matrix);
        let into = place.inverse().map_err(|why| format!("transform has no inverse: {why}"))?;
        let scattering = if albedo.is_some() { coefficients.extinction } else { coefficients.scattering };
        let coefficients = Coefficients { scattering, ..coefficients };
        let majorants = Majorants::new(&density, glow.as_ref(), &coefficients, albedo.is_some(), &place);
        let medium = Self { density, albedo, glow, coefficients, phase, into, majorants };
        if !(coefficients.extinction * medium.majorants.densest()).is_finite() {
            return Err("density times a coefficient must be finite".into());
        }
        Ok(medium)
    }

    /// Returns whether the density is RGB.
    pub(super) fn is_coloured(&self) -> bool {
        self.density.is_coloured()
    }

    /// Returns whether the albedo is a grid.
    pub(super) fn has_albedo(&self) -> bool {
        self.albedo.is_some()
    }

    /// Maximum size of a block in grid space.
    pub(super) fn across(&self) -> f64 {
        self.majorants.across()
    }

    /// Values of the grids at a point of the unit cube.
    pub(super) fn here(&self, within: DVec3) -> Here {
        let albedo = self.albedo.as_ref().map(|albedo| albedo.at(within));
        Here { density: self.density.at(within), albedo }
    }

    /// Maps a point to the unit cube.
    pub(super) fn within(&self, point: DVec3) -> DVec3 {
        self.into.point(point)
    }

    /// Segments of a ray between two `t`, for a relation between extinction and coefficients.
    pub(super) fn stretches_by(&self, spectra: Spectra, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        let (origin, direction) = (self.into.point(ray.origin), self.into.vector(ray.direction));
        Stretches::blocks(BlockWalk::new(&self.majorants, spectra, origin, direction, span))
    }

    /// Emission that is not proportional to the density.
    pub(super) fn glow(&self) -> Option<&Glow> {
        self.glow.as_ref()
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
        !self.coefficients.emission.is_black() || self.majorants.glows()
    }

    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.stretches_by(Spectra::Linear, ray, span)
    }

    fn closed_stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.stretches_by(Spectra::Closed, ray, span)
    }

    #[inline]
    fn extinction(&self, point: DVec3) -> Rgb {
        self.coefficients.extinction * self.density.at(self.into.point(point))
    }

    #[inline]
    fn cubic(&self, [from, to]: [DVec3; 2]) -> Cubic {
        // Plain f64 is enough: its rounding moves points no more than the ray's own rounding, which barely changes
        // interpolated values.
        let within = |point: DVec3| self.into.vector(point) + self.into.shift;
        self.density.cubic([within(from), within(to)]).times(self.coefficients.extinction)
    }

    #[inline]
    fn at(&self, point: DVec3) -> Coefficients {
        let within = self.into.point(point);
        let mut here = self.coefficients.times(self.density.at(within));
        if let Some(albedo) = &self.albedo {
            here.scattering = here.extinction * albedo.at(within);
        }
        if let Some(glow) = &self.glow {
            here.emission += glow.at(within, || (here.extinction - here.scattering).at_least(Rgb::ZERO));
        }
        here
    }

    fn bytes(&self) -> usize {
        let albedo = self.albedo.as_ref().map_or(0, Field::bytes);
        self.density.bytes() + albedo + self.glow.as_ref().map_or(0, Glow::bytes) + self.majorants.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{At, Blocks, Content, Stretch, Values};
    use super::*;
    use raywright_base::sampling::{Sampler, warp};
    use std::sync::Arc;

    const UNIT: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    fn grid(size: [usize; 3], at: At, density: Vec<f32>, matrix: [[f64; 4]; 3]) -> GridMedium {
        let numbers: Vec<_> = density.into_iter().map(|v| [v]).collect();
        let values = Values::new(Arc::new(Blocks::new(size, &numbers).unwrap()), at);
        let absorbing = Coefficients::new(Rgb::ONE, Rgb::ZERO, Rgb::ZERO);
        GridMedium::new(Field::Grey(values), None, None, absorbing, Phase::Isotropic, matrix).unwrap()
    }

    /// Optical depth along a ray to `t`, by a quadrature that is exact if densities are cubic between `pieces` points.
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
        // With cell-centered values, the outer half cells are constant.
        let cells = grid([2, 1, 1], At::Centres, vec![1.0, 3.0], UNIT);
        for (x, value) in [(0.0, 1.0), (0.25, 1.0), (0.5, 2.0), (0.75, 3.0), (1.0, 3.0)] {
            assert_eq!(cells.at(DVec3::new(x, 0.3, 0.9)).extinction, Rgb::splat(value));
        }
    }

    #[test]
    fn optical_depths_are_those_of_the_densities() {
        // 0.4 z from 0 to 3: linear, as the grid is.
        let linear = grid([1, 1, 2], At::Corners, vec![0.0, 1.2], [UNIT[0], UNIT[1], [0.0, 0.0, 3.0, 0.0]]);
        // The number is rounded to f32.
        assert!((depth(&linear, &Ray::new(DVec3::ZERO, DVec3::Z), 3.0, 1) - 1.8).abs() < 1e-7);
        // 1 + 0.9 sin 20x, and 3 exp(−(0.7² + s²) / 0.5) from s = −1 to 2. With this many values the interpolation
        // error is below their rounding.
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
    fn stretches_follow_on_one_another_and_are_even_or_cubic() {
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
                let mut start = 0.25;
                for stretch in medium.closed_stretches(&ray, [0.25, 9.0]) {
                    assert!(stretch.end >= start - 1e-12 && stretch.end <= 9.0);
                    let inside = |t: f64, slack: f64| {
                        let within = medium.into.point(ray.at(t));
                        within.cmpge(DVec3::splat(-slack)).all() && within.cmple(DVec3::splat(1.0 + slack)).all()
                    };
                    let at = |step: i32| start + (stretch.end - start) * (f64::from(step) + 0.5) / 5.0;
                    let density = |step: i32| medium.at(ray.at(at(step))).extinction[0];
                    match stretch.content {
                        // The fourth differences of a cubic polynomial are 0.
                        Content::Cubic => {
                            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(density);
                            assert!((a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs() < 1e-11);
                            // Gauss-Legendre quadrature, which is exact for cubics.
                            let cubic = medium.cubic([start, stretch.end].map(|t| ray.at(t)));
                            let point = |side: f64| start + (stretch.end - start) * 0.5 * (1.0 + side / 3f64.sqrt());
                            let [a, b] = [-1.0, 1.0].map(|side| medium.at(ray.at(point(side))).extinction[0]);
                            assert!((cubic.mean()[0] - 0.5 * (a + b)).abs() < 1e-11);
                            assert!((0..5).all(|step| inside(at(step), 1e-12)));
                        }
                        Content::Even(nothing) => {
                            assert_eq!(nothing, Coefficients::NONE);
                            assert!((0..5).all(|step| !inside(at(step), 0.0) || density(step) == 0.0));
                        }
                        Content::Varies(_) => panic!("it is told by density"),
                    }
                    start = stretch.end;
                }
                assert_eq!(start, 9.0);
                // Where extinction is not proportional to the density, the majorant of each block is known.
                start = 0.25;
                for stretch in medium.stretches_by(Spectra::OfColours, &ray, [0.25, 9.0]) {
                    let middle = medium.at(ray.at(0.5 * (start + stretch.end))).extinction[0];
                    let Content::Varies([_, most]) = stretch.content else { continue };
                    assert!(middle <= most[0] + 1e-12);
                    start = stretch.end;
                }
            }
        }
    }

    #[test]
    fn what_is_the_same_throughout_a_block_is_even() {
        let mut numbers = vec![0.5f32; 24 * 8 * 8];
        numbers[23 * 64] = 0.75;
        let medium = grid([24, 8, 8], At::Centres, numbers, UNIT);
        let ray = Ray::new(DVec3::new(-1.0, 0.3, 0.4), DVec3::X);
        // Drops the sliver that rounding leaves between the last block and the end of the grid.
        let long = |all: super::super::Stretches<'_>| -> Vec<Stretch> {
            let mut start = 0.0;
            all.filter(|stretch| stretch.end - std::mem::replace(&mut start, stretch.end) > 1e-12).collect()
        };
        let contents = long(medium.stretches(&ray, [0.0, 9.0]));
        let even = |stretch: &Stretch, sigma: f64| match stretch.content {
            Content::Even(here) => here.extinction == Rgb::splat(sigma),
            _ => false,
        };
        assert!(even(&contents[0], 0.0) && even(&contents[1], 0.5) && even(&contents[2], 0.5));
        // The variation is small enough for a few lookups.
        assert!(matches!(contents[3].content, Content::Varies(range) if range == [Rgb::splat(0.5), Rgb::splat(0.75)]));
        assert!(even(&contents[4], 0.0) && contents.len() == 5);
        // Values are at the centers of 24 cells, eight per block.
        assert_eq!(long(medium.closed_stretches(&ray, [0.0, 9.0])).len(), 2 + 3 * 9);
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
        // For 512³ values the blocks take 1/128 more: 541 MB in total.
        let medium = grid([64; 3], At::Corners, vec![1.0; 1 << 18], UNIT);
        let whole = medium.bytes() * 512;
        assert!(whole <= 600_000_000, "{whole}");
    }

    #[test]
    fn refuses_what_lies_nowhere_and_what_is_no_coefficient() {
        let flat = [UNIT[0], UNIT[1], [0.0; 4]];
        let field = Field::Grey(Values::new(Arc::new(Blocks::new([1; 3], &[[1.0]]).unwrap()), At::Corners));
        let new =
            |coefficients, matrix| GridMedium::new(field.clone(), None, None, coefficients, Phase::Isotropic, matrix);
        assert!(new(Coefficients::NONE, flat).is_err());
        assert!(new(Coefficients::new(Rgb::ONE, Rgb::splat(f64::NAN), Rgb::ZERO), UNIT).is_err());
        assert!(new(Coefficients::NONE, UNIT).is_ok());
    }
}
