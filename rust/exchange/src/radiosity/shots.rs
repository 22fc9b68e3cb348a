//! Shooting: unshot power is distributed along rays, and the reflected part becomes unshot again.

use super::origins::Origin;
use super::{Enclosure, first_light};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::{BatchSize, SamplerKind, philox4x32};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Scene;
use std::ops::Range;

/// Marks rays that hit nothing, and rays that hit the black side of a face.
const ESCAPED: u32 = u32::MAX;
const BEHIND: u32 = u32::MAX - 1;

/// Replaces a ray that could not be sampled: it hits nothing.
const NOWHERE: Ray = Ray { t_max: -1.0, ..Ray::new(DVec3::ZERO, DVec3::X) };

/// Rays per parallel task.
const TOGETHER: u32 = 4096;

/// One replicate of a solution in progress: arrived and unshot power.
///
/// Each ray of a source carries the same fraction of its unshot power. It starts at a uniform point of the patch, in a
/// cosine-weighted direction, and ends at the first hit. The arrived power is unbiased for any number of rays, and
/// power is conserved: emitted power has been absorbed, has escaped, or is unshot. Shooting all sources at once, with
/// rays in proportion to power, is stochastic Jacobi iteration (Neumann, "Monte Carlo Radiosity", 1995; Bekaert,
/// "Hierarchical and Stochastic Algorithms for Radiosity", 1999). Shooting the source of greatest power is progressive
/// refinement (Cohen, Chen, Wallace and Greenberg, "A Progressive Refinement Approach to Fast Radiosity Image
/// Generation", 1988).
#[derive(Clone, Debug)]
pub struct Shots {
    /// Its number, which seeds its rays together with the number of each shot.
    replicate: u32,
    shot: u32,
    unshot: Vec<Rgb>,
    arrived: Vec<Rgb>,
    /// The initial power: emission of patches, and irradiance from other lights.
    emitted: Rgb,
    /// The power that has escaped, and that has reached black sides.
    escaped: Rgb,
    behind: Rgb,
    /// The total initial power.
    first: f64,
    rays: u64,
}

impl Shots {
    /// Start with the emission of patches, and their reflection of lights that are not surfaces, if any. The latter are
    /// sampled with the given total number of rays, at least one for each source with an area.
    pub fn new(
        scene: &Scene,
        lamps: Option<(&Scene, u64)>,
        enclosure: &Enclosure,
        (seed, replicate): (u64, u32),
        cancel: &Cancel,
    ) -> Self {
        let sources = 0..enclosure.sources() as u32;
        let mut arrived = vec![Rgb::ZERO; sources.len()];
        let mut drawn = 0;
        if let Some((lamps, rays)) = lamps {
            let whole: f64 = sources.clone().map(|source| enclosure.area(source)).sum();
            let rays_of = |source: u32| match enclosure.area(source) {
                0.0 => 0,
                area => (rays as f64 * area / whole).ceil().clamp(1.0, 1e9) as u32,
            };
            let rays: Vec<u32> = sources.clone().map(rays_of).collect();
            drawn = rays.iter().map(|&rays| u64::from(rays)).sum();
            let light = first_light::irradiance(scene, lamps, enclosure, &rays, key(seed, replicate, 0), cancel);
            for source in sources.clone() {
                arrived[source as usize] = light[source as usize] * enclosure.area(source);
            }
        }
        let to_shoot = |source: u32| {
            let at = source as usize;
            enclosure.emission[at] * enclosure.area(source) + arrived[at] * enclosure.reflectance[at]
        };
        let unshot: Vec<Rgb> = sources.map(to_shoot).collect();
        let first = unshot.iter().map(|power| power.mean()).sum();
        let each = arrived.iter().zip(&enclosure.emission).enumerate();
        let emitted = each.map(|(at, (light, emission))| *light + *emission * enclosure.area(at as u32)).sum();
        let (escaped, behind) = (Rgb::ZERO, Rgb::ZERO);
        Self { replicate, shot: 0, unshot, arrived, emitted, escaped, behind, first, rays: drawn }
    }

    /// Shoot the unshot power of all sources. The full initial power would take about `rays` rays. Each source gets a
    /// number in proportion to its power, and at least one.
    pub fn shoot_all(&mut self, scene: &Scene, enclosure: &Enclosure, rays: u64, seed: u64, cancel: &Cancel) {
        let mut whole = 0.0;
        let share = rays as f64 / self.first;
        let mut sources = Vec::new();
        for (source, power) in self.unshot.iter().enumerate() {
            if power.is_black() {
                continue;
            }
            let before = whole;
            whole += power.mean() * share;
            sources.push((source as u32, ((whole.floor() - before.floor()) as u64).clamp(1, 1 << 30) as u32));
        }
        self.shoot(scene, enclosure, &sources, seed, cancel);
    }

