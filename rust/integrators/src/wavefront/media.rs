//! State of paths in scenes with media or nested dielectrics, by sample.

use super::flights::{Flight, FlightQueue};
use super::media_sharing::MediaSharing;
use super::queues::Extra;
use crate::media::distance_sampling::{Collision, MediumSegment};
use crate::media::equiangular::{PointLights, ScatteringSpan};
use crate::media::path_numbers::FurtherNumbers;
use crate::media::path_reuse::can_share;
use crate::media::spectral_mis::Weights;
use crate::mis_weight::power_heuristic;
use raywright_base::math::{DVec3, PathRays, Ray};
use raywright_optics::{Phase, Rgb};
use raywright_scene::media::Coefficients;
use raywright_scene::{LightSampleContext, Scene};

/// Per-thread state for scenes with media or nested dielectrics.
pub(super) struct Media<'a> {
    /// By sample.
    pub paths: Vec<PathMedia>,
    pub further: Vec<FurtherNumbers>,
    /// The paths that a medium scatters.
    pub scattered: Vec<MediumScattering>,
    /// By place in the queue, whether a path has come to no surface and not left the scene.
    pub is_within: Vec<bool>,
    /// Point lights that light homogeneous media; and where each scattered path was, if there are any.
    pub points: PointLights<'a>,
    pub spans: Vec<ScatteringSpan>,
    /// Shadow rays from places on the ways of paths to point lights.
    pub on_the_way: FlightQueue,
    /// State of path sharing, if paths share.
    pub sharing: Option<MediaSharing>,
}

/// State of the path of a sample.
#[derive(Clone, Copy)]
pub(super) struct PathMedia {
    /// Media at the origin of its ray, and behind the surface that it has come to: numbers in [`MediumStacks`].
    pub media: u32,
    pub through: u32,
    /// Index of refraction outside of the object that it has come to.
    pub outside: f64,
    /// The color that samples distances.
    pub hero: usize,
    /// Density of the path for each color as the hero, relative to the mean of the three.
    pub drawn: Rgb,
    /// True if it leaves the first vertex that it shares; and the share of its way in the medium, if it came from there
    /// to a surface that may share.
    pub is_first: bool,
    pub shares: Option<f64>,
}

/// A scattering event in a medium.
#[derive(Clone, Copy)]
pub(super) struct MediumScattering {
    /// The path's place in the queue.
    pub path: u32,
    pub position: DVec3,
    /// Unit direction of incidence.
    pub before: DVec3,
    pub phase: Phase,
    /// The collision on the flight of the path.
    pub collision: Collision,
    /// True at the second vertex that the path shares.
    pub is_second: bool,
}

impl MediumScattering {
    /// Return the coefficients of a homogeneous medium.
    pub fn even(&self) -> Option<Coefficients> {
        self.collision.density.map(|_| self.collision.here)
    }
}

impl PathMedia {
    /// Of a path that starts in media.
    pub fn new(media: u32, hero: usize) -> Self {
        Self { media, through: media, outside: 1.0, hero, drawn: Rgb::ONE, is_first: false, shares: None }
    }
}

impl PathMedia {
    /// The path has come to somewhere in media, with these relative densities.
    pub fn come(&mut self, media: u32, drawn: Rgb) {
        (self.media, self.drawn) = (media, drawn);
    }
}

impl<'a> Media<'a> {
    /// Begins with the flights of so many paths.
    pub fn begin(&mut self, paths: usize) {
        self.scattered.clear();
        self.spans.clear();
        self.on_the_way.clear();
        self.is_within.clear();
        self.is_within.resize(paths, false);
    }

    /// Those of a scene; `None` where all is empty space, but for glass objects that stand apart.
    pub fn of(scene: &'a Scene, shares: bool, scatters: bool, extra: Extra) -> Option<Self> {
        let needs = scene.plan().needs();
        (needs.media || needs.nested).then(|| Self {
            paths: Vec::new(),
            further: Vec::new(),
            scattered: Vec::new(),
            is_within: Vec::new(),
            points: if scatters { PointLights::of(scene) } else { PointLights::default() },
            spans: Vec::new(),
            on_the_way: FlightQueue::new(extra),
            sharing: (shares && can_share(scene)).then(MediaSharing::default),
        })
    }
}

impl Media<'_> {
    /// Queues a shadow ray from a place on the way of a path, in a homogeneous medium, to a point light, by two uniform
    /// numbers. It counts beside light that is drawn where the path is scattered.
    pub fn light_on_the_way(
        &mut self,
        flight: &Flight,
        (ray, segment): (&Ray, &MediumSegment<'_>),
        here: &Coefficients,
        u: [f64; 2],
    ) {
        let Some((light, t, pdf)) = self.points.sample(ray, segment.span, u) else { return };
        let (position, before) = (ray.at(t), ray.direction / segment.length);
        let receiver = LightSampleContext { waves: segment.waves, ..LightSampleContext::free(position) };
        let Some(drawn) = light.sample(&receiver, [0.5; 2]) else { return };
        let Some(source) = drawn.source else { return };
        let (weights, left) = (flight.weights, here.left(segment.way(0.0, t)));
        let of_path = (weights.drawn * here.extinction * left).mean() / weights.drawn.mean();
        let scattered = here.scattering * left * segment.medium.phase().pdf(before, drawn.direction);
        let carried = weights.carried * scattered * drawn.weight * (power_heuristic(pdf, of_path) / pdf);
        if carried.is_black() {
            return;
        }
        let way = (source.position() - position).length();
        let weights = Weights { carried, drawn: Rgb::ZERO, asked: weights.drawn };
        let shadow = Flight { way, weights, ..*flight };
        let ray_to_light = (position, drawn.direction.as_vec3().to_array());
        self.on_the_way.push_ray(shadow, ray_to_light, PathRays::END * way, [Ray::NO_TRIANGLE; 2], ray.time);
    }
}
