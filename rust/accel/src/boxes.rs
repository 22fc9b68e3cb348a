//! The boxes of trees, for people to look at.

use raywright_base::math::{Aabb, Axes, DVec3, Region};

/// The box of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeBox {
    /// In box units, along the tree's axes.
    pub aabb: Aabb,
    /// Steps from the root.
    pub depth: usize,
    /// Of a leaf, how many primitives stand in it.
    pub primitives: Option<usize>,
}

/// The boxes of a tree, in no order.
#[derive(Clone, Debug)]
pub struct Boxes {
    /// Of all nodes.
    pub nodes: Vec<NodeBox>,
    /// Whose units they are in.
    pub region: Region,
    /// What they lie along, if not the scene's own axes.
    pub axes: Option<Axes>,
}

impl Boxes {
    /// The corners of a box where the scene is: bits 0 to 2 of a corner's number are set where it is at the greater
    /// end along the first to the third axis.
    pub fn corners(&self, aabb: &Aabb) -> [DVec3; 8] {
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        std::array::from_fn(|i| {
            let end = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let along = DVec3::new(end(0), end(1), end(2));
            self.axes.map_or(along, |axes| axes.back(along)) / self.region.scale + self.region.centre
        })
    }
}
