//! The random numbers of a batch of samples in SoA layout.

use super::bits::number;
use super::sampler_lanes::joined;
use super::{Sampler, SamplerKind, SamplerLanes};
use crate::math::single::lesser;
use crate::math::{LANES, gather};
use crate::simd::{Column, Level, loops, pack};
use std::ops::Range;

/// Samples of one picture, whose numbers are generated sixteen at a time.
#[derive(Clone, Debug)]
pub struct SamplerColumns {
    /// The kind and seed of the numbers.
    all: SamplerLanes,
    pixel: Vec<u32>,
    sample: Vec<u32>,
    /// Of each among the samples of its pixel.
    number: Vec<u32>,
    /// Where each batch's stream starts; nothing where numbers are independent.
    words: Vec<[u32; 4]>,
    len: usize,
}

/// The greatest f32 below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// 32 bits as the midpoint of one of 2²³ equal steps in (0, 1).
#[inline(always)]
fn step(word: u32) -> f32 {
    ((word >> 9) as i32 as f32 + 0.5) * (1.0 / (1u32 << 23) as f32)
}

impl SamplerColumns {
    /// None yet, of the picture that some samples are of.
    pub fn like(samplers: &SamplerLanes) -> Self {
        Self {
            all: samplers.clone(),
            pixel: Vec::new(),
            sample: Vec::new(),
            number: Vec::new(),
            words: Vec::new(),
            len: 0,
        }
    }

    /// With samples of the picture that one is of.
    pub fn new(sampler: &Sampler) -> Self {
        Self::like(&SamplerLanes::new(sampler))
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Replace the samples by others of the same picture.
    pub fn take<'a>(&mut self, samplers: impl Iterator<Item = &'a Sampler>) {
        for column in [&mut self.pixel, &mut self.sample, &mut self.number] {
            column.clear();
        }
        self.words.clear();
        let has_words = self.all.kind != SamplerKind::Independent;
        for sampler in samplers {
            self.pixel.push(sampler.pixel);
            self.sample.push(sampler.sample);
            self.number.push(sampler.number());
            if has_words {
                self.words.push(sampler.words);
            }
        }
        self.len = self.pixel.len();
    }

    /// Takes some of others of the same picture in place of those before.
    pub fn take_from(&mut self, others: &Self, some: Range<usize>) {
        let columns =
            [(&mut self.pixel, &others.pixel), (&mut self.sample, &others.sample), (&mut self.number, &others.number)];
        for (to, from) in columns {
            to.clear();
            to.extend_from_slice(&from[some.clone()]);
        }
        self.words.clear();
        if !others.words.is_empty() {
            self.words.extend_from_slice(&others.words[some.clone()]);
        }
        self.all = others.all.clone();
        self.len = some.len();
    }

    /// Appends another that is equal to number `i`.
    pub fn repeat(&mut self, i: usize) {
        for column in [&mut self.pixel, &mut self.sample, &mut self.number] {
            column.truncate(self.len);
            column.push(column[i]);
        }
        if !self.words.is_empty() {
            self.words.push(self.words[i]);
        }
        self.len += 1;
    }

    /// Appends those of the lanes in a mask; `number` is the number of each among the samples of its pixel.
    pub fn push(&mut self, level: Level, mask: u32, samplers: &SamplerLanes, number: &[u32; LANES]) {
        let (at, room) = (self.len, self.len + LANES);
        for column in [&mut self.pixel, &mut self.sample, &mut self.number] {
            if column.len() < room {
                column.resize(2 * room, 0);
            }
        }
        let columns = [
            Column::new(&samplers.pixel, &mut self.pixel[at..]),
            Column::new(&samplers.sample, &mut self.sample[at..]),
            Column::new(number, &mut self.number[at..]),
        ];
        pack(level, mask, &columns);
        if samplers.kind != SamplerKind::Independent {
            self.words.truncate(at);
            self.words.extend((0..LANES).filter(|lane| mask >> lane & 1 == 1).map(|lane| samplers.words[lane]));
        }
        self.len += (mask & 0xffff).count_ones() as usize;
    }

    /// One of them.
    pub fn get(&self, i: usize) -> Sampler {
        let mut sampler = Sampler::of(self.all.kind, self.all.key, self.pixel[i], self.number[i]);
        sampler.sample = self.sample[i];
        if let Some(&words) = self.words.get(i) {
            sampler.words = words;
        }
        sampler
    }

