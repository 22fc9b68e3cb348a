//! Segments from many points of a homogeneous medium to one, as vectorizable loops over columns.

use raywright_base::math::DVec3;
use raywright_base::math::exponential::exp;
use raywright_base::simd::{Level, loops};
use raywright_optics::{Phase, PhaseTerms, Rgb};

/// Scattering points of paths, one column per coordinate, and their factors to another point.
pub(crate) struct Takers {
    level: Level,
    position: [Vec<f64>; 3],
    before: [Vec<f64>; 3],
    share: Vec<f64>,
    distance: Vec<f64>,
    onward: Vec<f64>,
    to_light: Vec<f64>,
    left: [Vec<f64>; 3],
}

/// A target point and two unit directions from it.
pub(crate) struct TargetDirections {
    pub to: DVec3,
    pub onward: DVec3,
    pub to_light: DVec3,
}

/// Factors of a pair of points.
pub(crate) struct PairFactors {
    /// The phase function and the surface cosine, over the squared distance.
    pub share: f64,
    /// The phase function at the target into its two directions; 1 and 0 for a surface, which reflects uniformly.
    pub onward: f64,
    pub to_light: f64,
    /// Transmittance.
    pub left: Rgb,
}

loops! {
    fn turn(
        phase: &PhaseTerms,
        to: &[[f64; 3]; 3],
        position: [&[f64]; 3],
        before: [&[f64]; 3],
        share: &mut [f64],
        distance: &mut [f64],
        onward: &mut [f64],
        to_light: &mut [f64],
    ) {
        let count = share.len();
        let ([x, y, z], [a, b, c]) = (position, before);
        let (x, y, z, a, b, c) = (&x[..count], &y[..count], &z[..count], &a[..count], &b[..count], &c[..count]);
        let (distance, onward, to_light) = (&mut distance[..count], &mut onward[..count], &mut to_light[..count]);
        let [to, next, light] = to;
        for i in 0..count {
            let way = [to[0] - x[i], to[1] - y[i], to[2] - z[i]];
            let square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
            let length = square.sqrt();
            let unit = [way[0] / length, way[1] / length, way[2] / length];
            let part = phase.pdf([a[i], b[i], c[i]], unit) / square;
            // Coincident points have no direction.
            share[i] = if part < f64::INFINITY { part } else { 0.0 };
            distance[i] = length;
            onward[i] = if square > 0.0 { phase.pdf(unit, *next) } else { 0.0 };
            to_light[i] = if square > 0.0 { phase.pdf(unit, *light) } else { 0.0 };
        }
    }
}

loops! {
    fn fade(extinction: f64, distance: &[f64], left: &mut [f64]) {
        let distance = &distance[..left.len()];
        for i in 0..left.len() {
            left[i] = exp(-(extinction * distance[i]).min(700.0));
        }
    }
}

impl Default for Takers {
    fn default() -> Self {
        let (position, before, left) = Default::default();
        let (share, distance, onward, to_light) = Default::default();
        let level = Level::current().unwrap_or(Level::Scalar);
        Self { level, position, before, share, distance, onward, to_light, left }
    }
}

impl Takers {
    pub fn clear(&mut self) {
        let Self { position, before, .. } = self;
        position.iter_mut().chain(before).for_each(Vec::clear);
    }

    /// Append a point with the incident direction of its path.
    pub fn push(&mut self, position: DVec3, before: DVec3) {
        for axis in 0..3 {
            self.position[axis].push(position[axis]);
            self.before[axis].push(before[axis]);
        }
    }

