//! Domains of procedural textures: texture coordinates, or the shape's space.

use super::{Needs, TexturePoint};
use raywright_base::math::DVec3;

/// An affine map of texture coordinates: two rows that act on columns (u, v, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform(pub [[f64; 3]; 2]);

impl Default for UvTransform {
    /// The identity.
    fn default() -> Self {
        Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    }
}

impl UvTransform {
    /// Maps texture coordinates.
    #[inline]
    pub fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        self.0.map(|[a, b, c]| a * u + b * v + c)
    }

    /// Factors by which a circle widens along each of the mapped coordinates.
    #[inline]
    pub fn stretch(&self) -> [f64; 2] {
        self.0.map(|[a, b, _]| a.hypot(b))
    }

    /// Determinant of the linear part.
    #[inline]
    pub fn determinant(&self) -> f64 {
        let [[a, b, _], [c, d, _]] = self.0;
        a * d - b * c
    }
}

/// An affine map from the space of a shape to that of a texture: three rows that act on columns (x, y, z, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectTransform(pub [[f64; 4]; 3]);

impl Default for ObjectTransform {
    /// The identity.
    fn default() -> Self {
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    }
}

/// The domain of a procedural texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// On the surface: x and y are texture coordinates, z is 0.
    Uv(UvTransform),
    /// In space, as if the shape were carved from a block.
    Object(ObjectTransform),
}

/// A point of a domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DomainPoint {
    pub point: DVec3,
    /// Distance of adjacent rays along each axis.
    pub widths: DVec3,
    /// Number of axes in use: 2 or 3.
    pub axes: usize,
}

impl DomainPoint {
    /// Distance of adjacent rays as one number: the root mean square over the axes.
    #[inline]
    pub fn size(&self) -> f64 {
        (self.widths.length_squared() / self.axes as f64).sqrt()
    }
}

impl Domain {
    /// Maps a lookup point to the domain.
    #[inline]
    pub(super) fn place(&self, point: &TexturePoint) -> DomainPoint {
        match self {
            Self::Uv(map) => {
                let ([x, y], [across, up]) = (map.point(point.uv), map.stretch());
                let widths = DVec3::new(across, up, 0.0) * point.width;
                DomainPoint { point: DVec3::new(x, y, 0.0), widths, axes: 2 }
            }
            Self::Object(ObjectTransform(rows)) => {
                let p = point.position;
                let at = rows.map(|[a, b, c, d]| a * p.x + b * p.y + c * p.z + d);
                let stretch = rows.map(|[a, b, c, _]| DVec3::new(a, b, c).length());
                DomainPoint { point: at.into(), widths: DVec3::from_array(stretch) * point.size, axes: 3 }
            }
        }
    }

    /// The lookup data that the map needs.
    pub(super) fn needs(&self) -> Needs {
        match self {
            Self::Uv(_) => Needs { uv: true, width: true, ..Needs::NONE },
            Self::Object(_) => Needs { position: true, width: true, ..Needs::NONE },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_widths_go_with_the_map() {
        let point = TexturePoint {
            uv: [0.5, 2.0],
            width: 0.1,
            position: DVec3::new(1.0, 2.0, 3.0),
            size: 0.5,
            ..TexturePoint::default()
        };
        let on = Domain::Uv(UvTransform([[3.0, 4.0, 1.0], [0.0, 2.0, -1.0]])).place(&point);
        assert_eq!((on.point, on.widths), (DVec3::new(10.5, 3.0, 0.0), DVec3::new(0.5, 0.2, 0.0)));
        let rows = [[0.0, 2.0, 0.0, 1.0], [3.0, 0.0, 4.0, 0.0], [0.0, 0.0, -1.0, 9.0]];
        let inside = Domain::Object(ObjectTransform(rows)).place(&point);
        assert_eq!((inside.point, inside.widths), (DVec3::new(5.0, 15.0, 6.0), DVec3::new(1.0, 2.5, 0.5)));
        // A uniform scaling scales the size.
        let even = ObjectTransform([[0.0, 7.0, 0.0, 0.0], [7.0, 0.0, 0.0, 0.0], [0.0, 0.0, 7.0, 0.0]]);
        assert!((Domain::Object(even).place(&point).size() - 3.5).abs() < 1e-15);
        assert!((Domain::Uv(UvTransform::default()).place(&point).size() - 0.1).abs() < 1e-16);
    }
}
