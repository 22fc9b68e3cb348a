//! Good-Turing estimates of how often bright samples recur.

/// Counts of cells with an outlier, by its brightness and by whether the cell has another.
///
/// A pixel with one bright sample may be on the edge of a lamp, where many of its samples would be bright, or it may
/// have hit an extremely rare event. It cannot tell, but all pixels together can. If bright samples occur as a Poisson
/// process with λ per cell, the numbers of cells with one and with two determine λ. It is twice the number of cells
/// with two over the number of those with one (Good, "The Population Frequencies of Species and the Estimation of
/// Population Parameters", 1953, who credits Turing). Rarity depends on brightness, so each octave of brightness is
/// estimated separately, with its two neighbors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sightings([[u64; 2]; OCTAVES + 2]);

/// Number of octaves, the smallest at 2⁻³²; values outside count in the first or last. One empty octave is added at
/// either end.
const OCTAVES: usize = 96;

/// Expected number of further samples in a cell that are as bright as its brightest, for cells with one such sample: 1
/// if each is as bright as it seems, and 0 if nothing so bright recurs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chance {
    /// Likely number.
    pub likely: f64,
    /// Upper bound.
    pub most: f64,
}

impl Default for Sightings {
    fn default() -> Self {
        Self([[0; 2]; OCTAVES + 2])
    }
}

impl Sightings {
    /// Counts a cell: the brightness of its brightest sample, and the squares of the others over its square, which is
    /// the equivalent number of samples of the same size.
    #[inline]
    pub fn add(&mut self, brightness: f64, again: f64) {
        let counts = &mut self.0[octave(brightness)];
        // Events vary in size: another of half the size still counts as the second, and two more do not count as one.
        if again < 0.25 {
            counts[0] += 1;
        } else if again < 1.5 {
            counts[1] += 1;
        }
    }

    /// Adds the counts of another.
    pub fn join(&mut self, other: &Self) {
        for (counts, others) in self.0.iter_mut().zip(&other.0) {
            counts[0] += others[0];
            counts[1] += others[1];
        }
    }

    /// Chances for each octave.
    pub fn chances(&self) -> Chances {
        Chances(std::array::from_fn(|octave| {
            let around = if octave == 0 { &self.0[..2] } else { &self.0[octave - 1..(octave + 2).min(OCTAVES + 2)] };
            let [once, twice] = [0, 1].map(|which| around.iter().map(|counts| counts[which]).sum::<u64>() as f64);
            // One of its kind gives no information on its rarity, and two give a little.
            let little = 2.0 / once.max(1.0).powi(2);
            let likely = ((2.0 * twice + little) / (once + little)).min(1.0);
            // If three are expected, none occurs with probability 1 in 20.
            let most = (2.0 * (twice + 2.0 * twice.sqrt() + 3.0) / once.max(1.0)).min(1.0);
            Chance { likely, most }
        }))
    }
}

/// A chance for each octave.
pub(super) struct Chances([Chance; OCTAVES + 2]);

impl Chances {
    /// The chance for samples of this brightness.
    #[inline]
    pub fn of(&self, brightness: f64) -> &Chance {
        &self.0[octave(brightness)]
    }
}

/// Computed from the bits, so that it is the same on every machine.
#[inline]
fn octave(brightness: f64) -> usize {
    let exponent = (brightness.to_bits() >> 52 & 0x7ff) as i64 - 1023;
    (exponent + 32).clamp(0, OCTAVES as i64 - 1) as usize + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::sampling::Sampler;

    proptest! {
        #[test]
        fn octaves_are_powers_of_two(brightness in 1e-9..1e19f64) {
            prop_assert_eq!(octave(brightness), (brightness.log2().floor() as usize).wrapping_add(33));
            prop_assert!(octave(0.0) == 1 && octave(f64::from(f32::MAX)) == OCTAVES);
        }
    }

    #[test]
    fn nothing_known_is_as_bright_as_it_says() {
        let mut sightings = Sightings::default();
        let chance = |sightings: &Sightings| *sightings.chances().of(1.5);
        assert_eq!(chance(&sightings), Chance { likely: 1.0, most: 1.0 });
        sightings.add(1.0, 0.0);
        assert!(chance(&sightings).likely > 0.5 && chance(&sightings).most == 1.0);
        // Much darker or brighter samples have no influence.
        (0..1000).for_each(|_| sightings.add(8.0, 0.0));
        assert!(chance(&sightings).likely > 0.5 && sightings.chances().of(8.0).most < 0.01);
    }

    #[test]
    fn finds_how_rare_events_are() {
        // Cells of 64 samples, each bright with probability λ/64; λ is estimated from the cells with one bright sample.
        for lambda in [0.02, 0.1, 0.5] {
            let mut sightings = Sightings::default();
            for cell in 0..20_000u32 {
                let bright = (0..64).filter(|&n| Sampler::new(3, cell, n).one(0) < lambda / 64.0).count();
                if bright > 0 {
                    sightings.add(5.0, bright as f64 - 1.0);
                }
            }
            let chance = *sightings.chances().of(5.0);
            // Two hundred pairs at 0.1 give an accuracy of 1/14, four at 0.02 one of 1/2.
            let doubt = 4.0 * (20_000.0f64 * lambda * lambda / 2.0).sqrt().recip();
            assert!((chance.likely / lambda - 1.0).abs() < doubt, "{lambda}: {chance:?}");
            assert!(chance.most > lambda);
        }
    }
}
