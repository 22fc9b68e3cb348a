//! A spot light.

use super::light::strength;
use super::{Light, LightBounds, LightSample, LightSampleContext, Place, PointEmission, Reach};
use raywright_base::math::{DVec3, Frame};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Falloff profile towards the rim of the cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// A cubic of the cosine to the axis, with zero slope at both ends.
    Smooth,
    /// Linear in the angle to the axis.
    Linear,
}

/// A point light that emits into a cone: uniform in its center, with a falloff to its rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    position: DVec3,
    axis: DVec3,
    intensity: Rgb,
    /// Cosines of the angles to the axis where the falloff begins and ends.
    cosines: [f64; 2],
    angle: f64,
    falloff: f64,
    profile: Profile,
}

impl SpotLight {
    /// Creates a spot at a position along an axis of any non-zero length. It emits a radiant intensity, W·sr⁻¹, within
    /// `angle` radians of the axis and falls off over the last `falloff` radians.
    pub fn new(position: DVec3, axis: DVec3, intensity: Rgb, angle: f64, falloff: f64) -> Self {
        let axis = (axis / axis.abs().max_element()).normalize();
        // At a right angle the cosine rounds to a tiny positive number; 0 keeps the plane of the light dark.
        let cosine = |a: f64| if a >= FRAC_PI_2 { 0.0 } else { a.cos() };
        let cosines = [cosine(angle - falloff), cosine(angle)];
        Self { position, axis, intensity, cosines, angle, falloff, profile: Profile::Smooth }
    }

    /// Sets the falloff profile.
    pub fn with_profile(self, profile: Profile) -> Self {
        Self { profile, ..self }
    }

    /// Relative intensity in a unit direction.
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
    /// 1 − cos of the cone from half the angle, which keeps its digits for a narrow cone.
    fn height(&self) -> f64 {
        if self.cosines[1] == 0.0 { 1.0 } else { 2.0 * (0.5 * self.angle).sin().powi(2) }
    }
}

impl Light for SpotLight {
    fn validate(&self) -> Result<(), String> {
        if !(self.position.is_finite() && self.intensity.is_radiance()) {
            Err("a spot light must have a finite position and an intensity that is finite and not negative".into())
        } else if !self.axis.is_finite() {
            Err("a spot light must have a nonzero direction".into())
        } else if !(self.angle > 0.0 && self.angle <= FRAC_PI_2) {
            Err(format!("a spot light's angle is {}, expected above 0 and at most 90 degrees", self.angle.to_degrees()))
        } else if !(self.falloff >= 0.0 && self.falloff <= self.angle) {
            Err(format!("a spot light's falloff is {}, expected 0 to its angle", self.falloff.to_degrees()))
        } else {
            Ok(())
        }
    }

    /// The power is exact. The smooth falloff is odd about its middle, so its mean over cosines is one half. For the
    /// linear one, ∫ (b − θ) / (b − a) sin θ dθ from a to b is cos a minus the mean of cos θ; the form used keeps its
    /// digits however close a and b are.
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

    /// Samples directions uniformly in the cone.
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

    /// The value outside the cone is irrelevant, because the intensity there is 0.
    fn emission_pdf(&self, _: DVec3) -> f64 {
        1.0 / (TAU * self.height())
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
