//! Where light has come to, kept to be connected to.

use crate::light_paths::{Arrived, Dimensions, Flying, LightEnd, Onward, Partials, Visitor};
use crate::nesting::MediumStack;
use raywright_base::sampling::Sampler;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::EmissionSample;

/// A surface that light has come to.
pub(super) struct LightVertex<'a> {
    pub arrived: Arrived<'a>,
    /// The flux that the path stands for, more where not all such are kept.
    pub flux: Rgb,
    /// What is left of it for a viewer who looks by way of what gives more than there is ([`Bsdf::again`]).
    pub again: Rgb,
    /// Which of the path's surfaces it is, from 1 on.
    pub bounce: u32,
    /// Whether the hero of its wavelengths is all that it has come by.
    pub single: bool,
    pub end: LightEnd,
    /// That of the same path before this.
    before: Option<u32>,
}

/// The surfaces that each path of a batch has come to, but for those which scatter in single directions alone. Of a
/// path that has been to many, as in a white room without a window, those beyond the first [`LightVertices::ALL`] are
/// kept the less likely the later they are: all connections of two such paths would take hours.
pub(super) struct LightVertices<'a> {
    partials: Partials<'a>,
    vertices: Vec<LightVertex<'a>>,
    /// The last of each path.
    last: Vec<Option<u32>>,
}

impl<'a> LightVertices<'a> {
    /// The first that are kept of each path, whatever the odds; of 4,000 that is one in twenty.
    const ALL: f64 = 32.0;

    pub fn new(partials: Partials<'a>) -> Self {
        Self { partials, vertices: Vec::new(), last: Vec::new() }
    }

    /// Forgets all, before so many paths are followed, which merge by these disks, if they do.
    pub fn begin(&mut self, paths: usize, disks: impl Iterator<Item = f64>) {
        self.partials.begin(disks);
        self.vertices.clear();
        self.last.clear();
        self.last.resize(paths, None);
    }

    /// Those of a path, from the last on.
    pub fn of(&self, path: u32) -> impl Iterator<Item = &LightVertex<'a>> {
        let get = |index: u32| &self.vertices[index as usize];
        let last = self.last.get(path as usize).copied().flatten();
        std::iter::successors(last.map(get), move |vertex| vertex.before.map(get))
    }
}

/// Arrivals are borrowed for as long as a visit takes; what they hold lives as long as the scene.
impl<'a> Visitor<'a> for LightVertices<'a> {
    fn set_out(&mut self, path: &Flying, light: &EmissionSample) {
        self.partials.set_out(path, light);
    }

    fn meet(
        &mut self,
        arrived: &Arrived<'a>,
        path: &Flying,
        _: &MediumStack,
        (sampler, dimensions): (&mut Sampler, Dimensions),
    ) {
        self.partials.arrive(path, arrived);
        let odds = Self::ALL / f64::from(path.bounce);
        if arrived.here.bsdf().is_delta() || odds < 1.0 && sampler.one(dimensions.keeping()) >= odds {
            return;
        }
        let last = &mut self.last[path.number as usize];
        let vertex = LightVertex {
            arrived: arrived.clone(),
            flux: path.flux / odds.min(1.0),
            again: path.again,
            bounce: path.bounce,
            single: path.single,
            end: *self.partials.end(path),
            before: *last,
        };
        *last = Some(self.vertices.len() as u32);
        self.vertices.push(vertex);
    }

    fn go_on(&mut self, arrived: &Arrived<'a>, path: &Flying, next: &Onward) {
        self.partials.go_on(path, arrived, next);
    }
}
