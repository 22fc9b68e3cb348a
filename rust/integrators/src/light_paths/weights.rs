//! How much each of the ways counts in which one path may be found.
//!
//! A path of s vertices walked from a light and t from the camera, which is one of them, is found by every split of its
//! vertices among the two. By the balance heuristic (Veach, "Robust Monte Carlo Methods for Light Transport
//! Simulation", 1997, 9.2) each counts by its density over the sum of all. The ratios of the others' densities to one's
//! own are gathered along both walks, each in two sums that are known without the other end (Georgiev, "Implementing
//! Vertex Connection and Merging", 2012): no walk is looked at again.
//!
//! Where walks merge, a path is found as well by walks that come to the same vertex from both ends: as nearly the same
//! as photons count, of as many walks from lights as there are photons (Georgiev et al., "Light Transport Simulation
//! with Vertex Connection and Merging", 2012; Hachisuka et al., "A Path Space Extension for Robust Light Transport
//! Simulation", 2012). With the density with which either walk comes there, that has the disk's area times the number
//! of photons: what all share, so that it is but one more summand where a vertex can be merged at. None merges where
//! light comes first: that is found by asking for it.
//!
//! Weights of one path add up to 1 as long as all of its ways put the same numbers in, whatever these are. So roulette
//! and masks, which are passed by chance, are left out, and where a direction is single, the chance that it was drawn
//! with counts as the same from both ends.

use raywright_scene::EmissionDensity;

/// What is known, where a walk has come to, of the other ways to find its vertices: Georgiev's d_VCM and d_VC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Partial {
    /// Of the way in which the walk from the other end comes to this vertex, less the density of that: the inverse of
    /// the density with which this one came here.
    here: f64,
    /// Of those in which the other walk goes on from here, less the density with which it does.
    beyond: f64,
    /// Of that which merges here, less the density with which the other walk comes here. Once the walk has gone on, it
    /// waits to be part of the former until it is known that there is light before.
    merged: f64,
}

impl Partial {
    /// That of light that sets out. At its first surface, [`Partial::asked`] comes before all else but arriving.
    pub fn of_light(departure: &EmissionDensity) -> Self {
        let share = departure.cosine / departure.density;
        Self { here: share, beyond: if departure.is_single() { 0.0 } else { share }, merged: 0.0 }
    }

    /// Light has come to its first surface, under the cosine of an angle to the normal.
    pub fn arrived_first(self, cosine: f64) -> Self {
        Self { here: self.here / cosine, beyond: self.beyond / cosine, merged: 0.0 }
    }

    /// With the density with which light is asked for from the first surface.
    pub fn asked(self, density: f64) -> Self {
        Self { here: self.here * density, ..self }
    }

    /// That of what the camera sees first: `density` is that of its rays, of which there are as many as paths from
    /// lights, by area.
    pub fn of_camera(paths: f64, density: f64) -> Self {
        Self { here: if density > 0.0 { paths / density } else { 0.0 }, beyond: 0.0, merged: 0.0 }
    }

    /// The walk has come to a surface over a distance, under the cosine of an angle to the normal.
    pub fn arrived(self, distance: f64, cosine: f64) -> Self {
        let here = self.here * (distance * distance / cosine);
        Self { here, beyond: (self.beyond + self.merged) / cosine, merged: 0.0 }
    }

    /// The same where walks merge: `disk` is the area from which photons count, times their number.
    pub fn merging(self, disk: f64) -> Self {
        Self { merged: disk, ..self }
    }

    /// The walk goes on under the cosine of an angle to the normal, in a direction of a density, where the other would
    /// go back with another.
    pub fn scattered(self, cosine: f64, forward: f64, reverse: f64) -> Self {
        let share = cosine / forward;
        let beyond = share * (self.beyond * reverse + self.here);
        Self { here: 1.0 / forward, beyond, merged: share * self.merged }
    }

    /// The same in a single direction: no other walk ends or begins here.
    pub fn scattered_singly(self, cosine: f64) -> Self {
        Self { here: 0.0, beyond: self.beyond * cosine, merged: 0.0 }
    }

    /// The densities of all ways in which the other walk comes here and on, over that of a connection to here: it comes
    /// with a density, by area, and goes back along this one with another.
    pub fn others(&self, comes: f64, reverse: f64) -> f64 {
        comes * (self.here + self.merged + self.beyond * reverse)
    }

    /// The densities of all ways in which the other walk comes here or beyond, but that of merging here, over what that
    /// has in common with the other end's: its disk.
    fn unmerged(&self, reverse: f64) -> f64 {
        self.here + self.beyond * reverse
    }

    /// How much it counts that a walk from the camera has come upon light that is asked for with a density, and sets
    /// out so; `self` before arriving.
    pub fn of_found(&self, asked: f64, departure: &EmissionDensity) -> f64 {
        weight(self.here * asked, self.beyond * departure.density / departure.cosine)
    }
}

