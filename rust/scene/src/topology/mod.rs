//! Classification of faces into closed bodies and defects.

mod edges;
mod enclosed_area;
mod junctions;
mod manifold;
mod outlines;
mod patches;
mod section;
mod weld;

pub use enclosed_area::Rule;
pub use section::{Cut, Cutter, Section};
pub use weld::{joined, rounding, welded};

use edges::EdgeAdjacency;
use raywright_base::math::DVec3;
use std::collections::HashMap;
use weld::welded_among;

/// Marks a face without body.
pub const NONE: u32 = u32::MAX;

/// A connected set of faces in which every edge has an even number of faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Enclosed volume; negative if normals point inwards. Not meaningful if each face occurs in both orientations, or
    /// the body is not oriented.
    pub volume: f64,
    /// True if every edge is traversed equally often in both directions, so that winding numbers are integers.
    pub is_oriented: bool,
}

/// Classification of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceKind {
    /// A face of a body, by its number.
    Closed(u32),
    /// A face on an open boundary.
    Open,
    /// A wall between parts of a body's interior.
    Inner,
    /// It repeats the corners of another face.
    Duplicate,
    /// Two of its corners coincide, or one is not finite.
    Degenerate,
}

/// The classified faces of a mesh.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// Representative of each corner after merging.
    pub corners: Vec<u32>,
    /// Classification of each face.
    pub faces: Vec<FaceKind>,
    /// For each face that is neither duplicate nor degenerate, the number of faces with its corners and orientation
    /// minus those with the opposite one.
    pub votes: Vec<i32>,
    /// The closed bodies.
    pub bodies: Vec<Body>,
    /// Edges with an odd number of faces, by their corners.
    pub cracks: Vec<[u32; 2]>,
    /// T-junctions: corners within edges of other faces.
    pub junctions: Vec<u32>,
    /// Number of edges whose two faces traverse them in the same direction: one of the faces is flipped.
    pub turned: usize,
    /// Distance within which corners were merged.
    pub tolerance: f64,
    /// True if bodies close to the last bit: by equal corners, without T-junctions.
    pub is_exact: bool,
}

