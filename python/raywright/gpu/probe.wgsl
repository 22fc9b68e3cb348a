// Probes the arithmetic of a device: each row of four has sums, differences, products, quotients, and more of its two
// numbers. The package compares them with WGSL's guarantees.

struct Job {
    zero: u32,
    count: u32,
    reserved: vec2<u32>,
}

@group(0) @binding(0) var<uniform> job: Job;
@group(0) @binding(1) var<storage, read> pairs: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read_write> results: array<vec4<f32>>;

fn held(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ job.zero);
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.count {
        return;
    }
    let x = pairs[id.x].x;
    let y = pairs[id.x].y;
    results[3u * id.x] = vec4<f32>(x + y, x - y, x * y, x / y);
    // A canceling sum: the held one is a single rounded number.
    results[3u * id.x + 1u] = vec4<f32>(held(x + y) - x, min(x, y), max(x, y), abs(x));
    let cross_product = cross(vec3<f32>(x, y, 1.0), vec3<f32>(y, 1.0, x));
    let order = select(0.0, 1.0, x < y) + select(0.0, 2.0, x > y);
    results[3u * id.x + 2u] = vec4<f32>(cross_product.z, dot(vec3<f32>(x, y, x), vec3<f32>(y, x, 1.0)), order, held(x));
}
