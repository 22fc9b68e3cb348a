//! An expression as a list of steps on the results of earlier steps, with common subexpressions shared.

use super::functions::{Binary, Unary};
use super::number::Number;

/// One step; operands are the indices of earlier steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A number.
    Constant(f64),
    /// x, y or z.
    Variable(usize),
    /// A unary function.
    Unary(Unary, usize),
    /// A binary function.
    Binary(Binary, usize, usize),
    /// An integer power.
    Power(usize, i32),
}

/// The steps of an expression, whose value is the last step.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    steps: Vec<Step>,
}

impl Tape {
    /// Return the index of a step, appending it if it is new. Constants are folded where that is exact, so that `x **
    /// -2` is an integer power.
    pub fn push(&mut self, step: Step) -> usize {
        let step = match step {
            Step::Unary(Unary::Negative, a) if self.constant(a).is_some() => {
                Step::Constant(self.constant(a).map_or(0.0, |x| -x))
            }
            Step::Binary(Binary::Multiply, a, b) if a == b => Step::Power(a, 2),
            Step::Binary(Binary::Raise, a, b) => match self.constant(b) {
                Some(n) if n.fract() == 0.0 && n.abs() <= 1024.0 => Step::Power(a, n as i32),
                _ => step,
            },
            _ => step,
        };
        let same = |other: &Step| match (other, &step) {
            // 0 and −0 compare equal but differ.
            (Step::Constant(a), Step::Constant(b)) => a.to_bits() == b.to_bits(),
            (a, b) => a == b,
        };
        self.steps.iter().position(same).unwrap_or_else(|| {
            self.steps.push(step);
            self.steps.len() - 1
        })
    }

    /// The value of a constant step.
    fn constant(&self, step: usize) -> Option<f64> {
        if let Step::Constant(x) = self.steps[step] { Some(x) } else { None }
    }

    /// The number of steps.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Make the given step the last one, and drop steps it does not need.
    pub fn finish(&mut self, last: usize) {
        let mut needed = vec![false; last + 1];
        needed[last] = true;
        for (i, step) in self.steps[..=last].iter().enumerate().rev() {
            if needed[i] {
                match *step {
                    Step::Unary(_, a) | Step::Power(a, _) => needed[a] = true,
                    Step::Binary(_, a, b) => (needed[a], needed[b]) = (true, true),
                    Step::Constant(_) | Step::Variable(_) => {}
                }
            }
        }
        let place: Vec<usize> = (0..=last).map(|i| needed[..i].iter().filter(|&&n| n).count()).collect();
        let kept = self.steps[..=last].iter().zip(&needed).filter(|(_, needed)| **needed);
        self.steps = kept
            .map(|(step, _)| match *step {
                Step::Unary(f, a) => Step::Unary(f, place[a]),
                Step::Power(a, n) => Step::Power(place[a], n),
                Step::Binary(f, a, b) => Step::Binary(f, place[a], place[b]),
                step => step,
            })
            .collect();
    }

    /// Return whether any step uses x, y or z.
    pub fn is_constant(&self) -> bool {
        !self.steps.iter().any(|s| matches!(s, Step::Variable(_)))
    }

    /// Evaluate the expression for given x, y and z. `work` is scratch space.
    pub fn value<N: Number>(&self, variables: &[N; 3], work: &mut Vec<N>) -> N {
        work.clear();
        for step in &self.steps {
            let result = match *step {
                Step::Constant(x) => N::constant(x),
                Step::Variable(axis) => variables[axis],
                Step::Unary(function, a) => work[a].unary(function),
                Step::Binary(function, a, b) => work[a].binary(function, work[b]),
                Step::Power(a, n) => work[a].power(n),
            };
            work.push(result);
        }
        work[work.len() - 1]
    }
}
