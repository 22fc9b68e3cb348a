//! Joining of segments into polylines.

use std::collections::VecDeque;

/// A polyline by its point numbers. A closed one repeats its first point at the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// Points in order.
    pub points: Vec<u32>,
    /// Segments between them; true if the segment is traversed forwards.
    pub segments: Vec<(u32, bool)>,
}

impl Polyline {
    /// Returns whether it is closed.
    pub fn is_closed(&self) -> bool {
        self.points.len() > 1 && self.points.first() == self.points.last()
    }

    /// The reversed polyline.
    pub fn reversed(mut self) -> Self {
        self.points.reverse();
        self.segments.reverse();
        self.segments.iter_mut().for_each(|(_, is_forward)| *is_forward = !*is_forward);
        self
    }
}

/// Joins segments between numbered points into polylines, in either direction. Open ones come first, starting at points
/// where an odd number of segments end. At a point with more than two segments, a polyline prefers one that continues
/// in its direction. If it returns to one of its points, the loop is split off as a polyline of its own.
pub fn outlines(points: usize, segments: &[[u32; 2]]) -> Vec<Polyline> {
    const ELSEWHERE: u32 = u32::MAX;
    let mut at: Vec<VecDeque<u32>> = vec![VecDeque::new(); points];
    for (i, &[from, to]) in segments.iter().enumerate() {
        at[from as usize].push_front(i as u32);
        at[to as usize].push_back(i as u32);
    }
    let odd: Vec<u32> = (0..points as u32).filter(|&point| at[point as usize].len() % 2 == 1).collect();
    let mut is_used = vec![false; segments.len()];
    let (mut lines, mut loops) = (Vec::new(), Vec::new());
    // Position of each point on the polyline.
    let mut places = vec![ELSEWHERE; points];
    for begin in odd.into_iter().chain(segments.iter().map(|&[from, _]| from)) {
        let mut line = Polyline { points: vec![begin], segments: Vec::new() };
        places[begin as usize] = 0;
        let mut here = begin;
        loop {
            let others = &mut at[here as usize];
            while others.front().is_some_and(|&segment| is_used[segment as usize]) {
                others.pop_front();
            }
            let Some(segment) = others.pop_front() else { break };
            is_used[segment as usize] = true;
            let [from, to] = segments[segment as usize];
            let is_forward = from == here;
            here = if is_forward { to } else { from };
            line.segments.push((segment, is_forward));
            let place = places[here as usize];
            if place == ELSEWHERE {
                places[here as usize] = line.points.len() as u32;
                line.points.push(here);
                continue;
            }
            let mut around = line.points.split_off(place as usize + 1);
            around.iter().for_each(|&point| places[point as usize] = ELSEWHERE);
            around.insert(0, here);
            around.push(here);
            loops.push(Polyline { points: around, segments: line.segments.split_off(place as usize) });
        }
        line.points.iter().for_each(|&point| places[point as usize] = ELSEWHERE);
        if !line.segments.is_empty() {
            lines.push(line);
        }
    }
    lines.extend(loops);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_joined_whichever_way_segments_run() {
        let found = outlines(4, &[[0, 1], [2, 1], [2, 3], [0, 3]]);
        assert_eq!(found.len(), 1);
        assert!(found[0].is_closed());
        let ways: i32 = found[0].segments.iter().map(|(_, is)| if *is { 1 } else { -1 }).sum();
        assert_eq!((found[0].points.len(), ways), (5, 0));
        // Two loops that share a point, and an open polyline.
        let found = outlines(8, &[[6, 7], [0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 2]]);
        let mut told: Vec<_> = found.iter().map(|line| (line.is_closed(), line.segments.len())).collect();
        told.sort_unstable();
        assert_eq!(told, [(false, 1), (true, 3), (true, 3)]);
        assert!(found.iter().all(|line| line.segments.iter().all(|(_, is_forward)| *is_forward)));
    }
}
