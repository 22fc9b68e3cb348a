//! Transposition of rows of three numbers to columns.

/// Four vectors of three, by axis.
#[inline(always)]
pub fn columns_of_four(rows: &[[f32; 3]; 4]) -> [[f32; 4]; 3] {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::*;
        let numbers = rows.as_flattened();
        let mut columns = [[0.0; 4]; 3];
        // SAFETY: every x86-64 processor has the instructions; twelve numbers are read, and twelve written.
        unsafe {
            // x y z x, y z x y, z x y z.
            let a = _mm_loadu_ps(numbers.as_ptr());
            let b = _mm_loadu_ps(numbers.as_ptr().add(4));
            let c = _mm_loadu_ps(numbers.as_ptr().add(8));
            let x = _mm_shuffle_ps::<0b10_00_11_00>(a, _mm_shuffle_ps::<0b01_01_10_10>(b, c));
            let (y, more) = (_mm_shuffle_ps::<0b00_00_01_01>(a, b), _mm_shuffle_ps::<0b10_10_11_11>(b, c));
            let y = _mm_shuffle_ps::<0b10_00_10_00>(y, more);
            let z = _mm_shuffle_ps::<0b11_00_10_00>(_mm_shuffle_ps::<0b01_01_10_10>(a, b), c);
            for (column, numbers) in columns.iter_mut().zip([x, y, z]) {
                _mm_storeu_ps(column.as_mut_ptr(), numbers);
            }
        }
        columns
    }
    #[cfg(not(target_arch = "x86_64"))]
    [0, 1, 2].map(|axis| [rows[0][axis], rows[1][axis], rows[2][axis], rows[3][axis]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_what_rows_have() {
        let rows = [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 8.0], [9.0, 10.0, 11.0]];
        assert_eq!(columns_of_four(&rows), [[0.0, 3.0, 6.0, 9.0], [1.0, 4.0, 7.0, 10.0], [2.0, 5.0, 8.0, 11.0]]);
    }
}
