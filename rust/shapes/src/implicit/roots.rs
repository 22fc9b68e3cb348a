//! Root isolation: all zeros of a univariate function, in order.
//!
//! The function gives enclosures of its values and first two derivatives over any interval. An interval whose values
//! exclude zero has no root. If its slope excludes zero, it has one root if the signs at the ends differ, and else
//! none. If its second derivative excludes zero, the slope has at most one zero, which splits the interval into two of
//! that kind. All other intervals are bisected (Moore 1966; Mitchell, "Robust Ray Intersection with Interval
//! Arithmetic", 1990).
//!
//! At single points f64 leaves the sign open where the value is zero to within rounding. Such points, and intervals too
//! short to bisect, form a *zone*. At the next certain sign the zone is reported once: as a crossing if that sign
//! differs from the last one, as a tangent if not. So roots closer than rounding count as one, or as none that crosses,
//! and signs always alternate between crossings.
//!
//! Where the function is discontinuous or undefined, short intervals count only if the value at one of their points may
//! be zero. So poles and jumps are not roots.

use super::jet::Jet;
use crate::Contact;
use raywright_base::math::Interval;

/// Maximum number of intervals per line. Beyond it the remaining ones are accepted as they are.
pub const WORK: usize = 4096;

/// A function on a line.
pub trait Function {
    /// Enclose value and derivatives over an interval.
    fn enclosure(&mut self, over: Interval) -> Jet<Interval>;
    /// Enclose the value at a point.
    fn at(&mut self, s: f64) -> Interval;
    /// Value and derivatives, rounded.
    fn roughly(&mut self, s: f64) -> Jet<f64>;
}

/// A root and its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// The parameter.
    pub place: f64,
    /// True if the sign changes.
    pub contact: Contact,
}

/// The sign of a function at a point: certain, open, or undefined.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    Certain(i32),
    Open,
    Undefined,
}

impl Sign {
    fn of(value: Interval) -> Self {
        match value.sign() {
            _ if value.is_empty() => Self::Undefined,
            0 => Self::Open,
            sign => Self::Certain(sign),
        }
    }

    /// Return whether both are certain and differ.
    fn differs(self, other: Self) -> bool {
        matches!((self, other), (Self::Certain(a), Self::Certain(b)) if a != b)
    }
}

/// A run of points that may all be zeros.
#[derive(Clone, Copy, Debug)]
struct Zone {
    start: f64,
    end: f64,
    /// The point reported for a tangent.
    place: f64,
}

struct RootSearch<'a, F> {
    function: &'a mut F,
    /// Shorter intervals are not bisected.
    shortest: f64,
    met: &'a mut dyn FnMut(Root) -> bool,
    /// The last certain sign and its position; None at the start and where the function is undefined.
    last: Option<(i32, f64)>,
    zone: Option<Zone>,
    stopped: bool,
}

/// Call `met` with every root from `span.low` to `span.high` that is not certainly outside `wanted`, in order, until it
/// returns true. Return whether it did.
///
/// The roots do not depend on `wanted`, which only saves work. Their error is a few multiples of `shortest`.
pub fn roots<F: Function>(
    function: &mut F,
    span: Interval,
    wanted: Interval,
    shortest: f64,
    met: &mut dyn FnMut(Root) -> bool,
) -> bool {
    let mut search = RootSearch { function, shortest, met, last: None, zone: None, stopped: false };
    let ends = [span.low, span.high].map(|s| (s, search.function.at(s)));
    let mut stack = vec![ends];
    let mut work = 0;
    while let Some([(a, at_a), (b, at_b)]) = stack.pop() {
        if search.stopped || (a > wanted.high && search.zone.is_none()) {
            return search.stopped;
        }
        if let (true, Sign::Certain(sign)) = (b < wanted.low, Sign::of(at_b)) {
            (search.last, search.zone) = (Some((sign, b)), None);
            continue;
        }
        work += 1;
        if !search.settle((a, at_a), (b, at_b), work > WORK) {
            let middle = 0.5 * (a + b);
            let at_middle = search.function.at(middle);
            stack.push([(middle, at_middle), (b, at_b)]);
            stack.push([(a, at_a), (middle, at_middle)]);
        }
    }
    // A zone at the very end counts: the surface extends to it.
    search.undefined();
    search.stopped
}

