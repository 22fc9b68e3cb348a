//! Exact test whether a line passes through a polygon.
//!
//! Projected along the line, the line is a point. It passes through the polygon if a half-line from that point crosses
//! an odd number of edges. An edge's side of the point is the sign of `d · ((v − w) × (v + w))` with corners relative
//! to the origin, as for triangles (`shapes/triangle/edge.rs`). It is computed in f64 with an error bound, and exactly
//! if that is not enough. So polygons and triangles that share an edge agree on it and are watertight.
//!
//! For a line that touches edges, symbolic perturbation moves the line along one fixed direction: by ε along x, ε²
//! along y and ε³ along z. The side of a point relative to the half-line's own line is the sign of the first nonzero
//! coordinate of `d × (v − o)`. This is the sign of a linear form with infinitesimal weights. If all are zero, it is
//! that of `−d × (ε, ε², ε³)`.

use crate::Contact;
use raywright_base::math::robust::{UNIT, normalising_scale};
use raywright_base::math::{DVec3, Ray, exact_edges, exact_turn};

/// A line prepared for edge tests.
pub struct Line {
    origin: DVec3,
    /// The direction as given.
    unscaled: DVec3,
    /// Scaled so that its largest coordinate lies in [1, 2).
    direction: DVec3,
    /// Bound on the error of an edge's volume.
    error: f64,
    /// Bound on every coordinate relative to the origin.
    largest: f64,
    /// The side of a point on the line itself.
    own_side: i32,
}

impl Line {
    /// Prepare the line of a ray. Corners lie within `largest` of its origin in every coordinate, and edges have
    /// coordinates of at most `longest`. The ray must be finite, and its direction must have a normal coordinate.
    pub fn new(ray: &Ray, largest: f64, longest: f64) -> Self {
        let d = ray.direction;
        let (scale, _) = normalising_scale(d.abs().max_element());
        let size = longest * largest * largest;
        // An edge's volume errs by 184 uEM (`EdgeRay::meet_closely`).
        let error = if size > 1e-270 && size < 1e300 { 256.0 * UNIT * longest * largest } else { f64::INFINITY };
        // −d × x̂ = (0, −d_z, d_y), and −d × ŷ = (d_z, 0, −d_x).
        let sign = |x: f64| i32::from(x > 0.0) - i32::from(x < 0.0);
        let own_side = [sign(-d.z), sign(d.y), sign(-d.x)].into_iter().find(|&s| s != 0).unwrap_or(1);
        Self { origin: ray.origin, unscaled: d, direction: d * scale, error, largest, own_side }
    }

    /// The side of a point relative to the half-line's line: −1 or 1, and 0 on the ray's own line.
    fn side(&self, point: DVec3) -> i32 {
        let (to, d) = (point - self.origin, self.direction);
        for (j, k) in [(1, 2), (2, 0), (0, 1)] {
            if d[j] == 0.0 && d[k] == 0.0 {
                continue;
            }
            let (a, b) = (d[j] * to[k], d[k] * to[j]);
            let value = a - b;
            // A coordinate errs by uM relative to the origin, a product by 4uM in all, and their difference is at most
            // 4M.
            if value.abs() > 16.0 * UNIT * self.largest && self.largest > 1e-280 {
                return if value > 0.0 { 1 } else { -1 };
            }
            return exact_turn(self.unscaled, self.origin, point);
        }
        0
    }

    /// The sign of an edge's volume, exactly.
    fn volume(&self, v: DVec3, w: DVec3) -> i32 {
        let (a, b) = (v - self.origin, w - self.origin);
        let volume = self.direction.dot((v - w).cross(a + b));
        let exact = if volume.abs() > self.error {
            volume
        } else {
            let [exact, ..] = exact_edges(self.origin, self.unscaled, [v, v, w]);
            exact
        };
        i32::from(exact > 0.0) - i32::from(exact < 0.0)
    }

    /// The contact of the line with the area that the rings enclose by the even-odd rule. None on a miss or if the
    /// polygon is exactly edge-on.
    pub fn meet(&self, rings: &[Vec<DVec3>]) -> Option<Contact> {
        let (mut odd, mut touched) = (false, false);
        for ring in rings {
            let mut before = self.side(ring[ring.len() - 1]);
            let mut v = ring[ring.len() - 1];
            for &w in ring {
                let side = self.side(w);
                if before * side <= 0 {
                    let volume = self.volume(v, w);
                    touched |= volume == 0;
                    let moved = [before, side].map(|s| if s == 0 { self.own_side } else { s });
                    if moved[0] != moved[1] {
                        let volume = if volume == 0 { exact_turn(self.unscaled, v, w) } else { volume };
                        odd ^= volume == moved[1];
                    }
                }
                (v, before) = (w, side);
            }
        }
        if !touched {
            return odd.then_some(Contact::Inside);
        }
        let flat = rings.iter().all(|ring| {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).all(|(&v, &w)| self.volume(v, w) == 0)
        });
        (!flat).then_some(if odd { Contact::Crossing } else { Contact::Touching })
    }
}
