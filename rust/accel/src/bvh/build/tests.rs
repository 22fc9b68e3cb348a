//! Tests of the trees of all builders, with and without optimizers, over arbitrary boxes.

use super::*;
use crate::bvh::optimise::{reinsertion, treelet};
use proptest::prelude::*;
use raywright_base::math::{DVec3, Vec3};
use raywright_base::sampling::philox4x32;
use raywright_base::work::Watch;
use raywright_shapes::triangle::clipped;

const ALL: [Builder; 9] = [
    Builder::Binned { bins: None },
    Builder::Sweep,
    Builder::Spatial { bins: Some(8), budget: 2.0 },
    Builder::Morton(morton::Bits::Thirty),
    Builder::Morton(morton::Bits::SixtyThree),
    Builder::Ploc { radius: ploc::RADIUS },
    Builder::Halves(SplitRule::Midpoint),
    Builder::Halves(SplitRule::Median),
    Builder::Halves(SplitRule::Mean),
];

/// Clip primitives that fill their boxes.
fn fill(boxes: &[Aabb]) -> impl Fn(u32, &Aabb) -> Aabb + Sync {
    |p, to| boxes[p as usize].intersection(*to)
}

/// The area of all inner nodes.
fn cost(bvh: &BinaryBvh) -> f64 {
    bvh.nodes.iter().filter(|n| !n.is_leaf()).map(|n| f64::from(n.aabb().half_area())).sum()
}

/// Assert that a tree over these boxes is valid, in depth-first order, and no deeper than traversal stacks allow.
fn assert_sound(bvh: &BinaryBvh, boxes: &[Aabb], builder: Builder, clip: impl Fn(u32, &Aabb) -> Aabb) {
    if builder.parts() { bvh.validate_parts(boxes, clip) } else { bvh.validate(boxes) }
        .unwrap_or_else(|wrong| panic!("{}: {wrong}", builder.name()));
    assert_depth_first(bvh);
    let count = boxes.iter().filter(|b| !b.is_empty()).count();
    // Primitives within a block may form a chain.
    let limit = 3 * count.max(1).ilog2() as usize + 42 + Leaves::MAX_BLOCK;
    let limit = if let Builder::Morton(bits) = builder { limit.max(bits.count() as usize + 33) } else { limit };
    assert!(bvh.depth() <= limit, "{}: depth {} of {count}", builder.name(), bvh.depth());
}

/// Build with every builder, and run every optimizer.
fn check(boxes: &[Aabb], clip: impl Fn(u32, &Aabb) -> Aabb + Sync, block: usize) {
    for builder in ALL {
        let mut bvh = builder.build(boxes, &clip, &Leaves::for_blocks(block), Work::UNWATCHED).unwrap();
        assert_sound(&bvh, boxes, builder, &clip);
        assert!(bvh.nodes.iter().all(|n| n.count as usize <= Leaves::for_blocks(block).whole));
        let before = cost(&bvh);
        let mut other = bvh.clone();
        treelet::optimise(&mut bvh, &treelet::Options { rounds: 3, worthwhile: 0.0, block }, Work::UNWATCHED).unwrap();
        assert_sound(&bvh, boxes, builder, &clip);
        let between = cost(&bvh);
        assert!(between <= before * (1.0 + 1e-6), "{}: {between} from {before}", builder.name());
        let options = reinsertion::Options { rounds: 3, share: 0.5, worthwhile: 0.0, block };
        for bvh in [&mut bvh, &mut other] {
            reinsertion::optimise(bvh, &options, Work::UNWATCHED).unwrap();
            assert_sound(bvh, boxes, builder, &clip);
        }
        assert!(cost(&bvh) <= between * (1.0 + 1e-6), "{}: {} from {between}", builder.name(), cost(&bvh));
    }
}

