//! Patches between non-manifold edges: walls within bodies.

use super::edges::EdgeAdjacency;
use std::collections::HashMap;

/// Duplicated faces that do not belong to any surface. These form components of faces that occur an even number of
/// times. A component is returned if most of its edges shared with other faces have an odd face count with it, and an
/// even one without. A wall between two bodies qualifies; the surface of a mesh with every face in both orientations
/// does not.
pub fn doubled(edges: &EdgeAdjacency, is_copied: &[bool]) -> Vec<u32> {
    if !is_copied.contains(&true) {
        return Vec::new();
    }
    let parts = edges.joined(|_, face| is_copied[face as usize]);
    // Per component: number of odd shared edges minus even ones.
    let mut odd = vec![0i64; is_copied.len()];
    for edge in 0..edges.ends.len() as u32 {
        if edges.faces_at(edge).all(|face| is_copied[face as usize]) {
            continue;
        }
        for face in edges.faces_at(edge).filter(|&face| is_copied[face as usize]) {
            odd[parts[face as usize] as usize] += if edges.count(edge) % 2 == 1 { 1 } else { -1 };
        }
    }
    let is_doubled = |&face: &u32| is_copied[face as usize] && odd[parts[face as usize] as usize] > 0;
    (0..is_copied.len() as u32).filter(is_doubled).collect()
}

/// Faces of walls within bodies. Patches are components across edges with two faces, processed in order of area. A
/// patch is removed if most of its shared edges have an odd face count with it and an even one without. A wall that
/// spans a rim within a body has less area than the surface around it.
pub fn partitions(edges: &EdgeAdjacency, area: impl Fn(u32) -> f64) -> Vec<u32> {
    if edges.odd().next().is_none() {
        return Vec::new();
    }
    let parts = edges.joined(|edge, _| edges.count(edge) == 2);
    let mut counts: Vec<u32> = (0..edges.ends.len() as u32).map(|edge| edges.count(edge)).collect();
    let is_shared = |edge: &u32| edges.count(*edge) != 2;
    let mut patches: HashMap<u32, (f64, Vec<u32>)> = HashMap::new();
    for face in (0..parts.len() as u32).filter(|&face| edges.is_left(face)) {
        let (total, faces) = patches.entry(parts[face as usize]).or_default();
        *total += area(face);
        faces.push(face);
    }
    let mut patches: Vec<(f64, Vec<u32>)> = patches.into_values().collect();
    patches.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    let mut walls = Vec::new();
    for (_, faces) in patches {
        let rim = || faces.iter().flat_map(|&face| edges.of_face(face)).filter(is_shared);
        let (odd, even): (Vec<u32>, Vec<u32>) = rim().partition(|&edge| counts[edge as usize] % 2 == 1);
        if odd.len() > even.len() {
            rim().for_each(|edge| counts[edge as usize] -= 1);
            walls.extend(faces);
        }
    }
    walls
}
