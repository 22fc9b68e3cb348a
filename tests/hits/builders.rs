//! Builders and optimizers: every tree is valid and gives the hits of brute force, bit for bit.

use super::triangles::{Random, Triangles, bits, levels};
use raywright::accel::bvh::build::morton::Bits;
use raywright::accel::bvh::build::split_rules::SplitRule;
use raywright::accel::bvh::build::{Builder, ploc};
use raywright::accel::bvh::optimise::{Optimiser, Optimisers};
use raywright::accel::bvh::{self, Options, Quality};
use raywright::accel::{Accelerator, BruteForce, Nearest};
use raywright::math::{DVec3, Hit, Ray, Vec3};

/// Spatial splits without a limit on their number.
pub const SPATIAL: Builder = Builder::Spatial { bins: None, budget: 4.0 };

/// All builders.
pub const BUILDERS: [Builder; 9] = [
    Builder::Binned { bins: Some(2) },
    Builder::Sweep,
    SPATIAL,
    Builder::Morton(Bits::Thirty),
    Builder::Morton(Bits::SixtyThree),
    Builder::Ploc { radius: ploc::RADIUS },
    Builder::Halves(SplitRule::Midpoint),
    Builder::Halves(SplitRule::Median),
    Builder::Halves(SplitRule::Mean),
];

/// No optimizer, one, and all.
pub fn optimisers() -> [Optimisers; 3] {
    let both = Optimisers::new([Optimiser::Treelet, Optimiser::Reinsertion]).unwrap();
    [Optimisers::NONE, Optimisers::new([Optimiser::Treelet]).unwrap(), both]
}

/// Trees of every builder and optimizer, and of every quality.
fn trees(triangles: &Triangles) -> Vec<Box<dyn Accelerator>> {
    let level = levels().last().unwrap();
    let chosen = BUILDERS.into_iter().flat_map(|builder| {
        optimisers().map(|optimisers| Options { builder, optimisers: Some(optimisers), ..Options::DEFAULT })
    });
    let by_quality = Quality::ALL.map(|quality| Options { quality, ..Options::DEFAULT });
    let mut trees = Vec::new();
    for options in chosen.chain(by_quality) {
        for width in [4, 8].into_iter().filter(|&w| w <= level.lanes()) {
            let tree = bvh::wide(width, triangles, &options, level);
            tree.validate(triangles).unwrap_or_else(|wrong| panic!("{}: {wrong}", tree.info().kind));
            trees.push(tree);
        }
    }
    trees
}

/// Return the number of hits, after checking that all trees agree with brute force.
fn agreed(triangles: &Triangles, rays: &[Ray]) -> usize {
    let ask = |accelerator: &dyn Accelerator| {
        let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        accelerator.intersect(rays, &mut hits);
        accelerator.occluded(rays, &mut occluded);
        (hits.iter().map(bits).collect::<Vec<_>>(), occluded)
    };
    let brute = BruteForce::over(triangles, levels().last().unwrap());
    let wanted = ask(brute.as_ref());
    for tree in trees(triangles) {
        assert_eq!(ask(tree.as_ref()), wanted, "{}", tree.info().kind);
        assert_eq!(tree.info().primitives, brute.info().primitives, "{}", tree.info().kind);
    }
    wanted.1.iter().filter(|&&hit| hit).count()
}

/// Long thin triangles along a diagonal.
pub fn sticks(random: &mut Random, count: usize) -> Triangles {
    let stick = |_| {
        let (from, along) = (random.point(1.0), DVec3::new(1.5, random.between(1.2, 1.5), -1.5));
        [from, from + along, from + along * 0.9 + random.point(0.02)].map(|p| p.as_vec3())
    };
    Triangles((0..count).map(stick).collect())
}

#[test]
fn soups() {
    let mut random = Random(31);
    for (count, size) in [(1, 1.0), (2, 1.0), (9, 0.5), (400, 0.3), (1500, 0.05)] {
        let soup = random.soup(count, size);
        assert!(agreed(&soup, &random.aimed(&soup, 300, 3.0)) >= 100);
    }
}

#[test]
fn sticks_along_diagonals() {
    let mut random = Random(32);
    let sticks = sticks(&mut random, 600);
    let mut rays = random.aimed(&sticks, 600, 4.0);
    rays.extend((0..600).map(|_| Ray::new(random.point(2.0), random.point(1.0))));
    assert!(agreed(&sticks, &rays) >= 300);
}

