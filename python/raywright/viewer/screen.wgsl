// Shaders for the screen: after gpu/walk.wgsl, sight.wgsl and brought.wgsl.

@vertex
fn whole(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers all.
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// From unbounded light to linear colors of a screen, as in io/tone.py.
fn toned(rgb: vec3<f32>) -> vec3<f32> {
    let light = min(max(rgb, vec3<f32>(0.0)) * look.size.z, vec3<f32>(1e15));
    if look.mode.y == 1u {
        return min(light, vec3<f32>(1.0));
    }
    let peak = max(light.x, max(light.y, light.z));
    var shown = peak;
    if peak > 0.5 {
        shown = 1.0 - 0.25 / (peak - 0.5 + 0.5);
    }
    let scaled = light * (shown / max(peak, 1e-18));
    let white = 1.0 - 1.0 / (0.15 * (peak - shown) + 1.0);
    return mix(scaled, vec3<f32>(shown), white);
}

// The sRGB transfer (IEC 61966-2-1).
fn encoded(linear: vec3<f32>) -> vec4<f32> {
    let curved = 1.055 * pow(max(linear, vec3<f32>(1e-18)), vec3<f32>(1.0 / 2.4)) - 0.055;
    return vec4<f32>(select(curved, 12.92 * linear, linear <= vec3<f32>(0.0031308)), 1.0);
}

@fragment
fn sight(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let ray = ray_through(at.xy / look.size.xy);
    let met = nearest(ray.origin, ray.direction, NOBODY, look.mode.w);
    if look.mode.x == 1u {
        return encoded(heat(log2(f32(visits)) / log2(look.size.w)));
    }
    return encoded(toned(sketched(ray, met)));
}

@group(1) @binding(0) var drawn: texture_2d<f32>;
@group(1) @binding(1) var between: sampler;

// A picture possibly of lower resolution.
@fragment
fn shown(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return textureSampleLevel(drawn, between, at.xy / look.size.xy, 0.0);
}

// Sums of paths so far, by pixel.
@group(1) @binding(2) var<storage, read> brought: array<Brought>;

@fragment
fn developed(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let its = brought[u32(at.y) * u32(look.size.x) + u32(at.x)];
    return encoded(toned(its.sum / max(its.count, 1.0)));
}