fn hostile() -> impl Strategy<Value = Vec<Aabb>> {
    let whole = || (-2i32..=2).prop_map(|x| x as f32);
    let coordinate = || prop_oneof![4 => -2f32..2.0, 2 => whole(), 1 => (-120i32..1).prop_map(|e| 2f32.powi(e))];
    let size = || prop_oneof![2 => Just(0f32), 4 => 0f32..0.3, 1 => 0f32..3.0, 1 => Just(1e-30f32)];
    let some = (prop::array::uniform3(coordinate()), prop::array::uniform3(size())).prop_map(|(p, d)| {
        let min = Vec3::from(p);
        Aabb { min, max: (min + Vec3::from(d)).min(Vec3::splat(2.0)).max(min) }
    });
    let one = prop_oneof![12 => some, 1 => Just(Aabb::EMPTY)];
    let copies = (one, prop_oneof![8 => Just(1usize), 1 => 2usize..40]);
    prop::collection::vec(copies, 0..120).prop_map(|all| all.into_iter().flat_map(|(b, n)| vec![b; n]).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    #[test]
    fn trees_over_any_boxes_are_valid(boxes in hostile(), block in 1..=16usize) {
        check(&boxes, fill(&boxes), block);
    }
}

#[test]
fn a_few_boxes_and_none() {
    let boxes = [
        Aabb::EMPTY,
        Aabb::around([Vec3::ONE]),
        Aabb::EMPTY,
        Aabb::around([Vec3::ONE]),
        Aabb::around([Vec3::X, Vec3::Y]),
    ];
    for count in 0..=boxes.len() {
        for block in [1, 8] {
            check(&boxes[..count], fill(&boxes), block);
        }
    }
}

#[test]
fn many_of_one_centre_and_of_one_box() {
    let scales: Vec<_> = (0..5000).map(|i| Vec3::splat(1.01f32.powi(-i))).map(|s| Aabb { min: -s, max: s }).collect();
    check(&scales, fill(&scales), 8);
    let equal = vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }; 30_000];
    check(&equal, fill(&equal), 8);
    // Each box contains all previous ones.
    let nested: Vec<_> =
        (0..20_000).map(|i| Aabb { min: Vec3::ZERO, max: Vec3::splat(1.0 - 0.9995f32.powi(i)) }).collect();
    check(&nested, fill(&nested), 4);
}

#[test]
fn a_million_copies_end_soon() {
    let boxes = vec![Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 0.0, 1.0) }; 1_000_000];
    let start = std::time::Instant::now();
    for builder in ALL {
        let bvh = builder.build(&boxes, fill(&boxes), &Leaves::for_blocks(8), Work::UNWATCHED).unwrap();
        assert!(bvh.depth() <= 22 && bvh.order.len() >= boxes.len(), "{}", builder.name());
    }
    assert!(start.elapsed().as_secs() < 120, "{:?}", start.elapsed());
}

/// Thin triangles along a diagonal, and their boxes.
fn sticks(count: u32) -> (Vec<[DVec3; 3]>, Vec<Aabb>) {
    let random = |i| philox4x32([i, 0, 0, 0], [0, 0]).map(|bits| f64::from(bits) / 2f64.powi(32));
    let triangles: Vec<_> = (0..count)
        .map(|i| {
            let [x, y, z, length] = random(i);
            let (from, along) = (DVec3::new(x, 0.1 * y, z), DVec3::new(0.8, 1.0, 0.8 + 0.1 * length));
            [from, from + along, from + along + DVec3::new(1e-3, 0.0, 0.0)]
        })
        .collect();
    let everywhere = Aabb { min: Vec3::splat(-4.0), max: Vec3::splat(4.0) };
    let boxes = triangles.iter().map(|&corners| clipped(corners, &everywhere)).collect();
    (triangles, boxes)
}

/// The cost by the surface area heuristic, relative to the root's area.
fn sah(bvh: &BinaryBvh) -> f64 {
    let cost = |n: &Node| f64::from(n.aabb().half_area()) * if n.is_leaf() { f64::from(n.count) } else { 1.0 };
    bvh.nodes.iter().map(cost).sum::<f64>() / f64::from(bvh.nodes[0].aabb().half_area())
}

#[test]
fn parted_sticks_are_held_and_cost_less() {
    let (triangles, boxes) = sticks(1000);
    let clip = |p: u32, to: &Aabb| clipped(triangles[p as usize], to);
    check(&boxes, clip, 8);
    let leaves = Leaves::by_cost(8, 1.0, 1.0);
    let build = |builder: Builder| builder.build(&boxes, clip, &leaves, Work::UNWATCHED).unwrap();
    let whole = build(Builder::Sweep);
    let mut last = sah(&whole);
    for budget in [1.0, 4.0, 8.0] {
        let bvh = build(Builder::Spatial { bins: Some(32), budget });
        bvh.validate_parts(&boxes, clip).unwrap();
        assert!(bvh.order.len() as f32 <= 1000.0 * (1.0 + budget));
        assert!(sah(&bvh) < 0.8 * last, "{budget}: {} from {last}", sah(&bvh));
        last = sah(&bvh);
    }
}

#[test]
fn looking_everywhere_costs_no_more_than_looking_at_borders_of_bins() {
    let (_, boxes) = sticks(20_000);
    for leaves in [Leaves::for_blocks(1), Leaves::by_cost(16, 1.0, 1.0)] {
        let [sweep, binned, median] =
            [Builder::Sweep, Builder::Binned { bins: Some(8) }, Builder::Halves(SplitRule::Median)]
                .map(|builder| sah(&builder.build(&boxes, fill(&boxes), &leaves, Work::UNWATCHED).unwrap()));
        assert!(sweep < binned && binned < median, "{sweep} {binned} {median}");
    }
}

