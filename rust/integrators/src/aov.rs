//! Auxiliary buffers (AOVs) of the first hit.

use super::boundary_queries::indices_outside;
use raywright_base::math::{Hit, Ray};
use raywright_base::parallel;
use raywright_base::sampling::SamplerKind;
use raywright_base::workers::Cancel;
use raywright_optics::Bsdf;
use raywright_scene::textures::Needs;
use raywright_scene::{Camera, Footprint, Scene, ShadingPoint, SurfaceInteraction};

/// A property of the first hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Distance along the ray.
    Depth,
    /// Position.
    Position,
    /// Unit geometric normal, by the winding.
    Normal,
    /// Unit shading normal, bumps included.
    ShadingNormal,
    /// Texture coordinates.
    Uv,
    /// Index of the shape; −1 for no hit.
    ShapeId,
    /// Index of the primitive in its shape, or of the copy; −1 for no hit.
    Primitive,
    /// Share of light that is scattered.
    Albedo,
    /// Displacement of the point during the shutter interval.
    Motion,
    /// Displacement in the picture during the shutter interval, in pixels to the right and down, including camera
    /// motion.
    ScreenMotion,
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 10] = [
        Self::Depth,
        Self::Position,
        Self::Normal,
        Self::ShadingNormal,
        Self::Uv,
        Self::ShapeId,
        Self::Primitive,
        Self::Albedo,
        Self::Motion,
        Self::ScreenMotion,
    ];

    /// Return the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Normal => "normal",
            Self::ShadingNormal => "shading_normal",
            Self::Uv => "uv",
            Self::ShapeId => "shape_id",
            Self::Primitive => "primitive_id",
            Self::Albedo => "albedo",
            Self::Motion => "motion",
            Self::ScreenMotion => "screen_motion",
        }
    }

    /// Return the number of components.
    pub fn width(self) -> usize {
        match self {
            Self::Depth | Self::ShapeId | Self::Primitive => 1,
            Self::Uv | Self::ScreenMotion => 2,
            _ => 3,
        }
    }

    /// Return whether the values are indices, which cannot be averaged: the center of the pixel has the value.
    pub fn is_id(self) -> bool {
        matches!(self, Self::ShapeId | Self::Primitive)
    }

    /// Return the value for no hit.
    pub fn nothing(self) -> f64 {
        match self {
            Self::Depth => f64::INFINITY,
            Self::ShapeId | Self::Primitive => -1.0,
            _ => 0.0,
        }
    }

    /// Return the components at a hit.
    fn observe(
        self,
        scene: &Scene,
        camera: &dyn Camera,
        (ray, hit, outside): (&Ray, &Hit, f64),
        width: f64,
    ) -> [f64; 3] {
        let geometry = scene.geometry();
        let number = |n: u32| [f64::from(n), 0.0, 0.0];
        let ends = || geometry.positions(ray, hit, [0.0, 1.0].map(|time| camera.body().scene_time(time)));
        match self {
            Self::Depth => [hit.t, 0.0, 0.0],
            Self::Position => geometry.surface(ray, hit).position.to_array(),
            Self::Normal => geometry.surface(ray, hit).normal.to_array(),
            Self::ShadingNormal => {
                let surface = geometry.surface(ray, hit);
                let material = scene.material_at(&surface);
                let point = ShadingPoint::new(geometry, ray, hit, surface, material.needs(), width);
                material.normal(&point).unwrap_or(surface.shading_normal).to_array()
            }
            Self::Uv => {
                let surface = geometry.surface(ray, hit);
                let needs = Needs { uv: true, ..Needs::NONE };
                let [u, v] = ShadingPoint::new(geometry, ray, hit, surface, needs, width).texture.uv;
                [u, v, 0.0]
            }
            Self::ShapeId => number(geometry.locate(hit.primitive).0),
            Self::Primitive => number(geometry.locate(hit.primitive).1),
            Self::Albedo => {
                let surface = geometry.surface(ray, hit);
                SurfaceInteraction::new(scene, ray, hit, surface, width, outside).bsdf().albedo().to_array()
            }
            Self::Motion => {
                let [start, end] = ends();
                (end - start).to_array()
            }
            Self::ScreenMotion => {
                let [start, end] = ends();
                let seen = |point, time| camera.connect(point, [0.5; 2], time).map(|there| there.film);
                match (seen(start, 0.0), seen(end, 1.0)) {
                    (Some([x, y]), Some([right, down])) => [right - x, down - y, 0.0],
                    // Points out of view at either end have no displacement in the picture.
                    _ => [0.0; 3],
                }
            }
        }
    }
}

/// Render channels, each as rows of components per pixel, from the top.
///
/// A pixel is the mean over its samples with a hit, uniform over its square, lens and shutter. Indices are those at its
/// center at the start of the shutter interval. After a cancellation it returns soon, and the result must be discarded.
pub fn aovs(
    scene: &Scene,
    camera: &dyn Camera,
    channels: &[Channel],
    samples: u32,
    seed: u64,
    cancel: &Cancel,
) -> Vec<Vec<f64>> {
    let (width, height) = (camera.width() as usize, camera.height() as usize);
    let row_of = |y: usize| -> Vec<Vec<f64>> {
        let mut row: Vec<_> = channels.iter().map(|channel| vec![channel.nothing(); width * channel.width()]).collect();
        if !cancel.is_raised() {
            expose_row(scene, camera, (channels, samples, seed), y, &mut row);
        }
        row
    };
    let rows = parallel::map(height, row_of);
    (0..channels.len()).map(|i| rows.iter().flat_map(|row| row[i].iter().copied()).collect()).collect()
}

