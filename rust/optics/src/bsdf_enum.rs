//! A macro for enums of BSDF kinds.

use raywright_base::math::LANES;

/// Lanes with a set flag, by kind.
pub(super) struct ByKind<'a> {
    kinds: &'a [u8; LANES],
    asks: &'a [bool; LANES],
    /// Bit mask of the kinds among them.
    present: u64,
}

impl<'a> ByKind<'a> {
    /// Groups the flagged lanes by kind.
    #[inline]
    pub fn new(kinds: &'a [u8; LANES], asks: &'a [bool; LANES]) -> Self {
        let kind = |lane: usize| if asks[lane] { 1u64 << (kinds[lane] & 63) } else { 0 };
        Self { kinds, asks, present: (0..LANES).fold(0, |all, lane| all | kind(lane)) }
    }

    /// Returns whether all flagged lanes are of one kind.
    #[inline]
    pub fn is_one(&self) -> bool {
        self.present.is_power_of_two()
    }

    /// The flagged lanes of a kind; `None` if there are none.
    #[inline]
    pub fn asks(&self, kind: u8) -> Option<[bool; LANES]> {
        let asks = |lane: usize| self.asks[lane] && self.kinds[lane] == kind;
        (self.present >> kind & 1 == 1).then(|| std::array::from_fn(asks))
    }
}

/// Defines an enum of kinds that implement [`super::Bsdf`], which implements it too and numbers them, and its
/// structure-of-arrays form. `$inline` is the inline attribute of its functions.
macro_rules! one_of {
    (
        $(#[$about:meta])* $name:ident, $inline:meta, $(#[$about_columns:meta])* $columns:ident,
        { $($(#[$doc:meta])* $kind:ident($of:ty),)+ }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        pub enum $name {
            $($(#[$doc])* $kind($of),)+
        }

        impl $name {
            /// Number of kinds.
            pub const VARIANTS: usize = [$(stringify!($kind)),+].len();

            /// Index of its kind.
            #[inline]
            pub fn variant(&self) -> usize {
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

        impl crate::Bsdf for $name {
            #[$inline]
            fn evaluate(&self, wo: glam::DVec3, wi: glam::DVec3) -> (crate::Rgb, f64) {
                match self {
                    $(Self::$kind(kind) => kind.evaluate(wo, wi),)+
                }
            }

            #[$inline]
            fn sample(
                &self,
                wo: glam::DVec3,
                choice: &mut dyn FnMut() -> f64,
                u: [f64; 2],
            ) -> Option<crate::BsdfSample> {
                match self {
                    $(Self::$kind(kind) => kind.sample(wo, choice, u),)+
                }
            }

            fn albedo(&self) -> crate::Rgb {
                match self {
                    $(Self::$kind(kind) => kind.albedo(),)+
                }
            }

            #[$inline]
            fn repeat_correction(&self) -> crate::Rgb {
                match self {
                    $(Self::$kind(kind) => kind.repeat_correction(),)+
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
            fn diffuse(&self) -> Option<crate::Rgb> {
                match self {
                    $(Self::$kind(kind) => kind.diffuse(),)+
                }
            }
        }

        $(#[$about_columns])*
        #[derive(Clone, Debug)]
        #[allow(non_snake_case, reason = "a field for each kind has its name")]
        pub struct $columns {
            /// Kind of each lane, initially none.
            kinds: [u8; raywright_base::math::LANES],
            $($kind: <$of as crate::bsdf_columns::LaneBsdf>::Lanes,)+
        }

        impl crate::bsdf_columns::LaneBsdf for $name {
            type Lanes = $columns;
        }

        impl crate::bsdf_columns::BsdfColumns<$name> for $columns {
            const NONE: Self = Self {
                kinds: [u8::MAX; raywright_base::math::LANES],
                $($kind: <<$of as crate::bsdf_columns::LaneBsdf>::Lanes
                    as crate::bsdf_columns::BsdfColumns<$of>>::NONE,)+
            };

            #[$inline]
            fn set(&mut self, lane: usize, of: &$name, wo: glam::DVec3) {
                self.kinds[lane] = of.variant() as u8;
                match of {
                    $($name::$kind(of) => self.$kind.set(lane, of, wo),)+
                }
            }

            #[$inline]
            fn evaluate<'a>(
                &self,
                level: raywright_base::simd::Level,
                each: impl Fn(usize) -> Option<&'a $name> + Copy,
                asks: &[bool; raywright_base::math::LANES],
                directions: [&raywright_base::math::VectorLanes; 2],
                value: &mut crate::RgbLanes,
                pdf: &mut [f64; raywright_base::math::LANES],
            ) {
                let by_kind = crate::bsdf_enum::ByKind::new(&self.kinds, asks);
                if !by_kind.is_one() {
                    (*value, *pdf) = (crate::RgbLanes::ZERO, [0.0; raywright_base::math::LANES]);
                }
                let mut kind = 0;
                $(
                    if let Some(mine) = by_kind.asks(kind) {
                        let each = |lane| match each(lane) {
                            Some($name::$kind(of)) => Some(of),
                            _ => None,
                        };
                        if by_kind.is_one() {
                            return self.$kind.evaluate(level, each, &mine, directions, value, pdf);
                        }
                        let (mut some, mut density) = (value.clone(), *pdf);
                        self.$kind.evaluate(level, each, &mine, directions, &mut some, &mut density);
                        for lane in (0..raywright_base::math::LANES).filter(|&lane| mine[lane]) {
                            value.set(lane, some.get(lane));
                            pdf[lane] = density[lane];
                        }
                    }
                    kind += 1;
                )+
                let _ = kind;
            }

            #[$inline]
            fn sample<'a>(
                &self,
                level: raywright_base::simd::Level,
                each: impl Fn(usize) -> Option<&'a $name> + Copy,
                asks: &[bool; raywright_base::math::LANES],
                wo: &raywright_base::math::VectorLanes,
                numbers: (&[f64; raywright_base::math::LANES], &raywright_base::sampling::Pairs),
                drawn: &mut crate::BsdfSampleLanes,
            ) {
                let by_kind = crate::bsdf_enum::ByKind::new(&self.kinds, asks);
                if !by_kind.is_one() {
                    drawn.pdf = [0.0; raywright_base::math::LANES];
                }
                let mut kind = 0;
                $(
                    if let Some(mine) = by_kind.asks(kind) {
                        let each = |lane| match each(lane) {
                            Some($name::$kind(of)) => Some(of),
                            _ => None,
                        };
                        if by_kind.is_one() {
                            return self.$kind.sample(level, each, &mine, wo, numbers, drawn);
                        }
                        let mut some = crate::BsdfSampleLanes::NONE;
                        self.$kind.sample(level, each, &mine, wo, numbers, &mut some);
                        drawn.take(&mine, &some);
                    }
                    kind += 1;
                )+
                let _ = kind;
            }
        }
    };
}

pub(super) use one_of;
