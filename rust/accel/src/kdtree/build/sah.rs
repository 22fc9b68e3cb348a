//! The surface area heuristic in n log n: part ends are sorted once and stay sorted when distributed (Wald and Havran,
//! "On Building Fast kd-Trees for Ray Tracing, and on Doing That in O(N log N)", 2006).

use super::super::area;
use super::{Grown, Node, Options, PARALLEL, is_stopped, told};
use crate::walk::{BuildBudget, Input, PartPosition, PrimitivePart, SplitPlane};
use raywright_base::math::Aabb;
use raywright_base::parallel::{self, CHUNK};
use raywright_base::work::Steps;
use std::ops::Range;

/// An end of a part along an axis. Its bits, in order of significance: the position; whether the part ends there, is
/// flat there, or starts there; and the part's index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Event(u64);

const END: u64 = 0;
const FLAT: u64 = 1;
const START: u64 = 2;

impl Event {
    /// Limit of part indices.
    const MOST: usize = 1 << 30;

    fn new(at: f32, kind: u64, part: usize) -> Self {
        // Maps bits to the order of the numbers; adding 0 turns −0 into +0.
        let bits = (at + 0.0).to_bits();
        let ordered = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
        Self(u64::from(ordered) << 32 | kind << 30 | part as u64)
    }

    /// The events of a part in order; the second is None for a flat part.
    fn of(part: &PrimitivePart, number: usize, axis: usize) -> [Option<Self>; 2] {
        let (least, greatest) = (part.aabb.min[axis], part.aabb.max[axis]);
        if least == greatest {
            [Some(Self::new(least, FLAT, number)), None]
        } else {
            [Some(Self::new(least, START, number)), Some(Self::new(greatest, END, number))]
        }
    }

    fn place(self) -> u32 {
        (self.0 >> 32) as u32
    }

    fn at(self) -> f32 {
        let ordered = self.place();
        f32::from_bits(if ordered >> 31 == 1 { ordered & !(1 << 31) } else { !ordered })
    }

    fn kind(self) -> u64 {
        self.0 >> 30 & 3
    }

    fn part(self) -> usize {
        self.0 as usize & (Self::MOST - 1)
    }

    /// The same event for another part index.
    fn renumbered(self, part: u32) -> Self {
        Self(self.0 & !(Self::MOST as u64 - 1) | u64::from(part))
    }
}

/// A plane and the side for parts in the plane.
#[derive(Clone, Copy, Debug)]
struct SahSplit {
    cost: f64,
    plane: SplitPlane,
    flat: usize,
}

/// The content of a cell.
struct Set {
    parts: Vec<PrimitivePart>,
    /// Sorted events by axis.
    events: [Vec<Event>; 3],
    cell: Aabb,
    room: BuildBudget,
}

/// Marks parts that are not on a side, or that are cut.
const GONE: u32 = u32::MAX;

/// Build the subtree of a cell; return its node.
pub fn grow(
    input: &Input,
    options: &Options,
    parts: Vec<PrimitivePart>,
    cell: Aabb,
    room: BuildBudget,
    grown: &mut Grown,
) -> Node {
    let sorted = |axis: usize| {
        let ends = |i: usize| Event::of(&parts[i], i, axis).into_iter().flatten().map(|event| event.0);
        let ends = |range: Range<usize>| range.flat_map(ends).collect::<Vec<_>>();
        let mut events = parallel::map_chunks(parts.len(), CHUNK, ends).concat();
        parallel::sort(&mut events);
        events.into_iter().map(Event).collect()
    };
    let [sort, grow] = input.work.parts([1.0, 10.0]);
    let (steps, mut events) = (sort.steps(3), [const { Vec::new() }; 3]);
    for (axis, events) in events.iter_mut().enumerate() {
        *events = sorted(axis);
        if steps.did(1).is_err() {
            return Node::EMPTY;
        }
    }
    SahBuilder { input, options, steps: &grow.steps(BuildBudget::STEPS) }.grow(Set { parts, events, cell, room }, grown)
}

