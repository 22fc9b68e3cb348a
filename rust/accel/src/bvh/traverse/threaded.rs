//! Stackless traversal with threads: every node has one link for a hit and one for a miss, so a traversal needs only an
//! index (Smits, "Efficiency Issues for Ray Tracing", 1998).
//!
//! One thread is one order of the leaves, which suits rays in that direction. So there are several threads, one for
//! each of six or eight classes of directions (Hachisuka, "Implementing a Photorealistic Rendering System using GLSL",
//! 2015). In each, the child whose center is nearer in that direction goes first.

use super::numbered_leaves::Numbered;
use crate::bvh::BinaryBvh;
use crate::walk::{Built, Input, Structure, Walker};
use crate::{Info, NodeBox, SlabRay};
use raywright_base::math::Vec3;

/// The classes of directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orders {
    /// By the major axis and its sign.
    Six,
    /// By octant.
    #[default]
    Eight,
}

impl Orders {
    /// The number of classes.
    pub const fn count(self) -> usize {
        match self {
            Self::Six => 6,
            Self::Eight => 8,
        }
    }

    /// The representative direction of a class.
    fn direction(self, way: usize) -> Vec3 {
        let towards = |down: usize| if down == 0 { 1.0 } else { -1.0 };
        match self {
            Self::Six => Vec3::AXES[way / 2] * towards(way % 2),
            Self::Eight => Vec3::new(towards(way & 1), towards(way >> 1 & 1), towards(way >> 2)),
        }
    }

    /// The class of a ray.
    fn way(self, ray: &SlabRay) -> usize {
        let [x, y, z] = ray.first;
        match self {
            Self::Six => {
                let [a, b, c] = ray.inverse.map(f32::abs);
                let axis = if a <= b && a <= c { 0 } else { 1 + usize::from(c < b) };
                2 * axis + ray.first[axis]
            }
            Self::Eight => x | y << 1 | z << 2,
        }
    }
}

/// The links of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Link {
    /// The next node after a hit.
    hit: u32,
    /// The next node after a miss.
    miss: u32,
}

impl Link {
    /// The end of the traversal.
    const END: u32 = u32::MAX;
}

/// A binary tree with threads.
pub struct Threaded {
    tree: Numbered,
    orders: Orders,
    /// The links of every node, class by class.
    links: Vec<Link>,
    kind: String,
}

impl Threaded {
    /// Create the structure; `kind` describes the build.
    pub fn over(bvh: BinaryBvh, orders: Orders, kind: &str) -> Built {
        let (tree, lists) = Numbered::new(bvh);
        let links = (0..orders.count()).flat_map(|way| thread(&tree, orders.direction(way))).collect();
        let kind = format!("BVH, {kind}, threaded in {} orders", orders.count());
        (Box::new(Self { tree, orders, links, kind }), lists)
    }
}

/// The links of all nodes for one class.
fn thread(tree: &Numbered, direction: Vec3) -> Vec<Link> {
    let nodes = tree.nodes.as_slice();
    let mut links = vec![Link { hit: Link::END, miss: Link::END }; nodes.len()];
    // Parents come before their children, so their miss links are known.
    for (i, node) in nodes.iter().enumerate() {
        let behind = links[i].miss;
        if node.is_leaf() {
            links[i].hit = behind;
            continue;
        }
        let [a, b] = node.children();
        // Doubled centers.
        let at = |child: usize| (nodes[child].min + nodes[child].max).dot(direction);
        let (near, far) = if at(a) <= at(b) { (a, b) } else { (b, a) };
        links[i].hit = near as u32;
        links[near].miss = far as u32;
        links[far].miss = behind;
    }
    links
}

impl Structure for Threaded {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        let (ray, links) = (SlabRay::EVERYWHERE, self.links.as_slice());
        if counted {
            Box::new(ThreadedTraversal::<true> { threaded: self, links, ray, at: Link::END, nodes: 0 })
        } else {
            Box::new(ThreadedTraversal::<false> { threaded: self, links, ray, at: Link::END, nodes: 0 })
        }
    }

    fn info(&self) -> Info {
        let info = self.tree.info(&self.kind);
        Info { bytes: info.bytes + size_of_val(self.links.as_slice()), ..info }
    }

    fn boxes(&self, _: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        Some(self.tree.boxes())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        self.tree.validate(input, primitives)?;
        let count = self.tree.nodes.len();
        if self.links.len() != count * self.orders.count() {
            return Err(format!("{} links of {count} nodes", self.links.len()));
        }
        if count == 0 {
            return Ok(());
        }
        for (way, links) in self.links.chunks(count).enumerate() {
            let mut met = vec![false; count];
            let mut at = 0;
            while at != Link::END {
                match met.get_mut(at as usize) {
                    Some(met) if !*met => *met = true,
                    _ => return Err(format!("thread {way} visits node {at} of {count} twice")),
                }
                at = links[at as usize].hit;
            }
            if let Some(i) = met.iter().position(|&met| !met) {
                return Err(format!("thread {way} skips node {i}"));
            }
            for (i, node) in self.tree.nodes.iter().enumerate().filter(|(_, n)| !n.is_leaf()) {
                let [a, b] = node.children().map(|child| links[child].miss as usize);
                let [first, second] = node.children();
                let behind = links[i].miss as usize;
                if !((a, b) == (second, behind) || (a, b) == (behind, first)) {
                    return Err(format!("thread {way} continues to {a} and {b} after the children of node {i}"));
                }
            }
        }
        Ok(())
    }

    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let tree = self.tree.refitted(input, primitives)?;
        let links = (0..self.orders.count()).flat_map(|way| thread(&tree, self.orders.direction(way))).collect();
        Ok(Box::new(Self { tree, links, orders: self.orders, kind: self.kind.clone() }))
    }
}

struct ThreadedTraversal<'a, const COUNTED: bool> {
    threaded: &'a Threaded,
    /// The links of the ray's class.
    links: &'a [Link],
    ray: SlabRay,
    at: u32,
    nodes: u32,
}

impl<const COUNTED: bool> Walker for ThreadedTraversal<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        let (count, way) = (self.threaded.tree.nodes.len(), self.threaded.orders.way(ray));
        self.links = &self.threaded.links[way * count..(way + 1) * count];
        self.ray = *ray;
        self.nodes = 0;
        self.at = if count > 0 { 0 } else { Link::END };
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.threaded.tree.nodes.as_slice();
        while self.at != Link::END {
            let (node, link) = (&nodes[self.at as usize], self.links[self.at as usize]);
            self.nodes += u32::from(COUNTED);
            if self.ray.passes(&node.aabb(), limit).is_none() {
                self.at = link.miss;
                continue;
            }
            self.at = link.hit;
            if node.is_leaf() {
                return Some(node.index);
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::{DVec3, Ray, Region};

    #[test]
    fn rays_go_the_way_that_stands_for_them() {
        let region = Region::around([DVec3::splat(-1.0), DVec3::ONE]);
        for orders in [Orders::Six, Orders::Eight] {
            for way in 0..orders.count() {
                let direction = orders.direction(way).as_dvec3();
                for slant in [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.1), DVec3::new(-0.4, 0.1, 0.2)] {
                    let ray = Ray::new(DVec3::ZERO, direction + slant);
                    let (_, slabs) = SlabRay::prepare(None, &ray, &region).unwrap();
                    assert_eq!(orders.way(&slabs), way, "{orders:?}, {direction}");
                }
            }
        }
    }
}
