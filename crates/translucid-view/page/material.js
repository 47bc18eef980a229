// The panel of the material that is selected.

import { byId, make, setText } from "./dom.js";
import { nextGesture } from "./gesture.js";
import { meanFreePath } from "./mean-free-path.js";
import { ChoiceRow, ColorRow, NumberRow, SwitchRow } from "./row.js";
import { linear, logarithmicFromZero } from "./scale.js";

/** Sections in the order of their use; every parameter of the server is in the one of its prefix. */
const SECTIONS = [
    ["subsurface", "Subsurface", true],
    ["base", "Base", true],
    ["specular", "Specular", true],
    ["coat", "Coat", false],
    ["transmission", "Transmission", false],
    ["emission", "Emission", false],
    ["geometry", "Geometry", false],
];

const NAMES = {
    specular_ior: "Index of refraction",
    coat_ior: "Index of refraction",
    subsurface_color: "Surface albedo A",
    subsurface_scatter_anisotropy: "Anisotropy g",
    subsurface_eta: "Relative index \u03b7",
};

const WORDS = {
    mfp: ["\u2113 volume", "mfp: mean free path in the volume"],
    dmfp: ["\u2113d surface", "dmfp: diffuse mean free path on the surface"],
    exit: ["Exit", "The albedo and the length where light leaves count"],
    entry: ["Entry", "The albedo and the length where light enters count"],
    both: ["Both", "The geometric means of both count"],
    none: ["None", "The profile is that of a half space"],
    energy: ["Energy", "Even light returns A from any shape"],
};

/** Which material is selected, and its panel. */
export class MaterialPanel {
    index = null;

    #session;
    #choice = byId("material");
    #preset = byId("preset");
    #rows = new Map();
    #shown = null;
    #scene = null;
    #onSelect = new Set();

    constructor(session) {
        this.#session = session;
        session.on("hello", ({ name }) => {
            if (name !== this.#scene) this.index = null;
            this.#scene = name;
        });
        session.on("state", () => {
            this.#build(session.hello);
            this.#show();
        });
        this.#choice.addEventListener("change", () => this.select(Number(this.#choice.value)));
        this.#preset.addEventListener("change", () => this.#applyPreset());
        this.#preset.addEventListener("blur", () => (this.#preset.value = ""));
    }

    onSelect(listener) {
        this.#onSelect.add(listener);
    }

    get material() {
        return this.#session.look.materials[this.index];
    }

    select(index) {
        this.index = index;
        this.#show();
        for (const listener of this.#onSelect) listener(index);
    }

    #applyPreset() {
        const preset = this.#preset.value;
        if (!preset) return;
        this.#session.setMaterial(this.index, { preset }, { gesture: nextGesture() });
        this.#session.settle();
    }

    #set(set, options) {
        this.#session.setMaterial(this.index, set, options);
    }

    #build(hello) {
        const text = JSON.stringify([hello.parameters, hello.models, hello.words, hello.presets]);
        if (text === this.#shown) return;
        this.#shown = text;
        this.#rows.clear();
        this.#preset.replaceChildren(make("option", { value: "" }, "Preset \u2026"), ...presetGroups(hello.presets));
        const sections = SECTIONS.map(([prefix, title, open]) => {
            const body = make("div", { className: "rows" });
            if (prefix === "subsurface") this.#subsurface(body, hello);
            for (const parameter of hello.parameters) {
                if (parameter.name.startsWith(`${prefix}_`) && !this.#rows.has(parameter.name)) {
                    this.#add(body, parameter.name, this.#row(parameter, hello));
                }
            }
            return make("details", { open, id: `section-${prefix}` }, make("summary", {}, title), body);
        });
        byId("material-rows").replaceChildren(...sections);
    }

