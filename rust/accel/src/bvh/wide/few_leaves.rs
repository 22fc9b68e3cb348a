//! Queries for few triangles: sixteen rays at a time visit every leaf that some of them may hit, without any nodes.

use super::WideBvh;
use super::bests::{Bests, are_few};
use super::first::First;
use super::hit_sink::Answer;
use super::node::Packed;
use super::refine_hits::{Refining, Settling};
use super::single;
use super::sixteen::Sixteen;
use super::step::Stacks;
use raywright_base::math::Aabb;
use raywright_base::simd::{Lanes, Simd};
use raywright_shapes::triangle::{ALL, Leaves, Met, RAYS};

/// Maximum numbers of triangles and of leaves; for more, traversal is faster.
pub const TRIANGLES: usize = 64;
const LEAVES: usize = 32;

/// The leaves of a tree and their boxes, if they are few.
pub fn leaves<const N: usize, L: Leaves<N>>(bvh: &WideBvh<N, L>) -> Option<Vec<(Packed, Aabb)>> {
    if bvh.info.primitives > TRIANGLES {
        return None;
    }
    let leaf = |node: usize, lane: usize| (Packed::of(bvh.nodes[node].children[lane]), bvh.nodes[node].aabb(lane));
    let all = (0..bvh.nodes.len()).flat_map(|node| (0..N).map(move |lane| leaf(node, lane)));
    let leaves: Vec<_> = all.filter(|(child, _)| child.kind() == 1).collect();
    (leaves.len() <= LEAVES).then_some(leaves)
}

/// Process all rays with the leaves of the tree.
#[inline(always)]
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
    simd: S,
    bvh: &WideBvh<N, L>,
    leaves: &[(Packed, Aabb)],
    errand: &mut First<'_, A>,
) {
    let batch = errand.rays;
    let sixteen = simd.sixteen();
    let mut lone = Stacks::spare::<N>(bvh.stack);
    let (mut rays, mut bests, mut refining) = (Sixteen::NONE, Bests::NOTHING, Refining::new());
    for start in (0..batch.len()).step_by(RAYS) {
        let count = RAYS.min(batch.len() - start);
        let here = ALL >> (RAYS - count);
        rays.take::<N, L, _>(sixteen, batch, start, &bvh.region, bvh.axes.as_ref());
        let plain = here & rays.plain.plain;
        bests.clear(sixteen, &rays);
        let mut limit = sixteen.load(&rays.slabs.limit);
        for &(leaf, bounds) in leaves {
            let active = plain & !bests.answered & rays.slabs.meeting(sixteen, &bounds, limit);
            if active == 0 {
                continue;
            }
            let from = (batch, start);
            let changed = if are_few(simd, active, leaf) {
                if A::ANY {
                    bests.visit_alone::<true, N, L, S>(simd, bvh, &rays, from, leaf, active)
                } else {
                    bests.visit_alone::<false, N, L, S>(simd, bvh, &rays, from, leaf, active)
                }
            } else {
                let (first, count) = leaf.leaf();
                let triangles = bvh.leaves.spread(simd, &rays.blocks, first, count);
                if A::ANY {
                    bests.visit::<true, N, L, S>(simd, bvh, &rays, from, &triangles, leaf, active)
                } else {
                    bests.visit::<false, N, L, S>(simd, bvh, &rays, from, &triangles, leaf, active)
                }
            };
            if A::ANY {
                bests.answered |= changed;
                if bests.answered == plain {
                    break;
                }
            } else if changed != 0 {
                limit = bests.limits(sixteen, bvh.region.scale / L::unit(&bvh.region), changed, limit);
            }
        }
        if A::ANY {
            errand.answer.some(start, count, bests.answered, &Met::NONE, &[0; RAYS]);
        } else {
            refining.settle(sixteen, bvh, batch, start, count, &bests, errand.answer);
        }
        let mut others = here & !plain;
        while others != 0 {
            let i = others.trailing_zeros() as usize;
            others &= others - 1;
            single::ask(simd, bvh, batch, start + i, errand, &mut lone);
        }
    }
    lone.put_away();
    errand.winners.settle(sixteen, bvh, batch, errand.answer);
}
