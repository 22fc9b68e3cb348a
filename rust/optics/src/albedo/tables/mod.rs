//! Tables written by `entries.rs`. `cargo test write_tables -- --ignored` integrates them anew, which takes about half
//! an hour on two cores. TABLES=coat,coat_average writes only these.

use super::cubic::Table;

/// Table sizes: by cosine and α, and the average by α.
pub(super) const MIRROR: [usize; 2] = [33, 17];
pub(super) const MIRROR_AVERAGE: [usize; 1] = [33];
/// By cosine, azimuth, ratio of roughnesses and the greater roughness; the average by the last two.
pub(super) const BRUSHED: [usize; 4] = [27, 11, 13, 13];
pub(super) const BRUSHED_AVERAGE: [usize; 2] = [25, 25];
/// By α, cosine and index, and the averages by α and index.
pub(super) const THIN: [usize; 3] = [17, 33, 25];
pub(super) const DENSE: [usize; 3] = [17, 49, 25];
pub(super) const INTERFACE_AVERAGE: [usize; 2] = [33, 97];
pub(super) const COAT: [usize; 3] = [21, 33, 25];
pub(super) const COAT_AVERAGE: [usize; 2] = [33, 33];
/// By cosine and α, and the average by α.
pub(super) const SCHLICK: [usize; 2] = [33, 17];
pub(super) const SCHLICK_AVERAGE: [usize; 1] = [33];

/// All tables of one facet distribution.
#[derive(Debug)]
pub struct Tables {
    /// Losses of perfectly reflecting facets, over an approximation.
    pub(super) mirror: Table<2>,
    /// Logarithms of their cosine-weighted averages, over α².
    pub(super) mirror_average: Table<1>,
    /// Losses of anisotropic, perfectly reflecting facets, over an approximation.
    pub(super) brushed: Table<4>,
    /// Logarithms of their cosine-weighted averages, over the mean of α².
    pub(super) brushed_average: Table<2>,
    /// Losses of interfaces from the thinner side, over an approximation.
    pub(super) thin: Table<3>,
    /// Losses of interfaces from the denser side, over an approximation.
    pub(super) dense: Table<3>,
    /// Logarithms of cosine-weighted averages of the losses from the thinner side, over their unit.
    pub(super) thin_average: Table<2>,
    /// The same from the denser side.
    pub(super) dense_average: Table<2>,
    /// Albedo of coats with single scattering, minus the reflectance of one facet.
    pub(super) coat: Table<3>,
    /// Its cosine-weighted average, minus that of Fresnel's reflectance.
    pub(super) coat_average: Table<2>,
    /// Albedo with Schlick's weight, minus that weight.
    pub(super) schlick: Table<2>,
    /// Its cosine-weighted average.
    pub(super) schlick_average: Table<1>,
}

impl Tables {
    /// Names and contents of the files.
    #[cfg(test)]
    pub(super) fn files(&self) -> [(&'static str, &'static [u8]); 12] {
        [
            ("mirror", self.mirror.bytes),
            ("mirror_average", self.mirror_average.bytes),
            ("brushed", self.brushed.bytes),
            ("brushed_average", self.brushed_average.bytes),
            ("thin", self.thin.bytes),
            ("dense", self.dense.bytes),
            ("thin_average", self.thin_average.bytes),
            ("dense_average", self.dense_average.bytes),
            ("coat", self.coat.bytes),
            ("coat_average", self.coat_average.bytes),
            ("schlick", self.schlick.bytes),
            ("schlick_average", self.schlick_average.bytes),
        ]
    }
}

/// Loads the tables of a folder.
macro_rules! tables {
    ($folder:literal) => {
        tables! {
            $folder,
            mirror: MIRROR, [0.0, 1.5];
            mirror_average: MIRROR_AVERAGE, [-4.0, 4.0];
            brushed: BRUSHED, [0.0, 3.0];
            brushed_average: BRUSHED_AVERAGE, [-4.0, 4.0];
            thin: THIN, [0.0, 1.0];
            dense: DENSE, [0.0, 2.0];
            thin_average: INTERFACE_AVERAGE, [-8.0, 4.0];
            dense_average: INTERFACE_AVERAGE, [-8.0, 4.0];
            coat: COAT, [-0.5, 0.5];
            coat_average: COAT_AVERAGE, [-0.5, 0.5];
            schlick: SCHLICK, [-0.5, 0.5];
            schlick_average: SCHLICK_AVERAGE, [0.0, 0.1];
        }
    };
    ($folder:literal, $($name:ident: $sizes:expr, $range:expr;)+) => {
        Tables {
            $($name: Table {
                bytes: include_bytes!(concat!($folder, "/", stringify!($name), ".bin")),
                sizes: $sizes,
                range: $range,
            },)+
        }
    };
}

/// Tables of [`crate::Ggx`].
pub(super) static GGX: Tables = tables!("ggx");

/// Tables of [`crate::Beckmann`].
pub(super) static BECKMANN: Tables = tables!("beckmann");
