//! A point that shines into a cone.

use super::light::strength;
use super::{Light, LightBounds, LightSample, LightSampleContext, Place, PointEmission, Reach};
use raywright_base::math::{DVec3, Frame};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How light falls off towards the rim of a cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// A cubic of the cosine to the axis, with level ends.
    Smooth,
    /// Evenly with the angle to the axis.
    Linear,
}

/// A light without extent that shines into a cone: evenly in its middle, then falling off to its rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    position: DVec3,
    axis: DVec3,
    intensity: Rgb,
    /// The cosines of the angles to the axis up to which all shines, and from which on nothing does.
    cosines: [f64; 2],
    angle: f64,
    falloff: f64,
    profile: Profile,
}

impl SpotLight {
    /// A spot at a position that shines along an axis of any length but 0 with a radiant intensity, W·sr⁻¹, into
    /// directions within `angle` of it, radians, in the last `falloff` of which it falls off.
    pub fn new(position: DVec3, axis: DVec3, intensity: Rgb, angle: f64, falloff: f64) -> Self {
        let axis = (axis / axis.abs().max_element()).normalize();
        // A cosine of next to nothing is 0 at a right angle: what is in its plane is not lit.
        let cosine = |a: f64| if a >= FRAC_PI_2 { 0.0 } else { a.cos() };
        let cosines = [cosine(angle - falloff), cosine(angle)];
        Self { position, axis, intensity, cosines, angle, falloff, profile: Profile::Smooth }
    }

    /// The same spot, falling off in another way.
    pub fn with_profile(self, profile: Profile) -> Self {
        Self { profile, ..self }
    }

    /// The share of the intensity along a unit direction.
    fn share(&self, direction: DVec3) -> f64 {
        let cosine = self.axis.dot(direction);
        let [inner, outer] = self.cosines;
        if cosine <= outer {
            return 0.0;
        } else if cosine >= inner {
            return 1.0;
        }
        match self.profile {
            Profile::Smooth => {
                let x = (cosine - outer) / (inner - outer);
                x * x * (3.0 - 2.0 * x)
            }
            Profile::Linear => ((self.angle - cosine.clamp(-1.0, 1.0).acos()) / self.falloff).clamp(0.0, 1.0),
        }
    }
}

impl SpotLight {
    /// 1 − cos of the cone, by half the angle, which keeps its digits where the cone is narrow.
    fn height(&self) -> f64 {
        if self.cosines[1] == 0.0 { 1.0 } else { 2.0 * (0.5 * self.angle).sin().powi(2) }
    }
}

impl Light for SpotLight {
    fn validate(&self) -> Result<(), String> {
        if !(self.position.is_finite() && self.intensity.is_radiance()) {
            Err("a spot light must have a finite position and an intensity that is finite and not negative".into())
        } else if !self.axis.is_finite() {
            Err("a spot light must have a direction of a length other than 0".into())
        } else if !(self.angle > 0.0 && self.angle <= FRAC_PI_2) {
            Err(format!("a spot light's angle is {}, expected above 0 and at most 90 degrees", self.angle.to_degrees()))
        } else if !(self.falloff >= 0.0 && self.falloff <= self.angle) {
            Err(format!("a spot light's falloff is {}, expected 0 to its angle", self.falloff.to_degrees()))
        } else {
            Ok(())
        }
    }

    /// The power is exact. Of the smooth falloff, which is odd about its middle, the mean over cosines is a half; of
    /// the linear one, ∫ (b − θ) / (b − a) sin θ dθ from a to b is cos a less the mean of cos θ, which is written so
    /// that it keeps its digits however near a and b are.
    fn reach(&self) -> Reach {
        let intensity = strength(self.intensity);
        let [inner, outer] = self.cosines;
        let falling = match self.profile {
            Profile::Linear if self.falloff > 0.0 => {
                let half = 0.5 * self.falloff;
                inner - (self.angle - half).cos() * half.sin() / half
            }
            _ => 0.5 * (inner - outer),
        };
        let power = 2.0 * PI * intensity * (1.0 - inner + falling);
        Reach::Finite { power, bounds: LightBounds::within(self.position, self.axis, self.angle, intensity) }
    }

    #[inline]
    fn sample(&self, receiver: &LightSampleContext, _: [f64; 2]) -> Option<LightSample> {
        LightSample::of_point(self.position, receiver, |direction| self.intensity * self.share(direction))
    }

    /// Even in the cone.
    fn sample_emission(&self, [u, v]: [f64; 2]) -> Option<PointEmission> {
        let most = self.height();
        let height = most * u;
        let ((sin, cos), out) = ((TAU * v).sin_cos(), (height * (2.0 - height)).sqrt());
        let direction = Frame::new(self.axis).to_world(DVec3::new(out * cos, out * sin, 1.0 - height));
        let pdf = 1.0 / (TAU * most);
        let weight = self.intensity * (self.share(direction) / pdf);
        Some(PointEmission { position: self.position, direction, weight, pdf })
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Point(self.position))
    }

    fn intensity_towards(&self, direction: DVec3, _: Option<&Waves>) -> Rgb {
        self.intensity * self.share(direction)
    }

    /// Beyond the cone it does not matter: nothing is sent there.
    fn emission_pdf(&self, _: DVec3) -> f64 {
        1.0 / (TAU * self.height())
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
