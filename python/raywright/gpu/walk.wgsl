// Rays through flat arrays in f32, for pictures: closest hits and occlusion.
//
// The including shader has node(i) -> Node and triangle(i) -> Triangle, the arrays of `FlatArrays`. A ray skips up to
// two faces by number, its own origin and target. Unlike trace.wgsl, this decides despite rounding: a ray hits both
// faces at an edge, so that none passes between them, and at equal t the lowest number wins.

struct Node {
    lower: vec3<f32>,
    index: u32,
    upper: vec3<f32>,
    count: u32,
}

struct Triangle {
    corner: vec3<f32>,
    primitive: u32,
    edge: vec3<f32>,
    largest: f32,
    other: vec3<f32>,
    instance: u32,
}

const ULP: f32 = 1.1920928955078125e-07;
const NOBODY: u32 = 0xffffffffu;
const BEYOND: f32 = 1e30;

struct Slabs {
    origin: vec3<f32>,
    reach: f32,
    direction: vec3<f32>,
    inverse: vec3<f32>,
    room: vec3<f32>,
}

fn slabs(origin: vec3<f32>, direction: vec3<f32>) -> Slabs {
    let least = 1e-18;
    let away = select(vec3<f32>(least), vec3<f32>(-least), direction < vec3<f32>(0.0));
    let inverse = 1.0 / select(direction, away, abs(direction) < vec3<f32>(least));
    let size = abs(origin);
    let reach = max(size.x, max(size.y, size.z)) + 2.0;
    return Slabs(origin, reach, direction, inverse, 8.0 * ULP * (reach + 1.0) * abs(inverse));
}

// Distances where a ray enters a box, and where it leaves it or reaches a limit.
fn passes(ray: Slabs, lower: vec3<f32>, upper: vec3<f32>, limit: f32) -> vec2<f32> {
    let a = (lower - ray.origin) * ray.inverse;
    let b = (upper - ray.origin) * ray.inverse;
    let near = min(a, b) - ray.room;
    let far = max(a, b) + ray.room;
    return vec2<f32>(max(max(near.x, near.y), max(near.z, 0.0)), min(min(far.x, far.y), min(far.z, limit)));
}

// The t of a ray's hit with a triangle (Moeller and Trumbore, 1997), or a negative number. Edges have a margin for
// rounding.
fn met_at(ray: Slabs, one: Triangle) -> f32 {
    let s = ray.origin - one.corner;
    let p = cross(ray.direction, one.other);
    let q = cross(s, one.edge);
    let determinant = dot(one.edge, p);
    let sign = select(-1.0, 1.0, determinant > 0.0);
    let u = sign * dot(s, p);
    let v = sign * dot(ray.direction, q);
    let size = abs(s);
    let far = 4.0 * ULP * (max(size.x, max(size.y, size.z)) + 0.25 * ray.reach);
    let e = length(one.edge);
    let f = length(one.other);
    if u < -far * f || v < -far * e || sign * determinant - u - v < -far * (e + f) {
        return -1.0;
    }
    if abs(determinant) < 4.0 * ULP * e * f {
        return -1.0;
    }
    return dot(one.other, q) / determinant;
}

struct Met {
    t: f32,
    face: u32,
}

// The closest hit: the nearer child first, the other on a stack.
fn nearest(origin: vec3<f32>, direction: vec3<f32>, from_face: u32, nodes: u32) -> Met {
    var best = Met(BEYOND, NOBODY);
    if nodes == 0u {
        return best;
    }
    let ray = slabs(origin, direction);
    var stack: array<u32, STACK>;
    var enters: array<f32, STACK>;
    var size = 0u;
    var at = 0u;
    let root = node(0u);
    let first = passes(ray, root.lower, root.upper, best.t);
    if first.x > first.y {
        return best;
    }
    loop {
        let here = node(at);
        var go_on = false;
        if here.count > 0u {
            for (var i = here.index; i < here.index + here.count; i++) {
                let one = triangle(i);
                let t = met_at(ray, one);
                let same = 2.0 * ULP * (ray.reach + t);
                let is_first = t < best.t - same || (t < best.t + same && one.primitive < best.face);
                if t >= 0.0 && one.primitive != from_face && is_first {
                    best = Met(t, one.primitive);
                }
            }
        } else {
            let a = at + 1u;
            let left = node(a);
            let b = select(left.index, a + 1u, left.count > 0u);
            let right = node(b);
            let to_left = passes(ray, left.lower, left.upper, best.t);
            let to_right = passes(ray, right.lower, right.upper, best.t);
            let meets_left = to_left.x <= to_left.y;
            let meets_right = to_right.x <= to_right.y;
            go_on = meets_left || meets_right;
            if meets_left && meets_right {
                let left_first = to_left.x <= to_right.x;
                stack[size] = select(a, b, left_first);
                enters[size] = select(to_left.x, to_right.x, left_first);
                size++;
                at = select(b, a, left_first);
            } else {
                at = select(b, a, meets_left);
            }
        }
        while !go_on && size > 0u {
            size--;
            at = stack[size];
            go_on = enters[size] <= best.t;
        }
        if !go_on {
            break;
        }
    }
    return best;
}

// True if anything is hit before a t: in the order of nodes.
fn is_hidden(origin: vec3<f32>, direction: vec3<f32>, t_max: f32, from_face: u32, to_face: u32, nodes: u32) -> bool {
    let ray = slabs(origin, direction);
    var at = 0u;
    while at < nodes {
        let here = node(at);
        let within = passes(ray, here.lower, here.upper, t_max);
        if within.x > within.y {
            at = select(here.index, at + 1u, here.count > 0u);
            continue;
        }
        for (var i = 0u; i < here.count; i++) {
            let one = triangle(here.index + i);
            let t = met_at(ray, one);
            if t >= 0.0 && t < t_max && one.primitive != from_face && one.primitive != to_face {
                return true;
            }
        }
        at++;
    }
    return false;
}