    /// Compute the factors of all points to a target, given the extinction and the shares of the segments in the
    /// medium. For a surface, its normal gives the cosine.
    pub fn meet(
        &mut self,
        way: &TargetDirections,
        normal: Option<DVec3>,
        inside: &[f64],
        phase: &Phase,
        extinction: Rgb,
    ) {
        let count = self.position[0].len();
        let Self { level, position, before, share, distance, onward, to_light, left } = self;
        for column in [&mut *share, distance, onward, to_light].into_iter().chain(left.iter_mut()) {
            column.resize(count, 0.0);
        }
        let level = *level;
        let to = [way.to, way.onward, way.to_light].map(|vector| vector.to_array());
        let [position, before] = [position, before].map(|columns| columns.each_ref().map(|column| &column[..]));
        turn(level, &phase.terms(), &to, position, before, share, distance, onward, to_light);
        if let Some(normal) = normal {
            for i in 0..count {
                let apart = DVec3::new(position[0][i], position[1][i], position[2][i]) - way.to;
                share[i] *= normal.dot(apart).max(0.0) / distance[i];
                (onward[i], to_light[i]) = (1.0, 0.0);
            }
        }
        for (distance, inside) in distance.iter_mut().zip(inside) {
            *distance *= inside;
        }
        let [red, others @ ..] = left;
        fade(level, extinction[0], distance, red);
        for (channel, other) in (1..).zip(others) {
            if extinction[channel] == extinction[0] {
                other.copy_from_slice(red);
            } else {
                fade(level, extinction[channel], distance, other);
            }
        }
    }

    /// Return the factors of a point to the target.
    #[inline]
    pub fn pair(&self, i: usize) -> PairFactors {
        let left = self.left.each_ref().map(|column| column[i]);
        PairFactors {
            share: self.share[i],
            onward: self.onward[i],
            to_light: self.to_light[i],
            left: Rgb::from_array(left),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::{Sampler, warp};
    use raywright_optics::HenyeyGreenstein;

    #[test]
    fn pairs_are_what_they_are_one_by_one_at_every_level() {
        let phase = Phase::HenyeyGreenstein(HenyeyGreenstein::new(-0.6).unwrap());
        let extinction = Rgb::new(0.5, 0.5, 3.0);
        let drawn = |number: u32| Sampler::new(41, 0, number);
        let unit = |number: u32| warp::uniform_sphere(drawn(number).two(0));
        let place = |number: u32| unit(number) * 2.0 * drawn(number).one(4);
        let way = TargetDirections { to: place(0), onward: unit(1), to_light: unit(2) };
        let inside: Vec<f64> = (0..21).map(|i| drawn(100 + i).one(0)).collect();
        let mut first: Option<Vec<[f64; 6]>> = None;
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let mut takers = Takers { level, ..Takers::default() };
            (0..21).for_each(|i| takers.push(place(10 + i), unit(50 + i)));
            // One point coincides with the target.
            takers.push(way.to, DVec3::X);
            let mut found = Vec::new();
            for normal in [None, Some(DVec3::Z)] {
                takers.meet(&way, normal, &[&inside[..], &[1.0]].concat(), &phase, extinction);
                for (i, inside) in (0..21).zip(&inside) {
                    let PairFactors { share, onward, to_light, left } = takers.pair(i as usize);
                    let to = way.to - place(10 + i);
                    let (length, ahead) = (to.length(), to.normalize());
                    let cosine = normal.map_or(1.0, |normal| (-normal.dot(ahead)).max(0.0));
                    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
                    assert!(near(share, phase.pdf(unit(50 + i), ahead) * cosine / (length * length)));
                    if normal.is_none() {
                        assert!(near(onward, phase.pdf(ahead, way.onward)));
                        assert!(near(to_light, phase.pdf(ahead, way.to_light)));
                    }
                    (0..3).for_each(|c| assert!(near(left[c], (-extinction[c] * length * inside).exp())));
                    found.push([share, onward, to_light, left[0], left[1], left[2]]);
                }
                let none = takers.pair(21);
                assert!(none.share == 0.0 || none.share.is_nan(), "{}", none.share);
            }
            assert_eq!(*first.get_or_insert_with(|| found.clone()), found, "{level:?}");
        }
    }
}
