//! Energy balance of white materials in one scattering event, by quadrature over the direction of incidence under
//! uniform light. 0 is correct. The table has the largest errors over all angles and over all indices of refraction of
//! glass and coats.

use raywright::math::DVec3;
use raywright::optics::albedo::Tabulated;
use raywright::optics::conductors::Reflectance;
use raywright::optics::fresnel::ConductorIndex;
use raywright::optics::furnace::{directional_albedo, drawn_albedo};
use raywright::optics::{
    Beckmann, Bsdf, Coated, Conductor, Dielectric, Ggx, LayeredPrincipled, LayeredPrincipledThin, Look, MetallicRough,
    OrenNayar, Rgb,
};
use raywright::parallel;

/// Roughness of each column.
const ALPHAS: [f64; 9] = [1e-4, 0.001, 0.01, 0.03, 0.1, 0.2, 0.35, 0.6, 1.0];

/// Relative indices of refraction of glass, below over above.
const GLASS: [f64; 13] = [0.5, 0.6, 0.667, 0.75, 0.9, 0.99, 1.01, 1.1, 1.33, 1.5, 1.8, 2.4, 3.0];

/// Indices of refraction of coats.
const COATS: [f64; 6] = [1.1, 1.33, 1.5, 1.8, 2.4, 3.0];

/// Return cosines of directions: uniform in angle, and some at grazing angles.
fn cosines() -> Vec<f64> {
    let even = (0..30).map(|i| f64::from(3 * i).to_radians().cos());
    even.chain([0.03, 0.01, 0.003, 0.001]).collect()
}

/// Return the largest loss (negative) and gain (positive) of a white material. `eta` is the index below over that
/// above, and `width` that of its sharpest lobe; `None` uses sampling instead of quadrature.
fn extremes(scatter: &(impl Bsdf + Sync), eta: f64, width: Option<f64>) -> [f64; 2] {
    let sides: &[f64] = if scatter.transmits() { &[1.0, -1.0] } else { &[1.0] };
    let ways: Vec<DVec3> = cosines()
        .into_iter()
        .flat_map(|z| {
            sides.iter().map(move |side| {
                let sine = ((1.0 - z) * (1.0 + z)).sqrt();
                DVec3::new(0.8 * sine, 0.6 * sine, z * side)
            })
        })
        .collect();
    let off = |wo: DVec3| match width {
        Some(width) => directional_albedo(scatter, eta, wo, width, 1e-6) - 1.0,
        None => drawn_albedo(scatter, wo, 1 << 15) - 1.0,
    };
    all(parallel::map(ways.len(), |i| [off(ways[i]); 2]).into_iter())
}

fn wider(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn all(parts: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    parts.fold([0.0; 2], wider)
}

fn glass<F: Tabulated + Send + Sync>(alpha: f64) -> [f64; 2] {
    all(GLASS.iter().map(|&eta| extremes(&Dielectric::of(eta, F::rough([alpha; 2])), eta, Some(alpha))))
}

fn metal<F: Tabulated + Send + Sync>(alpha: f64, across: f64) -> [f64; 2] {
    let white = Reflectance::Index(ConductorIndex::new(Rgb::ONE, Rgb::splat(1e12)));
    extremes(&Conductor::of(white, F::rough([alpha, across])), 1.0, (alpha == across).then_some(alpha))
}

fn plastic<F: Tabulated + Send + Sync>(alpha: f64) -> [f64; 2] {
    all(COATS.iter().map(|&eta| extremes(&Coated::of(Rgb::ONE, eta, F::rough([alpha; 2])), 1.0, Some(alpha))))
}

/// Return white parameters, with the other values set to `other`, which should not matter.
fn white(alpha: f64, transmission: f64, other: f64) -> Look {
    Look {
        base_color: Rgb::ONE,
        luminance: 1.0,
        roughness: alpha.sqrt(),
        anisotropic: 0.0,
        transmission,
        specular_tint: other,
        sheen: other,
        sheen_tint: 0.5 * other,
        flatness: 1.0 - other,
    }
}

fn principled(alpha: f64) -> [f64; 2] {
    let kinds = [(0.0, 0.0, [0.0; 2]), (0.5, 0.0, [0.6, 0.9]), (1.0, 0.0, [1.0, 0.0]), (0.0, 1.0, [0.0; 2])];
    all(kinds.into_iter().flat_map(|(metallic, through, coat)| {
        [1.33, 1.5, 2.4]
            .map(|eta| extremes(&LayeredPrincipled::new(white(alpha, through, 0.5), eta, metallic, coat), eta, None))
    }))
}

fn principled_sheet(alpha: f64) -> [f64; 2] {
    all([0.0, 0.5, 1.0]
        .into_iter()
        .map(|through| extremes(&LayeredPrincipledThin::new(white(alpha, through, 0.5), 1.5, 0.3), 1.0, None)))
}

/// A name, and a function from roughness to loss and gain.
type Row = (&'static str, fn(f64) -> [f64; 2]);

const ROWS: [Row; 12] = [
    ("`Dielectric`, index 0.5 to 3", glass::<Ggx>),
    ("`Dielectric`, Beckmann's facets", glass::<Beckmann>),
    ("`Conductor`", |alpha| metal::<Ggx>(alpha, alpha)),
    ("`Conductor`, 0.2 across", |alpha| metal::<Ggx>(alpha, 0.2)),
    ("`Conductor`, Beckmann's facets", |alpha| metal::<Beckmann>(alpha, alpha)),
    ("`Conductor`, Beckmann's, 0.2 across", |alpha| metal::<Beckmann>(alpha, 0.2)),
    ("`Plastic`, index 1.1 to 3", plastic::<Ggx>),
    ("`Plastic`, Beckmann's facets", plastic::<Beckmann>),
    ("`MetallicRough`, metallic 0, 0.5 and 1", |alpha| {
        all([0.0, 0.5, 1.0]
            .into_iter()
            .map(|metallic| extremes(&MetallicRough::new(Rgb::ONE, metallic, alpha.sqrt()), 1.0, Some(alpha))))
    }),
    ("`Principled`, index 1.33 to 2.4", principled),
    ("`PrincipledThin`", principled_sheet),
    ("`OrenNayar`", |alpha| extremes(&OrenNayar::new(Rgb::ONE, alpha), 1.0, Some(1.0))),
];

fn main() {
    // Without this flag, as in `cargo test --benches`, one column suffices.
    let is_whole = std::env::args().any(|arg| arg == "--bench");
    let alphas = if is_whole { &ALPHAS[..] } else { &ALPHAS[5..6] };
    println!("Light lost and gained by white surfaces in one bsdf, in per cent, at the worst angle and index.");
    println!();
    let cells = |values: Vec<String>| values.join(" | ");
    println!("| α | {} |", cells(alphas.iter().map(|alpha| format!("{alpha}")).collect()));
    println!("|---|{}", "---|".repeat(alphas.len()));
    for (name, row) in ROWS {
        let cell = |&alpha: &f64| {
            let [lost, gained] = row(alpha);
            format!("{:+.2} {:+.2}", 100.0 * lost, 100.0 * gained)
        };
        println!("| {name} | {} |", cells(alphas.iter().map(cell).collect()));
    }
}
