//! Oriented bounding boxes: a node has one in addition to its axis-aligned box, if its surface area is smaller
//! (Gottschalk, Lin and Manocha, "OBBTree: A Hierarchical Structure for Rapid Interference Detection", 1996).

use super::node_volumes::{NOWHERE, NodeVolumes, ObliqueRay, Points, Span, grow};
use super::numbered_leaves::Numbered;
use crate::SlabRay;
use raywright_base::math::{DVec3, Vec3};
use raywright_base::parallel;
use raywright_shapes::oriented_box::OrientedBox;

/// Maximum surface area of an oriented box relative to the axis-aligned one. A larger one is not worth its test.
const WORTHWHILE: f32 = 0.8;

/// The oriented boxes of nodes that have one.
pub struct Oriented {
    /// The index of each node's box; [`Oriented::NONE`] without one.
    which: Vec<u32>,
    boxes: Vec<Turned>,
}

/// An oriented box.
#[derive(Clone, Copy)]
struct Turned {
    axes: [Vec3; 3],
    spans: [Span; 3],
}

impl Turned {
    /// A box around points, if its surface area is small enough.
    fn around(points: &[DVec3], surface: f32) -> Option<Self> {
        // Use rounded axes, with intervals recomputed along them.
        let axes = OrientedBox::around(points)?.axes.map(|axis| axis.as_vec3());
        let mut spans = [NOWHERE; 3];
        for &point in points {
            for (span, axis) in spans.iter_mut().zip(axes) {
                *span = grow(*span, axis.as_dvec3().dot(point));
            }
        }
        let [a, b, c] = spans.map(|[low, high]| high - low);
        (a * (b + c) + b * c < WORTHWHILE * surface).then_some(Self { axes, spans })
    }
}

impl Oriented {
    const NONE: u32 = u32::MAX;
}

impl NodeVolumes for Oriented {
    const NAME: &'static str = " in turned boxes";
    type Ready = ObliqueRay;

    fn around(tree: &Numbered, points: &Points) -> Self {
        let turned = parallel::map(tree.nodes.len(), |i| {
            Turned::around(&points.below(tree, i), tree.nodes[i].aabb().half_area())
        });
        let mut count = 0;
        let which = turned.iter().map(|turned| match turned {
            None => Self::NONE,
            Some(_) => {
                count += 1;
                count - 1
            }
        });
        Self { which: which.collect(), boxes: turned.into_iter().flatten().collect() }
    }

    #[inline(always)]
    fn ready(ray: &SlabRay) -> ObliqueRay {
        ObliqueRay::new(ray)
    }

    #[inline(always)]
    fn narrowed(&self, node: u32, ray: &ObliqueRay, mut within: (f32, f32)) -> Option<(f32, f32)> {
        let Some(turned) = self.boxes.get(self.which[node as usize] as usize) else { return Some(within) };
        for (&axis, &span) in turned.axes.iter().zip(&turned.spans) {
            within = ray.across(axis).narrowed(span, within);
        }
        (within.0 <= within.1).then_some(within)
    }

    fn holds(&self, node: usize, point: DVec3) -> bool {
        let Some(turned) = self.boxes.get(self.which[node] as usize) else { return true };
        turned.axes.iter().zip(turned.spans).all(|(axis, span)| grow(span, axis.as_dvec3().dot(point)) == span)
    }

    fn bytes(&self) -> usize {
        size_of_val(self.which.as_slice()) + size_of_val(self.boxes.as_slice())
    }
}
