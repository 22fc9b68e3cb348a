//! Path sharing: paths of a group share the light found beyond their second points (Bekaert, Sbert and Halton,
//! "Accelerating Path Tracing by Re-Using Paths", 2002).
//!
//! Path j of a group goes from a first point xⱼ, where scattering is diffuse, to a second, yⱼ. If that is diffuse too,
//! the radiance that yⱼ reflects is the same for all first points that see it. So each first point takes a share of it
//! as one more sample, weighted by the balance heuristic (Veach and Guibas, 1995) over the densities pₖ with which the
//! paths of the group reach yⱼ. With G(x, y) = cos θₓ cos θ_y V(x, y) / |x − y|² these are pₖ = G(xₖ, yⱼ) / π, and
//! point i takes of yⱼ the share G(xᵢ, yⱼ) / Σₖ G(xₖ, yⱼ), times its reflectance. The sum includes all mutual
//! visibilities, so the estimate is unbiased for any geometry in between. Shares are at most 1: no sample is amplified.
//!
//! Where a [`Guide`] aims paths at their first points, pₖ is the density of its mixture with diffuse scattering.
//!
//! Direct light at the first point, and emission of yⱼ, are not shared. Neither is a path whose second point is not
//! diffuse, or whose shading normal there had to be bent ([`SurfaceInteraction::GRAZING`]): the scattering of such a
//! point depends on the direction to the first point. These directions are in the domain of no technique that shares.

use crate::{Guide, LocalGuide};
use raywright_base::math::single::{choose, mask};
use raywright_base::math::{DVec3, LANES, PathRays, Ray, SingleLanes, Vec3};
use raywright_base::simd::{Column, Level, loops, pack};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Scene, SurfaceInteraction};
use std::f64::consts::PI;
use std::ops::Range;

/// Whether paths can share in a scene: two points see each other or do not, at any time, and what is found at a point
/// does not depend on who looks.
///
/// Masks and nested media make sight more than a yes or no; where something moves, the samples of a group see the scene
/// at times of their own; and a filtered texture shows to each what is of its own width.
pub(crate) fn can_share(scene: &Scene) -> bool {
    let needs = scene.plan().needs();
    let is_open = !(needs.masks || needs.nested || needs.media || needs.points.width);
    is_open && !needs.motion && !scene.lights().is_dark()
}

/// A point of a diffuse surface on a path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharingPoint {
    pub position: DVec3,
    /// Where rays leave on the side that the path came from.
    pub origin: DVec3,
    /// Shading normal and geometric normal on that side; equal where the surface is flat.
    pub shading: Vec3,
    pub normal: Vec3,
    /// The primitive that it is on; rays from and to the point miss it.
    pub primitive: u32,
}

/// First points, by the number of the sample, in columns.
#[derive(Default)]
struct FirstPoints<'a> {
    position: [Vec<f64>; 3],
    origin: [Vec<f64>; 3],
    /// Zero where nothing is shared.
    shading: [Vec<f32>; 3],
    normal: [Vec<f32>; 3],
    primitive: Vec<u32>,
    /// The reflectance, times the throughput of the path up to the point.
    reflectance: Vec<Rgb>,
    /// Where paths aim from; empty without a guide.
    aims: Vec<Option<LocalGuide<'a>>>,
    /// Whether all points, the second ones included, have shading normals that equal the geometric ones.
    are_flat: bool,
}

