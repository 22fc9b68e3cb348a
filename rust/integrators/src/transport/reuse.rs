//! Paths that share what they find.

use super::path_state::PathState;
use raywright_base::math::{DVec3, Ray};
use raywright_base::workers::Cancel;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Encounter, RayOrigin, Scene, SurfaceInteraction, fading};
use std::ops::Range;

/// What the paths of a batch share: the light that leaves their second surfaces (Bekaert, Sbert and Halton,
/// "Accelerating Path Tracing by Re-Using Paths", 2002).
///
/// Path j of a group goes from a first point xⱼ, where scattering is diffuse, to a second, yⱼ. If that is diffuse too,
/// what the rest of the path finds of the light that yⱼ reflects is worth the same to all first points that see it. So
/// each of them takes its part of it as one more sample, weighed against all that could have come to it: by the balance
/// heuristic (Veach and Guibas, 1995) over the densities pₖ with which the paths of the group meet a surface at yⱼ.
/// With G(x, y) = cos θₓ cos θ_y V(x, y) / |x − y|² these are pₖ = G(xₖ, yⱼ) / π, and point i takes of yⱼ the share
/// G(xᵢ, yⱼ) / Σₖ G(xₖ, yⱼ), times its reflectance. The sum knows all mutual visibilities, so the mean is as without
/// sharing whatever lies between; shares are at most 1, so nothing is made large that was not.
///
/// What a path finds at its first point, and what yⱼ emits itself, stays its own. So does the rest of a path whose
/// second point is not diffuse, or has a shading normal that had to be bent ([`SurfaceInteraction::GRAZING`]), so that
/// it is another for each who looks: these directions are in the domain of no technique that shares, for whoever takes.
#[derive(Default)]
pub(super) struct Reuse {
    /// The first point of each sample.
    first: Vec<First>,
    /// Second points, in the order of their samples.
    second: Vec<Second>,
    pairs: Vec<Pair>,
    /// Rays in bundles of [`BUNDLE`] with one origin, and those that are too few for one.
    bundles: Sight,
    strays: Sight,
}

/// Rays, and whether something lies on the way.
#[derive(Default)]
struct Sight {
    rays: Vec<Ray>,
    occluded: Vec<bool>,
}

impl Sight {
    fn look(&mut self, scene: &Scene) {
        self.occluded.resize(self.rays.len(), false);
        scene.occluded(&self.rays, &mut self.occluded);
        self.rays.clear();
    }
}

/// A first point, which takes.
#[derive(Clone, Copy)]
struct First {
    departure: RayOrigin,
    /// The primitive that it is on, which rays from and to here miss.
    primitive: u32,
    /// Shading normal and geometric normal on the side of the camera.
    shading: DVec3,
    normal: DVec3,
    is_flat: bool,
    /// What is reflected, times what the path brings there; zero where nothing is taken.
    reflectance: Rgb,
}

/// A second point, which gives.
#[derive(Clone, Copy)]
struct Second {
    departure: RayOrigin,
    primitive: u32,
    shading: DVec3,
    normal: DVec3,
    is_flat: bool,
    sample: u32,
}

/// A first point that may see a second one.
struct Pair {
    /// By the number of the sample.
    first: u32,
    /// The number of the ray between them, counted through bundles or strays; `KNOWN` where it need not be asked.
    ray: u32,
    is_stray: bool,
    /// G, if it does.
    geometry: f64,
    fading: f64,
}

/// What is given from a second point on, and to how many pairs at most.
struct Given {
    found: Rgb,
    pairs: usize,
}

impl Pair {
    const KNOWN: u32 = u32::MAX;
}

/// Rays that are sent together: enough to keep the accelerator's kernels full, few enough to stay in cache.
const TOGETHER: usize = 4096;

/// Rays that the accelerator takes through its tree as one packet. With rays of two origins in it, none would go
/// together, so copies of one are added to fill it.
const BUNDLE: usize = 16;

/// Fewer rays than this go alone.
const FEW: usize = 5;

impl First {
    const NONE: Self = Self {
        departure: RayOrigin::free(DVec3::ZERO),
        primitive: Ray::NO_TRIANGLE,
        shading: DVec3::ZERO,
        normal: DVec3::ZERO,
        is_flat: true,
        reflectance: Rgb::ZERO,
    };

