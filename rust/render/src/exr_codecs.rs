//! Decoders of EXR chunks that work symbol by symbol: differences, run lengths, and PIZ (Huffman codes of a wavelet).
//! The rest is zlib and array arithmetic, in `python/raywright/io/exr/`.
//!
//! After `ImfZip.cpp`, `ImfRle.cpp`, `ImfHuf.cpp`, `ImfWav.cpp` and `ImfPizCompressor.cpp` of OpenEXR. Each function
//! accepts any bytes, and returns their content or an error. It allocates at most a multiple of their number.

/// Number of 16-bit symbols; the code after them repeats the last symbol.
const SYMBOLS: usize = 1 << 16;
/// Codes up to this length are decoded by one table lookup.
const TABLE_BITS: u32 = 14;
const LONGEST_CODE: usize = 58;
/// Code lengths from here on encode runs of unused symbols: the last with 8 bits of length.
const SHORT_RUN: u64 = 59;
const LONG_RUN: u64 = 63;
/// A run takes at least 9 bits and yields at most 255 symbols.
const MOST_SYMBOLS_PER_BIT: usize = 255 / 9 + 1;

/// Sums the differences stored by ZIP and RLE, each with an offset of 128; the even bytes precede the odd ones.
pub fn integrate(data: &[u8]) -> Vec<u8> {
    let mut out = vec![0; data.len()];
    let (even, odd) = data.split_at(data.len().div_ceil(2));
    let mut last = 128_u8;
    for (pair, difference) in out.chunks_mut(2).zip(even) {
        // The highest bit is 128, so the offset is an exclusive or, and only one addition depends on the last byte.
        last = last.wrapping_add(difference ^ 128);
        pair[0] = last;
    }
    for (pair, difference) in out.chunks_exact_mut(2).zip(odd) {
        last = last.wrapping_add(difference ^ 128);
        pair[1] = last;
    }
    out
}

/// Decodes `count` bytes of run lengths: n >= 0 repeats the next byte n + 1 times, n < 0 copies -n bytes.
///
/// # Errors
/// If `data` holds fewer or more than `count` bytes.
pub fn run_lengths(data: &[u8], count: usize) -> Result<Vec<u8>, &'static str> {
    // Two bytes yield at most 128.
    if count > 64 * data.len() {
        return Err("its runs are cut short");
    }
    let mut out = Vec::with_capacity(count);
    let mut rest = data;
    while let [n, tail @ ..] = rest {
        let n = *n as i8;
        let taken = if n < 0 { usize::from(n.unsigned_abs()) } else { 1 };
        let (bytes, tail) = tail.split_at_checked(taken).ok_or("its runs are cut short")?;
        let length = if n < 0 { taken } else { n as usize + 1 };
        if out.len() + length > count {
            return Err("its runs are too long");
        }
        if n < 0 {
            out.extend_from_slice(bytes);
        } else {
            out.resize(out.len() + length, bytes[0]);
        }
        rest = tail;
    }
    if out.len() == count { Ok(out) } else { Err("its runs are cut short") }
}

/// Decodes a PIZ chunk. `channels` are columns, rows and 16-bit words per sample. The result has all samples of the
/// first channel, row by row, then those of the next.
///
/// # Errors
/// If `data` does not hold them.
pub fn piz(data: &[u8], channels: &[(usize, usize, usize)]) -> Result<Vec<u16>, &'static str> {
    let short = "its table of values is cut short";
    let (lowest, tail) = take_u16(data).ok_or(short)?;
    let (highest, tail) = take_u16(tail).ok_or(short)?;
    let mut used = [0; SYMBOLS / 8];
    let mut tail = tail;
    if lowest <= highest {
        let place = used.get_mut(lowest..=highest).ok_or("its table of values is too long")?;
        let (bytes, after) = tail.split_at_checked(place.len()).ok_or(short)?;
        place.copy_from_slice(bytes);
        tail = after;
    }
    // Zero is a value even if its bit is not set.
    used[0] |= 1;
    let mut values: Vec<u16> = (0..=u16::MAX).filter(|&v| used[usize::from(v >> 3)] >> (v & 7) & 1 == 1).collect();
    let is_wide = values.len() > 1 << 14;
    values.resize(SYMBOLS, 0);

    let (length, tail) = take_u32(tail).ok_or("it is cut short")?;
    let packed = tail.get(..length).ok_or("it is cut short")?;
    let size = |&(width, rows, n): &(usize, usize, usize)| width.checked_mul(rows)?.checked_mul(n);
    let count = channels.iter().try_fold(0, |sum: usize, channel| sum.checked_add(size(channel)?));
    let mut out = huffman(packed, count.ok_or("it is too large")?)?;
    if out.is_empty() {
        return Ok(out);
    }
    let mut rest = &mut out[..];
    for &(width, rows, n) in channels {
        let (channel, after) = rest.split_at_mut(width * rows * n);
        // A channel may have no row in a chunk.
        for word in 0..if channel.is_empty() { 0 } else { n } {
            if is_wide {
                inverse_wavelet(&mut channel[word..], (width, rows), n, modular_pair);
            } else {
                inverse_wavelet(&mut channel[word..], (width, rows), n, plain_pair);
            }
        }
        rest = after;
    }
    for value in &mut out {
        *value = values[usize::from(*value)];
    }
    Ok(out)
}

