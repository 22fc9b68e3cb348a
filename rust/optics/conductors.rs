//! Metals as they were measured.

use super::Rgb;

/// A metal's complex index of refraction, channel by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Chemical symbol.
    pub symbol: &'static str,
    /// English name.
    pub name: &'static str,
    /// Real part.
    pub eta: Rgb,
    /// Imaginary part.
    pub k: Rgb,
}

/// The metal of a chemical symbol or an English name, in any case of letters.
pub fn metal(name: &str) -> Option<Metal> {
    METALS
        .iter()
        .find(|metal| name.eq_ignore_ascii_case(metal.symbol) || name.eq_ignore_ascii_case(metal.name))
        .copied()
}

const fn metal_of(symbol: &'static str, name: &'static str, eta: [f64; 3], k: [f64; 3]) -> Metal {
    Metal { symbol, name, eta: Rgb::new(eta[0], eta[1], eta[2]), k: Rgb::new(k[0], k[1], k[2]) }
}

/// Every metal that is known, by symbol.
///
/// Red, green and blue have the values at 630, 532 and 465 nm, where the primaries of Rec. 709 and Rec. 2020 lie about,
/// linear between the measured wavelengths that refractiveindex.info lists: not a rendering of the spectrum, but what
/// a camera with narrow filters would see.
#[rustfmt::skip]
// Tungsten's k at 532 nm only looks like e.
#[allow(clippy::approx_constant)]
pub const METALS: [Metal; 26] = [
    // Johnson and Christy, "Optical Constants of the Noble Metals", 1972.
    metal_of("Ag", "silver", [0.0569, 0.0540, 0.0469], [4.2543, 3.4290, 2.8028]),
    // Rakić, "Algorithm for the determination of intrinsic optical constants of metal films", 1995.
    metal_of("Al", "aluminium", [1.4303, 0.9388, 0.6860], [7.5081, 6.4195, 5.6351]),
    // Johnson and Christy, 1972.
    metal_of("Au", "gold", [0.1884, 0.5439, 1.3319], [3.4034, 2.2309, 1.8693]),
    // Rakić et al., "Optical properties of metallic films for vertical-cavity optoelectronic devices", 1998.
    metal_of("Be", "beryllium", [3.4316, 3.3131, 3.1332], [3.1787, 3.1502, 3.1465]),
    // Johnson and Christy, "Optical constants of transition metals", 1974.
    metal_of("Co", "cobalt", [2.2086, 2.0014, 1.7890], [4.1595, 3.7350, 3.3710]),
    metal_of("Cr", "chromium", [3.1452, 3.0343, 2.4560], [3.3124, 3.3300, 3.2100]),
    // Johnson and Christy, 1972.
    metal_of("Cu", "copper", [0.2753, 1.1159, 1.2469], [3.3726, 2.5956, 2.4562]),
    // Johnson and Christy, 1974.
    metal_of("Fe", "iron", [2.8924, 2.8954, 2.6460], [3.0655, 2.9179, 2.8050]),
    // Inagaki, Arakawa and Williams, "Optical properties of liquid mercury", 1981.
    metal_of("Hg", "mercury", [1.9647, 1.4612, 1.1306], [5.2128, 4.5190, 3.9896]),
    // Schmitt et al., "Optical, structural, and functional properties of highly reflective and stable iridium mirror
    // coatings", 2022: sputtered.
    metal_of("Ir", "iridium", [2.9952, 2.5412, 2.2378], [5.5346, 4.9990, 4.5053]),
    // Smith, "Optical constants of sodium and potassium", 1969.
    metal_of("K", "potassium", [0.0516, 0.0480, 0.0426], [1.7262, 1.3807, 1.1195]),
    // Rasigni and Rasigni, "Optical constants of lithium deposits", 1977.
    metal_of("Li", "lithium", [0.2199, 0.2085, 0.2298], [2.9085, 2.3715, 1.9899]),
    // Palm et al., "Dynamic optical properties of metal hydrides", 2018.
    metal_of("Mg", "magnesium", [0.9708, 0.7661, 0.5538], [5.6203, 4.7838, 4.2422]),
    // Kirillova et al., 1971.
    metal_of("Mo", "molybdenum", [3.4220, 3.2900, 2.9060], [3.6260, 3.6896, 3.5880]),
    // Smith, 1969.
    metal_of("Na", "sodium", [0.0506, 0.0601, 0.0665], [2.6163, 2.1774, 1.8613]),
    // Johnson and Christy, 1974.
    metal_of("Ni", "nickel", [1.9900, 1.8775, 1.7650], [4.0943, 3.4946, 3.0480]),
    // Mathewson and Myers, "Absolute values of the optical constants of some pure metals", 1971.
    metal_of("Pb", "lead", [2.5975, 2.5047, 2.2305], [4.1650, 4.1875, 4.1923]),
    // Johnson and Christy, 1974.
    metal_of("Pd", "palladium", [1.7655, 1.5975, 1.4450], [4.2750, 3.7429, 3.3510]),
    // Rakić et al., 1998, Brendel and Bormann's model.
    metal_of("Pt", "platinum", [2.3137, 2.0382, 1.8793], [4.1601, 3.6116, 3.2231]),
    // Weaver, Olson and Lynch, "Optical investigation of the electronic structure of bulk Rh and Ir", 1977.
    metal_of("Rh", "rhodium", [2.1447, 1.9274, 1.8164], [5.5872, 4.8895, 4.5097]),
    // Johnson and Christy, 1974.
    metal_of("Ti", "titanium", [2.6979, 2.4793, 2.3050], [3.7571, 3.3511, 3.0820]),
    // Pflüger and Fink, in Palik, "Handbook of Optical Constants of Solids II", 1991.
    metal_of("TiN", "titanium nitride", [1.3444, 1.2349, 1.4020], [2.7447, 1.9528, 1.4218]),
    // Johnson and Christy, 1974.
    metal_of("V", "vanadium", [3.4502, 3.9150, 3.7440], [3.0417, 3.1250, 3.4040]),
    // Weaver, Lynch and Olson, "Optical properties of crystalline tungsten", 1975.
    metal_of("W", "tungsten", [3.6170, 3.4953, 3.3250], [2.9100, 2.7183, 2.5740]),
    // Werner, Glantschnig and Ambrosch-Draxl, "Optical constants and inelastic electron-scattering data for 17 elemental
    // metals", 2009.
    metal_of("Zn", "zinc", [1.1685, 0.8816, 0.7128], [5.6992, 4.8048, 4.1598]),
    // Querry, "Optical constants of minerals and other materials from the millimeter to the ultraviolet", 1987.
    metal_of("Zr", "zirconium", [3.0230, 2.4244, 2.0590], [3.5515, 3.2826, 2.9528]),
];

