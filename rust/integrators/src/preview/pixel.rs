//! Pixels of previews, from linear values.

use std::sync::OnceLock;

/// A channel of a pixel.
pub trait Pixel: Copy + Send {
    /// What turns linear values into it.
    type Encoder: Copy;

    /// That.
    fn encoder() -> Self::Encoder;

    /// A pixel of a color.
    fn of(color: [f32; 3], encoder: Self::Encoder) -> [Self; 3];
}

impl Pixel for f32 {
    type Encoder = ();

    fn encoder() -> Self::Encoder {}

    #[inline(always)]
    fn of(color: [f32; 3], _: Self::Encoder) -> [Self; 3] {
        color
    }
}

/// By the curve of sRGB (IEC 61966-2-1), rounded to the nearest.
impl Pixel for u8 {
    type Encoder = &'static Encoder;

    fn encoder() -> Self::Encoder {
        static ENCODER: OnceLock<Encoder> = OnceLock::new();
        ENCODER.get_or_init(Encoder::new)
    }

    #[inline(always)]
    fn of([red, green, blue]: [f32; 3], encoder: Self::Encoder) -> [Self; 3] {
        let first = encoder.encode(red);
        // Most of what is seen is gray.
        if red == green && green == blue {
            return [first; 3];
        }
        [first, encoder.encode(green), encoder.encode(blue)]
    }
}

/// From linear values to bytes of sRGB.
#[derive(Debug)]
pub struct Encoder {
    /// The byte of the lower end of each interval of linear values.
    bytes: Vec<u8>,
    /// The least value of each byte; a last one that nothing reaches.
    least: [f32; 257],
}

impl Encoder {
    /// No interval has more than one step: near 0 steps are 1 / (255 · 12.92) apart, more than four intervals.
    const INTERVALS: f32 = 16384.0;

    fn new() -> Self {
        let linear = |s: f64| if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
        let mut least = [f32::INFINITY; 257];
        least[0] = f32::NEG_INFINITY;
        for (byte, least) in least.iter_mut().enumerate().take(256).skip(1) {
            *least = linear((byte as f64 - 0.5) / 255.0) as f32;
        }
        let byte = |value: f32| (least.partition_point(|&least| least <= value) - 1) as u8;
        let bytes = (0..=Self::INTERVALS as usize).map(|i| byte(i as f32 / Self::INTERVALS)).collect();
        Self { bytes, least }
    }

    #[inline(always)]
    fn encode(&self, value: f32) -> u8 {
        // NaN becomes 0.
        let value = value.clamp(0.0, 1.0);
        let byte = self.bytes[(value * Self::INTERVALS) as usize];
        byte + u8::from(value >= self.least[usize::from(byte) + 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_those_of_the_curve() {
        for i in 0..=200_000 {
            let value = i as f32 / 180_000.0 - 0.05;
            let x = f64::from(value).clamp(0.0, 1.0);
            let curve = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
            let [red, _, blue] = u8::of([value, 0.5, value], u8::encoder());
            assert!(red == blue && (f64::from(red) - 255.0 * curve).abs() < 0.501, "{value}");
        }
        assert_eq!(u8::of([f32::NAN, f32::INFINITY, -1.0], u8::encoder()), [0, 255, 0]);
    }
}
