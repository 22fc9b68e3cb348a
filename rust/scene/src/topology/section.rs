//! Plane sections of meshes.

use super::enclosed_area::{Rule, covered};
use super::outlines::{Polyline, outlines};
use super::{FaceKind, Topology, joined};
use raywright_accel::BoxTree;
use raywright_base::math::{DVec2, DVec3};
use raywright_shapes::Bounds;
use std::collections::HashMap;
use std::sync::OnceLock;

/// Minimum number of planes for which a tree over the faces pays off.
const FOR_A_TREE: usize = 8;

/// At a T-junction, a plane nearly parallel to the edges cuts them at points this many times farther apart than the
/// edges are.
const ALONG_A_CRACK: f64 = 8.0;

/// A polyline of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// A closed polyline repeats its first point at the end.
    pub points: Vec<DVec3>,
    /// True if it is closed.
    pub is_closed: bool,
}

/// The section of a mesh with a plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Open polylines, then closed ones. Closed ones are anticlockwise around the inside, as seen against the normal.
    pub lines: Vec<Cut>,
    /// Area enclosed by the closed polylines.
    pub area: f64,
}

/// A mesh prepared for sections.
pub struct Cutter<'a> {
    points: &'a [DVec3],
    given: &'a [[u32; 3]],
    tolerance: Option<f64>,
    faces: Faces,
    /// The mesh with rounded corners welded and inner walls removed, used if polylines do not close otherwise.
    welded: OnceLock<(Faces, f64)>,
    tree: Option<BoxTree>,
}

/// Faces by representative corners.
struct Faces {
    faces: Vec<[u32; 3]>,
    is_left: Vec<bool>,
    /// For each face, faces with its orientation minus those with the opposite one, if duplicates are removed.
    votes: Option<Vec<i32>>,
}

impl<'a> Cutter<'a> {
    /// Prepares a mesh for a number of sections. Corners are merged within a tolerance; the default is
    /// [`super::rounding`].
    pub fn new(points: &'a [DVec3], given: &'a [[u32; 3]], tolerance: Option<f64>, planes: usize) -> Self {
        let corners = joined(points);
        let is_finite = |face: &[u32; 3]| face.iter().all(|&v| points[v as usize].is_finite());
        let faces = Faces {
            faces: given.iter().map(|face| face.map(|v| corners[v as usize])).collect(),
            is_left: given.iter().map(is_finite).collect(),
            votes: None,
        };
        let around = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| points[v as usize]);
            // Merged corners may lie slightly outside the face's box.
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let room = tolerance.unwrap_or(0.0) + 1e-6 * min.abs().max(max.abs()).max_element();
            Bounds { min: min - room, max: max + room }
        };
        let boxes = || given.iter().enumerate().filter(|(_, face)| is_finite(face));
        let tree = (planes >= FOR_A_TREE).then(|| BoxTree::new(boxes().map(|(i, face)| (i as u32, around(face)))));
        Self { points, given, tolerance, faces, welded: OnceLock::new(), tree }
    }

    /// The section with a plane, and its area. The normal must be a unit vector.
    ///
    /// The side of a corner is decided once for all faces that share it. A corner exactly on the plane counts as above
    /// (Edelsbrunner and Mücke, "Simulation of Simplicity", 1990).
    pub fn cut(&self, origin: DVec3, normal: DVec3, rule: Rule) -> Section {
        let near = self.tree.as_ref().map(|tree| {
            let mut near = Vec::new();
            tree.visit(|bounds| is_cut(bounds, origin, normal), |face| near.push(face));
            near.sort_unstable();
            near
        });
        let cut = |faces: &Faces, joining| {
            let segments = match &near {
                Some(near) => Segments::new(self.points, faces, near.iter().copied(), origin, normal),
                None => Segments::new(self.points, faces, 0..faces.faces.len() as u32, origin, normal),
            };
            segments.outlines(joining)
        };
        let (mut segments, mut lines) = cut(&self.faces, 0.0);
        let is_welding = self.tolerance.is_none_or(|tolerance| tolerance > 0.0);
        if is_welding && lines.iter().any(|line| !line.is_closed()) {
            let (welded, joining) = self.welded.get_or_init(|| {
                let topology = Topology::new(self.points, self.given, self.tolerance);
                let is_left = |kind: &FaceKind| matches!(kind, FaceKind::Closed(_) | FaceKind::Open);
                let name = |face: &[u32; 3]| face.map(|v| topology.corners[v as usize]);
                let faces = Faces {
                    faces: self.given.iter().map(name).collect(),
                    is_left: topology.faces.iter().map(is_left).collect(),
                    votes: Some(topology.votes),
                };
                (faces, ALONG_A_CRACK * topology.tolerance)
            });
            (segments, lines) = cut(welded, *joining);
        }
        segments.section(lines, normal, rule)
    }
}

