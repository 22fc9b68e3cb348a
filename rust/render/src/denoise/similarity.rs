//! Similarity of patches around two pixels.

use super::planes::{Area, Size, away};

/// The data that pixels are compared by.
pub(super) struct Guide<'a> {
    /// Channels, one plane each.
    pub channels: &'a [Vec<f64>],
    /// Variance of each pixel, summed over channels.
    pub variance: &'a [f64],
    /// Added to variances, so that noise-free data can be compared.
    pub least: f64,
}

/// Compares patches; its buffers are reused.
#[derive(Default)]
pub(super) struct Comparing {
    points: Vec<f64>,
    across: Vec<f64>,
}

impl Comparing {
    /// For each pixel of an area, the distance of its patch from that at `offset`: the squared difference minus its
    /// expectation from noise, over the variance of both, averaged over the patch (Rousselle, Knaus and Zwicker,
    /// "Adaptive Rendering with Non-Local Means Filtering", 2012). Infinite if the other pixel is outside the picture.
    /// Patches extend `reach` pixels in each direction.
    pub fn distances(
        &mut self,
        guide: &Guide,
        size: Size,
        area: &Area,
        offset: [isize; 2],
        reach: usize,
        into: &mut [f64],
    ) {
        into.fill(f64::INFINITY);
        let (wide, part) = (area.wider(reach, size).with(offset, size), area.with(offset, size));
        if part.pixels() == 0 {
            return;
        }
        let (width, columns) = (wide.columns.len(), part.columns.len());
        self.points.clear();
        self.points.resize(wide.pixels(), 0.0);
        for (points, y) in self.points.chunks_mut(width).zip(wide.rows.clone()) {
            let here = y * size.width + wide.columns.start;
            let there = away(here, offset, size);
            for channel in guide.channels {
                let pairs = channel[here..here + width].iter().zip(&channel[there..there + width]);
                points.iter_mut().zip(pairs).for_each(|(sum, (a, b))| *sum += (a - b) * (a - b));
            }
            let pairs = guide.variance[here..here + width].iter().zip(&guide.variance[there..there + width]);
            for (point, (&a, &b)) in points.iter_mut().zip(pairs) {
                *point = (*point - (a + a.min(b))) / (guide.least + a + b);
            }
        }
        let near = |at: usize, start: usize, end: usize| at.saturating_sub(reach).max(start)..end.min(at + reach + 1);
        self.across.clear();
        self.across.resize(wide.rows.len() * columns, 0.0);
        for (across, points) in self.across.chunks_mut(columns).zip(self.points.chunks(width)) {
            for (across, x) in across.iter_mut().zip(part.columns.clone()) {
                let near = near(x, wide.columns.start, wide.columns.end);
                let first = near.start - wide.columns.start;
                *across = points[first..first + near.len()].iter().sum::<f64>() / near.len() as f64;
            }
        }
        for y in part.rows.clone() {
            let start = (y - area.rows.start) * area.columns.len() + part.columns.start - area.columns.start;
            let into = &mut into[start..start + columns];
            into.fill(0.0);
            let near = near(y, wide.rows.start, wide.rows.end);
            for row in near.clone() {
                let across = &self.across[(row - wide.rows.start) * columns..][..columns];
                into.iter_mut().zip(across).for_each(|(sum, value)| *sum += value);
            }
            into.iter_mut().for_each(|sum| *sum /= near.len() as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_means_over_patches() {
        let size = Size { width: 9, height: 6 };
        let plane = |n: usize| (0..54).map(|i| ((i * (n + 5) * 7 + i * i) % 31) as f64 / 31.0).collect::<Vec<f64>>();
        let (channels, variance) = ([plane(0), plane(1)], plane(2));
        let guide = Guide { channels: &channels, variance: &variance, least: 0.1 };
        let area = Area { columns: 3..8, rows: 1..6 };
        let point = |p: usize, q: usize| {
            let square: f64 = channels.iter().map(|channel| (channel[p] - channel[q]).powi(2)).sum();
            let (a, b) = (variance[p], variance[q]);
            (square - (a + a.min(b))) / (0.1 + a + b)
        };
        let mut comparing = Comparing::default();
        for [dx, dy] in [[0isize, 0isize], [2, -1], [-4, 3], [8, 0]] {
            let mut found = vec![0.0; area.pixels()];
            comparing.distances(&guide, size, &area, [dx, dy], 2, &mut found);
            for (i, found) in found.into_iter().enumerate() {
                let (x, y) = ((3 + i % 5) as isize, (1 + i / 5) as isize);
                let is_there = |x: isize, y: isize| (0..9).contains(&x) && (0..6).contains(&y);
                let (mut sum, mut count) = (0.0, 0.0);
                for (a, b) in (x - 2..=x + 2).flat_map(|a| (y - 2..=y + 2).map(move |b| (a, b))) {
                    if is_there(a, b) && is_there(a + dx, b + dy) {
                        sum += point((b * 9 + a) as usize, ((b + dy) * 9 + a + dx) as usize);
                        count += 1.0;
                    }
                }
                let expected = if is_there(x + dx, y + dy) { sum / count } else { f64::INFINITY };
                assert!(found == expected || (found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}
