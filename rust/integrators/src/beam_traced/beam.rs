//! Beams and the projection of faces into them.
//!
//! A flat mirror turns a beam into one from the mirror image of the eye. In film coordinates each ray of a beam is
//! `apex + t · direction(x, y)`. The direction is linear in x and y after any number of mirrors, and of faces of glass
//! with linearized refraction (`next_beams.rs`). So all clipping is done in the film plane: straight edges project to
//! straight edges, and 1 / t, the nearness, is linear in x and y on every plane.

use glam::DMat3;
use raywright_accel::Primitives;
use raywright_base::math::convex::{Convex, HalfPlane, above, area, sides};
use raywright_base::math::{DVec2, DVec3, Ray};
use raywright_scene::{Camera, Geometry, Perspective};

/// Distance, in pixels, below which corners are on a line of the film.
pub(super) const ON_LINE: f64 = 1e-11;

/// Size, in pixels, below which polygons are dropped.
pub(super) const LEAST: f64 = 1e-13;

/// The half-space of points x with `normal · x` above an offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub normal: DVec3,
    pub offset: f64,
}

/// The face that a beam comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin {
    /// Index of the beam that hit the face.
    pub beam: usize,
    pub primitive: u32,
    pub nearness: DVec3,
    /// For transmission, the factor on the apex's distance from the face: 1 if straight on.
    pub through: Option<f64>,
}

/// A polygonal beam.
#[derive(Clone, Debug)]
pub(super) struct Beam {
    pub apex: DVec3,
    /// Matrix from (x, y, 1) to the ray direction, and its inverse.
    axes: DMat3,
    inverse: DMat3,
    /// Its part of the film.
    pub window: Convex,
    /// Plane where it begins; `None` at the eye.
    beyond: Option<HalfSpace>,
    pub origin: Option<Origin>,
    /// Number of surfaces so far.
    pub bounce: u32,
}

/// A face in a beam.
#[derive(Clone, Debug)]
pub(super) struct VisibleFace {
    pub primitive: u32,
    /// Its visible part on the film.
    pub outline: Convex,
    pub sides: Vec<HalfPlane>,
    /// Corners of the bounding rectangle.
    pub bounds: [DVec2; 2],
    /// Coefficients of nearness: 1 / t at (x, y) is the product with (x, y, 1).
    pub nearness: DVec3,
    /// Maximum nearness.
    pub nearest: f64,
}

impl Beam {
    /// Return the beam of a camera's whole view.
    pub fn of(camera: &Perspective) -> Self {
        let [width, height] = camera.body().size();
        let [middle, right, up] = camera.window().axes(camera.viewpoint());
        let axes = DMat3::from_cols(right * (2.0 / width), up * (-2.0 / height), middle - right + up);
        let window = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(DVec2::from_array).to_vec();
        let apex = camera.viewpoint().position;
        Self { apex, axes, inverse: axes.inverse(), window, beyond: None, origin: None, bounce: 0 }
    }

    /// Return the reflected or transmitted beam of a part of a face.
    pub fn goes_on(&self, part: Convex, geometry: &Geometry, origin: Origin) -> Self {
        let (normal, corner) = (geometry.normal(origin.primitive), geometry.corners(origin.primitive)[0]);
        let normal = if normal.dot(self.apex - corner) < 0.0 { -normal } else { normal };
        let offset = normal.dot(corner);
        let mut next = Self { window: part, origin: Some(origin), bounce: self.bounce + 1, ..self.clone() };
        if let Some(stretch) = origin.through {
            let stretched = |way: DVec3| way + normal * ((stretch - 1.0) * normal.dot(way));
            next.turn(stretched);
            next.apex = self.apex + normal * ((stretch - 1.0) * (normal.dot(self.apex) - offset));
            next.beyond = Some(HalfSpace { normal: -normal, offset: -offset });
        } else {
            next.turn(|way| way - normal * (2.0 * normal.dot(way)));
            next.apex = self.apex - normal * (2.0 * (normal.dot(self.apex) - offset));
            next.beyond = Some(HalfSpace { normal, offset });
        }
        next
    }

    /// Apply a linear map to the ray directions.
    fn turn(&mut self, changed: impl Fn(DVec3) -> DVec3) {
        let DMat3 { x_axis, y_axis, z_axis } = self.axes;
        self.axes = DMat3::from_cols(changed(x_axis), changed(y_axis), changed(z_axis));
        self.inverse = self.axes.inverse();
    }

    /// Return the film position of a ray direction, if there is one.
    pub fn place(&self, direction: DVec3) -> Option<DVec2> {
        let at = self.inverse * direction;
        (at.z > 0.0).then(|| at.truncate() / at.z)
    }

    /// Return the ray direction at a film position, of the length that t refers to.
    pub fn direction(&self, at: DVec2) -> DVec3 {
        self.axes * at.extend(1.0)
    }

    /// Return the ray at a film position, of unit direction, and its intersection with a plane of given nearness.
    pub fn ray(&self, at: DVec2, nearness: DVec3) -> (Ray, f64) {
        let way = self.direction(at);
        let length = way.length();
        (Ray::new(self.apex, way / length), length / nearness.dot(at.extend(1.0)))
    }

    /// Restrict a half-space to a plane of given nearness: a point is inside if the product with (x, y, 1) is positive.
    /// That product is its distance times its nearness.
    pub fn on_plane(&self, space: &HalfSpace, nearness: DVec3) -> DVec3 {
        self.axes.transpose() * space.normal + nearness * (space.normal.dot(self.apex) - space.offset)
    }

    /// Project a face; return `None` if it is not visible.
    pub fn see(&self, geometry: &Geometry, primitive: u32) -> Option<VisibleFace> {
        let corners = geometry.corners(primitive);
        let normal = geometry.normal(primitive);
        let distance = normal.dot(corners[0] - self.apex);
        let nearness = self.axes.transpose() * (normal / distance);
        if !nearness.is_finite() {
            return None;
        }
        let mut outline: Vec<DVec3> = corners.iter().map(|&corner| self.inverse * (corner - self.apex)).collect();
        let farthest = outline.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
        if let Some(HalfSpace { normal, offset }) = self.beyond {
            let (slope, value) = (self.axes.transpose() * normal, normal.dot(self.apex) - offset);
            // Points in the mirror's own plane are not beyond it.
            let slack = 1e-12 * (offset.abs() + value.abs() + slope.abs().dot(DVec3::splat(farthest)));
            outline = above(&outline, |c| slope.dot(c) + value, slack);
        }
        for side in sides(&self.window, ON_LINE) {
            outline = above(&outline, |c| side.line.dot(c), 0.0);
        }
        outline = above(&outline, |c| c.z - 1e-12 * farthest, 0.0);
        let outline: Convex = outline.iter().map(|c| c.truncate() / c.z).collect();
        if outline.len() < 3 || area(&outline) <= LEAST {
            return None;
        }
        let low = outline.iter().copied().reduce(DVec2::min)?;
        let high = outline.iter().copied().reduce(DVec2::max)?;
        let nearest = outline.iter().map(|at| nearness.dot(at.extend(1.0))).fold(0.0, f64::max);
        let sides = sides(&outline, ON_LINE);
        Some(VisibleFace { primitive, outline, sides, bounds: [low, high], nearness, nearest })
    }
}
