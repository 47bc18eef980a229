// A path at the surface, or the light, that its ray has met: `path/tracer.rs` of the renderer, but that one way is drawn where
// the processor follows several.

// Scattering events after which paths of little throughput are ended at random.
const ROULETTE_AFTER = 3u;

fn surface_step(slot: u32) {
    var path = slots[slot].path;
    var found = slots[slot].found;
    var shadow = slots[slot].shadow;
    path.vertex += 1u;
    let is_hit = path.hit_triangle != NO_TRIANGLE;
    let t_max = select(NEVER, path.hit_t, is_hit);
    let of_camera = is_of_camera(&path);
    let light = light_intersect(path.origin, path.direction, t_max, of_camera);
    if (light.is_hit) {
        let weight = weight_beside(&path, light_hit_pdf(light, path.mis_point, path.mis_normal));
        if (of_camera) {
            found.alpha = 1.0;
        }
        add_light(&path, &found, light.radiance * absorbed(path.absorption, light.t) * weight);
        path.work = ENDED;
    } else if (!is_hit) {
        add_environment(&path, &found, of_camera);
        path.work = ENDED;
    } else {
        path.throughput *= absorbed(path.absorption, path.hit_t);
        interact(slot, &path, &found, &shadow, point_at(path.hit_triangle, path.hit));
    }
    slots[slot].path = path;
    slots[slot].found = found;
    slots[slot].shadow = shadow;
}

fn add_environment(path: ptr<function, Path>, found: ptr<function, Found>, of_camera: bool) {
    let direction = (*path).direction;
    if (of_camera && !environment_is_visible()) {
        return;
    }
    var radiance: vec3f;
    if (of_camera) {
        radiance = background_radiance(direction);
        (*found).alpha = 1.0;
    } else {
        radiance = environment_radiance(direction);
    }
    var weight = 1.0;
    if ((*path).mis_pdf < NEVER) {
        weight = power_heuristic((*path).mis_pdf, environment_pdf((*path).mis_point, (*path).mis_normal, direction));
    }
    add_light(path, found, radiance * weight);
}

fn interact(slot: u32, path: ptr<function, Path>, found: ptr<function, Found>, shadow: ptr<function, Shadow>, point: Point) {
    let m = material_at(point.material);
    let u = stratified((*path).sampler, (*path).vertex, 0u);
    let is_hidden = tables[m + HIDDEN_FROM_CAMERA] > 0.0 && is_of_camera(path);
    let opacity = opacity_at(point);
    if (!is_hidden) {
        add_emission(path, found, point, opacity);
    }
    if (is_hidden || opacity < 1.0 && u.w >= opacity) {
        pass_surface(path, point, vec3f(1.0));
        return;
    }
    var p = surface_at(point);
    let is_soft = ((*path).flags & SOFT) != 0u;
    let clear = p.transmission_weight * (1.0 - p.metalness);
    if (is_soft && clear > 0.0 && u.z < clear) {
        (*path).absorption = absorption_behind(point, (*path).direction, (*path).absorption);
        pass_surface(path, point, straight_transmittance(p, abs(dot((*path).direction, point.shading))));
        return;
    }
    let incoming = (*path).direction;
    let normal = facing(shading_normal_at(point), point.geometric, -incoming);
    let frame = frame_of(normal);
    let has_caustics = head(CAUSTICS) > 0u;
    let is_matte = p.metalness < 1.0 && p.transmission_weight < 1.0;
    let light_is_soft = is_soft || (is_matte && !has_caustics);
    let is_thin = tables[m + THIN_WALLED] > 0.0;
    let can_be_passed = tables[m + IS_MATCHED] > 0.0;
    let is_spent = (*path).depth >= head(MAX_DEPTH);

    // The surface as the path sees it
    let below = below_at(point);
    p.surface_albedo = below.surface_albedo;
    p.subsurface_active = select(vec3f(0.0), vec3f(1.0), below.length > vec3f(0.0));
    if (is_thin) {
        let g = tables[m + SUBSURFACE_ANISOTROPY];
        p.thin_albedo = 0.5 * p.surface_albedo * (1.0 + g);
        p.surface_albedo = 0.5 * p.surface_albedo * (1.0 - g);
    }
    if (is_soft) {
        p = surface_seen_softly(p);
    }
    if ((*path).diffuse_depth >= head(MAX_DIFFUSE_DEPTH)) {
        if (can_be_passed && p.metalness == 0.0) {
            p = surface_without_matte(p);
        } else {
            p = surface_without_diffuse(p);
        }
    }
    var bsdf = bsdf_new(p, to_local(frame, -incoming));
    if ((*path).depth == 0u && (*found).alpha == 0.0) {
        (*path).flags |= HAS_MET;
        (*found).alpha = 1.0;
        (*found).albedo = bsdf.albedo;
        (*found).normal = normal;
        (*found).depth = distance(point.position, (*path).mis_point);
    }
    if ((is_spent && !can_be_passed) || !survives(path, u.y)) {
        (*path).work = ENDED;
        return;
    }

    var light_normal = select(normal, -normal, dot(incoming, normal) > 0.0);
    let is_lit_from_behind = is_thin && tables[m + SUBSURFACE_WEIGHT] > 0.0;
    if (tables[m + TRANSMISSION_WEIGHT] > 0.0 || is_lit_from_behind) {
        light_normal = vec3f(0.0);
    }
    if (!is_spent && !bsdf_is_smooth_only(&bsdf)) {
        let u_light = stratified((*path).sampler, (*path).vertex, 1u);
        add_direct_light(path, shadow, point, normal, light_normal, frame, &bsdf, light_is_soft, u_light);
    }
    let v = stratified((*path).sampler, (*path).vertex, 2u);
    let drawn = bsdf_sample(&bsdf, v.x, v.yz);
    if (drawn.kind == BELOW) {
        (*path).throughput *= drawn.weight;
        begin_walk(slot, path, point, normal, below);
        return;
    }
    if (drawn.kind == NOTHING || is_spent) {
        (*path).work = ENDED;
        return;
    }
    let direction = normalize(frame * drawn.wi);
    let to = dot(direction, point.geometric);
    // The shading normal promised one side, the geometry has another: such light cannot be
    if ((-dot(incoming, point.geometric) * to < 0.0) != drawn.is_transmitted) {
        (*path).work = ENDED;
        return;
    }
    if (drawn.is_transmitted) {
        (*path).absorption = absorption_behind(point, direction, (*path).absorption);
    }
    (*path).diffuse_depth += u32(drawn.lobe == DIFFUSE);
    if (light_is_soft && drawn.pdf > 0.0) {
        (*path).flags |= SOFT;
    }
    (*path).mis_point = point.position;
    (*path).mis_normal = light_normal;
    (*path).mis_pdf = select(NEVER, min(drawn.pdf, 0.5 * NEVER), drawn.pdf > 0.0);
    scatter(path, OF_SURFACE, drawn.diffuse_share, ray_origin(point, direction), direction, drawn.weight);
}

