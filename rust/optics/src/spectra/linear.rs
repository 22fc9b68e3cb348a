//! Linear interpolation in tables over wavelength.

/// Interpolates a row of a table linearly. Each row starts with its wavelength, in increasing order. `None` outside the
/// table.
#[inline]
pub fn at<const N: usize>(rows: &[[f64; N]], wavelength: f64) -> Option<[f64; N]> {
    let after = rows.partition_point(|row| row[0] <= wavelength);
    match (after.checked_sub(1).map(|before| rows[before]), rows.get(after)) {
        (Some(a), Some(b)) => {
            let share = (wavelength - a[0]) / (b[0] - a[0]);
            Some(std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
        }
        (Some(a), None) if a[0] == wavelength => Some(a),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_met_and_lines_go_between() {
        let rows = [[400.0, 1.0, 8.0], [500.0, 3.0, 4.0], [520.0, 2.0, 4.0]];
        for row in rows {
            assert_eq!(at(&rows, row[0]), Some(row));
        }
        assert_eq!(at(&rows, 425.0), Some([425.0, 1.5, 7.0]));
        assert_eq!(at(&rows, 510.0), Some([510.0, 2.5, 4.0]));
        for outside in [399.9, 520.1, f64::NAN] {
            assert_eq!(at(&rows, outside), None);
        }
        assert_eq!(at::<2>(&[], 500.0), None);
    }
}
