//! Rows of the matrix by ray tracing, for curved surfaces and for scenes with too many faces for all pairs.

use super::Aim;
use super::facet::Facet;
use super::hit_fronts::Fronts;
use super::proportion_error::Counts;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::sampling::{BatchSize, Sampler, SamplerKind, warp};
use raywright_scene::{RayOrigin, Scene};

/// Rays traced together.
const TOGETHER: u32 = 1 << 12;

/// Maximum number of rays per row, and the maximum without a requested error.
const MOST: u32 = 1 << 26;
const MOST_UNASKED: u32 = 1 << 20;

/// An entry of a row: face, view factor and standard error.
pub type Entry = (u32, f64, f64);

/// The state of a thread that computes rows.
pub struct RowSampler<'a> {
    scene: &'a Scene,
    fronts: &'a Fronts,
    seed: u64,
    /// By face: the weight of its hits in the current batch, in all batches, and the sum of squares over batches.
    batch: Vec<f64>,
    sums: Vec<[f64; 2]>,
    /// The faces hit in the current batch, and in any batch.
    fresh: Vec<u32>,
    touched: Vec<u32>,
    rays: Vec<Ray>,
    /// The weight and origin of each ray.
    weights: Vec<f64>,
    places: Vec<DVec3>,
    hits: Vec<Hit>,
}

impl<'a> RowSampler<'a> {
    /// Create the state for a scene.
    pub fn new(scene: &'a Scene, fronts: &'a Fronts, seed: u64) -> Self {
        let count = scene.geometry().count();
        Self {
            scene,
            fronts,
            seed,
            batch: vec![0.0; count],
            sums: vec![[0.0; 2]; count],
            fresh: Vec::new(),
            touched: Vec::new(),
            rays: Vec::new(),
            weights: Vec::new(),
            places: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// Compute the row of a face from rays with uniform origins and cosine-weighted directions, each counted at its
    /// first hit if that is a front. The number of rays doubles until the error of each entry is at most `wanted(face,
    /// factor, greatest factor of the row)`. Return the number of rays, too.
    pub fn row(
        &mut self,
        primitive: u32,
        facet: &Facet,
        aim: &Aim,
        wanted: impl Fn(u32, f64, f64) -> f64,
    ) -> (Vec<Entry>, u32) {
        let rays = aim.row_rays;
        // The area of a stretched shape takes an integral, so it is computed once.
        let from = (primitive, self.scene.geometry().area(primitive));
        let size = BatchSize::for_budget(Some(rays));
        let (mut done, mut target) = (0, rays.next_multiple_of(size.samples()).max(2 * size.samples()));
        loop {
            while done < target {
                let to = target.min(done + TOGETHER.max(size.samples()));
                self.send(from, facet, size, done..to);
                done = to;
            }
            let batches = f64::from(done / size.samples());
            let entry = |&face: &u32| {
                let [sum, squares] = self.sums[face as usize];
                let mean = sum / batches;
                let between = (squares / batches - mean * mean).max(0.0) / (batches - 1.0);
                let each = f64::from(size.samples());
                let counts = Counts::of(mean / each, f64::from(done));
                (face, mean / each, counts.variance((between / (each * each), batches)).sqrt())
            };
            let row: Vec<Entry> = self.touched.iter().map(entry).collect();
            let most = row.iter().fold(0.0f64, |most, entry| most.max(entry.1));
            let is_met = row.iter().all(|&(face, factor, error)| error <= wanted(face, factor, most))
                || (aim.error.is_none() && target > MOST_UNASKED / 2);
            if is_met || target > MOST / 2 {
                for face in self.touched.drain(..) {
                    self.sums[face as usize] = [0.0; 2];
                }
                return (row, done);
            }
            target *= 2;
        }
    }

    fn send(&mut self, from: (u32, f64), facet: &Facet, size: BatchSize, samples: std::ops::Range<u32>) {
        let primitive = from.0;
        let kind = SamplerKind::Sobol(size);
        self.rays.clear();
        self.weights.clear();
        self.places.clear();
        for sample in samples {
            let mut sampler = kind.sampler(self.seed, primitive, sample);
            let (ray, weight, place) = leaving(self.scene, from, facet, &mut sampler);
            self.rays.push(ray);
            self.weights.push(weight);
            self.places.push(place);
        }
        self.hits.resize(self.rays.len(), Hit::MISS);
        self.scene.intersect(&self.rays, &mut self.hits);
        let each = size.samples() as usize;
        for start in (0..self.rays.len()).step_by(each) {
            for i in start..start + each {
                let (ray, hit) = (&self.rays[i], &self.hits[i]);
                if self.weights[i] > 0.0
                    && let Some((face, _)) = self.fronts.met(self.scene, (primitive, self.places[i]), ray, hit)
                {
                    if self.batch[face as usize] == 0.0 {
                        self.fresh.push(face);
                    }
                    self.batch[face as usize] += self.weights[i];
                }
            }
            for face in self.fresh.drain(..) {
                let value = std::mem::take(&mut self.batch[face as usize]);
                let sums = &mut self.sums[face as usize];
                if sums[0] == 0.0 {
                    self.touched.push(face);
                }
                sums[0] += value;
                sums[1] += value * value;
            }
        }
    }
}

/// A ray from a face of the given area, with uniform origin and cosine-weighted direction, its weight, and its origin.
/// One of weight 0 keeps its place in the batch.
pub fn leaving(
    scene: &Scene,
    (primitive, area): (u32, f64),
    facet: &Facet,
    sampler: &mut Sampler,
) -> (Ray, f64, DVec3) {
    let geometry = scene.geometry();
    let (u, v) = (sampler.two(1), sampler.two(3));
    let direction = warp::cosine_hemisphere(v);
    let (origin, normal, weight, place) = match geometry.shape(primitive) {
        Some(shape) => match shape.sample(u) {
            Some(drawn) => {
                let site = drawn.point.site();
                let point = geometry.on_shape(primitive, &site);
                let weight = 1.0 / (drawn.pdf * area);
                (RayOrigin::new(&point), point.normal, weight, point.position)
            }
            None => (RayOrigin::free(facet.centre), facet.normal, 0.0, facet.centre),
        },
        None => {
            let place = geometry.position(primitive, warp::uniform_triangle(u));
            (RayOrigin::off(place, geometry.error(primitive), facet.normal), facet.normal, 1.0, place)
        }
    };
    if weight > 0.0 {
        let misses = [primitive, Ray::NO_TRIANGLE];
        (Ray { misses, ..origin.ray(Frame::new(normal).to_world(direction)) }, weight, place)
    } else {
        (Ray::new(facet.centre, DVec3::Z), 0.0, place)
    }
}
