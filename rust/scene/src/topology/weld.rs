//! Merging of corners that differ only by rounding.

use super::manifold;
use raywright_base::math::DVec3;
use std::collections::HashMap;

/// Merge distance for f32 corners, relative to the greatest coordinate: 8 ulps.
const SINGLE: f64 = 8.0 / (1u64 << 24) as f64;
/// Merge distance for other corners: rotating and translating parts in f64 takes some tens of roundings.
const DOUBLE: f64 = 64.0 * f64::EPSILON / 2.0;
/// Upper bound relative to the mean edge: if coordinates are so large that rounding moves corners by this much, none
/// are merged.
const OF_EDGE: f64 = 1.0 / 64.0;

/// For each point, the number of the first that equals it. Non-finite points equal none.
pub fn joined(points: &[DVec3]) -> Vec<u32> {
    let bits = (2 * points.len()).next_power_of_two().max(2).trailing_zeros();
    let mut table = vec![u32::MAX; 1 << bits];
    let mask = table.len() - 1;
    let number = |(i, &point): (usize, &DVec3)| {
        if !point.is_finite() {
            return i as u32;
        }
        let mut slot = (hash(point) >> (64 - bits)) as usize;
        loop {
            let known = table[slot];
            if known == u32::MAX {
                table[slot] = i as u32;
                return i as u32;
            }
            if points[known as usize] == point {
                return known;
            }
            slot = (slot + 1) & mask;
        }
    };
    points.iter().enumerate().map(number).collect()
}

fn hash(point: DVec3) -> u64 {
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
    // Adding 0 gives −0 the bits of 0.
    let mixed = (point + DVec3::ZERO)
        .to_array()
        .into_iter()
        .fold(0u64, |hash, x| (hash.rotate_left(26) ^ x.to_bits()).wrapping_mul(ODD));
    (mixed ^ (mixed >> 32)).wrapping_mul(ODD)
}

/// Distance between corners that differ by rounding: 2⁻²¹ of the greatest coordinate if all are float32 numbers, and
/// 2⁻⁴⁷ otherwise, but at most a 64th of the mean edge.
pub fn rounding(points: &[DVec3], faces: &[[u32; 3]]) -> f64 {
    let (mut largest, mut is_single, mut edges, mut count) = (0.0f64, true, 0.0, 0usize);
    for face in faces {
        let [a, b, c] = face.map(|v| points[v as usize]);
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            continue;
        }
        for corner in [a, b, c] {
            largest = largest.max(corner.abs().max_element());
            is_single &= corner.as_vec3().as_dvec3() == corner;
        }
        edges += a.distance(b) + b.distance(c) + c.distance(a);
        count += 3;
    }
    let of_size = largest * if is_single { SINGLE } else { DOUBLE };
    if count == 0 { 0.0 } else { of_size.min(OF_EDGE * edges / count as f64) }
}

/// For each point, the number of its representative: the first that equals it, or one within the tolerances of both.
/// There is one tolerance for all points, or one each.
///
/// Only corners on open edges are merged, in order of their numbers, with the nearest earlier representative. Two
/// corners of one face are never merged, so closed meshes stay unchanged, however thin.
pub fn welded(points: &[DVec3], faces: &[[u32; 3]], tolerances: &[f64]) -> Vec<u32> {
    let all = joined(points);
    let named: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| all[v as usize])).collect();
    if manifold::parts(&named, points.len()).is_some() { all } else { welded_among(all, points, faces, tolerances) }
}

/// [`welded`], given the equal points.
pub fn welded_among(mut all: Vec<u32>, points: &[DVec3], faces: &[[u32; 3]], tolerances: &[f64]) -> Vec<u32> {
    if !tolerances.iter().any(|&tolerance| is_some(tolerance)) {
        return all;
    }
    let named = named(points, faces, &all);
    let rim = rim(&named);
    if rim.is_empty() {
        return all;
    }
    let mut neighbours: Vec<(u32, u32)> = named
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)])
        .filter(|(corner, _)| rim.binary_search(corner).is_ok())
        .collect();
    neighbours.sort_unstable();
    neighbours.dedup();
    let of_rim: HashMap<u32, u32> = leaders(points, &rim, &neighbours, tolerances);
    for number in &mut all {
        *number = of_rim.get(number).copied().unwrap_or(*number);
    }
    all
}

/// Faces by representative corners, each once, without degenerate and non-finite ones.
fn named(points: &[DVec3], faces: &[[u32; 3]], all: &[u32]) -> Vec<[u32; 3]> {
    let mut named: Vec<[u32; 3]> = faces
        .iter()
        .map(|face| face.map(|v| all[v as usize]))
        .filter(|&[a, b, c]| a != b && b != c && c != a && [a, b, c].iter().all(|&v| points[v as usize].is_finite()))
        .map(|mut face| {
            face.sort_unstable();
            face
        })
        .collect();
    named.sort_unstable();
    named.dedup();
    named
}

