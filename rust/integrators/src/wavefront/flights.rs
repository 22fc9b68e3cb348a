//! Rays on their way through media: paths to their next events, and shadow rays to lights. All take one step at a time,
//! up to their first hits.

use super::medium_stacks::MediumStacks;
use super::queues::Extra;
use crate::boundary_queries::BoundaryQueries;
use crate::media::current_medium::Filled;
use crate::media::distance_sampling::MediumSegment;
use crate::media::hit_classification::{ClassifiedHit, classify, straight};
use crate::media::spectral_mis::Weights;
use crate::nesting::{Filling, MediumStack};
use crate::shadows::opacity;
use raywright_base::math::{DVec3, Hit, LANES, PathRays, Ray};
use raywright_base::simd::Level;
use raywright_optics::spectra::Waves;
use raywright_scene::{Scene, SurfaceBlock};

/// A path, or a shadow ray, on its way. Its ray starts where its current medium does.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    /// Index in its queue, and sample.
    pub place: u32,
    pub sample: u32,
    /// The media around it.
    pub media: u32,
    /// Number of boundaries that it has passed. A partial passage counts as several.
    pub passed: u32,
    pub weights: Weights,
    /// For a path: remaining optical depth of its hero before the next scattering event.
    pub depth: f64,
    /// For a shadow ray: remaining length to the light.
    pub way: f64,
}

/// Flights with their rays.
pub(super) struct FlightQueue {
    pub rays: PathRays,
    pub all: Vec<Flight>,
}

/// Per-thread state of the flights of a batch.
pub(super) struct Flights<'a> {
    pub stacks: MediumStacks<'a>,
    pub now: FlightQueue,
    /// Flights after a boundary.
    pub next: FlightQueue,
    pub primitives: Vec<u32>,
    /// All of the hits, in scenes where the primitive does not tell the rest.
    pub hits: Vec<Hit>,
    has_hits: bool,
    /// Indices of the flights with a hit.
    pub which: Vec<u32>,
    pub surfaces: SurfaceBlock,
    /// Recent interfaces.
    known: Vec<Option<KnownInterface>>,
    /// Flights whose hit may have other surfaces close by.
    unclear: Vec<(Flight, Ray)>,
    boundaries: BoundaryQueries,
}

/// The interface at a hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    /// The media behind.
    pub through: u32,
    /// Index of refraction outside of the object, or around an open one; `None` at a mere boundary of media.
    pub outside: Option<f64>,
    /// True if it is a surface that some rays pass, as a mask or a thin pane.
    pub may_pass: bool,
}

/// The interface at hits of a shape by rays in some media, from the front or from behind.
#[derive(Clone, Copy)]
struct KnownInterface {
    of: (u32, u32, bool),
    interface: Interface,
    /// True if it holds only where nothing else is near.
    is_closed: bool,
}

/// Number of interfaces that are remembered, a power of 2.
const KNOWN: usize = 256;

/// The hit of a flight.
pub(super) struct Stop<'s> {
    pub interface: Interface,
    pub ray: &'s Ray,
    /// The `t` there, and the position.
    pub t: f64,
    pub position: DVec3,
    pub primitive: u32,
    /// The whole hit, if that is known already.
    hit: Option<Hit>,
    /// The lane with the rest of it.
    lane: usize,
}

/// Continuation of a flight after a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Passage {
    /// It does not.
    Ends,
    /// Through an interface.
    Through,
    /// In the same media, as through a mask.
    Along,
}