#[derive(Clone, Copy)]
struct SahBuilder<'a> {
    input: &'a Input<'a>,
    options: &'a Options,
    steps: &'a Steps<'a>,
}

impl SahBuilder<'_> {
    fn grow(self, set: Set, grown: &mut Grown) -> Node {
        let count = set.parts.len();
        if is_stopped(self.steps, count) {
            return Node::EMPTY;
        }
        if count <= self.options.leaf_size || set.room.depth == 0 || count >= Event::MOST {
            return grown.leaf(&set.parts);
        }
        let split = self.best(&set).filter(|s| s.cost < f64::from(self.options.intersection_cost) * count as f64);
        let Some(split) = split else { return grown.leaf(&set.parts) };
        let Some([below, above]) = self.parted(&set, split) else { return grown.leaf(&set.parts) };
        drop(set);
        let many = count > PARALLEL;
        let child = |set: Set, grown: &mut Grown| {
            let (count, room) = (set.parts.len(), set.room);
            let node = self.grow(set, grown);
            told(self.steps, count, room, many);
            node
        };
        let pair = grown.pair(many, |grown| child(below, grown), |grown| child(above, grown));
        Node::inner(split.plane.axis, split.plane.at, pair)
    }

    /// The plane of least cost; the first of several.
    fn best(self, set: &Set) -> Option<SahSplit> {
        let splits = on_axes(set.parts.len() > PARALLEL, |axis| self.best_across(set, axis));
        splits.into_iter().flatten().reduce(|best, split| if split.cost < best.cost { split } else { best })
    }

    /// The same along one axis: a sweep over the events counts the parts on either side.
    fn best_across(self, set: &Set, axis: usize) -> Option<SahSplit> {
        let cell = &set.cell;
        let size = cell.max.as_dvec3() - cell.min.as_dvec3();
        let (wide, other) = (size[axis], [size[(axis + 1) % 3], size[(axis + 2) % 3]]);
        let whole = area(cell);
        if whole <= 0.0 || wide <= 0.0 {
            return None;
        }
        // A side's fraction of the cell's surface area, given its fraction of the width.
        let (ends, walls) = (other[0] * other[1] / whole, (other[0] + other[1]) / whole);
        let Options { traversal_cost, intersection_cost, empty_bonus, .. } = *self.options;
        let (traversal, intersection) = (f64::from(traversal_cost), f64::from(intersection_cost));
        let bonus = 1.0 - f64::from(empty_bonus);
        // Counting SIMD blocks of leaves instead of primitives made no measurable difference.
        let cost = |areas: [f64; 2], below: usize, above: usize| {
            let cost = traversal + intersection * (areas[0] * below as f64 + areas[1] * above as f64);
            if below == 0 || above == 0 { bonus * cost } else { cost }
        };
        let mut best: Option<SahSplit> = None;
        let (mut below, mut above) = (0, set.parts.len());
        let mut rest = set.events[axis].as_slice();
        while let Some(&first) = rest.first() {
            let mut kinds = [0; 3];
            let mut here = 0;
            while let Some(event) = rest.get(here).filter(|e| e.place() == first.place()) {
                kinds[event.kind() as usize] += 1;
                here += 1;
            }
            rest = &rest[here..];
            let [end, flat, start] = kinds;
            above -= end + flat;
            let plane = SplitPlane { axis, at: first.at() };
            if plane.is_within(cell) {
                let areas = [
                    ends + walls * (f64::from(plane.at) - f64::from(cell.min[axis])),
                    ends + walls * (f64::from(cell.max[axis]) - f64::from(plane.at)),
                ];
                let costs = [cost(areas, below + flat, above), cost(areas, below, above + flat)];
                let side = usize::from(costs[1] < costs[0]);
                if best.is_none_or(|b| costs[side] < b.cost) {
                    best = Some(SahSplit { cost: costs[side], plane, flat: side });
                }
            }
            below += start + flat;
        }
        best
    }

    /// Distribute everything to both sides; None if that exceeds the budget.
    fn parted(self, set: &Set, split: SahSplit) -> Option<[Set; 2]> {
        let SahSplit { plane, flat, .. } = split;
        // By side, the new index of each uncut part.
        let count = set.parts.len();
        let mut numbers = [vec![GONE; count], vec![GONE; count]];
        let mut parts = [Vec::new(), Vec::new()];
        // By side, the indices of cut parts.
        let mut cut = [Vec::new(), Vec::new()];
        for (i, part) in set.parts.iter().enumerate() {
            let whole = match part.halves(self.input, plane) {
                PartPosition::Below => 0,
                PartPosition::Above => 1,
                PartPosition::Within => flat,
                PartPosition::Both(halves) => {
                    for (side, aabb) in halves.into_iter().enumerate().filter(|(_, aabb)| !aabb.is_empty()) {
                        cut[side].push(parts[side].len());
                        parts[side].push(PrimitivePart { aabb, ..*part });
                    }
                    continue;
                }
            };
            numbers[whole][i] = parts[whole].len() as u32;
            parts[whole].push(*part);
        }
        let rooms = set.room.shared(count, [parts[0].len(), parts[1].len()])?;
        let dealt = |axis: usize| dealt(&set.events[axis], axis, &numbers, &parts, &cut);
        let [x, y, z] = on_axes(count > PARALLEL, dealt);
        let cells = plane.cut(&set.cell);
        let ([x_below, x_above], [y_below, y_above], [z_below, z_above]) = (x, y, z);
        let [parts_below, parts_above] = parts;
        let below = Set { parts: parts_below, events: [x_below, y_below, z_below], cell: cells[0], room: rooms[0] };
        let above = Set { parts: parts_above, events: [x_above, y_above, z_above], cell: cells[1], room: rooms[1] };
        Some([below, above])
    }
}

