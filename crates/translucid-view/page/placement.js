// Where a light is, as seen from the middle of the scene.

import { axes } from "./camera.js";
import { add, cross, dot, length, normalize, perpendicular, rotate, scale, subtract } from "./vector.js";

const DEGREES = 180 / Math.PI;
const UP = [0, 1, 0];

/** The key of a light's place; parallel light has none. */
export const PLACE = { rectangle: "center", ellipse: "center", sphere: "center", spot: "position", beam: "origin" };

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

/** Irradiance of a new light on what faces it in the middle of the scene. */
const BRIGHT = 3;

/** A light of a kind, above the camera's right shoulder; `point` is a spot to all sides. */
export function newLight(kind, { center, radius }, camera) {
    const { right, up, forward } = axes(camera);
    const from = normalize(add(add(scale(right, 0.6), scale(up, 0.8)), scale(forward, -1)));
    const far = 3 * radius;
    const place = add(center, scale(from, far));
    const direction = scale(from, -1);
    const white = (value) => [value, value, value];
    const edge = perpendicular(from);
    const size = radius;
    const ofPoint = { radius: 0, visible: true };
    const flat = (area) => ({
        center: place,
        edge_x: scale(edge, size),
        edge_y: scale(cross(from, edge), -size),
        radiance: white((BRIGHT / area) * (far / size) ** 2),
        visible: true,
    });
    const lights = {
        rectangle: flat(1),
        ellipse: flat(Math.PI / 4),
        sphere: { center: place, radius: 0.3 * size, radiance: white((BRIGHT / Math.PI) * (far / (0.3 * size)) ** 2), visible: true },
        distant: { direction: from, angular_radius: 0.27, irradiance: white(BRIGHT) },
        spot: { position: place, direction, intensity: white(BRIGHT * far ** 2), inner_angle: 20, outer_angle: 30, ...ofPoint },
        point: { position: place, direction, intensity: white(BRIGHT * far ** 2), inner_angle: 0, outer_angle: 180, ...ofPoint },
        beam: { origin: place, direction, radius: 0.1 * size, power: white(BRIGHT * Math.PI * (0.1 * size) ** 2) },
    };
    return { kind: kind === "point" ? "spot" : kind, ...lights[kind] };
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
    const axis = light.edge_x ? normalize(cross(light.edge_x, light.edge_y)) : light.direction;
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