/// Actions of flights.
pub(super) trait Traveller {
    /// Takes a flight along its ray up to a `t`, infinite if it hits nothing. Returns whether it comes there.
    fn travel(&mut self, flight: &mut Flight, stacks: &MediumStacks<'_>, ray: &Ray, end: f64) -> bool;

    /// A flight has hit nothing.
    fn leave(&mut self, flight: &mut Flight, stacks: &MediumStacks<'_>, ray: &Ray);

    /// A flight has hit something.
    fn arrive(&mut self, flight: &mut Flight, flights: &Flights<'_>, at: &Stop<'_>) -> Passage;

    /// The greatest `t` of a flight's next ray.
    fn reach(&self, flight: &Flight, stacks: &MediumStacks<'_>) -> f64;
}

impl FlightQueue {
    pub fn new(extra: Extra) -> Self {
        let rays = PathRays::with_room(LANES, false);
        Self { rays: if extra.time { rays.with_times() } else { rays }, all: Vec::new() }
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.rays.len = 0;
        self.all.clear();
    }

    /// Appends a flight along number `i` of some rays, from an origin on; up to `t_max`.
    #[inline]
    pub fn push(&mut self, flight: Flight, from: &PathRays, i: usize, origin: DVec3, t_max: f64, misses: [u32; 2]) {
        let direction = from.direction.each_ref().map(|column| column[i]);
        self.push_ray(flight, (origin, direction), t_max, misses, from.time(i));
    }

    /// Appends a flight along a ray.
    #[inline]
    pub fn push_ray(
        &mut self,
        flight: Flight,
        (origin, direction): (DVec3, [f32; 3]),
        t_max: f64,
        misses: [u32; 2],
        time: f64,
    ) {
        let to = self.rays.len;
        let rays = &mut self.rays;
        rays.make_room(to + 1);
        for axis in 0..3 {
            (rays.origin[axis][to], rays.direction[axis][to]) = (origin[axis], direction[axis]);
        }
        (rays.t_max[to], rays.misses[to]) = (t_max, misses);
        if !rays.time.is_empty() {
            rays.time[to] = time;
        }
        rays.len += 1;
        self.all.push(flight);
    }
}

impl Flight {
    /// Return its segment from the origin of a ray up to a `t`, if that is in a medium.
    #[inline]
    pub fn segment<'a>(
        &self,
        stacks: &MediumStacks<'a>,
        (scene, waves): (&Scene, Option<Waves>),
        ray: &Ray,
        end: f64,
    ) -> Option<MediumSegment<'a>> {
        let (medium, within) = stacks.get(self.media).around(scene, ray)?;
        let (span, length) = ([0.0, end], ray.direction.length());
        Some(MediumSegment { medium, ray: within, span, length, scatters: stacks.scatters, roulette: false, waves })
    }
}

impl<'a> Flights<'a> {
    pub fn new(scene: &'a Scene, scatters: bool, extra: Extra) -> Self {
        let needs = scene.plan().needs();
        Self {
            stacks: MediumStacks::new(scene, scatters),
            now: FlightQueue::new(extra),
            next: FlightQueue::new(extra),
            primitives: Vec::new(),
            hits: Vec::new(),
            has_hits: needs.instances || needs.motion || scene.geometry().is_extreme(),
            which: Vec::new(),
            surfaces: SurfaceBlock::NONE,
            known: vec![None; KNOWN],
            unclear: Vec::new(),
            boundaries: BoundaryQueries::default(),
        }
    }

    /// Find the first hits of all flights.
    pub fn find_closest(&mut self, scene: &Scene, level: Level) {
        let rays = &self.now.rays;
        self.primitives.resize(rays.len + LANES, 0);
        if self.has_hits {
            self.hits.resize(rays.len, Hit::MISS);
            scene.first_hits(rays, &mut self.hits);
            for (primitive, hit) in self.primitives.iter_mut().zip(&self.hits) {
                *primitive = if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
            }
        } else {
            scene.first_primitives(level, rays, &mut self.primitives);
        }
        self.which.clear();
        let met = (0u32..).zip(&self.primitives[..rays.len]);
        self.which.extend(met.filter(|&(_, &primitive)| primitive != Ray::NO_TRIANGLE).map(|(i, _)| i));
    }

