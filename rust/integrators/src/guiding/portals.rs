//! Portals: small regions that much of the indirect light comes through.

use super::lobe::Lobe;
use super::photon::Photon;
use super::training::Visit;
use raywright_base::math::DVec3;

/// Number of segments that portals are found from, chosen by the light that they bring to the camera.
const SEGMENTS: usize = 512;

/// Maximum number of portals.
const PORTALS: usize = 8;

/// Minimum share of segments through a portal of those through a sphere of four times the radius, and the minimum
/// logarithm of the likelihood of so many, relative to evenly distributed segments: 8 without others around have 15.
const SHARE: f64 = 0.5;
const LIKELY: f64 = 14.0;

/// Radii of portals relative to the scene, from 2⁻⁴ to 2⁻⁹.
const HALVINGS: std::ops::RangeInclusive<i32> = 4..=9;

/// Share of a segment's length next to its origin where no portal is found.
const NEAR: f64 = 0.1;

/// Radius up to which segments are taken for those of a portal, relative to that of the segments it is found by.
const WIDER: f64 = 1.75;

/// Margin of a portal's radius.
const MARGIN: f64 = 1.15;

/// Spheres that paths aim at from everywhere. Light through a keyhole comes from many surfaces behind it, but from any
/// place in the direction of the keyhole.
#[derive(Clone, Debug, Default)]
pub(super) struct Portals {
    all: Vec<Portal>,
    /// Mean irradiance through each, of all visits.
    usual: Vec<f64>,
}

/// A sphere.
#[derive(Clone, Copy, Debug)]
struct Portal {
    center: DVec3,
    radius: f64,
}

/// A photon's way from its target.
#[derive(Clone, Copy)]
struct Segment {
    origin: DVec3,
    way: DVec3,
}

impl Segment {
    fn of(photon: &Photon) -> Self {
        Self { origin: photon.position, way: photon.target - photon.position }
    }

    /// Return the point nearest to another, away from the origin.
    fn nearest(&self, to: DVec3) -> DVec3 {
        let at = (to - self.origin).dot(self.way) / self.way.length_squared();
        self.origin + self.way * at.clamp(NEAR, 1.0)
    }

    fn distance(&self, to: DVec3) -> f64 {
        self.nearest(to).distance(to)
    }

    /// Return the point halfway between two segments where they are closest, and their distance there.
    fn meets(&self, other: &Self) -> (DVec3, f64) {
        let between = other.origin - self.origin;
        let (a, b, c) = (self.way.length_squared(), self.way.dot(other.way), other.way.length_squared());
        let (d, e) = (self.way.dot(between), other.way.dot(between));
        let at = (d * c - e * b) / (a * c - b * b);
        let on = self.origin + self.way * (if at.is_finite() { at } else { 0.5 }).clamp(NEAR, 1.0);
        let opposite = other.nearest(on);
        let on = self.nearest(opposite);
        ((on + opposite) * 0.5, on.distance(opposite))
    }
}

impl Portals {
    /// Find the portals of visits in a scene of some radius.
    pub fn of(visits: &[Visit], radius: f64) -> Self {
        let brings = |Visit { photon, throughput, .. }: &Visit| throughput * photon.flux;
        let all: f64 = visits.iter().map(brings).sum();
        let mut due = 0.5;
        let mut segments = Vec::new();
        for visit in visits.iter().filter(|visit| visit.photon.position != visit.photon.target) {
            due += (brings(visit) / all * SEGMENTS as f64).min(1.0);
            if due >= 1.0 {
                due -= 1.0;
                segments.push(Segment::of(&visit.photon));
            }
        }
        let mut found = Vec::new();
        while found.len() < PORTALS {
            let Some(portal) = Portal::best(&segments, radius) else { break };
            segments.retain(|segment| segment.distance(portal.center) > portal.radius);
            found.push(portal);
        }
        let mut portals = Self { usual: vec![0.0; found.len()], all: found };
        for Visit { photon, .. } in visits {
            if let Some(number) = portals.crossed(photon) {
                portals.usual[number] += photon.flux / visits.len() as f64;
            }
        }
        portals
    }

    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Return the portal that a photon came through, if any.
    pub fn crossed(&self, photon: &Photon) -> Option<usize> {
        let segment = Segment::of(photon);
        let is_crossed = |portal: &Portal| segment.distance(portal.center) <= portal.radius;
        if photon.flux > 0.0 && photon.position != photon.target { self.all.iter().position(is_crossed) } else { None }
    }

    /// Return a portal as seen by viewers around a place, and its mean irradiance.
    pub fn lobe(&self, number: usize, place: DVec3) -> (Lobe, f64) {
        let Portal { center, radius } = self.all[number];
        (Lobe::still(place, center, radius), self.usual[number])
    }
}

impl Portal {
    /// Return the sphere that the most segments cross for its size.
    fn best(segments: &[Segment], radius: f64) -> Option<Self> {
        /// Maximum distance of two segments that meet, relative to the scene.
        const CLOSE: f64 = 1.0 / 64.0;
        /// Number of places that are tried: those where segments come closest.
        const TRIED: usize = 2048;
        let mut places = Vec::new();
        for (i, one) in segments.iter().enumerate() {
            places.extend(segments[..i].iter().map(|other| one.meets(other)).filter(|at| at.1 < CLOSE * radius));
        }
        if places.len() > TRIED {
            places.select_nth_unstable_by(TRIED, |a, b| a.1.total_cmp(&b.1));
            places.truncate(TRIED);
        }
        let (mut best, mut most) = (None, 0.0);
        for (place, _) in places {
            let distances: Vec<f64> = segments.iter().map(|segment| segment.distance(place)).collect();
            for size in HALVINGS.map(|halvings| 0.5f64.powi(halvings)) {
                let within = |radius: f64| distances.iter().filter(|&&distance| distance < radius).count() as f64;
                let (count, around) = (within(size * radius), within(4.0 * size * radius));
                let usual = around / 16.0;
                let is_portal = count >= SHARE * around && count * (count / usual).ln() - count + usual > LIKELY;
                // The better of two brings more light, and takes fewer samples for it.
                let worth = count * (count / (size * size)).ln();
                if is_portal && worth > most {
                    (best, most) = (Some(Self { center: place, radius: size * radius }), worth);
                }
            }
        }
        best.map(|portal| portal.fitted(segments))
    }

    /// Center the sphere on the segments that cross it, and widen it to those that just miss it: light that it misses
    /// is found rarely.
    fn fitted(self, segments: &[Segment]) -> Self {
        let crossing = segments.iter().filter(|segment| segment.distance(self.center) < self.radius);
        let nearest: Vec<DVec3> = crossing.map(|segment| segment.nearest(self.center)).collect();
        let center = nearest.iter().sum::<DVec3>() / nearest.len() as f64;
        let mut distances: Vec<f64> = segments.iter().map(|segment| segment.distance(center)).collect();
        distances.sort_unstable_by(f64::total_cmp);
        let (all, rest) = distances.split_at(nearest.len());
        let farthest = all[all.len() - 1];
        let next = rest.iter().take_while(|&&distance| distance < WIDER * farthest).last();
        let radius = MARGIN * next.copied().unwrap_or(farthest);
        Self { center, radius }
    }
}
