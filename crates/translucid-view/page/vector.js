// Points and directions: arrays of three numbers.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const distance = (a, b) => length(subtract(a, b));
export const normalize = (a) => scale(a, 1 / (length(a) || 1));

/** `a` turned about the unit vector `axis` by an angle in radians, after Rodrigues. */
export function rotate(a, axis, angle) {
    const cosine = Math.cos(angle);
    const along = scale(axis, dot(axis, a) * (1 - cosine));
    return add(add(scale(a, cosine), scale(cross(axis, a), Math.sin(angle))), along);
}

/** A unit vector perpendicular to the unit vector `a`. */
export function perpendicular(a) {
    return normalize(cross(a, Math.abs(a[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0]));
}
