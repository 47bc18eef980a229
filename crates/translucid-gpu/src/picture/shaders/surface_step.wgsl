// A path at the surface, or the light, that its ray has met: `path/tracer.rs` of the renderer, but that one way is drawn where
// the processor follows several.

// Scattering events after which paths of little throughput are ended at random.
const ROULETTE_AFTER = 3u;

// What the ray has met: light, or a surface that it passes, or one that is to scatter it.
fn meet(path: ptr<function, Path>, found: ptr<function, Found>, met: ptr<function, Met>, light: ptr<function, Light>) {
    (*path).vertex += 1u;
    (*path).work = ENDED;
    let is_hit = (*path).hit_triangle != NO_TRIANGLE;
    let of_camera = is_of_camera(path);
    let seen = light_intersect((*path).origin, (*path).direction, select(NEVER, (*path).hit_t, is_hit), of_camera);
    var radiance = vec3f(0.0);
    // Density with which lights are sampled for what it has met
    var pdf = 0.0;
    var odds: LightOdds;
    if ((*path).mis_pdf < NEVER) {
        odds = light_odds((*path).mis_point, (*path).mis_normal);
    }
    if (seen.is_hit) {
        radiance = seen.radiance * absorbed((*path).absorption, seen.t);
        pdf = light_hit_pdf(odds, seen, (*path).mis_point);
    } else if (!is_hit) {
        if (of_camera && !environment_is_visible()) {
            return;
        }
        if (of_camera) {
            radiance = background_radiance((*path).direction);
        } else {
            radiance = environment_radiance((*path).direction);
        }
        pdf = environment_pdf(odds, (*path).mis_normal, (*path).direction);
    } else {
        (*path).throughput *= absorbed((*path).absorption, (*path).hit_t);
        let is_hidden = is_hidden_from(of_camera, material_at((*met).material));
        if (!is_hidden && !catches_shadows(path, material_at((*met).material)) && dot((*path).direction, (*met).geometric) < 0.0 && greatest((*met).emission) > 0.0) {
            radiance = (*met).emission * (*met).opacity;
            if ((*met).light != NO_TRIANGLE) {
                pdf = emissive_triangle_pdf(odds, (*met).light, (*path).mis_point, (*met).position);
            }
        }
    }
    let weight = select(1.0, power_heuristic((*path).mis_pdf, pdf), (*path).mis_pdf < NEVER);
    add_light(path, found, radiance * weight);
    if (seen.is_hit || !is_hit) {
        (*found).alpha = select((*found).alpha, 1.0, of_camera);
        return;
    }
    arrive(path, found, met, light, of_camera);
}

fn is_hidden_from(of_camera: bool, m: u32) -> bool {
    return of_camera && u32(tables[m + CAMERA_VISIBILITY]) == NOT_SEEN;
}

// Returns true where the camera sees only shadows: also behind a body, which covers as much as it keeps.
fn catches_shadows(path: ptr<function, Path>, m: u32) -> bool {
    return (*path).depth == 0u && u32(tables[m + CAMERA_VISIBILITY]) == SHADOWS_SEEN;
}

// How far what lies behind is seen through what the path has passed.
fn coverage(throughput: vec3f) -> f32 {
    return min(sum(throughput) * (1.0 / 3.0), 1.0);
}

// Sends the light sample of a surface of which only shadows are seen: what arrives, as a share of what was sent, is missing
// in its coverage.
fn look_for_shadow(
    path: ptr<function, Path>,
    found: ptr<function, Found>,
    met: ptr<function, Met>,
    light: ptr<function, Light>,
    shadow: ptr<function, Shadow>,
) {
    (*path).work = ENDED;
    (*found).alpha = 1.0;
    let sent = luminance((*light).radiance);
    if ((*light).kind == NO_LIGHT || !(sent > 0.0)) {
        (*found).alpha -= coverage((*path).throughput);
        return;
    }
    (*shadow).layer = TO_ALPHA;
    (*shadow).matte = (*light).radiance / sent;
    (*shadow).specular = vec3f(0.0);
    (*shadow).absorption = (*path).absorption;
    (*shadow).is_soft = u32(head(CAUSTICS) == 0u);
    (*shadow).passes = 0u;
    send(shadow, met, (*light).direction, (*light).distance);
}