    /// Gather samples, one per lane.
    #[inline]
    pub fn gather(&self, which: &[u32; LANES], to: &mut SamplerLanes) {
        gather(&self.pixel, which, &mut to.pixel);
        gather(&self.sample, which, &mut to.sample);
        if !self.words.is_empty() {
            gather(&self.words, which, &mut to.words);
        }
    }

    /// Lanes to gather into.
    pub fn lanes(&self) -> SamplerLanes {
        self.all.clone()
    }
}

impl SamplerLanes {
    /// [`SamplerLanes::choices_and_pairs`] for the same dimension in all lanes.
    #[inline]
    pub fn choice_and_pair(&self, level: Level, dimension: u32, one: &mut [f64; LANES], two: &mut [[f32; LANES]; 2]) {
        self.choices_and_pairs(level, &[dimension; LANES], one, two);
    }

    /// The numbers of [`SamplerLanes::one_and_two`] for a dimension of each lane, with the pair in f32.
    #[inline]
    pub fn choices_and_pairs(
        &self,
        level: Level,
        dimensions: &[u32; LANES],
        one: &mut [f64; LANES],
        two: &mut [[f32; LANES]; 2],
    ) {
        if self.kind == SamplerKind::Independent {
            return independent(level, self, dimensions, one, two);
        }
        let mut pair = [[0.0; LANES]; 2];
        self.one_and_two(level, dimensions, one, &mut pair);
        for (to, from) in two.iter_mut().zip(pair) {
            *to = from.map(|x| lesser(x as f32, BELOW_ONE));
        }
    }
}

impl SamplerLanes {
    /// The same with all three numbers in f32.
    #[inline]
    pub fn chance_and_pair(&self, level: Level, dimension: u32, one: &mut [f32; LANES], two: &mut [[f32; LANES]; 2]) {
        if self.kind == SamplerKind::Independent {
            return independent_singles(level, self, dimension, one, two);
        }
        let mut choice = [0.0; LANES];
        self.choice_and_pair(level, dimension, &mut choice, two);
        *one = choice.map(|x| lesser(x as f32, BELOW_ONE));
    }
}

loops! {
    /// Three of the words of a block of independent numbers.
    fn independent_singles(
        lanes: &SamplerLanes,
        dimension: u32,
        one: &mut [f32; LANES],
        two: &mut [[f32; LANES]; 2],
    ) {
        for i in 0..LANES {
            let [_, b, c, d] = lanes.block(i, dimension);
            one[i] = step(b);
            two[0][i] = step(c);
            two[1][i] = step(d);
        }
    }
}

loops! {
    /// Both halves of a block of independent numbers.
    fn independent(
        lanes: &SamplerLanes,
        dimensions: &[u32; LANES],
        one: &mut [f64; LANES],
        two: &mut [[f32; LANES]; 2],
    ) {
        for i in 0..LANES {
            let [a, b, c, d] = lanes.block(i, dimensions[i]);
            one[i] = number(joined(a, b));
            two[0][i] = step(c);
            two[1][i] = step(d);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::BatchSize;
    use super::*;

    #[test]
    fn numbers_are_those_of_samplers_as_f32() {
        let size = BatchSize::new(16).unwrap();
        let kinds = [SamplerKind::Independent, SamplerKind::Stratified(size), SamplerKind::Sobol(size)];
        for kind in kinds {
            let mut samplers: Vec<Sampler> = (0..40).map(|i| kind.sampler(77, 100 * i, 3 * i)).collect();
            let mut columns = SamplerColumns::new(&samplers[0]);
            columns.take(samplers.iter());
            let which = std::array::from_fn(|lane| (lane as u32 * 7) % 40);
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let mut lanes = columns.lanes();
                columns.gather(&which, &mut lanes);
                let (mut one, mut two) = ([0.0; LANES], [[0.0; LANES]; 2]);
                lanes.choice_and_pair(level, 6, &mut one, &mut two);
                for lane in 0..LANES {
                    let sampler = &mut samplers[which[lane] as usize];
                    assert_eq!(one[lane], sampler.one(6), "{kind:?} {level:?}");
                    let [a, b] = sampler.two(7);
                    for (single, double) in [(two[0][lane], a), (two[1][lane], b)] {
                        assert!((f64::from(single) - double).abs() <= 1.2e-7 && single > 0.0 && single < 1.0);
                    }
                }
            }
        }
        assert_eq!((step(0), step(u32::MAX)), (f32::EPSILON / 2.0, BELOW_ONE));
    }
}
