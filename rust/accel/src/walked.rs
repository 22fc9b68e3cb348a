//! Runs every query by traversing a structure.

use super::query::{Answers, Query, Wanted};
use super::walk::{Build, Contents, Few, Input, Lists, Mailbox, Mailboxes, Marks, Structure, TogetherBatch};
use super::{Accelerator, Boxes, Info, Nearest, PrimitiveFilter, Primitives, SlabRay, Touches, bvh};
use raywright_base::math::{Aabb, DVec3, LANES, Ray, Region};
use raywright_base::parallel::{self, CHUNK};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd};
use raywright_shapes::triangle::{DoubleLeaves, EdgeRay, Leaves, SingleLeaves, SolidCone};
use std::ops::Range;
use std::sync::OnceLock;
use std::time::Instant;

/// A structure with the primitives in its leaves.
pub struct Walked<const N: usize, L> {
    structure: Box<dyn Structure>,
    contents: Contents<N, L>,
    /// All primitives, if they are few objects.
    few: Option<Few>,
    /// Unbounded objects, tested against every ray.
    unbounded: Vec<u32>,
    /// Mailboxes, if a primitive may be in several leaves.
    mailboxes: Option<Mailboxes>,
    /// A tree over the triangles for queries other than rays, built on first use.
    nearest: OnceLock<Box<dyn Accelerator>>,
    /// The number of primitives, including those that cannot be hit.
    count: usize,
    region: Region,
    level: Level,
    info: Info,
}

/// Build a structure over primitives of any kind, with coordinates in the given precision.
///
/// `build` is given the primitives and returns the structure and the content of its leaves. `mailbox` avoids repeated
/// tests of primitives in several leaves.
pub fn walked(primitives: &dyn Primitives, level: Level, mailbox: Mailbox, build: &Build) -> Box<dyn Accelerator> {
    match (level.lanes(), primitives.is_single()) {
        (8, true) => Box::new(Walked::<8, SingleLeaves<8>>::new(primitives, level, mailbox, build)),
        (8, false) => Box::new(Walked::<8, DoubleLeaves<8>>::new(primitives, level, mailbox, build)),
        (_, true) => Box::new(Walked::<4, SingleLeaves<4>>::new(primitives, level, mailbox, build)),
        (_, false) => Box::new(Walked::<4, DoubleLeaves<4>>::new(primitives, level, mailbox, build)),
    }
}

impl<'a> Input<'a> {
    /// Compute the primitives' boxes. The numbers of unbounded primitives are returned separately.
    pub(super) fn new(primitives: &'a dyn Primitives) -> (Self, Vec<u32>) {
        let region = primitives.region();
        let [surround, work] = primitives.work().parts([1.0, 20.0]);
        let of = |p: usize| match primitives.bounds(p as u32) {
            Some(b) if b.is_finite() => region.aabb([b.min, b.max, b.max]),
            _ => Aabb::EMPTY,
        };
        let boxes = surround.collect(primitives.count(), of).unwrap_or_default();
        let is_unbounded = |p: &u32| primitives.bounds(*p).is_some_and(|b| !b.is_finite());
        let unbounded = |some: Range<usize>| (some.start as u32..some.end as u32).filter(is_unbounded).collect();
        let has_objects = primitives.objects().is_some();
        let count = if has_objects { primitives.count() } else { 0 };
        let unbounded: Vec<Vec<u32>> = parallel::map_chunks(count, CHUNK, unbounded);
        let unbounded = unbounded.concat();
        (Self { region, boxes, primitives, work }, unbounded)
    }
}

impl<const N: usize, L: Leaves<N>> Walked<N, L> {
    fn new(primitives: &dyn Primitives, level: Level, mailbox: Mailbox, build: &Build) -> Self {
        let start = Instant::now();
        let (input, unbounded) = Input::new(primitives);
        let (structure, mut lists) = build(&input);
        if input.work.is_stopped() {
            lists = Lists::default();
        }
        let contents = Contents::new(&input, &lists);
        let bounded = input.boxes.iter().filter(|b| !b.is_empty()).count();
        let mailboxes = (lists.order.len() > bounded).then(|| Mailboxes::new(mailbox, primitives.count()));
        let info = Info { primitives: bounded + unbounded.len(), ..Info::default() };
        let (nearest, count, region) = (OnceLock::new(), primitives.count(), input.region);
        let few = contents.few().filter(|_| mailboxes.is_none());
        let mut walked = Self { structure, contents, few, unbounded, mailboxes, nearest, count, region, level, info };
        walked.inform();
        walked.info.build_seconds = start.elapsed().as_secs_f64();
        walked
    }