#[test]
fn integers_with_ties_copies_and_flat_ones() {
    let mut random = Random(33);
    let mut triangles: Vec<_> = (0..60).map(|_| [0; 3].map(|_| random.grid(3).as_vec3())).collect();
    triangles.extend_from_within(..);
    triangles.extend(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 50]);
    triangles.push([Vec3::splat(f32::NAN); 3]);
    let triangles = Triangles(triangles);
    let rays: Vec<_> = (0..500).map(|_| Ray::new(random.grid(5), random.grid(2))).collect();
    assert!(agreed(&triangles, &rays) > 100);
}

#[test]
fn huge_and_tiny_together() {
    let mut random = Random(34);
    let triangles = (0..400).map(|i| {
        let size = random.of(&[1e-6, 1e-3, 1.0, 1e6]);
        let centre = random.point(if i % 2 == 0 { 1.0 } else { 1e6 });
        [0; 3].map(|_| (centre + random.point(size)).as_vec3())
    });
    let triangles = Triangles(triangles.collect());
    assert!(agreed(&triangles, &random.aimed(&triangles, 600, 3.0)) >= 300);
}

#[test]
fn nearest_points_do_not_depend_on_parts() {
    let mut random = Random(35);
    let sticks = sticks(&mut random, 300);
    let points: Vec<_> = (0..300).map(|_| random.point(2.0)).collect();
    let ask = |accelerator: &dyn Accelerator| {
        let mut nearest = vec![Nearest::MISS; points.len()];
        accelerator.nearest(&points, &[f64::INFINITY], &mut nearest);
        nearest
    };
    let wanted = ask(BruteForce::over(&sticks, levels().last().unwrap()).as_ref());
    for tree in trees(&sticks) {
        assert_eq!(ask(tree.as_ref()), wanted, "{}", tree.info().kind);
    }
}

#[test]
fn a_tree_of_parts_is_not_refitted() {
    let mut random = Random(36);
    // Along all four diagonals: no other axes fit all of them.
    let mut sticks = sticks(&mut random, 600);
    for (i, stick) in sticks.0.iter_mut().enumerate() {
        let signs = Vec3::new(if i % 2 == 0 { 1.0 } else { -1.0 }, 1.0, if i / 2 % 2 == 0 { 1.0 } else { -1.0 });
        *stick = stick.map(|corner| corner * signs);
    }
    let level = levels().last().unwrap();
    let tree = |options| bvh::widest(&sticks, &options, level);
    let default = Options::DEFAULT;
    for options in [Options { builder: SPATIAL, ..default }, Options { quality: Quality::FastRays, ..default }, default]
    {
        let wrong = tree(options).refitted(&sticks).err().unwrap();
        assert!(wrong.contains("spatial splits") && wrong.contains("rebuild it"), "{wrong}");
    }
    for builder in BUILDERS.into_iter().filter(|b| *b != SPATIAL) {
        let options = Options { builder, optimisers: Some(Optimisers::NONE), ..default };
        tree(options).refitted(&sticks).unwrap().validate(&sticks).unwrap();
    }
    tree(Options { quality: Quality::FastBuild, ..default }).refitted(&sticks).unwrap().validate(&sticks).unwrap();
}

#[test]
fn quality_decides_where_nobody_else_does() {
    let soup = Random(37).soup(50, 0.3);
    let level = levels().last().unwrap();
    let kind = |options: Options| bvh::widest(&soup, &options, level).info().kind.clone();
    let (default, none) = (Options::DEFAULT, Some(Optimisers::NONE));
    let treelet = Optimisers::new([Optimiser::Treelet]);
    for (options, wanted) in [
        (default, "binned SAH and reinsertion"),
        (Options { quality: Quality::FastBuild, ..default }, "binned SAH"),
        (Options { optimisers: none, ..default }, "binned SAH"),
        (Options { builder: Builder::Sweep, quality: Quality::FastRays, ..default }, "full-sweep SAH"),
        (Options { builder: Builder::Sweep, optimisers: treelet, ..default }, "full-sweep SAH and treelets"),
    ] {
        assert_eq!(kind(options), format!("BVH, {} wide, {wanted}, single", level.lanes().min(8)));
    }
    assert_eq!(Optimisers::new([Optimiser::Treelet; 2]), None);
}
