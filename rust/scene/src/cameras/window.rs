//! The film of a rectilinear camera, as a window at distance 1.

use super::{CameraError, Viewpoint};
use raywright_base::math::DVec3;

/// The picture length along which an angle of view or a scale is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measured {
    /// Width.
    Width,
    /// Height.
    #[default]
    Height,
    /// The smaller of both; the height if they are equal.
    Smaller,
    /// The larger of both; the height if they are equal.
    Larger,
    /// Diagonal.
    Diagonal,
}

impl Measured {
    /// This length of a picture of a size.
    pub fn of(self, [width, height]: [f64; 2]) -> f64 {
        match self {
            Self::Width => width,
            Self::Height => height,
            Self::Smaller => width.min(height),
            Self::Larger => width.max(height),
            Self::Diagonal => width.hypot(height),
        }
    }
}

/// The film of a pinhole or a lens, projected to distance 1. Its point at (x, y), each from −1 to 1, x to the right and
/// y up, is `centre + (half width · x + skew · y, half height · y)` right of and above the view's center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Half its width and half its height; negative if the picture is mirrored.
    half: [f64; 2],
    /// Its center.
    centre: [f64; 2],
    /// Shift of the upper edge to the right.
    skew: f64,
}

impl Window {
    /// Creates a window with square pixels, from an angle of view in degrees along one of a picture's lengths.
    ///
    /// # Errors
    /// If the angle is not between 0 and 180 degrees.
    pub fn of_view(fov: f64, along: Measured, size: [f64; 2]) -> Result<Self, CameraError> {
        if !(fov > 0.0 && fov < 180.0) {
            return Err(CameraError::FieldOfView);
        }
        let half = (0.5 * fov).to_radians().tan();
        let [width, height] = size;
        // Each branch is exact along the measured length.
        let length = along.of(size);
        let half = match length {
            _ if length == height => [half * width / height, half],
            _ if length == width => [half, half * height / width],
            _ => [half * width / length, half * height / length],
        };
        Ok(Self { half, centre: [0.0; 2], skew: 0.0 })
    }

    /// Creates a window from a camera matrix: focal lengths in pixels, the principal point in pixels from the film's
    /// left and top, and the skew. A point at (x, y) right and down at distance 1 projects to `focal[0] x + skew y +
    /// principal[0]`, `focal[1] y + principal[1]`. Negative focal lengths mirror the picture.
    ///
    /// # Errors
    /// If a focal length is zero, or a number is not finite.
    pub fn of_matrix(
        focal: [f64; 2],
        principal: [f64; 2],
        skew: f64,
        [width, height]: [f64; 2],
    ) -> Result<Self, CameraError> {
        let half = [0.5 * width / focal[0], 0.5 * height / focal[1]];
        let window = Self { half, centre: [0.0; 2], skew: skew / focal[0] * half[1] };
        window.seen_from(principal, [width, height])
    }

    /// Shifts the window so that the view's center projects to a film point, in pixels from the left and the top.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn seen_from(self, principal: [f64; 2], [width, height]: [f64; 2]) -> Result<Self, CameraError> {
        let [x, y] = [2.0 * principal[0] / width - 1.0, 1.0 - 2.0 * principal[1] / height];
        let centre = [-(self.half[0] * x + self.skew * y), -self.half[1] * y];
        let numbers = [self.half[0], self.half[1], self.skew, centre[0], centre[1]];
        if !numbers.iter().all(|n| n.is_finite()) || self.half.contains(&0.0) {
            return Err(CameraError::Film);
        }
        // Adding 0 turns −0 into 0, so that equal windows compare equal.
        Ok(Self { centre: centre.map(|c| c + 0.0), ..self })
    }

    /// Position at distance 1, right and up, of a film point from −1 to 1.
    #[inline(always)]
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.centre[0] + self.half[0] * x + self.skew * y, self.centre[1] + self.half[1] * y]
    }

    /// The inverse of [`Window::point`].
    pub(super) fn film(&self, [right, up]: [f64; 2]) -> [f64; 2] {
        let y = (up - self.centre[1]) / self.half[1];
        [(right - self.centre[0] - self.skew * y) / self.half[0], y]
    }

    /// Projects a point given by its right, up and forward coordinates onto a film shifted right and up. Returns the
    /// film position in pixels and the density of [`CameraConnection`](super::CameraConnection), or `None` for points
    /// that are not in front.
    pub(super) fn connect(
        &self,
        [right, up, along]: [f64; 3],
        shift: [f64; 2],
        size: [f64; 2],
    ) -> Option<([f64; 2], f64)> {
        if along.is_nan() || along <= 0.0 {
            return None;
        }
        let film = to_pixels(self.film([right / along + shift[0], up / along + shift[1]]), size);
        // Pixels over area at distance 1. An area perpendicular to the ray projects there with a factor cos θ / z²: the
        // ray's slant to the film plane, and the distance z along the view. Here cos θ = z / d.
        let pixels = size[0] * size[1] / (4.0 * self.half[0] * self.half[1]).abs();
        let slant = DVec3::new(right, up, along).length() / along;
        Some((film, pixels * slant / (along * along)))
    }

    /// The film's center seen from a viewpoint, and the vectors that x and y multiply.
    pub fn axes(&self, from: &Viewpoint) -> [DVec3; 3] {
        let [x, y] = self.centre;
        let middle = if self.centre == [0.0; 2] { from.forward } else { from.direction(x, y, 1.0) };
        let up = from.up * self.half[1];
        let up = if self.skew == 0.0 { up } else { up + from.right * self.skew };
        [middle, from.right * self.half[0], up]
    }

    /// Linear forms that map a point relative to a viewpoint to its x, its y and its distance along the view. The film
    /// position is x and y over that distance. Also returns a bound on each form and on its rounding error, as
    /// multiples of the point's distance.
    pub fn onto_film(&self, from: &Viewpoint) -> ([DVec3; 3], f64) {
        let ([width, height], [x, y], skew) = (self.half, self.centre, self.skew);
        let up = (from.up - from.forward * y) / height;
        let right = (from.right - from.forward * x - up * skew) / width;
        let size = 1.0 + x.abs() + y.abs() + skew.abs();
        let stretch = (size / width.abs()).max(size / height.abs()) * (1.0 + skew.abs() / height.abs());
        ([right, up, from.forward], stretch.max(1.0))
    }

    /// Angle between adjacent rays at the center, in radians.
    pub fn pixel_angle(&self, [width, height]: [f64; 2]) -> f64 {
        (2.0 * self.half[0] / width * (2.0 * self.half[1] / height)).abs().sqrt()
    }
}

