//! The opening of a lens.

use super::CameraError;
use raywright_base::sampling::warp::uniform_disk;
use std::f64::consts::TAU;

/// A disk, or a regular polygon whose corners lie on its edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aperture {
    radius: f64,
    /// Number of sides of the polygon; 0 for a disk.
    blades: u32,
    /// Rotation of the polygon in radians, counterclockwise as the camera looks. At 0 a corner is to the right.
    rotation: f64,
}

impl Aperture {
    /// Creates a disk of this radius. With `blades` it is a regular polygon with that many sides, turned
    /// counterclockwise as the camera looks by an angle in radians.
    ///
    /// # Errors
    /// If the radius is negative or not finite, the angle is not finite, or there are one or two blades.
    pub fn new(radius: f64, blades: u32, rotation: f64) -> Result<Self, CameraError> {
        if !(radius >= 0.0 && radius.is_finite() && rotation.is_finite()) || blades == 1 || blades == 2 {
            return Err(CameraError::Aperture);
        }
        Ok(Self { radius, blades, rotation })
    }

    /// Radius of the disk, or of the circle through the polygon's corners.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Samples a point uniformly by area, right and up from the center. The center of the square maps to the center.
    pub fn point(&self, u: [f64; 2]) -> [f64; 2] {
        let disk = uniform_disk(u) * self.radius;
        if self.blades == 0 {
            return disk.to_array();
        }
        // The squared radius and the angle of a uniform point of a disk are uniform and independent. The angle chooses
        // a point on the polygon's edge, uniform on each side; the radius scales it towards the center. The result is
        // uniform in each of the triangles between the center and a side.
        let sides = f64::from(self.blades);
        let along = (disk.y.atan2(disk.x) / TAU).rem_euclid(1.0) * sides;
        let side = along.floor();
        let part = along - side;
        let corner = |i: f64| (self.rotation + TAU * i / sides).sin_cos();
        let ((y0, x0), (y1, x1)) = (corner(side), corner(side + 1.0));
        let radius = disk.length();
        [radius * (x0 + (x1 - x0) * part), radius * (y0 + (y1 - y0) * part)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::chi_square::assert_frequencies;
    use std::f64::consts::PI;

    /// Returns whether a point is in the polygon, and its least distance to a side over the center's distance to a
    /// side.
    fn within([x, y]: [f64; 2], blades: u32, rotation: f64) -> f64 {
        let inner = (PI / f64::from(blades)).cos();
        (0..blades)
            .map(|i| {
                let (sin, cos) = (rotation + TAU * (f64::from(i) + 0.5) / f64::from(blades)).sin_cos();
                1.0 - (x * cos + y * sin) / inner
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn polygons_are_filled_evenly() {
        // Cells are rings of equal area, cut into halves of the polygon's sides. The probability of a false alarm is
        // that of `assert_frequencies`, for each number of blades; the seed is fixed.
        for (blades, rotation) in [(3, 0.0), (5, 0.3), (6, -2.0), (9, 7.0)] {
            let aperture = Aperture::new(1.0, blades, rotation).unwrap();
            let (rings, sectors) = (6, 2 * blades as usize);
            let mut counts = vec![0; rings * sectors];
            for sample in 0..200_000 {
                let p = aperture.point(Sampler::new(5, blades, sample).two(1));
                let room = within(p, blades, rotation);
                assert!(room > -1e-12, "{p:?}");
                let ring = ((1.0 - room).powi(2) * rings as f64) as usize;
                let angle = (p[1].atan2(p[0]) - rotation).rem_euclid(TAU) / TAU;
                let sector = (angle * sectors as f64) as usize;
                counts[ring.min(rings - 1) * sectors + sector.min(sectors - 1)] += 1;
            }
            assert_frequencies(&counts, &vec![1.0 / (rings * sectors) as f64; rings * sectors]);
        }
    }

    #[test]
    fn disks_are_filled_evenly() {
        let aperture = Aperture::new(2.0, 0, 1.0).unwrap();
        let mut counts = vec![0; 120];
        for sample in 0..200_000 {
            let [x, y] = aperture.point(Sampler::new(6, 1, sample).two(1));
            assert!(x.hypot(y) <= 2.0);
            let ring = (((x * x + y * y) / 4.0 * 10.0) as usize).min(9);
            counts[ring * 12 + (((y.atan2(x) + PI) / TAU * 12.0) as usize).min(11)] += 1;
        }
        assert_frequencies(&counts, &[1.0 / 120.0; 120]);
    }

    #[test]
    fn a_corner_is_where_the_rotation_says_and_the_middle_in_the_middle() {
        let edge = 1.0 - 2f64.powi(-33);
        for blades in [3, 4, 7] {
            for rotation in [0.0, 0.4] {
                let aperture = Aperture::new(3.0, blades, rotation).unwrap();
                assert_eq!(aperture.point([0.5; 2]).map(f64::abs), [0.0; 2]);
                let [x, y] = aperture.point([edge, 0.5]);
                assert!((x - 3.0 * rotation.cos()).abs() < 1e-8 && (y - 3.0 * rotation.sin()).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn refuses_what_is_no_aperture() {
        for (radius, blades, rotation) in [
            (-1.0, 0, 0.0),
            (f64::NAN, 0, 0.0),
            (f64::INFINITY, 0, 0.0),
            (1.0, 1, 0.0),
            (1.0, 2, 0.0),
            (1.0, 5, f64::NAN),
        ] {
            assert_eq!(Aperture::new(radius, blades, rotation), Err(CameraError::Aperture));
        }
    }
}
