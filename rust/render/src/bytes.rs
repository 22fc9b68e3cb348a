//! Numbers to bytes and back. Bytes may come from anyone: reading them neither panics nor takes memory that they do not
//! fill.

use raywright_optics::Rgb;
use std::fmt;

/// Why bytes are not what they should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Malformed(pub(super) &'static str);

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

impl std::error::Error for Malformed {}

/// Says what is wrong unless it is as it should be.
pub(super) fn check(right: bool, otherwise: &'static str) -> Result<(), Malformed> {
    if right { Ok(()) } else { Err(Malformed(otherwise)) }
}

/// A number that is stored as its bits, the least significant byte first.
pub(super) trait Word: Copy + PartialEq {
    /// Bytes that it takes.
    const SIZE: usize;
    fn put(self, to: &mut Vec<u8>);
    /// From as many bytes as it takes.
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

/// Bytes being written.
#[derive(Default)]
pub(super) struct Writer(pub Vec<u8>);

/// How numbers of one kind are stored: all the same, or one by one.
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

    /// Numbers whose count the reader knows; those that are all the same take the room of one.
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

    /// Colours, channel by channel, as [`Writer::words`].
    pub fn colours<T>(&mut self, of: &[T], colour: impl Fn(&T) -> Rgb) {
        for channel in 0..3 {
            self.words(of.iter().map(|entry| colour(entry)[channel].to_bits()));
        }
    }
}

/// Bytes being read.
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
        check(byte <= 1, "a flag is neither set nor not")?;
        Ok(byte == 1)
    }

    /// So many entries, of which each has room for `bytes` or more: no more than the bytes can hold.
    pub fn length(&mut self, bytes: usize) -> Result<usize, Malformed> {
        let count = self.word::<u32>()? as usize;
        check(count <= self.0.len() / bytes, "they end too early")?;
        Ok(count)
    }

    /// What [`Writer::words`] wrote: as many as `into` has.
    pub fn words<'b, W: Word + 'b>(&mut self, into: impl ExactSizeIterator<Item = &'b mut W>) -> Result<(), Malformed> {
        self.each(into, |entry, word| *entry = word)
    }

    /// What [`Writer::colours`] wrote, into all that is in `into`.
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
            _ => return Err(Malformed("numbers are stored in an unknown way")),
        }
        Ok(())
    }

    /// That nothing is left.
    pub fn end(&self) -> Result<(), Malformed> {
        check(self.0.is_empty(), "they go on after their end")
    }
}
