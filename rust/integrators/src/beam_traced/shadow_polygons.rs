//! Exact shadow polygons: beams from lights, clipped by occluders.
//!
//! The shadow volume of a face is bounded by four planes: its own, and those through the light and its sides. On
//! another face, each plane is a line of the film, so shadow edges are as exact as those of faces.

use super::beam::{Beam, HalfSpace, LEAST};
use raywright_accel::Primitives;
use raywright_base::math::convex::{Convex, HalfPlane, area, take_out};
use raywright_base::math::{DVec2, DVec3};
use raywright_base::workers::Cancel;
use raywright_scene::{Geometry, Place};

/// The shadow volumes of all faces for one light.
pub(super) struct Shadows {
    place: Place,
    /// Faces that cast a shadow, with their volumes.
    faces: Vec<(u32, [HalfSpace; 4])>,
    /// Distance below which points are on a plane.
    on_plane: f64,
}

/// Return a vector from a point toward a light, of any length but 0.
fn towards(place: Place, from: DVec3) -> DVec3 {
    match place {
        Place::Point(at) => at - from,
        Place::Direction(way) => way,
    }
}

impl Shadows {
    /// Make the shadow volumes of a light in a scene of a given extent from the origin.
    pub fn new(place: Place, geometry: &Geometry, reach: f64) -> Self {
        let faces = (0..geometry.count() as u32).filter_map(|p| Some((p, shadow(place, geometry, p)?))).collect();
        let far = match place {
            Place::Point(at) => at.abs().max_element(),
            Place::Direction(_) => 0.0,
        };
        Self { place, faces, on_plane: 1e-12 * (reach + far) }
    }

    /// Return whether a light and a point are on the same side of a face.
    pub fn is_before(&self, geometry: &Geometry, primitive: u32, from: DVec3) -> bool {
        let (normal, corner) = (geometry.normal(primitive), geometry.corners(primitive)[0]);
        normal.dot(towards(self.place, corner)) * normal.dot(from - corner) > 0.0
    }

    /// Divide a piece of a face into its lit and its shadowed parts.
    pub fn part(
        &self,
        beam: &Beam,
        primitive: u32,
        nearness: DVec3,
        piece: Convex,
        cancel: &Cancel,
    ) -> [Vec<Convex>; 2] {
        let nearest = piece.iter().map(|at| nearness.dot(at.extend(1.0))).fold(0.0, f64::max);
        let slack = self.on_plane * nearest;
        let (mut lit, mut dark) = (vec![piece], Vec::new());
        for (number, spaces) in &self.faces {
            if *number == primitive || lit.is_empty() {
                continue;
            }
            if number % 1024 == 0 && cancel.is_raised() {
                break;
            }
            let region = spaces.map(|space| HalfPlane { line: beam.on_plane(&space, nearness), slack });
            let is_beyond = |side: &HalfPlane, at: &DVec2| side.value(*at) <= 0.0;
            let misses = |piece: &Convex| region.iter().any(|side| piece.iter().all(|at| is_beyond(side, at)));
            if lit.iter().all(misses) {
                continue;
            }
            let mut left = Vec::with_capacity(lit.len());
            for piece in lit {
                let taken = take_out(piece, &region, &mut left);
                if taken.len() > 2 && area(&taken) > LEAST {
                    dark.push(taken);
                }
            }
            left.retain(|piece| area(piece) > LEAST);
            lit = left;
        }
        [lit, dark]
    }
}

/// Return the shadow volume of a face as four half-spaces; `None` if it is edge-on to the light or has no area.
fn shadow(place: Place, geometry: &Geometry, primitive: u32) -> Option<[HalfSpace; 4]> {
    let corners = geometry.corners(primitive);
    let normal = geometry.normal(primitive);
    let facing = normal.dot(towards(place, corners[0]));
    if facing == 0.0 || facing.is_nan() {
        return None;
    }
    let behind = normal * -facing.signum();
    let mut all = [HalfSpace { normal: behind, offset: behind.dot(corners[0]) }; 4];
    for i in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % 3]);
        let across = (b - a).cross(towards(place, a));
        let across = across / across.length();
        let inwards = across * across.dot(c - a).signum();
        if !inwards.is_finite() {
            return None;
        }
        all[i] = HalfSpace { normal: inwards, offset: inwards.dot(a) };
    }
    Some(all)
}
