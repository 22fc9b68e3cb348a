// Path tracing in one kernel per stage (Laine, Karras and Aila, "Megakernels Considered Harmful", 2013): camera rays,
// intersection, scattering by kind of surface, shadow rays, and film. Between stages, paths wait in lists by their next
// kernel.
//
// Like the CPU's paths, these sample one light at each surface, weigh it against hits of emitters by the power
// heuristic (Veach and Guibas, 1995), and end by Russian roulette.

struct Job {
    // Position of the camera, direction to the upper left of its film, and along its rows and columns to the other
    // ends.
    eye: vec3<f32>,
    // 0, unknown to the compiler.
    zero: u32,
    corner: vec3<f32>,
    width: u32,
    across: vec3<f32>,
    height: u32,
    down: vec3<f32>,
    nodes: u32,
    // The current batch: samples from a number on of some pixels. Path i belongs to pixel i % pixels.
    first_pixel: u32,
    pixels: u32,
    first_sample: u32,
    samples: u32,
    max_depth: u32,
    roulette_depth: u32,
    seed: vec2<u32>,
    // The current one of two ray lists, and the capacity of lists.
    now: u32,
    capacity: u32,
    // Index in the numbers of the filter's quantiles: 1025, in pixels from a pixel's center.
    quantiles: u32,
    reserved: u32,
}

struct Path {
    origin: vec3<f32>,
    // The face that the ray leaves, or NO.
    leaves: u32,
    direction: vec3<f32>,
    // The density of the sampled direction, or SINGLE.
    pdf: f32,
    throughput: vec3<f32>,
    // The factor of radiance due to indices of refraction alone.
    scale: f32,
    radiance: vec3<f32>,
    bounce: u32,
    // The face that the ray hits.
    face: u32,
    // Number of consecutive internal reflections in glass.
    held: u32,
    // 1 after a metal whose reflectance may exceed 1.
    gilded: u32,
    reserved: u32,
}

// A shadow ray, and its contribution if unoccluded.
struct Shadow {
    origin: vec3<f32>,
    t_max: f32,
    direction: vec3<f32>,
    path: u32,
    brings: vec3<f32>,
    leaves: u32,
    to_face: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

// Sums of a pixel's samples and of their squares, each in two numbers, the largest, and the count of invalid ones.
struct Pixel {
    sum: vec3<f32>,
    dropped: u32,
    sum_rest: vec3<f32>,
    reserved_a: u32,
    squares: vec3<f32>,
    reserved_b: u32,
    squares_rest: vec3<f32>,
    reserved_c: u32,
    largest: vec3<f32>,
    reserved_d: u32,
}

// Lists, by number: current rays and following rays, those that leave the scene, and kinds of surfaces.
const SKY: u32 = 2u;
const MATT: u32 = 3u;
const OTHERS: u32 = 4u;
const BRUSHED: u32 = 5u;
const FROSTED: u32 = 6u;
const TO_LIGHT: u32 = 7u;

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<uniform> lit: Lit;
@group(0) @binding(2) var<storage, read_write> paths: array<Path>;
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>, 8>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
@group(0) @binding(5) var<storage, read_write> groups: array<vec4<u32>, 8>;
@group(0) @binding(6) var<storage, read_write> shadows: array<Shadow>;
@group(0) @binding(7) var<storage, read_write> film: array<Pixel>;
BINDINGS

// Random numbers of a path, for one purpose at a bounce.
fn numbers_of(i: u32, purpose: u32) -> vec4<f32> {
    let pixel = job.first_pixel + i % job.pixels;
    let sample = job.first_sample + i / job.pixels;
    return uniform_numbers(vec4<u32>(pixel ^ job.seed.y, sample, purpose, job.seed.x));
}

fn put(list: u32, i: u32) {
    lists[list * job.capacity + atomicAdd(&counts[list], 1u)] = i;
}

// The path at an index of a list; NO beyond its end.
fn taken(list: u32, place: u32) -> u32 {
    if place >= atomicLoad(&counts[list]) {
        return NO;
    }
    return lists[list * job.capacity + place];
}

// Offset of a filter sample from the pixel's center, along an axis.
fn offset(u: f32) -> f32 {
    let place = u * 1024.0;
    let i = min(u32(place), 1023u);
    return mix(number(job.quantiles + i), number(job.quantiles + i + 1u), place - f32(i));
}

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i >= job.pixels * job.samples {
        return;
    }
    let pixel = job.first_pixel + i % job.pixels;
    let u = numbers_of(i, 0u);
    let x = (f32(pixel % job.width) + 0.5 + offset(u.x)) / f32(job.width);
    let y = (f32(pixel / job.width) + 0.5 + offset(u.y)) / f32(job.height);
    var path: Path;
    path.origin = job.eye;
    path.leaves = NO;
    path.direction = normalize(job.corner + job.across * x + job.down * y);
    path.pdf = SINGLE;
    path.throughput = vec3<f32>(1.0);
    path.scale = 1.0;
    paths[i] = path;
    put(job.now, i);
}