impl Topology {
    /// Classifies faces after merging corners within a tolerance; the default is [`rounding`].
    pub fn new(points: &[DVec3], faces: &[[u32; 3]], tolerance: Option<f64>) -> Self {
        let tolerance = tolerance.unwrap_or_else(|| rounding(points, faces));
        let equal = joined(points);
        let named: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| equal[v as usize])).collect();
        let is_finite = || faces.iter().flatten().all(|&v| points[v as usize].is_finite());
        let parts = if is_finite() { manifold::parts(&named, points.len()) } else { None };
        match parts {
            Some(parts) => Self::of_manifold(points, equal, &named, &parts, tolerance),
            None => Self::of_any(points, welded_among(equal, points, faces, &[tolerance]), faces, tolerance),
        }
    }

    /// Classification if all faces belong to bodies.
    fn of_manifold(points: &[DVec3], corners: Vec<u32>, faces: &[[u32; 3]], parts: &[u32], tolerance: f64) -> Self {
        let (mut kinds, votes) = (vec![FaceKind::Open; faces.len()], vec![1; faces.len()]);
        let kept: Vec<u32> = (0..faces.len() as u32).collect();
        let bodies = bodies(points, faces, &kept, |part| Some((parts[part], true)), &votes, &mut kinds);
        Self { corners, faces: kinds, votes, bodies, tolerance, is_exact: true, ..Self::default() }
    }

    fn of_any(points: &[DVec3], corners: Vec<u32>, faces: &[[u32; 3]], tolerance: f64) -> Self {
        let named: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| corners[v as usize])).collect();
        let (mut kinds, copies, votes) = sorted_out(points, &named);
        let kept: Vec<u32> = (0..named.len() as u32).filter(|&f| kinds[f as usize] == FaceKind::Open).collect();
        let mut edges = EdgeAdjacency::new(kept.iter().map(|&f| named[f as usize]), &HashMap::new());
        let open: Vec<[u32; 2]> = edges.odd().map(|edge| edges.ends[edge as usize]).collect();
        let within = junctions::within(points, &open, tolerance);
        let mut junctions: Vec<u32> = within.iter().flatten().copied().collect();
        junctions.sort_unstable();
        junctions.dedup();
        if !junctions.is_empty() {
            let chains = open.into_iter().zip(within).filter(|(_, corners)| !corners.is_empty()).collect();
            edges = EdgeAdjacency::new(kept.iter().map(|&f| named[f as usize]), &chains);
        }
        let is_copied: Vec<bool> = kept.iter().map(|&f| copies[f as usize].is_multiple_of(2)).collect();
        for face in patches::doubled(&edges, &is_copied) {
            edges.remove(face);
            kinds[kept[face as usize] as usize] = FaceKind::Duplicate;
        }
        let cracks = edges.odd().map(|edge| edges.ends[edge as usize]).collect();
        let turned = (0..edges.ends.len() as u32).filter(|&edge| edges.is_turned(edge)).count();
        edges.peel();
        let area = |face: u32| {
            let [a, b, c] = named[kept[face as usize] as usize].map(|v| points[v as usize]);
            (b - a).cross(c - a).length()
        };
        for face in patches::partitions(&edges, area) {
            edges.remove(face);
            kinds[kept[face as usize] as usize] = FaceKind::Inner;
        }
        let (parts, whole) = closed_parts(&edges);
        let part = |i: usize| {
            let part = parts[i];
            if edges.is_left(i as u32) { Some((part, whole[part as usize]?)) } else { None }
        };
        let bodies = bodies(points, &named, &kept, part, &votes, &mut kinds);
        let is_in_place = |&v: &u32| points[corners[v as usize] as usize] == points[v as usize];
        let closed = || faces.iter().zip(&kinds).filter(|(_, kind)| matches!(kind, FaceKind::Closed(_)));
        let is_exact = junctions.is_empty() && closed().all(|(face, _)| face.iter().all(is_in_place));
        Self { corners, faces: kinds, votes, bodies, cracks, junctions, turned, tolerance, is_exact }
    }
}

/// Classifies faces by their corners alone; candidates for bodies stay [`FaceKind::Open`]. Also returns, for each
/// candidate, the number of faces with its corners, and that number with opposite orientations subtracted.
fn sorted_out(points: &[DVec3], faces: &[[u32; 3]]) -> (Vec<FaceKind>, Vec<u32>, Vec<i32>) {
    let mut kinds = vec![FaceKind::Open; faces.len()];
    let mut order = Vec::with_capacity(faces.len());
    for (f, &[a, b, c]) in faces.iter().enumerate() {
        let is_finite = [a, b, c].iter().all(|&v| points[v as usize].is_finite());
        if a == b || b == c || c == a || !is_finite {
            kinds[f] = FaceKind::Degenerate;
            continue;
        }
        let mut key = [a, b, c];
        key.sort_unstable();
        order.push((key, f as u32));
    }
    order.sort_unstable();
    let (mut copies, mut votes) = (vec![0; faces.len()], vec![0; faces.len()]);
    // Parity of the permutation that sorts the corners.
    let turn = |&(_, f): &([u32; 3], u32)| {
        let [a, b, c] = faces[f as usize];
        if u8::from(a < b) + u8::from(b < c) + u8::from(c < a) == 2 { 1 } else { -1 }
    };
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        let first = same[0].1 as usize;
        copies[first] = same.len() as u32;
        votes[first] = turn(&same[0]) * same.iter().map(turn).sum::<i32>();
        for (_, f) in &same[1..] {
            kinds[*f as usize] = FaceKind::Duplicate;
        }
    }
    (kinds, copies, votes)
}

