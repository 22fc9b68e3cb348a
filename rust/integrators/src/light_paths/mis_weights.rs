//! MIS weights of bidirectional strategies.
//!
//! Every split of a path's vertices into s from the light and t from the camera, which counts as one, is a strategy
//! that samples it. The balance heuristic (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997,
//! 9.2) weights each strategy by its density over the sum of all. Both subpaths accumulate the ratios of the other
//! densities to their own. Each needs two sums, which do not depend on the other end (Georgiev, "Implementing Vertex
//! Connection and Merging", 2012). So no subpath is traversed again.
//!
//! Vertex merging is another strategy. The subpaths from both ends meet within the lookup radius, with as many light
//! paths as there are photons (Georgiev et al., "Light Transport Simulation with Vertex Connection and Merging", 2012;
//! Hachisuka et al., "A Path Space Extension for Robust Light Transport Simulation", 2012). Its density is that of both
//! subpaths times the disk's area times the number of photons. The last two factors are common to all merges. So
//! merging adds one summand per vertex where it is possible. Vertices that light reaches first are not merged: direct
//! light is sampled.
//!
//! The weights of one path sum to 1 if all its strategies use the same numbers, whatever they are. So roulette and the
//! random passage of masks are left out. The probability of a delta direction counts as equal from both ends.

use raywright_scene::EmissionDensity;

/// MIS partials of a subpath at a vertex: Georgiev's d_VCM and d_VC, and a term for merging.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Partial {
    /// Strategies where the other subpath arrives at this vertex, without the density of arriving: the inverse of
    /// this subpath's density.
    here: f64,
    /// Strategies where the other subpath continues from here, without the density of continuing.
    beyond: f64,
    /// The strategy that merges here, without the other subpath's density of arriving. After scattering it is pending,
    /// and joins `beyond` on the next arrival: merging needs another vertex toward the light.
    merged: f64,
}

impl Partial {
    /// Return the partials of emission. [`Partial::asked`] comes next, but for arriving, at the first surface.
    pub fn of_light(departure: &EmissionDensity) -> Self {
        let share = departure.cosine / departure.density;
        Self { here: share, beyond: if departure.is_single() { 0.0 } else { share }, merged: 0.0 }
    }

    /// Update for the first surface of a light path, given its cosine.
    pub fn arrived_first(self, cosine: f64) -> Self {
        Self { here: self.here / cosine, beyond: self.beyond / cosine, merged: 0.0 }
    }

    /// Multiply by the density of light sampling from the first surface.
    pub fn asked(self, density: f64) -> Self {
        Self { here: self.here * density, ..self }
    }

    /// Return the partials of the camera's first vertex. `density` is that of its rays per area, of as many rays as
    /// there are light paths.
    pub fn of_camera(paths: f64, density: f64) -> Self {
        Self { here: if density > 0.0 { paths / density } else { 0.0 }, beyond: 0.0, merged: 0.0 }
    }

    /// Update for arrival at a surface, given the distance and the cosine.
    pub fn arrived(self, distance: f64, cosine: f64) -> Self {
        let here = self.here * (distance * distance / cosine);
        Self { here, beyond: (self.beyond + self.merged) / cosine, merged: 0.0 }
    }

    /// Add merging at this vertex: `disk` is the lookup disk's area times the number of photons.
    pub fn merging(self, disk: f64) -> Self {
        Self { merged: disk, ..self }
    }

    /// Update for scattering, given the cosine and the densities of the direction and of the reverse one.
    pub fn scattered(self, cosine: f64, forward: f64, reverse: f64) -> Self {
        let share = cosine / forward;
        let beyond = share * (self.beyond * reverse + self.here);
        Self { here: 1.0 / forward, beyond, merged: share * self.merged }
    }

    /// Update for specular scattering: no strategy connects or ends here.
    pub fn scattered_singly(self, cosine: f64) -> Self {
        Self { here: 0.0, beyond: self.beyond * cosine, merged: 0.0 }
    }

    /// Return the densities of all strategies where the other subpath arrives here and continues, relative to a
    /// connection. `comes` is its density per area of arriving, and `reverse` that of continuing along this subpath.
    pub fn others(&self, comes: f64, reverse: f64) -> f64 {
        comes * (self.here + self.merged + self.beyond * reverse)
    }

    /// Return the densities of all strategies where the other subpath arrives here or continues, except merging
    /// here. They are relative to the factor common to both ends of the merge, without its disk.
    fn unmerged(&self, reverse: f64) -> f64 {
        self.here + self.beyond * reverse
    }

