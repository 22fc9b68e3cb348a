//! A benchmark of all routines on the same rays and triangles.

use std::hint::black_box;
use std::time::{Duration, Instant};

use super::badouel::Badouel;
use super::edge_f32::EdgeF32;
use super::edge_f64::EdgeF64;
use super::moller_trumbore::{MollerTrumbore, MollerTrumboreEdges};
use super::volumes::SignedVolumes;
use super::woop::Woop;
use super::{Routine, SingleRay, TriangleHit};
use raywright_base::math::Vec3;

/// Pairs per timed batch, loaded beforehand: few enough for a second-level cache.
const NEAR: usize = 1024;

/// Pairs of a ray and a triangle, prepared for every routine.
pub struct Contest {
    contenders: Vec<Box<dyn Contender>>,
    pairs: usize,
}

/// A routine with its pairs.
pub trait Contender: Send + Sync {
    /// Its name.
    fn name(&self) -> &'static str;
    /// The size of its triangle data in bytes.
    fn bytes(&self) -> usize;
    /// Test every pair once and return the results.
    fn answers(&self) -> Vec<Option<TriangleHit>>;
    /// Test every pair and return the time taken.
    fn time(&self, answers: &mut [Option<TriangleHit>]) -> Duration;
}

impl Contest {
    /// Pair the `i`-th ray with the `i`-th triangle.
    ///
    /// # Panics
    ///
    /// If the numbers of rays and triangles differ.
    pub fn new(rays: &[SingleRay], triangles: &[[Vec3; 3]]) -> Self {
        assert_eq!(rays.len(), triangles.len(), "as many rays as triangles");
        let contenders = vec![
            TestPairs::<MollerTrumbore>::ready(rays, triangles),
            TestPairs::<MollerTrumboreEdges>::ready(rays, triangles),
            TestPairs::<Badouel>::ready(rays, triangles),
            TestPairs::<SignedVolumes>::ready(rays, triangles),
            TestPairs::<Woop>::ready(rays, triangles),
            TestPairs::<EdgeF32>::ready(rays, triangles),
            TestPairs::<EdgeF64>::ready(rays, triangles),
        ];
        Self { contenders, pairs: rays.len() }
    }

    /// The routines, in the order of [`Contest::round`].
    pub fn contenders(&self) -> impl ExactSizeIterator<Item = &dyn Contender> {
        self.contenders.iter().map(|contender| &**contender)
    }

    /// The time of each routine for all pairs. The routines take turns, so that over several rounds each has an equal
    /// share of other load on the machine.
    pub fn round(&self) -> Vec<Duration> {
        let mut answers = vec![None; self.pairs];
        self.contenders.iter().map(|contender| contender.time(&mut answers)).collect()
    }
}

/// Pairs in the form that a routine needs.
struct TestPairs<R: Routine>(Vec<(R::Ray, R::Triangle)>);

impl<R> TestPairs<R>
where
    R: Routine + 'static,
    R::Ray: Send + Sync,
    R::Triangle: Send + Sync,
{
    fn ready(rays: &[SingleRay], triangles: &[[Vec3; 3]]) -> Box<dyn Contender> {
        let pairs = rays.iter().zip(triangles);
        Box::new(Self(pairs.map(|(&ray, &corners)| (R::ray(ray, corners), R::triangle(corners))).collect()))
    }
}

/// One test. The pair is hidden from the compiler, which might otherwise vectorize across tests.
#[inline(always)]
fn test<R: Routine>(pair: &(R::Ray, R::Triangle)) -> Option<TriangleHit> {
    let (ray, triangle) = black_box(pair);
    R::meet(ray, triangle)
}

impl<R> Contender for TestPairs<R>
where
    R: Routine,
    R::Ray: Send + Sync,
    R::Triangle: Send + Sync,
{
    fn name(&self) -> &'static str {
        R::NAME
    }

    fn bytes(&self) -> usize {
        size_of::<R::Triangle>()
    }

    fn answers(&self) -> Vec<Option<TriangleHit>> {
        self.0.iter().map(test::<R>).collect()
    }

    fn time(&self, answers: &mut [Option<TriangleHit>]) -> Duration {
        let mut spent = Duration::ZERO;
        for (pairs, answers) in self.0.chunks(NEAR).zip(answers.chunks_mut(NEAR)) {
            // A warm-up from back to front loads the pairs without training the branch predictor on their order.
            for (pair, answer) in pairs.iter().zip(answers.iter_mut()).rev() {
                *answer = test::<R>(pair);
            }
            let start = Instant::now();
            for (pair, answer) in pairs.iter().zip(answers.iter_mut()) {
                *answer = test::<R>(pair);
            }
            spent += start.elapsed();
            black_box(&*answers);
        }
        spent
    }
}
