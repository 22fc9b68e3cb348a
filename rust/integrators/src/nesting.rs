//! Nested dielectrics: the media at a point of a path.

use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Dispersive;
use raywright_scene::materials::Interior;
use raywright_scene::{RayOrigin, Scene};

/// The interior of a closed surface.
pub(super) trait Filling: Copy + PartialEq {
    /// Placeholder for no interior.
    const NONE: Self;

    /// Return the interior of a hit object; `None` for open surfaces.
    fn of(scene: &Scene, hit: &Hit) -> Option<Self>;

    /// Return whether this interior replaces another where they overlap.
    fn is_above(&self, other: &Self) -> bool;

    /// Return the index of refraction; `None` if it is that of the surroundings.
    fn ior(&self) -> Option<f64>;

    /// Return the dispersion.
    fn dispersion(&self) -> Dispersive;
}

impl Filling for Interior {
    const NONE: Self = Self::new(1.0, i32::MIN);

    fn of(scene: &Scene, hit: &Hit) -> Option<Self> {
        scene.material_of(hit).interior()
    }

    fn is_above(&self, other: &Self) -> bool {
        (self.priority, self.ior) > (other.priority, other.ior)
    }

    fn ior(&self) -> Option<f64> {
        Some(self.ior)
    }

    fn dispersion(&self) -> Dispersive {
        self.dispersion
    }
}

/// The interiors that contain a point. The one of highest priority exists there, and the surfaces of the others inside
/// it do not (Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced Images", 2002). Of equal priorities, the
/// higher index wins.
#[derive(Clone, Copy, Debug)]
pub(super) struct MediumStack<F = Interior> {
    count: u32,
    interiors: [F; MOST],
}

const MOST: usize = 4;

impl<F: Filling> Default for MediumStack<F> {
    fn default() -> Self {
        Self::NONE
    }
}

impl<F: Filling> MediumStack<F> {
    /// Maximum number of interiors at a point. Beyond, those of lowest priority are forgotten.
    pub const MOST: usize = MOST;

    /// No interior.
    pub const NONE: Self = Self { count: 0, interiors: [F::NONE; MOST] };

    /// Return the number of interiors.
    pub(super) fn depth(&self) -> u32 {
        self.count
    }

    /// Return the interiors, in no order.
    pub(super) fn interiors(&self) -> &[F] {
        &self.interiors[..self.count as usize]
    }

    /// Return the interior that exists there; `None` outside all.
    pub(super) fn top(&self) -> Option<&F> {
        self.interiors[..self.count as usize].iter().reduce(|a, b| if b.is_above(a) { b } else { a })
    }

    /// Return the refractive interior.
    fn clear(&self) -> Option<&F> {
        let all = self.interiors[..self.count as usize].iter().filter(|interior| interior.ior().is_some());
        all.reduce(|a, b| if b.is_above(a) { b } else { a })
    }

    /// Return the index of refraction.
    fn ior(&self) -> f64 {
        self.clear().and_then(F::ior).unwrap_or(1.0)
    }

    /// Return the index of refraction around an open surface; 1 for materials that do not depend on it.
    pub(super) fn ior_around(&self, scene: &Scene, hit: &Hit) -> f64 {
        if self.count > 0 && scene.material_of(hit).minds_outside() { self.ior() } else { 1.0 }
    }

    /// Return the dispersion.
    pub(super) fn dispersion(&self) -> Dispersive {
        self.clear().map_or(Dispersive::NONE, F::dispersion)
    }

    fn enter(&mut self, interior: F) {
        if (self.count as usize) < MOST {
            self.interiors[self.count as usize] = interior;
            self.count += 1;
            return;
        }
        let mut least = 0;
        for i in 1..MOST {
            if self.interiors[least].is_above(&self.interiors[i]) {
                least = i;
            }
        }
        if interior.is_above(&self.interiors[least]) {
            self.interiors[least] = interior;
        }
    }

    /// Leave one such interior. No effect if there is none, as behind an open surface.
    fn leave(&mut self, interior: &F) {
        let all = &mut self.interiors[..self.count as usize];
        if let Some(found) = all.iter().position(|i| i == interior) {
            all.swap(found, all.len() - 1);
            self.count -= 1;
        }
    }

