// Linear Rec. 709 and the sRGB codes of swatches.

const encode = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const decode = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);

/** `#rrggbb` of a linear color; what lies outside of [0, 1] is cut. */
export function toHex(linear) {
    const code = (x) => Math.round(255 * encode(Math.min(1, Math.max(0, x))));
    return "#" + linear.map((x) => code(x).toString(16).padStart(2, "0")).join("");
}

/** The linear color of `#rrggbb`, rounded to what eight bits can tell apart. */
export function fromHex(hex) {
    return [1, 3, 5].map((i) => Number(decode(parseInt(hex.slice(i, i + 2), 16) / 255).toFixed(5)));
}

/** A color as its greatest channel and what is left; black is white with a strength of 0. */
export function split(linear) {
    const strength = Math.max(...linear);
    return { strength, hue: strength > 0 ? linear.map((x) => x / strength) : [1, 1, 1] };
}
