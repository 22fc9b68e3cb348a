//! Lookup radii.

use super::kd_tree::PointKdTree;
use raywright_base::math::DVec3;

/// Squared radius of each map of a progressive estimate, relative to the first map: r²ₛ₊₁ / r²ₛ = (s + α) / (s + 1), s
/// from 1 on (Knaus and Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", 2011, eq. 17). It depends on
/// the index of the map alone, not on its photons.
#[derive(Debug)]
pub struct Radii {
    alpha: f64,
    /// Squared radii computed so far.
    squares: Vec<f64>,
}

impl Radii {
    /// Make radii that keep the share `alpha` of new photons on average.
    pub fn new(alpha: f64) -> Self {
        Self { alpha, squares: vec![1.0] }
    }

    /// Return the squared radius of a map, counted from 0.
    pub fn square(&mut self, map: u32) -> f64 {
        while self.squares.len() <= map as usize {
            let before = self.squares.len();
            let last = self.squares[before - 1];
            self.squares.push(last * (before as f64 + self.alpha) / (before as f64 + 1.0));
        }
        self.squares[map as usize]
    }

    /// Return the mean squared radius of at least one map. The bias is proportional to r², so this gives the bias of
    /// all maps.
    pub fn mean_square(&mut self, maps: u32) -> f64 {
        let maps = maps.max(1);
        (0..maps).map(|map| self.square(map)).sum::<f64>() / f64::from(maps)
    }

    /// Return the squared radius of a ball that keeps the same share of photons: cubes of ball radii follow the
    /// recurrence of squared disk radii.
    pub fn ball(&mut self, map: u32) -> f64 {
        self.square(map).powf(2.0 / 3.0)
    }

    /// Return the mean as [`Radii::mean_square`] does, for balls.
    pub fn mean_ball(&mut self, maps: u32) -> f64 {
        let maps = maps.max(1);
        (0..maps).map(|map| self.ball(map)).sum::<f64>() / f64::from(maps)
    }
}

/// Number of photons that half of all photons have within the first radius.
pub(super) const NEIGHBOURS: usize = 24;

/// Return the median distance of photons to their 24th nearest neighbor. It follows the photon density where most of
/// the light is. Return `None` with fewer photons.
pub(super) fn first(photons: &[DVec3]) -> Option<f64> {
    /// Number of photons in the median, evenly spread over all.
    const ASKED: usize = 512;
    let tree = PointKdTree::new(photons.iter().copied());
    let mut found = Vec::new();
    let mut far: Vec<f64> = Vec::new();
    for place in photons.iter().step_by(photons.len().div_ceil(ASKED).max(1)) {
        // Each photon's nearest neighbor is itself.
        tree.nearest(*place, NEIGHBOURS + 1, f64::INFINITY, |_, squared| Some(squared), &mut found);
        far.extend(found.get(NEIGHBOURS).map(|near| near.squared));
    }
    far.sort_unstable_by(f64::total_cmp);
    let median = far.get(far.len() / 2)?.sqrt();
    (median > 0.0).then_some(median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_shrink_as_they_should() {
        // Γ(N + α) / (Γ(1 + α) Γ(N + 1)), α = 2/3.
        let mut radii = Radii::new(2.0 / 3.0);
        for (map, expected) in [(9, 0.508515840265743), (99, 0.23838878553836), (999, 0.110760909975979)] {
            assert!((radii.square(map) / expected - 1.0).abs() < 1e-12);
        }
        assert_eq!([radii.square(0), Radii::new(1.0).square(50)], [1.0, 1.0]);
        // Γ as above: r³ falls as r² does for disks.
        assert!((radii.ball(99).powf(1.5) / 0.23838878553836 - 1.0).abs() < 1e-12);
        assert!((radii.mean_ball(2) - (1.0 + (5.0f64 / 6.0).powf(2.0 / 3.0)) / 2.0).abs() < 1e-15);
        assert!((radii.mean_square(2) - (1.0 + 5.0 / 6.0) / 2.0).abs() < 1e-15);
    }
}
