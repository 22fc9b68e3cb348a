//! Slabs along diagonals: a node has, in addition to its box, intervals along ten more directions, those of a cube's
//! edge midpoints and corners (Kay and Kajiya, "Ray tracing complex scenes", 1986).

use super::node_volumes::{Across, NOWHERE, NodeVolumes, ObliqueRay, Points, Span, grow};
use super::numbered_leaves::Numbered;
use crate::SlabRay;
use raywright_base::math::DVec3;
use raywright_shapes::oriented_box::DIRECTIONS;

/// Directions other than the axes.
const COUNT: usize = 10;

fn normal(i: usize) -> DVec3 {
    DIRECTIONS[3 + i]
}

/// The height intervals of all nodes.
pub struct Slabs(Vec<[Span; COUNT]>);

impl NodeVolumes for Slabs {
    const NAME: &'static str = " in 13 slabs";
    type Ready = [Across; COUNT];

    fn around(tree: &Numbered, points: &Points) -> Self {
        let mut spans = vec![[NOWHERE; COUNT]; tree.nodes.len()];
        // Children follow their parents.
        for (i, node) in tree.nodes.iter().enumerate().rev() {
            if node.is_leaf() {
                for point in points.of(node.index) {
                    for (k, span) in spans[i].iter_mut().enumerate() {
                        *span = grow(*span, normal(k).dot(point));
                    }
                }
            } else {
                let [a, b] = node.children().map(|child| spans[child]);
                spans[i] = std::array::from_fn(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])]);
            }
        }
        Self(spans)
    }

    #[inline(always)]
    fn ready(ray: &SlabRay) -> [Across; COUNT] {
        let line = ObliqueRay::new(ray);
        std::array::from_fn(|k| line.across(normal(k).as_vec3()))
    }

    #[inline(always)]
    fn narrowed(&self, node: u32, ray: &[Across; COUNT], mut within: (f32, f32)) -> Option<(f32, f32)> {
        for (across, &span) in ray.iter().zip(&self.0[node as usize]) {
            within = across.narrowed(span, within);
        }
        (within.0 <= within.1).then_some(within)
    }

    fn holds(&self, node: usize, point: DVec3) -> bool {
        self.0[node].iter().enumerate().all(|(k, &span)| grow(span, normal(k).dot(point)) == span)
    }

    fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}
