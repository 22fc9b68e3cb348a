// The error of a picture from sums of its paths: rust/render/src/error.rs in f32, whose comments have the reasons.
// After brought.wgsl.

@group(0) @binding(0) var<storage, read> brought: array<Brought>;
// Columns and rows.
@group(0) @binding(1) var<uniform> size: vec2<u32>;
// Sightings, jumps and finds, one after the other.
@group(0) @binding(2) var<storage, read_write> counted: array<atomic<u32>>;
// Sums of each workgroup.
@group(0) @binding(3) var<storage, read_write> sums: array<f32>;

const THREADS: u32 = 64u;
// By workgroup: the error, the least and the most, with equal denominators and with its own; squares and cubes of the
// most, and contributions of rare samples to both; the fewest paths of a pixel.
const SUMS: u32 = 10u;
const FEWEST: u32 = 9u;
// Squares and cubes are scaled by a millionth, so that outliers do not overflow f32.
const SMALL: f32 = 1e-6;

const OCTAVES: u32 = 96u;
const JUMPS: u32 = 2u * (OCTAVES + 2u);
const JUMP_BINS: u32 = 128u;
const LEAST_JUMP: i32 = -24;
const PARTS: u32 = 14u;
// Jumps are counted in fractions; beyond this many, more make no difference.
const ONE: f32 = 65536.0;
const PLENTY: u32 = 0x40000000u;
const FINDS: u32 = JUMPS + JUMP_BINS;
// Thirty-second parts of octaves, from 2 to the minus 40th on.
const FIND_BINS: u32 = 2048u;
const LEAST_FIND: u32 = (127u - 40u) << 5u;

const FLOOR: f32 = 0.01;

struct Spread {
    samples: f32,
    mean: vec3<f32>,
    // Variance of the mean, the largest sample's part in it, and the mean without that sample.
    variance: vec3<f32>,
    of_peak: vec3<f32>,
    without: vec3<f32>,
    brightness: f32,
    // Number of further samples of the largest size whose squares equal all others.
    again: f32,
}

fn spread(one: Brought) -> Spread {
    let n = max(one.count, 2.0);
    let mean = one.sum / n;
    let variance = one.squares / (n * (n - 1.0));
    let off = one.largest - mean;
    let without = max(one.sum - one.largest, vec3<f32>(0.0)) / (n - 1.0);
    let above = one.largest - without;
    let others = max(one.squares - off * off * (n / (n - 1.0)), vec3<f32>(0.0));
    let again = (others.x + others.y + others.z) / max(dot(above, above), 1e-37);
    let of_peak = min(off * off / (n * (n - 1.0)), variance);
    return Spread(n, mean, variance, of_peak, without, peak(one.largest), again);
}

fn octave(brightness: f32) -> u32 {
    let exponent = i32((bitcast<u32>(brightness) >> 23u) & 0xffu) - 127;
    return u32(clamp(exponent + 32, 0, i32(OCTAVES) - 1)) + 1u;
}

@compute @workgroup_size(THREADS)
fn count_sightings(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    for (var i = id.x; i < size.x * size.y; i += THREADS * groups.x) {
        let its = spread(brought[i]);
        let at = 2u * octave(its.brightness);
        if its.again < 0.25 {
            atomicAdd(&counted[at], 1u);
        } else if its.again < 1.5 {
            atomicAdd(&counted[at + 1u], 1u);
        }
    }
}

// Number of equally bright samples per pixel that has one: the likely one, and the most.
fn chance(brightness: f32) -> vec2<f32> {
    let middle = octave(brightness);
    var once = 0.0;
    var twice = 0.0;
    for (var at = middle - 1u; at < min(middle + 2u, OCTAVES + 2u); at++) {
        once += f32(atomicLoad(&counted[2u * at]));
        twice += f32(atomicLoad(&counted[2u * at + 1u]));
    }
    let some = max(once, 1.0);
    let little = 2.0 / (some * some);
    let likely = (2.0 * twice + little) / (once + little);
    return min(vec2<f32>(likely, 2.0 * (twice + 2.0 * sqrt(twice) + 3.0) / some), vec2<f32>(1.0));
}

fn mean_of(x: u32, y: u32) -> vec3<f32> {
    let one = brought[y * size.x + x];
    return one.sum / max(one.count, 1.0);
}

// One over the divisor of squared errors, for a brightness.
fn inverse(brightness: vec3<f32>) -> vec3<f32> {
    return 1.0 / (brightness * brightness + FLOOR);
}

// The same for a pixel, with its four neighbors.
fn likely_inverse(its: Spread, x: u32, y: u32, own: vec3<f32>) -> vec3<f32> {
    let a = mean_of(select(x, x - 1u, x > 0u), y);
    let b = mean_of(min(x + 1u, size.x - 1u), y);
    let c = mean_of(x, select(y, y - 1u, y > 0u));
    let d = mean_of(x, min(y + 1u, size.y - 1u));
    let off = sqrt(its.variance) * (5.0 / sqrt(its.samples));
    let lower = max(min(a, b), min(c, d));
    let upper = min(max(a, b), max(c, d));
    let low = min(lower, upper);
    let high = max(lower, upper);
    var middle = (low + high) / 2.0;
    if its.samples >= 16.0 {
        middle = min(max(its.mean, low), high);
    }
    let likely = min(max(middle, its.mean - off), its.mean + off);
    return min(inverse(likely), 4.0 * own);
}

