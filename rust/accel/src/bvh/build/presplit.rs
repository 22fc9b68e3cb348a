//! Splitting before the build: a long diagonal primitive fills little of its box, and any builder makes a better tree
//! from the boxes of its pieces (Ernst and Greiner, "Early Split Clipping for Bounding Volume Hierarchies", 2007).
//!
//! The gain of a split is the box's area minus the areas of the primitive's parts in its halves: it is proportional to
//! the number of avoided false hits. Splits with the greatest gain come first, anywhere in the scene, until the budget
//! is used up or the gain is too small. In the end the remaining gains are about equal everywhere. (Karras and Aila,
//! "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", 2013, distribute the budget beforehand, by
//! a power of the area.)
//!
//! Regular meshes gain nothing, since a piece takes a place in a block like a whole primitive. So nothing is split if
//! the total gain is small.

use super::reference::SHARE;
use super::spatial::MAX_BUDGET;
use super::{BinaryBvh, Shapes};
use raywright_base::math::{Aabb, Vec3};
use raywright_base::parallel;

/// Options of splitting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Maximum number of added pieces per primitive, from 0 to [`MAX_BUDGET`].
    pub budget: f32,
    /// Minimum total saving, as a fraction of the area of all boxes; otherwise nothing is split.
    pub worthwhile: f32,
}

/// Minimum gain of a split, relative to the area of the scene's box over the number of primitives. If as many pieces
/// are added as there are primitives, a ray hits at least this many boxes fewer.
const LEAST: f32 = 5.0;

/// Minimum gain relative to the area of the split box. A diagonal in a plane gains a half. A triangle with two
/// axis-parallel sides gains a quarter, which the nodes above its pieces cost again.
const LEAST_SHARE: f32 = 0.3;

/// Gain threshold of the splits that decide whether splitting is worthwhile, unless they are too few.
const COARSE: f32 = 100.0;

/// Beyond this number of splits per primitive, spatial splits would spend their budget where less is gained.
const MANY: f32 = 0.5;

/// Maximum number of pieces that a wide tree can index.
const MOST: usize = (1 << 28) - 2;

/// The treatment of primitives that fill little of their boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// None: there are too few of them.
    Nothing,
    /// Spatial splits during the build, if there are few.
    Planes,
    /// Splitting before the build, which spends the budget where most is gained.
    Pieces,
}

impl Remedy {
    /// Choose the treatment from the splits with the greatest gain.
    pub fn of(boxes: &[Aabb], shapes: &impl Shapes, options: &Options) -> Self {
        let total = Total::of(boxes);
        let coarse = (total.count as f32 * 1e-3).clamp(LEAST, COARSE);
        let least = coarse * total.around.half_area() / total.count as f32;
        let many = (MANY.min(options.budget) * total.count as f32) as usize;
        let made = SplitPieces::of(boxes, shapes, least, many);
        if many > 0 && made.cuts == many {
            Self::Pieces
        } else if made.saved > f64::from(options.worthwhile) * total.area {
            Self::Planes
        } else {
            Self::Nothing
        }
    }
}

/// Pieces of primitives, over which a tree may be built instead.
pub struct Pieces {
    /// The box of each piece or unsplit primitive, empty if the primitive's was.
    pub boxes: Vec<Aabb>,
    /// The primitive of each piece.
    pub primitives: Vec<u32>,
}

impl Pieces {
    /// Split primitives, given by their boxes; None if that is not worthwhile.
    ///
    /// Time is proportional to the number of pieces, and the result does not depend on the number of threads.
    ///
    /// # Panics
    ///
    /// If the budget is out of range.
    pub fn cut(boxes: &[Aabb], shapes: &impl Shapes, options: &Options) -> Option<Self> {
        let Options { budget, worthwhile } = *options;
        assert!((0.0..=MAX_BUDGET).contains(&budget), "budget is {budget}, not from 0 to {MAX_BUDGET}");
        let total = Total::of(boxes);
        let least = LEAST * total.around.half_area() / total.count as f32;
        let wanted = f64::from(worthwhile) * total.area;
        // A box cannot gain more than its area.
        let most: f64 = long(boxes, least).map(|(_, b)| f64::from(b.half_area())).sum();
        if most <= wanted {
            return None;
        }
        let budget = ((f64::from(budget) * total.count as f64) as usize).min(MOST.saturating_sub(total.count));
        let made = SplitPieces::of(boxes, shapes, least, budget);
        if made.saved <= wanted {
            return None;
        }
        // The pieces of a primitive stay in the order of their creation.
        let key = |(i, piece): (usize, &(u32, Aabb))| u64::from(piece.0) << 32 | i as u64;
        let mut keys: Vec<u64> = made.pieces.iter().enumerate().map(key).collect();
        parallel::sort(&mut keys);
        let mut pieces = keys.into_iter().map(|key| made.pieces[key as u32 as usize]).peekable();
        let mut all = Self { boxes: Vec::new(), primitives: Vec::new() };
        for (p, whole) in (0u32..).zip(boxes) {
            let before = all.boxes.len();
            while let Some((_, piece)) = pieces.next_if(|piece| piece.0 == p) {
                all.boxes.push(piece);
            }
            if all.boxes.len() == before {
                all.boxes.push(*whole);
            }
            all.primitives.resize(all.boxes.len(), p);
        }
        Some(all)
    }

