//! Traversals of binary trees: each gives the answers of brute force to every query, on the tree of every builder.

use super::builders::{BUILDERS, SPATIAL, optimisers, sticks};
use super::triangles::{Random, Triangles, levels};
use raywright::accel::bvh::Options;
use raywright::accel::bvh::optimise::Optimisers;
use raywright::accel::bvh::traverse::{Orders, PacketSize, Traversal};
use raywright::accel::{Accelerator, BruteForce, Cost, Crossings, Primitives, Side, UserGeometry, Wanted, trees};
use raywright::math::{DVec3, Hit, Ray, Vec3};
use raywright::shapes::{Bounds, Candidate, Contact};
use raywright::simd::Level;
use std::sync::Arc;

const BUNDLES: Traversal = Traversal::Stack(PacketSize::SixtyFour);
const STACK: Traversal = Traversal::Stack(PacketSize::One);

fn best() -> Level {
    levels().last().unwrap()
}

/// A tree of each builder with some optimizer, with every traversal.
fn trees(primitives: &dyn Primitives) -> Vec<Box<dyn Accelerator>> {
    let mut trees = Vec::new();
    for (i, builder) in BUILDERS.into_iter().enumerate() {
        for (k, traversal) in Traversal::ALL.into_iter().enumerate() {
            let optimisers = Some(optimisers()[(i + k) % 3]);
            let tree =
                trees::binary(primitives, &Options { builder, optimisers, ..Options::DEFAULT }, traversal, best());
            tree.validate(primitives).unwrap_or_else(|wrong| panic!("{}: {wrong}", tree.info().kind));
            trees.push(tree);
        }
    }
    let ways = Traversal::ALL.into_iter().flat_map(|way| levels().map(move |level| (way, level)));
    trees.extend(ways.map(|(way, level)| trees::binary(primitives, &Options::DEFAULT, way, level)));
    trees
}

/// Answers to all queries.
#[derive(Debug, PartialEq)]
struct Answers {
    hits: Vec<Hit>,
    occluded: Vec<bool>,
    crossings: Crossings,
    sides: Vec<Side>,
}

/// Run all queries in batches of a size.
fn ask(accelerator: &dyn Accelerator, rays: &[Ray], batch: usize) -> Answers {
    let none = Answers { hits: vec![], occluded: vec![], crossings: Crossings::default(), sides: vec![] };
    let mut all = none;
    all.crossings.splits.push(0);
    for rays in rays.chunks(batch) {
        let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        accelerator.intersect(rays, &mut hits);
        accelerator.occluded(rays, &mut occluded);
        let leaving: Vec<_> = rays.iter().map(|r| Ray { t_min: 0.0, ..*r }).collect();
        let sides = accelerator.exits(&|_| true, &leaving).sides();
        let Crossings { splits, hits: met } = accelerator.crossings(rays);
        let before = all.crossings.hits.len();
        all.crossings.splits.extend(splits[1..].iter().map(|end| before + end));
        all.crossings.hits.extend(met);
        all.hits.extend(hits);
        all.occluded.extend(occluded);
        all.sides.extend(sides);
    }
    all
}

/// Return the answers of brute force, after checking that all trees give them for several batch sizes.
fn agreed(primitives: &dyn Primitives, rays: &[Ray]) -> Answers {
    let wanted = ask(BruteForce::over(primitives, best()).as_ref(), rays, rays.len());
    for (i, tree) in trees(primitives).iter().enumerate() {
        let batch = [rays.len(), 65, 3][i % 3];
        assert_eq!(ask(tree.as_ref(), rays, batch), wanted, "{}, {batch} rays", tree.info().kind);
    }
    wanted
}

fn costs(tree: &dyn Accelerator, rays: &[Ray]) -> Vec<Cost> {
    let mut costs = vec![Cost::default(); rays.len()];
    tree.cost(rays, &mut costs);
    costs
}

fn nodes(costs: &[Cost]) -> u64 {
    costs.iter().map(|c| u64::from(c.nodes)).sum()
}

fn over(triangles: &Triangles, traversal: Traversal) -> Box<dyn Accelerator> {
    // Whole triangles only: these properties do not hold for trees over pieces.
    let options = Options { optimisers: Some(Optimisers::REINSERTION), ..Options::DEFAULT };
    trees::binary(triangles, &options, traversal, best())
}

