//! Daylight: sun and clear sky.

mod perez;
pub mod sun;
#[cfg(test)]
mod tests;
mod twilight;

pub use perez::Perez;

use super::light::strength;
use super::pyramid::Pyramid;
use super::{Light, LightSample, LightSampleContext, Reach};
use raywright_base::math::{DVec3, Frame};
use raywright_optics::Rgb;
use std::f64::consts::{PI, TAU};

/// A clear sky with the sun above a ground plane of uniform reflectance.
///
/// The sun is a disk of uniform radiance, sampled in its cone. The sky is sampled by a table, and the ground uniformly.
#[derive(Clone, Debug)]
pub struct SunSky {
    /// Frame with z up.
    frame: Frame,
    /// Unit direction to the sun.
    sun: DVec3,
    /// Direction to the brightest part of the sky: the sun or, after sunset, the horizon above it.
    glow: DVec3,
    sun_radiance: Rgb,
    sky: Perez,
    sky_scale: f64,
    ground: Rgb,
    turbidity: f64,
    albedo: Rgb,
    /// Fluxes of sun, sky and ground, means of the channels.
    flux: [f64; 3],
    /// Sampling weights of the sky's cells: sectors about the zenith, and bands of equal height from the horizon to it.
    weights: Vec<f64>,
    pyramid: Option<Pyramid>,
    spread: f64,
}

const COLUMNS: usize = 128;
const ROWS: usize = 64;

/// Probability of sampling the sun, if it is visible.
const SUN_SHARE: f64 = 0.5;

/// Lower bound of a cell's weight, relative to the mean.
const LEAST: f64 = 1e-3;

impl SunSky {
    /// Creates a sky for a sun in a direction of any non-zero length, a turbidity from 2, clear, to 10, hazy, and a
    /// ground reflectance. `scales` multiply the light of sun and sky. The sky model ends with the sun at the horizon
    /// defined by `up`. Below it, the sky at the horizon is darkened by a twilight model.
    ///
    /// Radiance is in W·sr⁻¹·m⁻², weighted by the eye's sensitivity: its luminance times 683 lm·W⁻¹ is in cd·m⁻².
    pub fn new([sun, up]: [DVec3; 2], turbidity: f64, albedo: Rgb, scales: [f64; 2]) -> Self {
        let unit = |v: DVec3| (v / v.abs().max_element()).normalize();
        let (sun, frame) = (unit(sun), Frame::new(unit(up)));
        let height = sun.dot(frame.normal);
        // With the sun straight below any side would do, because no light is left.
        let glow = if height < 0.0 { (sun - frame.normal * height).normalize_or(frame.tangent) } else { sun };
        let (sky, sky_scale) = (Perez::new(height.max(0.0), turbidity), scales[1] * twilight::share(height));
        let is_up = height > -sun::RADIUS.sin();
        let sun_radiance = if is_up { sun::radiance(height, turbidity) * scales[0] } else { Rgb::ZERO };
        let mut all = Self {
            frame,
            sun,
            glow,
            sun_radiance,
            sky,
            sky_scale,
            ground: Rgb::ZERO,
            turbidity,
            albedo,
            flux: [strength(sun_radiance) * sun::solid_angle(), 0.0, 0.0],
            weights: Vec::new(),
            pyramid: None,
            spread: 0.0,
        };
        all.survey();
        all
    }

