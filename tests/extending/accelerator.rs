use raywright::accel::walk::{Built, Input, Lists, Mailbox, Structure, Walker};
use raywright::accel::{Accelerator, BruteForce, Info, Primitives, SlabRay, walked};
use raywright::math::Aabb;
use raywright::simd::Level;

/// Boxes of eight primitives each, in the order of their centers along x, tested one after the other.
struct Slices(Vec<Aabb>);

fn slices(input: &Input) -> Built {
    let can_be_hit = |&p: &u32| !input.boxes[p as usize].is_empty();
    let mut order: Vec<u32> = (0..input.boxes.len() as u32).filter(can_be_hit).collect();
    let center = |p: &u32| input.boxes[*p as usize].min.x + input.boxes[*p as usize].max.x;
    order.sort_by(|a, b| center(a).total_cmp(&center(b)));
    let around = |some: &[u32]| some.iter().map(|&p| input.boxes[p as usize]).fold(Aabb::EMPTY, Aabb::union);
    let boxes = order.chunks(8).map(around).collect();
    (Box::new(Slices(boxes)), Lists::of(order.chunks(8)))
}

impl Structure for Slices {
    fn walker(&self, _counted: bool) -> Box<dyn Walker + '_> {
        Box::new(Walk { boxes: &self.0, ray: SlabRay::EVERYWHERE, next: 0 })
    }

    fn info(&self) -> Info {
        let bytes = size_of_val(&self.0[..]);
        Info { kind: "slices".to_owned(), leaves: self.0.len(), bytes, ..Info::default() }
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let is_within =
            |leaf: usize| primitives(leaf as u32).iter().all(|&p| self.0[leaf].contains(&input.boxes[p as usize]));
        (0..self.0.len()).all(is_within).then_some(()).ok_or_else(|| "a primitive is outside its box".to_owned())
    }
}

struct Walk<'a> {
    boxes: &'a [Aabb],
    ray: SlabRay,
    next: u32,
}

impl Walker for Walk<'_> {
    fn start(&mut self, ray: &SlabRay) {
        (self.ray, self.next) = (*ray, 0);
    }

    // The limit is where the closest hit so far lies.
    fn next(&mut self, limit: f32) -> Option<u32> {
        let rest = self.next..self.boxes.len() as u32;
        let found = rest.into_iter().find(|&leaf| self.ray.passes(&self.boxes[leaf as usize], limit).is_some());
        self.next = found.map_or(self.boxes.len() as u32, |leaf| leaf + 1);
        found
    }

    fn nodes(&self) -> u32 {
        0
    }
}

fn build(primitives: &dyn Primitives) -> Box<dyn Accelerator> {
    walked(primitives, Level::current().unwrap(), Mailbox::None, &slices)
}

#[test]
fn slices_find_what_brute_force_finds() {
    use raywright::math::{DVec3, Ray, Vec3};
    use raywright::scene::{Mesh, Scene, SceneDescription, Shape};

    let mut random = raywright::sampling::Sampler::new(1, 0, 0);
    let mut number = (0..).map(|i| random.one(i));
    let mut point = || DVec3::from_array([(); 3].map(|()| number.next().unwrap()));
    let vertices: Vec<Vec3> = (0..300).map(|i| (0.4 * point() + f64::from(i / 3) * 0.01).as_vec3()).collect();
    let faces = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut ray = || {
        let origin = 2.0 * point() - 0.5;
        // Towards the diagonal, along which the triangles lie.
        Ray::new(origin, DVec3::splat(point().x) - origin)
    };
    let rays: Vec<Ray> = (0..500).map(|_| ray()).collect();
    let hits = |build: &dyn Fn(&dyn Primitives) -> Box<dyn Accelerator>| {
        let mesh = Mesh { vertices: vertices.clone().into(), faces: Vec::clone(&faces), ..Mesh::default() };
        let shapes = vec![Shape { surface: mesh.into(), ..Shape::default() }];
        let scene = Scene::new(SceneDescription { shapes, ..SceneDescription::default() }, build).unwrap();
        let mut hits = vec![raywright::math::Hit::MISS; rays.len()];
        scene.intersect(&rays, &mut hits);
        hits
    };
    let found = hits(&build);
    assert!(found.iter().filter(|hit| hit.is_hit()).count() > 20);
    assert_eq!(found, hits(&|primitives| BruteForce::over(primitives, Level::current().unwrap())));
}
