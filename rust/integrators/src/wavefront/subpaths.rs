//! Subpaths from lights or from the camera, whose vertices go to a sink.

use super::queues::{Flags, ShadowQueue};
use crate::dimensions::Dimensions;
use crate::path_vertices::{Onward, Vertex};
use raywright_base::math::{DVec3, Ray, Vec3};
use raywright_base::sampling::{Sampler, SamplerColumns};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{EmissionSample, RayOrigin};
use std::cell::OnceCell;

/// Receives the vertices of subpaths.
pub(crate) trait SubpathSink<'a> {
    /// A light emits a subpath.
    fn set_out(&mut self, _path: &Subpath, _light: &EmissionSample) {}

    /// A subpath arrives at a surface or a scattering event in a medium.
    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, context: &mut VertexContext<'_>);

    /// A subpath continues, unless roulette terminates it.
    fn go_on(&mut self, _at: &Arrival<'_, 'a>, _path: &Subpath, _next: &Onward) {}

    /// Media have absorbed flux.
    fn absorb(&mut self, _flux: Rgb) {}

    /// A subpath leaves the scene along a ray.
    fn leave(&mut self, _path: &Subpath, _ray: &Ray) {}

    /// Media along the subpath of a sample bring light of their own to it.
    fn glow(&mut self, _sample: u32, _light: Rgb) {}

    /// Light arrives along a connection.
    fn receive(&mut self, _connection: &Connection, _light: Rgb) {}
}

/// The state of a subpath, beside the columns of its ray and throughput.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subpath {
    /// Index within the batch.
    pub number: u32,
    /// Largest channel of the emitted flux; 1 from the camera. Throughput in columns is relative to it.
    pub power: f64,
    /// Flux of a light subpath, or throughput of a camera subpath (pbrt-v4: beta). At a scattering event in a medium it
    /// is the scattered one.
    pub beta: Rgb,
    /// The same at the end of its ray, before the surface there has any effect.
    pub arriving: Rgb,
    /// Time as a fraction of the shutter interval; of a light subpath.
    pub time: f64,
    /// Number of scattering events. Of a light subpath this includes the current one.
    pub bounce: u32,
    /// Remaining share of a light subpath after the last surface, for a reflectance above 1 met again
    /// ([`raywright_optics::Bsdf::repeat_correction`]). It applies once it reaches another such surface: of all such
    /// surfaces of a path, the one nearest to the viewer has none.
    pub again: Rgb,
    /// True if a camera subpath has such a surface.
    pub has_gamut_excess: bool,
    /// True if the last bounce was specular or nearly so; and true if a medium scattered it.
    pub is_sharp: bool,
    pub is_adrift: bool,
    /// Number of consecutive specular reflections at transmissive surfaces ([`crate::roulette::held`]).
    pub held: u32,
    /// Wavelengths that it carries, `None` for RGB; and true if only the first is left.
    pub waves: Option<Waves>,
    pub single: bool,
}

impl Subpath {
    /// Make one that starts with a flux or throughput.
    pub fn new(number: u32, beta: Rgb, power: f64, time: f64, waves: Option<Waves>) -> Self {
        Self {
            number,
            power,
            beta,
            arriving: beta,
            time,
            bounce: 0,
            again: Rgb::ONE,
            has_gamut_excess: false,
            is_sharp: false,
            is_adrift: false,
            held: 0,
            waves,
            single: false,
        }
    }

    /// Arrive at a vertex, with a relative throughput before it and there.
    pub fn arrive(&mut self, bounce: u32, [before, here]: [Rgb; 2], flags: u32, waves: Option<Waves>) {
        (self.bounce, self.waves) = (bounce, waves);
        (self.arriving, self.beta) = (before * self.power, here * self.power);
        self.single = flags & Flags::SINGLE != 0;
        self.has_gamut_excess = flags & Flags::HAS_GAMUT_EXCESS != 0;
    }
}

