// Numbers as people read and type them.

/** At most `digits` significant digits, no trailing zeros, exponents where they are shorter; what is no number is a dash. */
export function format(value, digits = 5) {
    if (!Number.isFinite(value)) return "\u2013";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e6 || size < 1e-4) {
        return value.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e");
    }
    return String(Number(value.toPrecision(digits)));
}

/**
 * The number of a typed text, or null. `before` is what stood there: "*2", "/2" and "+1ev" change it by a factor,
 * "+1ev" by stops.
 */
export function parse(text, before = 0) {
    const plain = text.trim().replace(/\u2212/g, "-").replace(/,/g, ".").replace(/\s+/g, "");
    const factor = plain.match(/^([*\/\u00d7])(.+)$/);
    if (factor) {
        const by = number(factor[2]);
        return by === null ? null : finite(factor[1] === "/" ? before / by : before * by);
    }
    const stops = plain.match(/^([+-].*?)(ev|stops?)$/i);
    if (stops) {
        const by = number(stops[1]);
        return by === null ? null : finite(before * 2 ** by);
    }
    return number(plain);
}

function number(text) {
    return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) ? finite(Number(text)) : null;
}

const finite = (value) => (Number.isFinite(value) ? value : null);

/** With a thin space between thousands, for counts. */
export function count(value) {
    return Math.round(value).toString().replace(/\B(?=(\d{3})+$)/g, "\u2009");
}

/** A count with a prefix of the SI: 3.1 M. */
export function si(value) {
    for (const [size, prefix] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]]) {
        if (value >= size) return `${format(value / size, 3)}\u2009${prefix}`;
    }
    return `${format(value, 3)}\u2009`;
}

/** Seconds as 3.2 s, 4:05 or 1:02:03. */
export function duration(seconds) {
    if (seconds < 60) return `${seconds.toFixed(1)}\u2009s`;
    const whole = Math.round(seconds);
    const pad = (n) => String(n).padStart(2, "0");
    const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
    return h > 0 ? `${h}:${pad(m)}:${pad(s)}` : `${m}:${pad(s)}`;
}
