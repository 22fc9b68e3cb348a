//! A spatial subdivision into cells of similar numbers of guiding photons.

use super::lobe::{Lobe, LobeLanes};
use super::photon::Photon;
use super::portals::Portals;
use super::training::Visit;
use raywright_base::math::{DVec3, LANES};
use raywright_base::parallel;
use std::ops::Range;

/// Cells made by halving the photons along the longest side of their bounding box, until few are left.
#[derive(Debug)]
pub(super) struct Cells {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    lobes: Vec<LobeLanes>,
}

/// A node of the tree. The first child, of points below `at` along an axis, is the next node; `second` is the index of
/// the other. A node without an axis is a leaf, and `second` its index.
#[derive(Clone, Copy, Debug)]
struct Node {
    at: f64,
    axis: u32,
    second: u32,
}

impl Node {
    /// Axis value that marks a leaf.
    const NONE: u32 = 3;

    fn leaf(number: usize) -> Self {
        Self { at: 0.0, axis: Self::NONE, second: number as u32 }
    }
}

/// A cell and the bounds of its photons.
#[derive(Clone, Debug)]
struct Leaf {
    min: DVec3,
    max: DVec3,
    share: f64,
    gain: f64,
    rarity: f64,
    /// Number of lobes, and their lane groups.
    count: usize,
    lobes: Range<usize>,
}

/// Guiding data of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct GuidingCell<'a> {
    /// Lobes toward the light, at least one and at most [`LOBES`], whose probabilities sum to 1; and their number.
    pub lobes: &'a [LobeLanes],
    pub count: usize,
    /// Probability of guided sampling.
    pub share: f64,
    /// Brightness relative to direct light.
    pub gain: f64,
    /// Rarity of the light in BSDF sampling: see [`LocalGuide::rarity`](super::LocalGuide::rarity).
    pub rarity: f64,
}

/// Maximum number of photons with light per cell. With 32 or 128, pictures of glass balls have more noise.
const PHOTONS: usize = 64;

/// Number of visits after which a cell's own light through a portal counts more than that through the portal anywhere.
const SURE: f64 = 2048.0;

/// Maximum number of lobes per cell. With 16 there is more noise.
const LOBES: usize = 32;

/// Margin of a cell, relative to its size, from which it includes photons. Without it, light at cell borders is missed.
const BESIDE: f64 = 0.5;

/// Probability of sampling the sphere around all others, in case a lobe is missing.
const WIDE: f64 = 0.1;

/// Minimum and maximum probability of guided sampling.
const SHARES: [f64; 2] = [0.1, 0.6];

/// Minimum solid angle of a lobe as a share of all directions.
const SMALLEST: f64 = 1e-8;

/// Maximum brightness of a cell relative to direct light.
const BRIGHTEST: f64 = 1e6;

impl Cells {
    /// Build the cells of some photons; `usual` is the mean direct irradiance.
    pub fn of_photons(photons: Vec<Photon>, usual: f64) -> Self {
        Self::new(photons, |near, bounds| Leaf::of_photons(near, bounds, usual))
    }

    /// Build the cells of the visits of paths from the camera, in a scene of some radius.
    pub fn of_visits(visits: Vec<Visit>, radius: f64) -> Self {
        let portals = Portals::of(&visits, radius);
        Self::new(visits, |near, bounds| Leaf::of_visits(near, bounds, &portals))
    }

    /// Build cells of at most [`PHOTONS`] with light each. `told` makes a cell of those in and around it.
    fn new<P: Positioned>(
        mut photons: Vec<P>,
        told: impl Fn(&mut Vec<P>, (DVec3, DVec3)) -> (Leaf, Vec<Lobe>) + Sync,
    ) -> Self {
        let mut all = Self { nodes: Vec::new(), leaves: Vec::new(), lobes: Vec::new() };
        let mut ranges = Vec::new();
        let count = photons.len();
        all.divide(&mut photons, 0..count, &mut ranges);
        let told = |range: Range<usize>| {
            let (min, max) = bounds(&photons[range]);
            let beside = DVec3::splat(BESIDE * (max - min).max_element());
            let (min, max) = (min - beside, max + beside);
            let mut near = Vec::new();
            all.gather(0, &photons, (min, max), &mut near);
            told(&mut near, (min, max))
        };
        let told: Vec<(Leaf, Vec<Lobe>)> = parallel::map_parts(ranges, told);
        for (leaf, lobes) in told {
            let first = all.lobes.len();
            all.lobes.extend(lobes.chunks(LANES).map(LobeLanes::of));
            all.leaves.push(Leaf { count: lobes.len(), lobes: first..all.lobes.len(), ..leaf });
        }
        all
    }

