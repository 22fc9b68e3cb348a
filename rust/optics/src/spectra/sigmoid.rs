//! Smooth spectra of RGB colors.

use super::super::Rgb;
use super::{FIRST, Illuminant, LAST, Response, Waves};
use glam::{DMat3, DVec3};
use raywright_base::parallel;
use std::sync::LazyLock;

/// The physical quantity of a color.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// A reflectance: no wavelength exceeds 1 if no channel does.
    Share,
    /// An unbounded amount: light, or a coefficient per length.
    Amount,
}

/// A spectrum that has a given color under daylight: a scaled sigmoid of a polynomial of degree 2 (Jakob and Hanika,
/// "A Low-Dimensional Function Space for Efficient Spectral Upsampling", 2019). A gray color has exactly the same
/// value at all wavelengths.
///
/// The sigmoid is that of the color scaled to a greatest channel of one half, which keeps it smooth. For a reflectance
/// above one half, it is that of the color itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    scale: f64,
    /// Coefficients of the squared, the linear and the constant term in the wavelength, scaled from 0 to 1 over the
    /// visible range; `None` if the spectrum is flat.
    polynomial: Option<DVec3>,
}

impl Smooth {
    /// The spectrum of a non-negative color.
    pub fn of(colour: Rgb, role: Role) -> Self {
        match Normal::of(colour, role) {
            Ok(Normal { scale, colour, .. }) => {
                let about = fit(colour, None);
                Self { scale, polynomial: Some(approach(about, DVec3::from_array(colour.to_array()), &FINE)) }
            }
            Err(grey) => grey,
        }
    }

    /// Approximation by a table: to a thousandth of the greatest channel on average, and to a hundredth if a channel is
    /// nearly 0.
    pub fn looked_up(colour: Rgb, role: Role) -> Self {
        match Normal::of(colour, role) {
            Ok(normal) => Self { scale: normal.scale, polynomial: Some(TABLE.at(&normal)) },
            Err(grey) => grey,
        }
    }

    /// Returns whether it is the same at all wavelengths.
    pub fn is_flat(&self) -> bool {
        self.polynomial.is_none()
    }

    /// Value at a wavelength, nm.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        self.polynomial.map_or(self.scale, |polynomial| self.scale * sigmoid(argument(polynomial, wavelength)))
    }

    /// Values at a path's wavelengths.
    #[inline]
    pub fn lanes(&self, waves: &Waves) -> Rgb {
        let Some(polynomial) = self.polynomial else { return Rgb::splat(self.scale) };
        // Four, as two registers have.
        let [a, b, c] = waves.all();
        let mut lanes = [a, b, c, c];
        for lane in &mut lanes {
            *lane = self.scale * sigmoid(argument(polynomial, *lane));
        }
        let [a, b, c, _] = lanes;
        Rgb::new(a, b, c)
    }
}

/// A color whose greatest channel is between [`LEAST`] and 1, and a scale.
struct Normal {
    scale: f64,
    colour: Rgb,
    /// Index of the greatest channel.
    greatest: usize,
}

/// Greatest channel of the darkest colors with a sigmoid of their own.
const LEAST: f64 = 0.5;

/// Greatest channel of the brightest such colors; beyond it, sigmoids of nearly white colors become arbitrarily
/// steep.
const MOST: f64 = 0.98;

impl Normal {
    /// Normalizes a color; the error is the flat spectrum of a gray.
    fn of(colour: Rgb, role: Role) -> Result<Self, Smooth> {
        let (most, least) = (colour.max(), colour.min());
        // Rounding makes sums of grays slightly colored.
        if most - least <= 1e-12 * most {
            return Err(Smooth { scale: most, polynomial: None });
        }
        let level = if role == Role::Amount { LEAST } else { most.clamp(LEAST, MOST) };
        let greatest = if most == colour[0] {
            0
        } else if most == colour[1] {
            1
        } else {
            2
        };
        Ok(Self { scale: most / level, colour: colour * (level / most), greatest })
    }
}

