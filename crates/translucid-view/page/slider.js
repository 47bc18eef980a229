// A slider on a scale of its own.

import { make } from "./dom.js";
import { nextGesture } from "./gesture.js";

/** Positions of the slider, as fine as a wide screen. */
const FINE = 1000;

/** `change(value, gesture, isFinal)`; a gesture lasts from the press to the release, where `gesture` is null. */
export class Slider {
    #scale;
    #text;
    #gesture = 0;

    constructor({ id, label, labelledby, scale, text, change, className = "" }) {
        this.#scale = scale;
        this.#text = text;
        this.input = make("input", {
            id,
            type: "range",
            min: 0,
            max: FINE,
            step: 1,
            className,
            "aria-label": label,
            "aria-labelledby": labelledby,
        });
        const value = () => Number(this.#scale.toValue(this.input.valueAsNumber / FINE).toPrecision(5));
        this.input.addEventListener("input", () => {
            this.#gesture ||= nextGesture();
            this.#describe(value());
            change(value(), this.#gesture, false);
        });
        this.input.addEventListener("change", () => {
            this.#gesture = 0;
            change(value(), null, true);
        });
        this.input.addEventListener("keydown", (event) => this.#key(event));
    }

    /** Whether a hand is on it. */
    get isHeld() {
        return this.#gesture !== 0;
    }

    set scale(scale) {
        this.#scale = scale;
    }

    show(value) {
        if (this.isHeld) return;
        const position = Math.min(1, Math.max(0, this.#scale.toPosition(value)));
        const text = String(Math.round(position * FINE));
        if (this.input.value !== text) this.input.value = text;
        this.#describe(value);
    }

    #describe(value) {
        this.input.style.setProperty("--at", `${(this.input.valueAsNumber / FINE) * 100}%`);
        this.input.setAttribute("aria-valuetext", this.#text(value));
    }

    /** Arrow keys go by a hundredth, with shift by a thousandth, with Page Up and Down by a tenth. */
    #key(event) {
        const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
        if (!direction) return;
        event.preventDefault();
        const before = this.input.value;
        this.input.valueAsNumber += direction * (event.shiftKey ? 1 : FINE / 100);
        if (this.input.value === before) return;
        this.input.dispatchEvent(new Event("input"));
        this.input.dispatchEvent(new Event("change"));
    }
}