    /// Split a range of photons. Leaves are numbered in the order of their ranges.
    fn divide<P: Positioned>(&mut self, photons: &mut [P], range: Range<usize>, ranges: &mut Vec<Range<usize>>) {
        let mine = &mut photons[range.clone()];
        let (min, max) = bounds(mine);
        let size = max - min;
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        if mine.iter().filter(|photon| photon.is_lit()).count() <= PHOTONS || size[axis] <= 0.0 {
            self.nodes.push(Node::leaf(ranges.len()));
            ranges.push(range);
            return;
        }
        let half = mine.len() / 2;
        mine.select_nth_unstable_by(half, |a, b| a.position()[axis].total_cmp(&b.position()[axis]));
        let (at, node) = (mine[half].position()[axis], self.nodes.len());
        self.nodes.push(Node::leaf(0));
        self.divide(photons, range.start..range.start + half, ranges);
        self.nodes[node] = Node { at, axis: axis as u32, second: self.nodes.len() as u32 };
        self.divide(photons, range.start + half..range.end, ranges);
    }

    /// Append the photons of a node inside a box.
    fn gather<P: Positioned>(&self, node: usize, photons: &[P], (min, max): (DVec3, DVec3), near: &mut Vec<P>) {
        let Node { at, axis, second } = self.nodes[node];
        if axis == Node::NONE {
            let inside = |p: &&P| p.position().cmpge(min).all() && p.position().cmple(max).all();
            near.extend(photons.iter().filter(inside));
            return;
        }
        // `divide` splits ranges in the middle.
        let (one, other) = photons.split_at(photons.len() / 2);
        if min[axis as usize] <= at {
            self.gather(node + 1, one, (min, max), near);
        }
        if max[axis as usize] >= at {
            self.gather(second as usize, other, (min, max), near);
        }
    }

    /// Return the cell of a place; `None` far from any photon.
    #[inline]
    pub fn find(&self, place: DVec3) -> Option<GuidingCell<'_>> {
        // Depths are similar for all places but paths are unpredictable, so the descent is free of data-dependent
        // branches.
        let coordinates = [place.x, place.y, place.z, 0.0];
        let mut node = 0;
        while self.nodes[node].axis != Node::NONE {
            let Node { at, axis, second } = self.nodes[node];
            let is_below = coordinates[axis as usize & 3] < at;
            node = std::hint::select_unpredictable(is_below, node + 1, second as usize);
        }
        let leaf = &self.leaves[self.nodes[node].second as usize];
        let inside = leaf.count > 0 && place.cmpge(leaf.min).all() && place.cmple(leaf.max).all();
        let &Leaf { share, gain, rarity, count, .. } = leaf;
        inside.then(|| GuidingCell { lobes: &self.lobes[leaf.lobes.clone()], count, share, gain, rarity })
    }
}

impl Leaf {
    /// Make a leaf and its lobes, not yet stored, from the photons in and around a cell.
    fn of_photons(near: &mut [Photon], (min, max): (DVec3, DVec3), usual: f64) -> (Self, Vec<Lobe>) {
        let sides = max - min;
        let light: f64 = near.iter().map(|photon| photon.flux).sum();
        let area = (sides.x * sides.y).max(sides.y * sides.z).max(sides.z * sides.x);
        // Without direct light, or with no area, all light arrives through specular surfaces.
        let brighter = if usual > 0.0 { (light / area / usual).min(BRIGHTEST) } else { BRIGHTEST };
        let each = divide(near, sides.max_element());
        let rarity = rarity(&each, brighter);
        // The variance of a lobe's light is its flux times its brightness times its solid angle, over the probability
        // of sampling it. So the optimal probability is proportional to the square root of that product. Larger lobes
        // are usually less bright, so the combined factor is the square root of the solid angle.
        let strengths = each.into_iter().map(|(lobe, light)| (lobe, (light * lobe.fills().sqrt()).sqrt())).collect();
        let around = Lobe::around(near, sides.max_element());
        let (leaf, lobes) = Self::new((min, max), brighter, strengths, Some(around));
        (Self { rarity, ..leaf }, lobes)
    }