#[inline]
fn argument(polynomial: DVec3, wavelength: f64) -> f64 {
    const SCALE: f64 = 1.0 / (LAST - FIRST);
    let t = (wavelength - FIRST) * SCALE;
    (polynomial.x * t + polynomial.y) * t + polynomial.z
}

#[inline]
fn sigmoid(x: f64) -> f64 {
    0.5 + x / (2.0 * (1.0 + x * x).sqrt())
}

/// Weights of wavelengths.
type MatchedWavelengths = Vec<(f64, DVec3)>;

/// At every fifth nm, which is accurate to a thousandth, and at every nm.
static COARSE: LazyLock<MatchedWavelengths> = LazyLock::new(|| every(5));
static FINE: LazyLock<MatchedWavelengths> = LazyLock::new(|| every(1));

fn every(step: u32) -> MatchedWavelengths {
    let all = Response::new(Illuminant::Daylight, step);
    all.weights().map(|(wavelength, weight)| (wavelength, DVec3::from_array(weight.to_array()))).collect()
}

/// Color of a polynomial's sigmoid, and its derivatives by the coefficients.
fn seen(polynomial: DVec3, by: &MatchedWavelengths) -> (DVec3, DMat3) {
    let (mut colour, mut slopes) = (DVec3::ZERO, DMat3::ZERO);
    for &(wavelength, weight) in by {
        let t = (wavelength - FIRST) / (LAST - FIRST);
        let x = argument(polynomial, wavelength);
        let root = 1.0 / (1.0 + x * x).sqrt();
        colour += weight * (0.5 + 0.5 * x * root);
        let slope = weight * (0.5 * root * root * root);
        slopes.x_axis += slope * (t * t);
        slopes.y_axis += slope * t;
        slopes.z_axis += slope;
    }
    (colour, slopes)
}

/// Fits the polynomial of a color that is not gray, starting from a nearby one or from gray.
fn fit(colour: Rgb, near: Option<DVec3>) -> DVec3 {
    let target = DVec3::from_array(colour.to_array());
    let Some(near) = near else {
        let grey = DVec3::splat(colour.mean().clamp(0.05, 0.95));
        let y = 2.0 * grey.x - 1.0;
        let mut polynomial = DVec3::new(0.0, 0.0, y / (1.0 - y * y).sqrt());
        for step in 1..=8 {
            polynomial = approach(polynomial, grey.lerp(target, f64::from(step) / 8.0), &COARSE);
        }
        return polynomial;
    };
    approach(near, target, &COARSE)
}

/// Moves a polynomial towards a target color, by damped Gauss-Newton steps (Levenberg 1944, Marquardt 1963).
fn approach(mut polynomial: DVec3, target: DVec3, by: &MatchedWavelengths) -> DVec3 {
    let mut damping = 1e-4;
    let (mut colour, mut slopes) = seen(polynomial, by);
    for _ in 0..40 {
        let off = target - colour;
        let error = off.length_squared();
        if error < 1e-20 {
            break;
        }
        let normal = slopes.transpose() * slopes;
        let damped =
            normal + DMat3::from_diagonal(DVec3::new(normal.x_axis.x, normal.y_axis.y, normal.z_axis.z) * damping);
        let step = damped.inverse() * (slopes.transpose() * off);
        let next = polynomial + step;
        // Beyond this size the sigmoid is a step, and its steepness has no visible effect.
        if !step.is_finite() || next.abs().max_element() > 1e4 {
            damping *= 10.0;
            if damping > 1e8 {
                break;
            }
            continue;
        }
        let (there, turned) = seen(next, by);
        if (target - there).length_squared() < error {
            (polynomial, colour, slopes) = (next, there, turned);
            damping = (damping * 0.1).max(1e-12);
        } else {
            damping *= 10.0;
            if damping > 1e8 {
                break;
            }
        }
    }
    polynomial
}

/// Polynomials of normalized colors: by the index of the greatest channel, its value, and the ratios of the next two
/// channels to it.
struct SigmoidTable(Vec<DVec3>);

