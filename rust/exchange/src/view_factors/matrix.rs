//! The full matrix of view factors: pairs of clusters with potential blockers, down to pairs of faces.

use super::balance::Balance;
use super::clusters::{Cluster, Clusters};
use super::coincident::overlap;
use super::distant::Quadrature;
use super::facet::Facet;
use super::hit_fronts::Fronts;
use super::pair::pair;
use super::partly_visible_pairs::Open;
use super::proportion_error::Counts;
use super::ray_rounds::{FAINT, Rounds};
use super::row_sampler::{Entry, RowSampler};
use super::shaft::{Blocker, HalfSpace, between_boxes, between_facets, hides};
use super::{Aim, Sampled, areas, facets};
use raywright_base::parallel;
use raywright_base::simd::Level;
use raywright_base::work::{Steps, Stopped, Work};
use raywright_scene::Scene;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// View factors between all faces of a scene.
#[derive(Debug, Default)]
pub struct Matrix {
    /// The factors, row by row.
    pub factors: Vec<f64>,
    /// The sampled entries and their errors.
    pub sampled: Vec<Sampled>,
    /// Numbers of pairs in closed form, certainly hidden pairs, and ray-traced pairs.
    pub counts: [u64; 3],
    /// The number of rays traced.
    pub rays: u64,
    /// True if each row was sampled and belongs to a closed room.
    pub closed: Vec<bool>,
}

/// Compute all view factors of a scene. Degenerate faces have factors of 0.
pub fn matrix(scene: &Scene, aim: &Aim, work: Work) -> Result<Matrix, Stopped> {
    let facets = facets(scene);
    let count = facets.len();
    let sending = (0..count as u32).filter(|&i| facets[i as usize].area > 0.0).collect();
    let tree = Clusters::new(&facets, sending);
    let [visits, rays] = work.parts([3.0, 2.0]);
    let all = Everything {
        scene,
        facets: &facets,
        tree: &tree,
        blockers: blockers(scene, &facets, &tree),
        fronts: Fronts::new(scene),
        aim,
        level: Level::current().unwrap_or(Level::Scalar),
        steps: visits.steps(count * count),
        factors: parallel::collect(count * count, |_| AtomicU64::new(0)),
        open: Mutex::default(),
        counts: Default::default(),
        rays: AtomicU64::new(0),
    };
    if let Some(root) = tree.nodes.first() {
        let may_hide: Vec<u32> = (0..all.blockers.len() as u32).collect();
        all.visit(root, root, &may_hide);
    }
    let areas = areas(scene);
    let mut sampled = all.curved(&areas)?;
    visits.goes_on()?;
    all.sampled(&mut sampled, &areas, rays)?;
    sampled.sort_unstable_by_key(|sampled| sampled.faces);
    let [closed, hidden, _] = all.counts.map(AtomicU64::into_inner);
    let mut made = Matrix {
        factors: all.factors.into_iter().map(|bits| f64::from_bits(bits.into_inner())).collect(),
        counts: [closed, hidden, sampled.len() as u64],
        rays: all.rays.into_inner(),
        ..Matrix::default()
    };
    for estimate in &sampled {
        made.write(estimate, &areas);
    }
    if !sampled.is_empty() {
        let (facets, fronts, areas, seed) = (&facets[..], &all.fronts, &areas[..], aim.seed);
        let balanced = Balance { scene, fronts, facets, areas, factors: &made.factors, seed }.apply(&mut sampled);
        made.rays += balanced.rays;
        made.closed = balanced.closed;
        sampled.iter().for_each(|estimate| made.write(estimate, areas));
    }
    made.closed.resize(count, false);
    made.sampled = sampled;
    work.goes_on()?;
    work.done();
    Ok(made)
}

impl Matrix {
    /// Store an estimate in both rows.
    fn write(&mut self, estimate: &Sampled, areas: &[f64]) {
        let [i, j] = estimate.faces.map(|face| face as usize);
        self.factors[i * areas.len() + j] = estimate.value / areas[i];
        self.factors[j * areas.len() + i] = estimate.value / areas[j];
    }
}

