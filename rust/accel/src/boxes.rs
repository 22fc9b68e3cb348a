//! The node boxes of trees, for visualization.

use raywright_base::math::{Aabb, Axes, DVec3, Region};

/// The box of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeBox {
    /// In box units, along the tree's axes.
    pub aabb: Aabb,
    /// Depth below the root.
    pub depth: usize,
    /// Of a leaf, the number of its primitives.
    pub primitives: Option<usize>,
}

/// The boxes of a tree, in no particular order.
#[derive(Clone, Debug)]
pub struct Boxes {
    /// The boxes of all nodes.
    pub nodes: Vec<NodeBox>,
    /// The region that defines their units.
    pub region: Region,
    /// The tree's own axes, if they differ from the scene's.
    pub axes: Option<Axes>,
}

impl Boxes {
    /// The corners of a box in the scene's units. Bit k of a corner's index is set if it is at the upper end along the
    /// k-th axis.
    pub fn corners(&self, aabb: &Aabb) -> [DVec3; 8] {
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        std::array::from_fn(|i| {
            let end = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let along = DVec3::new(end(0), end(1), end(2));
            self.axes.map_or(along, |axes| axes.back(along)) / self.region.scale + self.region.centre
        })
    }
}