/// Decodes `count` symbols of OpenEXR's canonical Huffman code, which starts with its table of lengths.
///
/// # Errors
/// If `data` does not hold them, or its table is not that of a prefix code.
pub fn huffman(data: &[u8], count: usize) -> Result<Vec<u16>, &'static str> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let short = "its table of codes is cut short";
    let (first, tail) = take_u32(data).ok_or(short)?;
    let (repeat, tail) = take_u32(tail).ok_or(short)?;
    let (_, tail) = take_u32(tail).ok_or(short)?;
    let (bits, tail) = take_u32(tail).ok_or(short)?;
    let (_, tail) = take_u32(tail).ok_or(short)?;
    if first > repeat || repeat > SYMBOLS {
        return Err("its table of codes is broken");
    }
    let (lengths, used) = code_lengths(tail, repeat + 1 - first)?;
    let packed = &tail[used..];
    if bits > 8 * packed.len() {
        return Err("it is cut short");
    }
    if count > bits * MOST_SYMBOLS_PER_BIT {
        return Err("it has too few symbols");
    }
    let codes = Codes::new(&lengths, first)?;
    let mut reader = Bits::new(packed);
    let mut out: Vec<u16> = Vec::with_capacity(count);
    while out.len() < count {
        let (symbol, length) = codes.decode(reader.peek()).ok_or("it has no such code")?;
        reader.at += length;
        if symbol == repeat {
            let run = reader.take(8) as usize;
            let last = *out.last().ok_or("it repeats nothing")?;
            if out.len() + run > count {
                return Err("it has too many symbols");
            }
            out.resize(out.len() + run, last);
        } else {
            out.push(symbol as u16);
        }
        if reader.at > bits {
            return Err("it has too few symbols");
        }
    }
    Ok(out)
}

/// Lengths of `count` codes, and their size in bytes.
fn code_lengths(data: &[u8], count: usize) -> Result<(Vec<u8>, usize), &'static str> {
    let mut reader = Bits::new(data);
    let mut lengths = Vec::with_capacity(count);
    while lengths.len() < count {
        let run = match reader.take(6) {
            LONG_RUN => reader.take(8) as usize + (LONG_RUN - SHORT_RUN + 2) as usize,
            n @ SHORT_RUN.. => (n - SHORT_RUN + 2) as usize,
            n => {
                lengths.push(n as u8);
                0
            }
        };
        lengths.resize(lengths.len() + run, 0);
        if lengths.len() > count || reader.at > 8 * data.len() {
            return Err("its table of codes is broken");
        }
    }
    Ok((lengths, reader.at.div_ceil(8)))
}

/// A canonical code: codes of equal length are consecutive numbers in the order of their symbols, and longer codes
/// precede shorter ones.
struct Codes {
    /// Symbol and code length, indexed by the next `TABLE_BITS` bits; length 0 for longer codes.
    table: Vec<(u32, u8)>,
    /// For each length, the first code, and the position of its symbol in `symbols`.
    starts: [(u64, usize); LONGEST_CODE + 2],
    /// Symbols by length, the longest codes first.
    symbols: Vec<u32>,
}

