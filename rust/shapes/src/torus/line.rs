//! Intersection of a line with a torus.
//!
//! About the center, let P be the line's nearest point to it and d its direction. A point p = `P + s·d` lies on the
//! torus where `F(s) = (|p|² + R² − r²)² − 4R²ρ² = 0`, ρ being the distance from the axis. As P ⟂ d, the quartic has no
//! cubic term, and its critical points are the roots of `4A²s³ + 2bs + c`, with A = d · d. F is monotone between two
//! critical points, so it has one root there if the signs at the ends differ, and else none. So no root is skipped, and
//! the sign of F at three points at most decides. At a critical point, an error δ of s changes F by no more than δ², so
//! s need not be exact.
//!
//! F has the sign of `G = (ρ − R)² + z² − r²`, the swept form, which cancels less than the expanded one for thin tubes.
//! All is computed in double-double (32 digits). In units in which R lies in [1, 2), P errs by less than 2⁻⁹⁹ for any
//! distance of the origin, since `P = d × (q × d) / A` and each coordinate of q × d is summed exactly. So does ρ, and G
//! near the tube errs by less than 2⁻⁹⁶·R·r. Values below 2⁻⁹⁴·R·r count as zero, so a line within 10⁻²⁸·R of tangency
//! is a tangent.

use crate::Contact;
use raywright_base::math::{DVec3, DoubleDouble, Ray};

/// A torus centered at the origin, in units in which R lies in [1, 2).
#[derive(Clone, Copy, Debug)]
pub struct Tube {
    /// The unit axis.
    pub axis: [DoubleDouble; 3],
    /// The major radius R.
    pub major: f64,
    /// The minor radius r.
    pub minor: f64,
}

/// An intersection of the line with the torus.
#[derive(Clone, Copy, Debug)]
pub struct TorusHit {
    /// The line parameter.
    pub t: f64,
    /// Relative to the center.
    pub position: DVec3,
    /// The kind of contact.
    pub contact: Contact,
}

/// Parameter differences below this count as zero: far below the f64 resolution at the torus's size.
const NOTHING: f64 = 1.0 / (1u128 << 88) as f64;

fn dot(a: &[DoubleDouble; 3], b: &[DoubleDouble; 3]) -> DoubleDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A line relative to a torus; `s` is 0 at the point nearest to the center.
struct TorusLine<'a> {
    tube: &'a Tube,
    /// The parts of nearest point and direction across the axis.
    across: [[DoubleDouble; 3]; 2],
    /// Their parts along the axis.
    along: [DoubleDouble; 2],
    /// Nearest point and direction, rounded.
    place: [DVec3; 2],
    /// Their parts across the axis, rounded.
    rounded: [DVec3; 2],
    /// Coefficients of F' as `s³ + p·s + q`.
    slope: [DoubleDouble; 2],
    /// All roots lie in −reach..reach.
    reach: f64,
    /// `t` where `s` is 0.
    start: DoubleDouble,
}

