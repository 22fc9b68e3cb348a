//! The choice among the lights within a scene.

use super::{LightBounds, LightContextLanes, LightSampleContext, LightTree, Sides};
use raywright_base::math::{DVec3, LANES};
use raywright_base::sampling::AliasTable;
use raywright_base::simd::Level;
use std::f64::consts::PI;

/// What a light is chosen by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength {
    /// Its power, a mean of the channels; 0 if it is never to be chosen.
    pub power: f64,
    /// Where it is and where it shines to.
    pub bounds: LightBounds,
}

/// How a light within a scene is chosen.
#[derive(Debug)]
pub(super) enum Choice {
    /// By power, wherever it is asked.
    Power(AliasTable),
    /// By what it brings.
    Tree(LightTree),
}

/// The greatest power that is told from greater ones: the sum of as many as there can be is still finite.
pub(super) const MOST: f64 = 1e290;

/// From so many lights on there is a tree: among three lamps over a floor it already takes most of the variance of the
/// choice away, for two importances a level. The two triangles of a single lamp are seen alike, and have none.
const MANY: usize = 3;

impl Strength {
    /// Of what never shines.
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

    /// Of a triangle that faces to where its corners turn anticlockwise, or the other way if it is `turned`.
    pub fn of_triangle([a, b, c]: [DVec3; 3], turned: bool, radiance: f64, sides: Sides) -> Self {
        let cross = (b - a).cross(c - a);
        let normal = cross.try_normalize().map(|n| if turned { -n } else { n });
        Self::of_shape(0.5 * cross.length(), [a.min(b).min(c), a.max(b).max(c)], normal, radiance, sides)
    }

    /// Of a surface of an area in a box that faces one way, or any.
    pub fn of_shape(area: f64, bounds: [DVec3; 2], facing: Option<DVec3>, radiance: f64, sides: Sides) -> Self {
        if !(area.is_finite() && bounds[0].is_finite() && bounds[1].is_finite()) {
            return Self::NONE;
        }
        // Of what is round, a quarter of the area is seen (Cauchy).
        let seen = if facing.is_some() { 1.0 } else { 0.25 };
        let facing = facing.and_then(|normal| sides.facing(normal));
        let power = PI * area * radiance * sides.count();
        Self { power, bounds: LightBounds::surface(bounds, facing, (seen * area * radiance).min(MOST)) }
    }
}

impl Choice {
    /// Among lights by their strengths; `None` if none is to be chosen.
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

    /// A light for a receiver by a number in [0, 1), and its probability.
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

    /// The same for a lane each.
    pub fn sample_lanes(
        &self,
        level: Level,
        receivers: &LightContextLanes,
        u: &[f64; LANES],
        chosen: &mut [Option<(usize, f64)>; LANES],
    ) {
        match self {
            Self::Power(table) => {
                for lane in 0..LANES {
                    let light = table.sample(u[lane]);
                    chosen[lane] = Some((light, table.probability(light)));
                }
            }
            Self::Tree(tree) => tree.sample_lanes(level, receivers, u, chosen),
        }
    }

    /// The probability of a light.
    #[inline]
    pub fn probability(&self, light: usize, receiver: &LightSampleContext) -> f64 {
        match self {
            Self::Power(table) => table.probability(light),
            Self::Tree(tree) => tree.probability(light, receiver),
        }
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Power(table) => table.bytes(),
            Self::Tree(tree) => tree.bytes(),
        }
    }
}