#[cfg(test)]
mod tests {
    use super::super::fresnel;
    use super::*;

    #[test]
    fn metals_are_found_by_symbol_and_name() {
        assert_eq!(metal("au"), metal("Gold"));
        assert_eq!(metal("Al").unwrap().name, "aluminium");
        assert!(metal("unobtainium").is_none());
        for (i, one) in METALS.iter().enumerate() {
            assert!(METALS[i + 1..].iter().all(|other| other.symbol > one.symbol && other.name != one.name));
        }
    }

    #[test]
    fn metals_have_their_colours_and_reflect_less_than_all() {
        for one in METALS {
            let f = fresnel::conductor(1.0, one.eta, one.k);
            assert!(f.min_element() > 0.25 && f.max_element() < 1.0, "{one:?}");
            // The rule of four points, against one of many.
            let many = (0..2000).map(|i| (f64::from(i) + 0.5) / 2000.0);
            let mean: Rgb = many.map(|mu| fresnel::conductor(mu, one.eta, one.k) * mu / 1000.0).sum();
            assert!(
                (mean - fresnel::ConductorIndex::new(one.eta, one.k).average()).abs().max_element() < 1e-3,
                "{one:?}"
            );
        }
        let normal = |name| metal(name).map(|m| fresnel::conductor(1.0, m.eta, m.k)).unwrap();
        // Silver is the whitest; copper and gold take blue, gold less of green.
        assert!(normal("silver").min_element() > 0.95);
        for yellow in [normal("gold"), normal("copper")] {
            assert!(yellow.x > 0.9 && yellow.x > yellow.y && yellow.y > yellow.z);
        }
        assert!(normal("gold").y > normal("copper").y && normal("gold").z < normal("copper").z);
    }
}
