// Rows of a panel: a label, the controls of one value, and the server's objections to it.

import { fromHex, split, toHex } from "./color.js";
import { make, setText } from "./dom.js";
import { NumberField } from "./field.js";
import { nextGesture } from "./gesture.js";
import { format } from "./numbers.js";
import { Slider } from "./slider.js";
import { MILLIMETERS, readable } from "./units.js";
import { COLOR_PARTS, inWords } from "./words.js";

const CHANNELS = ["r", "g", "b"];

/** What all rows have: `element`, `refuse(error)` and `accept()` for the server's answer. */
class Row {
    /** `hint` begins with the key of what is shown, if it is one; `labels` are what messages call it and other keys. */
    constructor(id, name, { hint, labels, className = "", tag = "label" } = {}) {
        this.labels = labels ?? { [/^\w*/.exec(hint ?? "")[0]]: name };
        this.label = make(tag, { id: `${id}-label`, title: hint ?? "" }, name);
        this.badge = make("span", { className: "badge", hidden: true });
        this.error = make("p", { id: `${id}-error`, className: "error", hidden: true, role: "alert" });
        this.controls = make("div", { className: "controls" });
        this.element = make(
            "div",
            { className: `row ${className}` },
            make("div", { className: "name" }, this.label, this.badge),
            this.controls,
            this.error,
        );
        this.inputs = [];
    }

    add(input, ...more) {
        this.inputs.push(input);
        this.controls.append(input, ...more);
    }

    refuse({ message: plain, help }) {
        const message = inWords(plain, this.labels, this.parts);
        setText(this.error, help ? `${message} \u2013 ${help}` : message);
        this.error.hidden = false;
        for (const input of this.inputs) {
            input.setAttribute("aria-invalid", "true");
            input.setAttribute("aria-describedby", this.error.id);
        }
    }

    accept() {
        if (this.error.hidden) return;
        this.error.hidden = true;
        for (const input of this.inputs) {
            input.removeAttribute("aria-invalid");
            input.removeAttribute("aria-describedby");
        }
    }

    /** Says that the value is a factor on an image or on vertex colors. */
    mark(text, title) {
        this.badge.hidden = !text;
        setText(this.badge, text ?? "");
        this.badge.title = title ?? "";
    }

    set disabled(disabled) {
        for (const input of this.inputs) input.disabled = disabled;
        this.element.classList.toggle("disabled", disabled);
    }

    field(options) {
        const field = new NumberField(options);
        field.refused = (error) => this.refuse(error);
        field.accepted = () => this.accept();
        return field;
    }
}

/**
 * A slider and a field for a number.
 *
 * `change(value, gesture, isFinal, row)`, here and in the rows below: `gesture` is null where the value has been told
 * before and only the end of the gesture is new.
 */
export class NumberRow extends Row {
    constructor({ id, name, unit = "", scale, limits, change, hint, labels, className }) {
        super(id, name, { hint, labels, className });
        this.label.htmlFor = id;
        const labelledby = `${id}-label`;
        const isLength = unit in MILLIMETERS;
        const suffix = make("span", { className: unit === "\u00b0" ? "unit degrees" : "unit" }, unit);
        const text = (value) => {
            const shown = isLength ? readable(value, unit) : unit;
            return unit ? `${format(isLength ? value * MILLIMETERS[unit] / MILLIMETERS[shown] : value)} ${shown}` : format(value);
        };
        const onChange = (value, gesture, isFinal) => change(value, gesture, isFinal, this);
        this.slider = new Slider({ id: `${id}-slider`, labelledby, scale, text, change: (value, ...rest) => {
            this.numberField.show(value, true);
            onChange(value, ...rest);
        } });
        this.numberField = this.field({
            id,
            labelledby,
            scale: { ...scale, ...limits },
            change: onChange,
            handle: this.label,
            unit: isLength ? unit : undefined,
            onUnit: (name) => setText(suffix, name),
        });
        this.add(this.slider.input);
        this.inputs.push(this.numberField.input);
        this.controls.append(make("span", { className: "suffixed" }, this.numberField.input, unit && suffix));
    }

    show(value) {
        this.slider.show(value);
        if (!this.slider.isHeld) this.numberField.show(value);
    }
}

/** Fields for numbers without a slider, such as a place; each is dragged at its letter. */
export class NumbersRow extends Row {
    #values = [];

    constructor({ id, name, letters, parts, unit, scale, change, hint, className = "" }) {
        super(id, name, { hint, className: `fields ${className}` });
        if (letters[0] !== "R") this.parts = parts;
        this.label.htmlFor = `${id}-${parts[0]}`;
        if (unit) this.label.append(make("span", { className: "unit" }, unit));
        this.fields = parts.map((part, i) => {
            const letter = make("span", { className: `letter ${letters[i].length === 1 ? part : ""}` }, letters[i]);
            const field = this.field({
                id: `${id}-${part}`,
                label: `${name}, ${part}`,
                scale,
                handle: letter,
                change: (value, gesture, isFinal) => {
                    this.#values = this.#values.with(i, value);
                    change(this.#values, gesture, isFinal, this);
                },
            });
            this.inputs.push(field.input);
            this.controls.append(make("span", { className: "lettered" }, letter, field.input));
            return field;
        });
    }

    show(values) {
        this.#values = [...values];
        values.forEach((value, i) => this.fields[i].show(value));
    }
}

/** A swatch that opens the browser's picker, and a field for each channel. */
export class ColorRow extends Row {
    #value = [1, 1, 1];