/// A connection of a vertex to the camera, a light, or a vertex of another subpath.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Connection {
    /// Index of the subpath.
    pub sample: u32,
    /// Position on the film, if the camera is at the other end.
    pub film: [f64; 2],
    /// Light that arrives if nothing is in between.
    pub light: Rgb,
}

/// Random numbers and connections of a vertex.
pub(crate) struct VertexContext<'q> {
    pub(super) samplers: Option<&'q SamplerColumns>,
    pub dimensions: Dimensions,
    pub(super) shadows: &'q mut ShadowQueue,
    pub(super) connections: &'q mut Vec<Connection>,
    /// Index of the subpath; and its media in front of the surface and behind it.
    pub(super) sample: u32,
    pub(super) media: [u32; 2],
}

impl VertexContext<'_> {
    /// Return the sampler of the subpath.
    pub fn sampler(&self) -> Option<Sampler> {
        self.samplers.map(|samplers| samplers.get(self.sample as usize))
    }

    /// Return a number of a dimension.
    pub fn one(&self, dimension: u32) -> f64 {
        self.sampler().map_or(0.5, |mut sampler| sampler.one(dimension))
    }

    /// Return a pair of a dimension.
    pub fn two(&self, dimension: u32) -> [f64; 2] {
        self.sampler().map_or([0.5; 2], |mut sampler| sampler.two(dimension))
    }

    /// Connect the vertex along a segment that brings some light if nothing is in between. It ends at `film` if the
    /// camera is at the other end.
    pub fn connect(&mut self, at: &Arrival<'_, '_>, segment: &Ray, light: Rgb, film: [f64; 2]) {
        if light.is_black() || !light.is_finite() {
            return;
        }
        let is_behind = segment.direction.dot(at.normal) < 0.0;
        self.shadows.push_ray(segment, self.sample, self.media[usize::from(is_behind)], 0.0);
        self.connections.push(Connection { sample: self.sample, film, light });
    }
}

/// A vertex of a subpath. Few sinks need all of it.
pub(crate) struct Arrival<'v, 'a> {
    /// Origin of rays that leave.
    pub origin: RayOrigin,
    /// Unit direction of incidence.
    pub before: DVec3,
    /// Unit geometric normal on the side of incidence; zero in a medium.
    pub normal: DVec3,
    /// Primitive; [`Ray::NO_TRIANGLE`] in a medium.
    pub primitive: u32,
    /// Reflectance of a Lambertian surface without a shading normal.
    pub diffuse: Option<Rgb>,
    /// Width of a camera subpath there, if textures are filtered.
    pub width: f64,
    /// Scene time.
    pub time: f64,
    made: OnceCell<Vertex<'a>>,
    make: &'v dyn Fn() -> Vertex<'a>,
}

impl<'v, 'a> Arrival<'v, 'a> {
    /// Make a vertex in a medium.
    pub fn new(origin: RayOrigin, before: DVec3, time: f64, make: &'v dyn Fn() -> Vertex<'a>) -> Self {
        let (normal, primitive, diffuse) = (DVec3::ZERO, Ray::NO_TRIANGLE, None);
        Self { origin, before, normal, primitive, diffuse, width: 0.0, time, made: OnceCell::new(), make }
    }

    /// Make it a vertex on a surface of a normal and a primitive, which may be Lambertian and flat.
    pub fn on_surface(self, (normal, primitive): (Vec3, u32), width: f64, diffuse: Option<Rgb>) -> Self {
        Self { normal: normal.as_dvec3(), primitive, width, diffuse, ..self }
    }

    /// Return whether it is in a medium.
    pub fn is_in_medium(&self) -> bool {
        self.primitive == Ray::NO_TRIANGLE
    }

    /// Return the whole vertex.
    pub fn vertex(&self) -> &Vertex<'a> {
        self.made.get_or_init(self.make)
    }

    /// Return a ray that leaves, with the time of the vertex, and misses this primitive and `to`.
    pub fn leaving(&self, ray: Ray, to: u32) -> Ray {
        Ray { time: self.time, misses: [self.primitive, to], ..ray }
    }
}