    /// G without visibility, and the fading of light; none where either point does not face the other, or nothing may
    /// be shared.
    #[inline]
    fn geometry(&self, there: &Second) -> Option<(f64, f64)> {
        let way = there.departure.position() - self.departure.position();
        let square = way.length_squared();
        let (leaving, arriving) = (self.shading.dot(way), -there.normal.dot(way));
        if leaving <= 0.0 || arriving <= 0.0 {
            return None;
        }
        let mut fades = 1.0;
        if !self.is_flat {
            let geometric = self.normal.dot(way);
            if geometric <= 0.0 {
                return None;
            }
            fades = fading(geometric, leaving, self.shading.dot(self.normal));
        }
        if !there.is_flat {
            const GRAZING: f64 = SurfaceInteraction::<raywright_optics::AnyBsdf>::GRAZING;
            let cosine = -there.shading.dot(way);
            if cosine <= 0.0 || cosine * cosine < GRAZING * GRAZING * square {
                return None;
            }
        }
        let geometry = leaving * arriving / (square * square);
        (geometry > 0.0 && geometry.is_finite()).then_some((geometry, fades))
    }
}

impl Reuse {
    /// Forgets all, and begins with a batch of so many samples.
    pub fn begin(&mut self, samples: usize) {
        self.first.clear();
        self.first.resize(samples, First::NONE);
        self.second.clear();
        self.pairs.clear();
        self.bundles.rays.clear();
        self.strays.rays.clear();
    }

    /// A path comes to a surface, on a primitive of the scene. Where what it finds from there on is to be shared, it
    /// goes on as the path of a sample of number `samples` or more.
    #[inline]
    pub fn visit<S: Bsdf>(&mut self, mut path: PathState, here: &SurfaceInteraction<S>, primitive: u32) -> PathState {
        if path.bounce > 1 {
            return path;
        }
        let Some(reflectance) = here.bsdf().diffuse().filter(|_| !here.is_as_given()) else { return path };
        let (shading, normal) = (here.shading_normal(), here.normal());
        // Where the one normal is seen from above and the other from below, or both from the side, nothing is
        // scattered.
        let is_lit = here.cosine() > 0.0 && !reflectance.is_black();
        if !is_lit {
            return path;
        }
        let (departure, is_flat) = (here.ray_origin(), here.is_flat());
        if path.bounce == 0 {
            let reflectance = path.throughput * reflectance;
            self.first[path.sample as usize] = First { departure, primitive, shading, normal, is_flat, reflectance };
            return path;
        }
        let second = Second { departure, primitive, shading, normal, is_flat, sample: path.sample };
        let first = &self.first[path.sample as usize];
        if first.reflectance.is_black() || here.is_bent() || first.geometry(&second).is_none() {
            return path;
        }
        self.second.push(second);
        path.throughput = Rgb::ONE;
        path.sample += self.first.len() as u32;
        path
    }

