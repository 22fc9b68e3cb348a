//! A wide tree over objects with one object per leaf, traversed by single rays.

use super::Options;
use super::collapse::Outline;
use super::node::{Child, Packed, WideNode, boxes};
use super::step::{Boxes, Stacks};
use crate::bvh::BinaryBvh;
use crate::walk::{Built, Input, Lists, Structure, Walker};
use crate::{Info, NodeBox, SlabRay};
use raywright_base::math::Aabb;
use raywright_base::simd::{Dispatch, Kernel, Level, Simd};
use raywright_base::work::{Stopped, Work};

/// A tree with up to `N` children per node and one object per leaf.
#[derive(Debug)]
struct Objects<const N: usize> {
    /// The nodes; the first primitive of a leaf is the leaf's own index.
    nodes: Vec<WideNode<N>>,
    depth: usize,
    leaves: usize,
    level: Level,
    kind: String,
}

/// Build a tree over boxes, as wide as the SIMD vectors.
pub fn over(input: &Input, options: &Options, level: Level) -> Built {
    // Objects are never split.
    let [grow, collapse] = input.work.parts([3.0, 1.0]);
    let (binary, name) = options.quality.steps(1).whole(&input.boxes, grow).unwrap_or_default();
    match level.lanes() {
        8 => collapsed::<8>(&binary, options, &name, level, collapse),
        _ => collapsed::<4>(&binary, options, &name, level, collapse),
    }
}

fn collapsed<const N: usize>(binary: &BinaryBvh, options: &Options, name: &str, level: Level, work: Work) -> Built
where
    Level: Dispatch<N>,
{
    let (outline, nodes) =
        Outline::of(binary, options, 1, work).unwrap_or_else(|Stopped| (Outline::NOTHING, Vec::new()));
    let kind = format!("BVH, {N} wide, {name}");
    let objects = Objects::<N> { nodes, depth: outline.depth, leaves: outline.order.len(), level, kind };
    (Box::new(objects), Lists { counts: outline.counts, order: outline.order })
}

impl<const N: usize> Objects<N> {
    /// The nodes refitted to other boxes of the leaves.
    fn fitted(&self, leaf: impl Fn(u32) -> Aabb) -> Vec<WideNode<N>> {
        let mut nodes = self.nodes.clone();
        let mut around = vec![Aabb::EMPTY; nodes.len()];
        // Children follow their parents.
        for index in (0..nodes.len()).rev() {
            let children: Vec<_> =
                nodes[index].children().map(|(_, child)| (below(child, &around, &leaf), child)).collect();
            nodes[index] = WideNode::new(&children);
            around[index] = nodes[index].bounds();
        }
        nodes
    }
}

/// The bounding box of a child's subtree.
fn below(child: Child, around: &[Aabb], leaf: impl Fn(u32) -> Aabb) -> Aabb {
    match child {
        Child::None => Aabb::EMPTY,
        Child::Node(index) => around[index as usize],
        Child::Leaf { first, .. } => leaf(first),
    }
}

