//! Points that a path has come to among media, as either end of it sees them.
//!
//! Where a path is scattered by a medium, all that is known of a surface by its cosines is known of the medium by its
//! extinction: a direction of density p that comes there over a distance d has the density p σ / d² by volume, as it
//! has p cos θ / d² by area on a surface. So both are weighed alike. What is left out of the densities is how much
//! light gets through on the way, which all ways to find a path have in common but for the part on which its ends are
//! connected; and σ is the mean of the wavelengths'. Weights of all ways still add up to 1, as all put the same in, and
//! what a way brings stays as bounded as without media: its own transmittance is in what it carries.

use super::filled::{self, Filled};
use super::flight::Collision;
use super::scattering::Scattering;
use crate::light_paths::{Arrived, Onward, onward_pdf};
use crate::nesting::MediumStack;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::media::Coefficients;
use raywright_scene::{Encounter, LightSampleContext, RayOrigin, Scene, SurfaceInteraction};

/// Where a path has come to.
#[derive(Clone)]
pub(crate) struct Vertex<'a> {
    pub point: Point<'a>,
    /// The ray that came there, and at which `t`.
    pub ray: Ray,
    pub t: f64,
    /// What is on the side that the ray came from.
    pub media: MediumStack<Filled>,
}

/// What is there.
#[derive(Clone)]
pub(crate) enum Point<'a> {
    Surface {
        /// As rays without width meet it: densities that are compared are those.
        arrived: Box<Arrived<'a>>,
        /// As a path from a camera sees it, if that differs.
        wide: Option<Box<SurfaceInteraction>>,
        /// What a ray that goes through is in.
        through: MediumStack<Filled>,
    },
    Medium {
        here: Scattering,
        /// What the medium does to light there.
        medium: Coefficients,
        /// What stands for the cosine of a direction: the same whoever comes there, at whichever wavelengths.
        density: f64,
        /// As [`Collision::came`].
        came: Rgb,
    },
}

/// A vertex as whoever comes from the other end sees it.
pub(crate) struct Met {
    /// The share of the light that is sent into a solid angle there.
    pub sent: Rgb,
    /// The density with which a walk from there would go on back along the ray.
    pub back: f64,
    /// What light is drawn for.
    pub receiver: LightSampleContext,
}

impl<'a> Vertex<'a> {
    pub fn of_surface(arrived: Arrived<'a>, through: MediumStack<Filled>, media: MediumStack<Filled>) -> Self {
        let (ray, t) = (arrived.ray, arrived.hit.t);
        Self { point: Point::Surface { arrived: Box::new(arrived), wide: None, through }, ray, t, media }
    }

    /// The same as a path from a camera sees it, where that differs.
    pub fn seen(mut self, seen: Option<SurfaceInteraction>) -> Self {
        if let Point::Surface { wide, .. } = &mut self.point {
            *wide = seen.map(Box::new);
        }
        self
    }

    pub fn of_medium(
        scene: &Scene,
        here: Scattering,
        collision: &Collision,
        (ray, media): (Ray, MediumStack<Filled>),
        waves: Option<&Waves>,
    ) -> Self {
        let Collision { t, here: medium, came, .. } = *collision;
        let plain = |_: &Waves| filled::around(scene, &media, &ray).map(|(medium, within)| medium.at(within.at(t)));
        let density = waves.and_then(plain).unwrap_or(medium).extinction.mean();
        Self { point: Point::Medium { here, medium, density, came }, ray, t, media }
    }

    /// Back to where it came from.
    pub fn back(&self) -> DVec3 {
        -self.ray.direction
    }

