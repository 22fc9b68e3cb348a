//! Flat parts of faces, and pairs of coplanar overlapping ones.

use super::clusters::{Cluster, Clusters};
use super::coincident::{LEAST, SINGLE, coincident, overlap_within, rounding};
use super::facet::Facet;
use super::facets;
use raywright_accel::Primitives;
use raywright_base::math::DVec3;
use raywright_scene::Scene;
use raywright_shapes::Flat;
use std::collections::BTreeMap;

/// A flat part of a face: a triangle, or a flat part of another shape.
#[derive(Clone, Copy, Debug)]
pub enum FlatPart {
    Triangle(Facet),
    /// As [`Flat::Ellipse`], with the unit normal.
    Ellipse {
        center: DVec3,
        axes: [DVec3; 2],
        inner: f64,
        normal: DVec3,
    },
}

/// Points outside by at most this fraction of the part's size count as inside.
const NEXT: f64 = 1e-9;

impl FlatPart {
    fn new(flat: &Flat) -> Self {
        match *flat {
            Flat::Triangle(corners) => Self::Triangle(Facet::new(corners)),
            Flat::Ellipse { center, axes, inner } => {
                let normal = axes[0].cross(axes[1]).try_normalize().unwrap_or(DVec3::ZERO);
                Self::Ellipse { center, axes, inner, normal }
            }
        }
    }

    /// The unit normal.
    pub fn normal(&self) -> DVec3 {
        match self {
            Self::Triangle(facet) => facet.normal,
            Self::Ellipse { normal, .. } => *normal,
        }
    }

    /// The approximate signed height of a point above the plane.
    pub fn height(&self, place: DVec3) -> f64 {
        match self {
            Self::Triangle(facet) => facet.normal.dot(place - facet.centre),
            Self::Ellipse { center, normal, .. } => normal.dot(place - *center),
        }
    }

    /// Return whether a point of the plane is inside or adjacent.
    pub fn covers(&self, place: DVec3) -> bool {
        self.covers_by(place, -NEXT)
    }

    /// Return whether a point of the plane is inside by at least a fraction of the part's size.
    pub fn covers_by(&self, place: DVec3, margin: f64) -> bool {
        match self {
            Self::Triangle(facet) => facet.covers_by(place, margin),
            Self::Ellipse { center, axes: [a, b], inner, normal } => {
                let (from, whole) = (place - *center, normal.dot(a.cross(*b)));
                let (x, y) = (normal.dot(from.cross(*b)) / whole, normal.dot(a.cross(from)) / whole);
                let within = if *inner > 0.0 { inner + margin } else { 0.0 };
                (within..=1.0 - margin).contains(&x.hypot(y))
            }
        }
    }

    /// The barycentric weights of a triangle's second and third corner for a point of the plane; zero for other shapes,
    /// which have constant values.
    pub fn weights(&self, place: DVec3) -> [f64; 2] {
        match self {
            Self::Triangle(facet) => facet.weights(place),
            Self::Ellipse { .. } => [0.0; 2],
        }
    }
}

/// Overlapping coplanar parts of two faces.
#[derive(Clone, Copy, Debug)]
pub struct SharedPlane {
    /// The faces, lower number first.
    pub faces: [u32; 2],
    /// Their parts.
    pub parts: [FlatPart; 2],
    /// The area of the overlap; for ellipses to some percent.
    pub area: f64,
    /// A point of the overlap.
    pub middle: DVec3,
    /// True if both have the same orientation.
    pub is_same: bool,
    /// Maximum distance of the planes by rounding.
    pub room: f64,
}

/// All pairs of faces with overlapping coplanar parts: triangles first, then other shapes with triangles and with each
/// other.
pub fn shared_planes(scene: &Scene) -> Vec<SharedPlane> {
    let corners = |face| Facet::new(scene.geometry().corners(face));
    let of_triangles = coincident(scene).into_iter().map(|overlap| {
        let facets = overlap.faces.map(corners);
        SharedPlane {
            faces: overlap.faces,
            parts: facets.map(FlatPart::Triangle),
            area: overlap.area,
            middle: overlap.middle,
            is_same: overlap.is_same,
            room: rounding(&facets[0]).min(rounding(&facets[1])),
        }
    });
    of_triangles.chain(of_shapes(scene)).collect()
}

/// A flat part of a shape, with its face and a triangulation.
struct OfShape {
    face: u32,
    part: FlatPart,
    pieces: Vec<Facet>,
}

