// Sums of a pixel's paths, and statistics for its error.

struct Brought {
    sum: vec3<f32>,
    // Number of paths.
    count: f32,
    // Sum of squared deviations from the mean.
    squares: vec3<f32>,
    reserved_a: f32,
    // The path with the largest channel.
    largest: vec3<f32>,
    reserved_b: f32,
}

fn peak(rgb: vec3<f32>) -> f32 {
    return max(rgb.x, max(rgb.y, rgb.z));
}

// Adds one path. Squares of light itself would lose the differences between paths in f32 (Youngs and Cramer, 1971).
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
