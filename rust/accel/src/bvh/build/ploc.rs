//! Bottom-up build by parallel locally-ordered clustering (Meister and Bittner, "Parallel Locally-Ordered Clustering
//! for Bounding Volume Hierarchy Construction", 2018).
//!
//! Clusters are in Morton order, initially of one primitive each. In every round each cluster finds the neighbor
//! within a radius with which it forms the smallest box. Mutual nearest neighbors merge. Ties are broken by the
//! positions alone, in the same way for both partners. So at least one pair merges per round, all of them do for
//! coincident primitives, and the result does not depend on threads.
//!
//! In a chain of scales only one pair merges per round. After more rounds than any reasonable scene takes, adjacent
//! clusters are paired, which bounds time and depth.

use super::morton::{self, Bits};
use super::reference::{Bounds, Reference, references};
use super::slices::{self, Opened, Subtree};
use super::{BinaryBvh, spare};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;
use std::ops::Range;

/// Options of the clustering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// The search radius in Morton order, from 1 to [`MAX_RADIUS`].
    pub radius: usize,
}

/// Maximum search radius.
pub const MAX_RADIUS: usize = 128;

/// The radius that the authors recommend.
pub const RADIUS: usize = 14;

/// Clusters per parallel task.
const SHARE: usize = 1 << 12;

/// Build a tree over boxes, skipping empty ones. Leaves have one primitive each; blocks are formed when the tree is
/// collapsed.
///
/// # Panics
///
/// If the radius is out of range.
pub fn build<'a>(boxes: impl Into<Cow<'a, [Aabb]>>, options: &Options, work: Work) -> Result<BinaryBvh, Stopped> {
    let Options { radius } = *options;
    assert!((1..=MAX_RADIUS).contains(&radius), "radius is {radius}, not from 1 to {MAX_RADIUS}");
    let [gather, sort, merge, write] = work.parts([1.0, 8.0, 30.0, 10.0]);
    let mut sorted = references(boxes, gather)?;
    if sorted.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let codes = morton::sorted(&sorted, Bits::SixtyThree, sort)?;
    sorted = parallel::collect(codes.len(), |i| sorted[codes[i].1 as usize]);
    drop(codes);
    let count = sorted.len();
    let cluster = |i: usize| Cluster { bounds: sorted[i].bounds, link: i as u32, count: 1 };
    let mut clusters = parallel::collect(count, cluster);
    let mut pairs = Vec::with_capacity(count - 1);
    let (mut rounds, steps) = (spare(count), merge.steps(count));
    while clusters.len() > 1 {
        let before = clusters.len();
        let sought = if rounds > 0 { nearest(&clusters, radius) } else { beside(clusters.len()) };
        clusters = merged(&clusters, &sought, count, &mut pairs);
        rounds = rounds.saturating_sub(1);
        steps.did(before - clusters.len())?;
    }
    slices::write(Merged { link: clusters[0].link, leaves: &sorted, pairs: &pairs }, count, write)
}

/// A cluster of primitives, which is a subtree.
#[derive(Clone, Copy)]
struct Cluster {
    bounds: Bounds,
    /// The index of a single primitive; for a pair, its index among the pairs plus the number of primitives.
    link: u32,
    /// The number of primitives.
    count: u32,
}

/// A merged pair: the links of both, and the number of primitives in the first.
struct ClusterPair {
    links: [u32; 2],
    first: u32,
}

/// A neighbor and its distance.
#[derive(Clone, Copy)]
struct Neighbour {
    area: f32,
    /// Breaks ties of areas, lower ranks first: adjacent clusters that would be paired in a forced round, then those at
    /// a smaller distance, then earlier ones.
    rank: u64,
    place: u32,
}

impl Neighbour {
    const NONE: Self = Self { area: f32::INFINITY, rank: u64::MAX, place: u32::MAX };

    #[inline(always)]
    fn offer(&mut self, other: Self) {
        if other.area < self.area || (other.area == self.area && other.rank < self.rank) {
            *self = other;
        }
    }
}

