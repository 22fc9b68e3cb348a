//! Soap films as the CIE's observer sees them.

use super::reflectance;
use crate::spectra::matching;
use glam::{DMat3, DVec3};

/// The response at every nm, by cubics through every fifth: as close to the CIE's table of every nm as 1e-6, where
/// lines are off by 1e-4.
fn response(nm: u32) -> DVec3 {
    let (before, t) = (f64::from(nm - nm % 5), f64::from(nm % 5) / 5.0);
    let [a, b, c, d] = [-5.0, 0.0, 5.0, 10.0].map(|by| matching(before + by));
    let (up, down, far) = (t + 1.0, 1.0 - t, 2.0 - t);
    (b * (down * far * up) + c * (t * up * far)) * 0.5 - (a * (down * far * t) + d * (t * up * down)) / 6.0
}

/// From X, Y and Z to linear sRGB, by where its primaries and its white lie (IEC 61966-2-1).
fn srgb() -> DMat3 {
    let primaries = DMat3::from_cols_array(&[0.64, 0.33, 0.03, 0.30, 0.60, 0.10, 0.15, 0.06, 0.79]);
    let white = DVec3::new(0.3127, 0.3290, 1.0 - 0.3127 - 0.3290) / 0.3290;
    (primaries * DMat3::from_diagonal(primaries.inverse() * white)).inverse()
}

#[test]
fn soap_films_have_their_colours() {
    // Straight on, in light that is even over wavelengths, by thickness in nm: X, Y and Z with Y = 1 for a mirror, and
    // linear sRGB (Born and Wolf, 7.6 and 1.6, summed over every nm from 360 to 830 with the CIE's table of 1931).
    let truths = [
        (0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        (50.0, [0.036653569, 0.0373740181, 0.0503900611], [0.036209902, 0.0366801667, 0.0476764616]),
        (100.0, [0.0740367497, 0.0758483941, 0.0712905095], [0.0877966202, 0.0734919551, 0.0639993833]),
        (150.0, [0.0496402816, 0.0476243834, 0.0121262983], [0.081619432, 0.0417321775, 0.00586436783]),
        (200.0, [0.0130235962, 0.00557891891, 0.023472519], [0.0219284972, -0.00118176529, 0.0243963167]),
        (250.0, [0.023120242, 0.0278659883, 0.0726257602], [-0.00412067766, 0.0328845086, 0.0723655211]),
        (300.0, [0.0538322429, 0.066802417, 0.0370001187], [0.0533191117, 0.0746801465, 0.0284766096]),
        (350.0, [0.0597360887, 0.0536907088, 0.0102708017], [0.105938543, 0.0432500047, 0.00322740067]),
        (400.0, [0.037332577, 0.0182389386, 0.0566708773], [0.0646968134, 0.000386254947, 0.058255994]),
        (500.0, [0.0323311737, 0.0538578253, 0.0162329447], [0.0138903267, 0.0703733066, 0.00797059046]),
        (600.0, [0.0520728739, 0.0305518282, 0.0591723482], [0.0922927829, 0.00930184546, 0.0592084356]),
        (700.0, [0.0248261035, 0.0436796734, 0.0279188323], [-0.000612369878, 0.0590392735, 0.0219808417]),
        (850.0, [0.0341083781, 0.0325339902, 0.0284601284], [0.0463364925, 0.0291560422, 0.0253428124]),
        (1000.0, [0.0464684549, 0.0400762409, 0.0334223185], [0.0723255994, 0.0315313377, 0.0297368527]),
        (2000.0, [0.0396181763, 0.0391533525, 0.0401332157], [0.0481967599, 0.0367184896, 0.0366372463]),
        (5000.0, [0.0393648036, 0.0393485774, 0.0393441033], [0.0474689111, 0.0372975134, 0.0357492605]),
    ];
    let to_srgb = srgb();
    for (thickness, xyz, rgb) in truths {
        let (mut sum, mut mirror) = (DVec3::ZERO, 0.0);
        for nm in 360..=830 {
            sum += response(nm) * reflectance(nm.into(), 1.0, thickness, 1.0, 1.33, 1.0.into());
            mirror += response(nm).y;
        }
        let found = sum / mirror;
        for (found, truth) in [(found, xyz), (to_srgb * found, rgb)] {
            let off = (found - DVec3::from_array(truth)).abs().max_element();
            assert!(off < 1e-5, "{thickness} {found} {off:e}");
        }
    }
}
