//! Beams, and what faces look like in them.
//!
//! A flat mirror turns a beam into one that comes from behind it, from where the eye is seen in the mirror. Told by the
//! place on the film that it comes from, each of its rays is `apex + t · direction(x, y)`, and the direction is linear
//! in x and y, however many mirrors it has met, and faces of glass where refraction is taken for linear (`onward.rs`).
//! So the film is the plane that all is cut in: straight edges are straight there, and 1 / t, the nearness, is linear
//! in x and y on every plane.

use glam::DMat3;
use raywright_accel::Primitives;
use raywright_base::math::convex::{Convex, HalfPlane, above, area, sides};
use raywright_base::math::{DVec2, DVec3, Ray};
use raywright_scene::{Camera, Geometry, Perspective};

/// Corners that are so near to a line of the film, in pixels, are on it.
pub(super) const ON_LINE: f64 = 1e-11;

/// What is smaller, in pixels, is left out.
pub(super) const LEAST: f64 = 1e-13;

/// All points x with `normal · x` above an offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub normal: DVec3,
    pub offset: f64,
}

/// Which face a beam comes from, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin {
    /// The beam that has met it, by its number.
    pub beam: usize,
    pub primitive: u32,
    pub nearness: DVec3,
    /// Of one that goes on on the other side, how many times as far from the face it comes from: 1 if straight on.
    pub through: Option<f64>,
}

/// A polygonal beam.
#[derive(Clone, Debug)]
pub(super) struct Beam {
    pub apex: DVec3,
    /// What x, y and 1 are multiplied by in the direction of the ray through (x, y), and the inverse of that.
    axes: DMat3,
    inverse: DMat3,
    /// What of the film it is seen at.
    pub window: Convex,
    /// Where it begins; `None` at the eye.
    beyond: Option<HalfSpace>,
    pub origin: Option<Origin>,
    /// How many surfaces it has met.
    pub bounce: u32,
}

/// A face in a beam.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub primitive: u32,
    /// What of it is in the beam, on the film.
    pub outline: Convex,
    pub sides: Vec<HalfPlane>,
    /// The corners of the least rectangle around it.
    pub bounds: [DVec2; 2],
    /// 1 / t at (x, y) is its product with (x, y, 1).
    pub nearness: DVec3,
    /// The greatest there is.
    pub nearest: f64,
}

impl Beam {
    /// All that a camera sees.
    pub fn of(camera: &Perspective) -> Self {
        let [width, height] = camera.body().size();
        let [middle, right, up] = camera.window().axes(camera.viewpoint());
        let axes = DMat3::from_cols(right * (2.0 / width), up * (-2.0 / height), middle - right + up);
        let window = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(DVec2::from_array).to_vec();
        let apex = camera.viewpoint().position;
        Self { apex, axes, inverse: axes.inverse(), window, beyond: None, origin: None, bounce: 0 }
    }

    /// The beam that goes on from a part of a face: that which a mirror throws back, or which goes through.
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

    /// Changes the way of each ray, linearly.
    fn turn(&mut self, changed: impl Fn(DVec3) -> DVec3) {
        let DMat3 { x_axis, y_axis, z_axis } = self.axes;
        self.axes = DMat3::from_cols(changed(x_axis), changed(y_axis), changed(z_axis));
        self.inverse = self.axes.inverse();
    }

    /// The place of the film whose ray has a direction; `None` if there is none.
    pub fn place(&self, direction: DVec3) -> Option<DVec2> {
        let at = self.inverse * direction;
        (at.z > 0.0).then(|| at.truncate() / at.z)
    }

    /// The way of the ray through a place, of the length that t counts in.
    pub fn direction(&self, at: DVec2) -> DVec3 {
        self.axes * at.extend(1.0)
    }

    /// The ray through a place, of unit direction, and where it meets a plane of this nearness.
    pub fn ray(&self, at: DVec2, nearness: DVec3) -> (Ray, f64) {
        let way = self.direction(at);
        let length = way.length();
        (Ray::new(self.apex, way / length), length / nearness.dot(at.extend(1.0)))
    }

    /// On a plane of this nearness, what a half-space is: a point is in it where the product with (x, y, 1) is above 0,
    /// which is its distance times its nearness.
    pub fn on_plane(&self, space: &HalfSpace, nearness: DVec3) -> DVec3 {
        self.axes.transpose() * space.normal + nearness * (space.normal.dot(self.apex) - space.offset)
    }

    /// How a face is seen; `None` where it is not.
    pub fn see(&self, geometry: &Geometry, primitive: u32) -> Option<Seen> {
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
            // What lies in the mirror's own plane is not beyond it.
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
        Some(Seen { primitive, outline, sides, bounds: [low, high], nearness, nearest })
    }
}
