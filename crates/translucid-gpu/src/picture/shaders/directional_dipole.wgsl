// The directional dipole of a kernel, whose formula is among those of exports: `DirectionalDipoleTable` of `translucid-profile`.

// Places of a kernel's words in place of those of oblique light.
const DIPOLE_TABLE = 1u;    // where g and the cubics begin behind the kernel
const DIPOLE_BOUNDARY = 3u; // C_phi, C_E, A

const DIPOLE_INTERVALS = 192.0;
const DIPOLE_CELL_WORDS = 8u;

// Square root of 1 - alpha', and alpha'/A: cubics over the root of the surface albedo.
fn dipole_medium(cubics: u32, albedo: f32) -> vec2f {
    let place = sqrt(albedo) * DIPOLE_INTERVALS;
    let cell = min(floor(place), DIPOLE_INTERVALS - 1.0);
    let t = place - cell;
    var values: vec2f;
    for (var k = 0u; k < 2u; k += 1u) {
        let at = cubics + DIPOLE_CELL_WORDS * u32(cell) + 4u * k;
        values[k] = tables[at] + t * (tables[at + 1u] + t * (tables[at + 2u] + t * tables[at + 3u]));
    }
    return values;
}

// 2 pi r R(x) [1/L] of light from a direction, for unit normals at entry and exit.
fn dipole_density(kernel: u32, albedo: f32, stated: f32, offset: vec3f, light: vec3f, n_i: vec3f, n_o: vec3f) -> f32 {
    let table = kernel + u32(tables[kernel + DIPOLE_TABLE]);
    let medium = dipole_medium(table + 1u, albedo);
    let absorbed = medium.x * medium.x;
    let alpha_prime = albedo * medium.y;
    let transport_mfps_per_mfp = absorbed + alpha_prime / (1.0 - tables[table]);
    let per_length = select(transport_mfps_per_mfp, sqrt(3.0 * absorbed / (1.0 + absorbed)), tables[kernel + IS_DMFP] > 0.0);
    let transport_mfp = max(clamp(stated, 1e-18, 1e18) * per_length, 1e-30);
    let boundary = table_vector(kernel + DIPOLE_BOUNDARY);
    let eta = tables[kernel + REFRACTION_ETA];
    let dipole = directional_dipole(medium.x, alpha_prime, 1.0 / transport_mfps_per_mfp, boundary.x, boundary.y, boundary.z, eta);
    // Beyond that all distances are alike
    let x = clamp(offset / transport_mfp, vec3f(-1e15), vec3f(1e15));
    return 2.0 * PI * length(x) * directional_dipole_eval(dipole, x, light, n_i, n_o) / transport_mfp;
}