// At a surface: passed, or to scatter the path beside a light sample.
fn arrive(
    path: ptr<function, Path>,
    found: ptr<function, Found>,
    met: ptr<function, Met>,
    light: ptr<function, Light>,
    of_camera: bool,
) {
    let m = material_at((*met).material);
    let p = (*met).surface;
    let u = stratified((*path).sampler, (*path).vertex, 0u);
    let is_hidden = is_hidden_from(of_camera, m);
    let clear = p.transmission_weight * (1.0 - p.metalness);
    if (is_hidden || ((*met).opacity < 1.0 && u.w >= (*met).opacity)) {
        pass_surface(path, met, vec3f(1.0));
        return;
    }
    let incoming = (*path).direction;
    if (catches_shadows(path, m)) {
        let normal = (*met).smooth_normal;
        (*path).work = AT_CATCHER;
        request_light(light, (*met).position, select(normal, -normal, dot(normal, incoming) > 0.0));
        return;
    }
    if (((*path).flags & SOFT) != 0u && clear > 0.0 && u.z < clear) {
        (*path).absorption = absorption_behind(met, incoming, (*path).absorption);
        pass_surface(path, met, surface_parameters_straight_transmittance(p, abs(dot(incoming, (*met).smooth_normal))));
        return;
    }
    let normal = facing((*met).normal, (*met).geometric, -incoming);
    if ((*path).depth == 0u && ((*path).flags & HAS_MET) == 0u) {
        (*path).flags |= HAS_MET | IS_FIRST;
        (*found).alpha = 1.0;
        (*found).normal = normal;
        (*found).depth = distance((*met).position, (*path).mis_point);
    }
    let is_spent = (*path).depth >= head(MAX_DEPTH);
    let can_be_passed = tables[m + IS_MATCHED] > 0.0 || p.thin != 0u;
    if ((is_spent && !can_be_passed) || !survives(path, u.y)) {
        return;
    }
    (*path).work = AT_SURFACE;
    (*light).kind = NO_LIGHT;
    if (!is_spent) {
        request_light(light, (*met).position, light_normal(met, m, normal, incoming));
    }
}

// The normal that light selection may rely on: 0 where light from both sides counts.
fn light_normal(met: ptr<function, Met>, m: u32, normal: vec3f, incoming: vec3f) -> vec3f {
    let p = (*met).surface;
    let is_lit_from_behind = p.thin != 0u && tables[m + INPUT_WORDS * SUBSURFACE_WEIGHT] > 0.0;
    if (tables[m + INPUT_WORDS * TRANSMISSION_WEIGHT] > 0.0 || is_lit_from_behind) {
        return vec3f(0.0);
    }
    return select(normal, -normal, dot(incoming, normal) > 0.0);
}

fn request_light(light: ptr<function, Light>, point: vec3f, normal: vec3f) {
    (*light).kind = USABLE;
    (*light).point = point;
    (*light).normal = normal;
}

// Plays Russian roulette with the throughput; the weight of refraction is that of basic radiance, so no index counts.
fn survives(path: ptr<function, Path>, u: f32) -> bool {
    if ((*path).depth < ROULETTE_AFTER) {
        return true;
    }
    let survival = min(sqrt(greatest((*path).throughput)), 0.95);
    if (u >= survival) {
        return false;
    }
    (*path).throughput /= survival;
    return true;
}

