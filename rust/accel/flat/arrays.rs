//! All that there is of a scene as arrays: nodes, and what stands in their leaves.

use super::nodes::{FlatNode, flatten};
use crate::accel::bvh::Options;
use crate::accel::bvh::traverse::{gathered, larger_first};
use crate::accel::walk::Input;
use crate::accel::{Primitives, region};
use crate::math::Region;
use crate::math::robust::greater;
use crate::shapes::Bounds;
use rayon::prelude::*;

/// What stands in a leaf: a triangle by a corner and the two edges from there, in box units. Differences are taken in
/// f64 and rounded once: edges of small triangles lose nothing to their distance from the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FlatTriangle {
    /// Its first corner; of what is no triangle, the least corner of its box.
    pub corner: [f32; 3],
    /// Its number among all primitives.
    pub primitive: u32,
    /// From the first corner to the second; of what is no triangle, the greatest corner of its box.
    pub edge: [f32; 3],
    /// At least the largest coordinate of an edge in magnitude; −1 for what is no triangle.
    pub largest: f32,
    /// From the first corner to the third.
    pub other: [f32; 3],
    /// 0.
    pub reserved: u32,
}

const _: () = assert!(size_of::<FlatTriangle>() == 48);

/// A scene as arrays.
#[derive(Clone, Debug)]
pub struct Flat {
    /// The tree. No nodes, no primitives.
    pub nodes: Vec<FlatNode>,
    /// What stands in its leaves, leaf after leaf. A primitive may stand in several.
    pub triangles: Vec<FlatTriangle>,
    /// The longest way from the root to a leaf.
    pub depth: usize,
    /// Whose units boxes, corners and edges are in.
    pub region: Region,
    /// What has no end, and stands in no leaf.
    pub unbounded: Vec<u32>,
    /// Where the triangles among the primitives lie: what their errors are measured against.
    pub of_triangles: Region,
}

/// What is tested at once.
const BLOCK: usize = 1;

impl Flat {
    /// Builds a tree as the options say, and lays all out flat.
    pub fn new(primitives: &dyn Primitives, options: &Options) -> Self {
        let (input, unbounded) = Input::new(primitives);
        let (mut bvh, _) = gathered(&input, options, BLOCK);
        larger_first(&mut bvh);
        let mut nodes = flatten(&bvh.nodes);
        let mut order = Vec::with_capacity(bvh.order.len());
        for node in nodes.iter_mut().filter(|n| n.is_leaf()) {
            let from = node.index as usize;
            node.index = order.len() as u32;
            order.extend_from_slice(&bvh.order[from..from + node.count as usize]);
        }
        let region_of = |p: u32| {
            let [a, b, c] = primitives.corners(p);
            primitives.is_finite(p).then(|| Bounds { min: a.min(b).min(c), max: a.max(b).max(c) })
        };
        let of_triangles = match primitives.objects() {
            Some(_) => region(primitives.count(), region_of),
            None => input.region,
        };
        let triangles = order.par_iter().map(|&p| flat_triangle(&input, p)).collect();
        Self { nodes, triangles, depth: bvh.depth(), region: input.region, unbounded, of_triangles }
    }
}

/// A primitive as it stands in a leaf.
fn flat_triangle(input: &Input, primitive: u32) -> FlatTriangle {
    if !input.primitives.is_finite(primitive) {
        let aabb = &input.boxes[primitive as usize];
        let (corner, edge) = (aabb.min.to_array(), aabb.max.to_array());
        return FlatTriangle { corner, primitive, edge, largest: -1.0, other: [0.0; 3], reserved: 0 };
    }
    let [a, b, c] = input.primitives.corners(primitive);
    // A difference of huge numbers may overflow before it is scaled; in box units it does not.
    let [a, b, c] = [a, b, c].map(|corner| (corner, input.region.to_box(corner)));
    let edge = |to: (crate::math::DVec3, crate::math::DVec3)| {
        let exact = (to.0 - a.0) * input.region.scale;
        (if exact.is_finite() { exact } else { to.1 - a.1 }).as_vec3()
    };
    let (e, f) = (edge(b), edge(c));
    let largest = greater(e.abs().max_element(), f.abs().max_element());
    FlatTriangle {
        corner: a.1.as_vec3().to_array(),
        primitive,
        edge: e.to_array(),
        largest,
        other: f.to_array(),
        reserved: 0,
    }
}