@compute @workgroup_size(64)
fn find_closest(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = taken(job.now, id.x);
    if i == NO {
        return;
    }
    let met = nearest(paths[i].origin, paths[i].direction, paths[i].leaves, job.nodes);
    paths[i].face = met.face;
    if met.face == NOBODY {
        put(SKY, i);
        return;
    }
    // The front's and the back's may differ in kind.
    let one = face(met.face);
    let is_back = dot(cross(one.edge, one.other), paths[i].direction) > 0.0;
    let kind = material(one.material + select(0u, 1u, is_back)).kind;
    switch kind {
        case DIFFUSE: { put(MATT, i); }
        case ROUGH_METAL: { put(BRUSHED, i); }
        case ROUGH_GLASS: { put(FROSTED, i); }
        default: { put(OTHERS, i); }
    }
}

// Number of workgroups for a list. Used lists are emptied.
fn plan(list: u32) {
    groups[list] = vec4<u32>((atomicLoad(&counts[list]) + 63u) / 64u, 1u, 1u, 0u);
}

@compute @workgroup_size(1)
fn plan_shading() {
    for (var list = SKY; list <= FROSTED; list++) {
        plan(list);
    }
    atomicStore(&counts[job.now], 0u);
    atomicStore(&counts[TO_LIGHT], 0u);
}

@compute @workgroup_size(1)
fn plan_rays() {
    plan(1u - job.now);
    plan(TO_LIGHT);
    for (var list = SKY; list <= FROSTED; list++) {
        atomicStore(&counts[list], 0u);
    }
}

// For generated camera rays.
@compute @workgroup_size(1)
fn plan_first() {
    plan(job.now);
}

@compute @workgroup_size(64)
fn add_outside(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = taken(SKY, id.x);
    if i == NO || SKY_KIND == 0u {
        return;
    }
    let direction = paths[i].direction;
    let pdf = paths[i].pdf;
    var weight = 1.0;
    if pdf != SINGLE {
        weight = beside(pdf, lit.sky_share * sky_pdf(direction));
    }
    paths[i].radiance += paths[i].throughput * sky_radiance(direction) * weight;
}

// Greatest survival probability of light after this many consecutive internal reflections, as in the core: it
// contributes nothing. Here that applies to rough glass as well, since all wait for the last path.
fn kept(held: u32) -> f32 {
    return select(1.0, 1.0 - 1.0 / 32.0, held >= 64u);
}

