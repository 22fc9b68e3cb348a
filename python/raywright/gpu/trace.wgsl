// Rays through flat arrays in f32: candidates for a ray's closest hit, and certain hits.
//
// Nothing here decides alone. A triangle is rejected only if it certainly is missed, and a hit only if it certainly is
// one. Any other triangle is a candidate, and the core decides about it in exact arithmetic. So every error needs a
// bound that holds on any device with WGSL's guarantees:
//
// - of + - *, either of the two neighbors of the true result: one ulp, at most U = 2^-23 of it; of a division 2.5;
// - numbers smaller than 2^-126 may be 0, before an operation and after it;
// - sums and products of one expression may be taken in any other order, and fused;
// - no infinity and no NaN: there is none, as no number exceeds 2^103.
//
// A `held` value passes through integers, which hide it from the compiler: it is a single rounded number.
//
// The numbers. Box units: every corner is at most 2 in every coordinate, and rounded to f32, by U/2 of itself. L is the
// largest coordinate of the ray's origin o, plus 2. The origin errs by U/2 of itself for rounding and by U/4 for being
// moved up to the scene. The direction d is at most 2, and errs by U/2 of itself. Edges e and f are at most E and F,
// and err by U/2 of themselves: of a sliver one is short. The bounds hold for the CPU's own t, which errs by at most
// 2^-26 (L + 2).
//
// Boxes. A plane lies at (plane - o) / d. The difference errs by U of itself, at most UL, the division by 2.5 U, the
// product by U, the sum with the pad by U, d by U/2: 6UL of distance; o by UL/2 + U/4; and the CPU's t, as a distance
// along an axis, by 2 2^-26 (L + 2). Together less than U(7L + 3). The pad is 8U(L + 1). Where a coordinate of d is
// less than 2^-60 it counts as that: along such an axis the ray moves by less than 2^-50, for which there is room.
//
// Weights, as Moeller and Trumbore (1997) have them: s = o - a from the corner a, u = s . (d x f), v = d . (s x e),
// their sum with that of the third edge, w, is the determinant e . (d x f). Let S be the largest coordinate of s. It
// errs by U(L/2 + 1/2) through o and a, and by US through the difference: it is held. Each of u, v and the
// determinant is the sum of six products of three numbers. In any order, each of these is rounded at most 7 times:
//
// - u: 6 2SF at most, times 7U: 84 USF; s errs by 6 2F U(L/2 + 1/2 + S) = UF(6L + 6 + 12S); d and the edge by
//   U/2 each, 12 USF. Together UF(108 S + 6(L + 1)); 128 S + 8(L + 1) is allowed. And so v, with E.
// - the determinant: 12 EF at most, times 7U: 84 UEF; d and both edges 18 UEF: 102 UEF; 128 is allowed.
// - w = determinant - u - v, all three held: their errors, and twice U of the sum of their bounds,
//   12 EF + 12 S(E + F): together U(E + F)(132 S + 6(L + 1)) + 126 UEF. 160 S + 8(L + 1), and 160, are allowed.
// - the numerator of t, f . (s x e): 6 SEF at most: 42 USEF; s 6 EF U(L/2 + 1/2 + S), edges 6 USEF: together
//   UEF(54 S + 3(L + 1)). 64 S + 4(L + 1) is allowed.
//
// Underflow below 2^-126 is, in each of at most 18 products, twice that times at most 2 + L, and once in each sum:
// less than 2^-118 (1 + L), which is added to all.
//
// t. With numerator n and determinant D, off by N and M, and |D| > 2M, n/D is off by (N + |n/D| M) / (|D| - M), and
// the division by 2.5U |n/D|. A sixteenth more than that is allowed, 4U |n/D|, and 2^-25 (L + 4) for the CPU's t.
// Neither can be large: |n/D| <= 6 SEF / 256 UEF < 2^23.
//
// All bounds are themselves computed in f32, and err by some U of themselves, for which each has room.
// tests/python/gpu/test_gpu_bounds.py checks them against the worst possible arithmetic.

struct Node {
    lower: vec3<u32>,
    index: u32,
    upper: vec3<u32>,
    count: u32,
}

struct Triangle {
    corner: vec3<u32>,
    primitive: u32,
    edge: vec3<u32>,
    largest: u32,
    other: vec3<u32>,
    instance: u32,
}

struct Ray {
    origin: vec3<f32>,
    t_min: f32,
    direction: vec3<f32>,
    t_max: f32,
}

struct Job {
    // 0, unknown to the compiler.
    zero: u32,
    rays: u32,
    nodes: u32,
    reserved: u32,
}

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read> rays: array<Ray>;
@group(0) @binding(2) var<storage, read_write> answers: array<ANSWER>;
BINDINGS

