//! Digits made random, so that what was spread evenly still is.

/// The 64 binary digits after the point of a number whose first digits are `digits`, least significant bit first,
/// scrambled as `random` picks.
///
/// Owen's nested scrambling ("Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995) makes each number uniform, and
/// two that agree in k digits into two that agree in k digits and no more, whose further digits are independent. So
/// does d ↦ a·d + c modulo 2⁶⁴ with a random odd a and a random c, least significant bit first: the difference of two
/// numbers is 2ᵏ times something odd, and a makes that 2ᵏ times anything odd, equally often. As variance depends on
/// samples two at a time, one multiplication does the work of Owen's tree of coins, and does it exactly.
#[inline(always)]
pub(super) fn scramble(digits: u32, random: [u64; 2]) -> u64 {
    u64::from(digits).wrapping_mul(random[0] | 1).wrapping_add(random[1]).reverse_bits()
}

/// As [`scramble`], with 32 digits.
#[inline(always)]
pub(super) fn scramble_short(digits: u32, random: u64) -> u32 {
    digits.wrapping_mul(random as u32 | 1).wrapping_add((random >> 32) as u32).reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::super::chi_square::assert_frequencies;
    use super::super::philox4x32;
    use super::*;

    fn random(i: u32) -> [u64; 2] {
        let [a, b, c, d] = philox4x32([i, 1, 0, 0], [5, 7]).map(u64::from);
        [a << 32 | b, c << 32 | d]
    }

    #[test]
    fn as_many_digits_agree_as_before_and_the_rest_is_independent() {
        // (digits, digits, how many first ones they share).
        for (i, j, shared) in [(0u32, 1, 0), (5, 4, 0), (5, 7, 1), (0b1_0110, 0b0_0110, 4), (3, 35, 5)] {
            let (mut long, mut short) = (vec![0; 1024], vec![0; 1024]);
            for pick in 0..100_000 {
                let [a, b] = [i, j].map(|digits| scramble(digits, random(pick)));
                assert_eq!((a ^ b).leading_zeros(), shared);
                let [c, d] = [i, j].map(|digits| scramble_short(digits, random(pick)[0]));
                assert_eq!((c ^ d).leading_zeros(), shared);
                // The five digits of each that follow the first in which they differ.
                let after = |x: u64| (x << (shared + 1) >> 59) as usize;
                long[after(a) * 32 + after(b)] += 1;
                short[after(u64::from(c) << 32) * 32 + after(u64::from(d) << 32)] += 1;
            }
            assert_frequencies(&long, &[1.0 / 1024.0; 1024]);
            assert_frequencies(&short, &[1.0 / 1024.0; 1024]);
        }
    }
}