/// Converts pixels from the left and the top to a film point from −1 to 1, x to the right and y up.
#[inline(always)]
pub(super) fn from_middle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> [f64; 2] {
    [2.0 * x / width - 1.0, 1.0 - 2.0 * y / height]
}

/// The inverse of [`from_middle`].
pub(super) fn to_pixels([x, y]: [f64; 2], [width, height]: [f64; 2]) -> [f64; 2] {
    [0.5 * width * (1.0 + x), 0.5 * height * (1.0 - y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_is_along_what_is_measured() {
        let size = [4.0, 3.0];
        let half = |along| Window::of_view(90.0, along, size).unwrap().half;
        let tan = 45f64.to_radians().tan();
        assert_eq!(half(Measured::Height)[1], tan);
        assert_eq!(half(Measured::Width)[0], tan);
        assert_eq!(half(Measured::Smaller), half(Measured::Height));
        assert_eq!(half(Measured::Larger), half(Measured::Width));
        let [x, y] = half(Measured::Diagonal);
        assert!((x.hypot(y) - tan).abs() < 1e-15);
        for along in [Measured::Width, Measured::Height, Measured::Diagonal] {
            let [x, y] = half(along);
            assert!((x / y - 4.0 / 3.0).abs() < 1e-15);
        }
        for fov in [0.0, 180.0, -5.0, f64::NAN] {
            assert_eq!(Window::of_view(fov, Measured::Height, size), Err(CameraError::FieldOfView));
        }
    }

    #[test]
    fn a_matrix_projects_as_it_says() {
        let (focal, principal, skew, size) = ([300.0, 250.0], [70.0, 20.0], 15.0, [128.0, 96.0]);
        let window = Window::of_matrix(focal, principal, skew, size).unwrap();
        for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-1.0, 4.0)] {
            let pixel = [focal[0] * x + skew * y + principal[0], focal[1] * y + principal[1]];
            let [right, up] = window.point(from_middle(pixel, size));
            assert!((right - x).abs() < 1e-15 * 8.0 && (up + y).abs() < 1e-15 * 8.0, "{right} {up}");
        }
        // Square pixels about the center equal those of an angle of view.
        let plain = Window::of_matrix([48.0; 2], [64.0, 48.0], 0.0, size).unwrap();
        let view = Window::of_view(90.0, Measured::Height, size).unwrap();
        assert!((plain.half[0] - view.half[0]).abs() < 1e-15 && (plain.half[1] - view.half[1]).abs() < 1e-15);
        assert_eq!(plain.centre, [0.0; 2]);
        for (focal, principal, skew) in [
            ([0.0, 1.0], [0.0; 2], 0.0),
            ([1.0, f64::INFINITY], [0.0; 2], 0.0),
            ([1.0; 2], [f64::NAN, 0.0], 0.0),
            ([1.0; 2], [0.0; 2], f64::INFINITY),
        ] {
            assert_eq!(Window::of_matrix(focal, principal, skew, size), Err(CameraError::Film));
        }
    }

    #[test]
    fn what_goes_through_the_film_is_seen_there() {
        let from = Viewpoint::towards(DVec3::ZERO, DVec3::new(0.3, -0.4, 1.0), DVec3::new(0.2, 1.0, 0.1)).unwrap();
        let window = Window::of_matrix([300.0, -250.0], [700.0, 20.0], 40.0, [128.0, 96.0]).unwrap();
        let [middle, right, up] = window.axes(&from);
        let ([x, y, distance], stretch) = window.onto_film(&from);
        for film in [[0.0, 0.0], [-1.0, 1.0], [0.4, 0.7]] {
            let p = 3.0 * (middle + right * film[0] + up * film[1]);
            let [px, py] = window.point(film);
            assert!((p / 3.0 - from.direction(px, py, 1.0)).length() < 1e-15 * 8.0);
            assert!((p.dot(distance) - 3.0).abs() < 1e-13);
            assert!((p.dot(x) / 3.0 - film[0]).abs() < 1e-13 && (p.dot(y) / 3.0 - film[1]).abs() < 1e-13);
            assert!(x.length() <= stretch && y.length() <= stretch);
        }
    }
}
