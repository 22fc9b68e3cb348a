//! Coplanar overlapping triangles.

use super::clusters::{Cluster, Clusters};
use super::facet::Facet;
use super::facets;
use raywright_base::math::DVec3;
use raywright_scene::Scene;

/// Two overlapping triangles in one plane.
#[derive(Clone, Copy, Debug)]
pub struct Overlap {
    /// The faces, lower number first.
    pub faces: [u32; 2],
    /// The area of the overlap.
    pub area: f64,
    /// Its centroid.
    pub middle: DVec3,
    /// True if both have the same orientation.
    pub is_same: bool,
}

/// Relative effect of rounding on a plane, for f32 coordinates and for others.
pub const SINGLE: f64 = 1.0 / (1u64 << 22) as f64;
const DOUBLE: f64 = 1.0 / (1u64 << 48) as f64;

/// Overlaps below this fraction of the smaller triangle are attributed to rounding.
pub const LEAST: f64 = 1e-4;

/// All pairs of coplanar overlapping triangles, ordered by number.
pub fn coincident(scene: &Scene) -> Vec<Overlap> {
    let facets = facets(scene);
    let sending = (0..facets.len() as u32).filter(|&i| facets[i as usize].area > 0.0).collect();
    let tree = Clusters::new(&facets, sending);
    let mut found = Vec::new();
    if let Some(root) = tree.nodes.first() {
        visit(&facets, &tree, root, root, &mut found);
    }
    found.sort_unstable_by_key(|overlap: &Overlap| overlap.faces);
    found
}

fn visit(facets: &[Facet], tree: &Clusters, one: &Cluster, other: &Cluster, found: &mut Vec<Overlap>) {
    let room = SINGLE * one.low.abs().max(one.high.abs()).max_element();
    let is_apart = |k: usize| one.low[k] > other.high[k] + room || other.low[k] > one.high[k] + room;
    if (0..3).any(is_apart) {
        return;
    }
    let is_same = one.first == other.first && one.count == other.count;
    if one.is_leaf() && other.is_leaf() {
        for (k, &i) in tree.faces(one).iter().enumerate() {
            for &j in tree.faces(other).iter().skip(if is_same { k + 1 } else { 0 }) {
                let faces = [i.min(j), i.max(j)];
                let [a, b] = faces.map(|face| &facets[face as usize]);
                let shared = overlap(a, b);
                if let Some((area, middle)) = shared.filter(|(area, _)| *area > LEAST * a.area.min(b.area)) {
                    found.push(Overlap { faces, area, middle, is_same: a.normal.dot(b.normal) > 0.0 });
                }
            }
        }
    } else if is_same {
        let [first, second] = tree.parts(one);
        for (one, other) in [(first, first), (first, second), (second, second)] {
            visit(facets, tree, one, other, found);
        }
    } else if other.is_leaf() || (!one.is_leaf() && one.count >= other.count) {
        tree.parts(one).iter().for_each(|part| visit(facets, tree, part, other, found));
    } else {
        tree.parts(other).iter().for_each(|part| visit(facets, tree, one, part, found));
    }
}

/// The area and centroid of the overlap of two coplanar triangles; `None` if they are not coplanar or do not overlap.
pub fn overlap(one: &Facet, other: &Facet) -> Option<(f64, DVec3)> {
    overlap_within(one, other, rounding(one).min(rounding(other)))
}

/// The same with a given tolerance for the distance of the planes.
pub fn overlap_within(one: &Facet, other: &Facet, room: f64) -> Option<(f64, DVec3)> {
    // A quick test of the normals, with a margin since those of slender triangles are inaccurate.
    if one.normal.dot(other.normal).abs() < 0.99 || one.centre.distance(other.centre) >= one.radius + other.radius {
        return None;
    }
    let (larger, smaller) = if one.area >= other.area { (one, other) } else { (other, one) };
    let is_flat = smaller.corners.iter().all(|&corner| larger.normal.dot(corner - larger.centre).abs() <= room);
    if !is_flat {
        return None;
    }
    let mut polygon = smaller.corners.to_vec();
    for i in 0..3 {
        let (from, to) = (larger.corners[i], larger.corners[(i + 1) % 3]);
        let inwards = larger.normal.cross(to - from);
        let height = |point: DVec3| inwards.dot(point - from);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for k in 0..polygon.len() {
            let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
            let (up, next) = (height(a), height(b));
            if up >= 0.0 {
                kept.push(a);
            }
            if (up > 0.0 && next < 0.0) || (up < 0.0 && next > 0.0) {
                kept.push(a + (b - a) * (up / (up - next)));
            }
        }
        polygon = kept;
    }
    let first = *polygon.first()?;
    let twice: DVec3 = polygon.windows(2).map(|edge| (edge[0] - first).cross(edge[1] - first)).sum();
    let middle = first + polygon.iter().map(|&point| point - first).sum::<DVec3>() / polygon.len() as f64;
    Some((0.5 * twice.length(), middle))
}

/// How far rounding of the corners may move a triangle's plane.
pub fn rounding(facet: &Facet) -> f64 {
    let coordinates = facet.corners.map(|corner| corner.to_array());
    let is_single = coordinates.as_flattened().iter().all(|&x| f64::from(x as f32) == x);
    let most = coordinates.as_flattened().iter().fold(0.0f64, |most, x| most.max(x.abs()));
    most * if is_single { SINGLE } else { DOUBLE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_of_one_plane_share_what_they_share() {
        let at = |corners: [[f64; 3]; 3]| Facet::new(corners.map(DVec3::from));
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let area = |one: &Facet, other: &Facet| overlap(one, other).map_or(0.0, |shared| shared.0);
        let half = at([a, b, c]);
        for (other, truth) in [
            (at([a, b, c]), 0.5),
            (at([c, a, b]), 0.5),
            (at([c, b, a]), 0.5),
            (at([a, b, d]), 0.25),
            (at([a, c, d]), 0.0),
            (at([[0.5, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 9.0, 0.0]]), 17.0 / 52.0),
            (at([[0.0, 0.0, 0.1], [1.0, 0.0, 0.1], [1.0, 1.0, 0.1]]), 0.0),
            (at([[7.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 1.0, 0.0]]), 0.0),
        ] {
            for found in [area(&half, &other), area(&other, &half)] {
                assert!((found - truth).abs() < 1e-15, "{found} for {truth}");
            }
        }
        // Tolerances follow the rounding of f64 or f32 coordinates.
        let turned = |facet: &Facet, by: f64| Facet::new(facet.corners.map(|p| DVec3::new(p.x, p.y, p.x / 3.0 + by)));
        assert!(overlap(&turned(&half, 0.0), &turned(&half, 1e-16)).is_some());
        assert!(overlap(&turned(&half, 0.0), &turned(&half, 1e-9)).is_none());
    }
}