/// The nearest neighbor of each cluster, among at least two.
fn nearest(clusters: &[Cluster], radius: usize) -> Vec<u32> {
    let mut sought = vec![0; clusters.len()];
    parallel::each_chunk_mut(&mut sought, SHARE, &|start, sought| {
        let own = start..start + sought.len();
        let mut found = vec![Neighbour::NONE; own.len()];
        // Each pair is evaluated once, unless two tasks share it.
        for a in start.saturating_sub(radius)..own.end {
            let bounds = clusters[a].bounds;
            for b in (a + 1).max(start)..(a + radius + 1).min(clusters.len()) {
                // Infinite boxes may give NaN.
                let area = bounds.union(&clusters[b].bounds).half_area().min(f32::MAX);
                let rank = if a ^ 1 == b { a as u64 } else { ((b - a) as u64) << 32 | a as u64 };
                for (one, other) in [(a, b), (b, a)] {
                    if own.contains(&one) {
                        found[one - start].offer(Neighbour { area, rank, place: other as u32 });
                    }
                }
            }
        }
        sought.iter_mut().zip(found).for_each(|(sought, found)| *sought = found.place);
    });
    sought
}

/// The partner of each cluster if adjacent ones are paired; itself if it has none.
fn beside(count: usize) -> Vec<u32> {
    (0..count).map(|place| if place ^ 1 < count { place ^ 1 } else { place } as u32).collect()
}

/// The clusters after merging mutual nearest neighbors, each at the position of its first member.
fn merged(clusters: &[Cluster], sought: &[u32], leaves: usize, pairs: &mut Vec<ClusterPair>) -> Vec<Cluster> {
    let agree = |place: usize| sought[sought[place] as usize] as usize == place && sought[place] as usize != place;
    let is_first = |place: &usize| agree(*place) && *place < sought[*place] as usize;
    let made = parallel::map_chunks(clusters.len(), SHARE, |share| share.filter(is_first).count());
    let before = made.iter().scan(leaves + pairs.len(), |next, made| {
        *next += made;
        Some(*next - made)
    });
    let before: Vec<usize> = before.collect();
    let of_share = |places: Range<usize>| {
        let share = places.start / SHARE;
        let (mut left, mut new) = (Vec::with_capacity(SHARE), Vec::with_capacity(made[share]));
        for place in places {
            let cluster = clusters[place];
            if !agree(place) {
                left.push(cluster);
            } else if is_first(&place) {
                let other = clusters[sought[place] as usize];
                left.push(Cluster {
                    bounds: cluster.bounds.union(&other.bounds),
                    link: (before[share] + new.len()) as u32,
                    count: cluster.count + other.count,
                });
                new.push(ClusterPair { links: [cluster.link, other.link], first: cluster.count });
            }
        }
        (left, new)
    };
    let done = parallel::map_chunks(clusters.len(), SHARE, of_share);
    let mut left = Vec::with_capacity(clusters.len() - made.iter().sum::<usize>());
    for (of_share, new) in done {
        left.extend(of_share);
        pairs.extend(new);
    }
    left
}

/// The subtree below a link.
#[derive(Clone, Copy)]
struct Merged<'a> {
    link: u32,
    leaves: &'a [Reference],
    pairs: &'a [ClusterPair],
}

impl Subtree for Merged<'_> {
    fn open(self) -> Opened<Self> {
        match self.leaves.get(self.link as usize) {
            Some(leaf) => Opened::Leaf(leaf.bounds.aabb(), leaf.primitive()),
            None => {
                let ClusterPair { links: [left, right], first } = self.pairs[self.link as usize - self.leaves.len()];
                Opened::Pair(Self { link: left, ..self }, Self { link: right, ..self }, first as usize)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::Vec3;

    #[test]
    fn pairs_that_are_near_come_first() {
        // Two close pairs, in an order that the codes do not reveal.
        let boxes =
            [0.0, 0.1, 7.0, 7.1].map(|x: f32| Aabb::around([Vec3::new(x, 0.0, 0.0), Vec3::new(x + 0.05, 1.0, 1.0)]));
        let bvh = build(&boxes, &Options { radius: RADIUS }, Work::UNWATCHED).unwrap();
        bvh.validate(&boxes).unwrap();
        let [left, right] = bvh.nodes[0].children().map(|child| bvh.nodes[child].aabb());
        assert_eq!([left, right], [boxes[0].union(boxes[1]), boxes[2].union(boxes[3])]);
    }

    #[test]
    fn coinciding_boxes_make_a_tree_of_least_depth() {
        let boxes = vec![Aabb::around([Vec3::ONE]); 1 << 14];
        let bvh = build(boxes, &Options { radius: RADIUS }, Work::UNWATCHED).unwrap();
        assert_eq!(bvh.depth(), 14);
    }
}