fn add_emission(path: ptr<function, Path>, found: ptr<function, Found>, point: Point, opacity: f32) {
    let m = material_at(point.material);
    if (!(tables[m + EMISSION_LUMINANCE] > 0.0) || dot((*path).direction, point.geometric) >= 0.0) {
        return;
    }
    var weight = 1.0;
    if ((*path).mis_pdf < NEVER && point.light != NO_TRIANGLE) {
        let pdf = emissive_triangle_pdf(point.light, (*path).mis_point, (*path).mis_normal, point.position, point.geometric);
        weight = power_heuristic((*path).mis_pdf, pdf);
    }
    add_light(path, found, emission_at(point) * (opacity * weight));
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

// Sends light from one sampled light, reflected or transmitted by a surface.
fn add_direct_light(
    path: ptr<function, Path>,
    shadow: ptr<function, Shadow>,
    point: Point,
    normal: vec3f,
    light_normal: vec3f,
    frame: mat3x3f,
    bsdf: ptr<function, Bsdf>,
    is_soft: bool,
    u: vec4f,
) {
    let light = light_sample(point.position, light_normal, u.x, u.yz);
    if (!light.is_usable) {
        return;
    }
    let value = bsdf_eval(bsdf, to_local(frame, light.direction));
    let incoming = (*path).direction;
    let same_side = -dot(incoming, point.geometric) * dot(light.direction, point.geometric) > 0.0;
    let shading_side = -dot(incoming, normal) * dot(light.direction, normal) > 0.0;
    if (same_side != shading_side || is_zero(value.diffuse + value.specular)) {
        return;
    }
    let mis = select(power_heuristic(light.pdf, value.pdf), 1.0, light.is_delta);
    let received = sent(light, point.position, mis / light.pdf) * (*path).throughput;
    if (is_zero(received)) {
        return;
    }
    (*shadow).is_subsurface = u32((*path).layer == OF_SUBSURFACE);
    (*shadow).matte = received * value.diffuse;
    (*shadow).specular = received * value.specular;
    if ((*path).layer != OF_EMISSION) {
        let all = received * (value.diffuse + value.specular);
        (*shadow).matte = all;
        (*shadow).specular = vec3f(0.0);
        if ((*path).layer == OF_SURFACE) {
            (*shadow).matte = all * (*path).diffuse_share;
            (*shadow).specular = all * (1.0 - (*path).diffuse_share);
        }
    }
    (*shadow).absorption = (*path).absorption;
    if (!same_side) {
        (*shadow).absorption = absorption_behind(point, light.direction, (*path).absorption);
    }
    (*shadow).is_soft = u32(is_soft);
    (*shadow).passes = 0u;
    send(shadow, point, light.direction, light.distance);
    if ((*shadow).t_max <= 0.0) {
        (*shadow).t_max = 0.0;
    }
}
