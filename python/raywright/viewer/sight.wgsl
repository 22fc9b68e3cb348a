// The scene along a ray of a picture, by gpu/walk.wgsl.

struct Look {
    // The ray at the upper left of the picture, and steps across it and down: origins of rays, and their directions.
    origin: vec4<f32>,
    origin_across: vec4<f32>,
    origin_down: vec4<f32>,
    way: vec4<f32>,
    way_across: vec4<f32>,
    way_down: vec4<f32>,
    // Vectors whose dot products with a place less the origin give its position across, down and along.
    across: vec4<f32>,
    down: vec4<f32>,
    along: vec4<f32>,
    // The lamp of a picture in movement; w is 1 for a place, 0 for a direction.
    lamp: vec4<f32>,
    // Width and height of the picture; the factor of the exposure; visits that the heat map shows as white.
    size: vec4<f32>,
    // The content, 0 the scene, 1 the heat map; the tone, 0 filmic, 1 linear; the first row of a band; nodes.
    mode: vec4<u32>,
    // The background.
    behind: vec4<f32>,
}

@group(0) @binding(0) var<storage, read> nodes: array<Node>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
// For each primitive a color, whose last byte is 255 if it emits, and its normal on an octahedron.
@group(0) @binding(2) var<storage, read> paints: array<vec2<u32>>;
@group(0) @binding(3) var<uniform> look: Look;

// Nodes read so far.
var<private> visits: u32;

fn node(i: u32) -> Node {
    visits++;
    return nodes[i];
}

fn triangle(i: u32) -> Triangle {
    return triangles[i];
}

struct Ray {
    origin: vec3<f32>,
    direction: vec3<f32>,
}

// The ray through a position in the picture, from (0, 0) at its upper left to (1, 1).
fn ray_through(place: vec2<f32>) -> Ray {
    let origin = look.origin + place.x * look.origin_across + place.y * look.origin_down;
    let way = look.way + place.x * look.way_across + place.y * look.way_down;
    return Ray(origin.xyz, normalize(way.xyz));
}

// A unit vector from its place on an octahedron (Cigolle et al., 2014).
fn unfolded(packed: u32) -> vec3<f32> {
    let e = unpack2x16snorm(packed);
    let z = 1.0 - abs(e.x) - abs(e.y);
    let folded = (1.0 - abs(e.yx)) * select(vec2<f32>(-1.0), vec2<f32>(1.0), e >= vec2<f32>(0.0));
    return normalize(vec3<f32>(select(folded, e, z >= 0.0), z));
}

const BY_LAMP: f32 = 0.8;
const BY_ALL: f32 = 0.2;

// The light along a ray of a picture in movement: one color per shape, one lamp and its shadow. It ignores the
// radiance of lamps, and so has no exposure.
fn sketched(ray: Ray, met: Met) -> vec3<f32> {
    if met.face == NOBODY {
        return look.behind.xyz;
    }
    let paint = paints[met.face];
    let color = unpack4x8unorm(paint.x);
    if color.w > 0.5 {
        return vec3<f32>(1.0);
    }
    var normal = unfolded(paint.y);
    if dot(normal, ray.direction) > 0.0 {
        normal = -normal;
    }
    let place = ray.origin + met.t * ray.direction;
    let way = look.lamp.xyz - look.lamp.w * place;
    let distance = max(length(way), 1e-18);
    let towards = way / distance;
    let facing = dot(normal, towards);
    // Surfaces turned away still differ by their orientation.
    var light = BY_ALL * (1.0 + 0.5 * dot(normal, -ray.direction));
    if facing > 0.0 {
        let start = place + normal * (64.0 * ULP * (length(place) + met.t + 2.0));
        // Short of the lamp, which has a surface.
        let reach = select(BEYOND, 0.98 * distance, look.lamp.w > 0.5);
        if !is_hidden(start, towards, reach, met.face, NOBODY, look.mode.w) {
            light += BY_LAMP * facing;
        }
    }
    return color.xyz * light;
}

// From black by blue, green and yellow to white, with rising brightness.
fn heat(share: f32) -> vec3<f32> {
    let x = 5.0 * clamp(share, 0.0, 1.0);
    var stops = array<vec3<f32>, 6>(
        vec3<f32>(0.0, 0.0, 0.02), vec3<f32>(0.05, 0.05, 0.45), vec3<f32>(0.0, 0.35, 0.45),
        vec3<f32>(0.15, 0.6, 0.1), vec3<f32>(0.95, 0.75, 0.05), vec3<f32>(1.0, 1.0, 0.95));
    let i = min(u32(x), 4u);
    return mix(stops[i], stops[i + 1u], x - f32(i));
}