// Surrounding pixels: the mean of their means, and their greatest brightness without their largest samples.
fn seen_around(x: u32, y: u32) -> vec4<f32> {
    var sum = vec3<f32>(0.0);
    var count = 0.0;
    var shown = 0.0;
    for (var row = select(y, y - 1u, y > 0u); row <= min(y + 1u, size.y - 1u); row++) {
        for (var column = select(x, x - 1u, x > 0u); column <= min(x + 1u, size.x - 1u); column++) {
            if row != y || column != x {
                let its = spread(brought[row * size.x + column]);
                sum += its.mean;
                count += 1.0;
                shown = max(shown, peak(its.without));
            }
        }
    }
    return vec4<f32>(sum / max(count, 1.0), shown);
}

fn between(likely: vec3<f32>, its: Spread) -> vec3<f32> {
    return inverse(min(max(likely, min(its.mean, its.without)), max(its.mean, its.without)));
}

// Excess errors of pixels over the largest estimate, which one like this may hide.
fn count_jumps(its: Spread, told: f32) {
    var part = 1.0;
    for (var step = 0u; step <= PARTS; step++) {
        let is_last = step == PARTS;
        let middle = select(part * 0.840896415, 0.0, is_last);
        let likely = its.without + (its.mean - its.without) * middle;
        let more = dot(its.of_peak, inverse(likely)) * (1.0 - middle) * (1.0 - middle) - told;
        let bits = bitcast<u32>(max(more, 0.0));
        let exponent = i32(bits >> 23u) - 127;
        if exponent >= LEAST_JUMP {
            let upper = u32((bits & 0x7fffffu) >= 0x3504f3u);
            let at = JUMPS + min(2u * u32(exponent - LEAST_JUMP) + upper, JUMP_BINS - 1u);
            if atomicLoad(&counted[at]) < PLENTY {
                atomicAdd(&counted[at], u32(round(ONE * part * part * select(0.25, 0.5, is_last))));
            }
        }
        part *= 0.707106781;
    }
}

fn count_find(brings: f32) {
    let place = bitcast<u32>(max(brings, 0.0)) >> 18u;
    if place >= LEAST_FIND {
        atomicAdd(&counted[FINDS + min(place - LEAST_FIND, FIND_BINS - 1u)], 1u);
    }
}

var<workgroup> all: array<f32, SUMS * THREADS>;

@compute @workgroup_size(THREADS)
fn add_up(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    var its_sums = array<f32, SUMS>();
    its_sums[FEWEST] = 1e9;
    for (var i = id.x; i < size.x * size.y; i += THREADS * groups.x) {
        var one = weighed(i);
        for (var k = 0u; k < FEWEST; k++) {
            its_sums[k] += one[k];
        }
        its_sums[FEWEST] = min(its_sums[FEWEST], one[FEWEST]);
    }
    for (var k = 0u; k < SUMS; k++) {
        all[k * THREADS + thread] = its_sums[k];
    }
    workgroupBarrier();
    if thread < SUMS {
        var sum = all[thread * THREADS];
        for (var other = 1u; other < THREADS; other++) {
            let more = all[thread * THREADS + other];
            sum = select(sum + more, min(sum, more), thread == FEWEST);
        }
        sums[group.x * SUMS + thread] = sum;
    }
}

// Contribution of a pixel to the sums.
fn weighed(i: u32) -> array<f32, SUMS> {
    let x = i % size.x;
    let y = i / size.x;
    let its = spread(brought[i]);
    let own = inverse(its.mean);
    let likely = likely_inverse(its, x, y, own);
    let around = seen_around(x, y);
    let most_likely = max(likely, own);
    // For the largest sample, if the mean depends on it: leave one out.
    let hangs = max((1.0 + 8.0 / its.samples) * (1.0 + 8.0 / its.samples), 2.0);
    let is_alone = own < inverse(max(its.without, around.xyz)) / hangs;
    let chances = chance(its.brightness);
    let more = its.mean - its.without;
    let confirmed = between(max(around.xyz, its.without + more * chances.x), its);
    let surest = between(max(around.xyz, its.without + more * chances.y), its);
    let brings = dot(its.of_peak, select(likely, max(confirmed, likely), is_alone));
    let brings_least = dot(its.of_peak, select(own, max(surest, own), is_alone));
    let brings_most = dot(its.of_peak, select(most_likely, max(between(around.xyz, its), most_likely), is_alone));
    if any(own < inverse(its.without) / hangs) {
        count_jumps(its, brings_most);
    }
    let others = peak(its.without);
    if its.brightness - others > 2.0 * max(around.w - others, 0.0) {
        count_find(brings);
    }
    let rest = its.variance - its.of_peak;
    let error = brings + dot(rest, likely);
    let most = brings_most + dot(rest, most_likely);
    let small = select(0.0, most * SMALL, error > 0.0);
    let share = min(brings / max(error, 1e-37), 1.0);
    let square = small * small;
    return array<f32, SUMS>(
        error,
        brings_least + dot(rest, own),
        most,
        dot(its.variance, likely),
        dot(its.variance, own),
        square,
        square * small,
        square * share,
        square * small * share * (22.0 + share),
        brought[i].count,
    );
}
