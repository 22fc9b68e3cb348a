//! Tests of polygon pairs against Howell's closed forms and symmetries.

use super::{Facet, Quadrature, pair};
use raywright_base::math::DVec3;
use raywright_base::simd::Level;

/// A polygon as a triangle fan.
fn polygon<const N: usize>(corners: [[f64; 3]; N]) -> Vec<Facet> {
    let at = corners.map(DVec3::from);
    (1..N - 1).map(|i| Facet::new([at[0], at[i], at[i + 1]])).collect()
}

/// The view factor from one polygon to another.
fn factor(from: &[Facet], to: &[Facet]) -> f64 {
    let mut quadrature = Quadrature::new(Level::current().unwrap());
    let area: f64 = from.iter().map(|facet| facet.area).sum();
    let mut exchanged = 0.0;
    for one in from {
        for other in to {
            exchanged += pair(&mut quadrature, one, other);
        }
    }
    exchanged / area
}

/// A rectangle of the given width and depth at z = 0 facing up, and one like it at a height facing down.
fn opposed(width: f64, depth: f64, height: f64) -> [Vec<Facet>; 2] {
    let (w, d, h) = (width, depth, height);
    [
        polygon([[0.0, 0.0, 0.0], [w, 0.0, 0.0], [w, d, 0.0], [0.0, d, 0.0]]),
        polygon([[0.0, 0.0, h], [0.0, d, h], [w, d, h], [w, 0.0, h]]),
    ]
}

/// Rectangles with a common edge along y that enclose an angle.
fn wedge(edge: f64, width: f64, height: f64, degrees: f64) -> [Vec<Facet>; 2] {
    let (sin, cos) = if degrees == 90.0 { (1.0, 0.0) } else { degrees.to_radians().sin_cos() };
    let (x, z) = (height * cos, height * sin);
    [
        polygon([[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, edge, 0.0], [0.0, edge, 0.0]]),
        polygon([[0.0, 0.0, 0.0], [0.0, edge, 0.0], [x, edge, z], [x, 0.0, z]]),
    ]
}

/// Assert a view factor in both directions, at very different scales, and rotated.
fn assert_factor(what: &str, [from, to]: [Vec<Facet>; 2], truth: f64, tolerance: f64) {
    let areas = [&from, &to].map(|of| of.iter().map(|facet| facet.area).sum::<f64>());
    let there = factor(&from, &to);
    assert!((there / truth - 1.0).abs() <= tolerance, "{what}: {there} for {truth}, off {:e}", there / truth - 1.0);
    let back = factor(&to, &from) * areas[1] / areas[0];
    assert!((back / truth - 1.0).abs() <= tolerance, "{what}, back: {back} for {truth}, off {:e}", back / truth - 1.0);
    for scale in [1e-8, 3e-3, 1e6] {
        let turn = |c: DVec3| DVec3::new(0.6 * c.x - 0.8 * c.y, 0.8 * c.x + 0.6 * c.y, c.z) * scale;
        let moved = |of: &[Facet]| of.iter().map(|facet| Facet::new(facet.corners.map(turn))).collect::<Vec<_>>();
        let found = factor(&moved(&from), &moved(&to));
        let off = found / truth - 1.0;
        // The corners are rounded.
        assert!(off.abs() <= tolerance.max(1e-11), "{what} at {scale}: {found} for {truth}, off {off:e}");
    }
}

#[test]
fn opposed_rectangles() {
    // C-11 of Howell, "A Catalog of Radiation Heat Transfer Configuration Factors".
    for (width, depth, height, truth) in [
        (1.0, 1.0, 1.0, 0.199_824_895_698_387_46),
        (1.0, 1.0, 0.1, 0.826_994_522_397_256_5),
        (1.0, 1.0, 0.5, 0.415_253_283_577_146_9),
        (1.0, 1.0, 2.0, 0.068_589_588_818_552_6),
        (1.0, 1.0, 10.0, 0.003_162_056_838_754_467_7),
        (2.0, 1.0, 1.0, 0.285_875_384_850_714_7),
        (3.0, 2.0, 0.75, 0.566_666_591_549_48),
        (1.0, 10.0, 1.0, 0.386_382_489_266_135),
        (1.0, 1.0, 1000.0, 3.183_096_739_773_8e-7),
    ] {
        // Cubature rules, where they apply, are accurate to 10⁻⁹.
        assert_factor(&format!("{width} {depth} {height}"), opposed(width, depth, height), truth, 1e-10);
    }
}

#[test]
fn rectangles_at_an_edge() {
    // C-14, and the integral over widths for other angles.
    for (edge, width, height, degrees, truth) in [
        (1.0, 1.0, 1.0, 90.0, 0.200_043_776_075_403_16),
        (1.0, 1.0, 2.0, 90.0, 0.232_852_602_795_361_9),
        (1.0, 2.0, 1.0, 90.0, 0.116_426_301_397_680_95),
        (2.0, 0.5, 3.0, 90.0, 0.376_778_149_185_793),
        (1.0, 1.0, 0.01, 90.0, 0.004_895_849_268_506_68),
        (1.0, 1.0, 1.0, 60.0, 0.370_905_321_150_051),
        (1.0, 1.0, 1.0, 120.0, 0.086_615_001_118_276_1),
    ] {
        assert_factor(&format!("{edge} {width} {height} {degrees}"), wedge(edge, width, height, degrees), truth, 1e-10);
    }
}