    /// The BVH that serves point and cone queries, for which it is the best structure.
    fn tree(&self) -> &dyn Accelerator {
        let tree = self.nearest.get_or_init(|| {
            let mut kept =
                FilteredHits { corners: vec![[DVec3::NAN; 3]; self.count], is_single: L::PRECISION == "single" };
            for (primitive, corners) in self.contents.triangles() {
                kept.corners[primitive as usize] = corners;
            }
            bvh::widest(&kept, &bvh::Options::DEFAULT, self.level)
        });
        tree.as_ref()
    }

    /// Fill in the statistics.
    fn inform(&mut self) {
        let of_structure = self.structure.info();
        self.info = Info {
            kind: format!("{}, {}", of_structure.kind, L::PRECISION),
            precision: L::PRECISION,
            bytes: of_structure.bytes
                + self.contents.bytes()
                + self.few.as_ref().map_or(0, Few::bytes)
                + size_of_val(self.unbounded.as_slice()),
            primitives: self.info.primitives,
            build_seconds: self.info.build_seconds,
            ..of_structure
        };
    }
}

impl<const N: usize, L: Leaves<N>> Answers for Walked<N, L>
where
    Level: Dispatch<N>,
{
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q) {
        match &self.mailboxes {
            None => self.level.dispatch(WalkedBatch { walked: self, rays, marks: None, query }),
            Some(boxes) => {
                boxes.with(|marks| self.level.dispatch(WalkedBatch { walked: self, rays, marks: Some(marks), query }));
            }
        }
    }

    fn nearest(&self, points: &[DVec3], max_distances: &[f64], counts: PrimitiveFilter<'_>, nearest: &mut [Nearest]) {
        self.tree().nearest_kept(points, max_distances, counts, nearest);
    }

    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches {
        self.tree().touched(cones)
    }

    fn boxes(&self) -> Option<Boxes> {
        let nodes = self.structure.boxes(&|leaf| self.contents.primitives(leaf).len())?;
        Some(Boxes { nodes, region: self.region, axes: None })
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        let start = Instant::now();
        if L::PRECISION == "single" && !primitives.is_single() {
            return Err("f64 corners cannot be stored in f32 leaves".into());
        }
        let (input, unbounded) = Input::new(primitives);
        let lists = self.contents.lists();
        let can_be_hit = |p: u32| input.boxes.get(p as usize).is_some_and(|b| !b.is_empty());
        if let Some(p) = lists.order.iter().find(|&&p| !can_be_hit(p)) {
            return Err(format!("primitive {p} can no longer be hit"));
        }
        let bounded = (0..primitives.count() as u32).filter(|&p| can_be_hit(p)).count();
        if bounded + unbounded.len() != self.info.primitives || unbounded != self.unbounded {
            return Err(format!("{bounded} primitives can be hit, expected {} as before", self.info.primitives));
        }
        let structure = self.structure.refitted(&input, &|leaf| self.contents.primitives(leaf))?;
        let contents = Contents::new(&input, &lists);
        let few = contents.few().filter(|_| self.few.is_some());
        let mut walked = Self {
            structure,
            contents,
            few,
            unbounded,
            mailboxes: self.mailboxes.as_ref().map(Mailboxes::another),
            nearest: OnceLock::new(),
            region: input.region,
            info: self.info.clone(),
            ..*self
        };
        walked.inform();
        walked.info.build_seconds = start.elapsed().as_secs_f64();
        Ok(walked)
    }

    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        let (input, unbounded) = Input::new(primitives);
        if unbounded != self.unbounded {
            return Err(format!("primitives {unbounded:?} are unbounded, but {:?} are stored", self.unbounded));
        }
        let lists = self.contents.lists();
        let mut met = vec![0u32; input.boxes.len()];
        for &p in &lists.order {
            met[p as usize] += 1;
        }
        let most = if self.mailboxes.is_some() { u32::MAX } else { 1 };
        let least = |p: usize| u32::from(!input.boxes[p].is_empty());
        if let Some(p) = (0..met.len()).find(|&p| met[p] < least(p) || met[p] > most * least(p)) {
            return Err(format!("primitive {p} is in {} leaves; its box is {:?}", met[p], input.boxes[p]));
        }
        self.contents.validate(primitives)?;
        self.structure.validate(&input, &|leaf| self.contents.primitives(leaf))
    }

    fn info(&self) -> &Info {
        &self.info
    }
}

