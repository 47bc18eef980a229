// The panel of the scene's lights.

import { split } from "./color.js";
import { byId, icon, make, setText } from "./dom.js";
import { nextGesture } from "./gesture.js";
import { face, moveTo, newLight, polar, turnTo } from "./placement.js";
import { CheckRow, ColorRow, NumberRow, NumbersRow } from "./row.js";
import { linear, logarithmic, logarithmicFromZero } from "./scale.js";
import { length, normalize, scale } from "./vector.js";

/** A name of a file as a label: "angular_radius" is "Angular radius". */
const label = (key) => key[0].toUpperCase() + key.slice(1).replaceAll("_", " ");

/** The name of a type of lights. */
const title = (name) => (name === "distant" ? "Sun" : label(name));

export class LightsPanel {
    #session;
    #kinds = null;
    #shows = [];
    /** Which sections are open, where lights come and go by this page. */
    #open = null;

    constructor(session) {
        this.#session = session;
        this.#listen();
        session.on("state", () => {
            this.#offer();
            this.#build();
            this.#show();
        });
    }

    /** Lists the types of lights that can be added. */
    #offer() {
        const choice = byId("light-add");
        if (choice.options.length > 1) return;
        choice.append(...this.#session.hello.lights.map(({ name }) => make("option", { value: name }, title(name))));
    }

