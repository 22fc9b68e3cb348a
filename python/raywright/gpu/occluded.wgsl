// Occlusion of rays: NONE is no, CERTAIN is yes, a number is that of the only primitive f32 cannot decide, and OVERFLOW
// means several. The traversal follows the order of nodes, without a stack: one number is a ray's whole state (Smits
// 1998).

fn occlusion(ray: Slabs) -> u32 {
    var at = 0u;
    var open = NONE;
    while at < job.nodes {
        let here = node(at);
        let within = passes(ray, vector(here.lower), vector(here.upper), ray.t_max);
        if within.x > within.y {
            at = select(here.index, at + 1u, here.count > 0u);
            continue;
        }
        for (var i = 0u; i < here.count; i++) {
            let one = triangle(here.index + i);
            let met = meet(ray, one, within.x, ray.t_max);
            if met.certain {
                return CERTAIN;
            }
            if met.possible && open != one.primitive {
                open = select(OVERFLOW, one.primitive, open == NONE);
            }
        }
        at++;
    }
    return open;
}

@compute @workgroup_size(64)
fn occluded(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.rays {
        return;
    }
    let ray = rays[id.x];
    var answer = NONE;
    if largest(ray.direction) < 0.5 {
        answer = OVERFLOW;
    } else if ray.t_min <= ray.t_max && job.nodes > 0u {
        answer = occlusion(slabs(ray));
    }
    answers[id.x] = answer;
}