/// Returns whether a plane may intersect a box.
fn is_cut(bounds: &Bounds, origin: DVec3, normal: DVec3) -> bool {
    let (middle, half) = (0.5 * bounds.min + 0.5 * bounds.max - origin, 0.5 * bounds.max - 0.5 * bounds.min);
    let size = middle.abs().dot(normal.abs());
    middle.dot(normal).abs() <= half.dot(normal.abs()) + 1e-12 * size
}

/// Segments of the section.
#[derive(Default)]
struct Segments {
    points: Vec<DVec3>,
    /// Point numbers of each segment, with the inside on the left.
    ends: Vec<[u32; 2]>,
    /// For each segment, faces with this orientation minus those with the opposite one.
    votes: Vec<i32>,
}

impl Segments {
    fn new(corners: &[DVec3], faces: &Faces, which: impl Iterator<Item = u32>, origin: DVec3, normal: DVec3) -> Self {
        let height = |v: u32| (corners[v as usize] - origin).dot(normal);
        let mut numbers: HashMap<[u32; 2], u32> = HashMap::new();
        let mut known: HashMap<[u32; 3], u32> = HashMap::new();
        let mut all = Self::default();
        for number in which.filter(|&face| faces.is_left[face as usize]) {
            let face = faces.faces[number as usize];
            let heights = face.map(height);
            let above = heights.map(|h| h >= 0.0);
            let count = above.iter().filter(|is| **is).count();
            if count == 0 || count == 3 {
                continue;
            }
            // The corner that is alone on its side. Equal corners are on the same side, so its edges have distinct
            // ends.
            let i = (0..3).find(|&i| above[i] == (count == 1)).unwrap_or(0);
            let [a, b, c] = [i, (i + 1) % 3, (i + 2) % 3];
            if face[b] == face[c] {
                continue;
            }
            let mut point = |u: usize, v: usize| {
                let [u, v] = if face[u] < face[v] { [u, v] } else { [v, u] };
                *numbers.entry([face[u], face[v]]).or_insert_with(|| {
                    let share = heights[u] / (heights[u] - heights[v]);
                    all.points.push(corners[face[u] as usize] * (1.0 - share) + corners[face[v] as usize] * share);
                    all.points.len() as u32 - 1
                })
            };
            let (first, second) = (point(a, b), point(a, c));
            let ends = if above[a] { [first, second] } else { [second, first] };
            let mut key = face;
            key.sort_unstable();
            // Faces with the same corners count once.
            let segment = *known.entry(key).or_insert_with(|| {
                all.ends.push(ends);
                all.votes.push(0);
                all.ends.len() as u32 - 1
            }) as usize;
            let votes = faces.votes.as_ref().map_or(1, |votes| votes[number as usize]);
            all.votes[segment] += if all.ends[segment] == ends { votes } else { -votes };
        }
        all
    }

    /// Joins segments into polylines, merging points with an odd number of segments within a distance.
    fn outlines(mut self, joining: f64) -> (Self, Vec<Polyline>) {
        if joining > 0.0 {
            self.join_ends(joining);
        }
        let lines = outlines(self.points.len(), &self.ends);
        (self, lines)
    }