    #add(body, key, row) {
        this.#rows.set(key, row);
        body.append(row.element);
    }

    /** The rows that are not as any other parameter's. */
    #subsurface(body, hello) {
        const parameter = (name) => hello.parameters.find((parameter) => parameter.name === name);
        const word = (key, name, Kind) => {
            const options = hello.words[key].map((value) => {
                const [text, title] = WORDS[value] ?? [capital(value), ""];
                return { value, name: text, title };
            });
            const change = this.#session.editing((value, how) => this.#set({ [key]: value }, how));
            this.#add(body, key, new Kind({ id: `material-${key}`, name, options, change, hint: key }));
        };
        this.#add(body, "subsurface_weight", this.#row(parameter("subsurface_weight"), hello));
        const options = hello.models.map(({ name, description }) => ({ value: name, name, title: description }));
        const change = this.#session.editing((value, how) => this.#set({ subsurface_model: value }, how));
        const id = "material-subsurface_model";
        this.#add(body, "subsurface_model", new ChoiceRow({ id, name: "Model", options, change, hint: "subsurface_model" }));
        this.description = make("p", { className: "description" });
        body.append(this.description);
        this.#add(body, "subsurface_color", this.#albedo());
        word("subsurface_parameter", "Length", SwitchRow);
        for (const [key, row] of meanFreePath(this.#session, this)) this.#add(body, key, row);
        word("subsurface_configuration", "Light enters", SwitchRow);
        for (const name of ["subsurface_scatter_anisotropy", "subsurface_eta"]) {
            this.#add(body, name, this.#row(parameter(name), hello));
        }
        word("subsurface_texture_at", "Texture at", SwitchRow);
        word("subsurface_normalization", "Normalization", SwitchRow);
    }

    /** Surface albedo: a swatch, and a slider for each channel. */
    #albedo() {
        const session = this.#session;
        const key = "subsurface_color";
        const id = `material-${key}`;
        const edit = session.editing((value, how) => this.#set({ [key]: value }, { ...how, key }));
        const color = new ColorRow({ id, name: NAMES[key], change: edit, hint: key, className: "main", hasFields: false });
        const sliders = ["red", "green", "blue"].map((name, i) => {
            const change = (value, ...rest) => edit(this.material.parameters[key].value.with(i, value), ...rest);
            const labels = { [key]: NAMES[key] };
            const options = { id: `${id}-${name}`, name: capital(name), scale: linear(0, 1), change, hint: key, labels };
            return new NumberRow({ ...options, className: `channel ${name[0]}` });
        });
        const element = make("div", { className: "joined" }, color.element, ...sliders.map((row) => row.element));
        return {
            element,
            show(value) {
                color.show(value);
                sliders.forEach((row, i) => row.show(value[i]));
            },
            mark: (...texts) => color.mark(...texts),
        };
    }

    #row({ name: key, kind, min, max }, { unit }) {
        const id = `material-${key}`;
        const name = NAMES[key] ?? capital(key.slice(key.indexOf("_") + 1).replaceAll("_", " "));
        const change = this.#session.editing((value, how) => this.#set({ [key]: value }, how));
        if (kind === "color") return new ColorRow({ id, name, change, hint: key, hasStrength: max > 1 });
        const scale = max > 100 ? logarithmicFromZero(1e-3, 1e3) : linear(min, max);
        const isLength = key.endsWith("_depth") || key.endsWith("_radius");
        return new NumberRow({ id, name, scale, change, hint: key, unit: isLength ? unit : "", limits: { least: min, most: max } });
    }

    #show() {
        const { materials } = this.#session.look;
        this.index ??= firstTranslucent(materials);
        this.index = Math.min(this.index, materials.length - 1);
        this.#list(materials);
        const material = materials[this.index];
        byId("material-panel").classList.toggle("empty", !material);
        if (!material) return;
        for (const [key, row] of this.#rows) {
            const parameter = material.parameters[key];
            row.show(parameter ? parameter.value : material[key]);
            if (parameter && row.mark) markTexture(row, parameter);
        }
        const model = this.#session.hello.models.find(({ name }) => name === material.model);
        const chosen = material.model === material.subsurface_model ? "" : `${material.model}. `;
        setText(this.description, `${chosen}${model?.description ?? ""}`);
    }

    #list(materials) {
        const names = materials.map(({ name }) => name);
        const options = [...this.#choice.options].map(({ text }) => text);
        if (names.join("\n") !== options.join("\n")) {
            this.#choice.replaceChildren(...names.map((name, value) => make("option", { value }, name)));
        }
        this.#choice.value = String(this.index);
    }
}

function firstTranslucent(materials) {
    return Math.max(0, materials.findIndex(({ parameters: { subsurface_weight: weight } }) => weight.value > 0));
}

function markTexture(row, { image, vertex }) {
    const source = [image && "image", vertex && "vertex colors"].filter(Boolean).join(" and ");
    row.mark(source ? `\u00d7 ${image ? "image" : "vertex"}` : null, source && `A factor on the ${source}`);
}

/** Pictures in a row of presets.jpg, which has them in the order of the list. */
const COLUMNS = 10;

/** Options with pictures, which browsers show that can style a menu. */
function presetGroups(presets) {
    const groups = new Map();
    presets.forEach(({ name, source, group }, i) => {
        if (!groups.has(group)) groups.set(group, make("optgroup", { label: capital(group) }));
        const picture = make("span", { className: "thumbnail" });
        picture.style.setProperty("--column", i % COLUMNS);
        picture.style.setProperty("--row", Math.floor(i / COLUMNS));
        groups.get(group).append(make("option", { value: name, title: source }, picture, name));
    });
    return groups.values();
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
