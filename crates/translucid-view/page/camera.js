// Cameras as the server writes them, seen from elsewhere: every function returns a new one.

import { add, cross, distance, dot, normalize, perpendicular, rotate, scale, subtract } from "./vector.js";

/** Least angle between the view and `up`, in radians: at the pole right and left would change places. */
const POLE = 0.02;

/** The camera's axes: unit vectors to the right, up and forward. */
export function axes(camera) {
    const forward = normalize(subtract(camera.target, camera.position));
    const across = cross(forward, normalize(camera.up));
    const right = dot(across, across) > 1e-12 ? normalize(across) : perpendicular(forward);
    return { right, up: cross(right, forward), forward };
}

/** A perspective is not named: it is the default. */
export const isOrthographic = ({ projection }) => projection === "orthographic";

/** Length of a pixel's edge at a depth along the view, for a picture `width` pixels wide. */
export function lengthPerPixel(camera, width, depth) {
    if (isOrthographic(camera)) return camera.width / width;
    return (2 * depth * Math.tan((camera.fov * Math.PI) / 360)) / width;
}

/** Depth of a point along the view; negative behind the camera. */
export function depthOf(camera, point) {
    return dot(subtract(point, camera.position), axes(camera).forward);
}

/** The camera turned about its target: by `yaw` about `up`, and upward by `pitch`, in radians. */
export function orbit(camera, yaw, pitch) {
    const up = normalize(camera.up);
    const offset = subtract(camera.position, camera.target);
    const height = Math.acos(Math.min(1, Math.max(-1, dot(normalize(offset), up))));
    const wanted = Math.min(Math.PI - POLE, Math.max(POLE, height - pitch));
    const tilted = rotate(offset, axes(camera).right, wanted - height);
    return { ...camera, position: add(camera.target, rotate(tilted, up, yaw)) };
}

/** The camera moved sideways with its target, by shares of the picture's width at the target. */
export function pan(camera, across, upward) {
    const { right, up } = axes(camera);
    const width = lengthPerPixel(camera, 1, distance(camera.position, camera.target));
    const shift = add(scale(right, across * width), scale(up, upward * width));
    return { ...camera, position: add(camera.position, shift), target: add(camera.target, shift) };
}

/** The camera at `factor` times its distance from the target, or with a view that wide, at least `nearest`. */
export function dolly(camera, factor, nearest) {
    if (isOrthographic(camera)) return { ...camera, width: Math.max(nearest, factor * camera.width) };
    const before = distance(camera.position, camera.target);
    const after = Math.max(nearest, before * factor);
    const position = add(camera.target, scale(subtract(camera.position, camera.target), after / before));
    return keepFocus(camera, { ...camera, position });
}

/** The camera turned toward a point, from where it is. */
export function lookAt(camera, point) {
    return { ...camera, target: point, focus_distance: distance(camera.position, point) };
}

/** Focus that was at the target stays there. */
export function keepFocus(before, after) {
    const old = distance(before.position, before.target);
    if (Math.abs(before.focus_distance - old) > 1e-3 * old) return after;
    return { ...after, focus_distance: distance(after.position, after.target) };
}