impl<const N: usize, L: Leaves<N>> Walked<N, L> {
    /// Run a query without the structure.
    #[inline(always)]
    fn answer_by_few<Q: Query>(&self, few: &Few, rays: &[Ray], query: &mut Q) {
        let Self { contents, unbounded, region, .. } = self;
        let mut may_meet = [0; LANES];
        for (i, ray) in rays.iter().enumerate() {
            if i % LANES == 0 {
                few.ask(self.level, &rays[i..rays.len().min(i + LANES)], &mut may_meet);
            }
            let bits = may_meet[i % LANES];
            let edges = if bits == 0 && unbounded.is_empty() { None } else { EdgeRay::new(ray, region) };
            let Some(edges) = edges else {
                query.finish(i, None);
                continue;
            };
            let leaf_ray = contents.ray(ray, &edges, region);
            let mut state = query.start(i, edges.t_max);
            let mut meet = |numbers: &[u32]| contents.meet_objects(numbers, &leaf_ray, &mut None, query, &mut state);
            let _ = meet(unbounded) || few.numbers(bits).any(|number| meet(&[number]));
            query.finish(i, Some((edges.along(), state)));
        }
    }
}

/// The structure's triangles, as input for a BVH.
struct FilteredHits {
    corners: Vec<[DVec3; 3]>,
    is_single: bool,
}

impl Primitives for FilteredHits {
    fn count(&self) -> usize {
        self.corners.len()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.corners[primitive as usize]
    }

    fn is_single(&self) -> bool {
        self.is_single
    }
}

struct WalkedBatch<'a, const N: usize, L, Q> {
    walked: &'a Walked<N, L>,
    rays: &'a [Ray],
    marks: Option<&'a mut Marks>,
    query: &'a mut Q,
}

impl<const N: usize, L: Leaves<N>, Q: Query> Kernel<N> for WalkedBatch<'_, N, L, Q> {
    type Output = ();
    const AVX512: bool = false;

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) {
        let Self { walked, rays, mut marks, query } = self;
        let Walked { structure, contents, few, unbounded, region, level, .. } = walked;
        if let Some(few) = few
            && matches!(Q::WANTED, Wanted::Closest | Wanted::Any)
            && !Q::COUNTED
        {
            return walked.answer_by_few(few, rays, query);
        }
        if rays.len() > 1
            && let Some(mut walk) = structure.together(Q::COUNTED, *level)
        {
            TogetherBatch { contents, unbounded, region, rays }.answer(simd, walk.as_mut(), query);
            return;
        }
        // One ray at a time. Eight interleaved rays with prefetched leaves are faster in grids for incoherent rays, and
        // slower for coherent ones. Their mailbox stamps would also overwrite each other.
        let mut walker = match Q::WANTED {
            Wanted::Any => structure.any_walker(),
            _ => structure.walker(Q::COUNTED),
        };
        for (i, ray) in rays.iter().enumerate() {
            let Some(edges) = EdgeRay::new(ray, region) else {
                query.finish(i, None);
                continue;
            };
            let leaf_ray = contents.ray(ray, &edges, region);
            let mut state = query.start(i, edges.t_max);
            if let Some(marks) = &mut marks {
                marks.next_ray();
            }
            let mut answered = contents.meet_objects(unbounded, &leaf_ray, &mut marks, query, &mut state);
            if !answered && let Some(slabs) = SlabRay::new(None, &edges, region) {
                walker.start_at(&slabs, ray.time);
                while !answered && let Some(leaf) = walker.next(slabs.limit(Q::limit(&state))) {
                    answered = contents.meet(simd, leaf, &leaf_ray, &mut marks, query, &mut state);
                }
                if Q::COUNTED {
                    Q::visit_nodes(&mut state, walker.nodes());
                }
            }
            query.finish(i, Some((edges.along(), state)));
        }
    }
}
