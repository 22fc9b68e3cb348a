//! Cubic interpolation in tables.

use glam::Vec4;
use std::fmt;

/// Position of a variable in a table, and the weights of the four entries around it: a Catmull-Rom spline ("A Class of
/// Local Interpolating Splines", 1974), whose slopes are secants of the neighbors. At an end, the missing neighbor is
/// extrapolated by the parabola through the last three entries.
#[derive(Clone, Copy, Debug)]
pub struct Cubic {
    first: u32,
    weights: [f32; 4],
}

impl Cubic {
    /// Computes the position of a variable from 0 to 1 in a table with `count` ≥ 4 entries for it.
    #[inline(always)]
    pub fn new(variable: f64, count: usize) -> Self {
        let at = variable.clamp(0.0, 1.0) * (count - 1) as f64;
        // Conversion to 32 bits and back takes one instruction each.
        let low = (at as i32).min(count as i32 - 2);
        let f = (at - f64::from(low)) as f32;
        let g = 1.0 - f;
        let (a, d) = (-0.5 * f * g * g, -0.5 * f * f * g);
        let (b, c) = (1.0 + f * f * (1.5 * f - 2.5), 1.0 + g * g * (1.5 * g - 2.5));
        let (first, weights) = if low == 0 {
            (0, [b + 3.0 * a, c - 3.0 * a, d + a, 0.0])
        } else if low == count as i32 - 2 {
            (low - 2, [0.0, a + d, b - 3.0 * d, c + 3.0 * d])
        } else {
            (low - 1, [a, b, c, d])
        };
        Self { first: first as u32, weights }
    }

    #[inline]
    fn first(&self) -> usize {
        self.first as usize
    }
}

/// A table from a file: 16-bit little-endian numbers, the last variable fastest.
#[derive(Clone, Copy)]
pub struct Table<const N: usize> {
    /// Its entries.
    pub bytes: &'static [u8],
    /// Number of entries for each variable.
    pub sizes: [usize; N],
    /// Values of the entries 0 and 65535.
    pub range: [f32; 2],
}

impl<const N: usize> fmt::Debug for Table<N> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Table").field("sizes", &self.sizes).finish_non_exhaustive()
    }
}

impl<const N: usize> Table<N> {
    /// Four consecutive entries from index `at`.
    #[inline(always)]
    fn four(&self, at: usize) -> Vec4 {
        let bytes = self.bytes[2 * at..].first_chunk().expect("four entries from there on");
        // This form compiles to one load and one conversion of all four.
        let four = u64::from_le_bytes(*bytes);
        let entries = [four as u16, (four >> 16) as u16, (four >> 32) as u16, (four >> 48) as u16];
        Vec4::from_array(entries.map(f32::from))
    }

    /// Converts a weighted sum of entries, with weights that sum to 1, to a value.
    #[inline]
    fn scaled(&self, sum: f32) -> f64 {
        let [low, high] = self.range;
        f64::from(low + sum * ((high - low) / 65535.0))
    }
}

#[inline(always)]
fn dot(a: Vec4, b: [f32; 4]) -> f32 {
    let [x, y, z, w] = (a * Vec4::from_array(b)).to_array();
    (x + y) + (z + w)
}

impl Table<1> {
    /// Interpolated value.
    #[inline]
    pub fn at(&self, a: &Cubic) -> f64 {
        self.scaled(dot(self.four(a.first()), a.weights))
    }
}

impl Table<2> {
    /// Interpolated value.
    #[inline(always)]
    pub fn at(&self, a: &Cubic, b: &Cubic) -> f64 {
        let mut sum = Vec4::ZERO;
        for i in 0..4 {
            sum += self.four((a.first() + i) * self.sizes[1] + b.first()) * a.weights[i];
        }
        self.scaled(dot(sum, b.weights))
    }
}

impl Table<3> {
    /// Interpolated value.
    #[inline]
    pub fn at(&self, a: &Cubic, b: &Cubic, c: &Cubic) -> f64 {
        let [_, m, n] = self.sizes;
        let mut sum = Vec4::ZERO;
        for i in 0..4 {
            for j in 0..4 {
                let four = self.four(((a.first() + i) * m + b.first() + j) * n + c.first());
                sum += four * (a.weights[i] * b.weights[j]);
            }
        }
        self.scaled(dot(sum, c.weights))
    }
}

impl Table<4> {
    /// Interpolated value.
    #[inline]
    pub fn at(&self, a: &Cubic, b: &Cubic, c: &Cubic, d: &Cubic) -> f64 {
        let [_, l, m, n] = self.sizes;
        let mut sum = Vec4::ZERO;
        for i in 0..4 {
            for j in 0..4 {
                let weight = a.weights[i] * b.weights[j];
                for k in 0..4 {
                    let at = ((a.first() + i) * l + b.first() + j) * m + c.first() + k;
                    sum += self.four(at * n + d.first()) * (weight * c.weights[k]);
                }
            }
        }
        self.scaled(dot(sum, d.weights))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of these entries, from 0 to 65535.
    fn table<const N: usize>(sizes: [usize; N], entry: impl Fn([f64; N]) -> f64) -> Table<N> {
        let count: usize = sizes.iter().product();
        let bytes = (0..count).flat_map(|number| {
            let mut rest = number;
            let mut at = [0.0; N];
            for k in (0..N).rev() {
                at[k] = (rest % sizes[k]) as f64;
                rest /= sizes[k];
            }
            (entry(at) as u16).to_le_bytes()
        });
        Table { bytes: bytes.collect::<Vec<u8>>().leak(), sizes, range: [0.0, 65535.0] }
    }

    #[test]
    fn parabolas_are_read_as_they_are() {
        // Also between the first two entries and the last two.
        let one = table([9], |[i]| 700.0 * (i - 3.0) * (i - 3.0) + 11.0);
        for k in 0..=400 {
            let v = f64::from(k) / 400.0;
            let truth = 700.0 * (8.0 * v - 3.0).powi(2) + 11.0;
            assert!((one.at(&Cubic::new(v, 9)) - truth).abs() < 0.02, "{v}");
        }
        let four = table([4, 5, 6, 7], |[a, b, c, d]| (a + 1.0) * (b - 2.0).powi(2) * (c + 3.0) * d * d);
        for k in 0..=1000 {
            let v = [1, 7, 31, 113].map(|turn| f64::from(k * turn % 1001) / 1000.0);
            let cubics = [(v[0], 4), (v[1], 5), (v[2], 6), (v[3], 7)].map(|(v, count)| Cubic::new(v, count));
            let [a, b, c, d] = &cubics;
            let truth = (3.0 * v[0] + 1.0) * (4.0 * v[1] - 2.0).powi(2) * (5.0 * v[2] + 3.0) * (6.0 * v[3]).powi(2);
            assert!((four.at(a, b, c, d) - truth).abs() < 0.05, "{v:?}");
        }
    }

    #[test]
    fn weights_sum_to_one_and_what_is_beyond_is_the_end() {
        for count in [4, 5, 33] {
            for v in [-1.0, 0.0, 1e-9, 0.1, 0.5, 0.999, 1.0, 7.0] {
                let cubic = Cubic::new(v, count);
                assert!((cubic.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                assert!(cubic.first() + 4 <= count);
            }
            let line = table([count], |[i]| 100.0 * i);
            let end = 100.0 * (count - 1) as f64;
            assert!(line.at(&Cubic::new(-1.0, count)).abs() < 1e-3);
            assert!((line.at(&Cubic::new(7.0, count)) - end).abs() < 1e-3 * end);
        }
    }
}
