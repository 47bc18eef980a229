// Units of lengths: those that a person would choose for a number, and those that are typed behind one.

export const MILLIMETERS = { "\u00b5m": 1e-3, um: 1e-3, mm: 1, cm: 10, m: 1000 };

/** Why a text is no length. */
export const notLength = (text) => ({ ...notNumber(text), help: "lengths are numbers alone, or with \u00b5m, mm, cm or m" });
export const notNumber = (text) => ({ message: `\u201c${text}\u201d is not a number`, help: null });

/** The unit in which to show a length of the scene's `unit`: that one, or where it makes numbers long mm, \u00b5m or m. */
export function readable(length, unit) {
    const size = Math.abs(length);
    if (size === 0 || !(unit in MILLIMETERS) || (size >= 0.1 && size < 1e4)) return unit;
    const millimeters = size * MILLIMETERS[unit];
    if (millimeters >= 1e4) return "m";
    return millimeters < 0.01 ? "\u00b5m" : "mm";
}

/** A typed text without the unit at its end, and that unit; null where it names none. */
export function splitUnit(text) {
    const [, number, unit] = text.trim().match(/^(.*?)\s*(\u00b5m|\u03bcm|um|mm|cm|m)$/) ?? [null, text, null];
    return [number, unit === "\u03bcm" ? "um" : unit];
}