/// Coherent rays through an eye, and rays in any direction, some of them invalid.
fn some_of_one_mind(random: &mut Random, triangles: &Triangles) -> Vec<Ray> {
    let eye = DVec3::new(0.1, 0.2, 3.0);
    let fan = |i: u32| DVec3::new(f64::from(i % 16) * 0.04 - 0.3, f64::from(i / 16) * 0.04 - 0.3, -1.0);
    let mut rays: Vec<_> = (0..200).map(|i| Ray::new(eye, fan(i))).collect();
    rays.extend(random.aimed(triangles, 250, 3.0));
    for (i, ray) in rays.iter_mut().enumerate() {
        match i % 29 {
            3 => ray.direction = DVec3::NAN,
            5 => ray.t_max = 2.5,
            7 => (ray.t_min, ray.t_max) = (3.0, 2.0),
            _ => {}
        }
    }
    rays
}

#[test]
fn soups_and_sticks() {
    let mut random = Random(41);
    for triangles in [random.soup(350, 0.3), sticks(&mut random, 150), random.soup(1, 1.0), random.soup(2, 1.0)] {
        let rays = some_of_one_mind(&mut random, &triangles);
        assert!(agreed(&triangles, &rays).occluded.iter().filter(|&&hit| hit).count() >= 50);
    }
}

#[test]
fn ties_copies_planes_and_nothing() {
    let mut random = Random(42);
    let mut triangles: Vec<_> = (0..40).map(|_| [0; 3].map(|_| random.grid(3).as_vec3())).collect();
    triangles.extend_from_within(..);
    triangles.extend(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 50]);
    triangles.push([Vec3::splat(f32::NAN); 3]);
    let flat = triangles.iter().map(|t| t.map(|c| c.with_z(1.0))).collect();
    let rays: Vec<_> = (0..300).map(|_| Ray::new(random.grid(5), random.grid(2))).collect();
    for (triangles, hits) in [(triangles, 50), (flat, 5), (vec![[Vec3::ONE; 3]; 70], 0), (Vec::new(), 0)] {
        let answers = agreed(&Triangles(triangles), &rays);
        assert!(answers.occluded.iter().filter(|&&hit| hit).count() >= hits);
    }
}

/// Balls among triangles; the last two are unbounded half-spaces.
struct Balls {
    triangles: Triangles,
    balls: Arc<[(DVec3, f64)]>,
}

impl Balls {
    fn ball(&self) -> Found {
        Found { balls: self.balls.clone(), first: self.triangles.count() as u32 }
    }
}

impl Primitives for Balls {
    fn count(&self) -> usize {
        self.triangles.count() + self.balls.len() + 1
    }
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        let all = self.triangles.count();
        if (primitive as usize) < all { self.triangles.corners(primitive) } else { [DVec3::NAN; 3] }
    }
    fn is_single(&self) -> bool {
        true
    }
    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        Some(Arc::new(self.ball()))
    }
}

struct Found {
    balls: Arc<[(DVec3, f64)]>,
    first: u32,
}

impl UserGeometry for Found {
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        match self.balls.get(primitive.checked_sub(self.first)? as usize) {
            Some(&(centre, radius)) => Some(Bounds { min: centre - 1.01 * radius, max: centre + 1.01 * radius }),
            None => Some(Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY.with_z(-4.0) }),
        }
    }

    fn meet(&self, primitive: u32, _: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        let ts = match self.balls.get((primitive - self.first) as usize) {
            Some(&(centre, radius)) => {
                let to = ray.origin - centre;
                let (a, b) = (ray.direction.length_squared(), to.dot(ray.direction));
                let root = (b * b - a * (to.length_squared() - radius * radius)).sqrt();
                [(-b - root) / a, (-b + root) / a]
            }
            None => [(-4.0 - ray.origin.z) / ray.direction.z, f64::NAN],
        };
        let inside = |t: &f64| ray.t_min <= *t && *t <= ray.t_max;
        ts.into_iter().filter(inside).any(|t| met(Candidate { t, uv: [0.0; 2], contact: Contact::Inside, inner: 0 }))
    }
}

#[test]
fn balls_among_triangles() {
    let mut random = Random(43);
    let triangles = random.soup(80, 0.3);
    let balls: Vec<_> = (0..60).map(|_| (random.point(1.5), random.between(0.01, 0.3))).collect();
    let rays = some_of_one_mind(&mut random, &triangles);
    for triangles in [triangles, Triangles(Vec::new())] {
        let mixed = Balls { triangles, balls: balls.clone().into() };
        let answers = agreed(&mixed, &rays);
        let first = mixed.triangles.count() as u32;
        let of = |which: &dyn Fn(u32) -> bool| answers.hits.iter().any(|h| h.is_hit() && which(h.primitive));
        assert!(of(&|p| p >= first && p < first + 60) && of(&|p| p == first + 60));
    }
}