const LEVELS: usize = 12;
const SHARES: usize = 24;

static TABLE: LazyLock<SigmoidTable> = LazyLock::new(|| {
    let rows: Vec<_> =
        (0..3).flat_map(|k| (0..LEVELS).flat_map(move |l| (0..SHARES).map(move |j| [k, l, j]))).collect();
    let of_row = |&[greatest, level, second]: &[usize; 3]| {
        // Denser towards the brightest, whose polynomials grow fastest.
        let level = MOST - (MOST - LEAST) * (1.0 - level as f64 / (LEVELS - 1) as f64).powi(2);
        let share = |i: usize| i as f64 / (SHARES - 1) as f64;
        // From gray on, each entry starts from its neighbor.
        let mut row: Vec<DVec3> = Vec::with_capacity(SHARES);
        for third in (0..SHARES).rev() {
            let mut colour = [level; 3];
            colour[(greatest + 1) % 3] *= share(second);
            colour[(greatest + 2) % 3] *= share(third);
            row.push(fit(Rgb::from_array(colour), row.last().copied()));
        }
        row.reverse();
        row
    };
    SigmoidTable(parallel::map(rows.len(), |i| of_row(&rows[i])).concat())
});

impl SigmoidTable {
    fn at(&self, normal: &Normal) -> DVec3 {
        let most = normal.colour[normal.greatest];
        let place = |x: f64, count: usize| {
            let x = (x * (count - 1) as f64).clamp(0.0, (count - 1) as f64);
            let before = (x as usize).min(count - 2);
            (before, x - before as f64)
        };
        let (l, dl) = place(1.0 - ((MOST - most) / (MOST - LEAST)).max(0.0).sqrt(), LEVELS);
        let [(j, dj), (i, di)] = [1, 2].map(|next| place(normal.colour[(normal.greatest + next) % 3] / most, SHARES));
        let one = |l: usize, j: usize, i: usize| self.0[((normal.greatest * LEVELS + l) * SHARES + j) * SHARES + i];
        let row = |l: usize, j: usize| one(l, j, i).lerp(one(l, j, i + 1), di);
        let plane = |l: usize| row(l, j).lerp(row(l, j + 1), dj);
        plane(l).lerp(plane(l + 1), dl)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks(smooth: &Smooth) -> Rgb {
        Response::new(Illuminant::Daylight, 1).seen(|nm| smooth.at(nm))
    }

    #[test]
    fn colours_look_like_themselves_and_no_share_exceeds_one() {
        for i in 0..6_u32.pow(3) {
            let colour = Rgb::from_array([i / 36, i / 6 % 6, i % 6].map(|x| f64::from(x) / 5.0));
            for role in [Role::Share, Role::Amount] {
                let exact = Smooth::of(colour, role);
                let off = (looks(&exact) - colour).abs().max();
                assert!(off < if colour.min() > 0.0 { 1e-6 } else { 2e-3 }, "{colour} {role:?} {off}");
                let off = (looks(&Smooth::looked_up(colour, role)) - colour).abs().max();
                assert!(off <= 0.02 * colour.max(), "{colour} {role:?} {off}");
            }
            let share = Smooth::of(colour, Role::Share);
            let most = (360..=830).map(|nm| share.at(f64::from(nm))).fold(0.0, f64::max);
            assert!(most <= 1.0 / MOST, "{colour} {most}");
        }
    }

    #[test]
    fn grey_is_flat_and_light_goes_by_its_scale() {
        for grey in [0.0, 0.3, 1.0, 70.0] {
            let flat = Smooth::of(Rgb::splat(grey), Role::Amount);
            assert!((360..=830).all(|nm| flat.at(f64::from(nm)) == grey));
        }
        let colour = Rgb::new(0.9, 0.2, 0.4);
        let (one, seven) = (Smooth::of(colour, Role::Amount), Smooth::of(colour * 7.0, Role::Amount));
        assert!((360..=830).all(|nm| (seven.at(f64::from(nm)) / one.at(f64::from(nm)) - 7.0).abs() < 1e-9));
    }
}