fn expose_row(
    scene: &Scene,
    camera: &dyn Camera,
    (channels, samples, seed): (&[Channel], u32, u64),
    y: usize,
    row: &mut [Vec<f64>],
) {
    let width = camera.width() as usize;
    let spread = camera.spread();
    let footprint = Footprint { width: spread.width, spread: spread.angle };
    let mut rays = Vec::with_capacity(width);
    let mut hits = Vec::new();
    let mut trace = |film: &mut dyn FnMut(u32) -> ([f64; 2], [f64; 2], f64), rays: &mut Vec<Ray>| {
        rays.clear();
        rays.extend((0..width as u32).map(|x| {
            let ([right, down], lens, time) = film(x);
            camera.ray([f64::from(x) + right, y as f64 + down], lens, time).ray
        }));
        hits.clear();
        hits.resize(width, Hit::MISS);
        scene.intersect(rays, &mut hits);
        std::mem::take(&mut hits)
    };
    let is_id = |i: &usize| channels[*i].is_id();
    if (0..channels.len()).any(|i| is_id(&i)) {
        let found = trace(&mut |_| ([0.5; 2], [0.5; 2], 0.0), &mut rays);
        for i in (0..channels.len()).filter(is_id) {
            for x in (0..width).filter(|&x| found[x].is_hit()) {
                row[i][x] = channels[i].observe(scene, camera, (&rays[x], &found[x], 1.0), 0.0)[0];
            }
        }
    }
    if channels.iter().all(|channel| channel.is_id()) {
        return;
    }
    let mut seen = vec![0u32; width];
    let shades = channels.contains(&Channel::Albedo);
    let moves = scene.geometry().moves() || camera.uses_time();
    for number in 0..samples.max(1) {
        let mut film = |x: u32| {
            let pixel = y as u32 * camera.width() + x;
            let mut sampler = SamplerKind::default().sampler(seed, pixel, number);
            let time = if moves { sampler.one(3) } else { 0.0 };
            (sampler.two(0), sampler.two(1), time)
        };
        let found = trace(&mut film, &mut rays);
        let outside = shades.then(|| indices_outside(scene, &rays, &found));
        for x in (0..width).filter(|&x| found[x].is_hit()) {
            seen[x] += 1;
            for i in (0..channels.len()).filter(|i| !is_id(i)) {
                let met = (&rays[x], &found[x], outside.as_ref().map_or(1.0, |outside| outside[x]));
                let values = channels[i].observe(scene, camera, met, footprint.at(found[x].t).width);
                let n = channels[i].width();
                for (value, mean) in values.iter().zip(&mut row[i][x * n..(x + 1) * n]) {
                    // The first value replaces that for no hit, which may be infinite.
                    *mean = if seen[x] == 1 { *value } else { *mean + (value - *mean) / f64::from(seen[x]) };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::DVec3;
    use raywright_scene::fixtures::{cornell, rectangle, scene, shape};
    use raywright_scene::{Perspective, SceneDescription};

    #[test]
    fn a_wall_is_seen_where_it_is() {
        // A wall at z = −2 that fills the left half of the view.
        let wall = rectangle([-9.0, -9.0, -2.0], [9.0, 0.0, 0.0], [0.0, 18.0, 0.0]);
        let shapes = vec![shape(wall, [0.2, 0.4, 0.6], 0.0)];
        let scene = scene(SceneDescription { shapes, ..Default::default() });
        let camera = Perspective::looking_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 60.0, 8, 6).unwrap();
        let all = aovs(&scene, &camera, &Channel::ALL, 16, 1, &Cancel::default());
        for (channel, values) in Channel::ALL.into_iter().zip(&all) {
            let n = channel.width();
            assert_eq!(values.len(), 48 * n);
            for y in 0..6 {
                // The right half is empty.
                for x in 4..8 {
                    assert!(values[(y * 8 + x) * n..][..n].iter().all(|&v| v == channel.nothing()));
                }
                for x in 0..4 {
                    let v = &values[(y * 8 + x) * n..][..n];
                    match channel {
                        Channel::Depth => assert!(v[0] > 2.0 && v[0] < 4.0),
                        Channel::Position => assert!(v[0] < 0.0 && v[2] == -2.0),
                        Channel::Normal | Channel::ShadingNormal => assert_eq!(v, [0.0, 0.0, 1.0]),
                        Channel::Uv => assert!(v.iter().all(|v| (0.0..=1.0).contains(v))),
                        Channel::ShapeId => assert_eq!(v, [0.0]),
                        Channel::Primitive => assert!(v[0] == 0.0 || v[0] == 1.0),
                        Channel::Albedo => assert!((DVec3::from_slice(v) - DVec3::new(0.2, 0.4, 0.6)).length() < 1e-12),
                        Channel::Motion | Channel::ScreenMotion => assert!(v.iter().all(|&v| v == 0.0)),
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_asked_together_is_what_is_asked_alone() {
        let (scene, camera) = cornell(9, 7);
        let all = aovs(&scene, &camera, &Channel::ALL, 3, 5, &Cancel::default());
        for (channel, values) in Channel::ALL.into_iter().zip(all) {
            assert_eq!(aovs(&scene, &camera, &[channel], 3, 5, &Cancel::default()), [values]);
        }
    }
}
