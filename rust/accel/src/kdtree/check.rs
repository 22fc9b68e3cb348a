//! Validation of kd-trees.

use super::KdTree;
use crate::walk::{Input, PartPosition, PrimitivePart};
use raywright_base::math::Aabb;

/// Check a tree, given the primitives of each leaf; the error describes the violation.
///
/// Each pair of children follows its parent, and has only one. Planes are inside the cells that they split, and no leaf
/// is deeper than recorded. Each primitive is in all leaves whose cells it overlaps, clipped at every plane as in the
/// build.
pub fn check(tree: &KdTree, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
    let (parts, bounds) = input.parts();
    if bounds != tree.bounds {
        return Err(format!("the bounding box is {bounds:?}, expected {:?}", tree.bounds));
    }
    let mut parents = vec![0u32; tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate().filter(|&(i, n)| i != 1 && !n.is_leaf()) {
        let children = node.children() as usize;
        if children <= i || !children.is_multiple_of(2) || children + 1 >= tree.nodes.len() {
            return Err(format!("node {i} of {} has children {children}", tree.nodes.len()));
        }
        parents[children] += 1;
    }
    if let Some(i) = (2..parents.len()).step_by(2).find(|&i| parents[i] != 1) {
        return Err(format!("node {i} has {} parents", parents[i]));
    }
    let mut depth = 0;
    let mut numbers = Vec::new();
    for cell in tree.cells() {
        depth = depth.max(cell.depth);
        match tree.plane(cell.node) {
            Some((plane, _)) if !plane.is_within(&cell.aabb) => {
                return Err(format!("node {} has {plane:?} in {:?}", cell.node, cell.aabb));
            }
            Some(_) => {}
            None if tree.nodes[cell.node].count() > 0 => numbers.push(tree.nodes[cell.node].number()),
            None => {}
        }
    }
    if depth != tree.depth {
        return Err(format!("depth is {depth}, not {}", tree.depth));
    }
    numbers.sort_unstable();
    if let Some((leaf, number)) = (0..).zip(&numbers).find(|(leaf, number)| leaf != *number) {
        return Err(format!("leaf {leaf} has the number {number}"));
    }
    let mut lists: Vec<Vec<u32>> = numbers.iter().map(|&leaf| primitives(leaf)).collect();
    for node in tree.nodes.iter().filter(|n| n.is_leaf() && n.count() > 0) {
        let list = &mut lists[node.number() as usize];
        if list.len() != node.count() as usize {
            return Err(format!("leaf {} has {} primitives, not {}", node.number(), list.len(), node.count()));
        }
        list.sort_unstable();
    }
    match parts.into_iter().find(|&part| !stands(tree, input, &lists, 0, part)) {
        Some(part) => Err(format!("primitive {} is missing from a leaf", part.primitive)),
        None => Ok(()),
    }
}

/// Return whether a part is in all the leaves it overlaps below a node.
fn stands(tree: &KdTree, input: &Input, lists: &[Vec<u32>], node: usize, part: PrimitivePart) -> bool {
    if part.aabb.is_empty() {
        return true;
    }
    let Some((plane, children)) = tree.plane(node) else {
        let leaf = tree.nodes[node];
        return leaf.count() > 0 && lists[leaf.number() as usize].binary_search(&part.primitive).is_ok();
    };
    let on = |side: usize, aabb: Aabb| stands(tree, input, lists, children + side, PrimitivePart { aabb, ..part });
    match part.halves(input, plane) {
        PartPosition::Below => on(0, part.aabb),
        PartPosition::Above => on(1, part.aabb),
        PartPosition::Within => on(0, part.aabb) || on(1, part.aabb),
        PartPosition::Both([below, above]) => on(0, below) && on(1, above),
    }
}
