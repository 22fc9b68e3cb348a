//! Spherical emitters as seen from a cell.

use super::photon::Photon;
use glam::DMat3;
use raywright_base::math::trig::sin_cos_turn;
use raywright_base::math::{DVec3, Frame, LANES, VectorLanes};
use raywright_base::simd::{Level, loops};
use std::f64::consts::TAU;

/// A sphere that light comes from. Like the image of a lamp in a mirror, its center moves with the viewer. It is a
/// linear function of the viewer's position, fitted to the photons by least squares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lobe {
    /// Center of the viewers' positions.
    place: DVec3,
    /// Center of the sphere as seen from there.
    target: DVec3,
    /// Derivative of the center by the viewer's position.
    moves: DMat3,
    /// Squared radius.
    square: f64,
    /// Sampling probability.
    share: f64,
}

impl Lobe {
    /// Minimum number of photons for fitting the derivative.
    const FEW: usize = 6;

    /// Return the sphere around the origins of some photons, at least one. Their positions lie within `size` of each
    /// other.
    pub fn around(photons: &[Photon], size: f64) -> Self {
        let count = photons.len() as f64;
        let place = photons.iter().map(|p| p.position).sum::<DVec3>() / count;
        let target = photons.iter().map(|p| p.target).sum::<DVec3>() / count;
        let still = Self { place, target, moves: DMat3::ZERO, square: 0.0, share: 1.0 };
        let fitted = (photons.len() >= Self::FEW).then(|| still.fitted(photons, size));
        let lobe = fitted.filter(|fitted| 2.0 * fitted.spread(photons) < still.spread(photons)).unwrap_or(still);
        let farthest = photons.iter().map(|p| lobe.off(p).length_squared()).fold(0.0, f64::max);
        // A few photons underestimate the extent, and neighbors see other parts than one place does.
        let radius = farthest.sqrt() * (1.0 + 2.0 / count) + if photons.len() < Self::FEW { size / count } else { 0.0 };
        // A minimum size keeps squared cosines accurate enough to distinguish the sphere's directions.
        let least = (1e-10 * still.target.distance_squared(still.place)).max(f64::MIN_POSITIVE);
        Self { square: (radius * radius).max(least), ..lobe }
    }

    /// Return a sphere that is the same from everywhere, for viewers around a place.
    pub fn still(place: DVec3, target: DVec3, radius: f64) -> Self {
        let least = (1e-10 * target.distance_squared(place)).max(f64::MIN_POSITIVE);
        Self { place, target, moves: DMat3::ZERO, square: (radius * radius).max(least), share: 1.0 }
    }