    /// Find the media at ray origins: on the way out, each boundary around the point is crossed outward once more than
    /// inward. Open surfaces, or a camera in a wall, can make it wrong.
    pub(super) fn at(scene: &Scene, rays: &[Ray], inside: &mut Vec<Self>) {
        inside.clear();
        let region = scene.region();
        let is_within = |p: DVec3| p.cmpge(region.min).all() && p.cmple(region.max).all();
        // Rays with a common origin, as of a pinhole, share one query.
        let is_asked = |i: usize| is_within(rays[i].origin) && (i == 0 || rays[i].origin != rays[i - 1].origin);
        let asked: Vec<Ray> = (0..rays.len()).filter(|&i| is_asked(i)).map(|i| rays[i]).collect();
        let crossings = scene.crossings(&asked);
        let mut next = 0;
        for i in 0..rays.len() {
            let found = if is_asked(i) {
                next += 1;
                let mut found = Self::default();
                // From the last crossing back to the origin.
                for hit in crossed(crossings.of_ray(next - 1)).rev() {
                    found.pass(scene, &rays[i], hit, true);
                }
                found
            } else if is_within(rays[i].origin) {
                inside[i - 1]
            } else {
                Self::default()
            };
            inside.push(found);
        }
    }

    /// Cross a hit, along the ray or backward. Return the interior that the ray enters or leaves, and whether it enters
    /// it.
    pub(super) fn pass(&mut self, scene: &Scene, ray: &Ray, hit: &Hit, back: bool) -> Option<(F, bool)> {
        let interior = F::of(scene, hit)?;
        let surface = scene.geometry().surface(ray, hit);
        let enters = (ray.direction.dot(surface.normal) < 0.0) != back;
        if enters {
            self.enter(interior);
        } else {
            self.leave(&interior);
        }
        Some((interior, enters))
    }
}

/// Return the hits where a ray crosses a boundary, without tangential ones, which are reported twice.
pub(super) fn crossed(hits: &[Hit]) -> impl DoubleEndedIterator<Item = &Hit> {
    let is_twice = move |i: usize| {
        let same = |j: usize| hits.get(j).is_some_and(|other| *other == hits[i]);
        same(i + 1) || (i > 0 && same(i - 1))
    };
    (0..hits.len()).filter(move |&i| !is_twice(i)).map(move |i| &hits[i])
}

/// The classification of a hit in nested dielectrics.
#[derive(Clone, Copy, Debug)]
pub(super) enum Boundary<F = Interior> {
    /// No boundary: the same medium is on both sides. The ray continues in these media.
    None(MediumStack<F>),
    /// A boundary of two media.
    Between {
        /// The hit of the surface.
        hit: Hit,
        /// Index of refraction on the side away from its own interior.
        outside: f64,
        /// Media of a transmitted ray.
        through: MediumStack<F>,
    },
}

/// What may be around a hit: surfaces that coincide, or differ by less than rounding, are one boundary.
#[derive(Clone, Copy, Debug)]
pub(super) enum Vicinity {
    /// The hit surface is open.
    Open,
    /// Nothing else. The ray goes on from this `t`.
    Nothing(f64),
    /// What this span of the ray hits.
    Window(Ray),
}

impl Vicinity {
    /// Return the `t` from which a ray goes on behind its hit.
    pub fn beyond(&self, hit: &Hit) -> f64 {
        match self {
            Self::Open => hit.t.next_up(),
            Self::Nothing(beyond) => *beyond,
            Self::Window(window) => window.t_max.next_up(),
        }
    }
}

/// Return what may be around a hit.
pub(super) fn around<F: Filling>(scene: &Scene, ray: &Ray, hit: &Hit) -> Vicinity {
    if F::of(scene, hit).is_none() {
        return Vicinity::Open;
    }
    let surface = scene.geometry().surface(ray, hit);
    let reach = RayOrigin::reach(&surface, ray);
    let t_max = (hit.t + reach).next_up();
    if scene.plan().lone_shapes().has(ray, hit, &surface, reach) {
        return Vicinity::Nothing(t_max.next_up());
    }
    Vicinity::Window(Ray { t_min: ray.t_min.max(hit.t - reach), t_max, ..*ray })
}

impl<F: Filling> Boundary<F> {
    /// Classify the hit of a ray in given media, from all crossings around it ([`around`]).
    pub(super) fn new(scene: &Scene, ray: &Ray, inside: &MediumStack<F>, hits: &[Hit]) -> Self {
        let mut through = *inside;
        let mut owner: Option<(F, bool, Hit)> = None;
        for hit in crossed(hits) {
            let Some((interior, enters)) = through.pass(scene, ray, hit, false) else { continue };
            if owner.as_ref().is_none_or(|(best, ..)| interior.is_above(best)) {
                owner = Some((interior, enters, *hit));
            }
        }
        let Some((_, enters, hit)) = owner else { return Self::None(*inside) };
        // A medium that the path never entered, as with wrong initial media of a camera, is left like any other.
        if inside.top() == through.top() && (enters || inside.top().is_some()) {
            return Self::None(through);
        }
        Self::Between { hit, outside: if enters { inside.ior() } else { through.ior() }, through }
    }
}
