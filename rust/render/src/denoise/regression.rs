//! Weighted linear regression of pixels on features.

use super::features::FEATURES;
use super::planes::{Area, Size};
use super::similarity::{Comparing, Guide};
use raywright_base::parallel;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Filter radius, and patch radius of the comparison.
const REACH: isize = 7;
const PATCH: usize = 1;

/// Side of the tiles, chosen so that their sums stay in cache.
const SIDE: usize = 32;

/// Regressors per pixel: a constant, and the features.
const TERMS: usize = FEATURES + 1;

/// Sums per pixel: products of two regressors, and of a regressor and a channel.
const PRODUCTS: usize = TERMS * (TERMS + 1) / 2;
const MOMENTS: usize = PRODUCTS + 3 * TERMS;

/// Ridge on the squared variation of features; slopes over smaller variation are suppressed.
const RIDGE: f64 = 1e-4;

/// Weights below this one are skipped.
const FAINTEST: f64 = 1e-4;

/// Lower bound of the guide's variances.
const LEAST: f64 = 1e-10;

/// Filters a picture by linear fits to the features around each pixel, weighted by similarity in a guide, for each
/// bandwidth. `variance` is that of the mean of guide and values, two independent parts of equal size.
pub(super) fn filtered(
    guide: &[Rgb],
    variance: &[f64],
    values: &[Rgb],
    features: &[Vec<f64>],
    size: Size,
    bandwidths: &[f64],
    cancel: &Cancel,
) -> Vec<Vec<Rgb>> {
    let channels: Vec<Vec<f64>> = (0..3).map(|channel| guide.iter().map(|rgb| rgb[channel]).collect()).collect();
    let variance: Vec<f64> = variance.iter().map(|variance| 2.0 * variance).collect();
    let guide = Guide { channels: &channels, variance: &variance, least: LEAST };
    let tiles = size.tiles(SIDE);
    let of_tile = |area: &Area| of_tile(&guide, values, features, size, area, bandwidths, cancel);
    let found: Vec<Vec<Vec<Rgb>>> = parallel::map(tiles.len(), |i| of_tile(&tiles[i]));
    let mut all = vec![vec![Rgb::ZERO; size.pixels()]; bandwidths.len()];
    for (area, found) in tiles.iter().zip(found) {
        for (picture, found) in all.iter_mut().zip(found) {
            let places = area.rows.clone().flat_map(|y| area.columns.clone().map(move |x| y * size.width + x));
            places.zip(found).for_each(|(place, value)| picture[place] = value);
        }
    }
    all
}

fn of_tile(
    guide: &Guide,
    values: &[Rgb],
    features: &[Vec<f64>],
    size: Size,
    area: &Area,
    bandwidths: &[f64],
    cancel: &Cancel,
) -> Vec<Vec<Rgb>> {
    let wide = area.wider(REACH as usize, size);
    let products = products(values, features, size, &wide);
    let (columns, pixels) = (area.columns.len(), area.pixels());
    let mut sums = vec![vec![0.0; MOMENTS * pixels]; bandwidths.len()];
    let (mut comparing, mut distances) = (Comparing::default(), vec![0.0; pixels]);
    let mut weights = vec![0.0; columns];
    for offset in (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| [dx, dy])) {
        if cancel.is_raised() {
            break;
        }
        comparing.distances(guide, size, area, offset, PATCH, &mut distances);
        let part = area.with(offset, size);
        for (bandwidth, sums) in bandwidths.iter().zip(&mut sums) {
            let fall = 1.0 / (bandwidth * bandwidth);
            for y in part.rows.clone() {
                let row = (y - area.rows.start) * columns;
                let mut any = false;
                for (weight, distance) in weights.iter_mut().zip(&distances[row..]) {
                    let away = distance.max(0.0) * fall;
                    *weight = if away < -FAINTEST.ln() { (-away).exp() } else { 0.0 };
                    any |= *weight > 0.0;
                }
                if !any {
                    continue;
                }
                let first = part.columns.start - area.columns.start;
                let weights = &weights[first..first + part.columns.len()];
                let there = [part.columns.start as isize + offset[0], y as isize + offset[1]];
                let there =
                    (there[1] as usize - wide.rows.start) * wide.columns.len() + there[0] as usize - wide.columns.start;
                for (sums, products) in sums.chunks_mut(pixels).zip(products.chunks(wide.pixels())) {
                    let sums = &mut sums[row + first..][..weights.len()];
                    let products = &products[there..there + weights.len()];
                    for ((sum, weight), product) in sums.iter_mut().zip(weights).zip(products) {
                        *sum += weight * product;
                    }
                }
            }
        }
    }
    let places = || area.rows.clone().flat_map(|y| area.columns.clone().map(move |x| y * size.width + x));
    let fitted = |sums: &Vec<f64>| {
        let of = |(i, place): (usize, usize)| {
            let mut moments = [0.0; MOMENTS];
            moments.iter_mut().zip(sums.chunks(pixels)).for_each(|(moment, sums)| *moment = sums[i]);
            at(&moments, &std::array::from_fn(|feature| features[feature][place]))
        };
        places().enumerate().map(of).collect()
    };
    sums.iter().map(fitted).collect()
}

/// Products of regressors and channels in an area, a plane for each.
fn products(values: &[Rgb], features: &[Vec<f64>], size: Size, area: &Area) -> Vec<f64> {
    let mut all = vec![0.0; MOMENTS * area.pixels()];
    let places = area.rows.clone().flat_map(|y| area.columns.clone().map(move |x| y * size.width + x));
    for (i, place) in places.enumerate() {
        let mut planes = all.iter_mut().skip(i).step_by(area.pixels());
        let term = |t: usize| if t == 0 { 1.0 } else { features[t - 1][place] };
        for product in (0..TERMS).flat_map(|a| (a..TERMS).map(move |b| term(a) * term(b))) {
            planes.next().into_iter().for_each(|plane| *plane = product);
        }
        for product in (0..TERMS).flat_map(|a| (0..3).map(move |channel| term(a) * values[place][channel])) {
            planes.next().into_iter().for_each(|plane| *plane = product);
        }
    }
    all
}