    /// Set the sampling probability.
    pub fn drawn(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// Return the sphere's center as seen from a place.
    #[inline(always)]
    pub fn target(&self, place: DVec3) -> DVec3 {
        self.target + self.moves * (place - self.place)
    }

    /// Return the share of the surroundings that the sphere fills, seen from the center: about its solid angle over
    /// that of a hemisphere.
    pub fn fills(&self) -> f64 {
        let far = self.target.distance_squared(self.place);
        self.square / (self.square + far)
    }

    /// Sample a direction to the sphere, uniformly in a cone of less than half of all directions, even from inside.
    #[inline]
    pub fn sample(&self, place: DVec3, u: [f64; 2]) -> DVec3 {
        let way = self.target(place) - place;
        let far = way.length_squared();
        let all = far + self.square;
        // The height of the cone's cap, 1 − cos θ with cos² θ = d² / (d² + r²), without cancellation for narrow cones.
        let height = self.square / all / (1.0 + (far / all).sqrt());
        let down = u[0] * height;
        let across = (down * (2.0 - down)).sqrt();
        let [sin, cos] = sin_cos_turn(u[1]);
        let axis = way.try_normalize().unwrap_or(DVec3::Z);
        Frame::new(axis).to_world(DVec3::new(across * cos, across * sin, 1.0 - down))
    }

    /// Return the density per solid angle of a unit direction, times the sampling probability.
    #[cfg(test)]
    pub fn pdf(&self, place: DVec3, direction: DVec3) -> f64 {
        let (is_met, far) = self.meets(place, direction);
        if is_met { self.density(far) } else { 0.0 }
    }

    /// Return whether a direction from a place hits the sphere, and the squared distance of its center. Most directions
    /// miss, which products alone decide.
    #[inline(always)]
    fn meets(&self, place: DVec3, direction: DVec3) -> (bool, f64) {
        let way = self.target(place) - place;
        let (far, along) = (way.length_squared(), way.dot(direction));
        ((along > 0.0) & (along * along * (far + self.square) >= far * far), far)
    }

    /// Return the density of directions that hit the sphere times its sampling probability, for a squared distance of
    /// its center.
    #[inline]
    fn density(&self, far: f64) -> f64 {
        let all = far + self.square;
        self.share * (1.0 + (far / all).sqrt()) * (all / self.square) / TAU
    }

    /// Return the offset of a photon's origin from the center.
    fn off(&self, photon: &Photon) -> DVec3 {
        photon.target - self.target(photon.position)
    }

    /// Return the sum of the squared offsets.
    fn spread(&self, photons: &[Photon]) -> f64 {
        photons.iter().map(|p| self.off(p).length_squared()).sum()
    }

    /// Fit the derivative to the photons.
    fn fitted(self, photons: &[Photon], size: f64) -> Self {
        // Positions mostly lie in a plane, which leaves the perpendicular derivative open: regularization makes it
        // zero.
        let mut places = DMat3::from_diagonal(DVec3::splat(1e-4 * size * size * photons.len() as f64));
        let mut moves = DMat3::ZERO;
        for photon in photons {
            let (x, y) = (photon.position - self.place, photon.target - self.target);
            places += DMat3::from_cols(x * x.x, x * x.y, x * x.z);
            moves += DMat3::from_cols(y * x.x, y * x.y, y * x.z);
        }
        let moves = moves * places.inverse();
        if moves.is_finite() { Self { moves, ..self } } else { self }
    }

    /// Split photons, at least one, into clusters of one sphere each, by at most `halvings` levels. Append the sphere
    /// and the flux of each.
    pub fn divide(photons: &mut [Photon], size: f64, halvings: u32, each: &mut Vec<(Self, f64)>) {
        let lobe = Self::around(photons, size);
        if halvings > 0 && photons.len() > Self::FEW {
            let across = photons.iter().map(|p| lobe.off(p) * lobe.off(p)).sum::<DVec3>();
            let axis = (0..3).max_by(|&a, &b| across[a].total_cmp(&across[b])).unwrap_or(0);
            photons.sort_unstable_by(|a, b| lobe.off(a)[axis].total_cmp(&lobe.off(b)[axis]));
            let half = photons.partition_point(|p| lobe.off(p)[axis] < 0.0);
            let spread = lobe.spread(photons);
            let (one, other) = photons.split_at_mut(half);
            if one.len() > 2 && other.len() > 2 {
                let halves = Self::around(one, size).spread(one) + Self::around(other, size).spread(other);
                // Halving a uniform square leaves 5/8 of its variance.
                if halves < 0.4 * spread {
                    Self::divide(one, size, halvings - 1, each);
                    Self::divide(other, size, halvings - 1, each);
                    return;
                }
            }
        }
        each.push((lobe, photons.iter().map(|p| p.flux).sum()));
    }
}

/// Lobes of one cell, one per lane, with possibly unused lanes.
#[derive(Clone, Debug)]
pub(super) struct LobeLanes {
    place: VectorLanes,
    target: VectorLanes,
    moves: [VectorLanes; 3],
    square: [f64; LANES],
    share: [f64; LANES],
}

loops! {
    /// Find the lobes that a direction hits, as a bit mask, and the squared distances of their centers.
    fn meet(of: &LobeLanes, place: DVec3, direction: DVec3, met: &mut u32, far: &mut [f64; LANES]) {
        let mut bits = [0; LANES];
        for i in 0..LANES {
            let (is_met, square) = of.get(i).meets(place, direction);
            bits[i] = u32::from(is_met) << i;
            far[i] = square;
        }
        *met = bits.into_iter().fold(0, |all, bit| all | bit);
    }
}

impl LobeLanes {
    /// Store at most as many lobes as lanes. Unused lanes have the probability 0.
    pub fn of(lobes: &[Lobe]) -> Self {
        let nothing = VectorLanes::ZERO;
        let mut lanes =
            Self { place: nothing, target: nothing, moves: [nothing; 3], square: [1.0; LANES], share: [0.0; LANES] };
        for (lane, lobe) in lobes.iter().enumerate() {
            lanes.place.set(lane, lobe.place);
            lanes.target.set(lane, lobe.target);
            for axis in 0..3 {
                lanes.moves[axis].set(lane, lobe.moves.col(axis));
            }
            (lanes.square[lane], lanes.share[lane]) = (lobe.square, lobe.share);
        }
        lanes
    }

    /// Return the lobe of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Lobe {
        let [x, y, z] = &self.moves;
        Lobe {
            place: self.place.get(lane),
            target: self.target.get(lane),
            moves: DMat3::from_cols(x.get(lane), y.get(lane), z.get(lane)),
            square: self.square[lane],
            share: self.share[lane],
        }
    }

    /// Return the sampling probability of a lane's lobe.
    #[inline]
    pub fn share(&self, lane: usize) -> f64 {
        self.share[lane]
    }

    /// Add to `sum`, lane by lane, the density per solid angle of a unit direction times the sampling probability.
    #[inline]
    pub fn add_pdf(&self, level: Level, place: DVec3, direction: DVec3, mut sum: f64) -> f64 {
        let (mut met, mut far) = (0, [0.0; LANES]);
        meet(level, self, place, direction, &mut met, &mut far);
        while met != 0 {
            let lane = met.trailing_zeros() as usize % LANES;
            met &= met - 1;
            sum += self.get(lane).density(far[lane]);
        }
        sum
    }
}