    /// Computes the weights of the sky, and the irradiance of the ground.
    fn survey(&mut self) {
        let cell = TAU / (COLUMNS * ROWS) as f64;
        let (mut sky, mut down, mut squares) = (Rgb::ZERO, Rgb::ZERO, 0.0);
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                // Four points of each cell: the maximum gives its weight, and all contribute to the sums.
                let mut most = 0.0f64;
                for (x, y) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                    let direction = self.inside(column, row, [x, y]);
                    let radiance = self.sky_at(direction);
                    most = most.max(strength(radiance));
                    sky += radiance * (0.25 * cell);
                    down += radiance * (0.25 * cell * self.frame.normal.dot(direction));
                    squares += 0.25 * cell * strength(radiance).powi(2);
                }
                self.weights.push(most);
            }
        }
        let mean = self.weights.iter().sum::<f64>() / self.weights.len() as f64;
        self.weights.iter_mut().for_each(|weight| *weight += LEAST * mean);
        self.pyramid = Pyramid::new([COLUMNS, ROWS], |i, j| self.weights[j * COLUMNS + i]);
        let sun = self.sun_radiance * (sun::solid_angle() * self.sun.dot(self.frame.normal).max(0.0));
        self.ground = self.albedo * (down + sun) / PI;
        self.flux = [self.flux[0], strength(sky), TAU * strength(self.ground)];
        squares += sun::solid_angle() * strength(self.sun_radiance).powi(2) + TAU * strength(self.ground).powi(2);
        let whole: f64 = self.flux.iter().sum();
        self.spread = if squares > 0.0 { whole * whole / (2.0 * TAU * squares) } else { 1.0 };
    }

    /// A direction within a cell of the sky.
    fn inside(&self, column: usize, row: usize, [x, y]: [f64; 2]) -> DVec3 {
        let cosine = (row as f64 + y) / ROWS as f64;
        let (sin, cos) = ((column as f64 + x) / COLUMNS as f64 * TAU).sin_cos();
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        self.frame.to_world(DVec3::new(sine * cos, sine * sin, cosine))
    }

    /// Radiance of the sky without the sun, above the horizon.
    fn sky_at(&self, direction: DVec3) -> Rgb {
        self.sky.radiance(direction.dot(self.frame.normal), direction.dot(self.glow)) * self.sky_scale
    }

    /// Returns whether a direction is within the sun's disk. The chord between two unit vectors is twice the sine of
    /// half their angle.
    fn is_sun(&self, direction: DVec3) -> bool {
        (direction - self.sun).length() <= 2.0 * (0.5 * sun::RADIUS).sin()
    }

    /// Probabilities of sampling sun, sky and ground for a receiver.
    #[inline]
    fn shares(&self, receiver: &LightSampleContext) -> [f64; 3] {
        let (sees_sun, above) = if receiver.is_free() {
            (true, 0.5)
        } else {
            let height = receiver.normal.dot(self.frame.normal).clamp(-1.0, 1.0);
            (receiver.normal.dot(self.sun) > -sun::RADIUS.sin(), 0.5 + 0.5 * height)
        };
        let [sky, ground] = [self.flux[1] * above, self.flux[2] * (1.0 - above)];
        let rest = sky + ground;
        let sun = match (sees_sun && self.flux[0] > 0.0, rest > 0.0) {
            (true, true) => SUN_SHARE,
            (true, false) => 1.0,
            (false, _) => 0.0,
        };
        if rest > 0.0 { [sun, (1.0 - sun) * (sky / rest), (1.0 - sun) * (ground / rest)] } else { [sun, 0.0, 0.0] }
    }

    /// Density of the sky's table.
    fn sky_pdf(&self, local: DVec3) -> f64 {
        let Some(pyramid) = &self.pyramid else { return 0.0 };
        let turn = (local.y.atan2(local.x) / TAU).rem_euclid(1.0);
        let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
        let row = ((local.z * ROWS as f64) as usize).min(ROWS - 1);
        self.weights[row * COLUMNS + column] / pyramid.total() * (COLUMNS * ROWS) as f64 / TAU
    }
}

impl Light for SunSky {
    fn validate(&self) -> Result<(), String> {
        if self.sun.dot(self.frame.normal).is_nan() {
            Err("a sun must have a direction".into())
        } else if !(2.0..=10.0).contains(&self.turbidity) {
            Err(format!("a sky's turbidity is {}, expected 2 to 10", self.turbidity))
        } else if !(self.albedo.is_radiance() && self.albedo.max() <= 1.0) {
            Err("a ground's albedo must be from 0 to 1".into())
        } else if self.sky_scale >= 0.0 && self.flux.iter().all(|flux| flux.is_finite() && *flux >= 0.0) {
            Ok(())
        } else {
            Err("scales of sun and sky must be finite and not negative".into())
        }
    }

    fn reach(&self) -> Reach {
        Reach::Infinite { flux: self.flux.iter().sum(), spread: self.spread }
    }

    fn sample(&self, receiver: &LightSampleContext, [u, v]: [f64; 2]) -> Option<LightSample> {
        let [sun, sky, ground] = self.shares(receiver);
        let left = |from: f64, share: f64| ((u - from) / share).clamp(0.0, 1.0 - f64::EPSILON / 2.0);
        let direction = if u < sun {
            // Uniform in the height of the cap, 1 − cos, up to 2 sin²(α / 2).
            let height = 2.0 * (0.5 * sun::RADIUS).sin().powi(2) * left(0.0, sun);
            let ((sin, cos), out) = ((TAU * v).sin_cos(), (height * (2.0 - height)).sqrt());
            Frame::new(self.sun).to_world(DVec3::new(out * cos, out * sin, 1.0 - height))
        } else if u < sun + sky {
            let weight = |i: usize, j: usize| self.weights[j * COLUMNS + i];
            let ([column, row], within) = self.pyramid.as_ref()?.sample([left(sun, sky), v], weight);
            self.inside(column, row, within)
        } else if ground > 0.0 {
            let height = left(sun + sky, ground);
            let ((sin, cos), out) = ((TAU * v).sin_cos(), (1.0 - height * height).sqrt());
            self.frame.to_world(DVec3::new(out * cos, out * sin, -height))
        } else {
            return None;
        };
        let pdf = self.infinite_pdf(receiver, direction);
        (pdf > 0.0).then(|| LightSample::of_infinite(direction, self.infinite_radiance(direction) / pdf, pdf))
    }

    fn infinite_radiance(&self, direction: DVec3) -> Rgb {
        // The ground hides the part of the sun below the horizon.
        if direction.dot(self.frame.normal) <= 0.0 {
            self.ground
        } else if self.is_sun(direction) {
            self.sky_at(direction) + self.sun_radiance
        } else {
            self.sky_at(direction)
        }
    }

    fn infinite_pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        let [sun, sky, ground] = self.shares(receiver);
        let local = self.frame.to_local(direction);
        let around = if local.z > 0.0 { sky * self.sky_pdf(local) } else { ground / TAU };
        if self.is_sun(direction) { around + sun / sun::solid_angle() } else { around }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(self.weights.as_slice()) + self.pyramid.as_ref().map_or(0, Pyramid::bytes)
    }
}