    #kind(name) {
        return this.#session.hello.lights.find((kind) => kind.name === name);
    }

    #listen() {
        const choice = byId("light-add");
        choice.addEventListener("change", async () => {
            const { look, state } = this.#session;
            const light = newLight(this.#kind(choice.value), state.bounds, state.camera);
            choice.value = "";
            this.#open = [...look.lights.map((_, index) => this.#isOpen(index)), true];
            if (!(await this.#session.addLight(light))) this.#open = null;
        });
    }

    async #remove(index) {
        this.#open = this.#session.look.lights.map((_, i) => this.#isOpen(i)).toSpliced(index, 1);
        if (!(await this.#session.removeLight(index))) this.#open = null;
        else byId("light-add").focus();
    }

    #isOpen(index) {
        return byId(`section-light-${index}`)?.open ?? false;
    }

    #build() {
        const kinds = this.#session.look.lights.map(({ type }) => type);
        if (kinds.join() === this.#kinds) return;
        this.#kinds = kinds.join();
        this.#shows = [];
        const none = make("p", { className: "description" }, "The scene has no lights of its own.");
        const sections = kinds.map((name, index) => this.#section(this.#kind(name), index, this.#open?.[index] ?? (index === 0 || kinds.length <= 2)));
        this.#open = null;
        byId("light-rows").replaceChildren(...(sections.length > 0 ? sections : [none]));
    }

    #section(kind, index, open) {
        const { unit } = this.#session.hello;
        const { radius } = this.#session.state.bounds;
        const center = () => this.#session.state.bounds.center;
        const { name, strength, place, fields } = kind;
        const has = (of) => fields.some((field) => field.kind === of);
        const id = `light-${index}`;
        const body = make("div", { className: "rows" });
        const light = () => this.#session.look.lights[index];
        /** A row that shows `get(light)` and whose change makes another light by `set(light, value)`. */
        const row = (Kind, key, label, get, set, options = {}) => {
            const change = this.#session.editing((value, { gesture, control }) => {
                this.#session.setLight(index, set(light(), value), { gesture, control });
            });
            const made = new Kind({ id: `${id}-${key}`, name: label, change, ...options });
            body.append(made.element);
            this.#shows.push(() => made.show(get(light())));
        };

        const hue = (light) => split(light[strength]).hue;
        row(NumberRow, "strength", "Strength", (l) => split(l[strength]).strength,
            (l, value) => ({ ...l, [strength]: scale(hue(l), value) }),
            { scale: logarithmicFromZero(1e-3, 1e4), limits: { least: 0 }, hint: `${strength}; the color is kept. Type +1ev or *2 to change it by a factor.` });
        body.lastChild.querySelector(".controls").append(this.#stops(id, index, strength));
        row(ColorRow, "color", "Color", (l) => l[strength], (l, value) => ({ ...l, [strength]: value }),
            { hasStrength: true, hint: strength, scale: { ...logarithmic(1e-3, 1e4), least: 0 } });

        const turn = (key, label, most) => row(NumberRow, key, label, (l) => polar(l, kind, center())[key],
            (l, value) => {
                const angles = { ...polar(l, kind, center()), [key]: value };
                return turnTo(l, kind, center(), angles.azimuth, angles.elevation);
            },
            { scale: linear(-most, most), limits: { least: -most, most }, unit: "\u00b0", hint: "Around the middle of the scene" });
        turn("azimuth", "Azimuth", 180);
        turn("elevation", "Elevation", 90);
        const span = logarithmic(radius * 0.05, radius * 50);
        if (place) {
            row(NumberRow, "distance", "Distance", (l) => polar(l, kind, center()).distance,
                (l, value) => moveTo(l, kind, center(), value), { scale: span, limits: { least: 0 }, unit, hint: "From the middle of the scene" });
            const step = (value, size) => value + size * radius * 0.02;
            row(NumbersRow, "place", "Place", (l) => l[place], (l, value) => ({ ...l, [place]: value }),
                { letters: ["X", "Y", "Z"], parts: ["x", "y", "z"], unit, scale: { step }, hint: place });
        }
        const size = { ...logarithmic(radius * 1e-3, radius * 10), least: 0 };
        if (has("edges")) {
            row(NumbersRow, "size", "Size", (l) => [length(l.edge_x), length(l.edge_y)],
                (l, [width, height]) => ({
                    ...l,
                    edge_x: scale(normalize(l.edge_x), width),
                    edge_y: scale(normalize(l.edge_y), height),
                }),
                { letters: ["W", "H"], parts: ["width", "height"], unit, scale: size });
        }
        const plain = (Kind, { key, hint }, options) =>
            row(Kind, key, label(key), (l) => l[key], (l, value) => ({ ...l, [key]: value }), { hint, labels: { [key]: label(key) }, ...options });
        const scales = {
            length: ({ min }) => ({ scale: min > 0 ? size : logarithmicFromZero(radius * 1e-3, radius * 10), unit, limits: { least: 0 } }),
            // The disc of a sun is small
            angle: ({ min, max }) => ({ scale: max > 90 ? linear(min, max) : logarithmicFromZero(0.01, max), unit: "\u00b0", limits: { least: min } }),
            number: ({ min, max }) => ({ scale: linear(min, max), limits: { least: min, most: max } }),
        };
        for (const field of fields) {
            if (field.kind in scales) plain(NumberRow, field, scales[field.kind](field));
            if (field.kind === "flag") plain(CheckRow, field);
        }
        const buttons = make("div", { className: "buttons" });
        const button = (key, text, act) => {
            const made = make("button", { id: `${id}-${key}`, type: "button", className: "plain" }, text);
            made.addEventListener("click", act);
            buttons.append(made);
        };
        if (place && (has("edges") || has("direction"))) {
            button("face", "Face the middle of the scene", () => {
                this.#session.setLight(index, face(light(), kind, center()), { gesture: nextGesture() });
                this.#session.settle();
            });
        }
        button("remove", "Remove", () => this.#remove(index));
        body.append(buttons);
        const chip = make("span", { className: "chip" });
        this.#shows.push(() => {
            const { strength: value, hue } = split(light()[strength]);
            chip.style.backgroundColor = `color(srgb-linear ${hue.join(" ")})`;
            chip.classList.toggle("off", value === 0);
        });
        const heading = make("span");
        this.#shows.push(() => setText(heading, `${light().outer_angle === 180 ? "Point" : title(name)} ${index + 1}`));
        const summary = make("summary", {}, heading, chip);
        return make("details", { open, id: `section-${id}` }, summary, body);
    }

    /** Half a stop less, half a stop more. */
    #stops(id, index, strength) {
        const button = (key, stops, text, label) => {
            const made = make("button", { id: `${id}-${key}`, type: "button", className: "step", title: label, "aria-label": label }, icon(text));
            made.addEventListener("click", () => {
                const light = this.#session.look.lights[index];
                const next = { ...light, [strength]: scale(light[strength], 2 ** stops) };
                this.#session.setLight(index, next, { gesture: nextGesture() });
                this.#session.settle();
            });
            return made;
        };
        return make("span", { className: "steps" },
            button("darker", -0.5, "minus", "Half a stop darker"),
            button("brighter", 0.5, "plus", "Half a stop brighter"));
    }

    #show() {
        for (const show of this.#shows) show();
    }
}
