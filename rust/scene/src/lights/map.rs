//! An image-based environment.

use super::light::strength;
use super::pyramid::{Pyramid, linear};
use super::{Light, LightSample, LightSampleContext, Picture, Reach};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// An equirectangular environment map. In the picture's space its center is at −z, its top at +y, and +x is to the
/// right of the center.
///
/// Radiance is interpolated bilinearly between texel centers and wraps around at the sides; at the top and bottom the
/// last row is extended. A cell between four centers is sampled by its flux, and a point in the cell by the
/// interpolated radiance. The sampling is exact horizontally. Vertically the density is linear between the products of
/// radiance and sine of the colatitude at both ends. So radiance over density varies by a small factor within a cell,
/// and by color, and no bright texel has a density that ignores it.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    picture: Arc<Picture>,
    /// From world space to the picture's space, orthonormal.
    to_picture: [DVec3; 3],
    scale: f64,
    /// Distribution over cells; `None` if all is black.
    pyramid: Option<Pyramid>,
    /// Sines of the colatitudes between rows of cells.
    sines: Vec<f64>,
    /// Flux and spread as in [`Reach::Infinite`], before scaling.
    flux: f64,
    spread: f64,
}

impl EnvironmentMap {
    /// Creates a map from a picture. Its radiance, W·sr⁻¹·m⁻², is `scale` times the colors, rotated into the world by
    /// an orthonormal matrix of three rows.
    pub fn new(picture: Arc<Picture>, to_world: [DVec3; 3], scale: f64) -> Self {
        let to_picture = [0, 1, 2].map(|i| DVec3::from_array(to_world.map(|row| row[i])));
        let height = picture.height();
        let colatitude = |row: usize| ((row as f64 - 0.5).clamp(0.0, height as f64)) / height as f64 * PI;
        let sines = (0..=height + 1).map(|row| colatitude(row).sin()).collect();
        let mut map = Self { picture, to_picture, scale, pyramid: None, sines, flux: 0.0, spread: 1.0 };
        let size = [map.picture.width(), height + 1];
        map.pyramid = Pyramid::new(size, |i, j| map.weight(i, j));
        let mut squares = 0.0;
        for row in 0..size[1] {
            // cos a − cos b = 2 sin((a + b) / 2) sin((b − a) / 2), which keeps its digits at the poles.
            let (a, b) = (colatitude(row), colatitude(row + 1));
            let solid_angle = 2.0 * (0.5 * (a + b)).sin() * (0.5 * (b - a)).sin() * TAU / size[0] as f64;
            for column in 0..size[0] {
                let mean = 0.25 * map.corners(column, row).map(strength).iter().sum::<f64>();
                map.flux += mean * solid_angle;
                squares += mean * mean * solid_angle;
            }
        }
        if squares > 0.0 {
            map.spread = map.flux * map.flux / (2.0 * TAU * squares);
        }
        map
    }

    /// Colors at the corners of a cell: left and right of its upper row, then of its lower.
    #[inline]
    fn corners(&self, column: usize, row: usize) -> [Rgb; 4] {
        let (width, last) = (self.picture.width(), self.picture.height() - 1);
        let next = if column + 1 == width { 0 } else { column + 1 };
        let (upper, lower) = (row.saturating_sub(1), row.min(last));
        let at = |i, j| self.picture.at(i, j);
        [at(column, upper), at(next, upper), at(column, lower), at(next, lower)]
    }

    /// Sampling weight of a cell: its flux by the radiance at its corners.
    #[inline]
    fn weight(&self, column: usize, row: usize) -> f64 {
        let [a, b, c, d] = self.corners(column, row).map(strength);
        let tall = if row == 0 || row == self.picture.height() { 0.5 } else { 1.0 };
        tall * ((a + b) * self.sines[row] + (c + d) * self.sines[row + 1])
    }

    /// The cell of a direction, the position within it, and the sine of the colatitude.
    #[inline]
    fn place(&self, direction: DVec3) -> ([usize; 2], [f64; 2], f64) {
        let [x, y, z] = self.to_picture.map(|row| row.dot(direction));
        let (width, height) = (self.picture.width(), self.picture.height());
        // Clamped, because the density by solid angle is undefined at a pole.
        let sine = x.hypot(z).max(1e-9);
        let column = (0.5 + x.atan2(-z) / TAU) * width as f64 - 0.5;
        let row = sine.atan2(y) / PI * height as f64 + 0.5;
        let left = column.floor();
        let index = if left < 0.0 { width - 1 } else { (left as usize).min(width - 1) };
        let top = (row as usize).min(height);
        // The cells at the poles are half as high as others.
        let down = match top {
            0 => 2.0 * row - 1.0,
            _ if top == height => 2.0 * (row - top as f64),
            _ => row - top as f64,
        };
        ([index, top], [column - left, down.clamp(0.0, 1.0)], sine)
    }