/// Connected components: for each face, the first face of its component. For that face also returns whether the
/// component is oriented, or `None` if it is not closed.
fn closed_parts(edges: &EdgeAdjacency) -> (Vec<u32>, Vec<Option<bool>>) {
    let parts = edges.parts();
    let mut whole = vec![Some(true); parts.len()];
    for edge in 0..edges.ends.len() as u32 {
        let Some(face) = edges.faces_at(edge).next() else { continue };
        let whole = &mut whole[parts[face as usize] as usize];
        let is_even = edges.count(edge).is_multiple_of(2);
        *whole = whole.filter(|_| is_even).map(|is_oriented| is_oriented && edges.balance(edge) == 0);
    }
    (parts, whole)
}

/// Builds the bodies of the faces kept, and sets these faces' kinds. For each face, `part` returns the first face of
/// its component and whether the component is oriented, or `None` if it belongs to no body.
fn bodies(
    points: &[DVec3],
    named: &[[u32; 3]],
    kept: &[u32],
    part: impl Fn(usize) -> Option<(u32, bool)>,
    votes: &[i32],
    kinds: &mut [FaceKind],
) -> Vec<Body> {
    let (mut numbers, mut bodies) = (vec![NONE; kept.len()], Vec::new());
    let (mut origins, mut are_two_sided): (Vec<DVec3>, Vec<bool>) = (Vec::new(), Vec::new());
    for (i, &face) in kept.iter().enumerate() {
        let Some((part, is_oriented)) = part(i) else { continue };
        let [a, b, c] = named[face as usize].map(|v| points[v as usize]);
        if numbers[part as usize] == NONE {
            numbers[part as usize] = bodies.len() as u32;
            bodies.push(Body { volume: 0.0, is_oriented });
            origins.push(a);
            are_two_sided.push(true);
        }
        let number = numbers[part as usize];
        let origin = origins[number as usize];
        bodies[number as usize].volume += (a - origin).dot((b - origin).cross(c - origin)) / 6.0;
        are_two_sided[number as usize] &= votes[face as usize] == 0;
        kinds[face as usize] = FaceKind::Closed(number);
    }
    for (body, _) in bodies.iter_mut().zip(are_two_sided).filter(|(_, are)| *are) {
        body.volume = body.volume.abs();
    }
    bodies
}

#[cfg(test)]
mod tests {
    use super::*;
    use FaceKind::{Closed, Degenerate, Duplicate, Open};