    /** `hasStrength`: the swatch keeps the greatest channel. Without `hasFields` there is the swatch alone. */
    constructor({ id, name, change, hint, hasStrength = false, hasFields = true, className = "", scale }) {
        super(id, name, { hint, className: `color ${className}` });
        this.label.htmlFor = `${id}-swatch`;
        this.hasStrength = hasStrength;
        let gesture = 0;
        this.swatch = make("input", { id: `${id}-swatch`, type: "color", className: "swatch", "aria-label": `${name}, swatch` });
        const set = (value, ...rest) => {
            this.#value = value;
            change(value, ...rest, this);
        };
        this.swatch.addEventListener("input", () => {
            gesture ||= nextGesture();
            set(this.#fromSwatch(), gesture, false);
        });
        this.swatch.addEventListener("change", () => {
            gesture = 0;
            change(this.#value, null, true, this);
        });
        this.add(this.swatch);
        const channels = hasFields ? CHANNELS : [];
        this.fields = channels.map((channel, i) => {
            const letter = make("span", { className: `letter ${channel}` }, channel.toUpperCase());
            const field = this.field({
                id: `${id}-${channel}`,
                label: `${name}, ${COLOR_PARTS[i]}`,
                digits: 3,
                scale: scale ?? { step: (value, size) => value + size * 0.01, least: 0 },
                handle: letter,
                change: (value, gesture, isFinal) => set(this.#value.with(i, value), gesture, isFinal),
            });
            this.inputs.push(field.input);
            this.controls.append(make("span", { className: "lettered" }, letter, field.input));
            return field;
        });
    }

    #fromSwatch() {
        const color = fromHex(this.swatch.value);
        if (!this.hasStrength) return color;
        const { strength } = split(this.#value);
        const { hue } = split(color);
        return hue.map((x) => x * (strength || 1));
    }

    show(value) {
        this.#value = [...value];
        const hex = toHex(this.hasStrength ? split(value).hue : value);
        if (this.swatch.value !== hex && document.activeElement !== this.swatch) this.swatch.value = hex;
        this.fields.forEach((field, i) => field.show(value[i]));
    }
}

/** A menu of words. `options` are {value, name, group?, title?}. */
export class ChoiceRow extends Row {
    constructor({ id, name, options, change, hint }) {
        super(id, name, { hint, className: "choice" });
        this.label.htmlFor = id;
        this.select = make("select", { id });
        this.setOptions(options);
        this.select.addEventListener("change", () => change(this.select.value, nextGesture(), true, this));
        this.add(this.select);
    }

    setOptions(options) {
        const groups = new Map();
        const children = [];
        for (const { value, name, group } of options) {
            const option = make("option", { value }, name);
            if (!group) {
                children.push(option);
                continue;
            }
            if (!groups.has(group)) {
                groups.set(group, make("optgroup", { label: group }));
                children.push(groups.get(group));
            }
            groups.get(group).append(option);
        }
        this.select.replaceChildren(...children);
    }

    show(value) {
        const text = String(value);
        if (this.select.value === text) return;
        // A table of the scene's own is no model of the list.
        if (![...this.select.options].some((option) => option.value === text)) {
            this.select.append(make("option", { value: text }, text));
        }
        this.select.value = text;
    }
}

/** Two or three words beside each other, as radio buttons. */
export class SwitchRow extends Row {
    constructor({ id, name, options, change, hint }) {
        super(id, name, { hint, className: "switch", tag: "span" });
        const group = make("div", { className: "segments", role: "radiogroup", "aria-labelledby": `${id}-label` });
        this.radios = options.map(({ value, name: text, title }) => {
            const radio = make("input", { type: "radio", name: id, id: `${id}-${value}`, value });
            radio.addEventListener("change", () => radio.checked && change(value, nextGesture(), true, this));
            this.inputs.push(radio);
            group.append(make("label", { title: title ?? "", htmlFor: radio.id }, radio, make("span", {}, ...subscript(text))));
            return radio;
        });
        this.controls.append(group);
    }

    show(value) {
        for (const radio of this.radios) radio.checked = radio.value === value;
    }
}

/** \u2113d with its d below the line. */
function subscript(text) {
    const [before, after] = text.split("\u2113d");
    return after === undefined ? [text] : [before, "\u2113", make("sub", {}, "d"), after];
}

/** Yes or no. */
export class CheckRow extends Row {
    constructor({ id, name, change, hint }) {
        super(id, name, { hint, className: "check" });
        this.label.htmlFor = id;
        this.box = make("input", { id, type: "checkbox" });
        this.box.addEventListener("change", () => change(this.box.checked, nextGesture(), true, this));
        this.add(this.box);
    }

    show(value) {
        this.box.checked = value;
    }
}
