//! Tables written by `entries.rs`: `cargo test write_tables -- --ignored` integrates them anew, which takes two cores
//! some half an hour. With TABLES=coat,coat_average it writes these alone.

use super::cubic::Table;

/// How many entries tables have: by cosine and α, and the average by α.
pub(super) const MIRROR: [usize; 2] = [33, 17];
pub(super) const MIRROR_AVERAGE: [usize; 1] = [33];
/// By cosine, azimuth, one roughness over the other and the greater; the average by the last two.
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

/// All that is tabulated of one distribution of facets.
#[derive(Debug)]
pub struct Tables {
    /// Losses of mirrors, over about what they are.
    pub(super) mirror: Table<2>,
    /// Logarithms of their means over even light, over α².
    pub(super) mirror_average: Table<1>,
    /// Losses of mirrors that are not alike in all directions, over about what they are.
    pub(super) brushed: Table<4>,
    /// Logarithms of their means over even light, over the mean of α².
    pub(super) brushed_average: Table<2>,
    /// Losses of interfaces from the thinner side, over about what they are.
    pub(super) thin: Table<3>,
    /// Losses of interfaces from the denser side, over about what they are.
    pub(super) dense: Table<3>,
    /// Logarithms of means over even light of the losses from the thinner side, over their unit.
    pub(super) thin_average: Table<2>,
    /// The same from the denser side.
    pub(super) dense_average: Table<2>,
    /// Means of Fresnel's reflectance over what coats reflect once, less that of one facet.
    pub(super) coat: Table<3>,
    /// Its mean over even light, less that of Fresnel's.
    pub(super) coat_average: Table<2>,
    /// What is reflected once with Schlick's term, less that term.
    pub(super) schlick: Table<2>,
    /// Its mean over even light.
    pub(super) schlick_average: Table<1>,
}

impl Tables {
    /// Their names and what is in their files.
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

/// The tables in a folder.
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

/// Those of [`crate::Ggx`].
pub(super) static GGX: Tables = tables!("ggx");

/// Those of [`crate::Beckmann`].
pub(super) static BECKMANN: Tables = tables!("beckmann");