    /// Pairs points with an odd number of segments, nearest pairs first, within a distance.
    fn join_ends(&mut self, joining: f64) {
        let mut is_odd = vec![false; self.points.len()];
        self.ends.iter().flatten().for_each(|&p| is_odd[p as usize] ^= true);
        let at = |p: u32| self.points[p as usize];
        let mut odd: Vec<u32> = (0..is_odd.len() as u32).filter(|&p| is_odd[p as usize]).collect();
        odd.sort_unstable_by(|&p, &q| at(p).x.total_cmp(&at(q).x));
        let mut stands_for: Vec<u32> = (0..is_odd.len() as u32).collect();
        for (i, &p) in odd.iter().enumerate() {
            if !is_odd[p as usize] {
                continue;
            }
            let near = odd[i + 1..].iter().take_while(|&&q| at(q).x - at(p).x <= joining);
            let left = near.filter(|&&q| is_odd[q as usize]).map(|&q| (at(p).distance(at(q)), q));
            let nearest = left.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((_, q)) = nearest.filter(|(distance, _)| *distance <= joining) {
                stands_for[q as usize] = p;
                (is_odd[p as usize], is_odd[q as usize]) = (false, false);
            }
        }
        for end in self.ends.iter_mut().flatten() {
            *end = stands_for[*end as usize];
        }
    }

    /// The polylines in space, oriented by the majority of their length, and the enclosed area.
    fn section(&self, lines: Vec<Polyline>, normal: DVec3, rule: Rule) -> Section {
        let across = normal.any_orthonormal_vector();
        let along = normal.cross(across);
        let flat = |p: u32| {
            let point = self.points[p as usize] - self.points[0];
            DVec2::new(point.dot(across), point.dot(along))
        };
        let mut turned = Vec::with_capacity(lines.len());
        let mut unsure = Vec::new();
        for line in lines {
            let votes = line.segments.iter().map(|&(segment, is_forward)| {
                let [from, to] = self.ends[segment as usize].map(|p| self.points[p as usize]);
                let vote = f64::from(self.votes[segment as usize].signum());
                from.distance(to) * if is_forward { vote } else { -vote }
            });
            let sum: f64 = votes.sum();
            if sum == 0.0 && line.is_closed() {
                unsure.push(turned.len());
            }
            turned.push(if sum < 0.0 { line.reversed() } else { line });
        }
        let flats: Vec<Vec<DVec2>> = turned.iter().map(|line| line.points.iter().map(|&p| flat(p)).collect()).collect();
        let is_closed: Vec<bool> = turned.iter().map(Polyline::is_closed).collect();
        let mut segments: Vec<[DVec2; 2]> = Vec::new();
        for (i, line) in turned.iter_mut().enumerate().filter(|(i, _)| is_closed[*i]) {
            let mut ring: Vec<[DVec2; 2]> = flats[i].windows(2).map(|ends| [ends[0], ends[1]]).collect();
            if unsure.binary_search(&i).is_ok() {
                // Outer boundaries are anticlockwise, and those of holes clockwise.
                let others = flats.iter().enumerate().filter(|(j, _)| *j != i && is_closed[*j]);
                let depth = others.filter(|(_, other)| surrounds(other, flats[i][0])).count();
                if (doubled_area(&flats[i]) > 0.0) != (depth % 2 == 0) {
                    *line = std::mem::take(line).reversed();
                    ring.iter_mut().for_each(|ends| ends.reverse());
                }
            }
            segments.extend(ring);
        }
        let placed = |line: Polyline| Cut {
            is_closed: line.is_closed(),
            points: line.points.iter().map(|&p| self.points[p as usize]).collect(),
        };
        Section { area: covered(&segments, rule), lines: turned.into_iter().map(placed).collect() }
    }
}

/// Twice the area enclosed by a polyline, by the shoelace formula about its first point.
fn doubled_area(line: &[DVec2]) -> f64 {
    line.windows(2).map(|ends| (ends[0] - line[0]).perp_dot(ends[1] - line[0])).sum()
}

/// Returns whether a closed polyline surrounds a point an odd number of times.
fn surrounds(line: &[DVec2], point: DVec2) -> bool {
    let crosses = |ends: &&[DVec2]| {
        let &&[a, b] = ends else { return false };
        (a.y > point.y) != (b.y > point.y) && a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y) > point.x
    };
    line.windows(2).filter(crosses).count() % 2 == 1
}
