// Where a light is, as seen from the middle of the scene.

import { axes } from "./camera.js";
import { add, cross, dot, length, normalize, perpendicular, rotate, scale, subtract } from "./vector.js";

const DEGREES = 180 / Math.PI;
const UP = [0, 1, 0];

/**
 * Azimuth from +z toward +x and elevation above the horizon in degrees, and the distance (null for parallel light).
 *
 * `kind` is the description of the light's type: `place` is the key of its point, null for parallel light.
 */
export function polar(light, { place }, pivot) {
    const offset = place ? subtract(light[place], pivot) : light.direction;
    return { ...anglesOf(offset), distance: place ? length(offset) : null };
}

function anglesOf(offset) {
    const far = length(offset);
    return {
        azimuth: Math.atan2(offset[0], offset[2]) * DEGREES,
        elevation: Math.asin(far > 0 ? Math.min(1, Math.max(-1, offset[1] / far)) : 0) * DEGREES,
    };
}

/** A light of a kind, above the camera's right shoulder: its example, which is made for a scene of radius 1, grown and turned. */
export function newLight(kind, { center, radius }, camera) {
    const { right, up, forward } = axes(camera);
    const from = normalize(add(add(scale(right, 0.6), scale(up, 0.8)), scale(forward, -1)));
    const { azimuth, elevation } = anglesOf(from);
    const light = { ...kind.example };
    for (const { key, kind: of } of kind.fields) {
        if (of === "length") light[key] *= radius;
        if (of === "power") light[key] = scale(light[key], radius ** 2);
        if (of === "point") light[key] = add(center, scale(light[key], radius));
        if (of === "edges") Object.assign(light, { edge_x: scale(light.edge_x, radius), edge_y: scale(light.edge_y, radius) });
    }
    return turnTo(light, kind, center, azimuth, elevation);
}

/** The light carried around the pivot as one piece, so that what faced the pivot still does. */
export function turnTo(light, kind, pivot, azimuth, elevation) {
    const before = polar(light, kind, pivot);
    const turn = (a) => {
        const straight = rotate(a, UP, -before.azimuth / DEGREES);
        const tilted = rotate(straight, [1, 0, 0], (before.elevation - elevation) / DEGREES);
        return rotate(tilted, UP, azimuth / DEGREES);
    };
    return transform(light, kind, pivot, turn);
}

/** The light at another distance from the pivot. */
export function moveTo(light, { place }, pivot, distance) {
    const offset = subtract(light[place], pivot);
    return { ...light, [place]: add(pivot, scale(normalize(offset), distance)) };
}

/** The light turned where it is, until it faces a point. */
export function face(light, kind, point) {
    const place = light[kind.place];
    const wanted = normalize(subtract(point, place));
    const axis = light.edge_x ? normalize(cross(light.edge_x, light.edge_y)) : light.direction;
    const cosine = Math.min(1, Math.max(-1, dot(axis, wanted)));
    const normal = cross(axis, wanted);
    const about = dot(normal, normal) > 1e-12 ? normalize(normal) : perpendicular(axis);
    return transform(light, kind, place, (a) => rotate(a, about, Math.acos(cosine)));
}

function transform(light, { place }, pivot, turn) {
    const next = { ...light };
    if (place) next[place] = add(pivot, turn(subtract(light[place], pivot)));
    if (light.direction) next.direction = normalize(turn(light.direction));
    if (light.edge_x) Object.assign(next, { edge_x: turn(light.edge_x), edge_y: turn(light.edge_y) });
    return next;
}
