//! All routines side by side, on the same rays and triangles and by the same clock.

use std::hint::black_box;
use std::time::{Duration, Instant};

use super::badouel::Badouel;
use super::edge_f32::EdgeF32;
use super::edge_f64::EdgeF64;
use super::moller_trumbore::{MollerTrumbore, MollerTrumboreEdges};
use super::volumes::Volumes;
use super::woop::Woop;
use super::{Meeting, Routine, SingleRay};
use raywright_base::math::Vec3;

/// Pairs that are brought near before their time is taken: few enough for a second-level cache.
const NEAR: usize = 1024;

/// Pairs of a ray and a triangle, made ready for every routine.
pub struct Contest {
    contenders: Vec<Box<dyn Contender>>,
    pairs: usize,
}

/// A routine with its pairs.
pub trait Contender: Send + Sync {
    /// Its name.
    fn name(&self) -> &'static str;
    /// What it keeps of a triangle, in bytes.
    fn bytes(&self) -> usize;
    /// Tests every pair once and returns the answers.
    fn answers(&self) -> Vec<Option<Meeting>>;
    /// Tests every pair, and tells how long that takes.
    fn time(&self, answers: &mut [Option<Meeting>]) -> Duration;
}

impl Contest {
    /// The `i`th ray is for the `i`th triangle.
    ///
    /// # Panics
    /// If there are not as many rays as triangles.
    pub fn new(rays: &[SingleRay], triangles: &[[Vec3; 3]]) -> Self {
        assert_eq!(rays.len(), triangles.len(), "as many rays as triangles");
        let contenders = vec![
            Pairs::<MollerTrumbore>::ready(rays, triangles),
            Pairs::<MollerTrumboreEdges>::ready(rays, triangles),
            Pairs::<Badouel>::ready(rays, triangles),
            Pairs::<Volumes>::ready(rays, triangles),
            Pairs::<Woop>::ready(rays, triangles),
            Pairs::<EdgeF32>::ready(rays, triangles),
            Pairs::<EdgeF64>::ready(rays, triangles),
        ];
        Self { contenders, pairs: rays.len() }
    }

    /// The routines, in the order of [`Contest::round`].
    pub fn contenders(&self) -> impl ExactSizeIterator<Item = &dyn Contender> {
        self.contenders.iter().map(|contender| &**contender)
    }

    /// How long each routine takes for all pairs. One after the other, so that of several rounds each has its share of
    /// whatever else the machine does.
    pub fn round(&self) -> Vec<Duration> {
        let mut answers = vec![None; self.pairs];
        self.contenders.iter().map(|contender| contender.time(&mut answers)).collect()
    }
}

/// Pairs as a routine wants them.
struct Pairs<R: Routine>(Vec<(R::Ray, R::Triangle)>);

impl<R> Pairs<R>
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

/// One test. The pair is hidden from the compiler, lest it merge several tests into one of vectors.
#[inline(always)]
fn test<R: Routine>(pair: &(R::Ray, R::Triangle)) -> Option<Meeting> {
    let (ray, triangle) = black_box(pair);
    R::meet(ray, triangle)
}

impl<R> Contender for Pairs<R>
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

    fn answers(&self) -> Vec<Option<Meeting>> {
        self.0.iter().map(test::<R>).collect()
    }

    fn time(&self, answers: &mut [Option<Meeting>]) -> Duration {
        let mut spent = Duration::ZERO;
        for (pairs, answers) in self.0.chunks(NEAR).zip(answers.chunks_mut(NEAR)) {
            // First from back to front: that fetches them, and teaches the branch predictor nothing of their order.
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
