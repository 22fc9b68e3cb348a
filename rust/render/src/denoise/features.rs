//! Prefiltering of auxiliary features.

use super::planes::{Area, Size, away, blurred};
use super::similarity::{Comparing, Guide};
use raywright_base::parallel;
use raywright_base::workers::Cancel;

/// Number of features per pixel: albedo, normal, and inverse distance.
pub const FEATURES: usize = 7;

/// Feature channels that are filtered together.
const GROUPS: [std::ops::Range<usize>; 3] = [0..3, 3..6, 6..7];

/// Filter radius, and patch radius of the comparison.
const REACH: isize = 3;
const PATCH: usize = 1;

/// Tolerance for differences of features beyond their noise.
const LEAST: f64 = 1e-4;

/// Prefilters features: a plane for each, from two independent pictures with all features pixel by pixel.
///
/// Features are noise-free except at edges and under depth of field or motion blur. Each picture is filtered with
/// weights from the other (Rousselle, Manzi and Zwicker, "Robust Denoising using Feature and Color Information", 2013).
pub(super) fn prefiltered(pictures: &[Vec<f64>; 2], size: Size, cancel: &Cancel) -> Vec<Vec<f64>> {
    let planes = |picture: &[f64]| -> Vec<Vec<f64>> {
        (0..FEATURES).map(|feature| picture.iter().skip(feature).step_by(FEATURES).copied().collect()).collect()
    };
    let [one, other] = [planes(&pictures[0]), planes(&pictures[1])];
    let mut all = Vec::new();
    for group in GROUPS {
        let (one, other) = (&one[group.clone()], &other[group]);
        let off = |i: usize| one.iter().zip(other).map(|(a, b)| (a[i] - b[i]).powi(2)).sum::<f64>() / 2.0;
        let variance = blurred(&(0..size.pixels()).map(off).collect::<Vec<f64>>(), size, 1);
        let filtered = |guide, values| {
            filtered(&Guide { channels: guide, variance: &variance, least: LEAST }, values, size, cancel)
        };
        let (a, b) = (filtered(one, other), filtered(other, one));
        let mean = |(a, b): (Vec<f64>, Vec<f64>)| a.iter().zip(&b).map(|(a, b)| (a + b) / 2.0).collect();
        all.extend(a.into_iter().zip(b).map(mean));
    }
    all
}

/// Filters planes by the similarity of pixels in a guide.
fn filtered(guide: &Guide, planes: &[Vec<f64>], size: Size, cancel: &Cancel) -> Vec<Vec<f64>> {
    let of_tile = |area: &Area| {
        let mut comparing = Comparing::default();
        let (mut distances, mut sums) = (vec![0.0; area.pixels()], vec![vec![0.0; area.pixels()]; planes.len() + 1]);
        for offset in (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| [dx, dy])) {
            if cancel.is_raised() {
                break;
            }
            comparing.distances(guide, size, area, offset, PATCH, &mut distances);
            for (i, distance) in distances.iter().enumerate().filter(|(_, distance)| **distance < 16.0) {
                let (x, y) = (i % area.columns.len(), i / area.columns.len());
                let there = away((area.rows.start + y) * size.width + area.columns.start + x, offset, size);
                let weight = (-distance.max(0.0)).exp();
                planes.iter().zip(&mut sums).for_each(|(plane, sum)| sum[i] += weight * plane[there]);
                sums[planes.len()][i] += weight;
            }
        }
        sums
    };
    let tiles = size.tiles(32);
    let found: Vec<Vec<Vec<f64>>> = parallel::map(tiles.len(), |i| of_tile(&tiles[i]));
    let mut all = vec![vec![0.0; size.pixels()]; planes.len()];
    for (area, sums) in tiles.iter().zip(found) {
        let weights = &sums[planes.len()];
        for (plane, sums) in all.iter_mut().zip(&sums) {
            let places = area.rows.clone().flat_map(|y| area.columns.clone().map(move |x| y * size.width + x));
            for ((place, sum), weight) in places.zip(sums).zip(weights) {
                // Never zero, because a pixel has full weight for itself.
                plane[place] = sum / weight;
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    #[test]
    fn edges_stay_and_noise_goes() {
        let size = Size { width: 24, height: 24 };
        let noisy = |seed: u64| -> Vec<f64> {
            let of = |i: usize| {
                let pixel = i / FEATURES;
                let draw = Sampler::new(seed, i as u32, 0).one(0) - 0.5;
                if pixel % 24 < 12 { 0.2 + 0.02 * draw } else { 0.8 }
            };
            (0..size.pixels() * FEATURES).map(of).collect()
        };
        let found = prefiltered(&[noisy(1), noisy(2)], size, &Cancel::default());
        assert_eq!(found.len(), FEATURES);
        for plane in found {
            for (i, value) in plane.iter().enumerate() {
                let off = value - if i % 24 < 12 { 0.2 } else { 0.8 };
                assert!(off.abs() < 0.004, "{i}: {off}");
            }
        }
    }
}
