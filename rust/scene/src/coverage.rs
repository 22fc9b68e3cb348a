//! The primitives in a solid cone, nearest first, and the share of the cone that each covers (Amanatides, "Ray Tracing
//! with Cones", 1984).
//!
//! Faces are projected onto a plane perpendicular to the axis and clipped to the part of the cone that nearer faces
//! leave free. So faces that share edges neither overlap nor leave gaps. The solid angle of each clipped part within
//! the cone is exact ([`Cap`]), and so is that of a sphere. Occlusion by spheres is blended: behind a sphere that
//! covers a share s of the cone, all coverage is scaled by 1 − s, wherever it is in the cone.

use super::Scene;
use raywright_accel::Primitives;
use raywright_base::math::cap::{Cap, shared};
use raywright_base::math::convex::{Convex, HalfPlane, above, area, centroid, sides, take_out};
use raywright_base::math::{DVec2, DVec3, Frame};
use raywright_shapes::Ball;
use raywright_shapes::triangle::SolidCone;

/// A scene of meshes and spheres, for cone queries.
pub struct Coverage<'a> {
    scene: &'a Scene,
    /// The spheres, by primitive number.
    balls: Vec<(u32, Ball)>,
}

/// A primitive that a cone meets.
#[derive(Clone, Copy, Debug)]
pub struct Covering {
    /// Primitive number.
    pub primitive: u32,
    /// Share of the cone's directions that it covers.
    pub share: f64,
    /// A unit direction of the cone near the middle of the covered part.
    pub direction: DVec3,
}

/// Filter of a cone query.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConeFilter {
    /// A shape that is ignored.
    pub without: Option<u32>,
    /// A normal n and an offset: only points x with n · x above the offset count.
    pub beyond: Option<(DVec3, f64)>,
}

/// Tolerance in radii of the cone, on the plane perpendicular to its axis. Corners within it of a line are on the line;
/// a polygon with less area than its square is empty.
const NOTHING: f64 = 1e-11;

/// Corners of the polygon around the cone on that plane.
const AROUND: usize = 8;

impl<'a> Coverage<'a> {
    /// Prepares a scene; the error is the number of a shape that is neither a mesh nor a sphere.
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

    /// The share of a cone's directions that hit something; NaN for a cone without an angle.
    pub fn share(&self, cone: &SolidCone, counted: ConeFilter) -> f64 {
        let mut all = 0.0;
        self.meet(cone, counted, |covering| all += covering.share);
        all.min(1.0)
    }

    /// Calls `each` with every primitive in a cone.
    pub fn meet(&self, cone: &SolidCone, counted: ConeFilter, mut each: impl FnMut(Covering)) {
        let geometry = self.scene.geometry();
        let counts = |primitive: u32| counted.without != Some(geometry.locate(primitive).0);
        let mut view = Left::new(cone);
        let mut balls: Vec<_> = self.balls.iter().filter(|(p, ball)| counts(*p) && is_beyond(ball, counted)).collect();
        let distance = |ball: &Ball| (ball.center - cone.apex).length() - ball.radius;
        balls.retain(|(_, ball)| distance(ball) <= cone.most);
        balls.sort_unstable_by(|a, b| distance(&b.1).total_cmp(&distance(&a.1)));
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

/// Returns whether the center of a sphere counts.
fn is_beyond(ball: &Ball, counted: ConeFilter) -> bool {
    counted.beyond.is_none_or(|(normal, offset)| normal.dot(ball.center) > offset)
}

/// The uncovered part of a cone.
struct Left {
    apex: DVec3,
    frame: Frame,
    cap: Cap,
    /// Tangent of the half angle, and the half angle.
    tangent: f64,
    angle: f64,
    window: Vec<HalfPlane>,
    /// The part that faces leave free, on the plane perpendicular to the axis, in radii of the cone.
    parts: Vec<Convex>,
    /// The share that faces leave free.
    free: f64,
    /// The share of everything that spheres leave free.
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

    /// The direction to a point of the plane, in the cone's frame.
    fn direction(&self, at: DVec2) -> DVec3 {
        (at * self.tangent).extend(1.0)
    }

    /// Subtracts a face from the free part. Returns its share and a direction in the middle of it, if it has any.
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
        // The centroid of a part that reaches out of the cone may be outside the cone.
        let middle = middle / middle.length().max(1.0);
        let direction = self.frame.to_world(self.direction(middle)).normalize();
        (share > 0.0).then_some((share * self.weight, direction))
    }

    /// Subtracts a sphere from the free part; see `take_face`.
    fn take_ball(&mut self, ball: &Ball) -> Option<(f64, DVec3)> {
        let way = self.frame.to_local(ball.center - self.apex);
        let (distance, across) = (way.length(), way.truncate().length());
        let sine = ball.radius / distance;
        // From a point on the sphere it covers a hemisphere, within rounding; from inside it covers everything.
        let half = if sine > 1.0 + 1e-9 { std::f64::consts::PI } else { sine.min(1.0).asin() };
        let between = across.atan2(way.z);
        let share = shared(self.angle, half, between) / self.cap.solid_angle();
        let share = share.min(1.0);
        // The middle of the overlap of both disks, on the great circle through their centers.
        let at = 0.5 * ((between - half).max(-self.angle) + (between + half).min(self.angle));
        let out = if across > 0.0 { way.truncate() / across } else { DVec2::X };
        let direction = self.frame.to_world((out * at.sin()).extend(at.cos()));
        let mine = share * self.weight * self.free;
        self.weight *= 1.0 - share;
        (mine > 0.0).then_some((mine, direction))
    }
}
