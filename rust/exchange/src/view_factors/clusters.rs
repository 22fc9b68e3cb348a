//! A tree of face clusters, by position and orientation.

use super::facet::Facet;
use raywright_base::math::DVec3;

/// Maximum number of faces in a leaf.
const LEAF: usize = 8;

/// A cluster of faces, consecutive in [`Clusters::order`].
#[derive(Clone, Copy, Debug)]
pub struct Cluster {
    /// The min corner of its bounding box.
    pub low: DVec3,
    /// The max corner.
    pub high: DVec3,
    /// The index of the first face.
    pub first: u32,
    /// The number of faces.
    pub count: u32,
    /// The index of the first of two adjacent children; 0 for a leaf.
    pub parts: u32,
}

/// The cluster tree.
#[derive(Debug)]
pub struct Clusters {
    /// The nodes, root first.
    pub nodes: Vec<Cluster>,
    /// The faces in the order of the clusters.
    pub order: Vec<u32>,
}

impl Cluster {
    /// The corners of its box.
    pub fn corners(&self) -> [DVec3; 8] {
        let pick = |i: usize, bit: usize, k: usize| if i >> bit & 1 == 0 { self.low[k] } else { self.high[k] };
        std::array::from_fn(|i| DVec3::new(pick(i, 0, 0), pick(i, 1, 1), pick(i, 2, 2)))
    }

    /// Return whether it is a leaf.
    pub fn is_leaf(&self) -> bool {
        self.parts == 0
    }
}

impl Clusters {
    /// Build a tree of some faces, split at the median of the center or normal coordinate with the greatest spread.
    pub fn new(facets: &[Facet], of: Vec<u32>) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: of };
        if tree.order.is_empty() {
            return tree;
        }
        let (low, high) = around(facets, &tree.order);
        // Normals are scaled so that the sides of a box are separated before they are split.
        let turn = (high - low).max_element();
        tree.nodes.push(Cluster { low, high, first: 0, count: tree.order.len() as u32, parts: 0 });
        let mut next = 0;
        while next < tree.nodes.len() {
            tree.part(facets, next, turn);
            next += 1;
        }
        tree
    }

    fn part(&mut self, facets: &[Facet], node: usize, turn: f64) {
        let Cluster { first, count, .. } = self.nodes[node];
        if count as usize <= LEAF {
            return;
        }
        let faces = &mut self.order[first as usize..(first + count) as usize];
        let key = |face: u32, k: usize| {
            let facet = &facets[face as usize];
            if k < 3 { facet.centre[k] } else { facet.normal[k - 3] * turn }
        };
        let spread = |k: usize| {
            let ends = faces.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &face| {
                [low.min(key(face, k)), high.max(key(face, k))]
            });
            ends[1] - ends[0]
        };
        let widest = (0..6).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(0);
        let half = count / 2;
        // The number breaks ties, so that the tree is deterministic.
        faces.select_nth_unstable_by(half as usize, |&a, &b| key(a, widest).total_cmp(&key(b, widest)).then(a.cmp(&b)));
        self.nodes[node].parts = self.nodes.len() as u32;
        for (first, count) in [(first, half), (first + half, count - half)] {
            let (low, high) = around(facets, &self.order[first as usize..(first + count) as usize]);
            self.nodes.push(Cluster { low, high, first, count, parts: 0 });
        }
    }

    /// The faces of a node.
    pub fn faces(&self, node: &Cluster) -> &[u32] {
        &self.order[node.first as usize..(node.first + node.count) as usize]
    }

    /// The children of an inner node.
    pub fn parts(&self, node: &Cluster) -> [&Cluster; 2] {
        [&self.nodes[node.parts as usize], &self.nodes[node.parts as usize + 1]]
    }
}

fn around(facets: &[Facet], faces: &[u32]) -> (DVec3, DVec3) {
    faces
        .iter()
        .flat_map(|&face| facets[face as usize].corners)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), corner| (low.min(corner), high.max(corner)))
}
