//! Parsing of numbers in text.

/// Parses the numbers at the beginning of a text, and returns whether nothing else follows. Numbers are separated by
/// ASCII white space; words listed in `skipped` may occur between them.
///
/// Numbers are rounded correctly; `inf` and `nan` are numbers.
pub fn leading_numbers(text: &[u8], skipped: &[&[u8]]) -> (Vec<f64>, bool) {
    // A number and its separator take at least two bytes, and usually more.
    let mut numbers = Vec::with_capacity(text.len() / 8);
    for word in text.split(|&byte| byte.is_ascii_whitespace() || byte == 0x0b) {
        if word.is_empty() || (word[0].is_ascii_alphabetic() && skipped.contains(&word)) {
            continue;
        }
        match std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
            Some(number) => numbers.push(number),
            None => return (numbers, false),
        }
    }
    (numbers, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_written_is_read(
            values in prop::collection::vec(any::<f64>(), 0..20),
            gap in "[ \t\r\n\u{b}\u{c}]{1,3}",
        ) {
            let text = values.iter().map(|x| format!("{x:e}{gap}")).collect::<String>();
            let (found, whole) = leading_numbers(text.as_bytes(), &[]);
            let bits = |all: &[f64]| all.iter().map(|x| if x.is_nan() { 1 } else { x.to_bits() }).collect::<Vec<_>>();
            prop_assert_eq!(bits(&found), bits(&values));
            prop_assert!(whole);
        }
    }

    #[test]
    fn numbers_end_at_the_first_other_word() {
        let wanted = (vec![1.0, 0.5, -2e3], false);
        assert_eq!(leading_numbers(b"1 .5 -2e3 x 7", &[]), wanted);
        assert_eq!(leading_numbers(b" vertex 1 .5\n-2E3 \xff", &[b"vertex"]), wanted);
        assert_eq!(leading_numbers(b" \n ", &[]), (vec![], true));
        assert_eq!(leading_numbers(b"+1. inf", &[]), (vec![1.0, f64::INFINITY], true));
        assert!(!leading_numbers(b"1,5", &[]).1 && !leading_numbers(b"1.#IND", &[]).1);
    }
}
