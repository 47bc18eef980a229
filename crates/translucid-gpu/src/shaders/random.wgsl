// Four random words as a function of seed, photon and step: no state, and a start that costs nothing.
fn random(photon: vec2u, step: u32) -> vec4u {
    return pcg4d(vec4u(photon, step, 0u) ^ settings.key);
}
