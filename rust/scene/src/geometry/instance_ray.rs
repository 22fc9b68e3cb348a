//! A ray in an instance: `t` in world space, and the comparison of the ray's ends with that `t`.
//!
//! The ray in the prototype's space ([`super::pose`]) determines the hits and their order. Its `t` carries the rounding
//! errors of the transform, so `t` of a triangle is recomputed from the given ray and map. Let q be the point of the
//! triangle at the hit's barycentric coordinates, x = L q + s − o − t d, and n the triangle's normal in the world. Then
//! the plane is at t + n · x / n · d. Nearly all of x cancels, so it is summed in twice the digits (Ogita, Rump and
//! Oishi, "Accurate Sum and Dot Product", 2005): its error is some u² of its terms, and its value some u of them. So
//! `n` may be rounded, and the last addition yields the f64 nearest to the exact `t`, except for ties within some u of
//! a unit in the last place. Other shapes keep their `t`.
//!
//! The new `t` differs from the old one by at most [`InstanceRay::room`] and has its sign; if it would not, as at
//! grazing angles, the old one stays. So `t` depends only on the ray and the primitive. A hit farther than that from an
//! end of the ray needs no second comparison, and an end at 0 is the same in both spaces.

use super::pose::Pose;
use super::prototype::Prototype;
use raywright_accel::Meeting;
use raywright_base::math::{Hit, Ray};
use raywright_shapes::{Candidate, Contact};

/// A ray and one instance.
pub struct InstanceRay<'a> {
    prototype: &'a Prototype,
    pose: &'a Pose,
    /// The ray as given, in world space.
    outside: &'a Ray,
    /// The ray in the prototype's space, with its ends unchanged.
    inside: Ray,
}

impl<'a> InstanceRay<'a> {
    /// Transforms a ray into the space of an instance with this pose.
    #[inline]
    pub fn new(prototype: &'a Prototype, pose: &'a Pose, ray: &'a Ray) -> Self {
        Self { prototype, pose, outside: ray, inside: pose.enter(ray) }
    }

    /// The ray in the prototype's space.
    pub fn inside(&self) -> &Ray {
        &self.inside
    }

    /// Bound on the difference of `t` in both spaces, near a `t`.
    fn room(&self, t: f64) -> f64 {
        const ROOM: f64 = 1.0 / (1u64 << 36) as f64;
        let reach = self.inside.origin.abs().max_element() / self.inside.direction.abs().max_element();
        ROOM * (t.abs() + if reach.is_finite() { reach } else { 0.0 })
    }

    /// An end of the ray, moved by `steps` times the bound. An end at 0 or at infinity is the same in both spaces and
    /// stays.
    fn end(&self, t: f64, steps: f64) -> f64 {
        if t == 0.0 || t.is_infinite() { t } else { t + steps * self.room(t) }
    }

    /// The ray in the prototype's space, widened so that it contains every hit that is within the ends in world space.
    // With R the relative bound, |t' − t| ≤ R (reach + |t'|) is at most R / (1 − R) of reach + |t|.
    pub fn widened(&self) -> Ray {
        Ray { t_min: self.end(self.inside.t_min, -2.0), t_max: self.end(self.inside.t_max, 2.0), ..self.inside }
    }

    /// Converts a hit of the prototype's ray to world space, with its flattened primitive number. Returns `None` if it
    /// is beyond an end of the ray.
    pub fn told(&self, hit: &Hit, contact: Contact) -> Option<Candidate> {
        let inner = self.prototype.flatten(hit);
        let Hit { mut t, uv, .. } = *hit;
        if let Some(plane) = self.prototype.plane_point(inner, uv, self.outside.time) {
            let beyond = self.pose.plane_point(&plane).beyond(self.outside, t);
            let is_alike = (t + beyond).partial_cmp(&0.0) == t.partial_cmp(&0.0);
            t += if is_alike && beyond.abs() <= self.room(t) { beyond } else { 0.0 };
        }
        let counts = t >= self.inside.t_min && t <= self.inside.t_max;
        counts.then_some(Candidate { t, uv, contact, inner })
    }

    /// Returns whether the ray may hit something within a few bounds of a `t`.
    fn may_meet_about(&self, t: f64) -> bool {
        let Some(bounds) = self.prototype.bounds() else { return false };
        let Ray { origin, direction, .. } = self.inside;
        let (point, room) = (origin + direction * t, direction.abs() * (8.0 * self.room(t)));
        (point + room).cmpge(bounds.min).all() && (point - room).cmple(bounds.max).all()
    }

    /// All hits of a ray in the prototype's space.
    pub fn met(&self, ray: &Ray) -> impl Iterator<Item = (Hit, Contact)> + use<> {
        let all = self.prototype.accelerator().met(std::slice::from_ref(ray));
        let scale = all.rays[0].0;
        let own = move |meeting: Meeting| (Hit { t: meeting.hit.t * scale, ..meeting.hit }, meeting.contact);
        all.met.into_iter().map(move |(_, meeting)| own(meeting))
    }

    /// The closest hit.
    pub fn closest(&self) -> Option<Candidate> {
        let accelerator = self.prototype.accelerator();
        let mut ray = self.widened();
        loop {
            let hit = accelerator.intersect_one(&ray);
            if !hit.is_hit() {
                return None;
            }
            let told = self.told(&hit, Contact::Inside);
            if told.is_some() {
                return told;
            }
            // The hit is near an end, where a neighboring hit may be inside the ends instead.
            let last = hit.t + 2.0 * self.room(hit.t);
            let near = self.met(&Ray { t_min: hit.t, t_max: last.min(ray.t_max), ..ray });
            let first = near.filter_map(|(hit, _)| Some((hit.t, self.told(&hit, Contact::Inside)?)));
            let first = first.min_by(|(s, a), (t, b)| s.total_cmp(t).then(a.inner.cmp(&b.inner)));
            if let Some((_, told)) = first {
                return Some(told);
            }
            ray.t_min = last.next_up();
        }
    }

    /// Tests for any hit.
    pub fn is_occluded(&self) -> bool {
        let accelerator = self.prototype.accelerator();
        let (all, Ray { t_min, t_max, .. }) = (self.widened(), self.inside);
        let (first, last) = (self.end(t_min, 2.0), self.end(t_max, -2.0));
        if first <= last && accelerator.occluded_one(&Ray { t_min: first, t_max: last, ..all }) {
            return true;
        }
        // Near the ends, only the world-space `t` decides.
        let about = |t_min: f64, t_max: f64| {
            let ray = Ray { t_min, t_max, ..all };
            (first > last || self.may_meet_about(t_min))
                && accelerator.occluded_one(&ray)
                && self.met(&ray).any(|(hit, contact)| self.told(&hit, contact).is_some())
        };
        if first > last {
            return about(all.t_min, all.t_max);
        }
        t_min != first && about(all.t_min, first) || t_max != last && about(last, all.t_max)
    }
}