    /// Return the weight of a camera path that hits a light, given the densities of light sampling and of emission;
    /// `self` is before arrival.
    pub fn of_found(&self, asked: f64, departure: &EmissionDensity) -> f64 {
        weight(self.here * asked, self.beyond * departure.density / departure.cosine)
    }
}

/// Return the weight of light sampling. `asked` is its density and `departure` that of emission. `forward` is the
/// camera path's density of hitting the light. `cosine` is that of the light's direction, and `reverse` the density
/// with which a light path would continue along the camera path.
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

/// Return the weight of merging two vertices. Each comes with the density of continuing along the other subpath.
pub(crate) fn of_merged(light: (&Partial, f64), eye: (&Partial, f64), disk: f64) -> f64 {
    weight(light.0.unmerged(light.1) / disk, eye.0.unmerged(eye.1) / disk)
}

/// Return the weight of a strategy from the densities of all others, relative to its own, on either side.
pub(crate) fn weight(one: f64, other: f64) -> f64 {
    let weight = 1.0 / (1.0 + one + other);
    // Overflowed densities, or none known for any strategy.
    if weight.is_nan() { 0.0 } else { weight }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_scene::Source;

    /// A path with arbitrary densities: x₀ on the light, then surfaces up to the camera's first hit.
    struct Made {
        /// Distance from each vertex to the next.
        distance: Vec<f64>,
        /// Cosine at each vertex toward the previous and the next one.
        before: Vec<f64>,
        after: Vec<f64>,
        /// Densities per solid angle at each vertex: of a light path that continues, and of a camera path that
        /// continues.
        onward: Vec<f64>,
        back: Vec<f64>,
        is_single: Vec<bool>,
        is_matt: Vec<bool>,
        /// The lookup disk times the number of photons; 0 without merging.
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
        // The light is never specular. Two consecutive specular vertices leave no other strategy between them.
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

        /// Return the density of the strategy with s light vertices, up to a common factor; `None` if it is impossible.
        /// Computed directly, without the recursion.
        fn density(&self, s: usize) -> Option<f64> {
            let last = self.last();
            // Scattering vertices may be specular, but connected ones may not.
            if s > 0 && s <= last && (self.is_single[s] || s > 1 && self.is_single[s - 1]) {
                return None;
            }
            if s == last + 1 && self.is_single[last] || s == 0 && self.departure.is_single() {
                return None;
            }
            Some((0..=last).map(|i| if i < s { self.of_light(i, s) } else { self.of_eye(i) }).product())
        }

        /// Return the density with which a light path of s vertices samples a vertex.
        fn of_light(&self, i: usize, s: usize) -> f64 {
            match i {
                // Point on the light times the direction to the first surface.
                0 if s > 1 => area(self.departure.density, self.before[1], self.distance[0]),
                0 => area(self.asked, self.departure.cosine, self.distance[0]),
                1 => 1.0,
                _ => area(self.scattered(i - 1, self.onward[i - 1]), self.before[i], self.distance[i - 1]),
            }
        }

        /// Return the density with which a camera path samples a vertex.
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

        /// Return whether merging is possible at a vertex.
        fn merges(&self, i: usize) -> bool {
            i > 1 && self.is_matt[i] && self.disk > 0.0
        }

        /// Return the density of merging at a vertex, up to the same factor.
        fn merged_density(&self, i: usize) -> Option<f64> {
            let light = || (0..=i).map(|j| self.of_light(j, i + 1)).product::<f64>();
            let eye = || (i..=self.last()).map(|j| self.of_eye(j)).product::<f64>();
            self.merges(i).then(|| light() * eye() * self.disk)
        }

        /// Return the weight of merging at a vertex by the recursion.
        fn merged_weight(&self, i: usize) -> f64 {
            let (light, eye) = (self.light(i), self.eye(i, false));
            of_merged((&light, self.back[i]), (&eye, self.onward[i]), self.disk)
        }

        /// Return the partials of a camera path at a vertex, or after it if it continues.
        fn eye(&self, to: usize, goes_on: bool) -> Partial {
            let last = self.last();
            let mut eye = Partial::of_camera(self.paths, self.seen);
            for i in (to..=last).rev() {
                if i < last {
                    eye = eye.arrived(self.distance[i], self.after[i]);
                }
                // The camera path does not know whether this is the light's first surface.
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

        /// Return the partials of a light path at a vertex.
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

        /// Return the weight of the strategy by the recursion.
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
