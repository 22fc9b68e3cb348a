//! How wide light is gathered.

use super::kd_tree::KdTree;
use raywright_base::math::DVec3;

/// The square of a progressive estimate's radius in each of its maps, over that in the first: r²ₛ₊₁ / r²ₛ = (s + α) /
/// (s + 1), s from 1 on (Knaus and Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", 2011, eq. 17). It
/// depends on the number of the map alone, not on what was found.
#[derive(Debug)]
pub struct Radii {
    alpha: f64,
    /// Those known so far.
    squares: Vec<f64>,
}

impl Radii {
    /// Those by which, on average, the share `alpha` of new photons is kept.
    pub fn new(alpha: f64) -> Self {
        Self { alpha, squares: vec![1.0] }
    }

    /// That of a map, from 0 on.
    pub fn square(&mut self, map: u32) -> f64 {
        while self.squares.len() <= map as usize {
            let before = self.squares.len();
            let last = self.squares[before - 1];
            self.squares.push(last * (before as f64 + self.alpha) / (before as f64 + 1.0));
        }
        self.squares[map as usize]
    }

    /// Their mean over so many maps, at least one: where the bias goes by r², that of a picture of them all.
    pub fn mean_square(&mut self, maps: u32) -> f64 {
        let maps = maps.max(1);
        (0..maps).map(|map| self.square(map)).sum::<f64>() / f64::from(maps)
    }

    /// That of a ball, of whose photons the same share is kept: what is true of disks' squares is true of balls' cubes.
    pub fn ball(&mut self, map: u32) -> f64 {
        self.square(map).powf(2.0 / 3.0)
    }

    /// As [`Radii::mean_square`], of balls.
    pub fn mean_ball(&mut self, maps: u32) -> f64 {
        let maps = maps.max(1);
        (0..maps).map(|map| self.ball(map)).sum::<f64>() / f64::from(maps)
    }
}

/// Photons of which half of all have so many within the first radius.
pub(super) const NEIGHBOURS: usize = 24;

/// A radius that suits a map: the median, over its photons, of the distance to the 24th nearest. So it goes by how
/// densely light lies where most of it is. `None` if there are not as many.
pub(super) fn first(photons: &[DVec3]) -> Option<f64> {
    /// Photons that are asked, evenly spread over all.
    const ASKED: usize = 512;
    let tree = KdTree::new(photons.iter().copied());
    let mut found = Vec::new();
    let mut far: Vec<f64> = Vec::new();
    for place in photons.iter().step_by(photons.len().div_ceil(ASKED).max(1)) {
        // It is the nearest to itself.
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
        // Γ as above: r³ falls as r² does.
        assert!((radii.ball(99).powf(1.5) / 0.23838878553836 - 1.0).abs() < 1e-12);
        assert!((radii.mean_ball(2) - (1.0 + (5.0f64 / 6.0).powf(2.0 / 3.0)) / 2.0).abs() < 1e-15);
        assert!((radii.mean_square(2) - (1.0 + 5.0 / 6.0) / 2.0).abs() < 1e-15);
    }
}