#[test]
fn rectangles_apart() {
    let from = polygon([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
    let to = polygon([[0.5, 1.0, 1.5], [0.5, 4.0, 1.5], [2.0, 4.0, 1.5], [2.0, 1.0, 1.5]]);
    assert_factor("parallel", [from, to], 0.163_614_339_221_222, 1e-10);
    let from = polygon([[0.5, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.5, 1.0, 0.0]]);
    let to = polygon([[0.0, 0.25, 0.1], [0.0, 3.0, 0.1], [0.0, 3.0, 1.1], [0.0, 0.25, 1.1]]);
    assert_factor("perpendicular", [from, to], 0.082_663_788_148_01, 1e-10);
}

#[test]
fn what_is_behind_a_plane_is_cut_off() {
    // The same as for the part of it in front, whose factor is known.
    let [from, _] = wedge(1.0, 1.0, 1.0, 90.0);
    let across = polygon([[0.0, 0.0, -0.7], [0.0, 1.0, -0.7], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]);
    let exchanged = factor(&across, &from) * 1.7;
    assert!((exchanged / 0.200_043_776_075_403_16 - 1.0).abs() < 1e-11, "{exchanged}");
    let both = polygon([[-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-3.0, 1.0, 0.0]]);
    let exchanged = factor(&across, &both) * 1.7;
    assert!((exchanged / 0.200_043_776_075_403_16 - 1.0).abs() < 1e-11, "{exchanged}");
}

#[test]
fn what_does_not_look_at_each_other_is_nothing() {
    let [one, other] = opposed(1.0, 1.0, 1.0);
    assert_eq!(factor(&one, &one), 0.0);
    let away = other.iter().map(|f| Facet::new([f.corners[0], f.corners[2], f.corners[1]])).collect::<Vec<_>>();
    assert_eq!(factor(&one, &away), 0.0);
    let flat = polygon([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(factor(&one, &flat), 0.0);
    assert_eq!(factor(&one, &[Facet::new([DVec3::Z; 3])]), 0.0);
}

/// The row sums of closed surfaces with inward faces.
fn assert_closed(what: &str, faces: &[Facet], tolerance: f64) {
    for one in faces {
        let sum: f64 = faces.iter().map(|other| factor(&[*one], &[*other])).sum();
        assert!((sum - 1.0).abs() < tolerance, "{what}: {:e}", sum - 1.0);
    }
}

#[test]
fn rows_of_closed_surfaces_are_one() {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
    for turn in [[0, 1, 2], [0, 2, 1]] {
        let facets: Vec<Facet> =
            faces.iter().map(|face| Facet::new(turn.map(|k: usize| DVec3::from(corners[face[k]])))).collect();
        if factor(&facets[..1], &facets[1..2]) == 0.0 {
            continue;
        }
        assert_closed("tetrahedron", &facets, 1e-12);
        for one in 0..4 {
            for other in 0..4 {
                let truth = if one == other { 0.0 } else { 1.0 / 3.0 };
                let found = factor(&facets[one..=one], &facets[other..=other]);
                assert!((found - truth).abs() < 1e-12, "{one} {other} {found}");
            }
        }
    }
    // Boxes with an aspect ratio of a thousand, and a needle.
    for size in [[1.0, 2.0, 3.0], [1.0, 1.0, 1000.0], [1.0, 0.001, 1.0], [1.0, 30.0, 0.03]] {
        assert_closed(&format!("{size:?}"), &inward_box(size).concat(), 1e-9);
    }
}

/// The sides −x, +x, −y, +y, −z, +z of a box, facing inward.
fn inward_box([a, b, c]: [f64; 3]) -> [Vec<Facet>; 6] {
    [
        polygon([[0.0, 0.0, 0.0], [0.0, b, 0.0], [0.0, b, c], [0.0, 0.0, c]]),
        polygon([[a, 0.0, 0.0], [a, 0.0, c], [a, b, c], [a, b, 0.0]]),
        polygon([[0.0, 0.0, 0.0], [0.0, 0.0, c], [a, 0.0, c], [a, 0.0, 0.0]]),
        polygon([[0.0, b, 0.0], [a, b, 0.0], [a, b, c], [0.0, b, c]]),
        polygon([[0.0, 0.0, 0.0], [a, 0.0, 0.0], [a, b, 0.0], [0.0, b, 0.0]]),
        polygon([[0.0, 0.0, c], [0.0, b, c], [a, b, c], [a, 0.0, c]]),
    ]
}

#[test]
fn a_box_is_as_the_catalogue_has_it() {
    let sides = inward_box([1.0, 2.0, 3.0]);
    let first = [0.0, 0.475_576_436_532_953, 0.159_498_350_739_525, 0.159_498_350_739_525, 0.102_713_430_993_999];
    for (side, truth) in sides.iter().zip(first) {
        let found = factor(&sides[0], side);
        assert!((found - truth).abs() < 1e-11, "{found} for {truth}");
    }
}
