// Surfaces and lights in f32: hit points, scattering, and light samples.
//
// The including shader has bindings and these functions: face(i) -> Face, material(i) -> Material, light(i) -> Light
// and number(i) -> f32, which read the arrays of packing.py, `lit`, a Lit, and the constants of `known_lit`. All
// lengths are in box units (see `FlatArrays`). Nothing here is an extension: it runs in browsers too.
//
// The scattering functions are those of the core (rust/optics), with the same sampling densities unless stated. In a
// shading frame z is on the side of the winding's normal; directions point away from the surface.

const PI: f32 = 3.14159265358979;
const INVERSE_PI: f32 = 0.318309886183791;
const NO: u32 = 0xffffffffu;

// Delta distributions: mirrors, panes, points of light.
const SINGLE: f32 = -1.0;

struct Face {
    corner: vec3<f32>,
    // Index of the front's material; the back's is the next.
    material: u32,
    edge: vec3<f32>,
    // Index of its light, or NO.
    light: u32,
    other: vec3<f32>,
    // 1: it has normals, 2: it has texture coordinates.
    has: u32,
    normal_a: vec3<f32>,
    u_a: f32,
    normal_b: vec3<f32>,
    u_b: f32,
    normal_c: vec3<f32>,
    u_c: f32,
    v: vec3<f32>,
    reserved: f32,
}

const DIFFUSE: u32 = 0u;
const MIRROR: u32 = 1u;
const GLASS: u32 = 2u;
const METAL: u32 = 3u;
const ROUGH_METAL: u32 = 4u;
const ROUGH_GLASS: u32 = 5u;
const PLASTIC: u32 = 6u;