impl<const N: usize> Structure for Objects<N>
where
    Level: Dispatch<N>,
{
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        // Each level leaves at most N − 1 siblings pending.
        let stacks = Stacks::spare::<N>(self.depth * (N - 1) + 1);
        if counted {
            Box::new(InstanceTraversal::<N, true> { tree: self, ray: Boxes::NOWHERE, stacks, is_new: true, nodes: 0 })
        } else {
            Box::new(InstanceTraversal::<N, false> { tree: self, ray: Boxes::NOWHERE, stacks, is_new: true, nodes: 0 })
        }
    }

    fn info(&self) -> Info {
        let area = |b: &Aabb| f64::from(b.half_area().max(f32::MIN_POSITIVE));
        let root = self.nodes.first().map_or(1.0, |root| area(&root.bounds()));
        let sum: f64 = self.nodes.iter().flat_map(WideNode::children).map(|(bounds, _)| area(&bounds)).sum();
        Info {
            kind: self.kind.clone(),
            nodes: self.nodes.len(),
            leaves: self.leaves,
            depth: self.depth,
            bytes: size_of_val(self.nodes.as_slice()),
            sah_cost: sum / root + f64::from(u8::from(!self.nodes.is_empty())),
            ..Info::default()
        }
    }

    fn boxes(&self, primitives: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        Some(boxes(&self.nodes, |first, _| primitives(first)))
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let mut met = vec![0u32; self.leaves];
        let mut reached = vec![0u32; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate() {
            for (outer, child) in node.children() {
                let inner = match child {
                    Child::Leaf { first, .. } => {
                        met[first as usize] += 1;
                        let each = primitives(first);
                        each.iter().fold(Aabb::EMPTY, |b, &p| b.union(input.boxes[p as usize]))
                    }
                    Child::Node(below) if (below as usize) > index && (below as usize) < self.nodes.len() => {
                        reached[below as usize] += 1;
                        self.nodes[below as usize].bounds()
                    }
                    other => return Err(format!("node {index} has the child {other:?}")),
                };
                if inner.is_empty() || !outer.contains(&inner) {
                    return Err(format!("node {index} does not contain {child:?}"));
                }
            }
        }
        if let Some(leaf) = met.iter().position(|&n| n != 1) {
            return Err(format!("leaf {leaf} has {} parents", met[leaf]));
        }
        match reached.iter().skip(1).position(|&n| n != 1) {
            Some(i) => Err(format!("node {} has {} parents", i + 1, reached[i + 1])),
            None => Ok(()),
        }
    }

    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let leaf = |leaf| primitives(leaf).into_iter().fold(Aabb::EMPTY, |b, p| b.union(input.boxes[p as usize]));
        let kind = self.kind.clone();
        Ok(Box::new(Self { nodes: self.fitted(leaf), kind, ..*self }))
    }
}

struct InstanceTraversal<'a, const N: usize, const COUNTED: bool> {
    tree: &'a Objects<N>,
    ray: Boxes,
    stacks: Stacks,
    /// True before the first visit.
    is_new: bool,
    nodes: u32,
}

impl<const N: usize, const COUNTED: bool> Drop for InstanceTraversal<'_, N, COUNTED> {
    fn drop(&mut self) {
        std::mem::replace(&mut self.stacks, Stacks::NONE).put_away();
    }
}

impl<const N: usize, const COUNTED: bool> Walker for InstanceTraversal<'_, N, COUNTED>
where
    Level: Dispatch<N>,
{
    fn start(&mut self, ray: &SlabRay) {
        let root = if self.tree.nodes.is_empty() { Packed::NONE } else { Packed::ROOT };
        self.ray = Boxes::new(ray, f32::INFINITY, root, self.stacks.bottom(0));
        (self.is_new, self.nodes) = (true, 0);
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        self.tree.level.dispatch(Next { walk: self, limit })
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}

/// Advances to the next leaf.
struct Next<'a, 'b, const N: usize, const COUNTED: bool> {
    walk: &'a mut InstanceTraversal<'b, N, COUNTED>,
    limit: f32,
}

impl<const N: usize, const COUNTED: bool> Kernel<N> for Next<'_, '_, N, COUNTED> {
    type Output = Option<u32>;

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) -> Option<u32> {
        let InstanceTraversal { tree, ray, stacks, is_new, nodes } = self.walk;
        if *is_new {
            (*is_new, ray.limit) = (false, self.limit);
        } else {
            if self.limit < ray.limit {
                ray.shorten(simd, self.limit, stacks, 0);
            }
            ray.pop(stacks);
        }
        loop {
            match ray.at.kind() {
                0 => {
                    if COUNTED {
                        *nodes += 1;
                    }
                    ray.enter::<N, S, true, true>(simd, &tree.nodes[ray.at.node()], stacks);
                    ray.pop(stacks);
                }
                1 => return Some(ray.at.leaf().0 as u32),
                _ => {
                    // Further calls return here again: the stack is empty.
                    *is_new = true;
                    return None;
                }
            }
        }
    }
}