    /// The whole hit of a stop, with its ray of unit direction.
    pub fn hit_of(&self, scene: &Scene, at: &Stop<'_>) -> (Ray, Hit) {
        match at.hit {
            Some(hit) => (*at.ray, hit),
            None => scene.geometry().hit_of_lane((&self.now.rays, &self.hits), &self.surfaces, at.lane),
        }
    }

    /// Takes all flights one step, up to their first hits. Those that pass these are the next.
    pub fn step(&mut self, scene: &Scene, level: Level, traveller: &mut dyn Traveller) {
        self.find_closest(scene, level);
        self.next.clear();
        for i in 0..self.now.rays.len {
            if self.primitives[i] == Ray::NO_TRIANGLE {
                let (mut flight, ray) = (self.now.all[i], self.now.rays.get(i));
                if traveller.travel(&mut flight, &self.stacks, &ray, f64::INFINITY) {
                    traveller.leave(&mut flight, &self.stacks, &ray);
                }
            }
        }
        for start in (0..self.which.len()).step_by(LANES) {
            let some = &self.which[start..self.which.len().min(start + LANES)];
            let met = (&self.primitives[..], &self.hits[..]);
            scene.geometry().meet_block(level, &self.now.rays, met, some, &mut self.surfaces);
            for lane in 0..self.surfaces.count {
                self.step_lane(scene, traveller, lane);
            }
        }
        self.step_unclear(scene, traveller);
        std::mem::swap(&mut self.now, &mut self.next);
    }

    fn step_lane(&mut self, scene: &Scene, traveller: &mut dyn Traveller, lane: usize) {
        let i = self.surfaces.index[lane] as usize;
        let (mut flight, ray) = (self.now.all[i], self.now.rays.get(i));
        let position = self.surfaces.position.get(lane);
        let t = (position - ray.origin).length() / ray.direction.length();
        if !traveller.travel(&mut flight, &self.stacks, &ray, t) {
            return;
        }
        let Some(interface) = self.interface(scene, flight.media, lane) else {
            return self.unclear.push((flight, ray));
        };
        let primitive = self.surfaces.primitive[lane];
        let at = Stop { interface, ray: &ray, t, position, primitive, hit: None, lane };
        let passage = traveller.arrive(&mut flight, self, &at);
        self.go_on(traveller, flight, (passage, &at), self.surfaces.origin_behind(lane));
    }

    fn step_unclear(&mut self, scene: &Scene, traveller: &mut dyn Traveller) {
        if self.unclear.is_empty() {
            return;
        }
        let unclear = std::mem::take(&mut self.unclear);
        // Nearness is decided by `t` to the last bit.
        let rays: Vec<Ray> = unclear.iter().map(|&(_, ray)| ray).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        scene.intersect(&rays, &mut hits);
        let mut boundaries = std::mem::take(&mut self.boundaries);
        boundaries.find::<Filled>(scene, rays.iter().copied(), &hits);
        for (k, ((mut flight, ray), hit)) in unclear.iter().copied().zip(&hits).enumerate() {
            let ray = &ray;
            if !hit.is_hit() {
                traveller.leave(&mut flight, &self.stacks, ray);
                continue;
            }
            let media = self.stacks.get(flight.media).media;
            let met = match boundaries.crossed(k, hit) {
                Some((crossed, beyond)) => classify(scene, ray, (hit, beyond), &media, crossed),
                None => open(scene, hit, &media),
            };
            let (interface, hit, beyond) = match met {
                ClassifiedHit::Passed(beyond, through) => {
                    (Interface { through: self.stacks.number(&through), outside: None, may_pass: false }, *hit, beyond)
                }
                ClassifiedHit::Surface { hit, outside, through, beyond } => {
                    (Interface::of_surface(scene, &hit, outside, self.stacks.number(&through)), hit, beyond)
                }
            };
            let (t, position) = (hit.t, ray.at(hit.t));
            let at = Stop { interface, ray, t, position, primitive: hit.primitive, hit: Some(hit), lane: 0 };
            let passage = traveller.arrive(&mut flight, self, &at);
            self.go_on(traveller, flight, (passage, &at), ray.at(beyond));
        }
        (self.unclear, self.boundaries) = (unclear, boundaries);
        self.unclear.clear();
    }

