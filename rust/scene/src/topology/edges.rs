//! Edge-face adjacency.

use std::collections::HashMap;

/// Numbered edges with their adjacent faces; faces can be removed.
#[derive(Clone, Debug)]
pub struct EdgeAdjacency {
    /// Lower and higher corner number of each edge.
    pub ends: Vec<[u32; 2]>,
    /// Edges of each face: those of face `i` from `first[i]` to `first[i + 1]`.
    sides: Vec<DirectedEdge>,
    first: Vec<u32>,
    /// Faces at each edge, stored alike, and the number of them that remain.
    faces: Vec<u32>,
    first_at: Vec<u32>,
    counts: Vec<u32>,
    is_left: Vec<bool>,
}

/// An edge of a face; true if the face traverses it from the lower corner number to the higher.
#[derive(Clone, Copy, Debug)]
struct DirectedEdge {
    edge: u32,
    is_forward: bool,
}

impl EdgeAdjacency {
    /// Builds the adjacency of faces. Edges with corners within them are cut there; `chains` lists these corners from
    /// the lower end to the higher.
    pub fn new(faces: impl Iterator<Item = [u32; 3]>, chains: &HashMap<[u32; 2], Vec<u32>>) -> Self {
        let (mut pieces, mut first): (Vec<([u32; 2], u32, u32)>, _) = (Vec::new(), vec![0]);
        let mut is_forward = Vec::new();
        let mut add = |face: usize, a: u32, b: u32| {
            pieces.push(([a.min(b), a.max(b)], pieces.len() as u32, face as u32));
            is_forward.push(a < b);
            pieces.len() as u32
        };
        for (face, [a, b, c]) in faces.enumerate() {
            let mut end = 0;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let key = [from.min(to), from.max(to)];
                let within = if chains.is_empty() { None } else { chains.get(&key) };
                let mut last = from;
                for i in 0..within.map_or(0, Vec::len) {
                    let within = within.map_or(&[][..], Vec::as_slice);
                    let next = if from < to { within[i] } else { within[within.len() - 1 - i] };
                    add(face, last, next);
                    last = next;
                }
                end = add(face, last, to);
            }
            first.push(end);
        }
        pieces.sort_unstable();
        let mut sides = vec![DirectedEdge { edge: 0, is_forward: false }; pieces.len()];
        let (mut ends, mut first_at): (Vec<[u32; 2]>, _) = (Vec::new(), vec![0]);
        for same in pieces.chunk_by(|a, b| a.0 == b.0) {
            for &(_, side, _) in same {
                sides[side as usize] = DirectedEdge { edge: ends.len() as u32, is_forward: is_forward[side as usize] };
            }
            ends.push(same[0].0);
            first_at.push(first_at[first_at.len() - 1] + same.len() as u32);
        }
        let faces = pieces.iter().map(|&(.., face)| face).collect();
        let counts = first_at.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let is_left = vec![true; first.len() - 1];
        Self { ends, sides, first, faces, first_at, counts, is_left }
    }

    /// Number of remaining faces at an edge.
    pub fn count(&self, edge: u32) -> u32 {
        self.counts[edge as usize]
    }

    /// Returns whether a face remains.
    pub fn is_left(&self, face: u32) -> bool {
        self.is_left[face as usize]
    }

    /// Edges with an odd number of remaining faces.
    pub fn odd(&self) -> impl Iterator<Item = u32> {
        (0..self.ends.len() as u32).filter(|&edge| self.counts[edge as usize] % 2 == 1)
    }

    /// Remaining faces at an edge.
    pub fn faces_at(&self, edge: u32) -> impl Iterator<Item = u32> {
        let [from, to] = [0, 1].map(|i| self.first_at[edge as usize + i] as usize);
        self.faces[from..to].iter().copied().filter(|&face| self.is_left(face))
    }

    /// Edges of a face.
    pub fn of_face(&self, face: u32) -> impl Iterator<Item = u32> {
        self.along(face).iter().map(|side| side.edge)
    }

    fn along(&self, face: u32) -> &[DirectedEdge] {
        let [from, to] = [0, 1].map(|i| self.first[face as usize + i] as usize);
        &self.sides[from..to]
    }

    /// Number of faces that traverse an edge forwards, minus those that traverse it backwards.
    pub fn balance(&self, edge: u32) -> i32 {
        let run = |face: u32| -> i32 {
            let here = self.along(face).iter().filter(|side| side.edge == edge);
            here.map(|side| if side.is_forward { 1 } else { -1 }).sum()
        };
        self.faces_at(edge).map(run).sum()
    }

    /// Returns whether an edge has two faces that traverse it in the same direction.
    pub fn is_turned(&self, edge: u32) -> bool {
        self.count(edge) == 2 && self.balance(edge) != 0
    }

    /// Removes a face.
    pub fn remove(&mut self, face: u32) {
        self.is_left[face as usize] = false;
        let [from, to] = [0, 1].map(|i| self.first[face as usize + i] as usize);
        for side in &self.sides[from..to] {
            self.counts[side.edge as usize] -= 1;
        }
    }

    /// Repeatedly removes faces with an edge of their own, until none is left.
    pub fn peel(&mut self) {
        let mut alone: Vec<u32> = (0..self.ends.len() as u32).filter(|&edge| self.count(edge) == 1).collect();
        while let Some(edge) = alone.pop() {
            let Some(face) = self.faces_at(edge).next() else { continue };
            self.remove(face);
            let left: Vec<u32> = self.of_face(face).filter(|&edge| self.count(edge) == 1).collect();
            alone.extend(left);
        }
    }

    /// Connected components: for each face, the first face of its component.
    pub fn parts(&self) -> Vec<u32> {
        self.joined(|_, _| true)
    }

    /// Connected components across the edge-face pairs that `counts` accepts.
    pub fn joined(&self, counts: impl Fn(u32, u32) -> bool) -> Vec<u32> {
        let mut parents: Vec<u32> = (0..self.is_left.len() as u32).collect();
        for edge in 0..self.ends.len() as u32 {
            let mut faces = self.faces_at(edge).filter(|&face| counts(edge, face));
            let Some(one) = faces.next() else { continue };
            for other in faces {
                let [a, b] = [one, other].map(|face| root(&mut parents, face));
                parents[a.max(b) as usize] = a.min(b);
            }
        }
        (0..parents.len() as u32).map(|face| root(&mut parents, face)).collect()
    }
}

/// The representative of a face's component, with path halving.
pub fn root(parents: &mut [u32], mut face: u32) -> u32 {
    while parents[face as usize] != face {
        let above = parents[parents[face as usize] as usize];
        parents[face as usize] = above;
        face = above;
    }
    face
}