impl<'a> TorusLine<'a> {
    /// Set up a line from an origin relative to the center and a direction whose largest coordinate is in [1, 2). None
    /// if the line misses the bounding sphere.
    fn new(tube: &'a Tube, q: [DoubleDouble; 3], d: DVec3) -> Option<Self> {
        let far = DVec3::from_array(q.map(|x| x.high));
        let (around, length) = (tube.major + tube.minor, d.length());
        // Each coordinate of the product errs by 4u|q||d|.
        let doubt = 1e-15 * far.length() * length;
        if far.cross(d).length() - doubt > around * length * (1.0 + 1e-14) {
            return None;
        }
        let term = |x: DoubleDouble, y: f64| {
            let (high, low) = (DoubleDouble::product(x.high, y), DoubleDouble::product(x.low, y));
            [high.high, high.low, low.high, low.low]
        };
        let moment: [DoubleDouble; 3] = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let ([a, b, c, e], [f, g, h, l]) = (term(q[j], d[k]), term(q[k], -d[j]));
            DoubleDouble::sum([a, b, c, e, f, g, h, l])
        });
        let [x, y, z] = [0, 1, 2].map(|i| term(q[i], d[i]));
        let forward = DoubleDouble::sum([x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], z[0], z[1], z[2], z[3]]);
        let direction = d.to_array().map(DoubleDouble::from);
        let square = dot(&direction, &direction);
        let nearest: [DoubleDouble; 3] = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            (direction[j] * moment[k] - direction[k] * moment[j]) / square
        });
        let along = [dot(&nearest, &tube.axis), dot(&direction, &tube.axis)];
        let reject = |v: &[DoubleDouble; 3], h: DoubleDouble| -> [DoubleDouble; 3] {
            std::array::from_fn(|i| v[i] - h * tube.axis[i])
        };
        let across = [reject(&nearest, along[0]), reject(&direction, along[1])];
        let (major, minor) = (DoubleDouble::from(tube.major), DoubleDouble::from(tube.minor));
        let distance = dot(&nearest, &nearest);
        let room = (major + minor).squared() - distance;
        if room.high < -1e-20 {
            return None;
        }
        // b = 2AK − 4R²|d⊥|² and c = 8R² h₀ h, over 2A² and 4A².
        let constant = distance + (major - minor) * (major + minor);
        let four = major.squared().scaled(4.0);
        let b = (square * constant).scaled(2.0) - four * dot(&across[1], &across[1]);
        let c = four.scaled(2.0) * along[0] * along[1];
        let slope = [b / square.squared().scaled(2.0), c / square.squared().scaled(4.0)];
        let round = |v: &[DoubleDouble; 3]| DVec3::from_array(v.map(DoubleDouble::to_f64));
        Some(Self {
            tube,
            across,
            along,
            place: [round(&nearest), d],
            rounded: [round(&across[0]), round(&across[1])],
            slope,
            reach: (room.high.max(0.0) / square.high).sqrt() * (1.0 + 1e-9) + 1e-9,
            start: -forward / square,
        })
    }

    /// G at a parameter.
    fn swept(&self, s: DoubleDouble) -> DoubleDouble {
        let (major, minor) = (DoubleDouble::from(self.tube.major), DoubleDouble::from(self.tube.minor));
        let across: [DoubleDouble; 3] = std::array::from_fn(|i| self.across[0][i] + s * self.across[1][i]);
        let z = self.along[0] + s * self.along[1];
        let radius = dot(&across, &across).sqrt();
        (radius - major).squared() + (z - minor) * (z + minor)
    }

    /// G and its derivative in f64.
    fn roughly(&self, s: f64) -> (f64, f64) {
        let across = self.rounded[0] + self.rounded[1] * s;
        let (rise, z) = (self.along[1].high, self.along[0].high + s * self.along[1].high);
        let radius = across.length();
        let off = radius - self.tube.major;
        let value = off * off + (z - self.tube.minor) * (z + self.tube.minor);
        let outwards = across.dot(self.rounded[1]) / radius;
        (value, 2.0 * (off * outwards + z * rise))
    }

    /// The sign of G: −1, 0 or 1.
    fn sign(&self, s: DoubleDouble) -> i32 {
        // G errs by less than 2⁻⁴⁸ for coordinates below 8.
        let (value, _) = self.roughly(s.high);
        let (value, doubt) = if value.abs() > 1.0 / (1u64 << 40) as f64 {
            (value, 0.0)
        } else {
            (self.swept(s).high, self.tube.major * self.tube.minor / (1u128 << 94) as f64)
        };
        i32::from(value > doubt) - i32::from(value < -doubt)
    }

    /// The critical points of F within reach, in order.
    fn critical(&self) -> ([DoubleDouble; 3], usize) {
        let [p, q] = self.slope;
        let cubic = |s: DoubleDouble| (s.squared() + p) * s + q;
        let derivative = |s: f64| 3.0 * s * s + p.high;
        let (mut places, mut count) = ([DoubleDouble::ZERO; 3], 0);
        let reach = DoubleDouble::from(self.reach);
        let mut corners = [-reach, reach, reach, reach];
        let mut used = 2;
        if p.is_negative() {
            // Between its own critical points, which need not be exact either, the cubic is monotone.
            let turn = (-p / DoubleDouble::from(3.0)).sqrt();
            if turn < reach {
                corners = [-reach, -turn, turn, reach];
                used = 4;
            }
        }
        for pair in corners[..used].windows(2) {
            let ends = [cubic(pair[0]), cubic(pair[1])];
            // A root at a corner belongs to the interval on its left.
            let crossed = ends[0] != DoubleDouble::ZERO
                && (ends[1] == DoubleDouble::ZERO || ends[0].is_negative() != ends[1].is_negative());
            if crossed {
                places[count] = root(pair[0], pair[1], ends[1].is_negative(), cubic, |s| {
                    ((s * s + p.high) * s + q.high, derivative(s))
                });
                count += 1;
            }
        }
        (places, count)
    }

    fn meeting(&self, s: DoubleDouble, contact: Contact) -> TorusHit {
        let t = (self.start + s).to_f64();
        let t = if t.abs() < NOTHING { 0.0 } else { t };
        TorusHit { t, position: self.place[0] + self.place[1] * s.to_f64(), contact }
    }
}

