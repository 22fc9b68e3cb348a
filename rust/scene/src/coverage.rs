//! What a solid cone meets, nearest first, and how much of it each has (Amanatides, "Ray Tracing with Cones", 1984).
//!
//! Faces are seen on a plane across the axis, where each is cut out of what the nearer ones have left of the cone. So
//! of faces that share edges none is counted twice and no gap is between them; the solid angle that the cone has in
//! common with what is cut out is exact ([`Cap`]), and so is that of a sphere. What only the order of objects can tell
//! is blended: of what is behind a sphere that has a share s of the cone, 1 − s is left, wherever in the cone it is.

use super::Scene;
use raywright_accel::Primitives;
use raywright_base::math::cap::{Cap, shared};
use raywright_base::math::convex::{Convex, HalfPlane, above, area, centroid, sides, take_out};
use raywright_base::math::{DVec2, DVec3, Frame};
use raywright_shapes::Ball;
use raywright_shapes::triangle::SolidCone;

/// A scene of meshes and spheres, for cones.
pub struct Coverage<'a> {
    scene: &'a Scene,
    /// Spheres, by their primitives.
    balls: Vec<(u32, Ball)>,
}

/// A primitive that a cone meets.
#[derive(Clone, Copy, Debug)]
pub struct Covering {
    /// Which primitive.
    pub primitive: u32,
    /// The share that it has of the cone's directions.
    pub share: f64,
    /// A direction of the cone in the midst of that, of unit length.
    pub direction: DVec3,
}

/// What of the scene counts for a cone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted {
    /// A shape that does not.
    pub without: Option<u32>,
    /// A normal n and an offset: only where n · x is above it.
    pub beyond: Option<(DVec3, f64)>,
}

/// In radii of the cone on the plane across its axis: corners so near to a line are on it, and what has less area than
/// the square of that is nothing.
const NOTHING: f64 = 1e-11;

/// Corners of the polygon around the cone on that plane.
const AROUND: usize = 8;

impl<'a> Coverage<'a> {
    /// Readies a scene; an error is the number of a shape that is neither a mesh nor a sphere.
    pub fn new(scene: &'a Scene) -> Result<Self, u32> {
        let geometry = scene.geometry();
        let mut balls = Vec::new();
        for shape in (0..geometry.shapes() as u32).filter(|_| geometry.first_other().is_some()) {
            if geometry.instances_of(shape).is_some() {
                return Err(shape);
            }
            let mut primitives = geometry.primitives_of(shape);
            if let Some((primitive, other)) = primitives.find_map(|p| Some((p, geometry.shape(p)?))) {
                let (center, radius) = other.ball().ok_or(shape)?;
                balls.push((primitive, Ball { center, radius }));
            }
        }
        Ok(Self { scene, balls })
    }

    /// The share of a cone's directions that meet something; NaN for a cone without an angle.
    pub fn share(&self, cone: &SolidCone, counted: Counted) -> f64 {
        let mut all = 0.0;
        self.meet(cone, counted, |covering| all += covering.share);
        all.min(1.0)
    }

    /// Calls with each primitive that a cone meets.
    pub fn meet(&self, cone: &SolidCone, counted: Counted, mut each: impl FnMut(Covering)) {
        let geometry = self.scene.geometry();
        let counts = |primitive: u32| counted.without != Some(geometry.locate(primitive).0);
        let mut view = Left::new(cone);
        let mut balls: Vec<_> = self.balls.iter().filter(|(p, ball)| counts(*p) && is_beyond(ball, counted)).collect();
        let distance = |ball: &Ball| (ball.center - cone.apex).length() - ball.radius;
        balls.retain(|(_, ball)| distance(ball) <= cone.most);
        balls.sort_by(|a, b| distance(&b.1).total_cmp(&distance(&a.1)));
        let touches = self.scene.touched(&[Some(*cone)]);
        let mut tell = |found: Option<(f64, DVec3)>, primitive: u32| {
            if let Some((share, direction)) = found {
                each(Covering { primitive, share, direction });
            }
        };
        for touch in touches.of(0).iter().filter(|touch| counts(touch.primitive)) {
            while let Some((primitive, ball)) = balls.pop_if(|(_, ball)| distance(ball) < touch.distance) {
                tell(view.take_ball(ball), *primitive);
            }
            if view.parts.is_empty() {
                return;
            }
            tell(view.take_face(geometry.corners(touch.primitive), counted.beyond), touch.primitive);
        }
        while let Some((primitive, ball)) = balls.pop() {
            tell(view.take_ball(ball), *primitive);
        }
    }
}

