// The panel of the scene's lights.

import { split } from "./color.js";
import { byId, icon, make, setText } from "./dom.js";
import { nextGesture } from "./gesture.js";
import { face, moveTo, newLight, PLACE, polar, turnTo } from "./placement.js";
import { CheckRow, ColorRow, NumberRow, NumbersRow } from "./row.js";
import { linear, logarithmic, logarithmicFromZero } from "./scale.js";
import { length, normalize, scale } from "./vector.js";

const KINDS = {
    rectangle: { name: "Rectangle", strength: "radiance" },
    ellipse: { name: "Ellipse", strength: "radiance" },
    sphere: { name: "Sphere", strength: "radiance" },
    distant: { name: "Sun", strength: "irradiance" },
    spot: { name: "Spot", strength: "intensity" },
    beam: { name: "Beam", strength: "power" },
};

/** What can be added. */
const NEW = { rectangle: "Rectangle", ellipse: "Ellipse", sphere: "Sphere", distant: "Sun", spot: "Spot", point: "Point", beam: "Beam" };

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
            this.#build();
            this.#show();
        });
    }

    #listen() {
        const choice = byId("light-add");
        choice.append(...Object.entries(NEW).map(([value, name]) => make("option", { value }, name)));
        choice.addEventListener("change", async () => {
            const { look, hello, state } = this.#session;
            const light = newLight(choice.value, hello.bounds, state.camera);
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
        const kinds = this.#session.look.lights.map(({ kind }) => kind);
        if (kinds.join() === this.#kinds) return;
        this.#kinds = kinds.join();
        this.#shows = [];
        const none = make("p", { className: "description" }, "The scene has no lights of its own.");
        const sections = kinds.map((kind, index) => this.#section(kind, index, this.#open?.[index] ?? (index === 0 || kinds.length <= 2)));
        this.#open = null;
        byId("light-rows").replaceChildren(...(sections.length > 0 ? sections : [none]));
    }

    #section(kind, index, open) {
        const { bounds, unit } = this.#session.hello;
        const { name, strength } = KINDS[kind];
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

        const turn = (key, label, most) => row(NumberRow, key, label, (l) => polar(l, bounds.center)[key],
            (l, value) => {
                const angles = { ...polar(l, bounds.center), [key]: value };
                return turnTo(l, bounds.center, angles.azimuth, angles.elevation);
            },
            { scale: linear(-most, most), limits: { least: -most, most }, unit: "\u00b0", hint: "Around the middle of the scene" });
        turn("azimuth", "Azimuth", 180);
        turn("elevation", "Elevation", 90);
        const place = PLACE[kind];
        const span = logarithmic(bounds.radius * 0.05, bounds.radius * 50);
        if (place) {
            row(NumberRow, "distance", "Distance", (l) => polar(l, bounds.center).distance,
                (l, value) => moveTo(l, bounds.center, value), { scale: span, limits: { least: 0 }, unit, hint: "From the middle of the scene" });
            const step = (value, size) => value + size * bounds.radius * 0.02;
            row(NumbersRow, "place", "Place", (l) => l[place], (l, value) => ({ ...l, [place]: value }),
                { letters: ["X", "Y", "Z"], parts: ["x", "y", "z"], unit, scale: { step }, hint: place });
        }
        const size = { ...logarithmic(bounds.radius * 1e-3, bounds.radius * 10), least: 0 };
        const isFlat = kind === "rectangle" || kind === "ellipse";
        if (isFlat) {
            row(NumbersRow, "size", "Size", (l) => [length(l.edge_x), length(l.edge_y)],
                (l, [width, height]) => ({
                    ...l,
                    edge_x: scale(normalize(l.edge_x), width),
                    edge_y: scale(normalize(l.edge_y), height),
                }),
                { letters: ["W", "H"], parts: ["width", "height"], unit, scale: size });
        }
        const plain = (key, label, options) =>
            row(NumberRow, key, label, (l) => l[key], (l, value) => ({ ...l, [key]: value }), options);
        if (kind === "sphere" || kind === "beam") plain("radius", "Radius", { scale: size, unit, limits: { least: 0 } });
        if (kind === "distant") plain("angular_radius", "Angular radius", { scale: logarithmicFromZero(0.01, 89), unit: "\u00b0", limits: { least: 0 } });
        if (kind === "spot") {
            plain("inner_angle", "Inner angle", { scale: linear(0, 90), unit: "\u00b0" });
            plain("outer_angle", "Outer angle", { scale: linear(0, 180), unit: "\u00b0", hint: "180\u00b0: light to all sides" });
        }
        if (kind === "spot") plain("radius", "Radius", { scale: { ...logarithmicFromZero(bounds.radius * 1e-3, bounds.radius * 10) }, unit, limits: { least: 0 } });
        if (isFlat || kind === "sphere" || kind === "spot") {
            row(CheckRow, "visible", "Visible", (l) => l.visible, (l, visible) => ({ ...l, visible }), { hint: "Whether the camera sees it" });
        }
        const buttons = make("div", { className: "buttons" });
        const button = (key, text, act) => {
            const made = make("button", { id: `${id}-${key}`, type: "button", className: "plain" }, text);
            made.addEventListener("click", act);
            buttons.append(made);
        };
        if (isFlat || kind === "spot" || kind === "beam") {
            button("face", "Face the middle of the scene", () => {
                this.#session.setLight(index, face(light(), bounds.center), { gesture: nextGesture() });
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
        const title = make("span");
        this.#shows.push(() => setText(title, `${light().outer_angle === 180 ? NEW.point : name} ${index + 1}`));
        const summary = make("summary", {}, title, chip);
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