/// The potential blockers: all faces except those whose plane has the whole scene on one side, as in a convex room.
fn blockers(scene: &Scene, facets: &[Facet], tree: &Clusters) -> Vec<Blocker> {
    let geometry = scene.geometry();
    let curved: Vec<u32> = (0..facets.len() as u32).filter(|&i| geometry.shape(i).is_some()).collect();
    let parts = |facet: &Facet| {
        let mut sides = [false; 2];
        for &i in &curved {
            let shape = geometry.shape(i);
            let height = facet.normal.dot(facet.centre);
            sides[0] |= shape.is_none_or(|shape| shape.support(facet.normal) > height);
            sides[1] |= shape.is_none_or(|shape| -shape.support(-facet.normal) < height);
        }
        for some in tree.order.chunks(16) {
            let [front, back] = facet.sides(some.iter().flat_map(|&i| facets[i as usize].corners));
            sides = [sides[0] || front, sides[1] || back];
            if sides == [true, true] {
                return true;
            }
        }
        false
    };
    /// Facets per parallel task.
    const TOGETHER: usize = 16;
    let flat = |some: Range<usize>| -> Vec<Blocker> {
        let facets = tree.order[some].iter().map(|&i| facets[i as usize]);
        facets.filter(parts).map(Blocker::Facet).collect()
    };
    let flat = parallel::map_chunks(tree.order.len(), TOGETHER, flat).into_iter().flatten();
    flat.chain(curved.iter().map(|&i| Blocker::Curved(i))).collect()
}

/// The data shared by all threads.
struct Everything<'a> {
    scene: &'a Scene,
    facets: &'a [Facet],
    tree: &'a Clusters,
    blockers: Vec<Blocker>,
    fronts: Fronts,
    aim: &'a Aim,
    level: Level,
    steps: Steps<'a>,
    /// The bits of the view factors, each written once.
    factors: Vec<AtomicU64>,
    /// Pairs that may be partly hidden.
    open: Mutex<Vec<Open>>,
    counts: [AtomicU64; 3],
    rays: AtomicU64,
}

/// Rows of curved surfaces computed together.
const ROWS: usize = 64;

/// Minimum number of face pairs for a parallel task.
const TASK: u64 = 1 << 14;