    /// Make a leaf and its lobes from the visits in and around a cell.
    fn of_visits(near: &mut [Visit], (min, max): (DVec3, DVec3), portals: &Portals) -> (Self, Vec<Lobe>) {
        let (mut light, mut direct) = (0.0, 0.0);
        let mut through = vec![0.0; portals.len()];
        let mut others = Vec::new();
        for Visit { photon, direct: of_lights, .. } in &*near {
            light += photon.flux;
            direct += of_lights;
            match portals.crossed(photon) {
                Some(number) => through[number] += photon.flux,
                None if photon.flux > 0.0 => others.push(*photon),
                None => {}
            }
        }
        let brighter = if direct > 0.0 { (light / direct).min(BRIGHTEST) } else { BRIGHTEST };
        let (place, size, count) = ((min + max) / 2.0, (max - min).max_element(), near.len() as f64);
        // A lobe is sampled as often as light comes from it.
        let mut strengths = divide(&mut alike(&others), size);
        for (number, light) in through.into_iter().enumerate() {
            let (lobe, usual) = portals.lobe(number, place);
            strengths.push((lobe, (light + SURE * usual) * count / (count + SURE)));
        }
        let around = (!others.is_empty()).then(|| Lobe::around(&others, size));
        // An opening fills about half of the cross section of the sphere around it.
        let rarity = 2.0 * rarity(&strengths, brighter);
        let (leaf, lobes) = Self::new((min, max), brighter, strengths, around);
        // Portals are where they are from anywhere.
        (Self { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY, rarity, ..leaf }, lobes)
    }

    /// Make a leaf of lobes to be sampled by strength, and of the sphere around their photons.
    fn new(
        (min, max): (DVec3, DVec3),
        brighter: f64,
        mut strengths: Vec<(Lobe, f64)>,
        around: Option<Lobe>,
    ) -> (Self, Vec<Lobe>) {
        strengths.retain(|(_, strength)| *strength > 0.0);
        strengths.sort_unstable_by(|a, b| b.1.total_cmp(&a.1));
        strengths.truncate(LOBES - 1);
        let total: f64 = strengths.iter().map(|(_, strength)| strength).sum();
        let wide = match around {
            None => 0.0,
            Some(_) if strengths.is_empty() => 1.0,
            Some(_) => WIDE,
        };
        let part = (1.0 - wide) / total;
        let mut lobes: Vec<Lobe> = strengths.iter().map(|(lobe, strength)| lobe.drawn(strength * part)).collect();
        lobes.extend(around.map(|lobe| lobe.drawn(wide)));
        // Weighs the noise that guiding removes from BSDF sampling against the noise that it adds, if light half filled
        // each lobe.
        let share = (2.0 * brighter / (2.0 * brighter + 1.0)).clamp(SHARES[0], SHARES[1]);
        let leaf = Self { min, max, share, gain: 1.0 + brighter, rarity: 0.0, count: lobes.len(), lobes: 0..0 };
        (leaf, lobes)
    }
}

/// Return the rarity of light from lobes ([`LocalGuide::rarity`](super::LocalGuide::rarity)) that is `brighter` than
/// direct light. BSDF sampling finds a lobe with the probability of its share of directions.
fn rarity(each: &[(Lobe, f64)], brighter: f64) -> f64 {
    let (light, of_all) = (each.iter().map(|(_, light)| light).sum::<f64>(), brighter / (1.0 + brighter));
    let found = |(lobe, of_lobe): &(Lobe, f64)| (of_lobe / light).powi(2) / lobe.fills().max(SMALLEST);
    if light > 0.0 { of_all * of_all * each.iter().map(found).sum::<f64>() } else { 0.0 }
}

/// Divide photons by their chains into lobes, with the flux of each.
fn divide(photons: &mut [Photon], size: f64) -> Vec<(Lobe, f64)> {
    let mut each = Vec::new();
    photons.sort_unstable_by_key(|photon| photon.chain);
    for prototype in photons.chunk_by_mut(|a, b| a.chain == b.chain) {
        Lobe::divide(prototype, size, 3, &mut each);
    }
    each
}

/// What has a position.
trait Positioned: Copy + Send + Sync {
    fn position(&self) -> DVec3;

    /// Return whether light arrives.
    fn is_lit(&self) -> bool;
}

impl Positioned for Photon {
    fn position(&self) -> DVec3 {
        self.position
    }

    fn is_lit(&self) -> bool {
        self.flux > 0.0
    }
}

impl Positioned for Visit {
    fn position(&self) -> DVec3 {
        self.photon.position
    }

    fn is_lit(&self) -> bool {
        self.photon.is_lit()
    }
}

fn bounds(photons: &[impl Positioned]) -> (DVec3, DVec3) {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    photons.iter().fold(start, |(min, max), p| (min.min(p.position()), max.max(p.position())))
}

/// Resample photons, so that each has at least the mean flux. As many then come from a direction as it brings light
/// (systematic resampling).
fn alike(photons: &[Photon]) -> Vec<Photon> {
    let mean = photons.iter().map(|photon| photon.flux).sum::<f64>() / photons.len().max(1) as f64;
    let mut due = 0.5;
    let mut kept = Vec::new();
    for &photon in photons {
        due += (photon.flux / mean).min(1.0);
        if due >= 1.0 {
            due -= 1.0;
            kept.push(Photon { flux: photon.flux.max(mean), ..photon });
        }
    }
    kept
}