impl Codes {
    fn new(lengths: &[u8], first_symbol: usize) -> Result<Self, &'static str> {
        let mut counts = [0; LONGEST_CODE + 2];
        for &length in lengths {
            counts[usize::from(length)] += 1;
        }
        let mut starts = [(0, 0); LONGEST_CODE + 2];
        let (mut code, mut place) = (0_u64, 0);
        for length in (1..=LONGEST_CODE).rev() {
            starts[length] = (code, place);
            place += counts[length];
            code += counts[length] as u64;
            if code > 1 << length {
                return Err("its table of codes is broken");
            }
            // A shorter code begins after the longer ones with its prefix.
            code >>= 1;
        }
        let mut table = vec![(0, 0); 1 << TABLE_BITS];
        let mut symbols = vec![0; place];
        let mut next = starts;
        for (symbol, &length) in (first_symbol as u32..).zip(lengths).filter(|(_, length)| **length > 0) {
            let (code, place) = &mut next[usize::from(length)];
            symbols[*place] = symbol;
            if u32::from(length) <= TABLE_BITS {
                let spare = TABLE_BITS - u32::from(length);
                let from = (*code as usize) << spare;
                table[from..from + (1 << spare)].fill((symbol, length));
            }
            *code += 1;
            *place += 1;
        }
        Ok(Self { table, starts, symbols })
    }

    /// Symbol of the code in the highest bits, and its length.
    fn decode(&self, bits: u64) -> Option<(usize, usize)> {
        let (symbol, length) = self.table[(bits >> (64 - TABLE_BITS)) as usize];
        if length > 0 {
            return Some((symbol as usize, usize::from(length)));
        }
        (TABLE_BITS as usize + 1..=LONGEST_CODE).find_map(|length| {
            let (first, place) = self.starts[length];
            // Symbols of shorter codes follow.
            let end = self.starts[length - 1].1;
            let within = (bits >> (64 - length)).checked_sub(first)?;
            let at = place + usize::try_from(within).ok()?;
            (at < end).then(|| (self.symbols[at] as usize, length))
        })
    }
}

/// A bit reader, most significant bit first; zeros follow the end.
struct Bits<'a> {
    data: &'a [u8],
    at: usize,
}

impl<'a> Bits<'a> {
    fn new(data: &'a [u8]) -> Self {
        Self { data, at: 0 }
    }

    /// The next 64 bits.
    fn peek(&self) -> u64 {
        let from = (self.at / 8).min(self.data.len());
        let bytes = match self.data[from..].first_chunk() {
            Some(bytes) => *bytes,
            None => {
                let mut bytes = [0; 9];
                let rest = &self.data[from..];
                bytes[..rest.len()].copy_from_slice(rest);
                bytes
            }
        };
        let [high @ .., last] = bytes;
        let shift = self.at % 8;
        u64::from_be_bytes(high) << shift | u64::from(last) >> (8 - shift)
    }

    fn take(&mut self, count: usize) -> u64 {
        let bits = self.peek() >> (64 - count);
        self.at += count;
        bits
    }
}

fn take_u16(data: &[u8]) -> Option<(usize, &[u8])> {
    let (bytes, rest) = data.split_first_chunk()?;
    Some((usize::from(u16::from_le_bytes(*bytes)), rest))
}

fn take_u32(data: &[u8]) -> Option<(usize, &[u8])> {
    let (bytes, rest) = data.split_first_chunk()?;
    Some((u32::from_le_bytes(*bytes) as usize, rest))
}

/// Inverts the two-dimensional wavelet transform of `size` samples at distance `stride`, from the coarsest level to the
/// finest.
fn inverse_wavelet(data: &mut [u16], size: (usize, usize), stride: usize, pair: impl Fn(u16, u16) -> (u16, u16)) {
    let (width, rows) = size;
    let row = width * stride;
    let mut step = 1;
    while 2 * step <= width.min(rows) {
        step *= 2;
    }
    while step > 1 {
        let half = step / 2;
        let (right, down) = (stride * half, row * half);
        let whole = width / step * step;
        for y in (0..rows / step * step).step_by(step) {
            let start = y * row;
            for x in (0..whole).step_by(step) {
                let at = start + x * stride;
                let (a, c) = pair(data[at], data[at + down]);
                let (b, d) = pair(data[at + right], data[at + down + right]);
                (data[at], data[at + right]) = pair(a, b);
                (data[at + down], data[at + down + right]) = pair(c, d);
            }
            if width & half != 0 {
                let at = start + whole * stride;
                (data[at], data[at + down]) = pair(data[at], data[at + down]);
            }
        }
        if rows & half != 0 {
            let start = rows / step * step * row;
            for x in (0..whole).step_by(step) {
                let at = start + x * stride;
                (data[at], data[at + right]) = pair(data[at], data[at + right]);
            }
        }
        step = half;
    }
}

/// Two samples from their mean and difference, if no sample has more than 14 bits.
fn plain_pair(mean: u16, difference: u16) -> (u16, u16) {
    let difference = difference as i16;
    let first = (mean as i16).wrapping_add(difference & 1).wrapping_add(difference >> 1);
    (first as u16, first.wrapping_sub(difference) as u16)
}

