//! Owen scrambling, which randomizes digits and preserves stratification.

/// Scramble 64 binary digits after the point. `digits` holds the first ones, least significant bit first, and `random`
/// selects the scrambling.
///
/// Owen's nested scrambling ("Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995) makes each number uniform. Two
/// numbers that agree in exactly k digits still do so afterwards, and their further digits are independent. So does d ↦
/// a·d + c modulo 2⁶⁴ with a random odd a and a random c, least significant bit first. The difference of two numbers is
/// 2ᵏ times an odd number, and a maps that to 2ᵏ times any odd number with equal probability. Since variance depends on
/// pairs of samples only, one multiplication replaces Owen's tree of permutations exactly.
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
        // (digits, digits, number of leading digits in common).
        for (i, j, shared) in [(0u32, 1, 0), (5, 4, 0), (5, 7, 1), (0b1_0110, 0b0_0110, 4), (3, 35, 5)] {
            let (mut long, mut short) = (vec![0; 1024], vec![0; 1024]);
            for pick in 0..100_000 {
                let [a, b] = [i, j].map(|digits| scramble(digits, random(pick)));
                assert_eq!((a ^ b).leading_zeros(), shared);
                let [c, d] = [i, j].map(|digits| scramble_short(digits, random(pick)[0]));
                assert_eq!((c ^ d).leading_zeros(), shared);
                // The five digits of each after the first difference.
                let after = |x: u64| (x << (shared + 1) >> 59) as usize;
                long[after(a) * 32 + after(b)] += 1;
                short[after(u64::from(c) << 32) * 32 + after(u64::from(d) << 32)] += 1;
            }
            assert_frequencies(&long, &[1.0 / 1024.0; 1024]);
            assert_frequencies(&short, &[1.0 / 1024.0; 1024]);
        }
    }
}
