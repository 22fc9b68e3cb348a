//! A scene as flat arrays for kernels: nodes, leaf primitives and instances.

use super::nodes::{FlatNode, flatten};
use crate::bvh::Options;
use crate::bvh::traverse::{gathered, larger_first};
use crate::walk::Input;
use crate::{Placed, Primitives, region};
use raywright_base::math::robust::greater;
use raywright_base::math::{DVec3, Region};
use raywright_base::parallel;
use raywright_shapes::Bounds;
use std::collections::HashMap;

/// A leaf primitive: a triangle as a corner and two edges, in box units.
///
/// Edges are computed in f64 and rounded once, so edges of small triangles lose no digits to their distance from the
/// center. The corner is the one that starts the shortest edge in winding order. So for a sliver only one of the two
/// edges is long, and their products are as small as the triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FlatTriangle {
    /// A corner; for other primitives the box's min corner.
    pub corner: [f32; 3],
    /// The index among all primitives.
    pub primitive: u32,
    /// The edge to the next corner; for other primitives the box's max corner.
    pub edge: [f32; 3],
    /// The largest absolute coordinate of an edge; −1 for other primitives.
    pub largest: f32,
    /// The edge to the previous corner.
    pub other: [f32; 3],
    /// One plus the index of an included instance; otherwise 0.
    pub instance: u32,
}

const _: () = assert!(size_of::<FlatTriangle>() == 48);

/// An instance: the position of the prototype's tree in the same arrays, and the transform of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FlatInstance {
    /// The map from the parent's box units to those of the prototype: in each row, three linear coefficients and a
    /// translation.
    pub rows: [[f32; 4]; 3],
    /// The root of the prototype's tree.
    pub node: u32,
    /// One past the last node of that tree.
    pub end: u32,
    /// The instance's index among all primitives of its parent.
    pub primitive: u32,
    /// 0.
    pub reserved: u32,
}

const _: () = assert!(size_of::<FlatInstance>() == 64);

/// A scene as flat arrays.
#[derive(Clone, Debug)]
pub struct Flat {
    /// The scene's tree, then those of prototypes if included. Empty without primitives.
    pub nodes: Vec<FlatNode>,
    /// Leaf primitives, leaf by leaf. A primitive may be in several leaves.
    pub triangles: Vec<FlatTriangle>,
    /// Static instances, if included.
    pub instances: Vec<FlatInstance>,
    /// The numbers of nodes and triangles of the scene's own tree.
    pub own: [usize; 2],
    /// The depth of the tree.
    pub depth: usize,
    /// The region that defines the units of the scene's own boxes, corners and edges.
    pub region: Region,
    /// Unbounded primitives, which are in no leaf.
    pub unbounded: Vec<u32>,
    /// The region of the triangles, which determines their error bounds.
    pub of_triangles: Region,
}

/// Primitives per SIMD test.
const BLOCK: usize = 1;

/// A tree that has been laid out.
#[derive(Clone, Copy)]
struct Laid {
    node: u32,
    end: u32,
    region: Region,
}

/// The arrays so far.
#[derive(Default)]
struct Layout {
    nodes: Vec<FlatNode>,
    triangles: Vec<FlatTriangle>,
    instances: Vec<FlatInstance>,
    /// Prototypes already included.
    known: HashMap<usize, Laid>,
}

impl Flat {
    /// Build a tree and flatten the scene, with prototypes if `wanted`.
    pub fn new(primitives: &dyn Primitives, options: &Options, wanted: bool) -> Self {
        let mut layout = Layout::default();
        let (input, unbounded) = Input::new(primitives);
        let depth = layout.tree(&input, options);
        let own = [layout.nodes.len(), layout.triangles.len()];
        if wanted {
            layout.instances_from(0, primitives, &input.region, options);
        }
        let region_of = |p: u32| {
            let [a, b, c] = primitives.corners(p);
            primitives.is_finite(p).then(|| Bounds { min: a.min(b).min(c), max: a.max(b).max(c) })
        };
        let of_triangles = match primitives.objects() {
            Some(_) => region(primitives.count(), &region_of),
            None => input.region,
        };
        let Layout { nodes, triangles, instances, .. } = layout;
        Self { nodes, triangles, instances, own, depth, region: input.region, unbounded, of_triangles }
    }
}