    const BOX: [[u32; 3]; 12] = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];

    fn corners(from: DVec3) -> Vec<DVec3> {
        (0..8).map(|i| from + DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect()
    }

    fn closed(topology: &Topology) -> usize {
        topology.faces.iter().filter(|kind| matches!(kind, Closed(_))).count()
    }

    #[test]
    fn a_box_is_a_body_whichever_way_it_is_told() {
        let points = corners(DVec3::ZERO);
        let turned: Vec<_> = BOX.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let both = [&BOX[..], &turned].concat();
        let mut one_turned = BOX;
        one_turned[3].swap(0, 1);
        for (faces, volume) in [
            (BOX.to_vec(), 1.0),
            (turned, -1.0),
            (both.clone(), 1.0),
            (both.iter().rev().copied().collect(), 1.0),
            ([&BOX[..], &BOX].concat(), 1.0),
            ([&both[..], &both].concat(), 1.0),
            ([&BOX[..], &BOX[..5]].concat(), 1.0),
        ] {
            let found = Topology::new(&points, &faces, None);
            let [body] = found.bodies[..] else { panic!("{:?}", found.bodies) };
            assert!((body.volume - volume).abs() < 1e-15 && body.is_oriented);
            assert_eq!((closed(&found), found.cracks.len(), found.turned), (12, 0, 0));
            assert!(found.faces[12..].iter().all(|&kind| kind == Duplicate));
        }
        let found = Topology::new(&points, &one_turned, None);
        assert_eq!((found.bodies.len(), found.bodies[0].is_oriented, found.turned), (1, false, 3));
    }

    #[test]
    fn corners_that_rounding_moved_are_one_and_no_others() {
        // Every face with its own corners, displaced by roundings.
        let moved = |by: f64, seed: u32| -> Vec<DVec3> {
            let mut random = seed;
            let all = corners(DVec3::ZERO);
            let mut draw = || {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(random >> 16) / 65536.0 - 0.5
            };
            BOX.iter().flatten().map(|&v| all[v as usize] + by * DVec3::new(draw(), draw(), draw())).collect()
        };
        let faces: Vec<[u32; 3]> = (0..12).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        for (by, is_closed) in [(0.0, true), (1e-17, true), (4e-15, true), (1e-12, false)] {
            let found = Topology::new(&moved(by, 7), &faces, None);
            assert_eq!(found.bodies.len(), usize::from(is_closed), "{by}");
            assert_eq!(Topology::new(&moved(by, 7), &faces, Some(1e-11)).bodies.len(), 1);
            assert_eq!(Topology::new(&moved(by, 7), &faces, Some(0.0)).bodies.len(), usize::from(by == 0.0));
        }
        let single: Vec<DVec3> = moved(2e-7, 3).iter().map(|v| v.as_vec3().as_dvec3()).collect();
        assert_eq!(Topology::new(&single, &faces, None).bodies.len(), 1);
        // A closed film stays closed, although it is thinner than the tolerance.
        let thin: Vec<DVec3> = corners(DVec3::ZERO).into_iter().map(|v| v * DVec3::new(1.0, 1.0, 1e-9)).collect();
        let found = Topology::new(&thin, &BOX, Some(1e-3));
        assert_eq!((closed(&found), found.corners.len()), (12, 8));
    }

    #[test]
    fn what_leads_nowhere_is_open() {
        let mut points = corners(DVec3::ZERO);
        assert_eq!(closed(&Topology::new(&points, &BOX[..11], None)), 0);
        // A sheet beside the box that shares an edge with it, and a degenerate face.
        points.extend([DVec3::new(0.0, -5.0, 0.0), DVec3::new(1.0, -5.0, 0.0)]);
        let faces = [&BOX[..], &[[0, 1, 8], [1, 9, 8], [3, 3, 4]]].concat();
        let found = Topology::new(&points, &faces, None);
        assert_eq!(closed(&found), 12);
        assert_eq!(found.faces[12..], [Open, Open, Degenerate]);
        // The edge with three faces, and the three boundary edges of the sheet.
        assert_eq!(found.cracks.len(), 4);
    }

    #[test]
    fn boxes_side_by_side_are_closed_with_or_without_the_wall_between() {
        let points = [corners(DVec3::ZERO), corners(DVec3::X)].concat();
        let other: Vec<[u32; 3]> = BOX.iter().map(|face| face.map(|v| v + 8)).collect();
        let found = Topology::new(&points, &[&BOX[..], &other].concat(), None);
        // The shared wall is not part of the surface.
        assert_eq!((closed(&found), found.cracks.len()), (20, 0));
        assert!((found.bodies.iter().map(|body| body.volume).sum::<f64>() - 2.0).abs() < 1e-14);
    }

    #[test]
    fn walls_within_a_body_are_no_part_of_its_surface() {
        // A box of two by two chambers, with single walls between them.
        let mut points = Vec::new();
        for z in 0..2 {
            points.extend((0..9).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3), f64::from(z))));
        }
        let quad = |a: u32, b: u32, c: u32, d: u32| [[a, b, c], [a, c, d]];
        let mut faces = Vec::new();
        for corner in [0, 1, 3, 4] {
            faces.extend(quad(corner, corner + 3, corner + 4, corner + 1));
            faces.extend(quad(corner + 9, corner + 10, corner + 13, corner + 12));
        }
        let around = [(0, 1), (1, 2), (2, 5), (5, 8), (8, 7), (7, 6), (6, 3), (3, 0)];
        around.iter().for_each(|&(a, b)| faces.extend(quad(a, b, b + 9, a + 9)));
        let outside = faces.len();
        [(1, 4), (4, 7), (3, 4), (4, 5)].iter().for_each(|&(a, b)| faces.extend(quad(a, b, b + 9, a + 9)));
        let found = Topology::new(&points, &faces, None);
        assert!(found.faces[..outside].iter().all(|&kind| kind == Closed(0)), "{:?}", found.faces);
        assert!(found.faces[outside..].iter().all(|&kind| kind == FaceKind::Inner), "{:?}", found.faces);
        assert!((found.bodies[0].volume - 4.0).abs() < 1e-14 && found.bodies[0].is_oriented);
    }

    #[test]
    fn corners_within_edges_close_them_to_rounding() {
        // The face below splits the edge from 0 to 1 at a third; the adjacent face does not.
        let mut points = corners(DVec3::new(0.1, 0.2, 0.3));
        points.push(points[0].lerp(points[1], 1.0 / 3.0));
        let faces = [&BOX[1..], &[[0, 2, 8], [8, 2, 1]]].concat();
        let found = Topology::new(&points, &faces, None);
        assert_eq!((closed(&found), found.junctions.as_slice(), found.cracks.len()), (13, &[8][..], 0));
        points[8].y += 1e-3;
        let found = Topology::new(&points, &faces, None);
        assert_eq!((closed(&found), found.junctions.len(), found.cracks.len()), (0, 0, 3));
    }

    #[test]
    fn closed_meshes_are_told_in_linear_time_what_any_mesh_is_told() {
        let mut points =
            [corners(DVec3::ZERO), corners(DVec3::splat(0.5)), corners(DVec3::new(0.2, 3.0, 0.1))].concat();
        let shifted = |by: u32| BOX.map(|face| face.map(|v| v + by));
        let turned = shifted(8).map(|[a, b, c]| [a, c, b]);
        let faces = [BOX, turned, shifted(16)].concat();
        for by in [1.0, 0.1] {
            points.iter_mut().for_each(|point| *point *= by);
            let (quick, any) = (
                Topology::new(&points, &faces, None),
                Topology::of_any(&points, joined(&points), &faces, rounding(&points, &faces)),
            );
            assert_eq!((&quick.faces, &quick.bodies, &quick.votes), (&any.faces, &any.bodies, &any.votes));
            assert_eq!((quick.bodies.len(), quick.is_exact, any.is_exact), (3, true, true));
            assert!(manifold::parts(&faces, 24).is_some());
        }
        // A missing, duplicated or flipped face; a repeated corner; a sheet of two opposite faces.
        let mut one_turned = BOX.to_vec();
        one_turned[0].swap(0, 1);
        let both = |extra: [u32; 3]| [&BOX[..], &[extra]].concat();
        let sheet = [&shifted(8)[..], &[[0, 1, 2], [0, 2, 1]]].concat();
        for faces in [BOX[1..].to_vec(), one_turned, both(BOX[4]), both([1, 1, 2]), sheet] {
            assert!(manifold::parts(&faces, 24).is_none());
        }
    }

    #[test]
    fn bodies_that_close_by_rounding_alone_are_not_exact() {
        let mut points = corners(DVec3::ZERO);
        points.push(points[7] + DVec3::splat(1e-16));
        let mut faces = BOX.to_vec();
        assert!(Topology::new(&points, &faces, None).is_exact);
        faces[11] = faces[11].map(|v| if v == 7 { 8 } else { v });
        let found = Topology::new(&points, &faces, None);
        assert_eq!((found.bodies.len(), found.is_exact), (1, points[7] == points[8]));
    }
}