    /// Shoot sources one after another, each time the one with the greatest unshot power.
    pub fn shoot_greatest(
        &mut self,
        scene: &Scene,
        enclosure: &Enclosure,
        (count, rays): (u32, u64),
        seed: u64,
        cancel: &Cancel,
    ) {
        /// A single ray would carry all power of a patch to one other.
        const LEAST: f64 = 16.0;
        for _ in 0..count {
            let most = self.unshot.iter().enumerate().max_by(|a, b| a.1.mean().total_cmp(&b.1.mean()));
            let Some((source, power)) = most.filter(|(_, power)| !power.is_black() && !cancel.is_raised()) else {
                return;
            };
            let rays = (rays as f64 * power.mean() / self.first).clamp(LEAST, f64::from(1 << 30)) as u32;
            self.shoot(scene, enclosure, &[(source as u32, rays)], seed, cancel);
        }
    }

    fn shoot(&mut self, scene: &Scene, enclosure: &Enclosure, sources: &[(u32, u32)], seed: u64, cancel: &Cancel) {
        self.shot += 1;
        let key = key(seed, self.replicate, self.shot);
        let carried: Vec<Rgb> = sources
            .iter()
            .map(|&(source, rays)| std::mem::take(&mut self.unshot[source as usize]) / f64::from(rays))
            .collect();
        // The targets of some million rays at a time, to limit memory.
        for part in parts(sources, 1 << 22) {
            let (sources, carried) = (&sources[part.clone()], &carried[part]);
            let pieces = pieces(sources);
            let targets: Vec<Vec<u32>> = parallel::map_parts(pieces, |piece| {
                if cancel.is_raised() { Vec::new() } else { follow(scene, enclosure, &piece, key) }
            });
            let mut target = targets.into_iter().flatten();
            for (&(_, rays), &power) in sources.iter().zip(carried) {
                for to in target.by_ref().take(rays as usize) {
                    self.receive(enclosure, to, power);
                }
                self.rays += u64::from(rays);
            }
        }
    }

    #[inline]
    fn receive(&mut self, enclosure: &Enclosure, to: u32, power: Rgb) {
        match to {
            ESCAPED => self.escaped += power,
            BEHIND => self.behind += power,
            to => {
                self.arrived[to as usize] += power;
                self.unshot[to as usize] += power * enclosure.reflectance[to as usize];
            }
        }
    }

    /// The power that has arrived at each source, W.
    pub fn arrived(&self) -> &[Rgb] {
        &self.arrived
    }

    /// The unshot power of each source, W.
    pub fn unshot(&self) -> &[Rgb] {
        &self.unshot
    }

    /// The initial power, W: emission, and irradiance of patches from other lights.
    pub fn emitted(&self) -> Rgb {
        self.emitted
    }

    /// The power that has escaped, and that has reached black sides, W.
    pub fn lost(&self) -> (Rgb, Rgb) {
        (self.escaped, self.behind)
    }

    /// The number of rays so far.
    pub fn rays(&self) -> u64 {
        self.rays
    }
}

/// The random key of a shot.
fn key(seed: u64, replicate: u32, shot: u32) -> u64 {
    let [a, b, _, _] = philox4x32([shot, replicate, 0, 0x7261_6469], [seed as u32, (seed >> 32) as u32]);
    u64::from(a) << 32 | u64::from(b)
}

/// Split sources into parts of about `most` rays.
fn parts(sources: &[(u32, u32)], most: u64) -> Vec<Range<usize>> {
    let (mut parts, mut start, mut rays) = (Vec::new(), 0, 0);
    for (i, &(_, more)) in sources.iter().enumerate() {
        rays += u64::from(more);
        if rays >= most || i + 1 == sources.len() {
            parts.push(start..i + 1);
            (start, rays) = (i + 1, 0);
        }
    }
    parts
}

/// Pieces of rays that are traced together, each with source, first number and count.
fn pieces(sources: &[(u32, u32)]) -> Vec<Vec<(u32, u32, u32)>> {
    let (mut pieces, mut piece, mut room) = (Vec::new(), Vec::new(), TOGETHER);
    for &(source, rays) in sources {
        let mut from = 0;
        while from < rays {
            let count = (rays - from).min(room);
            piece.push((source, from, count));
            (from, room) = (from + count, room - count);
            if room == 0 {
                pieces.push(std::mem::take(&mut piece));
                room = TOGETHER;
            }
        }
    }
    pieces.push(piece);
    pieces
}

