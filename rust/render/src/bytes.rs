//! Serialization of numbers. Input bytes are untrusted: reading never panics and allocates no more than they fill.

use raywright_optics::Rgb;
use std::fmt;

/// The reason why bytes are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Malformed(pub(super) &'static str);

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

impl std::error::Error for Malformed {}

/// Returns an error with this message unless the condition holds.
pub(super) fn check(right: bool, otherwise: &'static str) -> Result<(), Malformed> {
    if right { Ok(()) } else { Err(Malformed(otherwise)) }
}

/// A number stored as its bits, in little-endian order.
pub(super) trait Word: Copy + PartialEq {
    /// Size in bytes.
    const SIZE: usize;
    fn put(self, to: &mut Vec<u8>);
    /// Converts from its bytes.
    fn get(from: &[u8]) -> Self;
}

macro_rules! words {
    ($($kind:ty),*) => {$(
        impl Word for $kind {
            const SIZE: usize = size_of::<$kind>();
            fn put(self, to: &mut Vec<u8>) {
                to.extend_from_slice(&self.to_le_bytes());
            }
            fn get(from: &[u8]) -> Self {
                let mut bytes = [0; Self::SIZE];
                bytes.copy_from_slice(from);
                Self::from_le_bytes(bytes)
            }
        }
    )*};
}

words!(u32, u64);

/// A byte buffer for writing.
#[derive(Default)]
pub(super) struct Writer(pub Vec<u8>);

/// Storage of a sequence: one value for all, or each value.
const SAME: u8 = 0;
const EACH: u8 = 1;

impl Writer {
    pub fn byte(&mut self, value: u8) {
        self.0.push(value);
    }

    pub fn word<W: Word>(&mut self, value: W) {
        value.put(&mut self.0);
    }

    pub fn float(&mut self, value: f64) {
        self.word(value.to_bits());
    }

    /// Writes numbers whose count the reader knows; equal numbers are stored once.
    pub fn words<W: Word>(&mut self, values: impl Iterator<Item = W> + Clone) {
        let mut rest = values.clone();
        let Some(first) = rest.next() else { return };
        if rest.all(|value| value == first) {
            self.byte(SAME);
            self.word(first);
        } else {
            self.byte(EACH);
            self.0.reserve(W::SIZE * values.size_hint().0);
            values.for_each(|value| self.word(value));
        }
    }

    /// Writes colors, channel by channel, like [`Writer::words`].
    pub fn colours<T>(&mut self, of: &[T], colour: impl Fn(&T) -> Rgb) {
        for channel in 0..3 {
            self.words(of.iter().map(|entry| colour(entry)[channel].to_bits()));
        }
    }
}

/// Bytes to be read.
pub(super) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Malformed> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Malformed("they end too early"))?;
        self.0 = rest;
        Ok(taken)
    }

    pub fn byte(&mut self) -> Result<u8, Malformed> {
        Ok(self.take(1)?[0])
    }

    pub fn word<W: Word>(&mut self) -> Result<W, Malformed> {
        Ok(W::get(self.take(W::SIZE)?))
    }

    pub fn float(&mut self) -> Result<f64, Malformed> {
        Ok(f64::from_bits(self.word()?))
    }

    pub fn flag(&mut self) -> Result<bool, Malformed> {
        let byte = self.byte()?;
        check(byte <= 1, "a flag is neither 0 nor 1")?;
        Ok(byte == 1)
    }

    /// Reads a number of entries of at least `bytes` each; bounded by the remaining bytes.
    pub fn length(&mut self, bytes: usize) -> Result<usize, Malformed> {
        let count = self.word::<u32>()? as usize;
        check(count <= self.0.len() / bytes, "they end too early")?;
        Ok(count)
    }

    /// Reads numbers written by [`Writer::words`], as many as `into` has.
    pub fn words<'b, W: Word + 'b>(&mut self, into: impl ExactSizeIterator<Item = &'b mut W>) -> Result<(), Malformed> {
        self.each(into, |entry, word| *entry = word)
    }

    /// Reads colors written by [`Writer::colours`] into all of `into`.
    pub fn colours<T>(&mut self, into: &mut [T], colour: impl Fn(&mut T) -> &mut Rgb) -> Result<(), Malformed> {
        for channel in 0..3 {
            self.each(into.iter_mut(), |entry, bits: u64| colour(entry)[channel] = f64::from_bits(bits))?;
        }
        Ok(())
    }

    fn each<T, W: Word>(
        &mut self,
        into: impl ExactSizeIterator<Item = T>,
        mut set: impl FnMut(T, W),
    ) -> Result<(), Malformed> {
        let count = into.len();
        if count == 0 {
            return Ok(());
        }
        match self.byte()? {
            SAME => {
                let value = self.word()?;
                into.for_each(|entry| set(entry, value));
            }
            EACH => {
                let bytes = self.take(count.checked_mul(W::SIZE).ok_or(Malformed("they end too early"))?)?;
                into.zip(bytes.chunks_exact(W::SIZE)).for_each(|(entry, word)| set(entry, W::get(word)));
            }
            _ => return Err(Malformed("numbers have an unknown encoding")),
        }
        Ok(())
    }

    /// Checks that nothing is left.
    pub fn end(&self) -> Result<(), Malformed> {
        check(self.0.is_empty(), "they have extra bytes at the end")
    }
}
