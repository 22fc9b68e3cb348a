//! Light selection among the lights within a scene.

use super::{LightBounds, LightSampleContext, LightTree, Sides};
use raywright_base::math::{DVec3, LANES, SingleLanes, VectorLanes};
use raywright_base::sampling::AliasTable;
use std::f64::consts::PI;

/// Data for the selection of a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength {
    /// Power, a mean of the channels; 0 if it is never to be selected.
    pub power: f64,
    /// Spatial and directional bounds.
    pub bounds: LightBounds,
}

/// Distribution over the lights within a scene.
#[derive(Debug)]
pub(super) enum Choice {
    /// By power, independent of the receiver.
    Power(AliasTable),
    /// By estimated contribution to the receiver.
    Tree(LightTree),
}

/// Cap on powers: the sum of the maximum number of lights is still finite.
pub(super) const MOST: f64 = 1e290;

/// Minimum number of lights for a tree. With three lamps over a floor it already removes most of the variance of the
/// selection, at the cost of one node. The two triangles of a single lamp have nearly equal importance
/// and need none.
const MANY: usize = 3;

impl Strength {
    /// Strength of a light that never emits.
    pub const NONE: Self = Self {
        power: 0.0,
        bounds: LightBounds {
            min: DVec3::ZERO,
            max: DVec3::ZERO,
            axis: DVec3::Z,
            cos_cone: -1.0,
            cos_reach: 0.0,
            intensity: 0.0,
        },
    };

    /// Strength of a triangle whose normal follows the anticlockwise winding, or is opposite if `turned`.
    pub fn of_triangle([a, b, c]: [DVec3; 3], turned: bool, radiance: f64, sides: Sides) -> Self {
        let cross = (b - a).cross(c - a);
        let normal = cross.try_normalize().map(|n| if turned { -n } else { n });
        Self::of_shape(0.5 * cross.length(), [a.min(b).min(c), a.max(b).max(c)], normal, radiance, sides)
    }

    /// Strength of a surface of an area in a box, with one normal or none.
    pub fn of_shape(area: f64, bounds: [DVec3; 2], facing: Option<DVec3>, radiance: f64, sides: Sides) -> Self {
        if !(area.is_finite() && bounds[0].is_finite() && bounds[1].is_finite()) {
            return Self::NONE;
        }
        // The mean projected area of a convex body is a quarter of its surface (Cauchy).
        let seen = if facing.is_some() { 1.0 } else { 0.25 };
        let facing = facing.and_then(|normal| sides.facing(normal));
        let power = PI * area * radiance * sides.count();
        Self { power, bounds: LightBounds::surface(bounds, facing, (seen * area * radiance).min(MOST)) }
    }
}

impl Choice {
    /// Builds a distribution over lights; `None` if all have strength 0.
    pub fn new(strengths: &[Strength]) -> Option<Self> {
        let shine = strengths.iter().filter(|s| s.power > 0.0).count();
        if shine >= MANY { Self::by_tree(strengths) } else { Self::by_power(strengths) }
    }

    pub(super) fn by_power(strengths: &[Strength]) -> Option<Self> {
        let powers: Vec<f64> = strengths.iter().map(|s| s.power.min(MOST)).collect();
        AliasTable::new(&powers).map(Self::Power)
    }

    pub(super) fn by_tree(strengths: &[Strength]) -> Option<Self> {
        let bounds: Vec<_> = strengths.iter().map(|s| (s.power > 0.0).then_some(s.bounds)).collect();
        LightTree::new(&bounds).map(Self::Tree)
    }

    /// Samples a light for a receiver by a number in [0, 1); returns it with its probability.
    #[inline]
    pub fn sample(&self, receiver: &LightSampleContext, u: f64) -> Option<(usize, f64)> {
        match self {
            Self::Power(table) => {
                let chosen = table.sample(u);
                Some((chosen, table.probability(chosen)))
            }
            Self::Tree(tree) => tree.sample(receiver, u),
        }
    }

    /// The same for sixteen receivers, whose normals are 0 if light reaches them from all directions.
    pub fn sample_lanes(
        &self,
        position: &VectorLanes,
        normal: &SingleLanes,
        u: &[f64; LANES],
    ) -> [Option<(usize, f64)>; LANES] {
        let together = match self {
            Self::Power(_) => None,
            Self::Tree(tree) => tree.sample_lanes(position, normal, u),
        };
        together.unwrap_or_else(|| {
            let receiver = |lane: usize| LightSampleContext {
                position: position.get(lane),
                normal: normal.get(lane).as_dvec3(),
                waves: None,
            };
            std::array::from_fn(|lane| self.sample(&receiver(lane), u[lane]))
        })
    }

    /// Probability of selecting a light.
    #[inline]
    pub fn probability(&self, light: usize, receiver: &LightSampleContext) -> f64 {
        match self {
            Self::Power(table) => table.probability(light),
            Self::Tree(tree) => tree.probability(light, receiver),
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Power(table) => table.bytes(),
            Self::Tree(tree) => tree.bytes(),
        }
    }
}