    /// Radiance within a cell, before scaling, and density by solid angle.
    #[inline]
    fn within(&self, pyramid: &Pyramid, [column, row]: [usize; 2], [x, y]: [f64; 2], sine: f64) -> (Rgb, f64) {
        let corners = self.corners(column, row);
        let radiance = between(corners, [x, y]);
        let [a, b, c, d] = corners.map(strength);
        let (upper, lower) = (a + b, c + d);
        // Vertically the density is linear from one end of the cell to the other, and continuous across cells.
        let (from, to) = (upper * self.sines[row], lower * self.sines[row + 1]);
        let along = 2.0 * (from + (to - from) * y);
        let across = strength(radiance) / (0.5 * (upper + (lower - upper) * y));
        let (width, height) = (self.picture.width() as f64, self.picture.height() as f64);
        let pdf = along * across / (pyramid.total() * (TAU / width * (PI / height) * sine));
        (radiance, if pdf.is_finite() { pdf } else { 0.0 })
    }
}

/// Bilinear interpolation between the corners of a cell.
#[inline]
fn between([a, b, c, d]: [Rgb; 4], [x, y]: [f64; 2]) -> Rgb {
    (a * (1.0 - x) + b * x) * (1.0 - y) + (c * (1.0 - x) + d * x) * y
}

impl Light for EnvironmentMap {
    fn validate(&self) -> Result<(), String> {
        let orthonormal = (0..3).all(|i| {
            (0..3).all(|j| {
                let dot = self.to_picture[i].dot(self.to_picture[j]);
                (dot - f64::from(u8::from(i == j))).abs() < 1e-6
            })
        });
        let most = self.flux * self.scale;
        if !orthonormal {
            Err("an environment map's to_world must be a rotation".into())
        } else if self.scale >= 0.0 && self.scale.is_finite() && most.is_finite() {
            Ok(())
        } else {
            Err(format!("an environment map's scale is {}, expected finite and not negative", self.scale))
        }
    }

    fn reach(&self) -> Reach {
        Reach::Infinite { flux: self.flux * self.scale, spread: self.spread }
    }

    #[inline]
    fn sample(&self, _: &LightSampleContext, u: [f64; 2]) -> Option<LightSample> {
        let pyramid = self.pyramid.as_ref()?;
        let (cell, [u, v]) = pyramid.sample(u, |i, j| self.weight(i, j));
        let [a, b, c, d] = self.corners(cell[0], cell[1]).map(strength);
        let y = linear(v, (a + b) * self.sines[cell[1]], (c + d) * self.sines[cell[1] + 1]);
        let x = linear(u, a + (c - a) * y, b + (d - b) * y);
        let (width, height) = (self.picture.width() as f64, self.picture.height());
        // The first row of cells begins at the top edge, and the last ends at the bottom edge.
        let row = match cell[1] {
            0 => 0.5 * y,
            last if last == height => last as f64 - 0.5 + 0.5 * y,
            row => row as f64 - 0.5 + y,
        };
        let (sine, cosine) = (row / height as f64 * PI).sin_cos();
        let (sin, cos) = (((cell[0] as f64 + 0.5 + x) / width - 0.5) * TAU).sin_cos();
        let local = [sine * sin, cosine, -sine * cos];
        let direction: DVec3 = (0..3).map(|i| self.to_picture[i] * local[i]).sum();
        let (radiance, pdf) = self.within(pyramid, cell, [x, y], sine);
        let weight = radiance * (self.scale / pdf);
        (pdf > 0.0 && sine > 0.0).then_some(LightSample::of_infinite(direction, weight, pdf))
    }

    #[inline]
    fn infinite_radiance(&self, direction: DVec3) -> Rgb {
        let ([column, row], within, _) = self.place(direction);
        between(self.corners(column, row), within) * self.scale
    }

    #[inline]
    fn infinite_pdf(&self, _: &LightSampleContext, direction: DVec3) -> f64 {
        let Some(pyramid) = &self.pyramid else { return 0.0 };
        let (cell, within, sine) = self.place(direction);
        self.within(pyramid, cell, within, sine).1
    }

    fn bytes(&self) -> usize {
        self.picture.bytes() + size_of_val(self.sines.as_slice()) + self.pyramid.as_ref().map_or(0, Pyramid::bytes)
    }
}
