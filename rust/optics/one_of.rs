//! Several kinds of scattering as one type.

/// Makes an enum of kinds that implement [`super::Bsdf`], which implements it too and numbers them. `$inline` is how
/// its functions are to be inlined.
macro_rules! one_of {
    ($(#[$about:meta])* $name:ident, $inline:meta, { $($(#[$doc:meta])* $kind:ident($of:ty),)+ }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        pub enum $name {
            $($(#[$doc])* $kind($of),)+
        }

        impl $name {
            /// How many kinds there are.
            pub const KINDS: usize = [$(stringify!($kind)),+].len();

            /// The number of its kind among them.
            #[inline]
            pub fn kind(&self) -> usize {
                enum Kind {
                    $($kind),+
                }
                match self {
                    $(Self::$kind(_) => Kind::$kind as usize,)+
                }
            }
        }

        $(impl From<$of> for $name {
            fn from(kind: $of) -> Self {
                Self::$kind(kind)
            }
        })+

        impl $crate::optics::Bsdf for $name {
            #[$inline]
            fn evaluate(&self, wo: glam::DVec3, wi: glam::DVec3) -> ($crate::optics::Rgb, f64) {
                match self {
                    $(Self::$kind(kind) => kind.evaluate(wo, wi),)+
                }
            }

            #[$inline]
            fn sample(
                &self,
                wo: glam::DVec3,
                choice: impl FnOnce() -> f64,
                u: [f64; 2],
            ) -> Option<$crate::optics::BsdfSample> {
                match self {
                    $(Self::$kind(kind) => kind.sample(wo, choice, u),)+
                }
            }

            #[$inline]
            fn prepare(&mut self, wo: glam::DVec3) {
                match self {
                    $(Self::$kind(kind) => kind.prepare(wo),)+
                }
            }

            fn albedo(&self) -> $crate::optics::Rgb {
                match self {
                    $(Self::$kind(kind) => kind.albedo(),)+
                }
            }

            #[$inline]
            fn again(&self) -> $crate::optics::Rgb {
                match self {
                    $(Self::$kind(kind) => kind.again(),)+
                }
            }

            #[$inline]
            fn is_delta(&self) -> bool {
                match self {
                    $(Self::$kind(kind) => kind.is_delta(),)+
                }
            }

            #[$inline]
            fn transmits(&self) -> bool {
                match self {
                    $(Self::$kind(kind) => kind.transmits(),)+
                }
            }

            #[$inline]
            fn roughness(&self) -> f64 {
                match self {
                    $(Self::$kind(kind) => kind.roughness(),)+
                }
            }

            #[$inline]
            fn diffuse(&self) -> Option<$crate::optics::Rgb> {
                match self {
                    $(Self::$kind(kind) => kind.diffuse(),)+
                }
            }
        }
    };
}

pub(super) use one_of;
