// Four random words of four words: pcg4d of M. Jarzynski and M. Olano 2020, Hash Functions for GPU Rendering, JCGT 9(3), with a
// round more: as it is, upper bits of some words do not reach the lower bits of others.
fn pcg4d(words: vec4u) -> vec4u {
    var v = mixed(words * 1664525u + 1013904223u);
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