/// The root between two points at which a function changes sign once. Newton's method runs first in f64, then in
/// double-double, always within a bracket of the root. `falls` says whether the function is negative at the upper end;
/// `roughly` returns value and derivative.
fn root(
    low: DoubleDouble,
    high: DoubleDouble,
    falls: bool,
    value: impl Fn(DoubleDouble) -> DoubleDouble,
    roughly: impl Fn(f64) -> (f64, f64),
) -> DoubleDouble {
    let (mut a, mut b) = (low.high, high.high);
    let mut guess = 0.5 * (a + b);
    for _ in 0..60 {
        let (value, slope) = roughly(guess);
        if (value < 0.0) == falls {
            b = guess
        } else {
            a = guess
        }
        let next = guess - value / slope;
        let next = if next > a && next < b { next } else { 0.5 * (a + b) };
        let step = (next - guess).abs();
        guess = next;
        if step <= 1e-14 * guess.abs() || b - a <= 1e-15 {
            break;
        }
    }
    // Rounding may have misled the f64 search, so the second search uses only its result as a start.
    let (mut low, mut high) = (low, high);
    let mut place = DoubleDouble::from(guess);
    if !(place > low && place < high) {
        place = (low + high).scaled(0.5);
    }
    for _ in 0..240 {
        let found = value(place);
        if found == DoubleDouble::ZERO {
            break;
        }
        if found.is_negative() == falls {
            high = place
        } else {
            low = place
        }
        let (_, slope) = roughly(place.high);
        let next = place - DoubleDouble::from(found.high / slope);
        let inside = next > low && next < high;
        let next = if inside { next } else { (low + high).scaled(0.5) };
        let step = (next - place).abs().high;
        place = next;
        if step < NOTHING || (high - low).high < NOTHING {
            break;
        }
    }
    place
}

/// Call `met` with each intersection of a line with the torus, in order, until it returns true.
///
/// `q` is the line's origin relative to the center and `direction` has its largest coordinate in [1, 2).
pub fn meet(tube: &Tube, q: [DoubleDouble; 3], direction: DVec3, met: &mut dyn FnMut(TorusHit) -> bool) -> bool {
    let Some(line) = TorusLine::new(tube, q, direction) else { return false };
    let (critical, count) = line.critical();
    let end = DoubleDouble::from(line.reach);
    let (mut before, mut outside) = (-end, true);
    // At a critical point with F = 0 the line is tangent, or crosses if the signs on both sides differ.
    let mut zero = None;
    for &place in critical[..count].iter().chain([&end]) {
        let sign = if place == end { 1 } else { line.sign(place) };
        if sign == 0 {
            zero = zero.or(Some(place));
            continue;
        }
        let changes = (sign > 0) != outside;
        let stop = match zero.take() {
            Some(s) => met(line.meeting(s, if changes { Contact::Inside } else { Contact::Touching })),
            None if changes => {
                let falls = sign < 0;
                let s = root(before, place, falls, |s| line.swept(s), |s| line.roughly(s));
                met(line.meeting(s, Contact::Inside))
            }
            None => false,
        };
        if stop {
            return true;
        }
        (before, outside) = (place, sign > 0);
    }
    false
}

/// The ray's origin relative to a center, without rounding, scaled by a power of two.
pub fn relative(ray: &Ray, centre: DVec3, scale: f64) -> [DoubleDouble; 3] {
    std::array::from_fn(|i| {
        let (o, c) = (ray.origin[i], centre[i]);
        DoubleDouble::difference(o * scale, c * scale)
    })
}