impl<F: Function> RootSearch<'_, F> {
    /// Report the roots of an interval unless it needs bisection; return whether it is done.
    fn settle(&mut self, (a, at_a): (f64, Interval), (b, at_b): (f64, Interval), must: bool) -> bool {
        let (sign_a, sign_b) = (Sign::of(at_a), Sign::of(at_b));
        let all = self.function.enclosure(Interval::new(a, b));
        let mut value = all.value;
        if value.whole {
            // The mean value theorem from either end.
            let width = Interval::point(b).minus(Interval::point(a));
            let (low, high) = (Interval { low: 0.0, ..width }, Interval { low: 0.0, ..width }.negated());
            value = value.intersection(at_a.plus(all.slope.times(low)));
            value = value.intersection(at_b.plus(all.slope.times(high)));
            if value.is_empty() {
                value = all.value;
            }
        }
        if value.is_empty() {
            self.undefined();
            return true;
        }
        if value.sign() != 0 {
            // The sign is certain wherever the function is defined.
            if !value.whole {
                self.undefined();
            }
            self.visit(b, Sign::Certain(value.sign()));
            return true;
        }
        if value.low == 0.0 && value.high == 0.0 && value.whole {
            self.widen(a, b, a);
            return true;
        }
        if value.whole && all.slope.sign() != 0 {
            self.between((a, sign_a), (b, sign_b));
            return true;
        }
        if value.whole && all.bend.sign() != 0 && all.bend.magnitude().is_finite() {
            let (left, right) = (self.function.roughly(a).slope, self.function.roughly(b).slope);
            if (left < 0.0) == (right < 0.0) {
                self.between((a, sign_a), (b, sign_b));
            } else {
                let turn = self.change((a, b), left < 0.0, |jet| (jet.slope, jet.bend));
                let sign = Sign::of(self.function.at(turn));
                self.between((a, sign_a), (turn, sign));
                self.between((turn, sign), (b, sign_b));
            }
            return true;
        }
        if b - a > self.shortest && !must {
            return false;
        }
        let middle = 0.5 * (a + b);
        if all.value.whole {
            self.widen(a, b, middle);
            return true;
        }
        for (place, at) in [(a, at_a), (middle, self.function.at(middle)), (b, at_b)] {
            match Sign::of(at) {
                Sign::Open if at.whole => self.visit(place, Sign::Open),
                // Beside a pole or beyond a jump, earlier signs are irrelevant.
                _ => self.undefined(),
            }
        }
        if let Sign::Certain(sign) = sign_b {
            self.last = Some((sign, b));
        }
        true
    }

    /// An interval on which the function is monotone.
    fn between(&mut self, (a, sign_a): (f64, Sign), (b, sign_b): (f64, Sign)) {
        self.visit(a, sign_a);
        if sign_a.differs(sign_b) && !self.stopped {
            let place = self.change((a, b), sign_a == Sign::Certain(-1), |jet| (jet.value, jet.slope));
            self.tell(place, Contact::Inside);
            self.last = None;
        }
        self.visit(b, sign_b);
    }

    /// Advance past a point of known sign.
    fn visit(&mut self, s: f64, sign: Sign) {
        match sign {
            Sign::Open => self.widen(s, s, s),
            Sign::Undefined => self.undefined(),
            Sign::Certain(sign) => {
                if let Some(zone) = self.zone.take() {
                    match self.last {
                        Some((before, _)) if before == sign => self.tell(zone.place, Contact::Touching),
                        // A wide zone is a stretch of zeros, reported at its start.
                        Some((before, from)) if zone.end - zone.start <= 64.0 * self.shortest => {
                            let place = self.change((from, s), before < 0, |jet| (jet.value, jet.slope));
                            self.tell(place, Contact::Inside);
                        }
                        _ => self.tell(zone.start, Contact::Inside),
                    }
                }
                self.last = Some((sign, s));
            }
        }
    }

    /// Advance past an undefined stretch, which ends the zone before it.
    fn undefined(&mut self) {
        if let Some(zone) = self.zone.take() {
            self.tell(zone.start, Contact::Inside);
        }
        self.last = None;
    }

    fn widen(&mut self, start: f64, end: f64, place: f64) {
        let zone = self.zone.get_or_insert(Zone { start, end, place });
        zone.end = end;
    }

    fn tell(&mut self, place: f64, contact: Contact) {
        self.stopped = self.stopped || (self.met)(Root { place, contact });
    }

    /// The sign change of a part of the function, from negative to positive if `rises`. `part` selects value and
    /// derivative. Newton's method, with bisection for steps that leave the interval.
    fn change(&mut self, (mut a, mut b): (f64, f64), rises: bool, part: impl Fn(Jet<f64>) -> (f64, f64)) -> f64 {
        let mut place = 0.5 * (a + b);
        for _ in 0..200 {
            let (value, slope) = part(self.function.roughly(place));
            if value == 0.0 {
                return place;
            }
            if (value < 0.0) == rises {
                a = place
            } else {
                b = place
            }
            let next = place - value / slope;
            let next = if next > a && next < b { next } else { 0.5 * (a + b) };
            let step = (next - place).abs();
            place = next;
            if step <= 0.25 * self.shortest || b - a <= 0.25 * self.shortest || place <= a || place >= b {
                break;
            }
        }
        place
    }
}
