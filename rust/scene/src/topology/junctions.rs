//! T-junctions: corners of one face within the edge of another.

use raywright_base::math::DVec3;
use std::collections::HashMap;

/// For each edge, the corners within it to a tolerance, in order from its first end to its second.
///
/// Corners are hashed into cells of the mean edge length, and edges are followed from cell to cell.
pub fn within(points: &[DVec3], edges: &[[u32; 2]], tolerance: f64) -> Vec<Vec<u32>> {
    let ends = |edge: &[u32; 2]| edge.map(|v| points[v as usize]);
    let length = |edge: &[u32; 2]| {
        let [a, b] = ends(edge);
        a.distance(b)
    };
    let total: f64 = edges.iter().map(length).sum();
    let cell = (total / edges.len().max(1) as f64).max(8.0 * tolerance);
    if !(cell > 0.0 && cell.is_finite()) {
        return vec![Vec::new(); edges.len()];
    }
    let place = |point: DVec3| (point / cell + 0.37).floor().to_array().map(|x| x as i64);
    let mut corners: Vec<u32> = edges.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for corner in corners {
        cells.entry(place(points[corner as usize])).or_default().push(corner);
    }
    // A corner near a step of the edge is closer than this to one of the step's ends, along every axis.
    let reach = 0.5 * cell + tolerance;
    let of_edge = |edge: &[u32; 2]| {
        let ([a, b], steps) = (ends(edge), (length(edge) / cell).ceil() as usize);
        let mut met: Vec<(f64, u32)> = Vec::new();
        for step in 0..=steps {
            let at = a.lerp(b, step as f64 / steps.max(1) as f64);
            let (low, high) = (place(at - reach), place(at + reach));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        let some = cells.get(&[x, y, z]).into_iter().flatten().filter(|corner| !edge.contains(corner));
                        met.extend(some.filter_map(|&c| Some((along(points[c as usize], [a, b], tolerance)?, c))));
                    }
                }
            }
        }
        met.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        met.dedup();
        met.into_iter().map(|(_, corner)| corner).collect()
    };
    edges.iter().map(of_edge).collect()
}

/// Position of a point along a segment, from 0 to 1, if it is on the segment and not at an end.
fn along(point: DVec3, [a, b]: [DVec3; 2], tolerance: f64) -> Option<f64> {
    let (way, to) = (b - a, point - a);
    let share = to.dot(way) / way.length_squared();
    let is_within = share > 0.0 && share < 1.0 && to.distance(way * share) <= tolerance;
    (is_within && point.distance(a) > tolerance && point.distance(b) > tolerance).then_some(share)
}