    /// Adds to the radiance of each sample what it takes of what all of its group have `found`. `chance` gives a
    /// uniform number of a group, by the number of its first sample.
    ///
    /// Most of the time goes into rays, and dim light is not worth as many as bright light. What is dimmer than the
    /// mean of its group is shared in proportion to that only, and counts for more where it is: a systematic sample,
    /// which takes one uniform number for all.
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
        let mut given = Vec::new();
        // Paths come to surfaces in the order of what these scatter by; each has one second point at most.
        self.second.sort_unstable_by_key(|second| second.sample);
        for &count in groups {
            if cancel.is_raised() {
                return;
            }
            let group = start..start + count;
            let seconds = next..self.second.partition_point(|second| second.sample < group.end);
            (start, next) = (group.end, seconds.end);
            let brightness = |second: &Second| found[second.sample as usize].sum();
            let mean = self.second[seconds.clone()].iter().map(brightness).sum::<f64>() / seconds.len() as f64;
            let mut turn = if mean > 0.0 { chance(group.start) } else { 0.0 };
            for i in seconds {
                let second = self.second[i];
                let brightness = brightness(&second);
                let probability = (brightness / mean).min(1.0);
                let before = turn;
                turn += probability;
                if brightness != 0.0 && (probability >= 1.0 || turn.floor() > before.floor()) {
                    let pairs = self.pair(&group, &second);
                    let found = found[second.sample as usize] / probability;
                    given.push(Given { found, pairs });
                }
            }
            if self.bundles.rays.len() + self.strays.rays.len() >= TOGETHER {
                self.give(scene, &mut given, radiance);
            }
        }
        self.give(scene, &mut given, radiance);
    }

    /// Pairs a second point with all first points that may see it, and says with how many.
    fn pair(&mut self, group: &Range<u32>, second: &Second) -> usize {
        let before = self.pairs.len();
        let rays = &mut self.bundles.rays;
        for i in group.clone() {
            let there = &self.first[i as usize];
            let Some((geometry, fading)) = there.geometry(second) else { continue };
            // That a path sees where it has come to is known.
            let is_known = i == second.sample;
            let ray = if is_known { Pair::KNOWN } else { rays.len() as u32 };
            self.pairs.push(Pair { first: i, ray, is_stray: false, geometry, fading });
            if !is_known {
                let misses = [second.primitive, there.primitive];
                rays.push(Ray { misses, ..second.departure.segment(&there.departure) });
            }
        }
        let left = rays.len() % BUNDLE;
        if left >= FEW {
            rays.resize(rays.len() + BUNDLE - left, rays[rays.len() - 1]);
        } else if left > 0 {
            let (start, to) = ((rays.len() - left) as u32, self.strays.rays.len() as u32);
            self.strays.rays.extend(rays.drain(start as usize..));
            for pair in &mut self.pairs[before..] {
                if pair.ray != Pair::KNOWN && pair.ray >= start {
                    (pair.ray, pair.is_stray) = (pair.ray - start + to, true);
                }
            }
        }
        self.pairs.len() - before
    }

    /// Shares out what is given, where it is seen.
    fn give(&mut self, scene: &Scene, given: &mut Vec<Given>, radiance: &mut [Rgb]) {
        self.bundles.look(scene);
        self.strays.look(scene);
        let mut pairs = &mut self.pairs[..];
        for Given { found, pairs: count } in given.drain(..) {
            let (of, rest) = pairs.split_at_mut(count);
            pairs = rest;
            let mut sum = 0.0;
            for pair in &mut *of {
                let sight = if pair.is_stray { &self.strays } else { &self.bundles };
                if pair.ray != Pair::KNOWN && sight.occluded[pair.ray as usize] {
                    pair.geometry = 0.0;
                }
                sum += pair.geometry;
            }
            for pair in of.iter().filter(|pair| pair.geometry > 0.0) {
                let part = pair.geometry / sum * pair.fading;
                let first = pair.first as usize;
                radiance[first] += self.first[first].reflectance * (found * part);
            }
        }
        self.pairs.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(position: DVec3, normal: DVec3, shading: DVec3) -> First {
        let departure = RayOrigin::free(position);
        First {
            departure,
            primitive: Ray::NO_TRIANGLE,
            shading,
            normal,
            is_flat: shading == normal,
            reflectance: Rgb::ONE,
        }
    }

    fn second(position: DVec3, normal: DVec3, shading: DVec3) -> Second {
        let departure = RayOrigin::free(position);
        Second { departure, primitive: Ray::NO_TRIANGLE, shading, normal, is_flat: shading == normal, sample: 0 }
    }

    #[test]
    fn geometry_is_that_of_two_small_surfaces() {
        let floor = first(DVec3::ZERO, DVec3::Z, DVec3::Z);
        let above = second(DVec3::new(3.0, 0.0, 4.0), DVec3::NEG_Z, DVec3::NEG_Z);
        // Two cosines of 4/5, at a distance of 5.
        let (geometry, fading) = floor.geometry(&above).unwrap();
        assert!((geometry - 0.64 / 25.0).abs() < 1e-16 && fading == 1.0);
        // A shading normal counts for the cosine where light is taken, and for nothing where it is given.
        let tilted = DVec3::new(0.6, 0.0, 0.8);
        let (geometry, fading) = first(DVec3::ZERO, DVec3::Z, tilted).geometry(&above).unwrap();
        // Now the direction is that of the shading normal, a factor 5/4 more.
        assert!((geometry - 0.8 / 25.0).abs() < 1e-16 && (0.0..=1.0).contains(&fading));
        let other = second(above.departure.position(), DVec3::NEG_Z, -tilted);
        assert_eq!(floor.geometry(&other), floor.geometry(&above));
    }

    #[test]
    fn what_turns_away_or_is_one_point_shares_nothing() {
        let floor = first(DVec3::ZERO, DVec3::Z, DVec3::Z);
        for (position, normal) in [
            (DVec3::Z, DVec3::Z),
            (DVec3::NEG_Z, DVec3::NEG_Z),
            (DVec3::X, DVec3::NEG_X),
            (DVec3::ZERO, DVec3::NEG_Z),
            (DVec3::Z * 1e-200, DVec3::NEG_Z),
        ] {
            assert_eq!(floor.geometry(&second(position, normal, normal)), None);
        }
        // Its shading normal would be bent if seen from here.
        let grazed = second(DVec3::Z, DVec3::NEG_Z, DVec3::new(1.0, 0.0, -5e-4).normalize());
        assert_eq!(floor.geometry(&grazed), None);
    }
}