struct Material {
    // For metals, the factor of each reflection after the first.
    color: vec3<f32>,
    kind: u32,
    // For metals, with k, or 0 if a table replaces both; for glass the first is the index below over that above.
    eta: vec3<f32>,
    alpha: f32,
    k: vec3<f32>,
    // Index in the numbers of its reflectances.
    table: u32,
    // For metals, the multiple scattering between facets, over pi and the mean loss. For rough glass, one over pi and
    // the mean loss above and below; k has the shares of that which cross from there.
    multiple: vec3<f32>,
    // Index in the numbers of the loss by facets; for rough glass above, then below; for rough plastic the reflectance
    // of its coat (mean in k), then the one from within.
    losses: u32,
    // Index in the numbers of its picture, or NO.
    picture: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

// Kinds of lights.
const LAMP: u32 = 0u;
const POINT: u32 = 1u;
const DIRECTION: u32 = 2u;

struct Light {
    radiance: vec3<f32>,
    kind: u32,
    // Position of a point; direction to a distant light.
    place: vec3<f32>,
    face: u32,
    // Cumulative probability up to this light, and its own.
    until: f32,
    share: f32,
    area: f32,
    // 1: its front emits, 2: its back.
    sides: u32,
}

// Lighting of a scene.
struct Lit {
    // Radiance of the sky; for a picture its factor.
    sky: vec3<f32>,
    lights: u32,
    // Rotation to the picture's space, by rows, each followed by another number.
    to_picture_x: vec3<f32>,
    // 0: no sky, 1: constant, 2: a picture.
    sky_kind: u32,
    to_picture_y: vec3<f32>,
    sky_width: u32,
    to_picture_z: vec3<f32>,
    sky_height: u32,
    // Index of its colors among the numbers, row by row, and of the cumulative light: by row, then within each row by
    // column.
    sky_colors: u32,
    sky_shares: u32,
    // Probability to sample the sky.
    sky_share: f32,
    reserved: u32,
}

// Random numbers: a hash of their purpose (Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020).
fn hashed(key: vec4<u32>) -> vec4<u32> {
    var v = key * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> vec4<u32>(16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Four numbers in (0, 1).
fn uniform_numbers(key: vec4<u32>) -> vec4<f32> {
    return (vec4<f32>(hashed(key) >> vec4<u32>(9u)) + 0.5) * 1.1920928955078125e-07;
}

// Cosine and sine of 0 to 1 turns, by polynomials: built-in ones may be off by 2^-11.
fn turned(turns: f32) -> vec2<f32> {
    let quarter = floor(4.0 * turns + 0.5);
    let x = (turns - 0.25 * quarter) * (2.0 * PI);
    let x2 = x * x;
    let s = x * (1.0 + x2 * (-0.166666667 + x2 * (8.33333333e-3 + x2 * (-1.98412698e-4 + x2 * 2.75573192e-6))));
    let c = 1.0 + x2 * (-0.5 + x2 * (4.16666667e-2 + x2 * (-1.38888889e-3 + x2 * 2.48015873e-5)));
    switch u32(quarter) & 3u {
        case 0u: { return vec2<f32>(c, s); }
        case 1u: { return vec2<f32>(-s, c); }
        case 2u: { return vec2<f32>(-c, -s); }
        default: { return vec2<f32>(s, -c); }
    }
}

fn most(color: vec3<f32>) -> f32 {
    return max(color.x, max(color.y, color.z));
}

// The power heuristic's weight beside another sampling density (Veach and Guibas, 1995).
fn beside(mine: f32, other: f32) -> f32 {
    let ratio = other / mine;
    return 1.0 / (1.0 + ratio * ratio);
}

// A hit point of a ray on a face.
struct Surface {
    position: vec3<f32>,
    // Offset of leaving rays, from the error of the position.
    room: f32,
    // Normal of the winding.
    normal: vec3<f32>,
    // 1 if the ray comes from the side of the normal, -1 on the other.
    side: f32,
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
    // Back along the ray, in the frame.
    wo: vec3<f32>,
    uv: vec2<f32>,
    is_flat: bool,
    face: u32,
}

fn to_local(at: Surface, w: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(at.x, w), dot(at.y, w), dot(at.z, w));
}

fn to_world(at: Surface, w: vec3<f32>) -> vec3<f32> {
    return normalize(at.x * w.x + at.y * w.y + at.z * w.z);
}

fn size_of(v: vec3<f32>) -> f32 {
    let size = abs(v);
    return max(size.x, max(size.y, size.z));
}

// The hit point of a ray of unit direction on a face. A shading normal that would face away bends towards the viewer,
// as in the core.
fn surface_at(number_of_face: u32, origin: vec3<f32>, direction: vec3<f32>) -> Surface {
    let one = face(number_of_face);
    let s = origin - one.corner;
    let p = cross(direction, one.other);
    let determinant = dot(one.edge, p);
    var u = 0.0;
    var v = 0.0;
    if determinant != 0.0 {
        u = clamp(dot(s, p) / determinant, 0.0, 1.0);
        v = clamp(dot(direction, cross(s, one.edge)) / determinant, 0.0, 1.0 - u);
    }
    var at: Surface;
    at.face = number_of_face;
    at.position = one.corner + one.edge * u + one.other * v;
    at.room = 1e-6 * (size_of(one.corner) + size_of(one.edge) + size_of(one.other));
    at.normal = normalize(cross(one.edge, one.other));
    at.side = select(-1.0, 1.0, dot(at.normal, direction) <= 0.0);
    at.uv = vec2<f32>(u, v);
    let w = 1.0 - u - v;
    if (one.has & 2u) != 0u {
        at.uv = vec2<f32>(one.u_a * w + one.u_b * u + one.u_c * v, dot(one.v, vec3<f32>(w, u, v)));
    }
    at.z = at.normal;
    at.is_flat = true;
    if (one.has & 1u) != 0u {
        let mean = one.normal_a * w + one.normal_b * u + one.normal_c * v;
        let square = dot(mean, mean);
        if square > 1e-20 {
            at.z = mean * inverseSqrt(square);
            at.z = select(at.z, -at.z, dot(at.z, at.normal) < 0.0);
            at.is_flat = false;
            let cosine = -dot(at.z, direction) * at.side;
            if cosine < 1e-3 {
                at.z = normalize(at.z - direction * (at.side * (1e-3 - cosine)));
            }
        }
    }
    // Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
    let sign = select(-1.0, 1.0, at.z.z >= 0.0);
    let a = -1.0 / (sign + at.z.z);
    let b = at.z.x * at.z.y * a;
    at.x = vec3<f32>(1.0 + sign * at.z.x * at.z.x * a, sign * b, -sign * at.z.x);
    at.y = vec3<f32>(b, sign + at.z.y * at.z.y * a, -at.z.y);
    at.wo = to_local(at, -direction);
    return at;
}

// The material on the ray's side.
fn material_at(at: Surface) -> Material {
    return material(face(at.face).material + select(0u, 1u, at.side < 0.0));
}

// Origin of a ray that leaves in a direction.
fn leaving(at: Surface, direction: vec3<f32>) -> vec3<f32> {
    return at.position + at.normal * select(-at.room, at.room, dot(at.normal, direction) > 0.0);
}

// Factor of light from a direction near the horizon of either normal (Chiang, Li and Burley, "Taming the Shadow
// Terminator", 2019): see SurfaceInteraction::fading of the core.
fn fading(at: Surface, wi: vec3<f32>, direction: vec3<f32>) -> f32 {
    let geometric = dot(at.normal, direction);
    if wi.z * geometric <= 0.0 {
        return 0.0;
    }
    if at.is_flat || wi.z * at.wo.z < 0.0 {
        return 1.0;
    }
    let between = dot(at.z, at.normal);
    let g = geometric / (wi.z * between);
    if between <= 0.0 || g >= 1.0 {
        return 1.0;
    }
    return ((1.0 - g) * g + 1.0) * g;
}

// A color of a picture among the numbers. These are its width and height, its wrap mode (1: repeat, 2: clamp, 3:
// mirror, for u plus four times that for v), the two rows of the map to its coordinates, and its own rows from the top.
fn texel(at: u32, size: vec2<i32>, wrap: vec2<u32>, x: i32, y: i32) -> vec3<f32> {
    let column = wrapped(x, size.x, wrap.x);
    let row = wrapped(y, size.y, wrap.y);
    let first = at + 3u * u32(row * size.x + column);
    return vec3<f32>(number(first), number(first + 1u), number(first + 2u));
}

fn wrapped(i: i32, size: i32, wrap: u32) -> i32 {
    if wrap == 2u {
        return clamp(i, 0, size - 1);
    }
    let period = select(size, 2 * size, wrap == 3u);
    let within = ((i % period) + period) % period;
    return select(within, period - 1 - within, within >= size);
}

fn pictured(picture: u32, uv: vec2<f32>) -> vec3<f32> {
    let size = vec2<i32>(i32(number(picture)), i32(number(picture + 1u)));
    let both = u32(number(picture + 2u));
    let wrap = vec2<u32>(both & 3u, both >> 2u);
    let p = picture + 3u;
    let x_there = number(p) * uv.x + number(p + 1u) * uv.y + number(p + 2u);
    let y_there = number(p + 3u) * uv.x + number(p + 4u) * uv.y + number(p + 5u);
    let place = vec2<f32>(x_there, 1.0 - y_there) * vec2<f32>(size) - 0.5;
    let corner = clamp(floor(place), vec2<f32>(-1e9), vec2<f32>(1e9));
    let within = place - floor(place);
    let x = i32(corner.x);
    let y = i32(corner.y);
    let at = picture + 9u;
    let upper = mix(texel(at, size, wrap, x, y), texel(at, size, wrap, x + 1, y), within.x);
    let lower = mix(texel(at, size, wrap, x, y + 1), texel(at, size, wrap, x + 1, y + 1), within.x);
    return mix(upper, lower, within.y);
}

fn color_at(looks: Material, uv: vec2<f32>) -> vec3<f32> {
    if looks.picture == NO {
        return looks.color;
    }
    return looks.color * pictured(looks.picture, uv);
}

// Reflectance of a dielectric: see fresnel::dielectric of the core.
fn fresnel(cosine: f32, eta: f32) -> f32 {
    let e = (eta - 1.0) * (eta + 1.0);
    let square = e + cosine * cosine;
    if square <= 0.0 {
        return select(1.0, 0.0, e == 0.0);
    }
    let g = sqrt(square);
    let sum = cosine + g;
    let s = e / (sum * sum);
    let p = e * (cosine * sum - 1.0) / (sum * (eta * eta * cosine + g));
    return 0.5 * (s * s + p * p);
}

// Reflectance of a conductor of index eta + ik (Born and Wolf, "Principles of Optics", 14.2).
fn metallic(cosine: f32, eta: vec3<f32>, k: vec3<f32>) -> vec3<f32> {
    let c2 = cosine * cosine;
    let s2 = (1.0 - cosine) * (1.0 + cosine);
    let real = eta * eta - k * k - s2;
    let norm = sqrt(real * real + 4.0 * eta * eta * k * k);
    let a = sqrt(max((norm + real) * 0.5, vec3<f32>(0.0)));
    let sum = norm + c2;
    let twice = 2.0 * cosine * a;
    let even = c2 * norm + s2 * s2;
    let odd = s2 * twice;
    return clamp((sum - twice) * even / ((sum + twice) * (even + odd)), vec3<f32>(0.0), vec3<f32>(1.0));
}

// Reflectance of a metal: by its index, or by a table of 257 cosines from 0 to 1.
fn reflectance(looks: Material, cosine: f32) -> vec3<f32> {
    if looks.eta.x > 0.0 {
        return metallic(cosine, looks.eta, looks.k);
    }
    let place = clamp(cosine, 0.0, 1.0) * 256.0;
    let i = min(u32(place), 255u);
    let first = looks.table + 3u * i;
    let low = vec3<f32>(number(first), number(first + 1u), number(first + 2u));
    let high = vec3<f32>(number(first + 3u), number(first + 4u), number(first + 5u));
    return mix(low, high, place - f32(i));
}

// Direction of a ray that refracts at a facet of normal `h` on its side and leaves along `wo`; zero if there is none.
fn refracted(wo: vec3<f32>, h: vec3<f32>, eta: f32) -> vec3<f32> {
    let c = dot(wo, h);
    let e = (eta - 1.0) * (eta + 1.0);
    let square = e + c * c;
    if square <= 0.0 {
        return vec3<f32>(0.0);
    }
    return -(wo + h * (e / (c + sqrt(square)))) / eta;
}

// s(w) of GGX (Walter et al., 2007), |z| sqrt(1 + alpha^2 tan^2).
fn stretch(w: vec3<f32>, alpha: f32) -> f32 {
    return sqrt(alpha * alpha * (w.x * w.x + w.y * w.y) + w.z * w.z);
}

fn facets(h: vec3<f32>, alpha: f32) -> f32 {
    let xy = h.xy / alpha;
    let square = dot(xy, xy) + h.z * h.z;
    return INVERSE_PI / (alpha * alpha * square * square);
}

// Density of the facets that mirror one direction to another, and the cosine to both: Ggx::mirroring of the core.
fn mirroring(wo: vec3<f32>, wi: vec3<f32>, alpha: f32) -> vec2<f32> {
    let q = wo + wi;
    let square = dot(q, q);
    if square < 1e-20 {
        return vec2<f32>(facets(vec3<f32>(0.0, 0.0, 1.0), alpha), wo.z);
    }
    let z = alpha * q.z;
    let root = square * alpha / (q.x * q.x + q.y * q.y + z * z);
    return vec2<f32>(INVERSE_PI * root * root, min(0.5 * sqrt(square), 1.0));
}

// A facet visible from `wo`, above (Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023).
fn visible_facet(wo: vec3<f32>, alpha: f32, u: vec2<f32>) -> vec3<f32> {
    let w = vec3<f32>(alpha * wo.xy, wo.z) / stretch(wo, alpha);
    let depth = u.y * (1.0 + w.z);
    let radius = sqrt(max(depth * (2.0 - depth), 0.0));
    let way = turned(u.x);
    return normalize(vec3<f32>(alpha * (radius * way + w.xy), (1.0 - u.y) * (1.0 + w.z)));
}

// Loss by facets for a direction above, by a table of 64 numbers along the root of the cosine.
fn lost(table: u32, cosine: f32) -> f32 {
    let place = sqrt(clamp(cosine, 0.0, 1.0)) * 63.0;
    let i = min(u32(place), 62u);
    return mix(number(table + i), number(table + i + 1u), place - f32(i));
}

fn above(w: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(w.xy, abs(w.z));
}

fn by_cosine(u: vec2<f32>) -> vec3<f32> {
    return vec3<f32>(sqrt(u.x) * turned(u.y), sqrt(max(1.0 - u.x, 0.0)));
}

// The scattering function times its cosine, and the sampling density: 0 for delta lobes.
struct Scattered {
    value: vec3<f32>,
    pdf: f32,
}

fn rough_metal(looks: Material, wo: vec3<f32>, wi: vec3<f32>) -> Scattered {
    let met = mirroring(wo, wi, looks.alpha);
    let s = vec2<f32>(stretch(wo, looks.alpha), stretch(wi, looks.alpha));
    let single = met.x * 0.5 * wi.z / (s.x * wi.z + s.y * wo.z);
    let loss = lost(looks.losses, wo.z);
    let back = looks.multiple * (loss * lost(looks.losses, wi.z) * wi.z);
    let pdf = (1.0 - loss) * met.x * 0.5 / (wo.z + s.x) + loss * wi.z * INVERSE_PI;
    return Scattered(reflectance(looks, met.y) * single + back, pdf);
}

// Single scattering at a rough dielectric: Dielectric::single of the core.
fn rough_glass_once(looks: Material, wo: vec3<f32>, wi: vec3<f32>) -> Scattered {
    let eta = select(1.0 / looks.eta.x, looks.eta.x, wo.z > 0.0);
    if wo.z * wi.z > 0.0 {
        let o = above(wo);
        let i = above(wi);
        let met = mirroring(o, i, looks.alpha);
        let share = fresnel(met.y, eta);
        let s = vec2<f32>(stretch(o, looks.alpha), stretch(i, looks.alpha));
        let geometry = 0.5 * i.z / (s.x * i.z + s.y * o.z);
        return Scattered(vec3<f32>(share * met.x * geometry), share * met.x * 0.5 / (o.z + s.x));
    }
    var q = wo + wi * eta;
    q = select(q, -q, q.z * wo.z < 0.0);
    let square = dot(q, q);
    if square == 0.0 {
        return Scattered(vec3<f32>(0.0), 0.0);
    }
    let h = q * inverseSqrt(square);
    let o = dot(wo, h);
    let i = -dot(wi, h);
    if o <= 0.0 || i <= 0.0 {
        return Scattered(vec3<f32>(0.0), 0.0);
    }
    let through = (1.0 - fresnel(o, eta)) * facets(h, looks.alpha) * o * i / square;
    let seen = 2.0 / (abs(wo.z) + stretch(wo, looks.alpha));
    let both = min(seen, 2.0 * abs(wi.z / wo.z) / (abs(wi.z) + stretch(wi, looks.alpha)));
    return Scattered(vec3<f32>(through * both), through * seen * eta * eta);
}

// Loss by facets for a direction, on its side of rough glass.
fn lost_between(looks: Material, w: vec3<f32>) -> f32 {
    return lost(looks.losses + select(0u, 64u, w.z < 0.0), abs(w.z));
}

// Share of the loss on one side that is compensated on the other.
fn crossing(looks: Material, w: vec3<f32>) -> f32 {
    return select(looks.k.x, looks.k.y, w.z < 0.0);
}

// Includes the compensation of the loss by facets: Dielectric::both of the core.
fn rough_glass(looks: Material, wo: vec3<f32>, wi: vec3<f32>) -> Scattered {
    let by = rough_glass_once(looks, wo, wi);
    let loss = lost_between(looks, wo);
    let eta = select(1.0 / looks.eta.x, looks.eta.x, wo.z > 0.0);
    let crosses = wo.z * wi.z < 0.0;
    let share = select(1.0 - crossing(looks, wo), crossing(looks, wo), crosses);
    let over = select(looks.multiple.x, looks.multiple.y, wi.z < 0.0) / select(1.0, eta * eta, crosses);
    let back = loss * share * lost_between(looks, wi) * abs(wi.z) * over;
    return Scattered(by.value + back, (1.0 - loss) * by.pdf + loss * share * abs(wi.z) * INVERSE_PI);
}

// Reflectance of the coat of plastic.
fn coat(looks: Material, cosine: f32) -> f32 {
    if looks.alpha > 0.0 {
        return lost(looks.losses, cosine);
    }
    return fresnel(cosine, looks.eta.x);
}

// Probability to sample the coat, by its reflectance and that of the matt base.
fn coat_share(reflected: f32, base: vec3<f32>) -> f32 {
    return select(0.0, reflected / (reflected + most(base) * (1.0 - reflected)), reflected > 0.0);
}

// Coated::base of the core.
fn base_of(looks: Material, color: vec3<f32>) -> vec3<f32> {
    return color * (1.0 - looks.k.y) / (1.0 - color * looks.k.y);
}

// Coated::evaluate of the core, above.
fn plastic(looks: Material, color: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> Scattered {
    let base = base_of(looks, color);
    let reflected = coat(looks, wo.z);
    let share = coat_share(reflected, base);
    let reaching = (1.0 - reflected) * (1.0 - coat(looks, wi.z));
    let matt = base * (reaching * INVERSE_PI * wi.z / (1.0 - looks.k.x));
    var by = Scattered(matt, (1.0 - share) * wi.z * INVERSE_PI);
    if looks.alpha > 0.0 {
        let met = mirroring(wo, wi, looks.alpha);
        let s = vec2<f32>(stretch(wo, looks.alpha), stretch(wi, looks.alpha));
        let single = fresnel(met.y, looks.eta.x) * met.x * 0.5 * wi.z / (s.x * wi.z + s.y * wo.z);
        by.value += vec3<f32>(single);
        by.pdf += share * met.x * 0.5 / (wo.z + s.x);
    }
    return by;
}

fn is_metal(looks: Material) -> bool {
    return looks.kind == METAL || looks.kind == ROUGH_METAL;
}

fn is_single(looks: Material) -> bool {
    return looks.kind == MIRROR || looks.kind == GLASS || looks.kind == METAL;
}

// Scattering function of a material for light from `wi` to `wo`, in the frame.
fn scattered(looks: Material, color: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> Scattered {
    if looks.kind == ROUGH_GLASS {
        return rough_glass(looks, wo, wi);
    }
    if wo.z * wi.z <= 0.0 || is_single(looks) {
        return Scattered(vec3<f32>(0.0), 0.0);
    }
    if looks.kind == ROUGH_METAL {
        return rough_metal(looks, above(wo), above(wi));
    }
    if looks.kind == PLASTIC {
        return plastic(looks, color, above(wo), above(wi));
    }
    let pdf = abs(wi.z) * INVERSE_PI;
    return Scattered(color * pdf, pdf);
}

// A sampled direction in the frame: the scattering function times cosine over the density, and the density; 0 if none.
struct Drawn {
    wi: vec3<f32>,
    pdf: f32,
    weight: vec3<f32>,
    // The index beyond over that on the side of `wo` for transmission, else 1.
    eta: f32,
}

const NOTHING: Drawn = Drawn(vec3<f32>(0.0), 0.0, vec3<f32>(0.0), 1.0);

fn drawn_glass(looks: Material, wo: vec3<f32>, choice: f32) -> Drawn {
    let eta = select(1.0 / looks.eta.x, looks.eta.x, wo.z > 0.0);
    let share = fresnel(abs(wo.z), eta);
    if choice < share {
        return Drawn(vec3<f32>(-wo.xy, wo.z), SINGLE, vec3<f32>(1.0), 1.0);
    }
    let wi = refracted(wo, vec3<f32>(0.0, 0.0, select(-1.0, 1.0, wo.z > 0.0)), eta);
    if wi.z == 0.0 {
        return NOTHING;
    }
    return Drawn(wi, SINGLE, vec3<f32>(1.0 / (eta * eta)), eta);
}

fn drawn_rough_glass(looks: Material, wo: vec3<f32>, choice: f32, u: vec2<f32>) -> Drawn {
    let eta = select(1.0 / looks.eta.x, looks.eta.x, wo.z > 0.0);
    let loss = lost_between(looks, wo);
    var wi = by_cosine(u);
    var beyond = 1.0;
    if choice < loss {
        let crosses = choice < loss * crossing(looks, wo);
        wi.z = select(-wi.z, wi.z, (wo.z > 0.0) != crosses);
        beyond = select(1.0, eta, crosses);
    } else {
        var h = visible_facet(above(wo), looks.alpha, u);
        h.z = select(-h.z, h.z, wo.z > 0.0);
        let o = dot(wo, h);
        wi = h * (2.0 * o) - wo;
        if (choice - loss) / (1.0 - loss) < fresnel(o, eta) {
            if wi.z * wo.z <= 0.0 {
                return NOTHING;
            }
        } else {
            wi = refracted(wo, h, eta);
            beyond = eta;
            if wi.z * wo.z >= 0.0 {
                return NOTHING;
            }
            wi = normalize(wi);
        }
    }
    let by = rough_glass(looks, wo, wi);
    if !(by.pdf > 0.0) {
        return NOTHING;
    }
    return Drawn(wi, by.pdf, by.value / by.pdf, beyond);
}

fn drawn_rough_metal(looks: Material, wo: vec3<f32>, choice: f32, u: vec2<f32>) -> Drawn {
    let up = above(wo);
    var wi = by_cosine(u);
    if choice >= lost(looks.losses, up.z) {
        let h = visible_facet(up, looks.alpha, u);
        wi = h * (2.0 * dot(up, h)) - up;
    }
    if wi.z <= 0.0 {
        return NOTHING;
    }
    wi = normalize(wi);
    let by = rough_metal(looks, up, wi);
    if !(by.pdf > 0.0) {
        return NOTHING;
    }
    wi.z = select(-wi.z, wi.z, wo.z > 0.0);
    return Drawn(wi, by.pdf, by.value / by.pdf, 1.0);
}

fn drawn_plastic(looks: Material, color: vec3<f32>, wo: vec3<f32>, choice: f32, u: vec2<f32>) -> Drawn {
    let up = above(wo);
    let reflected = coat(looks, up.z);
    let share = coat_share(reflected, base_of(looks, color));
    var wi = by_cosine(u);
    if choice < share {
        if looks.alpha == 0.0 {
            return Drawn(vec3<f32>(-wo.xy, wo.z), SINGLE, vec3<f32>(reflected / share), 1.0);
        }
        let h = visible_facet(up, looks.alpha, u);
        wi = h * (2.0 * dot(up, h)) - up;
    }
    if wi.z <= 0.0 {
        return NOTHING;
    }
    wi = normalize(wi);
    let by = plastic(looks, color, up, wi);
    if !(by.pdf > 0.0) {
        return NOTHING;
    }
    wi.z = select(-wi.z, wi.z, wo.z > 0.0);
    return Drawn(wi, by.pdf, by.value / by.pdf, 1.0);
}

// Samples the direction of light that a material scatters to `wo`.
fn drawn(looks: Material, color: vec3<f32>, wo: vec3<f32>, choice: f32, u: vec2<f32>) -> Drawn {
    if wo.z == 0.0 {
        return NOTHING;
    }
    switch looks.kind {
        case DIFFUSE: {
            var wi = by_cosine(u);
            let pdf = wi.z * INVERSE_PI;
            wi.z = select(-wi.z, wi.z, wo.z > 0.0);
            return Drawn(wi, pdf, color, 1.0);
        }
        case MIRROR: { return Drawn(vec3<f32>(-wo.xy, wo.z), SINGLE, color, 1.0); }
        case GLASS: { return drawn_glass(looks, wo, choice); }
        case METAL: { return Drawn(vec3<f32>(-wo.xy, wo.z), SINGLE, reflectance(looks, abs(wo.z)), 1.0); }
        case ROUGH_METAL: { return drawn_rough_metal(looks, wo, choice, u); }
        case ROUGH_GLASS: { return drawn_rough_glass(looks, wo, choice, u); }
        case PLASTIC: { return drawn_plastic(looks, color, wo, choice, u); }
        default: { return NOTHING; }
    }
}

// Samples a direction at a surface, in the world, with the factor of shading normals.
fn drawn_at(at: Surface, looks: Material, color: vec3<f32>, choice: f32, u: vec2<f32>) -> Drawn {
    var next = drawn(looks, color, at.wo, choice, u);
    if next.pdf == 0.0 {
        return NOTHING;
    }
    let direction = to_world(at, next.wi);
    let counts = fading(at, next.wi, direction);
    if counts <= 0.0 {
        return NOTHING;
    }
    next.weight *= select(counts, 1.0, next.pdf == SINGLE);
    next.wi = direction;
    return next;
}

// Scattering by a surface of light from a world direction back along the ray.
fn scattered_at(at: Surface, looks: Material, color: vec3<f32>, direction: vec3<f32>) -> Scattered {
    let wi = to_local(at, direction);
    let counts = fading(at, wi, direction);
    if counts <= 0.0 {
        return Scattered(vec3<f32>(0.0), 0.0);
    }
    let by = scattered(looks, color, at.wo, wi);
    return Scattered(by.value * counts, by.pdf);
}

// The sky.

fn sky_texel(column: u32, row: u32) -> vec3<f32> {
    let first = lit.sky_colors + 3u * (row * lit.sky_width + column);
    return vec3<f32>(number(first), number(first + 1u), number(first + 2u));
}

// Column and row of a direction, each with its fraction; the middle of the picture is along -z, its top at +y.
fn sky_place(direction: vec3<f32>) -> vec2<f32> {
    let x = dot(lit.to_picture_x, direction);
    let y = dot(lit.to_picture_y, direction);
    let z = dot(lit.to_picture_z, direction);
    let across = select(0.0, atan2(x, -z), x != 0.0 || z != 0.0);
    let down = atan2(sqrt(x * x + z * z), y);
    let turns = vec2<f32>(0.5 + across * (0.5 * INVERSE_PI), down * INVERSE_PI);
    return clamp(turns, vec2<f32>(0.0), vec2<f32>(1.0)) * vec2<f32>(f32(lit.sky_width), f32(lit.sky_height));
}

// Radiance of the sky along a direction.
fn sky_radiance(direction: vec3<f32>) -> vec3<f32> {
    if SKY_KIND != 2u {
        return lit.sky * f32(SKY_KIND);
    }
    let place = sky_place(direction) - 0.5;
    let corner = floor(place);
    let within = place - corner;
    let width = i32(lit.sky_width);
    let left = (i32(corner.x) + width) % width;
    let right = (left + 1) % width;
    let last = i32(lit.sky_height) - 1;
    let top = u32(clamp(i32(corner.y), 0, last));
    let bottom = u32(clamp(i32(corner.y) + 1, 0, last));
    let upper = mix(sky_texel(u32(left), top), sky_texel(u32(right), top), within.x);
    let lower = mix(sky_texel(u32(left), bottom), sky_texel(u32(right), bottom), within.x);
    return lit.sky * mix(upper, lower, within.y);
}

// Index of the first cumulative share above a random number.
fn drawn_share(first: u32, count: u32, u: f32) -> u32 {
    var low = 0u;
    var high = count - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if u < number(first + middle) {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return low;
}

fn share_of(first: u32, i: u32) -> vec2<f32> {
    return vec2<f32>(select(0.0, number(first + max(i, 1u) - 1u), i > 0u), number(first + i));
}

fn sky_columns(row: u32) -> u32 {
    return lit.sky_shares + lit.sky_height + row * lit.sky_width;
}

// The density, in solid angle, of `from_sky` for a direction.
fn sky_pdf(direction: vec3<f32>) -> f32 {
    if SKY_KIND != 2u {
        return 0.25 * INVERSE_PI;
    }
    let place = sky_place(direction);
    let row = min(u32(place.y), lit.sky_height - 1u);
    let column = min(u32(place.x), lit.sky_width - 1u);
    let rows = share_of(lit.sky_shares, row);
    let columns = share_of(sky_columns(row), column);
    let share = (rows.y - rows.x) * (columns.y - columns.x) * f32(lit.sky_width) * f32(lit.sky_height);
    let sine = turned(0.5 * place.y / f32(lit.sky_height)).y;
    return share * (0.5 * INVERSE_PI * INVERSE_PI) / max(sine, 1e-6);
}

// Samples a direction to the sky: of a picture by the light in each texel.
fn from_sky(u: vec2<f32>) -> vec3<f32> {
    if SKY_KIND != 2u {
        let z = 1.0 - 2.0 * u.x;
        return vec3<f32>(sqrt(max(1.0 - z * z, 0.0)) * turned(u.y), z);
    }
    let row = drawn_share(lit.sky_shares, lit.sky_height, u.y);
    let rows = share_of(lit.sky_shares, row);
    let first = sky_columns(row);
    let column = drawn_share(first, lit.sky_width, u.x);
    let columns = share_of(first, column);
    let within = clamp(vec2<f32>((u.x - columns.x) / (columns.y - columns.x), (u.y - rows.x) / (rows.y - rows.x)),
        vec2<f32>(0.0), vec2<f32>(1.0));
    let place = (vec2<f32>(f32(column), f32(row)) + within) / vec2<f32>(f32(lit.sky_width), f32(lit.sky_height));
    let down = turned(0.5 * place.y);
    let across = turned(place.x);
    // The picture begins half a turn to the left of -z.
    let local = vec3<f32>(-down.y * across.y, down.x, down.y * across.x);
    return normalize(lit.to_picture_x * local.x + lit.to_picture_y * local.y + lit.to_picture_z * local.z);
}

// A light sample: direction, distance, radiance, and density in solid angle.
struct Arriving {
    direction: vec3<f32>,
    distance: f32,
    radiance: vec3<f32>,
    // 0 if there is none. SINGLE for lights without extent, whose `radiance` is divided by their probability.
    pdf: f32,
    // The emitting face, or NO.
    face: u32,
}

// Beyond all distances.
const FAR: f32 = 1e30;

fn shines(one: Light, cosine: f32) -> bool {
    return (one.sides & select(2u, 1u, cosine > 0.0)) != 0u && cosine != 0.0;
}

// Samples light that may reach a point.
fn from_lights(position: vec3<f32>, choice: f32, u: vec2<f32>) -> Arriving {
    var arriving = Arriving(vec3<f32>(0.0), FAR, vec3<f32>(0.0), 0.0, NO);
    if choice < lit.sky_share {
        arriving.direction = from_sky(u);
        arriving.radiance = sky_radiance(arriving.direction);
        arriving.pdf = lit.sky_share * sky_pdf(arriving.direction);
        return arriving;
    }
    if !HAS_LIGHTS {
        return arriving;
    }
    let left = (choice - lit.sky_share) / (1.0 - lit.sky_share);
    var low = 0u;
    var high = lit.lights - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if left < light(middle).until {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    let one = light(low);
    let chance = (1.0 - lit.sky_share) * one.share;
    if !(chance > 0.0) {
        return arriving;
    }
    if one.kind == DIRECTION {
        arriving.direction = one.place;
        arriving.radiance = one.radiance / chance;
        arriving.pdf = SINGLE;
        return arriving;
    }
    var place = one.place;
    if one.kind == LAMP {
        let lamp = face(one.face);
        let root = sqrt(u.x);
        place = lamp.corner + lamp.edge * (1.0 - root) + lamp.other * (root * u.y);
    }
    let way = place - position;
    let square = dot(way, way);
    if square == 0.0 {
        return arriving;
    }
    arriving.distance = sqrt(square);
    arriving.direction = way / arriving.distance;
    arriving.radiance = one.radiance;
    if one.kind == POINT {
        arriving.radiance = one.radiance / (chance * square);
        arriving.pdf = SINGLE;
        return arriving;
    }
    arriving.face = one.face;
    let lamp = face(one.face);
    let cosine = -dot(normalize(cross(lamp.edge, lamp.other)), arriving.direction);
    if shines(one, cosine) {
        arriving.pdf = chance * square / (one.area * abs(cosine));
    }
    return arriving;
}

// Emission of a face back along a ray.
fn emitted(at: Surface, direction: vec3<f32>) -> vec3<f32> {
    let which = face(at.face).light;
    if which == NO {
        return vec3<f32>(0.0);
    }
    let one = light(which);
    return select(vec3<f32>(0.0), one.radiance, shines(one, -dot(at.normal, direction)));
}

// The density of light sampling for an emitter that a ray from a point has hit.
fn emitted_pdf(at: Surface, origin: vec3<f32>, direction: vec3<f32>) -> f32 {
    let which = face(at.face).light;
    if which == NO {
        return 0.0;
    }
    let one = light(which);
    let way = at.position - origin;
    let cosine = abs(dot(at.normal, direction));
    return (1.0 - lit.sky_share) * one.share * dot(way, way) / max(one.area * cosine, 1e-30);
}
