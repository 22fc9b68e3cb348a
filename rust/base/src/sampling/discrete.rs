//! Sampling of discrete distributions.

/// Samples an entry with probability proportional to its weight in constant time (Walker, 1977; built in linear time as
/// in Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution", 1991).
#[derive(Clone, Debug)]
pub struct AliasTable {
    /// Each column belongs to its own entry below the threshold, and to its alias above.
    columns: Vec<AliasColumn>,
    probabilities: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
struct AliasColumn {
    threshold: f64,
    alias: u32,
}

impl AliasTable {
    /// Build a table for weights; `None` if all are 0 or there are none.
    ///
    /// # Panics
    ///
    /// If a weight is negative, infinite or NaN.
    pub fn new(weights: &[f64]) -> Option<Self> {
        assert!(weights.iter().all(|w| w.is_finite() && *w >= 0.0), "weights are finite and not negative");
        let largest = weights.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return None;
        }
        // Relative to the largest weight, no sum overflows.
        let sum: f64 = weights.iter().map(|w| w / largest).sum();
        let probabilities: Vec<f64> = weights.iter().map(|w| w / largest / sum).collect();

        let count = weights.len();
        let mut share: Vec<f64> = probabilities.iter().map(|p| p * count as f64).collect();
        let mut columns: Vec<AliasColumn> =
            (0..count as u32).map(|alias| AliasColumn { threshold: 1.0, alias }).collect();
        let (mut poor, mut rich): (Vec<u32>, Vec<u32>) = (0..count as u32).partition(|&i| share[i as usize] < 1.0);
        // Entries of weight 0 come first, while a donor for their column certainly exists. Rounding may leave a few
        // poor ones at the end, which then keep their column to themselves.
        poor.sort_by_key(|&i| share[i as usize] == 0.0);
        while let Some(&donor) = rich.last() {
            let Some(small) = poor.pop() else { break };
            columns[small as usize] = AliasColumn { threshold: share[small as usize], alias: donor };
            // In this order the difference is exact for small shares (Vose).
            share[donor as usize] = (share[donor as usize] + share[small as usize]) - 1.0;
            if share[donor as usize] < 1.0 {
                poor.push(donor);
                rich.pop();
            }
        }
        Some(Self { columns, probabilities })
    }

    /// Memory use in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.columns.as_slice()) + size_of_val(self.probabilities.as_slice())
    }

    /// The entry for a number in [0, 1).
    #[inline]
    pub fn sample(&self, u: f64) -> usize {
        let scaled = u * self.columns.len() as f64;
        let index = (scaled as usize).min(self.columns.len() - 1);
        let column = self.columns[index];
        if scaled - (index as f64) < column.threshold { index } else { column.alias as usize }
    }

    /// The probability of an entry.
    #[inline]
    pub fn probability(&self, index: usize) -> f64 {
        self.probabilities[index]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Sampler;
    use super::super::chi_square::assert_frequencies;
    use super::*;
    use proptest::prelude::*;

    /// The probability of each entry that the table's columns imply.
    fn implied(table: &AliasTable) -> Vec<f64> {
        let mut sums = vec![0.0; table.columns.len()];
        for (i, column) in table.columns.iter().enumerate() {
            sums[i] += column.threshold;
            sums[column.alias as usize] += 1.0 - column.threshold;
        }
        sums.iter().map(|s| s / table.columns.len() as f64).collect()
    }

    proptest! {
        #[test]
        fn columns_hold_the_weights(weights in prop::collection::vec(
            prop_oneof![Just(0.0), 0.0..1.0f64, (-30.0..30.0f64).prop_map(f64::exp2)], 1..200)) {
            let Some(table) = AliasTable::new(&weights) else {
                prop_assert!(weights.iter().all(|&w| w == 0.0));
                return Ok(());
            };
            let sum: f64 = weights.iter().sum();
            for (i, (got, weight)) in implied(&table).iter().zip(&weights).enumerate() {
                // Each of a column's few roundings is of a number below the count.
                prop_assert!((got - weight / sum).abs() < 4.0 * f64::EPSILON * weights.len() as f64);
                prop_assert!((table.probability(i) - weight / sum).abs() <= 1e-13 * table.probability(i));
                if *weight == 0.0 {
                    prop_assert_eq!(*got, 0.0);
                    prop_assert_eq!(table.columns[i].threshold, 0.0);
                }
            }
        }
    }

    #[test]
    fn draws_by_weight() {
        let weights = [1.0, 0.0, 3.0, 1e-9, 0.5, 0.0, 7.0];
        let table = AliasTable::new(&weights).unwrap();
        let mut counts = [0; 7];
        for sample in 0..100_000 {
            counts[table.sample(Sampler::new(3, 0, sample).one(0))] += 1;
        }
        assert_eq!((counts[1], counts[5]), (0, 0));
        assert_frequencies(&counts, &weights.map(|w| w / 11.5));
    }

    #[test]
    fn rare_entries_are_reached() {
        // One of a thousand entries has a probability of 10⁻¹⁰: it is the start of its column, and only a number with
        // more than 32 bits resolves it.
        let mut weights = vec![1.0; 1000];
        weights[0] = 1e-10;
        let table = AliasTable::new(&weights).unwrap();
        assert_eq!(table.sample(0.0), 0);
        assert_eq!(table.sample(0.9e-13), 0);
        assert_ne!(table.sample(1.1e-13), 0);
    }

    #[test]
    fn extremes() {
        assert!(AliasTable::new(&[]).is_none());
        assert!(AliasTable::new(&[0.0, 0.0]).is_none());
        let table = AliasTable::new(&[f64::MAX, f64::MAX]).unwrap();
        assert_eq!(table.probability(1), 0.5);
        assert_eq!(AliasTable::new(&[5.0]).unwrap().sample(1.0 - f64::EPSILON / 2.0), 0);
    }
}