    pub fn position(&self) -> DVec3 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.position(),
            Point::Medium { here, .. } => here.position,
        }
    }

    pub fn origin(&self) -> RayOrigin {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.ray_origin(),
            Point::Medium { here, .. } => here.ray_origin(),
        }
    }

    /// Whether a medium scatters there.
    pub fn is_in_medium(&self) -> bool {
        matches!(self.point, Point::Medium { .. })
    }

    /// Whether it scatters in single directions alone.
    pub fn is_single(&self) -> bool {
        matches!(&self.point, Point::Surface { arrived, .. } if arrived.here.bsdf().is_delta())
    }

    /// Whether light cannot be scattered to or from a direction, to be told at once.
    pub fn is_hidden_from(&self, direction: DVec3) -> bool {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.is_through(direction) && !arrived.here.bsdf().transmits(),
            Point::Medium { .. } => false,
        }
    }

    /// What stands for the cosine of a direction.
    pub fn cosine(&self, direction: DVec3) -> f64 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.cosine(direction),
            Point::Medium { density, .. } => *density,
        }
    }

    /// What light is drawn for.
    pub fn receiver(&self) -> LightSampleContext {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.light_context(),
            Point::Medium { here, .. } => here.light_context(),
        }
    }

    /// As [`Encounter::evaluate`].
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        match &self.point {
            Point::Surface { arrived, wide: None, .. } => arrived.here.evaluate(direction),
            Point::Surface { arrived, wide: Some(wide), .. } => {
                (wide.evaluate(direction).0, arrived.here.evaluate(direction).1)
            }
            Point::Medium { here, .. } => here.evaluate(direction),
        }
    }

    /// Of a path from a camera, the density with which light from a direction goes on along it.
    pub fn light_back_pdf(&self, direction: DVec3) -> f64 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.met_from(direction, 1.0, 0.0).onward_pdf(arrived.back()),
            Point::Medium { here, .. } => here.evaluate(direction).1,
        }
    }

    /// Of a path of light, the density with which it goes on in a direction.
    pub fn light_pdf(&self, direction: DVec3) -> f64 {
        match &self.point {
            Point::Surface { arrived, .. } => onward_pdf(&arrived.here, direction),
            Point::Medium { here, .. } => here.evaluate(direction).1,
        }
    }

    /// Of a path of light, as somebody meets it who comes from a direction over a distance.
    pub fn met_from(&self, direction: DVec3, distance: f64) -> Met {
        match &self.point {
            Point::Surface { arrived, .. } => {
                let met = arrived.met_from(direction, distance, 0.0);
                let (value, back) = met.evaluate(arrived.back());
                Met { sent: arrived.share(direction, || value), back, receiver: met.light_context() }
            }
            Point::Medium { here, .. } => {
                let (sent, back) = here.evaluate(direction);
                Met { sent, back, receiver: here.light_context() }
            }
        }
    }

    /// Of a path of light, the share that is sent into a solid angle in a direction, seen from such a distance by what
    /// is so wide.
    pub fn towards(&self, direction: DVec3, distance: f64, width: f64) -> Rgb {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.towards(direction, distance, width),
            Point::Medium { here, .. } => here.evaluate(direction).0,
        }
    }

    /// Draws where light goes on to.
    pub fn onward(&self, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<Onward> {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.onward(choice, u),
            Point::Medium { here, .. } => {
                let next = here.sample(choice, u)?;
                let (direction, weight, pdf) = (next.wi, next.weight, next.pdf);
                Some(Onward { direction, weight, pdf, is_through: false, is_single: false })
            }
        }
    }

    /// What a ray that leaves in a direction is in.
    pub fn media(&self, direction: DVec3) -> MediumStack<Filled> {
        match &self.point {
            Point::Surface { arrived, through, .. } if arrived.here.is_through(direction) => *through,
            _ => self.media,
        }
    }

    /// What a ray that was drawn is in, by whether it goes through.
    pub fn media_after(&self, is_through: bool) -> MediumStack<Filled> {
        match &self.point {
            Point::Surface { through, .. } if is_through => *through,
            _ => self.media,
        }
    }

    /// Whether a path from a camera sees it in another way than rays without width.
    pub fn is_wide(&self) -> bool {
        matches!(&self.point, Point::Surface { wide: Some(_), .. })
    }

    /// Mean curvature, as a path from a camera sees it.
    pub fn curvature(&self) -> f64 {
        match &self.point {
            Point::Surface { wide: Some(wide), .. } => wide.curvature(),
            _ => 0.0,
        }
    }

    /// The ray that leaves, to a primitive or to none, as another has it.
    pub fn leaving(&self, ray: Ray, to: u32) -> Ray {
        Ray { time: self.ray.time, misses: [self.primitive(), to], ..ray }
    }

    /// Which primitive it is on.
    pub fn primitive(&self) -> u32 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.hit.primitive,
            Point::Medium { .. } => Ray::NO_TRIANGLE,
        }
    }

    /// What is left of light that has come by way of what gives more than there is ([`Bsdf::again`]).
    pub fn again(&self) -> Rgb {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.bsdf().again(),
            Point::Medium { .. } => Rgb::ONE,
        }
    }
}
