// The edges of boxes over a picture: after gpu/walk.wgsl and sight.wgsl.

// Eight corners of each box.
@group(1) @binding(0) var<storage, read> corners: array<f32>;

const COLOR = vec4<f32>(1.0, 0.8157, 0.0, 1.0);

@vertex
fn edge(@builtin(vertex_index) i: u32, @builtin(instance_index) box: u32) -> @builtin(position) vec4<f32> {
    // Corners share an edge if their numbers differ in one bit: for each bit, the four corners without it.
    let bit = i >> 3u;
    let four = (i >> 1u) & 3u;
    let low = (four & ((1u << bit) - 1u)) | ((four >> bit) << (bit + 1u));
    let corner = 3u * (8u * box + (low | ((i & 1u) << bit)));
    let place = vec3<f32>(corners[corner], corners[corner + 1u], corners[corner + 2u]) - look.origin.xyz;
    let across = dot(place, look.across.xyz);
    let down = dot(place, look.down.xyz);
    let along = dot(place, look.along.xyz);
    // The device clips parts behind the camera: depth is linear along an edge.
    if look.origin.w > 0.5 {
        return vec4<f32>(2.0 * across - 1.0, 1.0 - 2.0 * down, along * 0.001, 1.0);
    }
    return vec4<f32>(2.0 * across - along, along - 2.0 * down, 0.5 * along, along);
}

@fragment
fn line() -> @location(0) vec4<f32> {
    return COLOR;
}
