// Four random words as a function of seed, photon and step: no state, and a start that costs nothing.
//
// pcg4d of M. Jarzynski and M. Olano 2020, Hash Functions for GPU Rendering, JCGT 9(3), with a round more: as it is, upper bits
// of photon and seed do not reach the lower bits of a word.
fn random(photon: vec2u, step: u32) -> vec4u {
    var v = (vec4u(photon, step, 0u) ^ settings.key) * 1664525u + 1013904223u;
    v = mixed(v);
    v = mixed(v ^ (v >> vec4u(16u)));
    return mixed(v ^ (v >> vec4u(16u)));
}

fn mixed(words: vec4u) -> vec4u {
    var v = words;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}
