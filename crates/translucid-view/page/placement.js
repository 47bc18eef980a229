// Where a light is, as seen from the middle of the scene.

import { add, cross, dot, length, normalize, perpendicular, rotate, scale, subtract } from "./vector.js";

const DEGREES = 180 / Math.PI;
const UP = [0, 1, 0];

/** The key of a light's place; parallel light has none. */
export const PLACE = { rectangle: "center", sphere: "center", spot: "position", beam: "origin" };

/** Azimuth from +z toward +x and elevation above the horizon in degrees, and the distance (null for parallel light). */
export function polar(light, pivot) {
    const place = PLACE[light.kind];
    const offset = place ? subtract(light[place], pivot) : light.direction;
    const far = length(offset);
    return {
        azimuth: Math.atan2(offset[0], offset[2]) * DEGREES,
        elevation: Math.asin(far > 0 ? Math.min(1, Math.max(-1, offset[1] / far)) : 0) * DEGREES,
        distance: place ? far : null,
    };
}

/** The light carried around the pivot as one piece, so that what faced the pivot still does. */
export function turnTo(light, pivot, azimuth, elevation) {
    const before = polar(light, pivot);
    const turn = (a) => {
        const straight = rotate(a, UP, -before.azimuth / DEGREES);
        const tilted = rotate(straight, [1, 0, 0], (before.elevation - elevation) / DEGREES);
        return rotate(tilted, UP, azimuth / DEGREES);
    };
    return transform(light, pivot, turn);
}

/** The light at another distance from the pivot. */
export function moveTo(light, pivot, distance) {
    const place = PLACE[light.kind];
    const offset = subtract(light[place], pivot);
    return { ...light, [place]: add(pivot, scale(normalize(offset), distance)) };
}

/** The light turned where it is, until it faces a point. */
export function face(light, point) {
    const place = light[PLACE[light.kind]];
    const wanted = normalize(subtract(point, place));
    const axis = light.kind === "rectangle" ? normalize(cross(light.edge_x, light.edge_y)) : light.direction;
    const cosine = Math.min(1, Math.max(-1, dot(axis, wanted)));
    const normal = cross(axis, wanted);
    const about = dot(normal, normal) > 1e-12 ? normalize(normal) : perpendicular(axis);
    return transform(light, place, (a) => rotate(a, about, Math.acos(cosine)));
}

function transform(light, pivot, turn) {
    const place = PLACE[light.kind];
    const next = { ...light };
    if (place) next[place] = add(pivot, turn(subtract(light[place], pivot)));
    if (light.direction) next.direction = normalize(turn(light.direction));
    if (light.edge_x) Object.assign(next, { edge_x: turn(light.edge_x), edge_y: turn(light.edge_y) });
    return next;
}
