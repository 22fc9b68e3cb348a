//! Motion blur: every node has boxes for the opening and the closing of the shutter, and a ray is tested against their
//! interpolation at its time (Glassner, "Spacetime Ray Tracing for Animation", 1988; interpolated boxes as in
//! Christensen, Fong, Laur and Batali, "Ray Tracing for the Movie 'Cars'", 2006).

use super::numbered_leaves::Numbered;
use crate::bvh::{BinaryBvh, Node};
use crate::walk::{Built, Input, Structure, Walker};
use crate::{Info, NodeBox, SlabRay};
use raywright_base::math::{Aabb, Vec3};

/// A binary tree with moving boxes.
pub struct Moving {
    /// The tree over boxes for the whole time interval.
    tree: Numbered,
    /// The boxes of each node at both ends.
    ends: Vec<[Aabb; 2]>,
    kind: String,
}

impl Moving {
    /// Create the structure over moving primitives; `kind` describes the build.
    pub fn over(bvh: BinaryBvh, input: &Input, kind: &str) -> Built {
        let (tree, lists) = Numbered::new(bvh);
        let mut starts = vec![0usize];
        starts.extend(lists.counts.iter().scan(0, |sum, &count| {
            *sum += count as usize;
            Some(*sum)
        }));
        let within = |leaf: u32| lists.order[starts[leaf as usize]..starts[leaf as usize + 1]].to_vec();
        let ends = ends(&tree.nodes, input, &within);
        (Box::new(Self { tree, ends, kind: format!("BVH, {kind}, moving boxes") }), lists)
    }
}

/// The boxes of a primitive at both ends, in box units.
fn ends_of(input: &Input, primitive: u32) -> [Aabb; 2] {
    let objects = input.primitives.objects();
    match objects.and_then(|objects| objects.ends(primitive)) {
        Some(ends) if ends.iter().all(|b| b.is_finite()) => ends.map(|b| input.region.aabb([b.min, b.max, b.max])),
        // Triangles are static.
        _ => [input.boxes[primitive as usize]; 2],
    }
}

fn union([a, b]: [Aabb; 2], [c, d]: [Aabb; 2]) -> [Aabb; 2] {
    [a.union(c), b.union(d)]
}

/// The boxes of all nodes at both ends.
fn ends(nodes: &[Node], input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Vec<[Aabb; 2]> {
    let mut ends = vec![[Aabb::EMPTY; 2]; nodes.len()];
    // Children follow their parents.
    for (i, node) in nodes.iter().enumerate().rev() {
        ends[i] = if node.is_leaf() {
            let each = primitives(node.index).into_iter().map(|p| ends_of(input, p));
            each.fold([Aabb::EMPTY; 2], union)
        } else {
            let [a, b] = node.children();
            union(ends[a], ends[b])
        };
    }
    ends
}

/// Interpolate two boxes at a time in [0, 1], rounded outward.
#[inline(always)]
fn between([start, end]: &[Aabb; 2], time: f64) -> Aabb {
    // The f64 computation errs by some 2⁻⁵² of its size, and rounding to f32 by 2⁻²⁴.
    const ROOM: f32 = 1.0 / (1u32 << 23) as f32;
    let at = |a: Vec3, b: Vec3| (a.as_dvec3() + (b.as_dvec3() - a.as_dvec3()) * time).as_vec3();
    let room = |a: Vec3, b: Vec3| a.abs().max(b.abs()) * ROOM + Vec3::splat(f32::MIN_POSITIVE);
    Aabb {
        min: at(start.min, end.min) - room(start.min, end.min),
        max: at(start.max, end.max) + room(start.max, end.max),
    }
}

impl Structure for Moving {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        // A path leaves one sibling per level.
        let stack = Vec::with_capacity(self.tree.depth + 1);
        if counted {
            Box::new(MovingTraversal::<true> { tree: self, ray: SlabRay::EVERYWHERE, time: 0.0, stack, nodes: 0 })
        } else {
            Box::new(MovingTraversal::<false> { tree: self, ray: SlabRay::EVERYWHERE, time: 0.0, stack, nodes: 0 })
        }
    }

    fn info(&self) -> Info {
        let info = self.tree.info(&self.kind);
        Info { bytes: info.bytes + size_of_val(self.ends.as_slice()), ..info }
    }

    fn boxes(&self, _: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        Some(self.tree.boxes())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        self.tree.validate(input, primitives)?;
        for (i, (node, outer)) in self.tree.nodes.iter().zip(&self.ends).enumerate() {
            let within = |inner: [Aabb; 2]| outer[0].contains(&inner[0]) && outer[1].contains(&inner[1]);
            let holds = if node.is_leaf() {
                primitives(node.index).into_iter().all(|p| within(ends_of(input, p)))
            } else {
                node.children().into_iter().all(|child| within(self.ends[child]))
            };
            if !holds {
                return Err(format!("node {i} does not contain its moving subtree"));
            }
        }
        Ok(())
    }

    fn refitted(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<Box<dyn Structure>, String> {
        let tree = self.tree.refitted(input, primitives)?;
        let ends = ends(&tree.nodes, input, primitives);
        Ok(Box::new(Self { tree, ends, kind: self.kind.clone() }))
    }
}

struct MovingTraversal<'a, const COUNTED: bool> {
    tree: &'a Moving,
    ray: SlabRay,
    time: f64,
    /// Nodes to visit, and the `t` at which the ray enters them.
    stack: Vec<(u32, f32)>,
    nodes: u32,
}