/// Ends of edges with an odd number of faces, in order. The corners of each face are sorted.
fn rim(faces: &[[u32; 3]]) -> Vec<u32> {
    let mut edges: Vec<(u32, u32)> = faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (a, c)]).collect();
    edges.sort_unstable();
    let odd = edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1);
    let mut ends: Vec<u32> = odd.flat_map(|same| [same[0].0, same[0].1]).collect();
    ends.sort_unstable();
    ends.dedup();
    ends
}

fn is_some(tolerance: f64) -> bool {
    tolerance > 0.0 && tolerance.is_finite()
}

/// The representative of each of some corners.
///
/// Representatives are hashed into cells some times as large as their tolerance, in one grid per power of two. So cells
/// hold few of them, even if tolerances differ.
fn leaders(points: &[DVec3], corners: &[u32], neighbours: &[(u32, u32)], tolerances: &[f64]) -> HashMap<u32, u32> {
    // Offset, so that common coordinates such as 0 are not on cell borders.
    let place = |point: DVec3, size: i32| {
        let cell = (point / (4.0 * f64::from(size).exp2()) + 0.37).floor().to_array();
        cell.map(|x| x as i64)
    };
    let mut sizes: Vec<i32> = Vec::new();
    let mut cells: HashMap<(i32, [i64; 3]), Vec<u32>> = HashMap::new();
    let mut found: HashMap<u32, u32> = HashMap::with_capacity(corners.len());
    let tolerance_of = |corner: u32| tolerances[if tolerances.len() == 1 { 0 } else { corner as usize }];
    for &corner in corners {
        let (point, own) = (points[corner as usize], tolerance_of(corner));
        if !is_some(own) {
            found.insert(corner, corner);
            continue;
        }
        let from = neighbours.partition_point(|&(of, _)| of < corner);
        let beside = || neighbours[from..].iter().take_while(|&&(of, _)| of == corner).map(|&(_, to)| to);
        let mut best: Option<(f64, u32)> = None;
        for &size in &sizes {
            let reach = own.min(f64::from(size).exp2());
            let (low, high) = (place(point - reach, size), place(point + reach, size));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        for &leader in cells.get(&(size, [x, y, z])).into_iter().flatten() {
                            let distance = points[leader as usize].distance(point);
                            let is_near = distance <= own.min(tolerance_of(leader));
                            let is_nearer = best.is_none_or(|best| (distance, leader) < best);
                            let shares_a_face = || beside().any(|to| to == leader || found.get(&to) == Some(&leader));
                            if is_near && is_nearer && !shares_a_face() {
                                best = Some((distance, leader));
                            }
                        }
                    }
                }
            }
        }
        let leader = best.map_or(corner, |(_, leader)| leader);
        if leader == corner {
            let size = own.log2().ceil() as i32;
            if !sizes.contains(&size) {
                sizes.push(size);
            }
            cells.entry((size, place(point, size))).or_default().push(corner);
        }
        found.insert(corner, leader);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_one_within_the_lesser_of_their_tolerances() {
        // Two adjacent strips of triangles, each with its own tolerance.
        let strip = |x: f64, off: f64| (0..4).map(move |i| DVec3::new(x + off * f64::from(i), f64::from(i / 2), 0.0));
        let gap = 1e-6;
        let points: Vec<DVec3> = [(0.0, 0.0), (1.0, 0.0)]
            .into_iter()
            .flat_map(|(x, off)| strip(x, off).enumerate().map(move |(i, p)| p + DVec3::X * f64::from(i as u32 & 1)))
            .enumerate()
            .map(|(i, p)| if i >= 4 { p + DVec3::X * gap } else { p })
            .collect();
        let faces = [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]];
        let of = |coarse: f64, fine: f64| {
            let tolerances: Vec<f64> = (0..8).map(|i| if i < 4 { coarse } else { fine }).collect();
            welded(&points, &faces, &tolerances)
        };
        let (apart, joined): (Vec<u32>, Vec<u32>) = ((0..8).collect(), vec![0, 1, 2, 3, 1, 5, 3, 7]);
        for (coarse, fine, wanted) in [
            (1e-5, 1e-5, &joined),
            (1e-2, 2e-6, &joined),
            (2e-6, 1e-2, &joined),
            (1e-2, 1e-7, &apart),
            (1e-7, 1e-2, &apart),
            (1e-2, 0.0, &apart),
            (f64::NAN, 1e-2, &apart),
        ] {
            assert_eq!(&of(coarse, fine), wanted, "{coarse} {fine}");
        }
        assert_eq!(welded(&points, &faces, &[1e-5]), joined);
        assert_eq!(welded(&points, &faces, &[1e-7]), apart);
    }
}