    /// Queues the ray of a flight that passes a hit, from a point behind it.
    fn go_on(
        &mut self,
        traveller: &dyn Traveller,
        mut flight: Flight,
        (passage, at): (Passage, &Stop<'_>),
        origin: DVec3,
    ) {
        match passage {
            Passage::Ends => return,
            Passage::Through => flight.media = at.interface.through,
            Passage::Along => {}
        }
        let partial = at.interface.outside.is_some();
        flight.passed = flight.passed.saturating_add(1 + u32::from(partial));
        let (t_max, direction) = (traveller.reach(&flight, &self.stacks), at.ray.direction.as_vec3().to_array());
        self.next.push_ray(flight, (origin, direction), t_max, [at.primitive, at.ray.misses[1]], at.ray.time);
    }

    /// Return the interface at the hit of a lane, in media; `None` where others may be near.
    fn interface(&mut self, scene: &Scene, media: u32, lane: usize) -> Option<Interface> {
        let (shape, is_front) = (self.surfaces.shape[lane], self.surfaces.is_front[lane] != 0);
        let of = (media, shape, is_front);
        let slot = (media.wrapping_mul(31) ^ shape << 1 ^ u32::from(is_front)) as usize % KNOWN;
        let surfaces = &self.surfaces;
        let is_alone = || scene.plan().lone_shapes().has_lane(surfaces, lane);
        if let Some(known) = self.known[slot].filter(|known| known.of == of) {
            return (!known.is_closed || is_alone()).then_some(known.interface);
        }
        if scene.geometry().instances_of(shape).is_some() {
            return None;
        }
        let (ray, hit) = scene.geometry().hit_of_lane((&self.now.rays, &self.hits), &self.surfaces, lane);
        let is_closed = Filled::of(scene, &hit).is_some();
        if is_closed && !is_alone() {
            return None;
        }
        let stack = self.stacks.get(media).media;
        let met = if is_closed {
            classify(scene, &ray, (&hit, hit.t), &stack, std::slice::from_ref(&hit))
        } else {
            open(scene, &hit, &stack)
        };
        let interface = match met {
            ClassifiedHit::Passed(_, through) => {
                Interface { through: self.stacks.number(&through), outside: None, may_pass: false }
            }
            ClassifiedHit::Surface { hit, outside, through, .. } => {
                Interface::of_surface(scene, &hit, outside, self.stacks.number(&through))
            }
        };
        self.known[slot] = Some(KnownInterface { of, interface, is_closed });
        Some(interface)
    }

    /// Begins with a batch.
    pub fn begin(&mut self) {
        // Interfaces have the numbers of media.
        if self.stacks.forget_many() {
            self.known.fill(None);
        }
    }
}

impl Interface {
    fn of_surface(scene: &Scene, hit: &Hit, outside: f64, through: u32) -> Self {
        let material = scene.material_of(hit);
        let may_pass = !material.is_opaque() || material.boundary().is_some();
        Self { through, outside: Some(outside), may_pass }
    }
}

/// The surface at a hit of an open one, in media.
fn open(scene: &Scene, hit: &Hit, media: &MediumStack<Filled>) -> ClassifiedHit {
    let (outside, beyond) = (media.ior_around(scene, hit), hit.t.next_up());
    ClassifiedHit::Surface { hit: *hit, outside, through: *media, beyond }
}

/// The shares of rays that a surface stops, and of those that it lets pass straight on as through a pane.
pub(super) fn shares_stopped(scene: &Scene, (ray, hit): (&Ray, &Hit), outside: f64) -> [f64; 2] {
    [opacity(scene, ray, hit), straight(scene, ray, hit, outside)]
}