impl<const COUNTED: bool> MovingTraversal<'_, COUNTED> {
    /// The `t` at which the ray enters a node's box, if it does.
    #[inline(always)]
    fn enters(&self, node: u32, limit: f32) -> Option<f32> {
        let aabb = between(&self.tree.ends[node as usize], self.time);
        self.ray.passes(&aabb, limit).map(|(enter, _)| enter)
    }
}

impl<const COUNTED: bool> Walker for MovingTraversal<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.start_at(ray, 0.0);
    }

    fn start_at(&mut self, ray: &SlabRay, time: f64) {
        self.ray = *ray;
        // NaN counts as 0.
        self.time = if time > 0.0 { time.min(1.0) } else { 0.0 };
        self.nodes = 0;
        self.stack.clear();
        if !self.tree.tree.nodes.is_empty() {
            self.nodes += u32::from(COUNTED);
            let root = self.enters(0, f32::INFINITY);
            self.stack.extend(root.map(|enter| (0, enter)));
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.tree.nodes.as_slice();
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
                at = match (self.enters(a, limit), self.enters(b, limit)) {
                    (Some(enter), Some(other)) => {
                        let (near, far, then) = if enter <= other { (a, b, other) } else { (b, a, enter) };
                        self.stack.push((far, then));
                        near
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn corner() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(prop_oneof![-2f32..2.0, -1e-30f32..1e-30]).prop_map(Vec3::from_array)
    }

    proptest! {
        #[test]
        fn a_point_that_moves_stays_in_the_box_that_moves(
            from in corner(), to in corner(), low in corner(), high in corner(), time in 0.0..=1.0f64
        ) {
            let around = |p: Vec3| Aabb::around([p - low.abs(), p + high.abs()]);
            let moved = between(&[around(from), around(to)], time);
            // Exact up to half an ulp of f64 in each of three operations, far less than the f32 padding.
            let point = from.as_dvec3() * (1.0 - time) + to.as_dvec3() * time;
            prop_assert!(moved.min.as_dvec3().cmple(point).all() && moved.max.as_dvec3().cmpge(point).all());
            // The padding is at most some ulps of f32.
            let ends = [around(from), around(to)];
            let wide = (ends[1].min - ends[0].min).as_dvec3() * time + ends[0].min.as_dvec3() - moved.min.as_dvec3();
            prop_assert!(wide.max_element() <= 1e-6 * 4.0);
        }
    }
}
