//! Which media a path is in.

use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Dispersive;
use raywright_scene::materials::Interior;
use raywright_scene::{RayOrigin, Scene};

/// What fills a closed surface, as far as whoever asks must know of it.
pub(super) trait Filling: Copy + PartialEq {
    /// In place of one where there is none.
    const NONE: Self;

    /// What fills that which a ray has hit; none where it encloses nothing.
    fn of(scene: &Scene, hit: &Hit) -> Option<Self>;

    /// Whether it is there, and not another, where both are.
    fn is_above(&self, other: &Self) -> bool;

    /// Its index of refraction; none if that is what is around it.
    fn ior(&self) -> Option<f64>;

    /// How that goes with wavelength.
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

/// The media that a point lies in. The one of the greatest priority is there, and the surfaces of the others, within
/// it, are not (Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced Images", 2002). Of equal priority, the
/// greater index.
#[derive(Clone, Copy, Debug)]
pub(super) struct MediumStack<F = Interior> {
    count: u32,
    interiors: [F; MOST],
}

/// How many media are told apart that a point lies in. Beyond, those of the least priority are forgotten.
const MOST: usize = 4;

impl<F: Filling> Default for MediumStack<F> {
    fn default() -> Self {
        Self::NONE
    }
}

impl<F: Filling> MediumStack<F> {
    /// In nothing.
    pub const NONE: Self = Self { count: 0, interiors: [F::NONE; MOST] };

    /// How many enclose the point.
    pub(super) fn depth(&self) -> u32 {
        self.count
    }

    /// What is there; `None` where nothing encloses the point.
    pub(super) fn top(&self) -> Option<&F> {
        self.interiors[..self.count as usize].iter().reduce(|a, b| if b.is_above(a) { b } else { a })
    }

    /// What bends light there.
    fn clear(&self) -> Option<&F> {
        let all = self.interiors[..self.count as usize].iter().filter(|interior| interior.ior().is_some());
        all.reduce(|a, b| if b.is_above(a) { b } else { a })
    }

    /// The index of refraction there.
    fn ior(&self) -> f64 {
        self.clear().and_then(F::ior).unwrap_or(1.0)
    }

    /// The index of refraction around a hit surface that encloses nothing; 1 where that makes no difference to it.
    pub(super) fn ior_around(&self, scene: &Scene, hit: &Hit) -> f64 {
        if self.count > 0 && scene.material_of(hit).minds_outside() { self.ior() } else { 1.0 }
    }

    /// How the index of refraction there goes with wavelength.
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

    /// Leaves one such medium; nothing if it is in none, as behind a surface that encloses nothing.
    fn leave(&mut self, interior: &F) {
        let all = &mut self.interiors[..self.count as usize];
        if let Some(found) = all.iter().position(|i| i == interior) {
            all.swap(found, all.len() - 1);
            self.count -= 1;
        }
    }

    /// What rays from these origins start in: each surface that encloses a medium is crossed outwards once more than
    /// inwards, on the way out, from inside of it. With open surfaces, or a camera in a wall, it may be wrong.
    pub(super) fn at(scene: &Scene, rays: &[Ray], inside: &mut Vec<Self>) {
        inside.clear();
        let region = scene.region();
        let is_within = |p: DVec3| p.cmpge(region.min).all() && p.cmple(region.max).all();
        // Rays from one point, as a pinhole's, are asked once.
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

    /// Goes through what a ray hits, along it or back. Returns the medium that it enters or leaves, and whether it
    /// enters it.
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

/// The index of refraction around what each ray hits: on the side that is not its own medium's, if it encloses one. 1
/// for rays that hit nothing, and where it makes no difference. Rays start in whatever their origins lie in.
pub fn indices_outside(scene: &Scene, rays: &[Ray], hits: &[Hit]) -> Vec<f64> {
    let mut found = vec![1.0; rays.len()];
    if !scene.plan().needs().nested {
        return found;
    }
    let met: Vec<usize> = (0..rays.len()).filter(|&i| hits[i].is_hit()).collect();
    let whole: Vec<Ray> = met.iter().map(|&i| Ray { t_max: f64::INFINITY, ..rays[i] }).collect();
    let mut media = Vec::new();
    MediumStack::<Interior>::at(scene, &whole, &mut media);
    let windows: Vec<_> = met.iter().map(|&i| around::<Interior>(scene, &rays[i], &hits[i])).collect();
    let crossings = scene.crossings(&windows.iter().flatten().copied().collect::<Vec<_>>());
    let mut next = 0;
    for ((&i, media), window) in met.iter().zip(&media).zip(&windows) {
        if window.is_none() {
            found[i] = media.ior_around(scene, &hits[i]);
            continue;
        }
        if let Boundary::Between { outside, .. } = Boundary::new(scene, &rays[i], media, crossings.of_ray(next)) {
            found[i] = outside;
        }
        next += 1;
    }
    found
}

/// What a ray crosses, of all that it is told to; not what it only touches, which is told twice.
pub(super) fn crossed(hits: &[Hit]) -> impl DoubleEndedIterator<Item = &Hit> {
    let is_twice = move |i: usize| {
        let same = |j: usize| hits.get(j).is_some_and(|other| *other == hits[i]);
        same(i + 1) || (i > 0 && same(i - 1))
    };
    (0..hits.len()).filter(move |&i| !is_twice(i)).map(move |i| &hits[i])
}

/// What a hit is to a ray among media.
#[derive(Clone, Copy, Debug)]
pub(super) enum Boundary<F = Interior> {
    /// None: the same medium is on both sides. The ray goes on in these media.
    None(MediumStack<F>),
    /// The surface hit is where one medium ends and another begins.
    Between {
        /// Which hit has the surface.
        hit: Hit,
        /// The index of refraction on the side of it that is not its own medium's.
        outside: f64,
        /// What a ray that goes through is in.
        through: MediumStack<F>,
    },
}

/// The part of a ray around a hit on whose crossings [`Boundary::new`] decides: surfaces that lie in one another, or
/// closer than rounding tells, are one boundary. `None` if the surface hit encloses nothing.
pub(super) fn around<F: Filling>(scene: &Scene, ray: &Ray, hit: &Hit) -> Option<Ray> {
    F::of(scene, hit)?;
    let surface = scene.geometry().surface(ray, hit);
    let reach = RayOrigin::reach(&surface, ray);
    Some(Ray { t_min: ray.t_min.max(hit.t - reach), t_max: (hit.t + reach).next_up(), ..*ray })
}

impl<F: Filling> Boundary<F> {
    /// What a ray in some media comes to, by what it crosses around its hit ([`around`]).
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
        // What the path never entered, as where the camera's media were told wrongly, it leaves like anything else.
        if inside.top() == through.top() && (enters || inside.top().is_some()) {
            return Self::None(through);
        }
        Self::Between { hit, outside: if enters { inside.ior() } else { through.ior() }, through }
    }
}