/// Index of the product of two regressors.
const fn index(a: usize, b: usize) -> usize {
    let (a, b) = if a < b { (a, b) } else { (b, a) };
    a * TERMS - a * (a + 1) / 2 + b
}

/// Value of the least-squares fit with these moments at some features.
fn at(moments: &[f64; MOMENTS], features: &[f64; FEATURES]) -> Rgb {
    let (products, values) = moments.split_at(PRODUCTS);
    let value = |term: usize| Rgb::new(values[3 * term], values[3 * term + 1], values[3 * term + 2]);
    let all = products[0];
    if all <= 0.0 {
        return Rgb::ZERO;
    }
    // Relative to the features here, the fit's value is its constant.
    let first: [f64; FEATURES] = std::array::from_fn(|i| products[index(0, i + 1)]);
    let centred: [f64; FEATURES] = std::array::from_fn(|i| first[i] - features[i] * all);
    let sums: [Rgb; FEATURES] = std::array::from_fn(|i| value(i + 1) - value(0) * features[i]);
    let mut matrix = [[0.0; FEATURES]; FEATURES];
    for i in 0..FEATURES {
        for j in 0..=i {
            matrix[i][j] = products[index(i + 1, j + 1)] - features[i] * first[j] - first[i] * features[j]
                + all * features[i] * features[j];
        }
        matrix[i][i] = matrix[i][i].max(0.0) + RIDGE * all;
    }
    let Some(root) = root(matrix) else { return value(0) / all };
    // By elimination of the slopes.
    let one = forward(&root, centred);
    let explained: f64 = one.iter().map(|x| x * x).sum();
    let rest = all - explained;
    if rest < 1e-6 * all {
        return value(0) / all;
    }
    let of_channel = |channel: usize| {
        let other = forward(&root, sums.map(|sum| sum[channel]));
        let along: f64 = one.iter().zip(other).map(|(a, b)| a * b).sum();
        (value(0)[channel] - along) / rest
    };
    Rgb::new(of_channel(0), of_channel(1), of_channel(2))
}

type NormalMatrix = [[f64; FEATURES]; FEATURES];

/// Cholesky decomposition: the lower triangular factor of a matrix, whose lower half is read; `None` if it is not
/// positive definite.
fn root(mut matrix: NormalMatrix) -> Option<NormalMatrix> {
    for i in 0..FEATURES {
        for j in 0..=i {
            let inner: f64 = (0..j).map(|k| matrix[i][k] * matrix[j][k]).sum();
            let left = matrix[i][j] - inner;
            if i == j {
                if left <= 0.0 {
                    return None;
                }
                matrix[i][i] = left.sqrt();
            } else {
                matrix[i][j] = left / matrix[j][j];
            }
        }
    }
    Some(matrix)
}

/// Forward substitution with a lower triangular matrix.
fn forward(root: &NormalMatrix, mut right: [f64; FEATURES]) -> [f64; FEATURES] {
    for i in 0..FEATURES {
        let inner: f64 = (0..i).map(|k| root[i][k] * right[k]).sum();
        right[i] = (right[i] - inner) / root[i][i];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    fn draws(seed: u64, count: usize) -> Vec<f64> {
        (0..count).map(|i| Sampler::new(seed, i as u32, 0).one(0)).collect()
    }

    #[test]
    fn what_is_linear_in_features_is_fitted() {
        let size = Size { width: 20, height: 20 };
        let features: Vec<Vec<f64>> = (0..FEATURES).map(|i| draws(i as u64 + 1, size.pixels())).collect();
        let values: Vec<Rgb> = (0..size.pixels())
            .map(|i| Rgb::new(1.0 + features[0][i] - 0.5 * features[6][i], 2.0, 0.3 + features[3][i]))
            .collect();
        let even = vec![Rgb::ONE; size.pixels()];
        let noise = vec![1.0; size.pixels()];
        let found = filtered(&even, &noise, &values, &features, size, &[1.0, 0.5], &Cancel::default());
        for picture in found {
            for (found, value) in picture.iter().zip(&values) {
                assert!((*found - *value).abs().max() < 0.01, "{found:?} {value:?}");
            }
        }
    }

    #[test]
    fn what_differs_by_more_than_its_noise_stays() {
        let size = Size { width: 20, height: 20 };
        let features = vec![vec![0.5; size.pixels()]; FEATURES];
        let draws = draws(3, size.pixels());
        let truth = |i: usize| if i % 20 < 10 { 1.0 } else { 3.0 };
        let values: Vec<Rgb> = draws.iter().enumerate().map(|(i, d)| Rgb::splat(truth(i) + 0.2 * (d - 0.5))).collect();
        // Variance of a mean of two, in three equal channels.
        let variance = vec![0.04 / 12.0 * 3.0 / 2.0; size.pixels()];
        let found = filtered(&values, &variance, &values, &features, size, &[1.0], &Cancel::default());
        let off = |of: &dyn Fn(usize) -> f64| {
            (0..size.pixels()).map(|i| (of(i) - truth(i)).powi(2)).sum::<f64>() / size.pixels() as f64
        };
        let (before, after) = (off(&|i| values[i][0]), off(&|i| found[0][i][0]));
        assert!(after < 0.2 * before, "{before} {after}");
    }
}
