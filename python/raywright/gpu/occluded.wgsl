// Whether rays hit anything: 0 no, 1 yes, 2 if f32 does not tell. Along the nodes as they lie, without a stack: one
// number is all that a ray has to know of its way (Smits 1998).

fn occlusion(ray: Slabs) -> u32 {
    var at = 0u;
    var answer = 0u;
    while at < job.nodes {
        let here = node(at);
        let within = passes(ray, vector(here.lower), vector(here.upper), ray.t_max);
        if within.x > within.y {
            at = select(here.index, at + 1u, here.count > 0u);
            continue;
        }
        for (var i = 0u; i < here.count; i++) {
            let met = meet(ray, triangle(here.index + i), within.x, ray.t_max);
            if met.certain {
                return 1u;
            }
            if met.possible {
                answer = 2u;
            }
        }
        at++;
    }
    return answer;
}

@compute @workgroup_size(64)
fn occluded(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.rays {
        return;
    }
    let ray = rays[id.x];
    var answer = 0u;
    if largest(ray.direction) < 0.5 {
        answer = 2u;
    } else if ray.t_min <= ray.t_max && job.nodes > 0u {
        answer = occlusion(slabs(ray));
    }
    answers[id.x] = answer;
}
