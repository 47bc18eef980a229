// A field for a number: typed with Enter, stepped with arrow keys, dragged at its label.

import { make } from "./dom.js";
import { nextGesture } from "./gesture.js";
import { format, parse } from "./numbers.js";
import { MILLIMETERS, notLength, notNumber, readable, splitUnit } from "./units.js";

/** Pixels of CSS that a label is dragged for a step. */
const DRAG = 4;

/**
 * `change(value, gesture, isFinal)` gets what was typed; `gesture` is null where only the end of a gesture is new.
 * `scale` says how far a step goes. `refused({ message, help })` is called for what is no number, `accepted()` when that is over.
 */
export class NumberField {
    #value = null;
    #text = "";
    #digits;
    #change;
    #scale;
    #gesture = 0;
    #unit;
    #shownUnit;

    /**
     * `digits`: significant ones that are shown; a field that has the focus shows more. `unit`: the scene's, of a length;
     * `onUnit` is told in which one it is shown.
     */
    constructor({ id, label, labelledby, scale, change, handle, digits = 4, unit, onUnit }) {
        this.#digits = digits;
        this.#unit = this.#shownUnit = unit;
        this.onUnit = onUnit;
        this.#change = change;
        this.#scale = scale;
        this.input = make("input", {
            id,
            type: "text",
            className: "number",
            inputMode: "decimal",
            autocomplete: "off",
            spellcheck: false,
            "aria-label": label,
            "aria-labelledby": labelledby,
        });
        this.input.addEventListener("change", () => this.#commit());
        this.input.addEventListener("focus", () => {
            if (!this.isRefused) this.show(this.#value, true);
            this.input.select();
        });
        this.input.addEventListener("blur", () => {
            this.#endGesture();
            if (!this.isRefused) this.show(this.#value, true);
        });
        this.input.addEventListener("keydown", (event) => this.#key(event));
        this.input.addEventListener("keyup", (event) => event.key.startsWith("Arrow") && this.#endGesture());
        if (handle) this.#drag(handle);
    }

    get isRefused() {
        return this.input.getAttribute("aria-invalid") === "true";
    }

    /** Shows a value, unless somebody types. */
    show(value, force = false) {
        this.#value = value;
        if (!force && (this.isRefused || this.#isTyping)) return;
        const digits = document.activeElement === this.input ? Math.max(5, this.#digits) : this.#digits;
        if (this.#unit && value !== null && readable(value, this.#unit) !== this.#shownUnit) {
            this.#shownUnit = readable(value, this.#unit);
            this.onUnit?.(this.#shownUnit);
        }
        this.#text = value === null ? "" : format(value / this.#size, digits);
        if (this.input.value !== this.#text) this.input.value = this.#text;
    }

    /** What a number 1 stands for, in the scene's unit. */
    get #size() {
        return this.#unit === this.#shownUnit ? 1 : MILLIMETERS[this.#shownUnit] / MILLIMETERS[this.#unit];
    }

    /** The value of a text in the unit that is shown, or in one of its own; null where it is no number. */
    #parse(text) {
        const before = (this.#value ?? 0) / this.#size;
        const [number, unit] = this.#unit in MILLIMETERS ? splitUnit(text) : [text, null];
        const value = parse(number, before);
        if (value === null) return null;
        return value * (unit ? MILLIMETERS[unit] / MILLIMETERS[this.#unit] : this.#size);
    }

    get #isTyping() {
        return document.activeElement === this.input && this.input.value !== this.#text;
    }

    #commit() {
        const text = this.input.value;
        if (text === this.#text && !this.isRefused) return;
        const value = this.#parse(text);
        if (value === null) return this.refused?.((this.#unit in MILLIMETERS ? notLength : notNumber)(text));
        this.show(value, true);
        this.#change(value, nextGesture(), true);
    }

    #key(event) {
        const isUndo = (event.ctrlKey || event.metaKey) && event.key === "z";
        if (event.key === "Escape" || (isUndo && this.#isTyping)) {
            event.preventDefault();
            this.accepted?.();
            this.show(this.#value, true);
            this.input.select();
            event.stopPropagation();
        } else if (event.key === "Enter") {
            // A text that was refused is tried again, although it did not change.
            this.#commit();
            this.input.select();
        } else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
            event.preventDefault();
            const size = (event.key === "ArrowUp" ? 1 : -1) * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
            this.#step(this.#parse(this.input.value) ?? this.#value ?? 0, size);
        }
    }

    #step(from, size) {
        this.#gesture ||= nextGesture();
        const value = Number(this.#clamp(this.#scale.step(from, size)).toPrecision(6));
        if (value === this.#value) return;
        this.accepted?.();
        this.show(value, true);
        this.#change(value, this.#gesture, false);
    }

    #clamp(value) {
        const { least = -Infinity, most = Infinity } = this.#scale;
        return Math.min(most, Math.max(least, value));
    }

    #endGesture() {
        if (this.#gesture === 0) return;
        this.#gesture = 0;
        this.#change(this.#value, null, true);
    }

    #drag(handle) {
        let [at, from, taken] = [0, 0, 0];
        handle.classList.add("scrub");
        handle.addEventListener("pointerdown", (event) => {
            if (event.button !== 0 || this.#value === null || this.input.disabled) return;
            handle.setPointerCapture(event.pointerId);
            [at, from, taken] = [event.clientX, this.#value, 0];
        });
        handle.addEventListener("pointermove", (event) => {
            if (!handle.hasPointerCapture(event.pointerId)) return;
            const steps = Math.trunc((event.clientX - at) / DRAG);
            if (steps === taken) return;
            taken = steps;
            this.#step(from, steps * (event.shiftKey ? 10 : 1));
        });
        handle.addEventListener("lostpointercapture", () => this.#endGesture());
    }
}
