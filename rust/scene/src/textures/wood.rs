//! Wood.

use super::periodic_functions::ramp;
use super::{Domain, Needs, Octaves, Pattern, TexturePoint};
use raywright_base::math::DVec3;

/// Growth rings about the z axis with period 1 in radius, from light early wood to dark late wood and sharply back,
/// distorted by noise (Perlin, "An Image Synthesizer", 1985; after Peachey, "Solid Texturing of Complex Surfaces",
/// 1985). Rings below the footprint fade to their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wood {
    /// Domain.
    pub domain: Domain,
    /// Amplitude of the distortion, in units.
    pub distortion: f64,
    /// The noise, stretched along the trunk.
    pub octaves: Octaves,
}

impl Wood {
    /// Share of a ring in which it darkens.
    const RISE: f64 = 0.85;

    /// Stretch of the noise along the trunk.
    const ALONG: f64 = 8.0;
}

impl Pattern for Wood {
    #[inline]
    fn amount(&self, point: &TexturePoint) -> f64 {
        let place = self.domain.place(point);
        let size = place.size();
        let p = place.point;
        let drawn = DVec3::new(p.x, p.y, p.z / Self::ALONG);
        let radius = p.x.hypot(p.y) + self.distortion * self.octaves.sum(drawn, size);
        let width = size * 1f64.hypot(self.distortion * self.octaves.slope(size));
        ramp(radius, width, Self::RISE)
    }

    fn needs(&self) -> Needs {
        self.domain.needs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::ObjectTransform;
    use super::*;

    #[test]
    fn without_distortion_it_is_rings() {
        let wood =
            Wood { domain: Domain::Object(ObjectTransform::default()), distortion: 0.0, octaves: Octaves::default() };
        let amount = |position, size| wood.amount(&TexturePoint { position, size, ..TexturePoint::default() });
        for (radius, expected) in [(0.0, 0.0), (0.425, 0.5), (0.925, 0.5), (1.17, 0.2), (7.34, 0.4)] {
            for (angle, z) in [(0.0f64, 0.0), (1.0, 5.0), (4.0, -9.0)] {
                let position = DVec3::new(radius * angle.cos(), radius * angle.sin(), z);
                assert!((amount(position, 0.0) - expected).abs() < 1e-12);
                assert!((amount(position, 2.0) - 0.5).abs() < 1e-12);
            }
        }
    }
}
