//! All that there is of a scene as arrays: nodes, what stands in their leaves, and what is put elsewhere as a whole.

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

/// What stands in a leaf: a triangle by a corner and the two edges from there, in box units. Differences are taken in
/// f64 and rounded once: edges of small triangles lose nothing to their distance from the middle. Of the three corners
/// it is that from which the shortest edge goes, as it is wound: of a sliver, only one of two edges is long then, and
/// products of both are as small as the triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FlatTriangle {
    /// A corner; of what is no triangle, the least corner of its box.
    pub corner: [f32; 3],
    /// Its number among all primitives.
    pub primitive: u32,
    /// From there to the next corner; of what is no triangle, the greatest corner of its box.
    pub edge: [f32; 3],
    /// The largest coordinate of an edge in magnitude; −1 for what is no triangle.
    pub largest: f32,
    /// From there to the one before.
    pub other: [f32; 3],
    /// Of an instance that is told, one more than its place among instances; otherwise 0.
    pub instance: u32,
}

const _: () = assert!(size_of::<FlatTriangle>() == 48);

/// A prototype that is put somewhere: where its tree stands in the same arrays, and how a ray comes there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FlatInstance {
    /// From the box units of what it stands in to those of the prototype: three numbers of the linear part a row, and
    /// one of the shift.
    pub rows: [[f32; 4]; 3],
    /// The root of the prototype's tree.
    pub node: u32,
    /// The node after the last of it.
    pub end: u32,
    /// The instance's number among all primitives of what it stands in.
    pub primitive: u32,
    /// 0.
    pub reserved: u32,
}

const _: () = assert!(size_of::<FlatInstance>() == 64);

/// A scene as arrays.
#[derive(Clone, Debug)]
pub struct Flat {
    /// The tree, and then those of prototypes, if they are wanted. No nodes, no primitives.
    pub nodes: Vec<FlatNode>,
    /// What stands in leaves, leaf after leaf. A primitive may stand in several.
    pub triangles: Vec<FlatTriangle>,
    /// Instances that stand still, if they are wanted.
    pub instances: Vec<FlatInstance>,
    /// How many of the nodes and of the triangles are the scene's own.
    pub own: [usize; 2],
    /// The longest way from the root to a leaf.
    pub depth: usize,
    /// Whose units boxes, corners and edges of its own are in.
    pub region: Region,
    /// What has no end, and stands in no leaf.
    pub unbounded: Vec<u32>,
    /// Where the triangles among the primitives lie: what their errors are measured against.
    pub of_triangles: Region,
}

/// What is tested at once.
const BLOCK: usize = 1;

/// A tree that has been laid out.
#[derive(Clone, Copy)]
struct Laid {
    node: u32,
    end: u32,
    region: Region,
}

/// What is laid out so far.
#[derive(Default)]
struct Layout {
    nodes: Vec<FlatNode>,
    triangles: Vec<FlatTriangle>,
    instances: Vec<FlatInstance>,
    /// Prototypes that are there already.
    known: HashMap<usize, Laid>,
}

impl Flat {
    /// Builds a tree as the options say, and lays all out flat; prototypes too, if they are `wanted`.
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
    /// Builds a tree and lays it out behind what there is; returns its depth.
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

    /// Lays out what is put elsewhere among the triangles from one on, and what is in that.
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

    /// Lays a prototype out, if it is not there.
    fn prototype(&mut self, inside: &Placed<'_>, options: &Options) -> Laid {
        if let Some(laid) = self.known.get(&inside.id) {
            return *laid;
        }
        let (input, _) = Input::new(inside.primitives);
        let (node, from) = (self.nodes.len() as u32, self.triangles.len());
        self.tree(&input, options);
        let laid = Laid { node, end: self.nodes.len() as u32, region: input.region };
        self.known.insert(inside.id, laid);
        // Behind its tree, whose triangles end here.
        let region = input.region;
        self.instances_from(from, inside.primitives, &region, options);
        laid
    }
}

/// The map from one region's box units to those of a prototype's.
fn between(inside: &Placed<'_>, from: &Region, to: &Region) -> [[f32; 4]; 3] {
    std::array::from_fn(|i| {
        let row = inside.rows[i];
        let shift = (row.dot(from.centre - inside.shift) - to.centre[i]) * to.scale;
        let [x, y, z] = (row * (to.scale / from.scale)).to_array();
        [x, y, z, shift].map(|number| number as f32)
    })
}

/// A primitive as it stands in a leaf.
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
        // A difference of huge numbers may overflow before it is scaled; in box units it does not.
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
