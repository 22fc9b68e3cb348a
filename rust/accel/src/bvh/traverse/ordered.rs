//! Traversal with a stack: nearer child first. The other child is pushed with its entry distance, and skipped if a
//! nearer hit was found meanwhile (Kay and Kajiya, "Ray tracing complex scenes", 1986, with a stack instead of their
//! heap).

use super::node_volumes::{NoVolumes, NodeVolumes, Points};
use super::numbered_leaves::Numbered;
use super::occlusion::{Unordered, larger_first};
use super::{bundle, packets};
use crate::bvh::BinaryBvh;
use crate::walk::{Built, Input, Lists, Structure, Together, Walker};
use crate::{Info, NodeBox, SlabRay};
use raywright_base::simd::Level;

/// The number of rays traversed together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketSize {
    /// Single rays.
    One,
    /// Packets of 4, one vector.
    Four,
    /// Packets of 64, ranges of vectors.
    SixtyFour,
}

/// A binary tree traversed with a stack, by single rays or packets.
pub struct Ordered<V = NoVolumes> {
    tree: Numbered,
    /// Additional bounding volumes of the nodes.
    volumes: V,
    rays: PacketSize,
    kind: String,
}

impl Ordered {
    /// Create the structure; `kind` describes the build.
    pub fn over(mut bvh: BinaryBvh, rays: PacketSize, kind: &str) -> Built {
        larger_first(&mut bvh);
        let (tree, lists) = Numbered::new(bvh);
        let name = match rays {
            PacketSize::One => "stack",
            PacketSize::Four => "packets of 4",
            PacketSize::SixtyFour => "packets of 64",
        };
        (Box::new(Self { tree, volumes: NoVolumes, rays, kind: format!("BVH, {kind}, {name}") }), lists)
    }
}

impl<V: NodeVolumes> Ordered<V> {
    /// Create the structure with additional bounding volumes, for single rays.
    pub(super) fn within(mut bvh: BinaryBvh, input: &Input, kind: &str) -> Built {
        larger_first(&mut bvh);
        let (tree, lists) = Numbered::new(bvh);
        let volumes = V::around(&tree, &Points::new(input, &lists));
        (Box::new(Self { tree, volumes, rays: PacketSize::One, kind: format!("BVH, {kind}, stack{}", V::NAME) }), lists)
    }

    fn lists(&self, primitives: &dyn Fn(u32) -> Vec<u32>) -> Lists {
        let leaves = self.tree.nodes.iter().filter(|n| n.is_leaf()).count() as u32;
        let all: Vec<_> = (0..leaves).map(primitives).collect();
        Lists::of(all.iter().map(Vec::as_slice))
    }
}

impl<V: NodeVolumes> Structure for Ordered<V> {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        if counted {
            Box::new(OrderedTraversal::<V, true>::new(self))
        } else {
            Box::new(OrderedTraversal::<V, false>::new(self))
        }
    }

    fn any_walker(&self) -> Box<dyn Walker + '_> {
        Box::new(Unordered::new(&self.tree, &self.volumes))
    }

    fn together(&self, counted: bool, level: Level) -> Option<Box<dyn Together + '_>> {
        match self.rays {
            PacketSize::One => None,
            PacketSize::Four => Some(packets::walk(&self.tree, counted, level)),
            PacketSize::SixtyFour => Some(bundle::walk(&self.tree, counted, level)),
        }
    }

    fn info(&self) -> Info {
        let info = self.tree.info(&self.kind);
        Info { bytes: info.bytes + self.volumes.bytes(), ..info }
    }

    fn boxes(&self, _: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        Some(self.tree.boxes())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        self.tree.validate(input, primitives)?;
        let lists = self.lists(primitives);
        let points = Points::new(input, &lists);
        let holds = |i: usize| points.below(&self.tree, i).into_iter().all(|p| self.volumes.holds(i, p));
        match (0..self.tree.nodes.len()).find(|&i| !V::NAME.is_empty() && !holds(i)) {
            Some(i) => Err(format!("the volume of node {i} does not contain its subtree")),
            None => Ok(()),
        }
    }

    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let tree = self.tree.refitted(input, primitives)?;
        let volumes = V::around(&tree, &Points::new(input, &self.lists(primitives)));
        Ok(Box::new(Self { tree, volumes, rays: self.rays, kind: self.kind.clone() }))
    }
}

struct OrderedTraversal<'a, V: NodeVolumes, const COUNTED: bool> {
    tree: &'a Numbered,
    volumes: &'a V,
    ray: SlabRay,
    ready: V::Ready,
    /// Nodes to visit, and the `t` at which the ray enters them.
    stack: Vec<(u32, f32)>,
    nodes: u32,
}

impl<'a, V: NodeVolumes, const COUNTED: bool> OrderedTraversal<'a, V, COUNTED> {
    fn new(of: &'a Ordered<V>) -> Self {
        let ray = SlabRay::EVERYWHERE;
        // A path leaves one sibling per level.
        let stack = Vec::with_capacity(of.tree.depth + 1);
        Self { tree: &of.tree, volumes: &of.volumes, ray, ready: V::ready(&ray), stack, nodes: 0 }
    }
}

impl<V: NodeVolumes, const COUNTED: bool> Walker for OrderedTraversal<'_, V, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.ray = *ray;
        self.ready = V::ready(ray);
        self.nodes = 0;
        self.stack.clear();
        if let Some(root) = self.tree.nodes.first() {
            self.nodes += u32::from(COUNTED);
            self.stack.extend(ray.passes(&root.aabb(), f32::INFINITY).map(|(enter, _)| (0, enter)));
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.nodes.as_slice();
        while let Some((mut at, enter)) = self.stack.pop() {
            if enter > limit {
                continue;
            }
            loop {
                let node = &nodes[at as usize];
                if node.is_leaf() {
                    return Some(node.index);
                }
                if COUNTED {
                    self.nodes += 2;
                }
                let [a, b] = [node.index, node.index + 1];
                let passes = |i: u32| {
                    let within = self.ray.passes(&nodes[i as usize].aabb(), limit)?;
                    self.volumes.narrowed(i, &self.ready, within)
                };
                at = match (passes(a), passes(b)) {
                    (Some((enter, _)), Some((other, _))) if enter <= other => {
                        self.stack.push((b, other));
                        a
                    }
                    (Some((enter, _)), Some(_)) => {
                        self.stack.push((a, enter));
                        b
                    }
                    (Some(_), None) => a,
                    (None, Some(_)) => b,
                    (None, None) => break,
                };
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}
