//! Whether a line passes through a polygon, decided exactly.
//!
//! Seen along the line, the polygon's edges are drawn around one point, and the line passes through where a half-line
//! from that point crosses an odd number of them. On which side of the point an edge passes is the sign of `d · ((v −
//! w) × (v + w))` with corners relative to the origin, as for triangles (`shapes/triangle/edge.rs`), computed in f64
//! with its bound and exactly where that is not enough. So polygons and triangles that share an edge agree on it and
//! leak nowhere.
//!
//! A line that touches edges is moved by next to nothing, along the same direction: by ε along x, ε² along y and ε³
//! along z. What stands on either side of the half-line's own line is told by the sign of the first coordinate of `d ×
//! (v − o)` that is not zero, which is the sign of a linear form with weights that are next to nothing too, and where
//! all are zero by that of `−d × (ε, ε², ε³)`.

use crate::Contact;
use raywright_base::math::robust::{UNIT, normalising_scale};
use raywright_base::math::{DVec3, Ray, exact_edges, exact_turn};

/// A line made ready for edges.
pub struct Line {
    origin: DVec3,
    /// As given.
    unscaled: DVec3,
    /// Scaled so that its largest coordinate lies in [1, 2).
    direction: DVec3,
    /// Bound on the error of an edge's volume.
    error: f64,
    /// Bounds every coordinate relative to the origin.
    largest: f64,
    /// The side of a point on the line itself.
    own_side: i32,
}

impl Line {
    /// The line of a ray, for corners within `largest` of its origin in every coordinate and edges whose coordinates
    /// are at most `longest`. The ray must be finite, and its direction have a coordinate that is a normal number.
    pub fn new(ray: &Ray, largest: f64, longest: f64) -> Self {
        let d = ray.direction;
        let (scale, _) = normalising_scale(d.abs().max_element());
        let size = longest * largest * largest;
        // 184 uEM is what an edge's volume errs by (`EdgeRay::meet_closely`).
        let error = if size > 1e-270 && size < 1e300 { 256.0 * UNIT * longest * largest } else { f64::INFINITY };
        // −d × x̂ = (0, −d_z, d_y), and −d × ŷ = (d_z, 0, −d_x).
        let sign = |x: f64| i32::from(x > 0.0) - i32::from(x < 0.0);
        let own_side = [sign(-d.z), sign(d.y), sign(-d.x)].into_iter().find(|&s| s != 0).unwrap_or(1);
        Self { origin: ray.origin, unscaled: d, direction: d * scale, error, largest, own_side }
    }

    /// On which side of the half-line's line a point stands: −1 or 1, and 0 on the ray's own line.
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

    /// How the line passes through what some rings of points enclose, counted evenly: none where it passes by, or sees
    /// them exactly edge-on.
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
