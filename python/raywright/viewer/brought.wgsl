// What paths have brought to a pixel, and what of that tells how sure it is.

struct Brought {
    sum: vec3<f32>,
    // How many paths.
    count: f32,
    // The squares of how far each is from their mean, added up.
    squares: vec3<f32>,
    reserved_a: f32,
    // Of all paths the one with the largest channel.
    largest: vec3<f32>,
    reserved_b: f32,
}

fn peak(rgb: vec3<f32>) -> f32 {
    return max(rgb.x, max(rgb.y, rgb.z));
}

// With one more. Squares of light itself would drown in f32 what its paths differ by (Youngs and Cramer, 1971).
fn with_path(before: Brought, light: vec3<f32>) -> Brought {
    var after = before;
    after.count += 1.0;
    after.sum += light;
    if before.count > 0.0 {
        let off = after.count * light - after.sum;
        after.squares += off * off / (after.count * before.count);
    }
    if peak(light) > peak(before.largest) {
        after.largest = light;
    }
    return after;
}