/// Return the results of `work` for the three axes, by three threads if there is much to do.
fn on_axes<T: Send>(many: bool, work: impl Fn(usize) -> T + Sync) -> [T; 3] {
    if many {
        let (x, (y, z)) = parallel::join(|| work(0), || parallel::join(|| work(1), || work(2)));
        [x, y, z]
    } else {
        [0, 1, 2].map(work)
    }
}

/// The events along an axis on either side: those of uncut parts keep their order, and those of cut parts are new.
fn dealt(
    events: &[Event],
    axis: usize,
    numbers: &[Vec<u32>; 2],
    parts: &[Vec<PrimitivePart>; 2],
    cut: &[Vec<usize>; 2],
) -> [Vec<Event>; 2] {
    [0, 1].map(|side| {
        let (numbers, parts) = (&numbers[side], &parts[side]);
        let mut new: Vec<_> = cut[side].iter().flat_map(|&i| Event::of(&parts[i], i, axis)).flatten().collect();
        new.sort_unstable();
        let mut new = new.into_iter().peekable();
        let mut dealt = Vec::with_capacity(2 * parts.len());
        for event in events {
            let number = numbers[event.part()];
            if number != GONE {
                let event = event.renumbered(number);
                while let Some(before) = new.next_if(|n| *n < event) {
                    dealt.push(before);
                }
                dealt.push(event);
            }
        }
        dealt.extend(new);
        dealt
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn events_are_ordered_as_what_they_are_made_of(
            a in -2f32..2.0, b in -2f32..2.0, kinds in (0u64..3, 0u64..3), parts in (0..Event::MOST, 0..Event::MOST),
        ) {
            for b in [b, a, -a] {
                let (one, other) = (Event::new(a, kinds.0, parts.0), Event::new(b, kinds.1, parts.1));
                let wanted = a.partial_cmp(&b).unwrap().then(kinds.0.cmp(&kinds.1)).then(parts.0.cmp(&parts.1));
                prop_assert_eq!(one.cmp(&other), wanted);
                prop_assert_eq!((one.at(), one.kind(), one.part()), (a, kinds.0, parts.0));
            }
        }
    }

    #[test]
    fn zeros_are_one() {
        assert_eq!(Event::new(-0.0, START, 3), Event::new(0.0, START, 3));
    }
}
