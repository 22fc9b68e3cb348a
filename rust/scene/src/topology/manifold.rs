//! Fast path for oriented manifold meshes: every edge has two faces that traverse it in opposite directions.

use super::edges::root;

/// Connected components in linear time: for each face, the first face of its component. Returns `None` if a face
/// repeats a corner, an edge has not exactly two opposite faces, or two faces have the same corners.
pub fn parts(faces: &[[u32; 3]], corners: usize) -> Option<Vec<u32>> {
    if faces.len() >= 1 << 31 || faces.iter().any(|&[a, b, c]| a == b || b == c || c == a) {
        return None;
    }
    let edges = || faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    // Edges are stored at their lower corner number: those of corner `i` from `first[i]` to `first[i + 1]` once filled
    // in.
    let mut first = vec![0u32; corners + 2];
    edges().for_each(|(from, to)| first[from.min(to) as usize + 2] += 1);
    for i in 2..first.len() {
        first[i] += first[i - 1];
    }
    let mut sides = vec![(0, 0); 3 * faces.len()];
    for (i, (from, to)) in edges().enumerate() {
        let next = &mut first[from.min(to) as usize + 1];
        sides[*next as usize] = (from.max(to), 2 * (i as u32 / 3) + u32::from(from < to));
        *next += 1;
    }
    let mut parents: Vec<u32> = (0..faces.len() as u32).collect();
    for ends in first[..=corners].windows(2) {
        let own = &mut sides[ends[0] as usize..ends[1] as usize];
        own.sort_unstable();
        for pair in own.chunk_by(|a, b| a.0 == b.0) {
            let &[(_, one), (_, other)] = pair else { return None };
            if (one ^ other) & 1 == 0 {
                return None;
            }
            let [a, b] = [one / 2, other / 2].map(|face| root(&mut parents, face));
            parents[a.max(b) as usize] = a.min(b);
        }
    }
    let (parts, mut sizes): (Vec<u32>, _) =
        ((0..faces.len() as u32).map(|face| root(&mut parents, face)).collect(), vec![0u32; faces.len()]);
    parts.iter().for_each(|&part| sizes[part as usize] += 1);
    // Two faces that share all their edges form a component of size 2.
    (!sizes.contains(&2)).then_some(parts)
}