#[test]
fn a_leaf_is_made_where_splitting_does_not_lower_the_cost() {
    // Equal boxes gain nothing; separate ones do, if traversal steps are cheap enough.
    let equal = vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }; 12];
    let apart: Vec<_> =
        (0..12).map(|i| Aabb::around([Vec3::new(i as f32, 0.0, 0.0), Vec3::new(i as f32 + 0.1, 1.0, 1.0)])).collect();
    for builder in [Builder::Binned { bins: None }, Builder::Sweep, Builder::Spatial { bins: None, budget: 1.0 }] {
        let nodes = |boxes: &[Aabb], traversal_cost| {
            let leaves = Leaves::by_cost(16, traversal_cost, 1.0);
            builder.build(boxes, fill(boxes), &leaves, Work::UNWATCHED).unwrap().nodes.len()
        };
        assert_eq!(nodes(&equal, 0.1), 1, "{}", builder.name());
        assert_eq!(nodes(&apart, 0.1), 23, "{}", builder.name());
        assert_eq!(nodes(&apart, 100.0), 1, "{}", builder.name());
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let (triangles, all) = sticks(66_000);
    let clip = |p: u32, to: &Aabb| clipped(triangles[p as usize], to);
    let on = |threads: usize, builder: Builder| {
        let pool = raywright_base::workers::pool(Some(threads)).unwrap();
        // Planes are searched in parallel only in the largest nodes.
        let boxes = &all[..if builder.parts() { all.len() } else { 10_000 }];
        pool.install(|| {
            let mut bvh = builder.build(boxes, clip, &Leaves::for_blocks(8), Work::UNWATCHED).unwrap();
            treelet::optimise(&mut bvh, &treelet::Options { rounds: 1, worthwhile: 0.0, block: 8 }, Work::UNWATCHED)
                .unwrap();
            bvh
        })
    };
    let nodes = |bvh: &BinaryBvh| -> Vec<_> {
        bvh.nodes.iter().map(|n| (n.min.to_array(), n.index, n.max.to_array(), n.count)).collect()
    };
    for builder in ALL {
        let [one, three] = [1, 3].map(|threads| on(threads, builder));
        assert!(one.order == three.order && nodes(&one) == nodes(&three), "{}", builder.name());
    }
}

#[test]
fn builds_tell_all_that_they_do_and_end_when_they_are_stopped() {
    let (triangles, boxes) = sticks(20_000);
    for builder in ALL {
        let (watch, stopped) = (Watch::default(), Watch::default());
        let leaves = Leaves::for_blocks(8);
        let clip = |p: u32, to: &Aabb| clipped(triangles[p as usize], to);
        let bvh = builder.build(&boxes, clip, &leaves, Work::of(&watch)).unwrap();
        // The reported progress adds up to the whole.
        assert!(watch.share() > 0.99 && watch.share() <= 1.0, "{}: {}", builder.name(), watch.share());
        stopped.stop();
        let early = builder.build(boxes.clone(), clip, &leaves, Work::of(&stopped));
        assert!(early.is_err() && stopped.share() < 0.5, "{}: {}", builder.name(), stopped.share());
        // A canceled optimizer leaves the tree unchanged.
        let mut same = bvh.clone();
        let options = treelet::Options { rounds: 1, worthwhile: 0.0, block: 8 };
        assert_eq!(treelet::optimise(&mut same, &options, Work::of(&stopped)), Err(Stopped));
        let options = reinsertion::Options { rounds: 3, share: 0.5, worthwhile: 0.0, block: 8 };
        assert_eq!(reinsertion::optimise(&mut same, &options, Work::of(&stopped)), Err(Stopped));
        assert!(same.order == bvh.order && same.nodes.len() == bvh.nodes.len());
    }
}

#[test]
fn halves_are_made_where_they_say() {
    // For centers 0, 1, 2, 9 the midpoint is 4.5, the mean 3, and the median separates two from two.
    let boxes = [0.0, 1.0, 2.0, 9.0].map(|x| Aabb::around([Vec3::new(x, 0.0, 0.0)]));
    for (way, left) in [(SplitRule::Midpoint, 2.0), (SplitRule::Mean, 2.0), (SplitRule::Median, 1.0)] {
        let bvh = split_rules::build(&boxes, way, &Leaves::for_blocks(1), Work::UNWATCHED).unwrap();
        assert_eq!(bvh.nodes[1].max.x, left, "{way:?}");
    }
    let boxes = [0.0, 4.0, 5.0, 7.0].map(|x| Aabb::around([Vec3::new(x, 0.0, 0.0)]));
    for (way, left) in [(SplitRule::Midpoint, 0.0), (SplitRule::Mean, 0.0), (SplitRule::Median, 4.0)] {
        let bvh = split_rules::build(&boxes, way, &Leaves::for_blocks(1), Work::UNWATCHED).unwrap();
        assert_eq!(bvh.nodes[1].max.x, left, "{way:?}");
    }
}