const U: f32 = SCALE * 1.1920928955078125e-07;
// 2^-118: the loss by flushing.
const LEAST: f32 = SCALE * 3.009265538105056e-36;
const TINY: f32 = 8.673617379884035e-19;
const FOREVER: f32 = 1.2676506002282294e30;
// Greater than any t.
const BEYOND: f32 = 2.535301200456459e30;

const NONE: u32 = 0xffffffffu;
const OVERFLOW: u32 = 0xfffffffeu;
const CERTAIN: u32 = 0xfffffffdu;

fn held(v: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(v) ^ vec3<u32>(job.zero));
}

fn held_one(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ job.zero);
}

fn number(bits: u32) -> f32 {
    return bitcast<f32>(bits);
}

fn vector(bits: vec3<u32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bits);
}

fn largest(v: vec3<f32>) -> f32 {
    let size = abs(v);
    return max(size.x, max(size.y, size.z));
}

// A ray with precomputed values for box tests.
struct Slabs {
    origin: vec3<f32>,
    direction: vec3<f32>,
    t_min: f32,
    t_max: f32,
    inverse: vec3<f32>,
    room: vec3<f32>,
    // L.
    reach: f32,
}

fn slabs(ray: Ray) -> Slabs {
    let d = ray.direction;
    let away = select(vec3<f32>(TINY), vec3<f32>(-TINY), d < vec3<f32>(0.0));
    let inverse = 1.0 / select(d, away, abs(d) < vec3<f32>(TINY));
    let reach = largest(ray.origin) + 2.0;
    let room = 8.0 * U * (reach + 1.0) * abs(inverse);
    return Slabs(ray.origin, d, ray.t_min, ray.t_max, inverse, room, reach);
}

// Distances where a ray enters a box, and where it leaves it or reaches a limit: if the first is greater, it misses.
fn passes(ray: Slabs, lower: vec3<f32>, upper: vec3<f32>, limit: f32) -> vec2<f32> {
    let a = held(lower - ray.origin) * ray.inverse;
    let b = held(upper - ray.origin) * ray.inverse;
    let near = min(a, b) - ray.room;
    let far = max(a, b) + ray.room;
    let enter = max(max(near.x, near.y), max(near.z, ray.t_min));
    let leave = min(min(far.x, far.y), min(far.z, limit));
    return vec2<f32>(enter, leave);
}

// Results of a ray and a primitive of a leaf: whether a hit is possible, whether it is certain, and bounds of its t.
struct Meeting {
    possible: bool,
    certain: bool,
    low: f32,
    high: f32,
}

fn meet(ray: Slabs, triangle: Triangle, enter: f32, limit: f32) -> Meeting {
    if number(triangle.largest) < 0.0 {
        // No triangle: only its box is known.
        let within = passes(ray, vector(triangle.corner), vector(triangle.edge), limit);
        return Meeting(within.x <= within.y, false, within.x, BEYOND);
    }
    let e = vector(triangle.edge);
    let f = vector(triangle.other);
    let d = ray.direction;
    let s = held(ray.origin - vector(triangle.corner));
    let p = cross(d, f);
    let q = cross(s, e);
    let u = held_one(dot(s, p));
    let v = held_one(dot(d, q));
    let determinant = held_one(dot(e, p));
    let w = determinant - u - v;
    let reach = ray.reach + 1.0;
    let S = largest(s);
    let least = LEAST * reach;
    let E = largest(e);
    let F = largest(f);
    let of_u = U * F * (128.0 * S + 8.0 * reach) + least;
    let of_v = U * E * (128.0 * S + 8.0 * reach) + least;
    let of_w = U * ((E + F) * (160.0 * S + 8.0 * reach) + 160.0 * E * F) + least;
    let above = u > of_u || v > of_v || w > of_w;
    let below = u < -of_u || v < -of_v || w < -of_w;
    if above && below {
        return Meeting(false, false, enter, BEYOND);
    }
    let M = 128.0 * U * E * F + least;
    let room = abs(determinant) - M;
    if room <= M {
        return Meeting(true, false, enter, BEYOND);
    }
    let t = dot(f, q) / determinant;
    let N = U * E * F * (64.0 * S + 4.0 * reach) + least;
    let error = 1.0625 * ((N + abs(t) * M) / room) + 4.0 * U * abs(t) + 0.25 * U * (reach + 3.0);
    let low = t - error;
    let high = t + error;
    if high < ray.t_min || low > limit {
        return Meeting(false, false, low, high);
    }
    let all_above = u > of_u && v > of_v && w > of_w;
    let all_below = u < -of_u && v < -of_v && w < -of_w;
    // Ends of the ray are rounded outwards, by up to 2^-21 of themselves.
    let begins = ray.t_min + 8.0 * U * abs(ray.t_min);
    let ends = ray.t_max - 8.0 * U * abs(ray.t_max);
    let certain = (all_above || all_below) && low >= begins && high <= ends;
    return Meeting(true, certain, max(low, enter), high);
}