// Scatters the path at a surface, and sends the light sample from there.
fn scatter_at_surface(
    slot: u32,
    path: ptr<function, Path>,
    found: ptr<function, Found>,
    met: ptr<function, Met>,
    light: ptr<function, Light>,
    shadow: ptr<function, Shadow>,
) {
    (*path).work = ENDED;
    let m = material_at((*met).material);
    let incoming = (*path).direction;
    let normal = facing((*met).normal, (*met).geometric, -incoming);
    let frame = frame_of(normal);
    let is_soft = ((*path).flags & SOFT) != 0u;
    let is_spent = (*path).depth >= head(MAX_DEPTH);
    var p = (*met).surface;
    let is_matte = p.metalness < 1.0 && p.transmission_weight < 1.0;
    let light_is_soft = is_soft || (is_matte && head(CAUSTICS) == 0u);
    if (is_soft) {
        p = surface_parameters_seen_softly(p);
    }
    if ((*path).diffuse_depth >= head(MAX_DIFFUSE_DEPTH)) {
        if (tables[m + IS_MATCHED] > 0.0 && p.metalness == 0.0) {
            p = surface_parameters_without_matte(p);
        } else {
            p = surface_parameters_without_diffuse(p);
        }
    }
    let pairing = pairing_of((*met).material);
    if (pairing != 0u && dot(incoming, normal) < 0.0) {
        p = brightened(p, pairing);
    }
    if (u32(tables[m + BELOW_KIND]) == WALK_BELOW && dot(incoming, normal) < 0.0 && greatest(p.subsurface_active) > 0.0) {
        // Shells may be brighter; the color only sets how often paths look below
        p.surface_albedo = max(p.surface_albedo, table_vector(shell_words((*met).material) + BRIGHTEST_SHELL));
    }
    let bsdf = bsdf_new((*met).tables, p, to_local(frame, -incoming));
    if (((*path).flags & IS_FIRST) != 0u) {
        (*path).flags &= ~IS_FIRST;
        (*found).albedo = bsdf.albedo;
    }
    // Sets of numbers are taken one after the other, as on the processor
    (*path).flags = select((*path).flags & ~UNLIT, (*path).flags | UNLIT, is_spent || bsdf_is_smooth_only(bsdf));
    let v = stratified((*path).sampler, (*path).vertex, surface_sets((*path).flags) - 1u);
    var chosen = bsdf_draw(bsdf, (*met).tables, v.x, v.yz);
    let has_light = (*light).kind != NO_LIGHT && !bsdf_is_smooth_only(bsdf);
    let is_drawn = chosen.kind == DIRECTION && chosen.lobe != MIRROR;
    // One evaluation for the light sample, and one for the direction that was drawn
    for (var k = 0u; k < 2u; k += 1u) {
        if (!select(is_drawn, has_light, k == 0u)) {
            continue;
        }
        var wi = chosen.wi;
        if (k == 0u) {
            wi = to_local(frame, (*light).direction);
        }
        let value = bsdf_eval(bsdf, (*met).tables, wi);
        if (k == 0u) {
            send_from_surface(path, met, light, shadow, normal, value, light_is_soft);
        } else {
            chosen = bsdf_draw_weighed(chosen, value);
        }
    }
    if (chosen.kind == BELOW) {
        (*path).throughput *= chosen.weight;
        if (u32(tables[m + BELOW_KIND]) == PROFILE_BELOW) {
            begin_probes(slot, path, met, normal);
        } else {
            begin_walk(slot, path, met, normal);
        }
        return;
    }
    // Straight through a thin wall, as light samples go; the camera, which has taken none, sees what is behind as through any glass
    let is_straight = p.thin != 0u && chosen.is_transmitted && chosen.lobe == MIRROR && (*path).depth > 0u;
    if (chosen.kind == NOTHING || (is_spent && !is_straight)) {
        return;
    }
    let direction = normalize(frame * chosen.wi);
    // The shading normal promised one side, the geometry has another: such light cannot be
    if ((-dot(incoming, (*met).geometric) * dot(direction, (*met).geometric) < 0.0) != chosen.is_transmitted) {
        return;
    }
    if (is_straight) {
        pass_surface(path, met, chosen.weight);
        return;
    }
    if (chosen.is_transmitted) {
        (*path).absorption = absorption_behind(met, direction, (*path).absorption);
    }
    (*path).diffuse_depth += u32(chosen.lobe == DIFFUSE);
    if (light_is_soft && chosen.pdf > 0.0) {
        (*path).flags |= SOFT;
    }
    (*path).mis_point = (*met).position;
    (*path).mis_normal = light_normal(met, m, normal, incoming);
    (*path).mis_pdf = select(NEVER, min(chosen.pdf, 0.5 * NEVER), chosen.pdf > 0.0);
    scatter(path, OF_SURFACE, chosen.diffuse_share, ray_origin(met, direction), direction, chosen.weight);
}

// Sends a light sample, reflected or transmitted by a surface.
fn send_from_surface(
    path: ptr<function, Path>,
    met: ptr<function, Met>,
    light: ptr<function, Light>,
    shadow: ptr<function, Shadow>,
    normal: vec3f,
    value: BsdfValue,
    is_soft: bool,
) {
    let incoming = (*path).direction;
    let direction = (*light).direction;
    let same_side = -dot(incoming, (*met).geometric) * dot(direction, (*met).geometric) > 0.0;
    let shading_side = -dot(incoming, normal) * dot(direction, normal) > 0.0;
    let received = weighed(light, weight_of(light, value.pdf)) * (*path).throughput;
    let all = value.diffuse + value.specular;
    if (same_side != shading_side || is_zero(received * all)) {
        return;
    }
    (*shadow).layer = select(TO_SURFACE, TO_SUBSURFACE, (*path).layer == OF_SUBSURFACE);
    (*shadow).matte = received * value.diffuse;
    (*shadow).specular = received * value.specular;
    if ((*path).layer == OF_SUBSURFACE) {
        (*shadow).matte = received * all;
        (*shadow).specular = vec3f(0.0);
    } else if ((*path).layer == OF_SURFACE) {
        (*shadow).matte = received * all * (*path).diffuse_share;
        (*shadow).specular = received * all * (1.0 - (*path).diffuse_share);
    }
    (*shadow).absorption = (*path).absorption;
    if (!same_side) {
        (*shadow).absorption = absorption_behind(met, direction, (*path).absorption);
    }
    (*shadow).is_soft = u32(is_soft);
    (*shadow).passes = 0u;
    send(shadow, met, direction, (*light).distance);
}