/// The sources that rays hit, ray by ray.
fn follow(scene: &Scene, enclosure: &Enclosure, piece: &[(u32, u32, u32)], key: u64) -> Vec<u32> {
    let kind = SamplerKind::Sobol(BatchSize::new(64).unwrap_or_default());
    let mut rays = Vec::with_capacity(TOGETHER as usize);
    let mut places = Vec::with_capacity(TOGETHER as usize);
    for &(source, from, count) in piece {
        for number in from..from + count {
            let mut sampler = kind.sampler(key, source, number);
            let origin = Origin::draw(scene, enclosure, source, sampler.two(0));
            places.push(origin.as_ref().map_or((Ray::NO_TRIANGLE, 1.0, DVec3::ZERO), Origin::place));
            rays.push(origin.map_or(NOWHERE, |origin| origin.leave(sampler.two(1))));
        }
    }
    let mut hits = vec![Hit::MISS; rays.len()];
    scene.intersect(&rays, &mut hits);
    let to = |((ray, hit), &from): ((&Ray, &Hit), &(u32, f64, DVec3))| {
        let lost = if hit.is_hit() { BEHIND } else { ESCAPED };
        enclosure.met(scene, from, ray, hit).unwrap_or(lost)
    };
    rays.iter().zip(&hits).zip(&places).map(to).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Sides;
    use super::*;
    use raywright_scene::Patches;
    use raywright_scene::fixtures::{cornell, furnace};

    fn enclosure(scene: &Scene, cut: u32, sides: Sides) -> Enclosure {
        use raywright_accel::Primitives;
        Enclosure::new(scene, Patches::new(vec![cut; scene.geometry().count()]).unwrap(), sides).unwrap()
    }

    #[test]
    fn what_is_emitted_is_absorbed_leaves_or_is_unshot() {
        let (scene, _) = cornell(8, 8);
        for sides in [Sides::Front, Sides::Both] {
            let enclosure = enclosure(&scene, 2, sides);
            let mut shots = Shots::new(&scene, None, &enclosure, (1, 0), &Cancel::default());
            let emitted = shots.emitted();
            for step in 0..6 {
                if step % 2 == 0 {
                    shots.shoot_all(&scene, &enclosure, 5000, 1, &Cancel::default());
                } else {
                    shots.shoot_greatest(&scene, &enclosure, (20, 5000), 1, &Cancel::default());
                }
                let each = shots.arrived().iter().zip(enclosure.reflectance());
                let absorbed: Rgb = each.map(|(arrived, reflectance)| *arrived * (Rgb::ONE - *reflectance)).sum();
                let unshot: Rgb = shots.unshot().iter().copied().sum();
                let (escaped, behind) = shots.lost();
                let off = (absorbed + unshot + escaped + behind - emitted).abs().max();
                // Sums of a few thousand terms.
                assert!(off < 1e-12 * emitted.max(), "{off}");
            }
            assert!(shots.rays() > 5000);
        }
    }

    #[test]
    fn in_a_furnace_all_that_is_sent_arrives_and_none_behind() {
        let scene = furnace(0.5, 1.0);
        let enclosure = enclosure(&scene, 1, Sides::Front);
        let mut shots = Shots::new(&scene, None, &enclosure, (7, 3), &Cancel::default());
        for _ in 0..60 {
            shots.shoot_all(&scene, &enclosure, 20_000, 7, &Cancel::default());
        }
        let arrived: Rgb = shots.arrived().iter().copied().sum();
        // An area of 24 emits π and reflects a half: each point receives π / (1 − ½), up to rounding.
        assert!((arrived.mean() / (24.0 * std::f64::consts::TAU) - 1.0).abs() < 1e-12);
        assert_eq!(shots.lost(), (Rgb::ZERO, Rgb::ZERO));
    }

    #[test]
    fn shots_are_the_same_for_any_number_of_threads() {
        let (scene, _) = cornell(8, 8);
        let enclosure = enclosure(&scene, 3, Sides::Both);
        let run = |threads| {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            pool.install(|| {
                let mut shots = Shots::new(&scene, None, &enclosure, (5, 1), &Cancel::default());
                shots.shoot_all(&scene, &enclosure, 20_000, 5, &Cancel::default());
                shots.arrived().to_vec()
            })
        };
        assert_eq!(run(1), run(3));
    }
}
