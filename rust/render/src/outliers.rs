//! Detection of a few samples that dominate an error estimate.

/// The few samples that dominate an error estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DominantSamples {
    /// Number of samples.
    pub samples: u32,
    /// Their share of the estimate, above one half.
    pub share: f64,
}

/// Maximum number of samples that count as few. If eight equal terms make up half of a sum, they alone give it a
/// standard error of √8/16, some 18 %. The next such sample, or its absence, moves the estimate beyond its accuracy, a
/// factor of 1.25.
const FEW: usize = 8;

/// The largest of many numbers, in descending order.
///
/// Only the largest sample of each cell is considered, if it is unconfirmed. That is enough, because outliers are rare
/// in the whole picture, and two of them are hardly ever in the same cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Largest([f64; FEW]);

impl Largest {
    /// Adds a number.
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

    /// Adds all numbers of another.
    pub fn join(&mut self, other: &Self) {
        for &value in &other.0 {
            self.add(value);
        }
    }

    /// The fewest numbers that make up more than half of a sum, if they are few.
    pub fn carry(&self, sum: f64) -> Option<DominantSamples> {
        let mut share = 0.0;
        for (samples, value) in (1..).zip(&self.0) {
            share += value / sum;
            if share > 0.5 {
                return Some(DominantSamples { samples, share });
            }
        }
        None
    }
}

/// Returns whether a sample is unconfirmed by neighbors: it exceeds the other samples of its pixel by more than twice
/// the excess of the brightest neighbor.
///
/// A pixel on the rim of a lamp may hit it with one sample of many, and a few such pixels may dominate the error,
/// especially with stratified samples, which leave little error elsewhere. But the next pixel shows the lamp's
/// brightness with all its samples, and the next sample to hit it is no brighter. Rare light without such confirmation
/// is a lamp smaller than a pixel, light through a small opening, or a caustic that was hit once.
#[inline]
pub(super) fn is_find(brightness: f64, others: f64, beside: f64) -> bool {
    brightness - others > 2.0 * (beside - others).max(0.0)
}

/// The maximum over the up to eight neighbors at distance `apart` along one axis or both.
#[inline]
pub(super) fn beside(shown: &[f64], width: usize, x: usize, y: usize, apart: usize) -> f64 {
    let height = shown.len() / width;
    let near = |at: usize, size: usize| [at.checked_sub(apart), Some(at), Some(at + apart).filter(|&at| at < size)];
    let rows = near(y, height);
    let places =
        rows.into_iter().flatten().flat_map(|row| near(x, width).into_iter().flatten().map(move |at| (at, row)));
    places.filter(|&place| place != (x, y)).map(|(x, y)| shown[y * width + x]).fold(0.0, f64::max)
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
            sorted.sort_unstable_by(|a, b| b.total_cmp(a));
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
        assert_eq!(largest(&[1.0, 9.0]).carry(10.0), Some(DominantSamples { samples: 1, share: 0.9 }));
        assert_eq!(largest(&[1.0, 2.0, 2.0]).carry(7.0), Some(DominantSamples { samples: 2, share: 4.0 / 7.0 }));
        assert_eq!(largest(&[1.0; 16]).carry(16.0), None);
        assert!(largest(&[1.0; 15]).carry(15.0).is_some());
    }

    #[test]
    fn pixels_beside_are_those_around_in_the_picture() {
        // Five columns and four rows of increasing brightness.
        let shown: Vec<f64> = (0..20).map(f64::from).collect();
        let at = |x, y, apart| beside(&shown, 5, x, y, apart);
        assert_eq!([at(0, 0, 1), at(2, 1, 1), at(4, 3, 1), at(0, 3, 1)], [6.0, 13.0, 18.0, 16.0]);
        assert_eq!([at(0, 0, 2), at(2, 1, 2), at(4, 3, 2), at(0, 0, 8)], [12.0, 19.0, 17.0, 0.0]);
        assert!(is_find(2.1, 0.0, 1.0) && !is_find(2.0, 0.0, 1.0) && !is_find(0.0, 0.0, 0.0));
        // Slightly brighter than its neighbors, and than darker ones.
        assert!(is_find(1.001, 1.0, 1.0) && is_find(1.001, 1.0, 0.5));
    }
}
