//! How often bright samples are seen again.

/// The cells of a picture whose brightest sample stands out, by how bright that is and whether the cell has another.
///
/// A pixel with one bright sample may lie on the edge of a lamp, where many of its samples would be as bright, or have
/// met what almost none does. It cannot tell, but all pixels together can. If bright samples come to a cell as rare
/// events do, λ of them on average, cells with one and with two of them are as many as tells of it: of those with one,
/// λ is twice the number of those with two over the number of those with one (Good, "The Population Frequencies of
/// Species and the Estimation of Population Parameters", 1953, who credits Turing). What is rare differs by how bright
/// it is, so this is asked of each octave of brightness, with the two beside it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sightings([[u64; 2]; OCTAVES + 2]);

/// Powers of two that are told apart, the least of them 2⁻³²; what is darker or brighter counts to the first or the
/// last. One more at either end has nothing in it.
const OCTAVES: usize = 96;

/// How many samples as bright as its brightest a cell may have on average, of those that have one: 1 if each is as
/// bright as it says, and 0 if nothing so bright is to come again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chance {
    /// As many as is likely.
    pub likely: f64,
    /// As many as there may be.
    pub most: f64,
}

impl Default for Sightings {
    fn default() -> Self {
        Self([[0; 2]; OCTAVES + 2])
    }
}

impl Sightings {
    /// Counts a cell in: the brightness of its brightest sample, and the squares of what is left without it over that
    /// one's, which is how many more of the same size would make them.
    #[inline]
    pub fn add(&mut self, brightness: f64, again: f64) {
        let counts = &mut self.0[octave(brightness)];
        // Of events that are not of one size, another of half the size still counts, and two more do not count for one.
        if again < 0.25 {
            counts[0] += 1;
        } else if again < 1.5 {
            counts[1] += 1;
        }
    }

    /// Counts in what another has counted.
    pub fn join(&mut self, other: &Self) {
        for (counts, others) in self.0.iter_mut().zip(&other.0) {
            counts[0] += others[0];
            counts[1] += others[1];
        }
    }

    /// The chances of samples of each octave.
    pub fn chances(&self) -> Chances {
        Chances(std::array::from_fn(|octave| {
            let around = if octave == 0 { &self.0[..2] } else { &self.0[octave - 1..(octave + 2).min(OCTAVES + 2)] };
            let [once, twice] = [0, 1].map(|which| around.iter().map(|counts| counts[which]).sum::<u64>() as f64);
            // One of its kind says nothing of how rare it is, two say a little.
            let little = 2.0 / once.max(1.0).powi(2);
            let likely = ((2.0 * twice + little) / (once + little)).min(1.0);
            // Of none where three are to be expected, chance makes one time in twenty.
            let most = (2.0 * (twice + 2.0 * twice.sqrt() + 3.0) / once.max(1.0)).min(1.0);
            Chance { likely, most }
        }))
    }
}

/// A chance for each octave.
pub(super) struct Chances([Chance; OCTAVES + 2]);

impl Chances {
    /// Of samples as bright as that.
    #[inline]
    pub fn of(&self, brightness: f64) -> &Chance {
        &self.0[octave(brightness)]
    }
}

/// Read from the bits, so that it is the same everywhere.
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
        // What is much darker or brighter says nothing.
        (0..1000).for_each(|_| sightings.add(8.0, 0.0));
        assert!(chance(&sightings).likely > 0.5 && sightings.chances().of(8.0).most < 0.01);
    }

    #[test]
    fn finds_how_rare_events_are() {
        // Cells of 64 samples, each of which is bright with a chance of λ/64: those that are bright once shall know λ.
        for lambda in [0.02, 0.1, 0.5] {
            let mut sightings = Sightings::default();
            for cell in 0..20_000u32 {
                let bright = (0..64).filter(|&n| Sampler::new(3, cell, n).one(0) < lambda / 64.0).count();
                if bright > 0 {
                    sightings.add(5.0, bright as f64 - 1.0);
                }
            }
            let chance = *sightings.chances().of(5.0);
            // Two hundred pairs at 0.1 are known to a fourteenth, four at 0.02 to a half.
            let doubt = 4.0 * (20_000.0f64 * lambda * lambda / 2.0).sqrt().recip();
            assert!((chance.likely / lambda - 1.0).abs() < doubt, "{lambda}: {chance:?}");
            assert!(chance.most > lambda);
        }
    }
}
