//! Stored vertices of light paths.

use crate::light_paths::{LightEnd, LightEnds};
use crate::path_vertices::{Onward, Vertex};
use crate::wavefront::{Arrival, Subpath, SubpathSink, VertexContext};
use raywright_optics::Rgb;
use raywright_scene::EmissionSample;

/// A vertex of a light path.
pub(super) struct LightVertex<'a> {
    pub at: Vertex<'a>,
    /// Flux of the path, divided by the probability that the vertex is stored.
    pub flux: Rgb,
    /// Remaining share for camera paths with a reflectance above 1 on the way
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    pub again: Rgb,
    /// Index of the vertex on the path, from 1 on.
    pub bounce: u32,
    /// True if only the hero wavelength is left.
    pub single: bool,
    pub end: LightEnd,
    /// Previous vertex of the same path.
    before: Option<u32>,
}

/// The vertices of each light path of a batch, except delta ones. Beyond the first [`LightVertices::ALL`] of a path, as
/// in a white room without a window, later vertices are stored with decreasing probability. Otherwise all connections
/// of two such paths would take hours.
pub(super) struct LightVertices<'a> {
    ends: LightEnds<'a>,
    vertices: Vec<LightVertex<'a>>,
    /// Last vertex of each path.
    last: Vec<Option<u32>>,
}

impl<'a> LightVertices<'a> {
    /// Number of vertices of a path that are always stored; one in twenty of 4,000 is stored.
    const ALL: f64 = 32.0;

    pub fn new(ends: LightEnds<'a>) -> Self {
        Self { ends, vertices: Vec::new(), last: Vec::new() }
    }

    /// Clear, and set the number of paths and their merging disks, if vertices are merged.
    pub fn begin(&mut self, paths: usize, disks: impl Iterator<Item = f64>) {
        self.ends.begin(disks);
        self.vertices.clear();
        self.last.clear();
        self.last.resize(paths, None);
    }

    /// Return the vertices of a path, last one first.
    pub fn of(&self, path: u32) -> impl Iterator<Item = &LightVertex<'a>> {
        let get = |index: u32| &self.vertices[index as usize];
        let last = self.last.get(path as usize).copied().flatten();
        std::iter::successors(last.map(get), move |vertex| vertex.before.map(get))
    }
}

impl<'a> SubpathSink<'a> for LightVertices<'a> {
    fn set_out(&mut self, path: &Subpath, light: &EmissionSample) {
        self.ends.set_out(path.number, light);
    }

    fn meet(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, context: &mut VertexContext<'_>) {
        let at = at.vertex();
        self.ends.arrive(path.number, at);
        let odds = Self::ALL / f64::from(path.bounce);
        if at.is_single() || odds < 1.0 && context.one(context.dimensions.storing()) >= odds {
            return;
        }
        let last = &mut self.last[path.number as usize];
        let vertex = LightVertex {
            at: at.clone(),
            flux: path.beta / odds.min(1.0),
            again: path.again,
            bounce: path.bounce,
            single: path.single,
            end: *self.ends.end(path.number),
            before: *last,
        };
        *last = Some(self.vertices.len() as u32);
        self.vertices.push(vertex);
    }

    fn go_on(&mut self, at: &Arrival<'_, 'a>, path: &Subpath, next: &Onward) {
        self.ends.go_on(path.number, at.vertex(), next);
    }
}