    /// The shapes of the pieces.
    pub fn shapes<'a, S: Shapes>(&'a self, of: &'a S) -> Pieced<'a, S> {
        Pieced { of, pieces: &self.primitives }
    }

    /// Turn a tree over pieces into one over primitives, without duplicates within a leaf.
    pub fn put_together(&self, bvh: &mut BinaryBvh) {
        let mut order = Vec::with_capacity(bvh.order.len());
        let mut open: Vec<usize> = bvh.nodes.first().map(|_| 0).into_iter().collect();
        while let Some(node) = open.pop() {
            let node = &mut bvh.nodes[node];
            if !node.is_leaf() {
                open.extend(node.children().into_iter().rev());
                continue;
            }
            let first = order.len();
            for &piece in &bvh.order[node.index as usize..(node.index + node.count) as usize] {
                let primitive = self.primitives[piece as usize];
                if !order[first..].contains(&primitive) {
                    order.push(primitive);
                }
            }
            (node.index, node.count) = (first as u32, (order.len() - first) as u32);
        }
        bvh.order = order;
    }
}

/// Totals before splitting.
pub struct Total {
    /// The bounding box of all.
    pub around: Aabb,
    /// Half the surface area of all boxes.
    pub area: f64,
    /// The number of nonempty boxes.
    pub count: usize,
}

impl Total {
    /// Compute the totals, independently of the number of threads.
    pub fn of(boxes: &[Aabb]) -> Self {
        let of_share = |share: &[Aabb]| {
            let none = Self { around: Aabb::EMPTY, area: 0.0, count: 0 };
            share.iter().filter(|b| !b.is_empty()).fold(none, |total, b| Self {
                around: total.around.union(*b),
                area: total.area + f64::from(b.half_area()),
                count: total.count + 1,
            })
        };
        // Partial sums are added in a fixed order.
        let shares = parallel::map_chunks(boxes.len(), SHARE, |share| of_share(&boxes[share]));
        shares.into_iter().fold(of_share(&[]), |a, b| Self {
            around: a.around.union(b.around),
            area: a.area + b.area,
            count: a.count + b.count,
        })
    }
}

/// Shapes of pieces, given by the primitive of each.
pub struct Pieced<'a, S> {
    of: &'a S,
    pieces: &'a [u32],
}

impl<S: Shapes> Shapes for Pieced<'_, S> {
    fn clip(&self, piece: u32, to: &Aabb) -> Aabb {
        self.of.clip(self.pieces[piece as usize], to)
    }

    fn corners(&self, piece: u32) -> Option<[Vec3; 3]> {
        self.of.corners(self.pieces[piece as usize])
    }
}

/// A split of a primitive or piece in the middle of its box's longest side.
struct Cut {
    primitive: u32,
    whole: Aabb,
    halves: [Aabb; 2],
    /// The reduction of the area.
    gain: f32,
}

impl Cut {
    /// None if the gain is too small.
    fn new(primitive: u32, whole: &Aabb, shapes: &impl Shapes, least: f32) -> Option<Self> {
        let area = whole.half_area();
        let least = least.max(LEAST_SHARE * area);
        if area <= least {
            return None;
        }
        let size = whole.max - whole.min;
        let axis = size.max_position();
        let middle = whole.min[axis] + size[axis] / 2.0;
        let (mut below, mut above) = (*whole, *whole);
        (below.max[axis], above.min[axis]) = (middle, middle);
        let halves = [below, above].map(|half| shapes.clip(primitive, &half));
        if halves.iter().any(Aabb::is_empty) {
            return None;
        }
        let gain = area - halves[0].half_area() - halves[1].half_area();
        (gain > least).then_some(Self { primitive, whole: *whole, halves, gain })
    }
}

/// The boxes of more than a given area.
fn long(boxes: &[Aabb], least: f32) -> impl Iterator<Item = (u32, &Aabb)> {
    (0u32..).zip(boxes).filter(move |(_, b)| !b.is_empty() && b.half_area() > least)
}

