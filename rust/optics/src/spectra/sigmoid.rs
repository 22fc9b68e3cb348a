//! Smooth spectra of colours.

use super::super::Rgb;
use super::{FIRST, Illuminant, LAST, Response, Waves};
use glam::{DMat3, DVec3};
use raywright_base::parallel;
use std::sync::LazyLock;

/// What a colour is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// A share of light: no wavelength of it exceeds 1 where no channel does.
    Share,
    /// An amount that has no bound: light, or a number per length.
    Amount,
}

/// A spectrum that looks like a colour in daylight: so many times a polynomial of degree 2 that goes through a sigmoid
/// (Jakob and Hanika, "A Low-Dimensional Function Space for Efficient Spectral Upsampling", 2019). What is grey is the
/// same at all wavelengths, to the last bit.
///
/// The sigmoid is that of the colour whose greatest channel is a half, which leaves it room to be smooth; of a share
/// that exceeds a half, that of the colour itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    scale: f64,
    /// Of the squared, the plain and the zeroth power of the wavelength, from 0 to 1 over what is seen; none where it
    /// is flat.
    polynomial: Option<DVec3>,
}

impl Smooth {
    /// Of a colour that is nowhere negative.
    pub fn of(colour: Rgb, role: Role) -> Self {
        match Normal::of(colour, role) {
            Ok(Normal { scale, colour, .. }) => {
                let about = fit(colour, None);
                Self { scale, polynomial: Some(approach(about, DVec3::from_array(colour.to_array()), &FINE)) }
            }
            Err(grey) => grey,
        }
    }

    /// About the same, by a table: to a thousandth of the greatest channel in the mean, and to a hundredth where one is
    /// next to nothing.
    pub fn looked_up(colour: Rgb, role: Role) -> Self {
        match Normal::of(colour, role) {
            Ok(normal) => Self { scale: normal.scale, polynomial: Some(TABLE.at(&normal)) },
            Err(grey) => grey,
        }
    }

    /// Whether it is the same at all wavelengths.
    pub fn is_flat(&self) -> bool {
        self.polynomial.is_none()
    }

    /// The value at a wavelength, nm.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        self.polynomial.map_or(self.scale, |polynomial| self.scale * sigmoid(argument(polynomial, wavelength)))
    }

    /// The values at those of a path.
    #[inline]
    pub fn lanes(&self, waves: &Waves) -> Rgb {
        match self.polynomial {
            Some(polynomial) => waves.lanes(|wavelength| self.scale * sigmoid(argument(polynomial, wavelength))),
            None => Rgb::splat(self.scale),
        }
    }
}

/// A colour whose greatest channel lies between [`LEAST`] and 1, and how many times as bright it is to be.
struct Normal {
    scale: f64,
    colour: Rgb,
    /// Which channel is the greatest.
    greatest: usize,
}

/// The greatest channel of the darkest colours that have a sigmoid of their own.
const LEAST: f64 = 0.5;

/// The greatest of the brightest: beyond, sigmoids of what is nearly white bend without end.
const MOST: f64 = 0.98;

impl Normal {
    /// Or a spectrum that is the same everywhere, if the colour is grey.
    fn of(colour: Rgb, role: Role) -> Result<Self, Smooth> {
        let (most, least) = (colour.max(), colour.min());
        // Rounding makes greys of sums slightly coloured.
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
    let t = (wavelength - FIRST) / (LAST - FIRST);
    (polynomial.x * t + polynomial.y) * t + polynomial.z
}

#[inline]
fn sigmoid(x: f64) -> f64 {
    0.5 + x / (2.0 * (1.0 + x * x).sqrt())
}

/// What is seen of wavelengths.
type Seen = Vec<(f64, DVec3)>;

/// Of every fifth nm, by which colours are told to a thousandth, and of every one.
static COARSE: LazyLock<Seen> = LazyLock::new(|| every(5));
static FINE: LazyLock<Seen> = LazyLock::new(|| every(1));

fn every(step: u32) -> Seen {
    let all = Response::new(Illuminant::Daylight, step);
    all.weights().map(|(wavelength, weight)| (wavelength, DVec3::from_array(weight.to_array()))).collect()
}

/// What a polynomial's sigmoid looks like, and how that changes with each coefficient.
fn seen(polynomial: DVec3, by: &Seen) -> (DVec3, DMat3) {
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

/// The polynomial of a colour that is not grey, from one that is near it or from grey.
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

/// Goes from a polynomial to that of a colour, by damped steps of Gauss and Newton (Levenberg 1944, Marquardt 1963).
fn approach(mut polynomial: DVec3, target: DVec3, by: &Seen) -> DVec3 {
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
        // Beyond, a sigmoid is a step, and nothing is seen of how steep it is.
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

/// Polynomials of normal colours: by which channel is the greatest, how great, and what the next two are over it.
struct Table(Vec<DVec3>);

const LEVELS: usize = 12;
const SHARES: usize = 24;

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let rows: Vec<_> =
        (0..3).flat_map(|k| (0..LEVELS).flat_map(move |l| (0..SHARES).map(move |j| [k, l, j]))).collect();
    let of_row = |&[greatest, level, second]: &[usize; 3]| {
        // Denser towards the brightest, whose polynomials go off the fastest.
        let level = MOST - (MOST - LEAST) * (1.0 - level as f64 / (LEVELS - 1) as f64).powi(2);
        let share = |i: usize| i as f64 / (SHARES - 1) as f64;
        // From grey on, each starts from its neighbour.
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
    Table(parallel::map(rows.len(), |i| of_row(&rows[i])).concat())
});

impl Table {
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
