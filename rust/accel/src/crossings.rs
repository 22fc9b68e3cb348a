//! Every hit of each ray in order, with shared points of a surface counted once.
//!
//! A ray through a shared edge hits both triangles. As a surface, they are crossed once there, or not at all if the ray
//! only touches a ridge. Of the triangles hit at one point of edges and corners, those count that the symbolically
//! perturbed ray crosses ([`Contact`]). So a closed surface is crossed an even number of times from outside and an odd
//! number from inside, in any direction. Where the ray touches but crosses nothing, the contact is still reported,
//! since [`super::Accelerator::intersect`] reports it: twice, as an entry and an exit. These are two triangles of a
//! ridge, or twice the same one if its neighbors at that point are edge-on.

use super::query::{Every, Meeting};
use raywright_base::math::Hit;
use raywright_shapes::Contact;

/// The hits of a batch of rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    /// Ray `i` has the hits from `splits[i]` to `splits[i + 1]`.
    pub splits: Vec<usize>,
    /// By ray, then `t`, then primitive.
    pub hits: Vec<Hit>,
}

impl Crossings {
    /// The hits of one ray.
    #[inline]
    pub fn of_ray(&self, ray: usize) -> &[Hit] {
        &self.hits[self.splits[ray]..self.splits[ray + 1]]
    }

    /// Sort the intersections, and count points shared by triangles once.
    pub fn of(every: Every) -> Self {
        let Every { mut met, rays } = every;
        // Adding zero turns −0 into +0; closest-hit queries treat them as equal.
        let t = |m: &Meeting| m.hit.t + 0.0;
        met.sort_unstable_by(|(r, a), (s, b)| {
            r.cmp(s)
                .then(t(a).total_cmp(&t(b)))
                .then((a.hit.primitive, a.hit.inner).cmp(&(b.hit.primitive, b.hit.inner)))
        });
        // Structures that reference a primitive in several leaves may report it from each.
        met.dedup_by(|(r, a), (s, b)| {
            let same = |a: &Hit, b: &Hit| a.primitive == b.primitive && a.inner == b.inner;
            r == s && t(a) == t(b) && same(&a.hit, &b.hit)
        });
        let mut crossings = Self { splits: Vec::with_capacity(rays.len() + 1), hits: Vec::with_capacity(met.len()) };
        crossings.splits.push(0);
        let mut rest = met.as_slice();
        for (i, &(scale, same_point)) in rays.iter().enumerate() {
            let count = rest.iter().take_while(|(ray, _)| *ray as usize == i).count();
            let (mine, others) = rest.split_at(count);
            rest = others;
            if let [(_, Meeting { hit, contact: Contact::Inside })] = mine {
                // Most rays have one hit, at no shared point.
                crossings.hits.push(Hit { t: hit.t * scale, ..*hit });
                crossings.splits.push(crossings.hits.len());
                continue;
            }
            for ((_, m), times) in mine.iter().zip(times_told(mine, same_point)) {
                let hit = Hit { t: m.hit.t * scale, ..m.hit };
                crossings.hits.extend(std::iter::repeat_n(hit, times));
            }
            crossings.splits.push(crossings.hits.len());
        }
        crossings
    }
}

/// How many times each of a ray's intersections, in order, is reported.
fn times_told(met: &[(u32, Meeting)], same_point: f64) -> Vec<usize> {
    let mut times = vec![1; met.len()];
    let shared: Vec<usize> = (0..met.len()).filter(|&i| met[i].1.contact != Contact::Inside).collect();
    for point in shared.chunk_by(|&i, &j| met[j].1.hit.t - met[i].1.hit.t <= same_point) {
        let crossed = point.iter().filter(|&&i| met[i].1.contact == Contact::Crossing).count();
        if let ([i], 0) = (point, crossed) {
            times[*i] = 2;
        }
        let told = if crossed == 0 { 2 } else { crossed };
        for &i in point.iter().skip(told) {
            times[i] = 0;
        }
    }
    times
}