/// Two samples from their mean and difference modulo 2^16.
fn modular_pair(mean: u16, difference: u16) -> (u16, u16) {
    let second = mean.wrapping_sub(difference >> 1);
    (difference.wrapping_add(second).wrapping_sub(1 << 15), second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_summed_and_bytes_interleaved() {
        // 10 20 30 and 11 21 in that order.
        assert_eq!(integrate(&[10, 138, 138, 109, 138]), [10, 11, 20, 21, 30]);
        assert!(integrate(&[]).is_empty());
    }

    #[test]
    fn runs_are_decoded_and_their_count_is_checked() {
        let data = [2, 7, 0xfe, 1, 2, 0, 9];
        assert_eq!(run_lengths(&data, 6).unwrap(), [7, 7, 7, 1, 2, 9]);
        for (data, count) in [(&data[..], 5), (&data[..], 7), (&data[..4], 5), (&data[..], usize::MAX)] {
            assert!(run_lengths(data, count).is_err());
        }
    }

    /// Symbols 0 (code 1), 1 (code 00) and 2 (code 01); the last is the repeat code.
    fn three_symbols(bits: u32, packed: &[u8]) -> Vec<u8> {
        let mut data: Vec<u8> = [0, 2, 0, bits, 0].iter().flat_map(|n: &u32| n.to_le_bytes()).collect();
        // 000001 000010 000010, in three bytes.
        data.extend([0b0000_0100, 0b0010_0000, 0b1000_0000]);
        data.extend(packed);
        data
    }

    #[test]
    fn symbols_and_runs_are_decoded() {
        // 1, 00, 01 00000011, 1: 0, 1, three repetitions, 0.
        let data = three_symbols(14, &[0b1000_1000, 0b0001_1100]);
        assert_eq!(huffman(&data, 6).unwrap(), [0, 1, 1, 1, 1, 0]);
        assert!(huffman(&data, 7).is_err());
        assert!(huffman(&data, 4).is_err());
        assert!(huffman(&data[..22], 6).is_err());
        // There is nothing to repeat before the first symbol.
        assert!(huffman(&three_symbols(10, &[0b0100_0000, 0b1100_0000]), 3).is_err());
    }

    #[test]
    fn a_wavelet_of_means_is_flat_and_both_pairs_are_inverses() {
        let mut data = vec![0; 7 * 5];
        data[0] = 1000;
        inverse_wavelet(&mut data, (7, 5), 1, plain_pair);
        assert!(data[..4].iter().all(|&v| v == 1000));
        for (a, b) in [(0_u16, 1_u16), (5, 3), (16383, 0), (0, 16383)] {
            let (mean, difference) = (((i32::from(a) + i32::from(b)) >> 1) as u16, a.wrapping_sub(b));
            assert_eq!(plain_pair(mean, difference), (a, b));
        }
        for (a, b) in [(0_u16, 65535_u16), (65535, 0), (40000, 3), (7, 7)] {
            // `wenc16` of OpenEXR.
            let shifted = i32::from(a.wrapping_add(1 << 15));
            let difference = shifted - i32::from(b);
            let mean = (shifted + i32::from(b)) >> 1;
            let mean = if difference < 0 { (mean + (1 << 15)) & 0xffff } else { mean };
            assert_eq!(modular_pair(mean as u16, difference as u16), (a, b));
        }
    }

    #[test]
    fn any_bytes_are_decoded_or_refused() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as u32
        };
        for _ in 0..2000 {
            let mut data = three_symbols(next() % 200, &[]);
            data.extend((0..next() % 60).map(|_| next() as u8));
            for _ in 0..next() % 4 {
                let at = next() as usize % data.len();
                data[at] = next() as u8;
            }
            let count = next() as usize % 300;
            assert!(huffman(&data, count).is_ok_and(|found| found.len() == count) || huffman(&data, count).is_err());
            let mut chunk = vec![1, 0, 1, 0, 255];
            chunk.extend((data.len() as u32).to_le_bytes());
            chunk.extend(&data);
            let (width, rows) = (next() as usize % 9, next() as usize % 9);
            assert!(
                piz(&chunk, &[(width, rows, 1), (width, rows, 2)])
                    .map_or(true, |found| found.len() == 3 * width * rows)
            );
            assert!(run_lengths(&data, count).map_or(true, |found| found.len() == count));
        }
    }
}
