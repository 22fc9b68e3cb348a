// What is seen along a ray, for pictures: after trace.wgsl, whose tests of boxes and triangles it takes. What f32 cannot
// tell counts as hit.

struct Look {
    // The ray at the upper left of the picture, what is added across it and down: where rays start, and their ways.
    origin: vec4<f32>,
    origin_across: vec4<f32>,
    origin_down: vec4<f32>,
    way: vec4<f32>,
    way_across: vec4<f32>,
    way_down: vec4<f32>,
    // What a place less the origin is dotted with for how far across and down it is seen, and how far along.
    across: vec4<f32>,
    down: vec4<f32>,
    along: vec4<f32>,
    // The lamp of a picture in movement; w is 1 for a place, 0 for a direction.
    lamp: vec4<f32>,
    // Width and height of the picture; the factor of the exposure; visits that are the brightest of the heat map.
    size: vec4<f32>,
    // What is drawn: 0 the scene, 1 the heat map; the tone: 0 filmic, 1 linear; the first row of a band; the sample.
    mode: vec4<u32>,
}

@group(0) @binding(5) var<uniform> look: Look;
@group(0) @binding(6) var<storage, read> paints: array<u32>;

// Primitives that rays leave, and end at, which they do not meet.
var<private> departed: vec2<u32> = vec2<u32>(NONE, NONE);

struct Hit {
    t: f32,
    // The triangle, by its place; NONE for none.
    at: u32,
    visits: u32,
}

// Where along a ray the plane of a triangle is. The bounds of `meet` lie around it, but for those that boxes tell.
fn distance_to(ray: Slabs, triangle: Triangle) -> f32 {
    let s = ray.origin - vector(triangle.corner);
    let across = cross(vector(triangle.edge), vector(triangle.other));
    return -dot(s, across) / dot(ray.direction, across);
}

fn first_hit(ray: Slabs) -> Hit {
    var hit = Hit(FOREVER, NONE, 1u);
    var stack: array<u32, STACK>;
    var enters: array<f32, STACK>;
    var size = 0u;
    var at = 0u;
    let root = node(0u);
    let first = passes(ray, vector(root.lower), vector(root.upper), ray.t_max);
    if first.x > first.y {
        return hit;
    }
    var enter = first.x;
    loop {
        let here = node(at);
        var go_on = false;
        if here.count > 0u {
            for (var i = here.index; i < here.index + here.count; i++) {
                let one = triangle(i);
                let met = meet(ray, one, enter, hit.t);
                if met.possible && met.high < BEYOND && all(departed != vec2<u32>(one.primitive)) {
                    let t = distance_to(ray, one);
                    if t > ray.t_min && t < hit.t {
                        hit.t = t;
                        hit.at = i;
                    }
                }
            }
        } else {
            let a = at + 1u;
            let left = node(a);
            let b = select(left.index, a + 1u, left.count > 0u);
            let right = node(b);
            hit.visits += 2u;
            let to_left = passes(ray, vector(left.lower), vector(left.upper), hit.t);
            let to_right = passes(ray, vector(right.lower), vector(right.upper), hit.t);
            let meets_left = to_left.x <= to_left.y;
            let meets_right = to_right.x <= to_right.y;
            if meets_left && meets_right {
                let left_first = to_left.x <= to_right.x;
                stack[size] = select(a, b, left_first);
                enters[size] = select(to_left.x, to_right.x, left_first);
                size++;
                at = select(b, a, left_first);
                enter = select(to_right.x, to_left.x, left_first);
                go_on = true;
            } else if meets_left {
                at = a;
                enter = to_left.x;
                go_on = true;
            } else if meets_right {
                at = b;
                enter = to_right.x;
                go_on = true;
            }
        }
        while !go_on && size > 0u {
            size--;
            at = stack[size];
            enter = enters[size];
            go_on = enter < hit.t;
        }
        if !go_on {
            break;
        }
    }
    return hit;
}

// Whether anything lies between, along the nodes as they lie (Smits 1998).
fn is_hidden(ray: Slabs) -> bool {
    var at = 0u;
    while at < job.nodes {
        let here = node(at);
        let within = passes(ray, vector(here.lower), vector(here.upper), ray.t_max);
        if within.x > within.y {
            at = select(here.index, at + 1u, here.count > 0u);
            continue;
        }
        for (var i = 0u; i < here.count; i++) {
            let one = triangle(here.index + i);
            let met = meet(ray, one, within.x, ray.t_max);
            if met.possible && met.high < BEYOND && all(departed != vec2<u32>(one.primitive)) {
                let t = distance_to(ray, one);
                if t > ray.t_min && t < ray.t_max {
                    return true;
                }
            }
        }
        at++;
    }
    return false;
}

// The ray through a place of the picture, from (0, 0) at its upper left to (1, 1).
fn ray_through(place: vec2<f32>) -> Slabs {
    let origin = look.origin + place.x * look.origin_across + place.y * look.origin_down;
    let way = look.way + place.x * look.way_across + place.y * look.way_down;
    return slabs(Ray(origin.xyz, 0.0, normalize(way.xyz), FOREVER));
}

// How far a point may be off its surface, and what begins there is moved away from it.
fn off_surface(p: vec3<f32>) -> f32 {
    return 64.0 * 1.1920928955078125e-07 * (largest(p) + 2.0);
}

const BY_LAMP: f32 = 0.8;
const BY_ALL: f32 = 0.2;
// What surrounds the scene.
const BEHIND = vec3<f32>(0.012, 0.013, 0.015);

// The light along a ray of a picture in movement: a colour of each shape, one lamp and its shadow.
fn sketched(ray: Slabs, hit: Hit) -> vec3<f32> {
    if hit.at == NONE {
        return BEHIND;
    }
    let one = triangle(hit.at);
    let paint = unpack4x8unorm(paints[one.primitive]);
    if paint.w > 0.5 {
        return vec3<f32>(1.0);
    }
    let across = cross(vector(one.edge), vector(one.other));
    var normal = normalize(across / max(largest(across), TINY));
    if dot(normal, ray.direction) > 0.0 {
        normal = -normal;
    }
    let place = ray.origin + hit.t * ray.direction;
    let off = off_surface(place);
    let start = place + off * normal;
    departed = vec2<u32>(one.primitive, NONE);
    let way = look.lamp.xyz - look.lamp.w * start;
    let distance = length(way);
    let towards = way / max(distance, TINY);
    let lit = dot(normal, towards);
    // What is turned away still differs by where it faces.
    var light = BY_ALL * (1.0 + 0.5 * dot(normal, -ray.direction));
    if lit > 0.0 {
        // Not up to the lamp: that has a surface.
        let reach = select(FOREVER, 0.98 * distance, look.lamp.w > 0.5);
        if !is_hidden(slabs(Ray(start, off, towards, reach))) {
            light += BY_LAMP * lit;
        }
    }
    return paint.xyz * light;
}

// From black by blue, green and yellow to white, each brighter than the one before.
fn heat(share: f32) -> vec3<f32> {
    let x = 5.0 * clamp(share, 0.0, 1.0);
    var stops = array<vec3<f32>, 6>(
        vec3<f32>(0.0, 0.0, 0.02), vec3<f32>(0.05, 0.05, 0.45), vec3<f32>(0.0, 0.35, 0.45),
        vec3<f32>(0.15, 0.6, 0.1), vec3<f32>(0.95, 0.75, 0.05), vec3<f32>(1.0, 1.0, 0.95));
    let i = min(u32(x), 4u);
    return mix(stops[i], stops[i + 1u], x - f32(i));
}
