//! Packets of four rays, one per lane: a box is tested against all of them at once (Wald, Slusallek, Benthin and
//! Wagner, "Interactive Rendering with Coherent Ray Tracing", 2001). Rays that miss are masked. The majority decides
//! which child comes first, so results for incoherent rays are correct, but slower.

use super::numbered_leaves::Numbered;
use super::ray_columns::Columns;
use crate::SlabRay;
use crate::walk::{MOST_TOGETHER, Together};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd};

/// Rays in a packet.
const WIDTH: usize = 4;

/// Create a traversal with packets of four rays.
pub fn walk(tree: &Numbered, counted: bool, level: Level) -> Box<dyn Together + '_> {
    // A path leaves one sibling per level.
    let (rays, stack) = (Columns::NONE, Vec::with_capacity(tree.depth + 1));
    if counted {
        Box::new(PacketTraversal::<true> { tree, level, rays, stack, nodes: [0; WIDTH] })
    } else {
        Box::new(PacketTraversal::<false> { tree, level, rays, stack, nodes: [0; WIDTH] })
    }
}

struct PacketTraversal<'a, const COUNTED: bool> {
    tree: &'a Numbered,
    level: Level,
    rays: Columns<WIDTH>,
    stack: Vec<PacketEntry>,
    nodes: [u32; WIDTH],
}

/// A node that some rays hit.
#[derive(Clone, Copy)]
struct PacketEntry {
    /// The `t` at which they enter it.
    enter: [f32; WIDTH],
    node: u32,
    /// The mask of these rays.
    rays: u32,
}

impl<const COUNTED: bool> Together for PacketTraversal<'_, COUNTED> {
    fn width(&self) -> usize {
        WIDTH
    }

    fn start(&mut self, rays: &[SlabRay]) {
        self.rays.fill(rays);
        self.stack.clear();
        self.nodes = [0; WIDTH];
        if !self.tree.nodes.is_empty() {
            self.level.dispatch(Begin { walk: self, rays: rays.len() });
        }
    }

    fn next(&mut self, limits: &[f32; MOST_TOGETHER]) -> Option<(u32, u64)> {
        let [a, b, c, d, ..] = *limits;
        self.level.dispatch(PacketStep { walk: self, limits: &[a, b, c, d] })
    }

    fn nodes(&self, ray: usize) -> u32 {
        self.nodes[ray]
    }
}

impl<const COUNTED: bool> PacketTraversal<'_, COUNTED> {
    /// Count box tests for some rays.
    #[inline(always)]
    fn count(&mut self, rays: u32, boxes: u32) {
        if COUNTED {
            for (i, nodes) in self.nodes.iter_mut().enumerate() {
                *nodes += boxes * (rays >> i & 1);
            }
        }
    }

    /// Push a node if any ray hits it.
    #[inline(always)]
    fn push<S: Simd<WIDTH>>(&mut self, simd: S, node: u32, from: S::F32, rays: u32) {
        if rays != 0 {
            let mut enter = [0.0; WIDTH];
            simd.store(from, &mut enter);
            self.stack.push(PacketEntry { enter, node, rays });
        }
    }
}

/// Tests the root.
struct Begin<'w, 'a, const COUNTED: bool> {
    walk: &'w mut PacketTraversal<'a, COUNTED>,
    rays: usize,
}

impl<const COUNTED: bool> Kernel<WIDTH> for Begin<'_, '_, COUNTED> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<WIDTH>>(self, simd: S) {
        let Self { walk, rays } = self;
        let all = (1 << rays) - 1;
        walk.count(all, 1);
        let (enter, met) = walk.rays.meet(simd, 0, &walk.tree.nodes[0], &[f32::INFINITY; WIDTH]);
        walk.push(simd, 0, enter, met & all);
    }
}

/// Advances to the next leaf.
struct PacketStep<'w, 'a, const COUNTED: bool> {
    walk: &'w mut PacketTraversal<'a, COUNTED>,
    limits: &'w [f32; WIDTH],
}

impl<const COUNTED: bool> Kernel<WIDTH> for PacketStep<'_, '_, COUNTED> {
    type Output = Option<(u32, u64)>;

    #[inline(always)]
    fn run<S: Simd<WIDTH>>(self, simd: S) -> Option<(u32, u64)> {
        let Self { walk, limits } = self;
        let nodes = walk.tree.nodes.as_slice();
        let limit = simd.load(limits);
        while let Some(entry) = walk.stack.pop() {
            let mut rays = entry.rays & simd.le(simd.load(&entry.enter), limit);
            let mut at = entry.node;
            while rays != 0 {
                let node = &nodes[at as usize];
                if node.is_leaf() {
                    return Some((node.index, u64::from(rays)));
                }
                walk.count(rays, 2);
                let [a, b] = [node.index, node.index + 1];
                let (enter_a, met_a) = walk.rays.meet(simd, 0, &nodes[a as usize], limits);
                let (enter_b, met_b) = walk.rays.meet(simd, 0, &nodes[b as usize], limits);
                let (met_a, met_b) = (met_a & rays, met_b & rays);
                let both = met_a & met_b;
                let a_first = (simd.le(enter_a, enter_b) & both).count_ones();
                // For a ray that hits only one of them the order is irrelevant.
                (at, rays) = if met_b == 0 || met_a != 0 && 2 * a_first >= both.count_ones() {
                    walk.push(simd, b, enter_b, met_b);
                    (a, met_a)
                } else {
                    walk.push(simd, a, enter_a, met_a);
                    (b, met_b)
                };
            }
        }
        None
    }
}