/// The result of splitting.
#[derive(Default)]
struct SplitPieces {
    /// All candidate pieces with their primitives.
    pieces: Vec<(u32, Aabb)>,
    /// The number of splits.
    cuts: usize,
    /// The saved area.
    saved: f64,
}

impl SplitPieces {
    /// Make splits above a minimum gain, up to a maximum number.
    fn of(boxes: &[Aabb], shapes: &impl Shapes, least: f32, budget: usize) -> Self {
        let mut made = Self::default();
        let long: Vec<_> = long(boxes, least).collect();
        made.cut(&long, &|p, whole| Cut::new(p, whole, shapes, least), budget);
        made
    }

    /// Split up to a maximum number of times, by decreasing gain to within a factor of two.
    fn cut(&mut self, long: &[(u32, &Aabb)], cut: &(dyn Fn(u32, &Aabb) -> Option<Cut> + Sync), mut budget: usize) {
        let first = parallel::collect(long.len(), |i| cut(long[i].0, long[i].1));
        let greatest = first.iter().flatten().fold(0f32, |greatest, cut| greatest.max(cut.gain));
        // Buckets of gains above a half of the greatest, above a quarter, and so on.
        let mut rows: Vec<Vec<Cut>> = Vec::new();
        let put = |rows: &mut Vec<Vec<Cut>>, cut: Cut, from: usize| {
            let row = ((greatest / cut.gain).log2() as usize).max(from);
            if rows.len() <= row {
                rows.resize_with(row + 1, Vec::new);
            }
            rows[row].push(cut);
        };
        // Primitives without gain stay whole and are not listed.
        first.into_iter().flatten().for_each(|cut| put(&mut rows, cut, 0));
        let mut row = 0;
        while row < rows.len() {
            let mut batch = std::mem::take(&mut rows[row]);
            if batch.is_empty() {
                row += 1;
                continue;
            }
            if batch.len() > budget {
                batch.sort_by(|a, b| b.gain.total_cmp(&a.gain));
                self.pieces.extend(batch.drain(budget..).map(|cut| (cut.primitive, cut.whole)));
            }
            budget -= batch.len();
            self.cuts += batch.len();
            self.saved += batch.iter().map(|cut| f64::from(cut.gain)).sum::<f64>();
            let halves = |i: usize| {
                let made: &Cut = &batch[i];
                made.halves.each_ref().map(|half| cut(made.primitive, half))
            };
            let halves = parallel::collect(batch.len(), halves);
            for (made, next) in batch.iter().zip(halves) {
                for (half, next) in made.halves.iter().zip(next) {
                    match next {
                        Some(next) => put(&mut rows, next, row),
                        None => self.pieces.push((made.primitive, *half)),
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::{Builder, Leaves};
    use raywright_base::math::{DVec3, Vec3};
    use raywright_base::sampling::philox4x32;
    use raywright_base::work::Work;
    use raywright_shapes::triangle::clipped;

    /// Triangles given by two sides from random corners.
    fn triangles(count: u32, along: DVec3, aside: DVec3) -> Vec<[DVec3; 3]> {
        let random = |i| philox4x32([i, 0, 0, 0], [0, 0]).map(|bits| f64::from(bits) / 2f64.powi(32));
        let place = |i| DVec3::from_slice(&random(i)[..3]);
        (0..count).map(|i| [place(i), place(i) + along, place(i) + aside]).collect()
    }

    fn boxes(triangles: &[[DVec3; 3]]) -> Vec<Aabb> {
        let everywhere = Aabb { min: Vec3::splat(-4.0), max: Vec3::splat(4.0) };
        triangles.iter().map(|&corners| clipped(corners, &everywhere)).collect()
    }

    fn cut(triangles: &[[DVec3; 3]], boxes: &[Aabb], budget: f32, worthwhile: f32) -> Option<Pieces> {
        Pieces::cut(boxes, &|p: u32, to: &Aabb| clipped(triangles[p as usize], to), &Options { budget, worthwhile })
    }

    fn area(boxes: &[Aabb]) -> f64 {
        boxes.iter().filter(|b| !b.is_empty()).map(|b| f64::from(b.half_area())).sum()
    }

    #[test]
    fn diagonals_are_cut_as_far_as_the_budget_goes() {
        let sticks = triangles(1000, DVec3::new(0.9, 0.8, -0.9), DVec3::new(1e-3, 0.0, 0.0));
        let mut whole = boxes(&sticks);
        whole[7] = Aabb::EMPTY;
        let mut last = area(&whole);
        for (budget, share) in [(1.0, 0.51), (3.0, 0.51), (7.0, 0.51)] {
            let pieces = cut(&sticks, &whole, budget, 0.4).unwrap();
            assert_eq!(pieces.boxes.len(), 1000 + (999.0 * budget) as usize);
            // Twice as many pieces of half the length have half the area.
            let now = area(&pieces.boxes);
            assert!(0.45 * last < now && now < share * last, "{now} from {last}");
            last = now;
            let builder = Builder::Ploc { radius: 14 };
            let leaves = Leaves::for_blocks(8);
            let fill = |_: u32, to: &Aabb| *to;
            let mut bvh = builder.build(&pieces.boxes, fill, &leaves, Work::UNWATCHED).unwrap();
            pieces.put_together(&mut bvh);
            bvh.validate_parts(&whole, |p, to| clipped(sticks[p as usize], to)).unwrap();
        }
        assert!(cut(&sticks, &whole, 1.0, 0.6).is_none(), "a half is not worthwhile");
        assert!(cut(&sticks, &whole, 0.0, 0.0).is_none() && cut(&sticks, &[], 1.0, 0.0).is_none());
    }

    #[test]
    fn what_lies_along_the_axes_stays_whole() {
        for (along, aside) in [(DVec3::X, 1e-3 * DVec3::Y), (DVec3::Z, 0.5 * DVec3::Y), (DVec3::Y, DVec3::X)] {
            let along = triangles(2000, along, aside);
            assert!(cut(&along, &boxes(&along), 8.0, 0.0).is_none());
        }
    }

    #[test]
    fn what_is_small_stays_whole() {
        // The scene's box has an area of 3; boxes of less than 5 thousandths of it are not even considered.
        let small = triangles(1000, DVec3::splat(0.07), DVec3::new(0.0, 1e-3, 0.0));
        let boxes = boxes(&small);
        assert!(
            Pieces::cut(
                &boxes,
                &|_: u32, _: &Aabb| -> Aabb { unreachable!() },
                &Options { budget: 8.0, worthwhile: 0.0 }
            )
            .is_none()
        );
    }

    #[test]
    fn planes_are_for_few_and_cuts_for_many() {
        let along = DVec3::new(0.9, 0.8, -0.9);
        let remedy = |long: u32, small: u32| {
            let mut some = triangles(long, along, DVec3::new(1e-3, 0.0, 0.0));
            some.extend(triangles(small, DVec3::splat(0.01), DVec3::new(0.0, 1e-2, 0.0)));
            let options = Options { budget: 4.0, worthwhile: 0.5 };
            Remedy::of(&boxes(&some), &|p: u32, to: &Aabb| clipped(some[p as usize], to), &options)
        };
        assert_eq!(remedy(0, 5000), Remedy::Nothing);
        assert_eq!(remedy(100, 5000), Remedy::Planes);
        assert_eq!(remedy(3000, 5000), Remedy::Pieces);
        assert_eq!(
            Remedy::of(&[], &|_: u32, to: &Aabb| *to, &Options { budget: 4.0, worthwhile: 0.5 }),
            Remedy::Nothing
        );
        // A gain below the requested one counts as none.
        let straight = triangles(5000, DVec3::X, 1e-3 * DVec3::Y);
        let clip = |p: u32, to: &Aabb| clipped(straight[p as usize], to);
        let options = Options { budget: 4.0, worthwhile: 0.5 };
        assert_eq!(Remedy::of(&boxes(&straight), &clip, &options), Remedy::Nothing);
    }

    #[test]
    fn the_longest_are_cut_first() {
        let mut sticks = triangles(500, DVec3::splat(0.25), DVec3::new(1e-3, 0.0, 0.0));
        sticks[..20].copy_from_slice(&triangles(20, DVec3::splat(1.0), DVec3::new(1e-3, 0.0, 0.0)));
        let pieces = cut(&sticks, &boxes(&sticks), 0.1, 0.0).unwrap();
        let of = |p: u32| pieces.primitives.iter().filter(|&&q| q == p).count();
        // Halves of the long ones still gain more than the short ones do.
        assert_eq!((0..20).map(of).sum::<usize>(), 70);
        assert!((0..20).all(|p| (3..=4).contains(&of(p))) && (20..500).all(|p| of(p) == 1));
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let sticks = triangles(40_000, DVec3::new(0.9, 0.8, -0.9), DVec3::new(0.02, 0.0, 0.0));
        let boxes = boxes(&sticks);
        let [one, three] = [1, 3].map(|threads| {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            pool.install(|| cut(&sticks, &boxes, 2.3, 0.0)).unwrap()
        });
        assert!(one.boxes == three.boxes && one.primitives == three.primitives);
    }
}