impl Everything<'_> {
    /// Process all pairs of faces of two clusters, or of one with itself. Blockers between them are among `may_hide`.
    fn visit(&self, one: &Cluster, other: &Cluster, may_hide: &[u32]) {
        if self.steps.is_stopped() {
            return;
        }
        let is_same = one.first == other.first && one.count == other.count;
        let left = if is_same { may_hide.to_vec() } else { self.between(one, other, may_hide) };
        let pairs = u64::from(one.count) * u64::from(other.count);
        let is_done = one.is_leaf() && other.is_leaf();
        if is_done || (left.is_empty() && pairs <= TASK) {
            self.pairs(one, other, is_same, &left);
            return;
        }
        let both: Vec<(&Cluster, &Cluster)> = if is_same {
            let [first, second] = self.tree.parts(one);
            vec![(first, first), (first, second), (second, second)]
        } else if other.is_leaf() || (!one.is_leaf() && one.count >= other.count) {
            self.tree.parts(one).map(|part| (part, other)).into()
        } else {
            self.tree.parts(other).map(|part| (one, part)).into()
        };
        if pairs > TASK {
            parallel::each(both.len(), &|i| self.visit(both[i].0, both[i].1, &left));
        } else {
            both.into_iter().for_each(|(one, other)| self.visit(one, other, &left));
        }
    }

    /// The blockers that may lie between faces of two clusters.
    fn between(&self, one: &Cluster, other: &Cluster, may_hide: &[u32]) -> Vec<u32> {
        if may_hide.is_empty() {
            return Vec::new();
        }
        let geometry = self.scene.geometry();
        let shaft = between_boxes(one, other);
        let corners = [one.corners(), other.corners()];
        let is_open = |blocker: &Blocker| {
            !shaft.iter().any(|half| blocker.is_beyond(geometry, half))
                && !blocker.has_aside(corners.iter().flatten().copied())
        };
        may_hide.iter().copied().filter(|&i| is_open(&self.blockers[i as usize])).collect()
    }

    /// Process all pairs of faces of two clusters.
    fn pairs(&self, one: &Cluster, other: &Cluster, is_same: bool, may_hide: &[u32]) {
        let (ones, others) = (self.tree.faces(one), self.tree.faces(other));
        let against = [ones, others].map(|faces| self.against(faces, may_hide));
        let face = |side: usize, k: usize, number: u32| Face {
            facet: &self.facets[number as usize],
            against: &against[side][k * may_hide.len()..][..may_hide.len()],
        };
        let mut quadrature = Quadrature::new(self.level);
        let (mut open, mut counts) = (Vec::new(), [0; 3]);
        for (k, &i) in ones.iter().enumerate() {
            for (l, &j) in others.iter().enumerate().skip(if is_same { k + 1 } else { 0 }) {
                // In the order of their numbers, independently of the tree.
                let [one, other] = if i < j { [face(0, k, i), face(1, l, j)] } else { [face(1, l, j), face(0, k, i)] };
                let (from, to, faces) = (one.facet, other.facet, [i.min(j), i.max(j)]);
                // All light from a face goes to the face that touches it there, despite rounding gaps.
                if self.fronts.touch(faces) {
                    if let Some((area, _)) = overlap(from, to) {
                        counts[0] += 1;
                        self.store(faces, area);
                    }
                    continue;
                }
                let mut hidden = self.hidden(&one, &other, may_hide);
                // A touching face hides a part of this one from all others, though it may be in no shaft.
                if hidden.is_none() && faces.iter().any(|&face| self.fronts.is_touched(face)) {
                    hidden = Some(Hidden::Partly);
                }
                match hidden {
                    Some(Hidden::Wholly) => counts[1] += 1,
                    Some(Hidden::Partly) => {
                        let whole = pair(&mut quadrature, from, to);
                        if whole > 0.0 {
                            open.push(Open { faces, whole });
                        }
                    }
                    None => {
                        let whole = pair(&mut quadrature, from, to);
                        if whole > 0.0 {
                            counts[0] += 1;
                            self.store(faces, whole);
                        }
                    }
                }
            }
        }
        if !open.is_empty() {
            self.open.lock().unwrap_or_else(PoisonError::into_inner).extend(open);
        }
        for (all, count) in self.counts.iter().zip(counts) {
            all.fetch_add(count, Relaxed);
        }
        let pairs = one.count as usize * other.count as usize;
        // Cancellation is noticed at the tree's next pair.
        let _ = self.steps.did(if is_same { pairs } else { 2 * pairs });
    }

    /// Classify faces relative to blockers, face by face.
    fn against(&self, faces: &[u32], blockers: &[u32]) -> Vec<Against> {
        let one = |face: u32, blocker: u32| {
            let face = &self.facets[face as usize];
            match &self.blockers[blocker as usize] {
                Blocker::Facet(facet) => Against {
                    sides: facet.sides(face.corners),
                    sees: face.sides(facet.corners)[0],
                    heights: facet.heights(face),
                },
                Blocker::Curved(_) => Against { sides: [true, true], sees: true, heights: [0.0; 3] },
            }
        };
        faces.iter().flat_map(|&face| blockers.iter().map(move |&blocker| one(face, blocker))).collect()
    }

    /// Return whether two faces are hidden from each other; None if no blocker intersects their shaft.
    fn hidden(&self, one: &Face, other: &Face, may_hide: &[u32]) -> Option<Hidden> {
        if may_hide.is_empty() {
            return None;
        }
        let looks = |one: &Facet, other: &Facet| one.sides(other.corners)[0];
        if !looks(one.facet, other.facet) || !looks(other.facet, one.facet) {
            return None;
        }
        let geometry = self.scene.geometry();
        let mut shaft: Option<Vec<HalfSpace>> = None;
        let mut found = None;
        for (&i, (from, to)) in may_hide.iter().zip(one.against.iter().zip(other.against)) {
            // Not between them, if both are on one side of its plane or only one sees it.
            let is_between = (0..2).all(|side| from.sides[side] || to.sides[side]);
            if !is_between || !from.sees || !to.sees {
                continue;
            }
            let blocker = &self.blockers[i as usize];
            if let Blocker::Facet(facet) = blocker
                && hides(facet, (one.facet, from.heights), (other.facet, to.heights))
            {
                return Some(Hidden::Wholly);
            }
            // Once one blocker intersects the shaft, others matter only if they hide all.
            if found.is_none() {
                let shaft = shaft.get_or_insert_with(|| between_facets(one.facet, other.facet));
                if !shaft.iter().any(|half| blocker.is_beyond(geometry, half)) {
                    found = Some(Hidden::Partly);
                }
            }
        }
        found
    }

    /// Store the exchange of two faces in both rows.
    fn store(&self, [i, j]: [u32; 2], exchanged: f64) {
        let (i, j) = (i as usize, j as usize);
        self.write(i, j, exchanged / self.facets[i].area);
        self.write(j, i, exchanged / self.facets[j].area);
    }

    fn write(&self, row: usize, column: usize, factor: f64) {
        self.factors[row * self.facets.len() + column].store(factor.to_bits(), Relaxed);
    }

    /// The greatest closed-form factor of each row.
    fn greatest(&self) -> Vec<f64> {
        let count = self.facets.len();
        let of = |i: usize| {
            let row = &self.factors[i * count..][..count];
            row.iter().fold(0.0f64, |most, bits| most.max(f64::from_bits(bits.load(Relaxed))))
        };
        parallel::collect(count, of)
    }

    /// The allowed error of a factor, given the greatest factors of both rows.
    fn wanted(&self, [i, j]: [u32; 2], [factor, most]: [f64; 2], areas: &[f64], greatest: &[f64]) -> f64 {
        let larger = areas[j as usize] / areas[i as usize];
        let absolute = self.aim.error.map_or(f64::INFINITY, |error| error * larger.min(1.0));
        let back = greatest[j as usize].max(factor / larger).max(FAINT);
        let relative = self.aim.relative.map_or(f64::INFINITY, |share| share * most.max(FAINT).min(larger * back));
        absolute.min(relative)
    }

    /// Estimate all potentially hidden pairs, and add them to the given estimates.
    fn sampled(&self, sampled: &mut Vec<Sampled>, areas: &[f64], work: Work) -> Result<(), Stopped> {
        let mut open = std::mem::take(&mut *self.open.lock().unwrap_or_else(PoisonError::into_inner));
        if open.is_empty() {
            return Ok(());
        }
        open.sort_unstable_by_key(|open| open.faces);
        let mut greatest = self.greatest();
        for Sampled { faces, value, .. } in &*sampled {
            for row in faces.map(|face| face as usize) {
                greatest[row] = greatest[row].max(value / areas[row]);
            }
        }
        let rounds = Rounds { scene: self.scene, fronts: &self.fronts, facets: self.facets, aim: self.aim, greatest };
        let (found, rays) = rounds.estimate(&open, work)?;
        self.rays.fetch_add(rays, Relaxed);
        sampled.extend(found.iter().map(|estimate| estimate.sampled));
        Ok(())
    }

    /// The exchange of curved surfaces. For two of them, both rows estimate the exchange A F, with a variance of about
    /// A² F / n, so the row of the smaller area has the greater weight.
    fn curved(&self, areas: &[f64]) -> Result<Vec<Sampled>, Stopped> {
        let geometry = self.scene.geometry();
        let is_curved = |i: u32| geometry.shape(i).is_some();
        let curved: Vec<u32> = (0..areas.len() as u32).filter(|&i| is_curved(i) && areas[i as usize] > 0.0).collect();
        let greatest = if curved.is_empty() { Vec::new() } else { self.greatest() };
        let mut exchanged = BTreeMap::<[u32; 2], [f64; 2]>::new();
        for some in curved.chunks(ROWS) {
            let row = |i: usize| {
                if self.steps.is_stopped() {
                    return Vec::new();
                }
                let (i, mut rows) = (some[i], RowSampler::new(self.scene, &self.fronts, self.aim.seed));
                let wanted = |j: u32, factor: f64, most: f64| self.wanted([i, j], [factor, most], areas, &greatest);
                let (row, sent) = rows.row(i, &self.facets[i as usize], self.aim, wanted);
                self.rays.fetch_add(u64::from(sent), Relaxed);
                self.with_unmet(i, row, sent, areas)
            };
            let rows = parallel::map(some.len(), row);
            self.steps.did(some.len() * areas.len())?;
            for (&i, row) in some.iter().zip(rows) {
                let area = areas[i as usize];
                for (j, factor, error) in row {
                    let other = areas[j as usize];
                    let share = if i != j && is_curved(j) { other / (area + other) } else { 1.0 };
                    let [value, variance] = exchanged.entry([i.min(j), i.max(j)]).or_default();
                    *value += share * area * factor;
                    *variance += (share * area * error).powi(2);
                }
            }
        }
        let sampled = exchanged.into_iter().map(|(faces, [value, variance])| {
            let most = areas[faces[0] as usize].min(areas[faces[1] as usize]);
            Sampled { faces, value: value.min(most), error: variance.sqrt(), most }
        });
        Ok(sampled.collect())
    }

    /// A row by rays, with entries for faces that may be visible but were not hit: their factor is not known to be
    /// zero.
    fn with_unmet(&self, i: u32, mut row: Vec<Entry>, rays: u32, areas: &[f64]) -> Vec<Entry> {
        let geometry = self.scene.geometry();
        let mut is_met = vec![false; areas.len()];
        row.iter().for_each(|entry| is_met[entry.0 as usize] = true);
        let error = Counts::of(0.0, f64::from(rays)).variance((0.0, 1.0)).sqrt();
        let faces_it = |j: u32| match geometry.shape(j) {
            Some(_) => j != i,
            None => {
                let facet = &self.facets[j as usize];
                let most = geometry.shape(i).map_or(f64::INFINITY, |shape| shape.support(facet.normal));
                most > facet.normal.dot(facet.centre)
            }
        };
        let unmet = (0..areas.len() as u32).filter(|&j| areas[j as usize] > 0.0 && !is_met[j as usize] && faces_it(j));
        row.extend(unmet.map(|j| (j, 0.0, error)));
        row
    }
}

/// A face and its classification for each potential blocker.
struct Face<'a> {
    facet: &'a Facet,
    against: &'a [Against],
}

/// The classification of a face relative to a blocker, independent of the other face.
struct Against {
    /// True if some of the face is in front of the blocker's plane, and whether some is behind.
    sides: [bool; 2],
    /// True if some of the blocker is in front of the face.
    sees: bool,
    /// The heights of the face's corners above the blocker's plane.
    heights: [f64; 3],
}

/// The degree to which one face is hidden from another.
enum Hidden {
    Partly,
    Wholly,
}
