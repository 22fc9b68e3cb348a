//! An expression evaluated along a line.

use super::jet::Jet;
use super::roots::Function;
use super::tape::Tape;
use raywright_base::math::{DVec3, DoubleDouble, Interval};

/// The expression at `origin + s · direction`.
#[derive(Debug)]
pub struct Along<'a> {
    tape: &'a Tape,
    origin: [Interval; 3],
    rounded: [f64; 3],
    direction: [f64; 3],
    jets: Vec<Jet<Interval>>,
    values: Vec<Interval>,
    rough: Vec<Jet<f64>>,
}

impl<'a> Along<'a> {
    /// From an origin given as intervals.
    pub fn new(tape: &'a Tape, origin: [Interval; 3], direction: DVec3) -> Self {
        let rounded = origin.map(|x| 0.5 * (x.low + x.high));
        let direction = direction.to_array();
        Self { tape, origin, rounded, direction, jets: Vec::new(), values: Vec::new(), rough: Vec::new() }
    }

    /// A coordinate of the origin.
    pub fn origin(&self, axis: usize) -> Interval {
        self.origin[axis]
    }

    fn place(&self, axis: usize, s: Interval) -> Interval {
        self.origin[axis].plus(s.times(Interval::point(self.direction[axis])))
    }
}

impl Function for Along<'_> {
    fn enclosure(&mut self, over: Interval) -> Jet<Interval> {
        let line = std::array::from_fn(|i| Jet::new(self.place(i, over), Interval::point(self.direction[i])));
        self.tape.value(&line, &mut self.jets)
    }

    fn at(&mut self, s: f64) -> Interval {
        let point = std::array::from_fn(|i| self.place(i, Interval::point(s)));
        self.tape.value(&point, &mut self.values)
    }

    fn roughly(&mut self, s: f64) -> Jet<f64> {
        let line = std::array::from_fn(|i| Jet::new(self.rounded[i] + s * self.direction[i], self.direction[i]));
        self.tape.value(&line, &mut self.rough)
    }
}

/// `origin + t · direction` to within one ulp of the result, for any distance of the origin.
pub fn moved(origin: DVec3, t: f64, direction: DVec3) -> [Interval; 3] {
    std::array::from_fn(|i| {
        let way = DoubleDouble::product(t, direction[i]);
        let sum = (DoubleDouble::from(origin[i]) + way).to_f64();
        // Double-double keeps 32 digits of the larger of the two.
        let lost = 1e-31 * origin[i].abs().max(way.high.abs());
        Interval::new((sum - lost).next_down(), (sum + lost).next_up())
    })
}
