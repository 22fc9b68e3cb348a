//! Hierarchical sampling of grid cells.

/// A pyramid of sums of cell weights, over 2 × 2 cells, 4 × 4, and so on. Sampling descends the pyramid and consumes
/// two random numbers one decision at a time (Clarberg et al., "Wavelet Importance Sampling", 2005, in its simplest
/// form). Neighboring numbers map to neighboring cells, which preserves stratification. The finest weights are
/// recomputed by the caller, so a cell takes at most 8/3 bytes.
#[derive(Clone, Debug)]
pub struct Pyramid {
    size: [usize; 2],
    /// From fine to coarse, the first over 2 × 2 cells.
    levels: Vec<PyramidLevel>,
    total: f64,
}

#[derive(Clone, Debug)]
struct PyramidLevel {
    width: usize,
    sums: Vec<f64>,
}

/// The largest f64 below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

impl Pyramid {
    /// Builds a pyramid over a grid of columns and rows with finite, non-negative weights; `None` if all are 0.
    pub fn new(size: [usize; 2], weight: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let mut levels: Vec<PyramidLevel> = Vec::new();
        let [mut width, mut height] = size;
        loop {
            let [wide, high] = [width.div_ceil(2), height.div_ceil(2)];
            let finer = |i: usize, j: usize| {
                if i >= width || j >= height {
                    return 0.0;
                }
                levels.last().map_or_else(|| weight(i, j), |level| level.sums[j * level.width + i])
            };
            let sum = |i: usize, j: usize| {
                finer(2 * i, 2 * j) + finer(2 * i + 1, 2 * j) + (finer(2 * i, 2 * j + 1) + finer(2 * i + 1, 2 * j + 1))
            };
            let sums = (0..high).flat_map(|j| (0..wide).map(move |i| (i, j))).map(|(i, j)| sum(i, j)).collect();
            levels.push(PyramidLevel { width: wide, sums });
            (width, height) = (wide, high);
            if width == 1 && height == 1 {
                break;
            }
        }
        let total = levels.last()?.sums[0];
        (total > 0.0 && total.is_finite()).then_some(Self { size, levels, total })
    }

    /// Sum of all weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Samples a cell with probability weight / total. Also returns the remaining two numbers, which are uniform in the
    /// cell. `weight` must be the function the pyramid was built with.
    #[inline]
    pub fn sample(&self, [mut u, mut v]: [f64; 2], weight: impl Fn(usize, usize) -> f64) -> ([usize; 2], [f64; 2]) {
        let (mut i, mut j) = (0, 0);
        for level in (0..self.levels.len()).rev() {
            let finer = |i: usize, j: usize| match level {
                0 if i < self.size[0] && j < self.size[1] => weight(i, j),
                0 => 0.0,
                _ => {
                    let level = &self.levels[level - 1];
                    let inside = i < level.width && (j + 1) * level.width <= level.sums.len();
                    if inside { level.sums[j * level.width + i] } else { 0.0 }
                }
            };
            (i, j) = (2 * i, 2 * j);
            let rows = [finer(i, j), finer(i + 1, j), finer(i, j + 1), finer(i + 1, j + 1)];
            let row;
            (row, v) = choose(v, rows[0] + rows[1], rows[2] + rows[3]);
            let column;
            (column, u) = choose(u, rows[2 * row], rows[2 * row + 1]);
            (i, j) = (i + column, j + row);
        }
        ([i, j], [u, v])
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.sums.as_slice())).sum()
    }
}

/// Selects the first or second of two, and rescales the random number.
#[inline]
fn choose(u: f64, first: f64, second: f64) -> (usize, f64) {
    let share = first / (first + second);
    if u < share || second == 0.0 {
        (0, (u / share).min(BELOW_ONE))
    } else {
        (1, ((u - share) / (1.0 - share)).min(BELOW_ONE))
    }
}

/// Samples a number in [0, 1] with a density that is linear between two weights, not both 0.
#[inline]
pub fn linear(u: f64, from: f64, to: f64) -> f64 {
    let root = (from * from + u * (to * to - from * from)).max(0.0).sqrt();
    let sum = from + root;
    if sum > 0.0 { (u * (from + to) / sum).min(1.0) } else { u }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::chi_square::assert_frequencies;

    #[test]
    fn cells_are_drawn_by_weight_and_what_is_left_is_even() {
        for (width, height) in [(1, 1), (7, 5), (8, 3), (1, 9), (13, 2)] {
            let weight = |i: usize, j: usize| if (i + j) % 3 == 1 { 0.0 } else { (1 + i * 2 + j) as f64 };
            let pyramid = Pyramid::new([width, height], weight).unwrap();
            let cells = || (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
            let total: f64 = cells().map(|(i, j)| weight(i, j)).sum();
            assert_eq!(pyramid.total(), total);
            let (mut counts, mut halves) = (vec![0; width * height], [0; 4]);
            for sample in 0..50_000 {
                let ([i, j], [u, v]) = pyramid.sample(Sampler::new(4, width as u32, sample).two(0), weight);
                counts[j * width + i] += 1;
                halves[usize::from(u < 0.5) + 2 * usize::from(v < 0.5)] += 1;
            }
            if counts.len() > 1 {
                let expected: Vec<f64> = cells().map(|(i, j)| weight(i, j) / total).collect();
                assert_frequencies(&counts, &expected);
            }
            assert_frequencies(&halves, &[0.25; 4]);
        }
        assert!(Pyramid::new([3, 3], |_, _| 0.0).is_none());
    }

    #[test]
    fn one_bright_cell_among_dim_ones_is_drawn_as_often_as_it_should_be() {
        let weight = |i: usize, j: usize| if (i, j) == (70, 33) { 1e7 } else { 1.0 };
        let pyramid = Pyramid::new([128, 64], weight).unwrap();
        let bright = |sample| pyramid.sample(Sampler::new(9, 0, sample).two(0), weight).0 == [70, 33];
        let others = (0..200_000).filter(|&sample| !bright(sample)).count() as f64;
        // 164 expected; the bound is five standard deviations, with a probability of exceeding it of one in two
        // million.
        let expected = 200_000.0 * 8191.0 / (1e7 + 8191.0);
        assert!((others - expected).abs() < 5.0 * expected.sqrt(), "{others} {expected}");
    }

    #[test]
    fn linear_draws_invert_their_distribution() {
        for (from, to) in [(1.0, 3.0), (0.0, 1.0), (2.0, 0.0), (1.0, 1.0), (1e-100, 1e100)] {
            for i in 0..=100 {
                let u = f64::from(i) / 100.0;
                let x = linear(u, from, to);
                let up_to: f64 = (from * x + 0.5 * (to - from) * x * x) / (0.5 * (from + to));
                assert!((0.0..=1.0).contains(&x) && (up_to - u).abs() < 1e-12, "{from} {to} {u}");
            }
        }
    }
}
