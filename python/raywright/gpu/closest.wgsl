// Candidates for each ray's closest hit: the nearer child first, the other on a stack with the distance where its box
// begins (Kay and Kajiya 1986).

var<private> ids: array<u32, 4>;
// The least t of each candidate; BEYOND if there is none.
var<private> lows: array<f32, 4>;
// Upper bound of the closest t.
var<private> best: f32;
// The candidate that certainly is a hit within that bound.
var<private> sure: u32;
// The least t among candidates that did not fit.
var<private> lost: f32;

fn add(id: u32, low: f32) {
    for (var i = 0u; i < 4u; i++) {
        if ids[i] == id {
            // Also hit in another leaf, where the lower bound of t may be slightly less.
            lows[i] = min(lows[i], low);
            return;
        }
    }
    for (var i = 0u; i < 4u; i++) {
        // Candidates beyond the bound are replaced first.
        if lows[i] > best {
            ids[i] = id;
            lows[i] = low;
            return;
        }
    }
    lost = min(lost, low);
}

fn candidates(ray: Slabs) -> vec4<u32> {
    var stack: array<u32, STACK>;
    var enters: array<f32, STACK>;
    var size = 0u;
    var at = 0u;
    let root = node(0u);
    let first = passes(ray, vector(root.lower), vector(root.upper), best);
    if first.x > first.y {
        return vec4<u32>(NONE);
    }
    var enter = first.x;
    loop {
        let here = node(at);
        var go_on = false;
        if here.count > 0u {
            for (var i = here.index; i < here.index + here.count; i++) {
                let one = triangle(i);
                let met = meet(ray, one, enter, min(best, ray.t_max));
                if met.possible {
                    if met.certain && met.high < best {
                        best = met.high;
                        sure = one.primitive;
                    }
                    if met.low <= best {
                        add(one.primitive, met.low);
                    }
                }
            }
        } else {
            let a = at + 1u;
            let left = node(a);
            let b = select(left.index, a + 1u, left.count > 0u);
            let right = node(b);
            let limit = min(best, ray.t_max);
            let to_left = passes(ray, vector(left.lower), vector(left.upper), limit);
            let to_right = passes(ray, vector(right.lower), vector(right.upper), limit);
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
            go_on = enter <= best;
        }
        if !go_on {
            break;
        }
    }
    if lost <= best {
        return vec4<u32>(OVERFLOW);
    }
    var found = vec4<u32>(NONE);
    var count = 0u;
    for (var i = 0u; i < 4u; i++) {
        if lows[i] <= best && ids[i] != NONE {
            found[count] = ids[i];
            count++;
        }
    }
    if count == 1u && found[0] == sure {
        found[1] = CERTAIN;
    }
    return found;
}

@compute @workgroup_size(64)
fn closest(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.rays {
        return;
    }
    let ray = rays[id.x];
    var answer = vec4<u32>(NONE);
    if largest(ray.direction) < 0.5 {
        answer = vec4<u32>(OVERFLOW);
    } else if ray.t_min <= ray.t_max && job.nodes > 0u {
        ids = array<u32, 4>(NONE, NONE, NONE, NONE);
        lows = array<f32, 4>(BEYOND, BEYOND, BEYOND, BEYOND);
        best = FOREVER;
        sure = NONE;
        lost = BEYOND;
        answer = candidates(slabs(ray));
    }
    answers[id.x] = answer;
}
