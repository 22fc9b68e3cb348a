//! Brute force: every primitive is tested against every ray, as a reference for the other accelerators.

use super::nearest::{Search, of};
use super::query::{Answers, Query};
use super::walk::{Contents, Input, Lists};
use super::{Accelerator, Info, Nearest, PrimitiveFilter, Primitives, Touch, Touches};
use raywright_base::math::{DVec3, Ray, Region};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd};
use raywright_shapes::triangle::{DoubleLeaves, EdgeRay, Leaves, SingleLeaves, SolidCone};
use std::time::Instant;

/// Triangles per SIMD test, on every processor.
const LANES: usize = 4;

/// One leaf with all primitives, and no boxes.
pub struct BruteForce<L = SingleLeaves<LANES>> {
    contents: Contents<LANES, L>,
    region: Region,
    level: Level,
    info: Info,
}

impl BruteForce {
    /// Collect the primitives, with coordinates in the given precision.
    pub fn over(primitives: &dyn Primitives, level: Level) -> Box<dyn Accelerator> {
        if primitives.is_single() {
            Box::new(Self::of(primitives, level))
        } else {
            Box::new(BruteForce::<DoubleLeaves<LANES>>::of(primitives, level))
        }
    }
}

/// The numbers of the primitives that can be hit.
fn all(primitives: &dyn Primitives) -> Vec<u32> {
    (0..primitives.count() as u32).filter(|&p| primitives.bounds(p).is_some()).collect()
}

impl<L: Leaves<LANES>> BruteForce<L> {
    fn of(primitives: &dyn Primitives, level: Level) -> Self {
        let start = Instant::now();
        let region = primitives.region();
        let order = all(primitives);
        let count = order.len();
        let lists = Lists { counts: vec![count as u32], order };
        let contents = Contents::new(&Input { region, boxes: Vec::new(), primitives, work: primitives.work() }, &lists);
        let info = Info {
            kind: format!("brute force, {}", L::PRECISION),
            precision: L::PRECISION,
            primitives: count,
            leaves: 1,
            bytes: contents.bytes(),
            build_seconds: start.elapsed().as_secs_f64(),
            sah_cost: count.div_ceil(LANES) as f64,
            ..Info::default()
        };
        Self { contents, region, level, info }
    }
}

impl<L: Leaves<LANES>> Answers for BruteForce<L> {
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q) {
        self.level.dispatch(BruteBatch { brute: self, rays, query });
    }

    fn nearest(&self, points: &[DVec3], max_distances: &[f64], counts: PrimitiveFilter<'_>, nearest: &mut [Nearest]) {
        let triangles = self.contents.triangles();
        for (i, (&point, nearest)) in points.iter().zip(nearest).enumerate() {
            *nearest = Search::new(point, of(max_distances, i), &self.region).map_or(Nearest::MISS, |mut search| {
                let counts = |&&(primitive, _): &&(u32, _)| counts.is_none_or(|counts| counts(primitive));
                for &(primitive, corners) in triangles.iter().filter(counts) {
                    search.offer(primitive, corners);
                }
                search.finish()
            });
        }
    }

    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches {
        let triangles = self.contents.triangles();
        let mut all = Touches::new();
        for cone in cones {
            let touch = |&(primitive, corners)| Some(Touch { distance: cone.as_ref()?.nearest(corners)?, primitive });
            all.push(triangles.iter().filter_map(touch).collect());
        }
        all
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        if L::PRECISION == "single" && !primitives.is_single() {
            return Err("f64 corners cannot be stored in f32 leaves".into());
        }
        Ok(Self::of(primitives, self.level))
    }

    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        let (mut kept, wanted) = (self.contents.primitives(0), all(primitives));
        kept.sort_unstable();
        if kept != wanted {
            return Err(format!("{} primitives are stored, expected the {} that can be hit", kept.len(), wanted.len()));
        }
        self.contents.validate(primitives)
    }

    fn info(&self) -> &Info {
        &self.info
    }
}

struct BruteBatch<'a, L, Q> {
    brute: &'a BruteForce<L>,
    rays: &'a [Ray],
    query: &'a mut Q,
}

impl<L: Leaves<LANES>, Q: Query> Kernel<LANES> for BruteBatch<'_, L, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<LANES>>(self, simd: S) {
        let Self { brute: BruteForce { contents, region, .. }, rays, query } = self;
        for (i, ray) in rays.iter().enumerate() {
            let Some(edges) = EdgeRay::new(ray, region) else {
                query.finish(i, None);
                continue;
            };
            let leaf_ray = contents.ray(ray, &edges, region);
            let mut state = query.start(i, edges.t_max);
            contents.meet(simd, 0, &leaf_ray, &mut None, query, &mut state);
            query.finish(i, Some((edges.along(), state)));
        }
    }
}