/// The overlaps of other shapes with triangles and with each other.
fn of_shapes(scene: &Scene) -> Vec<SharedPlane> {
    let geometry = scene.geometry();
    let count = geometry.count() as u32;
    let of = |(face, flat): (u32, Flat)| {
        let pieces = flat.triangles().into_iter().map(Facet::new).filter(|piece| piece.area > 0.0).collect();
        OfShape { face, part: FlatPart::new(&flat), pieces }
    };
    let flats = |face| geometry.shape(face).map_or_else(Vec::new, |s| s.flats()).into_iter().map(move |f| (face, f));
    let parts: Vec<OfShape> = (0..count).flat_map(flats).map(of).collect();
    if parts.is_empty() {
        return Vec::new();
    }
    // All triangles, followed by all pieces with the index of their part.
    let mut all = facets(scene);
    let mut owners = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        all.extend(&part.pieces);
        owners.resize(owners.len() + part.pieces.len(), number);
    }
    let sending = (0..all.len() as u32).filter(|&i| all[i as usize].area > 0.0).collect();
    let tree = Clusters::new(&all, sending);
    let mut found = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        // By face and part of the other: the overlap's area, the area and middle of its largest piece, and the
        // tolerance.
        let mut shared = BTreeMap::<(u32, usize), (f64, f64, DVec3, f64)>::new();
        for piece in &part.pieces {
            let mut with = |other: u32| {
                let owner = other.checked_sub(count).map(|piece| owners[piece as usize]);
                if owner.is_some_and(|owner| owner <= number || parts[owner].face == part.face) {
                    return;
                }
                let facet = &all[other as usize];
                let room = rounding(piece).max(rounding(facet));
                if let Some((area, middle)) = overlap_within(piece, facet, room) {
                    let face = owner.map_or(other, |owner| parts[owner].face);
                    let at = shared.entry((face, owner.unwrap_or(usize::MAX))).or_default();
                    at.0 += area;
                    if area > at.1 {
                        (at.1, at.2, at.3) = (area, middle, room);
                    }
                }
            };
            near(&tree, piece, 0, &mut with);
        }
        for ((face, owner), (area, _, middle, room)) in shared {
            let (other, whole) = match parts.get(owner) {
                Some(other) => (other.part, other.pieces.iter().map(|piece| piece.area).sum()),
                None => (FlatPart::Triangle(all[face as usize]), all[face as usize].area),
            };
            if area <= LEAST * whole.min(part.pieces.iter().map(|piece| piece.area).sum()) {
                continue;
            }
            let is_same = other.normal().dot(part.part.normal()) > 0.0;
            let (faces, parts) = if part.face < face {
                ([part.face, face], [part.part, other])
            } else {
                ([face, part.face], [other, part.part])
            };
            found.push(SharedPlane { faces, parts, area, middle, is_same, room });
        }
    }
    found.sort_unstable_by_key(|shared| shared.faces);
    found
}

/// Call `with` for all faces of a tree that may be coplanar with a piece.
fn near(tree: &Clusters, piece: &Facet, node: usize, with: &mut dyn FnMut(u32)) {
    let cluster: &Cluster = &tree.nodes[node];
    let root = &tree.nodes[0];
    let room = SINGLE * root.low.abs().max(root.high.abs()).max_element();
    let [a, b, c] = piece.corners;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    if (0..3).any(|k| low[k] > cluster.high[k] + room || cluster.low[k] > high[k] + room) {
        return;
    }
    if cluster.is_leaf() {
        tree.faces(cluster).iter().for_each(|&face| with(face));
    } else {
        let first = cluster.parts as usize;
        near(tree, piece, first, with);
        near(tree, piece, first + 1, with);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Fronts;
    use super::*;
    use raywright_scene::fixtures::{rectangle, scene, shape};
    use raywright_scene::{SceneDescription, Shape};
    use raywright_shapes::Revolution;
    use std::f64::consts::PI;
    use std::sync::Arc;

    #[test]
    fn a_cap_that_half_lies_on_a_floor_shares_half_of_itself_with_it() {
        // The cylinder's axis stands on the floor's edge.
        let floor = shape(rectangle([0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.5; 3], 0.0);
        let cylinder = Revolution::cylinder(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0), 0.5, true);
        let cylinder: Arc<dyn raywright_shapes::Shape> = Arc::new(cylinder);
        let shapes = vec![floor, Shape { surface: cylinder.into(), ..Shape::default() }];
        let scene = scene(SceneDescription { shapes, ..Default::default() });
        let shared = shared_planes(&scene);
        assert!(shared.iter().all(|shared| !shared.is_same && shared.faces[1] == 2));
        let area: f64 = shared.iter().map(|shared| shared.area).sum();
        assert!((area / (0.125 * PI) - 1.0).abs() < 0.01, "{area}");
        let fronts = Fronts::new(&scene);
        let at = |x: f64, z: f64| fronts.touching(2, DVec3::new(x, 1.1, z)).is_some();
        assert_eq!([at(0.2, 0.0), at(-0.2, 0.0), at(0.2, 1.0)], [true, false, false]);
        let at = |x: f64, face| fronts.touching(face, DVec3::new(x, 1.0, 0.0)).is_some();
        assert!([0, 1].iter().any(|&face| at(0.499, face)) && [0, 1].iter().all(|&face| !at(0.501, face)));
    }
}
