//! Batch execution of paths: the pending ray queries of all are traced together.

use crate::media::ray_tracer::TraceRays;
use raywright_base::math::{Hit, Ray};
use raywright_scene::Scene;
use std::cell::{Cell, RefCell};
use std::future::{Future, poll_fn};
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

/// Number of concurrent paths: enough for large ray batches, few enough that their state stays in the cache.
const TOGETHER: usize = 128;

/// A path's pending query and its result.
pub struct Lane {
    asked: Cell<Asked>,
    hit: Cell<Hit>,
    crossed: RefCell<Vec<Hit>>,
}

/// A pending query.
#[derive(Clone, Copy)]
enum Asked {
    Nothing,
    First(Ray),
    Crossed(Ray),
}

impl Lane {
    fn new() -> Self {
        Self { asked: Cell::new(Asked::Nothing), hit: Cell::new(Hit::MISS), crossed: RefCell::default() }
    }

    /// Await the result of a query.
    async fn ask(&self, question: Asked) {
        self.asked.set(question);
        let mut is_asked = false;
        poll_fn(|_| if std::mem::replace(&mut is_asked, true) { Poll::Ready(()) } else { Poll::Pending }).await;
    }
}

impl TraceRays for &Lane {
    async fn first(self, ray: &Ray) -> Hit {
        self.ask(Asked::First(*ray)).await;
        self.hit.get()
    }

    async fn crossed<T>(self, ray: &Ray, told: impl FnOnce(&[Hit]) -> T) -> T {
        self.ask(Asked::Crossed(*ray)).await;
        told(&self.crossed.borrow())
    }
}

/// Make the lanes for a number of paths.
pub fn lanes(paths: usize) -> Vec<Lane> {
    (0..paths.min(TOGETHER)).map(|_| Lane::new()).collect()
}

/// Run a task on each lane concurrently.
pub fn together<'l, F: Future<Output = ()> + 'l>(scene: &Scene, lanes: &'l [Lane], work: impl Fn(&'l Lane) -> F) {
    let mut context = Context::from_waker(Waker::noop());
    let mut busy: Vec<(&Lane, Pin<Box<F>>)> = lanes.iter().map(|lane| (lane, Box::pin(work(lane)))).collect();
    let (mut firsts, mut windows) = (Questions::default(), Questions::default());
    let mut hits = Vec::new();
    while !busy.is_empty() {
        firsts.clear();
        windows.clear();
        busy.retain_mut(|(lane, work)| {
            if work.as_mut().poll(&mut context).is_ready() {
                return false;
            }
            match lane.asked.get() {
                Asked::First(ray) => firsts.push(lane, ray),
                Asked::Crossed(ray) => windows.push(lane, ray),
                Asked::Nothing => {}
            }
            true
        });
        hits.clear();
        hits.resize(firsts.rays.len(), Hit::MISS);
        scene.intersect(&firsts.rays, &mut hits);
        for (lane, hit) in firsts.lanes.iter().zip(&hits) {
            lane.hit.set(*hit);
        }
        if !windows.rays.is_empty() {
            let crossings = scene.crossings(&windows.rays);
            for (number, lane) in windows.lanes.iter().enumerate() {
                let mut crossed = lane.crossed.borrow_mut();
                crossed.clear();
                crossed.extend_from_slice(crossings.of_ray(number));
            }
        }
    }
}

/// Pending rays and their lanes.
#[derive(Default)]
struct Questions<'l> {
    lanes: Vec<&'l Lane>,
    rays: Vec<Ray>,
}

impl<'l> Questions<'l> {
    fn clear(&mut self) {
        self.lanes.clear();
        self.rays.clear();
    }

    fn push(&mut self, lane: &'l Lane, ray: Ray) {
        self.lanes.push(lane);
        self.rays.push(ray);
    }
}
