//! Vertices of light paths and of bidirectional camera paths.
//!
//! In media, the extinction takes the place of the surface cosine. A direction of density p that arrives over a
//! distance d has the density p σ / d² per volume, as it has p cos θ / d² per area on a surface. So MIS treats both
//! alike. Transmittance is left out of these densities: it is common to all strategies except for the connecting
//! segment. σ is the mean over the wavelengths. The weights of all strategies still sum to 1, as all use the same
//! densities. Contributions stay as bounded as without media, since their own transmittance is included.

use super::adjoint::{Arrived, Onward, onward_pdf};
use crate::is_matt;
use crate::media::current_medium::{self, Filled};
use crate::media::distance_sampling::Collision;
use crate::media::scattering::Scattering;
use crate::nesting::MediumStack;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::media::Coefficients;
use raywright_scene::{Interaction, LightSampleContext, RayOrigin, Scene, SurfaceInteraction};

/// A vertex of a path.
#[derive(Clone)]
pub(crate) struct Vertex<'a> {
    pub point: Point<'a>,
    /// The incident ray, and its `t` at the vertex.
    pub ray: Ray,
    pub t: f64,
    /// Media on the side of incidence.
    pub media: MediumStack<Filled>,
}

/// Scattering at a vertex.
#[derive(Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are of the larger one, and a box would be allocated for each"
)]
pub(crate) enum Point<'a> {
    Surface {
        /// The interaction of a ray without width, which MIS densities refer to.
        arrived: Arrived<'a>,
        /// The interaction of the camera path's wide ray, if that differs.
        wide: Option<Box<SurfaceInteraction>>,
    },
    Medium {
        here: Scattering,
        /// Coefficients of the medium there.
        medium: Coefficients,
        /// Replacement for the cosine; it is the same for all paths and wavelengths.
        density: f64,
        /// Path weight as in [`Collision::came`].
        came: Rgb,
    },
}

/// A light vertex as seen from a camera vertex.
pub(crate) struct ConnectedVertex {
    /// Share of the flux per solid angle in its direction.
    pub sent: Rgb,
    /// Density with which a camera path from there would continue back along the light path.
    pub back: f64,
    /// Context for light sampling.
    pub receiver: LightSampleContext,
}

impl<'a> Vertex<'a> {
    /// Make the vertex of a ray's hit, given the media on both sides.
    #[inline(always)]
    pub fn of_surface(
        scene: &'a Scene,
        (ray, hit): (Ray, Hit),
        outside: f64,
        (media, through): (MediumStack<Filled>, MediumStack<Filled>),
        waves: Option<Waves>,
    ) -> Self {
        let arrived = match waves {
            None => Arrived::new(scene, ray, hit, outside),
            Some(waves) => {
                let around = [&media, &through].map(MediumStack::dispersion);
                Arrived::by_waves(scene, (ray, hit), (outside, around), waves)
            }
        };
        Self { point: Point::Surface { arrived, wide: None }, ray, t: hit.t, media }
    }

    /// Set the previous vertex of the path, at a distance. The ray may have started later, behind boundaries and masks.
    pub fn come_from(&mut self, vertex: DVec3, distance: f64) {
        (self.ray.origin, self.t) = (vertex, distance);
        if let Point::Surface { arrived, .. } = &mut self.point {
            (arrived.ray.origin, arrived.hit.t) = (vertex, distance);
        }
    }

    pub fn of_medium(
        scene: &Scene,
        here: Scattering,
        collision: &Collision,
        (ray, media): (Ray, MediumStack<Filled>),
        waves: Option<&Waves>,
    ) -> Self {
        let Collision { t, here: medium, came, .. } = *collision;
        let plain =
            |_: &Waves| current_medium::around(scene, &media, &ray).map(|(medium, within)| medium.at(within.at(t)));
        let density = waves.and_then(plain).unwrap_or(medium).extinction.mean();
        Self { point: Point::Medium { here, medium, density, came }, ray, t, media }
    }

    /// Return the direction back along the incident ray.
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

    /// Return the surface, if it is a matte one.
    pub fn matte(&self) -> Option<&Arrived<'a>> {
        match &self.point {
            Point::Surface { arrived, .. } if is_matt(arrived.here.bsdf()) => Some(arrived),
            _ => None,
        }
    }

    /// Return whether it has delta directions only.
    pub fn is_single(&self) -> bool {
        matches!(&self.point, Point::Surface { arrived, .. } if arrived.here.bsdf().is_delta())
    }

    /// Return true if light to or from a direction certainly contributes nothing: a cheap test.
    pub fn is_hidden_from(&self, direction: DVec3) -> bool {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.is_through(direction) && !arrived.here.bsdf().transmits(),
            Point::Medium { .. } => false,
        }
    }

    /// Return the cosine of a direction, or its replacement in a medium.
    pub fn cosine(&self, direction: DVec3) -> f64 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.cosine(direction),
            Point::Medium { density, .. } => *density,
        }
    }

    /// Return the context for light sampling.
    pub fn receiver(&self) -> LightSampleContext {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.here.light_context(),
            Point::Medium { here, .. } => here.light_context(),
        }
    }

    /// Evaluate as [`Interaction::evaluate`] does.
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        match &self.point {
            Point::Surface { arrived, wide: None, .. } => arrived.here.evaluate(direction),
            Point::Surface { arrived, wide: Some(wide), .. } => {
                (wide.evaluate(direction).0, arrived.here.evaluate(direction).1)
            }
            Point::Medium { here, .. } => here.evaluate(direction),
        }
    }

    /// Return the density with which a light path from a direction continues along this camera path.
    pub fn light_back_pdf(&self, direction: DVec3) -> f64 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.met_from(direction, 1.0, 0.0).onward_pdf(arrived.back()),
            Point::Medium { here, .. } => here.evaluate(direction).1,
        }
    }

    /// Return the density with which this light path continues in a direction.
    pub fn light_pdf(&self, direction: DVec3) -> f64 {
        match &self.point {
            Point::Surface { arrived, .. } => onward_pdf(&arrived.here, direction),
            Point::Medium { here, .. } => here.evaluate(direction).1,
        }
    }

    /// Return this light vertex as seen from a direction and distance.
    pub fn met_from(&self, direction: DVec3, distance: f64) -> ConnectedVertex {
        match &self.point {
            Point::Surface { arrived, .. } => {
                let met = arrived.met_from(direction, distance, 0.0);
                let (value, back) = met.evaluate(arrived.back());
                ConnectedVertex { sent: arrived.share(direction, || value), back, receiver: met.light_context() }
            }
            Point::Medium { here, .. } => {
                let (sent, back) = here.evaluate(direction);
                ConnectedVertex { sent, back, receiver: here.light_context() }
            }
        }
    }

    /// Return the share of this light path's flux per solid angle in a direction. The viewer has a given distance and
    /// ray width.
    pub fn towards(&self, direction: DVec3, distance: f64, width: f64) -> Rgb {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.towards(direction, distance, width),
            Point::Medium { here, .. } => here.evaluate(direction).0,
        }
    }

    /// Sample the next direction of a light path.
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

    /// Return whether the camera path's wide ray has a different interaction.
    pub fn is_wide(&self) -> bool {
        matches!(&self.point, Point::Surface { wide: Some(_), .. })
    }

    /// Return the primitive.
    pub fn primitive(&self) -> u32 {
        match &self.point {
            Point::Surface { arrived, .. } => arrived.hit.primitive,
            Point::Medium { .. } => Ray::NO_TRIANGLE,
        }
    }
}