/// How much it counts where light was asked for with a density, which sets out so: a ray of the walk comes upon it with
/// another density, and light comes under the cosine of an angle to the normal, where the walk from the light would go
/// on along the other with the last.
pub(crate) fn of_asked(
    eye: &Partial,
    (asked, departure): (f64, &EmissionDensity),
    forward: f64,
    cosine: f64,
    reverse: f64,
) -> f64 {
    let found = if departure.is_single() { 0.0 } else { forward / asked };
    weight(found, eye.merging(0.0).others(departure.density * cosine / (asked * departure.cosine), reverse))
}

/// How much it counts that walks merge: as either end has come to the same vertex, with the density with which its walk
/// would go on from there along the other one, and of what disk.
pub(crate) fn of_merged(light: (&Partial, f64), eye: (&Partial, f64), disk: f64) -> f64 {
    weight(light.0.unmerged(light.1) / disk, eye.0.unmerged(eye.1) / disk)
}

/// The weight of a way by what all others have, of vertices on either side.
pub(crate) fn weight(one: f64, other: f64) -> f64 {
    let weight = 1.0 / (1.0 + one + other);
    // Densities that no number holds, or that are known for none of the ways.
    if weight.is_nan() { 0.0 } else { weight }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_scene::Source;

    /// A path of any densities: x₀ at the light, and then surfaces up to the one that the camera sees first.
    struct Made {
        /// Between a vertex and the next.
        distance: Vec<f64>,
        /// At a vertex, towards the one before and the one after.
        before: Vec<f64>,
        after: Vec<f64>,
        /// With which light goes on at a vertex, and a walk from the camera goes back, by solid angle.
        onward: Vec<f64>,
        back: Vec<f64>,
        is_single: Vec<bool>,
        is_matt: Vec<bool>,
        /// The disk of photons, times their number; 0 where walks do not merge.
        disk: f64,
        departure: EmissionDensity,
        asked: f64,
        seen: f64,
        paths: f64,
    }

    fn made(number: u32, length: usize, is_point: bool) -> Made {
        let mut sampler = Sampler::new(9, number, 0);
        let mut dimension = 0;
        let mut any = || {
            dimension += 1;
            0.05 + 3.0 * sampler.one(dimension)
        };
        let mut all = || (0..=length).map(|_| any()).collect::<Vec<f64>>();
        let [distance, before, after, onward, back] = [(); 5].map(|()| all());
        let single = all();
        // Neither the light nor its neighbours in turn: of two singles in a row there is no other way.
        let is_single: Vec<bool> = (0..=length).map(|i| i > 0 && single[i] < 1.0).collect();
        let is_matt = (0..=length).map(|i| i > 0 && single[i] > 2.0).collect();
        let cosine = if is_point { 1.0 } else { after[0] };
        let source = if is_point { Source::Point(0) } else { Source::Surface(0) };
        let departure = EmissionDensity { source, density: any(), cosine };
        let (asked, seen) = (any(), any());
        let disk = if number.is_multiple_of(2) { 0.0 } else { 3.0 * any() };
        let paths = 64.0;
        Made { distance, before, after, onward, back, is_single, is_matt, disk, departure, asked, seen, paths }
    }

    fn area(pdf: f64, cosine: f64, distance: f64) -> f64 {
        pdf * cosine / (distance * distance)
    }

    impl Made {
        fn last(&self) -> usize {
            self.before.len() - 1
        }

        /// The density of the way that has s vertices from the light, up to a factor that all have; none if there is no
        /// such way. Written out with no regard to the recursion.
        fn density(&self, s: usize) -> Option<f64> {
            let last = self.last();
            // Vertices that either walk scatters at may be single; those that are connected may not.
            if s > 0 && s <= last && (self.is_single[s] || s > 1 && self.is_single[s - 1]) {
                return None;
            }
            if s == last + 1 && self.is_single[last] || s == 0 && self.departure.is_single() {
                return None;
            }
            Some((0..=last).map(|i| if i < s { self.of_light(i, s) } else { self.of_eye(i) }).product())
        }

        /// With which density a walk from the light, of s vertices, comes to a vertex.
        fn of_light(&self, i: usize, s: usize) -> f64 {
            match i {
                // Where the light is, times its direction to the first surface.
                0 if s > 1 => area(self.departure.density, self.before[1], self.distance[0]),
                0 => area(self.asked, self.departure.cosine, self.distance[0]),
                1 => 1.0,
                _ => area(self.scattered(i - 1, self.onward[i - 1]), self.before[i], self.distance[i - 1]),
            }
        }

        /// With which density a walk from the camera comes to a vertex.
        fn of_eye(&self, i: usize) -> f64 {
            if i == self.last() {
                return self.seen / self.paths;
            }
            let cosine = if i == 0 { self.departure.cosine } else { self.after[i] };
            area(self.scattered(i + 1, self.back[i + 1]), cosine, self.distance[i])
        }

        fn scattered(&self, i: usize, pdf: f64) -> f64 {
            if self.is_single[i] { 1.0 } else { pdf }
        }

        /// Whether walks merge at a vertex.
        fn merges(&self, i: usize) -> bool {
            i > 1 && self.is_matt[i] && self.disk > 0.0
        }

        /// The density of merging at a vertex, up to the same factor.
        fn merged_density(&self, i: usize) -> Option<f64> {
            let light = || (0..=i).map(|j| self.of_light(j, i + 1)).product::<f64>();
            let eye = || (i..=self.last()).map(|j| self.of_eye(j)).product::<f64>();
            self.merges(i).then(|| light() * eye() * self.disk)
        }

        /// The weight of merging there, by the recursion.
        fn merged_weight(&self, i: usize) -> f64 {
            let (light, eye) = (self.light(i), self.eye(i, false));
            of_merged((&light, self.back[i]), (&eye, self.onward[i]), self.disk)
        }

        /// What a walk from the camera knows where it has come to a vertex, or as it goes on.
        fn eye(&self, to: usize, goes_on: bool) -> Partial {
            let last = self.last();
            let mut eye = Partial::of_camera(self.paths, self.seen);
            for i in (to..=last).rev() {
                if i < last {
                    eye = eye.arrived(self.distance[i], self.after[i]);
                }
                // It does not know whether light comes here first.
                eye = eye.merging(if self.is_matt[i] { self.disk } else { 0.0 });
                let goes_on = i > to || goes_on;
                if goes_on && self.is_single[i] {
                    eye = eye.scattered_singly(self.before[i]);
                } else if goes_on {
                    eye = eye.scattered(self.before[i], self.back[i], self.onward[i]);
                }
            }
            eye
        }

        /// What a walk from the light knows where it has come to a vertex.
        fn light(&self, to: usize) -> Partial {
            let mut light = Partial::of_light(&self.departure);
            for i in 1..=to {
                light = match i {
                    1 => light.arrived_first(self.before[1]).asked(self.asked),
                    _ => light.arrived(self.distance[i - 1], self.before[i]),
                };
                light = light.merging(if self.merges(i) { self.disk } else { 0.0 });
                if i < to && self.is_single[i] {
                    light = light.scattered_singly(self.after[i]);
                } else if i < to {
                    light = light.scattered(self.after[i], self.onward[i], self.back[i]);
                }
            }
            light
        }

        /// The weight of that way by the recursion.
        fn weight(&self, s: usize) -> f64 {
            let last = self.last();
            let eye = if s > last { Partial::of_camera(self.paths, self.seen) } else { self.eye(s.max(1), s == 0) };
            match s {
                0 => return eye.of_found(self.asked, &self.departure),
                1 => {
                    let asked = (self.asked, &self.departure);
                    return of_asked(&eye, asked, self.back[1], self.before[1], self.onward[1]);
                }
                _ => {}
            }
            let light = self.light(s - 1);
            let end = s - 1;
            if s == last + 1 {
                return weight(light.others(self.seen / self.paths, self.back[end]), 0.0);
            }
            let square = self.distance[end] * self.distance[end];
            let one = light.others(self.back[s] * self.after[end] / square, self.back[end]);
            let other = eye.others(self.onward[end] * self.before[s] / square, self.onward[s]);
            weight(one, other)
        }
    }

    #[test]
    fn weights_are_the_balance_heuristic_and_add_up_to_one() {
        let (mut found, mut merged) = (0, 0);
        for number in 0..4000 {
            let path = made(number, 1 + number as usize % 6, number % 3 == 0);
            let ways: Vec<_> = (0..=path.last() + 1).filter_map(|s| Some((s, path.density(s)?))).collect();
            let merges: Vec<_> = (2..=path.last()).filter_map(|i| Some((i, path.merged_density(i)?))).collect();
            let all: f64 = ways.iter().chain(&merges).map(|(_, density)| density).sum();
            for &(s, density) in &ways {
                let weight = path.weight(s);
                assert!((weight - density / all).abs() < 1e-12, "{number}, {s}: {weight} {}", density / all);
            }
            for &(i, density) in &merges {
                let weight = path.merged_weight(i);
                assert!((weight - density / all).abs() < 1e-12, "{number}, {i}: {weight} {}", density / all);
            }
            found += usize::from(ways.len() > 1);
            merged += merges.len();
        }
        assert!(found > 2000 && merged > 300, "{found} {merged}");
    }

    #[test]
    fn weights_of_extremes_are_numbers() {
        for (one, other) in [(f64::INFINITY, 0.0), (f64::NAN, 1.0), (1e300, 1e300), (0.0, 0.0)] {
            assert!((0.0..=1.0).contains(&weight(one, other)));
        }
    }
}