/// Sixteen first points.
struct FirstLanes<'a> {
    position: [&'a [f64; LANES]; 3],
    origin: [&'a [f64; LANES]; 3],
    shading: [&'a [f32; LANES]; 3],
    normal: [&'a [f32; LANES]; 3],
}

/// A second point, and the path that came there.
#[derive(Clone, Copy)]
struct SecondPoint {
    sample: u32,
    point: SharingPoint,
    throughput: Rgb,
}

/// A second point whose light is shared.
struct Shared {
    found: Rgb,
    position: DVec3,
    /// The sample whose path came there, and the throughput of that path.
    sample: u32,
    throughput: Rgb,
    /// The samples of the group, and where their geometry terms begin.
    group: Range<u32>,
    start: usize,
}

/// The paths of a batch, and the rays between their points.
pub(crate) struct PathSharing<'a> {
    level: Level,
    guide: Option<&'a Guide>,
    first: FirstPoints<'a>,
    second: Vec<SecondPoint>,
    shared: Vec<Shared>,
    /// For each shared point, the geometry term of each sample of its group, in whole sixteens: 0 where it is not seen.
    geometry: Vec<f32>,
    /// The factors by which light fades near the horizon of bent shading normals; empty where all surfaces are flat.
    fading: Vec<f32>,
    rays: PathRays,
    /// The geometry term that each ray decides.
    term: Vec<u32>,
    is_occluded: Vec<bool>,
}

/// Rays that are traced together: enough to fill the accelerator's kernels, few enough to stay in cache.
const BATCH: usize = 4096;

/// The greatest geometry term, up to its factor: sums of a group stay finite. Points nearer than 10⁻¹⁵ of the usual
/// distance share nothing.
const MOST: f32 = 1e30;

/// The sum of sixteen numbers, in an order that is the same at all levels.
#[inline(always)]
fn sum(mut lanes: [f32; LANES]) -> f32 {
    for width in [8, 4, 2, 1] {
        for i in 0..width {
            lanes[i] += lanes[i + width];
        }
    }
    lanes[0]
}

loops! {
    /// Computes the geometry terms between first points and a second point, up to a common factor and without
    /// visibility, and the rays from the second point. `scale` is one over a length near their distances, so that
    /// squares stay in the range of f32.
    fn connect(
        first: &FirstLanes<'_>,
        second: &SharingPoint,
        scale: f64,
        geometry: &mut [f32; LANES],
        direction: &mut SingleLanes,
        t_max: &mut [f64; LANES],
    ) {
        let at = |axes: &[&[f64; LANES]; 3], i: usize| DVec3::new(axes[0][i], axes[1][i], axes[2][i]);
        for i in 0..LANES {
            let way = ((second.position - at(&first.position, i)) * scale).as_vec3();
            let shading = Vec3::new(first.shading[0][i], first.shading[1][i], first.shading[2][i]);
            let (leaving, arriving) = (shading.dot(way), -second.normal.dot(way));
            let square = way.dot(way);
            let term = leaving * arriving / (square * square);
            // A comparison with NaN is false.
            let faces = mask(leaving > 0.0) & mask(arriving > 0.0) & mask(term < MOST);
            geometry[i] = choose(faces, term, 0.0);
            let to = ((at(&first.origin, i) - second.origin) * scale).as_vec3();
            let length = to.dot(to).sqrt();
            direction.set(i, to * (1.0 / length));
            t_max[i] = f64::from(length) * (PathRays::END / scale);
        }
    }
}

loops! {
    /// Applies shading normals: the fading of light near the horizon, and the directions in which nothing is shared.
    fn shade(
        first: &FirstLanes<'_>,
        second: &SharingPoint,
        scale: f64,
        geometry: &mut [f32; LANES],
        fades: &mut [f32; LANES],
    ) {
        const GRAZING: f32 = SurfaceInteraction::<raywright_optics::AnyBsdf>::GRAZING as f32;
        let is_flat = mask(second.shading == second.normal);
        for i in 0..LANES {
            let position = DVec3::new(first.position[0][i], first.position[1][i], first.position[2][i]);
            let way = ((second.position - position) * scale).as_vec3();
            let shading = Vec3::new(first.shading[0][i], first.shading[1][i], first.shading[2][i]);
            let normal = Vec3::new(first.normal[0][i], first.normal[1][i], first.normal[2][i]);
            let (leaving, geometric, between) = (shading.dot(way), normal.dot(way), shading.dot(normal));
            let g = geometric / (leaving * between);
            // As `fading` has it.
            let faded = choose(mask(between <= 0.0) | mask(g >= 1.0), 1.0, ((1.0 - g) * g + 1.0) * g);
            let cosine = -second.shading.dot(way);
            let is_bent = mask(cosine <= 0.0) | mask(cosine * cosine < GRAZING * GRAZING * way.dot(way));
            geometry[i] = choose(mask(geometric > 0.0) & (is_flat | !is_bent), geometry[i], 0.0);
            fades[i] = choose(mask(geometry[i] > 0.0), faded, 0.0);
        }
    }
}

loops! {
    /// Adds up the geometry terms of a group.
    fn total(geometry: &[f32], all: &mut f32) {
        let mut lanes = [0.0; LANES];
        for sixteen in geometry.as_chunks::<LANES>().0 {
            for i in 0..LANES {
                lanes[i] += sixteen[i];
            }
        }
        *all = sum(lanes);
    }
}

impl<'a> FirstPoints<'a> {
    /// Begins with so many samples, none of which shares.
    fn begin(&mut self, samples: usize, is_guided: bool) {
        let room = samples + LANES;
        self.aims.clear();
        self.aims.resize(if is_guided { room } else { 0 }, None);
        self.position.iter_mut().chain(&mut self.origin).for_each(|column| column.resize(room, 0.0));
        self.normal.iter_mut().for_each(|column| column.resize(room, 0.0));
        for column in &mut self.shading {
            column.clear();
            column.resize(room, 0.0);
        }
        self.primitive.resize(room, Ray::NO_TRIANGLE);
        self.reflectance.clear();
        self.reflectance.resize(room, Rgb::ZERO);
        self.are_flat = true;
    }

    fn set(&mut self, sample: usize, point: &SharingPoint, reflectance: Rgb, guide: Option<&'a Guide>) {
        for axis in 0..3 {
            self.position[axis][sample] = point.position[axis];
            self.origin[axis][sample] = point.origin[axis];
            self.shading[axis][sample] = point.shading[axis];
            self.normal[axis][sample] = point.normal[axis];
        }
        self.primitive[sample] = point.primitive;
        self.reflectance[sample] = reflectance;
        if let Some(guide) = guide {
            self.aims[sample] = guide.at(point.position);
        }
        self.are_flat &= point.shading == point.normal;
    }

    fn position(&self, sample: usize) -> DVec3 {
        DVec3::new(self.position[0][sample], self.position[1][sample], self.position[2][sample])
    }

    /// The density of a path's direction from a first point to another point, over that of diffuse scattering.
    fn denser(&self, level: Level, sample: usize, to: DVec3) -> f64 {
        let Some(local) = &self.aims[sample] else { return 1.0 };
        let direction = (to - self.position(sample)).normalize();
        let [x, y, z] = self.shading.each_ref().map(|axis| f64::from(axis[sample]));
        let scattered = DVec3::new(x, y, z).dot(direction) / PI;
        1.0 + local.share() * (local.pdf(level, direction) / scattered - 1.0)
    }

    /// The sixteen from a sample on.
    fn lanes(&self, start: usize) -> FirstLanes<'_> {
        fn sixteen<T>(columns: &[Vec<T>; 3], start: usize) -> [&[T; LANES]; 3] {
            columns.each_ref().map(|column| column[start..].first_chunk().expect("room for sixteen more"))
        }
        FirstLanes {
            position: sixteen(&self.position, start),
            origin: sixteen(&self.origin, start),
            shading: sixteen(&self.shading, start),
            normal: sixteen(&self.normal, start),
        }
    }
}

impl<'a> PathSharing<'a> {
    /// For workers at a level of vector instructions.
    pub fn new(level: Level, guide: Option<&'a Guide>) -> Self {
        Self {
            level,
            guide,
            first: FirstPoints::default(),
            second: Vec::new(),
            shared: Vec::new(),
            geometry: Vec::new(),
            fading: Vec::new(),
            rays: PathRays::with_room(0, false),
            term: Vec::new(),
            is_occluded: Vec::new(),
        }
    }

    /// Forgets all, and begins with a batch of so many samples.
    pub fn begin(&mut self, samples: usize) {
        self.first.begin(samples, self.guide.is_some());
        self.second.clear();
    }

    /// The path of a sample comes to its first point, which reflects this much of its throughput diffusely.
    #[inline]
    pub fn add_first(&mut self, sample: u32, point: &SharingPoint, reflectance: Rgb) {
        if !reflectance.is_black() {
            self.first.set(sample as usize, point, reflectance, self.guide);
        }
    }

    /// The path of a sample comes to its second point with this throughput. Return whether the light that it finds
    /// beyond is shared. Then the path goes on with a throughput of 1, and `found` of [`PathSharing::share`] takes what
    /// it finds.
    #[inline]
    pub fn add_second(&mut self, sample: u32, point: &SharingPoint, throughput: Rgb) -> bool {
        let shares = !self.first.reflectance[sample as usize].is_black();
        if shares {
            self.first.are_flat &= point.shading == point.normal;
            self.second.push(SecondPoint { sample, point: *point, throughput });
        }
        shares
    }

    /// Adds to the radiance of each sample its shares of the light that the paths of its group have `found` beyond
    /// their second points. `chance` gives a uniform number of a group, by the number of its first sample.
    ///
    /// Most of the time goes into rays, and dim light deserves fewer than bright light. Light dimmer than the mean of
    /// its group is shared with a probability in proportion, and divided by it: a systematic sample, which takes one
    /// uniform number for all.
    pub fn share(
        &mut self,
        scene: &Scene,
        groups: &[u32],
        found: &[Rgb],
        cancel: &Cancel,
        radiance: &mut [Rgb],
        mut chance: impl FnMut(u32) -> f64,
    ) {
        let (mut start, mut next) = (0, 0);
        // Paths come to surfaces in the order of their materials; each has one second point at most.
        let mut all = std::mem::take(&mut self.second);
        all.sort_unstable_by_key(|second| second.sample);
        for &count in groups {
            if cancel.is_raised() {
                break;
            }
            let group = start..start + count;
            let seconds = next..all.partition_point(|second| second.sample < group.end);
            (start, next) = (group.end, seconds.end);
            let brightness = |second: &SecondPoint| found[second.sample as usize].sum();
            let mean = all[seconds.clone()].iter().map(brightness).sum::<f64>() / seconds.len() as f64;
            let mut turn = if mean > 0.0 { chance(group.start) } else { 0.0 };
            for second in &all[seconds] {
                let brightness = brightness(second);
                let probability = (brightness / mean).min(1.0);
                let before = turn;
                turn += probability;
                if brightness != 0.0 && (probability >= 1.0 || turn.floor() > before.floor()) {
                    let found = found[second.sample as usize] / probability;
                    self.connect(scene.traces_packets(), second, found, group.clone());
                }
            }
            if self.rays.len >= BATCH {
                self.distribute(scene, radiance);
            }
        }
        self.distribute(scene, radiance);
        self.second = all;
    }

    /// Connects a second point with all first points of its group that may see it.
    fn connect(&mut self, in_packets: bool, second: &SecondPoint, found: Rgb, group: Range<u32>) {
        let (level, first, start) = (self.level, &self.first, self.geometry.len());
        let SecondPoint { sample: own, point: ref second, throughput } = *second;
        let scale = 1.0 / (second.position - first.position(own as usize)).length();
        let (mut direction, mut t_max) = (SingleLanes::ZERO, [0.0; LANES]);
        let before = self.rays.len;
        self.rays.make_room(before + group.len() + LANES);
        self.term.resize(before + group.len() + 2 * LANES, 0);
        for at in group.clone().step_by(LANES) {
            let lanes = first.lanes(at as usize);
            let (mut geometry, mut fades) = ([0.0; LANES], [1.0; LANES]);
            connect(level, &lanes, second, scale, &mut geometry, &mut direction, &mut t_max);
            if !first.are_flat {
                shade(level, &lanes, second, scale, &mut geometry, &mut fades);
                self.fading.extend(fades);
            }
            let mut is_seen = 0;
            for (lane, term) in geometry.iter_mut().enumerate() {
                if at + lane as u32 >= group.end {
                    *term = 0.0;
                }
                is_seen |= u32::from(*term > 0.0) << lane;
            }
            // A path sees where it has come to.
            if (at..at + LANES as u32).contains(&own) {
                is_seen &= !(1 << (own - at));
            }
            let term = std::array::from_fn(|lane| (self.geometry.len() + lane) as u32);
            let misses = std::array::from_fn(|lane| [second.primitive, first.primitive[at as usize + lane]]);
            self.geometry.extend(geometry);
            let (to, rays) = (self.rays.len, &mut self.rays);
            let [x, y, z] = &mut rays.direction;
            let columns = [
                Column::new(&direction.0[0], &mut x[to..]),
                Column::new(&direction.0[1], &mut y[to..]),
                Column::new(&direction.0[2], &mut z[to..]),
                Column::new(&t_max, &mut rays.t_max[to..]),
                Column::new(&misses, &mut rays.misses[to..]),
                Column::new(&term, &mut self.term[to..]),
            ];
            pack(level, is_seen, &columns);
            rays.len += is_seen.count_ones() as usize;
        }
        let end = self.rays.len;
        for axis in 0..3 {
            self.rays.origin[axis][before..end + LANES].fill(second.origin[axis]);
        }
        // A tree takes sixteen rays of one origin as a packet: copies of the last ray fill it.
        if in_packets && end > before {
            let full = end.next_multiple_of(LANES);
            for column in &mut self.rays.direction {
                let last = column[end - 1];
                column[end..full].fill(last);
            }
            let last = (self.rays.t_max[end - 1], self.rays.misses[end - 1], self.term[end - 1]);
            self.rays.t_max[end..full].fill(last.0);
            self.rays.misses[end..full].fill(last.1);
            self.term[end..full].fill(last.2);
            self.rays.len = full;
        }
        self.shared.push(Shared { found, position: second.position, sample: own, throughput, group, start });
    }

    /// Traces the rays, and distributes the light of the shared points.
    fn distribute(&mut self, scene: &Scene, radiance: &mut [Rgb]) {
        let level = self.level;
        self.is_occluded.resize(self.rays.len + LANES, false);
        scene.are_occluded(level, &self.rays, &mut self.is_occluded);
        for (&term, &is_occluded) in self.term.iter().zip(&self.is_occluded[..self.rays.len]) {
            if is_occluded {
                self.geometry[term as usize] = 0.0;
            }
        }
        for Shared { found, position, sample, throughput, group, start } in self.shared.drain(..) {
            let count = group.len();
            let terms = &self.geometry[start..][..count.next_multiple_of(LANES)];
            let mut all = 0.0;
            total(level, terms, &mut all);
            if terms[(sample - group.start) as usize] == 0.0 {
                // Next to edge-on, or too near for its own first point: in the domain of no technique that shares.
                radiance[sample as usize] += throughput * found;
                continue;
            }
            let samples = group.start as usize..group.end as usize;
            let mut all = f64::from(all);
            if self.guide.is_some() {
                let seen = samples.clone().zip(terms).filter(|(_, term)| **term > 0.0);
                let density =
                    |(first, term): (usize, &f32)| f64::from(*term) * self.first.denser(level, first, position);
                all = seen.map(density).sum();
            }
            let of_all = found / all;
            let taken = radiance[samples.clone()].iter_mut().zip(&self.first.reflectance[samples]);
            if self.first.are_flat {
                for ((to, reflectance), &term) in taken.zip(terms) {
                    *to += *reflectance * (of_all * f64::from(term));
                }
            } else {
                let fading = &self.fading[start..][..count];
                for ((to, reflectance), (&term, &fades)) in taken.zip(terms.iter().zip(fading)) {
                    *to += *reflectance * (of_all * f64::from(term * fades));
                }
            }
        }
        self.rays.len = 0;
        self.geometry.clear();
        self.fading.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(position: DVec3, normal: Vec3, shading: Vec3) -> SharingPoint {
        SharingPoint { position, origin: position, shading, normal, primitive: Ray::NO_TRIANGLE }
    }

    /// The geometry term and the fading between a first and a second point.
    fn between(first: &SharingPoint, second: &SharingPoint) -> [f32; 2] {
        let mut points = FirstPoints::default();
        points.begin(1, false);
        points.set(0, first, Rgb::ONE, None);
        let level = Level::current().unwrap();
        let (mut geometry, mut fades) = ([0.0; LANES], [1.0; LANES]);
        let (lanes, scale) = (points.lanes(0), 1.0);
        connect(level, &lanes, second, scale, &mut geometry, &mut SingleLanes::ZERO.clone(), &mut [0.0; LANES]);
        if first.shading != first.normal || second.shading != second.normal {
            shade(level, &lanes, second, scale, &mut geometry, &mut fades);
        }
        assert!(geometry[1..].iter().all(|&term| term == 0.0), "no point, no term");
        [geometry[0], fades[0]]
    }

    #[test]
    fn geometry_is_that_of_two_small_surfaces() {
        let floor = point(DVec3::ZERO, Vec3::Z, Vec3::Z);
        let above = point(DVec3::new(3.0, 0.0, 4.0), Vec3::NEG_Z, Vec3::NEG_Z);
        // Two cosines of 4/5, at a distance of 5.
        let [geometry, fades] = between(&floor, &above);
        assert!((geometry - 0.64 / 25.0).abs() < 1e-8 && fades == 1.0);
        // A shading normal counts for the cosine where light is taken, and for nothing where it is given.
        let tilted = Vec3::new(0.6, 0.0, 0.8);
        let [geometry, fades] = between(&point(DVec3::ZERO, Vec3::Z, tilted), &above);
        // Now the direction is that of the shading normal, a factor 5/4 more.
        assert!((geometry - 0.8 / 25.0).abs() < 1e-8 && (0.0..=1.0).contains(&fades));
        let other = point(above.position, Vec3::NEG_Z, -tilted);
        assert_eq!(between(&floor, &other), between(&floor, &above));
    }

    #[test]
    fn what_turns_away_or_is_one_point_shares_nothing() {
        let floor = point(DVec3::ZERO, Vec3::Z, Vec3::Z);
        for (position, normal) in [
            (DVec3::Z, Vec3::Z),
            (DVec3::NEG_Z, Vec3::NEG_Z),
            (DVec3::X, Vec3::NEG_X),
            (DVec3::ZERO, Vec3::NEG_Z),
            (DVec3::Z * 1e-200, Vec3::NEG_Z),
        ] {
            assert_eq!(between(&floor, &point(position, normal, normal))[0], 0.0);
        }
        // Its shading normal would be bent if seen from here.
        let grazed = point(DVec3::Z, Vec3::NEG_Z, Vec3::new(1.0, 0.0, -5e-4));
        assert_eq!(between(&floor, &grazed)[0], 0.0);
    }
}
