// Scales of sliders: from a position in [0, 1] to a value and back.

export const linear = (min, max) => ({
    toValue: (t) => min + (max - min) * t,
    toPosition: (value) => (value - min) / (max - min),
    /** One step of an arrow key in a field. */
    step: (value, size) => value + size * (max - min) * 0.01,
    min,
    max,
});

/** Equal ratios for equal ways. */
export const logarithmic = (min, max) => ({
    toValue: (t) => min * (max / min) ** t,
    toPosition: (value) => (value > 0 ? Math.log(value / min) / Math.log(max / min) : 0),
    step: (value, size) => (value > 0 ? value * 1.05 ** size : size > 0 ? min : 0),
    min,
    max,
});

/** Logarithmic, but the left end is 0. */
export const logarithmicFromZero = (min, max) => {
    const inner = logarithmic(min, max);
    return {
        ...inner,
        toValue: (t) => (t <= 0 ? 0 : inner.toValue(t)),
        step: (value, size) => (size < 0 && value <= min ? 0 : inner.step(value, size)),
    };
};
