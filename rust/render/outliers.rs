//! Whether a few samples make most of an estimate.

/// The few samples that carry most of an estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// How many.
    pub samples: u32,
    /// Their share of the estimate, above one half.
    pub share: f64,
}

/// How many samples are few. A sum of which eight like terms make one half has, by these alone, a standard error of
/// √8/16, some 18 %: the next such sample, or its absence, moves it out of the factor of 1.25 that an estimate is
/// worth.
const FEW: usize = 8;

/// The largest of many numbers, from the largest down.
///
/// Only the largest sample of each cell is looked at. That is enough: an outlier is one of few in all of the picture,
/// and two of them are hardly ever in the same cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Largest([f64; FEW]);

impl Largest {
    /// Counts a number in.
    #[inline]
    pub fn add(&mut self, mut value: f64) {
        if value <= self.0[FEW - 1] {
            return;
        }
        for entry in &mut self.0 {
            if value > *entry {
                std::mem::swap(entry, &mut value);
            }
        }
    }

    /// Counts all of another's numbers in.
    pub fn join(&mut self, other: &Self) {
        for &value in &other.0 {
            self.add(value);
        }
    }

    /// The fewest that make more than one half of a sum, if they are few.
    pub fn carry(&self, sum: f64) -> Option<Carried> {
        let mut share = 0.0;
        for (samples, value) in (1..).zip(&self.0) {
            share += value / sum;
            if share > 0.5 {
                return Some(Carried { samples, share });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn largest(values: &[f64]) -> Largest {
        let mut largest = Largest::default();
        values.iter().for_each(|&value| largest.add(value));
        largest
    }

    proptest! {
        #[test]
        fn keeps_the_largest_in_order(values in prop::collection::vec(0.0..1.0f64, 0..50), split in 0usize..50) {
            let mut sorted = values.clone();
            sorted.sort_by(|a, b| b.total_cmp(a));
            sorted.resize(FEW, 0.0);
            prop_assert_eq!(&largest(&values).0[..], &sorted[..]);
            let (left, right) = values.split_at(split.min(values.len()));
            let mut joined = largest(left);
            joined.join(&largest(right));
            prop_assert_eq!(&joined.0[..], &sorted[..]);
        }
    }

    #[test]
    fn few_carry_more_than_half_or_none_do() {
        assert_eq!(largest(&[1.0, 9.0]).carry(10.0), Some(Carried { samples: 1, share: 0.9 }));
        assert_eq!(largest(&[1.0, 2.0, 2.0]).carry(7.0), Some(Carried { samples: 2, share: 4.0 / 7.0 }));
        assert_eq!(largest(&[1.0; 16]).carry(16.0), None);
        assert!(largest(&[1.0; 15]).carry(15.0).is_some());
    }
}