// For a kind known to the compiler, or for any with NO.
fn leave(i: u32, kind: u32) {
    var path = paths[i];
    let at = surface_at(path.face, path.origin, path.direction);
    var looks = material_at(at);
    if kind != NO {
        looks.kind = kind;
    }
    let shown = emitted(at, path.direction);
    if most(shown) > 0.0 {
        var weight = 1.0;
        if path.pdf != SINGLE {
            weight = beside(path.pdf, emitted_pdf(at, path.origin, path.direction));
        }
        path.radiance += path.throughput * shown * weight;
        paths[i].radiance = path.radiance;
    }
    if path.bounce >= job.max_depth {
        return;
    }
    let color = color_at(looks, at.uv);
    if is_metal(looks) && any(looks.color != vec3<f32>(1.0)) {
        path.throughput *= select(vec3<f32>(1.0), looks.color, path.gilded == 1u);
        path.gilded = 1u;
    }
    if !is_single(looks) {
        let u = numbers_of(i, 2u * path.bounce + 1u);
        let arriving = from_lights(at.position, u.x, u.yz);
        if arriving.pdf != 0.0 {
            let by = scattered_at(at, looks, color, arriving.direction);
            var brings = path.throughput * by.value * arriving.radiance;
            if arriving.pdf != SINGLE {
                brings *= beside(arriving.pdf, by.pdf) / arriving.pdf;
            }
            if most(brings) > 0.0 {
                var shadow: Shadow;
                shadow.origin = leaving(at, arriving.direction);
                shadow.t_max = select(arriving.distance * (1.0 - 4.0 * ULP) - at.room, FAR, arriving.distance == FAR);
                shadow.direction = arriving.direction;
                shadow.path = i;
                shadow.brings = brings;
                shadow.leaves = at.face;
                shadow.to_face = arriving.face;
                shadows[atomicAdd(&counts[TO_LIGHT], 1u)] = shadow;
            }
        }
    }
    let u = numbers_of(i, 2u * path.bounce + 2u);
    let next = drawn_at(at, looks, color, u.x, u.yz);
    path.throughput *= next.weight;
    if next.pdf == 0.0 || most(path.throughput) <= 0.0 {
        return;
    }
    path.scale *= next.eta * next.eta;
    let is_glass = looks.kind == GLASS || looks.kind == ROUGH_GLASS;
    path.held = select(0u, path.held + 1u, is_glass && next.eta == 1.0);
    path.bounce++;
    if path.bounce >= job.roulette_depth {
        let survival = min(min(sqrt(most(path.throughput) * path.scale), 1.0 - 1.0 / 4096.0), kept(path.held));
        if u.w >= survival {
            return;
        }
        path.throughput /= survival;
    }
    path.origin = leaving(at, next.wi);
    path.leaves = at.face;
    path.direction = next.wi;
    path.pdf = next.pdf;
    paths[i] = path;
    put(1u - job.now, i);
}

@compute @workgroup_size(64)
fn leave_matte(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = taken(MATT, id.x);
    if i != NO {
        leave(i, DIFFUSE);
    }
}

@compute @workgroup_size(64)
fn leave_any(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = taken(OTHERS, id.x);
    if i != NO {
        leave(i, NO);
    }
}

@compute @workgroup_size(64)
fn leave_brushed(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = taken(BRUSHED, id.x);
    if i != NO {
        leave(i, ROUGH_METAL);
    }
}

@compute @workgroup_size(64)
fn leave_frosted(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = taken(FROSTED, id.x);
    if i != NO {
        leave(i, ROUGH_GLASS);
    }
}

@compute @workgroup_size(64)
fn follow_shadows(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&counts[TO_LIGHT]) {
        return;
    }
    let one = shadows[id.x];
    if !is_hidden(one.origin, one.direction, one.t_max, one.leaves, one.to_face, job.nodes) {
        paths[one.path].radiance += one.brings;
    }
}

// Passes through integers, which hide it from the compiler: a single rounded number.
fn held(v: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(v) ^ vec3<u32>(job.zero));
}

// Rounding error of a sum (Knuth, "The Art of Computer Programming", volume 2).
fn left_out(a: vec3<f32>, b: vec3<f32>, sum: vec3<f32>) -> vec3<f32> {
    let of_b = held(sum - a);
    let of_a = held(sum - of_b);
    return held(a - of_a) + held(b - of_b);
}

fn is_radiance(color: vec3<f32>) -> bool {
    let bits = bitcast<vec3<u32>>(color) & vec3<u32>(0x7f800000u);
    // At most 2^60, so that squares are finite.
    return all(bits <= vec3<u32>(0x5d800000u)) && all(color >= vec3<f32>(0.0));
}

// Adds up the paths of each pixel.
@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.pixels {
        return;
    }
    var pixel = film[id.x];
    for (var s = 0u; s < job.samples; s++) {
        let sample = paths[s * job.pixels + id.x].radiance;
        if !is_radiance(sample) {
            pixel.dropped++;
            continue;
        }
        let sum = held(pixel.sum + sample);
        pixel.sum_rest += left_out(pixel.sum, sample, sum);
        pixel.sum = sum;
        let square = held(sample * sample);
        let squares = held(pixel.squares + square);
        pixel.squares_rest += left_out(pixel.squares, square, squares);
        pixel.squares = squares;
        if most(sample) > most(pixel.largest) {
            pixel.largest = sample;
        }
    }
    film[id.x] = pixel;
}