impl Layout {
    /// Build a tree and append it; return its depth.
    fn tree(&mut self, input: &Input, options: &Options) -> usize {
        let (mut bvh, _) = gathered(input, options, BLOCK);
        larger_first(&mut bvh);
        let (from, mut entries) = (self.nodes.len() as u32, self.triangles.len() as u32);
        let mut order = Vec::with_capacity(bvh.order.len());
        for mut node in flatten(&bvh.nodes) {
            if node.is_leaf() {
                order.extend_from_slice(&bvh.order[node.index as usize..(node.index + node.count) as usize]);
                node.index = entries;
                entries += node.count;
            } else {
                node.index += from;
            }
            self.nodes.push(node);
        }
        self.triangles.extend(parallel::collect(order.len(), |i| flat_triangle(input, order[i])));
        bvh.depth()
    }

    /// Add the instances among the triangles starting at `from`, and their prototypes.
    fn instances_from(&mut self, from: usize, primitives: &dyn Primitives, region: &Region, options: &Options) {
        let Some(objects) = primitives.objects() else { return };
        for i in from..self.triangles.len() {
            let primitive = self.triangles[i].primitive;
            if self.triangles[i].largest >= 0.0 {
                continue;
            }
            let Some(inside) = objects.inside(primitive) else { continue };
            let laid = self.prototype(&inside, options);
            let rows = between(&inside, region, &laid.region);
            let Laid { node, end, .. } = laid;
            self.instances.push(FlatInstance { rows, node, end, primitive, reserved: 0 });
            self.triangles[i].instance = self.instances.len() as u32;
        }
    }

    /// Add a prototype unless it is included.
    fn prototype(&mut self, inside: &Placed<'_>, options: &Options) -> Laid {
        if let Some(laid) = self.known.get(&inside.id) {
            return *laid;
        }
        let (input, _) = Input::new(inside.primitives);
        let (node, from) = (self.nodes.len() as u32, self.triangles.len());
        self.tree(&input, options);
        let laid = Laid { node, end: self.nodes.len() as u32, region: input.region };
        self.known.insert(inside.id, laid);
        // Nested instances follow the tree, whose triangles end here.
        let region = input.region;
        self.instances_from(from, inside.primitives, &region, options);
        laid
    }
}

/// The map from one region's box units to a prototype's.
fn between(inside: &Placed<'_>, from: &Region, to: &Region) -> [[f32; 4]; 3] {
    std::array::from_fn(|i| {
        let row = inside.rows[i];
        let shift = (row.dot(from.centre - inside.shift) - to.centre[i]) * to.scale;
        let [x, y, z] = (row * (to.scale / from.scale)).to_array();
        [x, y, z, shift].map(|number| number as f32)
    })
}

/// A primitive in a leaf.
fn flat_triangle(input: &Input, primitive: u32) -> FlatTriangle {
    if !input.primitives.is_finite(primitive) {
        let aabb = &input.boxes[primitive as usize];
        let (corner, edge) = (aabb.min.to_array(), aabb.max.to_array());
        return FlatTriangle { corner, primitive, edge, largest: -1.0, other: [0.0; 3], instance: 0 };
    }
    let corners = input.primitives.corners(primitive);
    let local = corners.map(|corner| input.region.to_box(corner));
    let edges = [0, 1, 2].map(|i| {
        let next = (i + 1) % 3;
        // A difference of huge numbers may overflow before scaling; in box units it does not.
        let exact: DVec3 = (corners[next] - corners[i]) * input.region.scale;
        if exact.is_finite() { exact } else { local[next] - local[i] }
    });
    let lengths = edges.map(DVec3::length_squared);
    let from = (0..3).min_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).unwrap_or(0);
    let (e, f) = (edges[from].as_vec3(), (-edges[(from + 2) % 3]).as_vec3());
    let largest = greater(e.abs().max_element(), f.abs().max_element());
    let (corner, edge, other) = (local[from].as_vec3().to_array(), e.to_array(), f.to_array());
    FlatTriangle { corner, primitive, edge, largest, other, instance: 0 }
}
