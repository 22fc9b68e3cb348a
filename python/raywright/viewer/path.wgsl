// One path per pixel and pass, added to earlier ones: after gpu/walk.wgsl, gpu/shading.wgsl, sight.wgsl and
// brought.wgsl. Each surface samples a light and a direction, weighed by both densities (Veach and Guibas 1995).

@group(1) @binding(0) var<storage, read_write> sums: array<Brought>;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> materials: array<Material>;
@group(1) @binding(3) var<storage, read> lights: array<Light>;
@group(1) @binding(4) var<storage, read> numbers: array<f32>;
@group(1) @binding(5) var<uniform> lit: Lit;
@group(1) @binding(6) var<uniform> limits: Limits;

struct Limits {
    // Most surfaces of a path, the first one with roulette, and a seed.
    depth: u32,
    roulette: u32,
    seed: u32,
    // Columns of the picture, and the number of this path in its pixel.
    width: u32,
    sample: u32,
}

fn face(i: u32) -> Face {
    return faces[i];
}

fn material(i: u32) -> Material {
    return materials[i];
}

fn light(i: u32) -> Light {
    return lights[i];
}

fn number(i: u32) -> f32 {
    return numbers[i];
}

// Greatest and least survival probability of Russian roulette.
const STAYS: f32 = 0.95;
const LEAVES: f32 = 0.05;

// Random numbers of a path, in fours.
var<private> drawn_so_far: u32;
var<private> drawn_for: vec3<u32>;

fn numbers_drawn() -> vec4<f32> {
    drawn_so_far++;
    return uniform_numbers(vec4<u32>(drawn_for, drawn_so_far + limits.seed * 0x10000u));
}

// Light from a light sample, scattered at a surface back along the ray.
fn asked_for(at: Surface, its: Material, color: vec3<f32>) -> vec3<f32> {
    let u = numbers_drawn();
    let arriving = from_lights(at.position, u.x, u.yz);
    if arriving.pdf == 0.0 {
        return vec3<f32>(0.0);
    }
    let by = scattered_at(at, its, color, arriving.direction);
    if !(most(by.value) > 0.0) {
        return vec3<f32>(0.0);
    }
    let start = leaving(at, arriving.direction);
    if is_hidden(start, arriving.direction, arriving.distance, at.face, arriving.face, look.mode.w) {
        return vec3<f32>(0.0);
    }
    if arriving.pdf == SINGLE {
        return by.value * arriving.radiance;
    }
    return by.value * arriving.radiance * (beside(arriving.pdf, by.pdf) / arriving.pdf);
}

fn traced(first: Ray) -> vec3<f32> {
    var ray = first;
    var throughput = vec3<f32>(1.0);
    var light = vec3<f32>(0.0);
    // Density of the last sampled direction: SINGLE if light sampling could not have found its hit.
    var pdf = SINGLE;
    // The factor of refraction in the throughput, which roulette ignores.
    var eta_squared = 1.0;
    var from_face = NOBODY;
    for (var depth = 0u;; depth++) {
        let met = nearest(ray.origin, ray.direction, from_face, look.mode.w);
        if met.face == NOBODY {
            if SKY_KIND != 0u {
                let other = lit.sky_share * sky_pdf(ray.direction);
                light += throughput * sky_radiance(ray.direction) * select(beside(pdf, other), 1.0, pdf == SINGLE);
            }
            break;
        }
        let at = surface_at(met.face, ray.origin, ray.direction);
        let shining = emitted(at, ray.direction);
        if most(shining) > 0.0 {
            let other = emitted_pdf(at, ray.origin, ray.direction);
            light += throughput * shining * select(beside(pdf, other), 1.0, pdf == SINGLE);
        }
        if depth >= limits.depth {
            break;
        }
        let its = material_at(at);
        let color = color_at(its, at.uv);
        if !is_single(its) {
            light += throughput * asked_for(at, its, color);
        }
        let u = numbers_drawn();
        let next = drawn_at(at, its, color, u.x, u.yz);
        if next.pdf == 0.0 {
            break;
        }
        throughput *= next.weight;
        eta_squared *= next.eta * next.eta;
        pdf = next.pdf;
        if depth >= limits.roulette {
            let stays = clamp(most(throughput) * eta_squared, LEAVES, STAYS);
            if u.w >= stays {
                break;
            }
            throughput /= stays;
        }
        from_face = at.face;
        ray = Ray(leaving(at, next.wi), next.wi);
    }
    return light;
}

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<u32>(id.x, id.y + look.mode.z);
    if pixel.x >= limits.width || f32(pixel.y) >= look.size.y {
        return;
    }
    drawn_for = vec3<u32>(pixel, limits.sample);
    drawn_so_far = 0u;
    let within = numbers_drawn().xy;
    let light = traced(ray_through((vec2<f32>(pixel) + within) / look.size.xy));
    let which = pixel.y * limits.width + pixel.x;
    var before = Brought();
    if limits.sample > 0u {
        before = sums[which];
    }
    // A NaN would persist.
    let counts = most(light) < 1e30 && most(-light) <= 0.0;
    sums[which] = with_path(before, select(vec3<f32>(0.0), light, counts));
}
