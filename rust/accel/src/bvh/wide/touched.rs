//! Solid cone queries on a wide tree: every box that a cone may touch is opened, and every triangle there is tested.

use super::WideBvh;
use super::node::Child;
use crate::touches::{ConeBoxTest, Touch, Touches};
use raywright_base::simd::{Kernel, Simd};
use raywright_shapes::triangle::{Leaves, SolidCone};

/// A batch of cone queries; None is an invalid cone.
pub struct Cones<'a, const N: usize, L> {
    pub bvh: &'a WideBvh<N, L>,
    pub cones: &'a [Option<SolidCone>],
}

impl<const N: usize, L: Leaves<N>> Kernel<N> for Cones<'_, N, L> {
    type Output = Touches;

    #[inline(always)]
    fn run<S: Simd<N>>(self, _: S) -> Touches {
        let mut all = Touches::new();
        let mut stack = Vec::with_capacity(self.bvh.stack);
        for cone in self.cones {
            let mut touches = Vec::new();
            if let Some(cone) = cone {
                walk(self.bvh, cone, &mut stack, &mut touches);
            }
            all.push(touches);
        }
        all
    }
}

#[inline(always)]
fn walk<const N: usize, L: Leaves<N>>(
    bvh: &WideBvh<N, L>,
    cone: &SolidCone,
    stack: &mut Vec<u32>,
    touches: &mut Vec<Touch>,
) {
    let boxes = ConeBoxTest::new(bvh.axes.as_ref(), cone, &bvh.region);
    stack.extend((!bvh.nodes.is_empty()).then_some(0));
    while let Some(index) = stack.pop() {
        let node = &bvh.nodes[index as usize];
        let mut left = match &boxes {
            Some(boxes) => boxes.may_touch(&node.planes),
            None => u32::MAX >> (32 - N),
        };
        while left != 0 {
            let lane = left.trailing_zeros() as usize & (N - 1);
            left &= left - 1;
            match node.child(lane) {
                Child::None => {}
                Child::Node(below) => stack.push(below),
                Child::Leaf { first, count } => {
                    let first = first as usize;
                    for lane in 0..count as usize {
                        if let Some(distance) = cone.nearest(bvh.leaves.corners(first, count, lane)) {
                            touches.push(Touch { distance, primitive: bvh.leaves.primitive(first, count, lane) });
                        }
                    }
                }
            }
        }
    }
}