/// Whether the middle of a ball counts.
fn is_beyond(ball: &Ball, counted: Counted) -> bool {
    counted.beyond.is_none_or(|(normal, offset)| normal.dot(ball.center) > offset)
}

/// What is left of a cone.
struct Left {
    apex: DVec3,
    frame: Frame,
    cap: Cap,
    /// Of half the opening, and the angle itself.
    tangent: f64,
    angle: f64,
    window: Vec<HalfPlane>,
    /// Where faces have left something, on the plane across the axis, in radii of the cone.
    parts: Vec<Convex>,
    /// The share that faces have left.
    free: f64,
    /// The share of everything that spheres have left.
    weight: f64,
}

impl Left {
    fn new(cone: &SolidCone) -> Self {
        let turn = std::f64::consts::TAU / AROUND as f64;
        let around = 1.0 / (0.5 * turn).cos();
        let window: Convex = (0..AROUND).map(|i| DVec2::from_angle(turn * i as f64) * around).collect();
        Self {
            apex: cone.apex,
            frame: Frame::new(cone.axis),
            cap: Cap::new(cone.sine, cone.cosine),
            tangent: cone.sine / cone.cosine,
            angle: cone.sine.atan2(cone.cosine),
            window: sides(&window, NOTHING),
            parts: vec![window],
            free: 1.0,
            weight: 1.0,
        }
    }

    /// The direction to a place on the plane, in the frame.
    fn direction(&self, at: DVec2) -> DVec3 {
        (at * self.tangent).extend(1.0)
    }

    /// Takes out what a face has, and tells its share and its middle, if it has any.
    fn take_face(&mut self, corners: [DVec3; 3], beyond: Option<(DVec3, f64)>) -> Option<(f64, DVec3)> {
        let mut outline = corners.to_vec();
        if let Some((normal, offset)) = beyond {
            outline = above(&outline, |corner| normal.dot(corner) - offset, 1e-12 * offset.abs());
        }
        let to_plane = |corner: DVec3| {
            let seen = self.frame.to_local(corner - self.apex);
            DVec3::new(seen.x, seen.y, seen.z * self.tangent)
        };
        outline = outline.into_iter().map(to_plane).collect();
        for side in &self.window {
            outline = above(&outline, |corner| side.line.dot(corner), 0.0);
        }
        outline.retain(|corner| corner.z > 0.0);
        let outline: Convex = outline.iter().map(|corner| corner.truncate() / corner.z).collect();
        if outline.len() < 3 || area(&outline) <= NOTHING * NOTHING {
            return None;
        }
        let region = sides(&outline, NOTHING);
        let mut left = Vec::with_capacity(self.parts.len() + 4);
        let (mut angle, mut middle) = (0.0, DVec2::ZERO);
        for part in std::mem::take(&mut self.parts) {
            let taken = take_out(part, &region, &mut left);
            if taken.len() > 2 {
                let corners: Vec<DVec3> = taken.iter().map(|&at| self.direction(at)).collect();
                let seen = self.cap.shared_with(&corners);
                angle += seen;
                middle += centroid(&taken) * seen;
            }
        }
        left.retain(|part| area(part) > NOTHING * NOTHING);
        self.parts = left;
        let share = (angle / self.cap.solid_angle()).min(self.free);
        self.free -= share;
        let middle = middle / angle;
        // The middle of a part that reaches out of the cone may be outside.
        let middle = middle / middle.length().max(1.0);
        let direction = self.frame.to_world(self.direction(middle)).normalize();
        (share > 0.0).then_some((share * self.weight, direction))
    }

    /// The same of a sphere.
    fn take_ball(&mut self, ball: &Ball) -> Option<(f64, DVec3)> {
        let way = self.frame.to_local(ball.center - self.apex);
        let (distance, across) = (way.length(), way.truncate().length());
        let sine = ball.radius / distance;
        // On its surface it is half of all, within rounding; inside all.
        let half = if sine > 1.0 + 1e-9 { std::f64::consts::PI } else { sine.min(1.0).asin() };
        let between = across.atan2(way.z);
        let share = shared(self.angle, half, between) / self.cap.solid_angle();
        let share = share.min(1.0);
        // In the middle of what both have of the circle through their middles.
        let at = 0.5 * ((between - half).max(-self.angle) + (between + half).min(self.angle));
        let out = if across > 0.0 { way.truncate() / across } else { DVec2::X };
        let direction = self.frame.to_world((out * at.sin()).extend(at.cos()));
        let mine = share * self.weight * self.free;
        self.weight *= 1.0 - share;
        (mine > 0.0).then_some((mine, direction))
    }
}
