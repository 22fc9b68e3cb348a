//! A projector light.

use super::light::strength;
use super::{Light, LightBounds, LightSample, LightSampleContext, Picture, Place, PointEmission, Reach};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::sync::Arc;

/// A slide projector: a point light whose intensity is an image.
///
/// On a screen perpendicular to its axis, the corners are as bright as the center. The intensity is proportional to the
/// inverse cube of the cosine to the axis, which compensates distance and slant.
#[derive(Clone, Debug)]
pub struct Projector {
    picture: Arc<Picture>,
    position: DVec3,
    /// Unit vectors to the right and the top of the projected image, and along the axis.
    axes: [DVec3; 3],
    /// Tangents of the half angles of the image, horizontal and vertical.
    half: [f64; 2],
    /// Intensity along the axis where the image is 1, W·sr⁻¹.
    intensity: Rgb,
}

impl Projector {
    /// Creates a projector from a position to a target, upright along `up`, with a vertical angle of `fov` radians. The
    /// image is interpolated between texel centers.
    ///
    /// # Errors
    /// A short reason if the positions are the same, or `up` is parallel to their line.
    pub fn new(
        picture: Arc<Picture>,
        [position, target, up]: [DVec3; 3],
        fov: f64,
        intensity: Rgb,
    ) -> Result<Self, String> {
        let axis = (target - position).try_normalize().ok_or("a projector's target must differ from its position")?;
        let right = axis.cross(up).try_normalize().ok_or("a projector's up must not be parallel to its axis")?;
        let tall = (0.5 * fov).tan();
        let half = [tall * picture.width() as f64 / picture.height() as f64, tall];
        Ok(Self { picture, position, axes: [right, right.cross(axis), axis], half, intensity })
    }

    /// Intensity in a unit direction.
    fn towards(&self, direction: DVec3) -> Rgb {
        let [right, up, ahead] = self.axes.map(|axis| axis.dot(direction));
        let (x, y) = (right / ahead / self.half[0], up / ahead / self.half[1]);
        if !(ahead > 0.0 && x.abs() <= 1.0 && y.abs() <= 1.0) {
            return Rgb::ZERO;
        }
        let (width, height) = (self.picture.width(), self.picture.height());
        let place = |x: f64, count: usize| {
            let x = (0.5 * x * count as f64 - 0.5).clamp(0.0, count as f64 - 1.0);
            let low = x.floor();
            (low as usize, (low as usize + 1).min(count - 1), x - low)
        };
        let ((left, next, x), (top, below, y)) = (place(1.0 + x, width), place(1.0 - y, height));
        let row = |row| self.picture.at(left, row) * (1.0 - x) + self.picture.at(next, row) * x;
        let here = row(top) * (1.0 - y) + row(below) * y;
        self.intensity * here / (ahead * ahead * ahead)
    }
}

impl Light for Projector {
    fn validate(&self) -> Result<(), String> {
        let [x, y] = self.half;
        if !(self.position.is_finite() && self.axes.iter().all(|axis| axis.is_finite())) {
            Err("a projector must have a finite position and target".into())
        } else if !(x > 0.0 && y > 0.0 && x.is_finite() && y < 1e9) {
            Err("a projector's fov must be above 0 and below 180 degrees".into())
        } else if self.intensity.is_radiance() {
            Ok(())
        } else {
            Err("a projector's intensity must be finite and not negative".into())
        }
    }

    /// The inverse cube of the cosine is the area on the plane at distance 1 per solid angle. So the power is the
    /// image's mean, neglecting its edges, times its area there.
    fn reach(&self) -> Reach {
        let [x, y] = self.half;
        let (width, height) = (self.picture.width(), self.picture.height());
        let each = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let (sum, most) = each
            .map(|(column, row)| strength(self.intensity * self.picture.at(column, row)))
            .fold((0.0, 0.0f64), |(sum, most), texel| (sum + texel, most.max(texel)));
        let corner = x.hypot(y);
        let peak = most * (1.0 + corner * corner).powf(1.5);
        Reach::Finite {
            power: sum / (width * height) as f64 * 4.0 * x * y,
            bounds: LightBounds::within(self.position, self.axes[2], corner.atan(), peak),
        }
    }

    #[inline]
    fn sample(&self, receiver: &LightSampleContext, _: [f64; 2]) -> Option<LightSample> {
        LightSample::of_point(self.position, receiver, |direction| self.towards(direction))
    }

    /// Samples positions uniformly in the projected image.
    fn sample_emission(&self, u: [f64; 2]) -> Option<PointEmission> {
        let ([x, y], [right, up, ahead]) = (self.half, self.axes);
        let [across, along] = u.map(|u| 2.0 * u - 1.0);
        let way = ahead + right * (x * across) + up * (y * along);
        let (direction, length) = (way.normalize(), way.length());
        // A solid angle is the area on the plane at distance 1 times the cosine cubed, and the cosine is one over the
        // length.
        let pdf = length * length * length / (4.0 * x * y);
        Some(PointEmission { position: self.position, direction, weight: self.towards(direction) / pdf, pdf })
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Point(self.position))
    }

    fn intensity_towards(&self, direction: DVec3, _: Option<&Waves>) -> Rgb {
        self.towards(direction)
    }

    /// The value outside the image is irrelevant, because the intensity there is 0.
    fn emission_pdf(&self, direction: DVec3) -> f64 {
        let (ahead, [x, y]) = (self.axes[2].dot(direction), self.half);
        if ahead > 0.0 { 1.0 / (ahead * ahead * ahead * 4.0 * x * y) } else { 0.0 }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.picture.bytes()
    }
}