#[test]
fn trees_are_fitted_to_what_moves_unless_they_hold_parts() {
    let mut random = Random(44);
    let (before, after) = (sticks(&mut random, 300), sticks(&mut random, 300));
    let rays = some_of_one_mind(&mut random, &after);
    let wanted = ask(BruteForce::over(&after, best()).as_ref(), &rays, 100);
    for traversal in Traversal::ALL {
        let tree = over(&before, traversal);
        let moved = tree.refitted(&after).unwrap();
        moved.validate(&after).unwrap();
        assert_eq!(ask(moved.as_ref(), &rays, 100), wanted, "{traversal:?}");
        let told = |a: &dyn Accelerator| (a.info().nodes, a.info().leaves, a.info().kind.clone());
        assert_eq!(told(moved.as_ref()), told(tree.as_ref()));
        let parts = trees::binary(&before, &Options { builder: SPATIAL, ..Options::DEFAULT }, traversal, best());
        let wrong = parts.refitted(&after).err().unwrap();
        assert!(wrong.contains("spatial splits") && wrong.contains("rebuild it"), "{wrong}");
    }
}

#[test]
fn rays_that_hit_nothing_take_the_same_nodes_in_any_order() {
    let mut random = Random(45);
    let soup = random.soup(2000, 0.05);
    let rays: Vec<_> = (0..2000).map(|_| Ray::new(random.point(2.0), random.point(1.0))).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    let stack = over(&soup, STACK);
    stack.intersect(&rays, &mut hits);
    let missing: Vec<_> = rays.iter().zip(&hits).filter(|(_, h)| !h.is_hit()).map(|(r, _)| *r).collect();
    let wanted = costs(stack.as_ref(), &missing);
    assert!(missing.len() > 200 && nodes(&wanted) > 5 * missing.len() as u64);
    for traversal in
        Traversal::ALL.into_iter().filter(|t| ![BUNDLES, Traversal::Oriented, Traversal::Slabs].contains(t))
    {
        assert_eq!(costs(over(&soup, traversal).as_ref(), &missing), wanted, "{traversal:?}");
    }
}

#[test]
fn rays_of_one_mind_share_the_work_of_a_bundle() {
    let mut random = Random(46);
    let soup = random.soup(3000, 0.1);
    let eye = DVec3::new(0.0, 0.0, 4.0);
    let fan: Vec<_> = (0..4096u32)
        .map(|i| {
            // Packets are squares of 8 by 8.
            let (tile, at) = (i / 64, i % 64);
            let (x, y) = (tile % 8 * 8 + at % 8, tile / 8 * 8 + at / 8);
            Ray::new(eye, DVec3::new(f64::from(x) / 640.0 - 0.05, f64::from(y) / 640.0 - 0.05, -1.0))
        })
        .collect();
    let [alone, together] = [STACK, BUNDLES].map(|way| nodes(&costs(over(&soup, way).as_ref(), &fan)));
    assert!(2 * together < alone, "{together} of {alone}");
}

#[test]
fn threads_take_eight_bytes_an_order_and_node() {
    let soup = Random(47).soup(500, 0.1);
    let bytes = |traversal| {
        let info = over(&soup, traversal).info().clone();
        (info.bytes, info.nodes + info.leaves)
    };
    let (stack, count) = bytes(STACK);
    for orders in [Orders::Six, Orders::Eight] {
        assert_eq!(bytes(Traversal::Threaded(orders)), (stack + 8 * orders.count() * count, count));
    }
    assert_eq!(bytes(BUNDLES), (stack, count));
}

#[test]
fn volumes_beside_boxes_spare_tests_of_what_is_diagonal() {
    let mut random = Random(48);
    let sticks = sticks(&mut random, 2000);
    let rays: Vec<_> = (0..2000).map(|_| Ray::new(random.point(2.0), random.point(1.0))).collect();
    let tests = |traversal| -> u64 {
        costs(over(&sticks, traversal).as_ref(), &rays).iter().map(|c| u64::from(c.primitives)).sum()
    };
    let boxes = tests(STACK);
    for traversal in [Traversal::Oriented, Traversal::Slabs] {
        assert!(2 * tests(traversal) < boxes, "{traversal:?}: {} of {boxes}", tests(traversal));
    }
}
