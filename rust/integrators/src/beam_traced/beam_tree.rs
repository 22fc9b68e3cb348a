//! The beam tree, whose leaves are pieces of the film.

use super::BeamTraced;
use super::beam::{Beam, LEAST, Origin, VisibleFace};
use super::face_shading::FilmHit;
use super::hidden_surfaces::visible;
use super::next_beams::Onward;
use super::shadow_polygons::Shadows;
use crate::Job;
use raywright_accel::Primitives;
use raywright_base::math::convex::{Convex, area};
use raywright_base::math::{DVec2, DVec3};
use raywright_base::parallel;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Perspective;
use std::ops::Range;

/// A piece of the film: one face, seen through a sequence of mirrors and lit by a set of lights.
#[derive(Clone, Debug)]
pub(super) struct FilmPiece {
    pub outline: Convex,
    /// Corners of the bounding rectangle.
    pub bounds: [DVec2; 2],
    beam: usize,
    primitive: u32,
    nearness: DVec3,
    /// Bit mask of the lights that reach it.
    lit: u64,
}

/// All beams of a picture.
pub(super) struct BeamTree {
    beams: Vec<Beam>,
    pub pieces: Vec<FilmPiece>,
}

/// Pieces and next beams of one face in one beam.
#[derive(Default)]
struct FaceBeams {
    pieces: Vec<FilmPiece>,
    next: Vec<Beam>,
}

/// Minimum size, in pixels, of parts that are followed further.
const LEAST_FOLLOWED: f64 = 1e-10;

/// Faces per task of a thread.
const TOGETHER: usize = 256;

impl BeamTree {
    /// Trace the view of a camera.
    pub fn new(job: &Job, camera: &Perspective, settings: &BeamTraced, cancel: &Cancel) -> Self {
        let scene = job.scene;
        let region = scene.region();
        let reach = region.min.abs().max(region.max.abs()).max_element();
        let places: Vec<_> = scene.lights().others().filter_map(|light| light.place()).collect();
        let lights: Vec<Shadows> = parallel::map(places.len(), |i| Shadows::new(places[i], scene.geometry(), reach));
        let mut tree = Self { beams: Vec::new(), pieces: Vec::new() };
        let mut next = if settings.max_depth > 0 { vec![Beam::of(camera)] } else { Vec::new() };
        while !next.is_empty() && !cancel.is_raised() {
            let first = tree.beams.len();
            tree.beams.append(&mut next);
            for number in first..tree.beams.len() {
                for found in tree.trace(job, &lights, number, settings, cancel) {
                    tree.pieces.extend(found.pieces);
                    next.extend(found.next);
                }
            }
        }
        tree
    }

    /// Process each face in a beam.
    fn trace(
        &self,
        job: &Job,
        lights: &[Shadows],
        number: usize,
        settings: &BeamTraced,
        cancel: &Cancel,
    ) -> Vec<FaceBeams> {
        let (beam, geometry) = (&self.beams[number], job.scene.geometry());
        let follows = beam.bounce + 1 < settings.max_depth;
        let see = |faces: Range<usize>| faces.filter_map(|face| beam.see(geometry, face as u32)).collect::<Vec<_>>();
        let mut seen: Vec<VisibleFace> =
            parallel::map_chunks(geometry.count(), TOGETHER, see).into_iter().flatten().collect();
        // Near faces hide most.
        seen.sort_unstable_by(|a, b| b.nearest.total_cmp(&a.nearest).then(a.primitive.cmp(&b.primitive)));
        let one = |which: usize| {
            let mut found = FaceBeams::default();
            if cancel.is_raised() {
                return found;
            }
            let VisibleFace { primitive, nearness, .. } = seen[which];
            let onward = Onward { job, beam, number, seen: &seen[which], tolerance: settings.tolerance };
            for part in visible(&seen, which, cancel) {
                if follows && area(&part) > LEAST_FOLLOWED {
                    found.next.extend(onward.beams(&part, cancel));
                }
                let transmits = job.scene.material(geometry.locate(primitive).0).transmits();
                let mut pieces = vec![(part, 0)];
                for (light, shadows) in lights.iter().enumerate() {
                    if !transmits && !shadows.is_before(geometry, primitive, beam.apex) {
                        continue;
                    }
                    let mut parted = Vec::new();
                    for (piece, lit) in pieces {
                        let [bright, dark] = shadows.part(beam, primitive, nearness, piece, cancel);
                        parted.extend(bright.into_iter().map(|piece| (piece, lit | 1 << light)));
                        parted.extend(dark.into_iter().map(|piece| (piece, lit)));
                    }
                    pieces = parted;
                }
                for (outline, lit) in pieces {
                    let low = outline.iter().copied().reduce(DVec2::min).unwrap_or_default();
                    let high = outline.iter().copied().reduce(DVec2::max).unwrap_or_default();
                    found.pieces.push(FilmPiece {
                        outline,
                        bounds: [low, high],
                        beam: number,
                        primitive,
                        nearness,
                        lit,
                    });
                }
            }
            found
        };
        parallel::map(seen.len(), one)
    }

    /// Return the radiance of a piece at a film position.
    pub fn radiance(&self, job: &Job, ambient: Rgb, piece: &FilmPiece, at: DVec2) -> Rgb {
        let mut beam = &self.beams[piece.beam];
        let mut light = FilmHit::new(job, beam, piece.primitive, piece.nearness, at).light(job, piece.lit, ambient);
        while let Some(Origin { beam: before, primitive, nearness, through }) = beam.origin {
            beam = &self.beams[before];
            light *= FilmHit::new(job, beam, primitive, nearness, at).share(through.is_some());
        }
        light
    }

    /// Return the indices of pieces that may be visible in blocks of pixels of a given side, row by row.
    pub fn by_block(&self, size: [u32; 2], side: u32) -> Vec<Vec<u32>> {
        let blocks = size.map(|length| length.div_ceil(side));
        let mut all = vec![Vec::new(); (blocks[0] * blocks[1]) as usize];
        for (number, piece) in self.pieces.iter().enumerate().filter(|(_, piece)| area(&piece.outline) > LEAST) {
            let block = |at: f64, axis: usize| ((at.max(0.0) / f64::from(side)) as u32).min(blocks[axis] - 1);
            let [low, high] = piece.bounds.map(|corner| [block(corner.x, 0), block(corner.y, 1)]);
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    all[(y * blocks[0] + x) as usize].push(number as u32);
                }
            }
        }
        all
    }
}
