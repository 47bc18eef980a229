// The panel of the rendering: samples, method, film, camera.

import { isOrthographic } from "./camera.js";
import { byId, make } from "./dom.js";
import { nextGesture } from "./gesture.js";
import { CheckRow, ChoiceRow, NumberRow, NumbersRow } from "./row.js";
import { linear, logarithmic, logarithmicFromZero } from "./scale.js";
import { add, distance, length, scale as stretch, subtract } from "./vector.js";

const SIZES = [[480, 270], [960, 540], [1280, 720], [1920, 1080], [512, 512], [1024, 1024]];

/** Whole numbers, by steps of one. */
const whole = (min, max) => {
    const scale = logarithmic(min, max);
    return {
        ...scale,
        toValue: (t) => Math.round(scale.toValue(t)),
        step: (value, size) => value + Math.sign(size) * Math.max(1, Math.round(Math.abs(size))),
        least: min,
    };
};

export class RenderPanel {
    #session;
    #picture;
    #shows = null;

    constructor(session, picture) {
        this.#session = session;
        this.#picture = picture;
        session.on("state", () => {
            this.#shows ??= this.#build();
            for (const show of this.#shows) show();
        });
    }

    #build() {
        return [...this.#mesh(), ...this.#integrator(), ...this.#film(), ...this.#camera()];
    }

    /** How a bare mesh is turned; its camera and lights follow. */
    #mesh() {
        const session = this.#session;
        const set = (part) => session.editing((value, how) => session.setOrientation({ ...session.state.orientation, [part]: value }, how));
        const up = new ChoiceRow({
            id: "mesh-up",
            name: "Up",
            options: session.hello.up.map((value) => ({ value, name: value.replace("-", "\u2212") })),
            hint: "up: the axis of the file that points up",
            change: set("up"),
        });
        const turn = new NumbersRow({
            id: "mesh-turn",
            name: "Turn",
            letters: ["X", "Y", "Z"],
            parts: ["x", "y", "z"],
            unit: "\u00b0",
            scale: { step: (value, size) => value + 5 * size },
            hint: "rotate: about x, then y, then z, once up is up",
            change: set("rotate"),
        });
        byId("mesh-rows").append(up.element, turn.element);
        const show = () => {
            const { orientation } = session.state;
            byId("section-mesh").hidden = !orientation;
            if (!orientation) return;
            up.show(orientation.up);
            turn.show(orientation.rotate);
        };
        return [show];
    }

    #integrator() {
        const session = this.#session;
        const { words } = session.hello;
        const row = (Kind, key, name, options = {}) => {
            const change = session.editing((value, how) => session.setIntegrator({ [key]: value }, how));
            const made = new Kind({ id: `integrator-${key}`, name, change, hint: key, ...options });
            byId("integrator-rows").append(made.element);
            return () => made.show(session.look.integrator[key]);
        };
        const methods = words.subsurface_method.map((value) => ({ value, name: value }));
        return [
            row(NumberRow, "samples_per_pixel", "Samples per pixel", { scale: whole(1, 4096) }),
            row(ChoiceRow, "subsurface_method", "Method", { options: methods }),
            this.#denoising(),
            ...(session.hello.devices.length > 1 ? [this.#device()] : []),
            row(CheckRow, "subsurface_sharing", "Share light", { hint: "subsurface_sharing: light that has entered serves the pixels around, too" }),
            row(NumberRow, "max_depth", "Depth", { scale: whole(1, 64), hint: "max_depth: most scattering events on a path" }),
            row(NumberRow, "max_diffuse_depth", "Diffuse depth", {
                scale: { ...linear(0, 32), toValue: (t) => Math.round(32 * t), step: (value, size) => value + Math.sign(size) },
                limits: { least: 0 },
                hint: "max_diffuse_depth: most diffuse or subsurface events among them",
            }),
            row(CheckRow, "caustics", "Caustics"),
            row(NumberRow, "seed", "Seed", { scale: { ...linear(0, 1000), toValue: (t) => Math.round(1000 * t), step: (value, size) => value + Math.sign(size) }, limits: { least: 0 } }),
        ];
    }

    /** Not a key of the scene: the finished picture is never denoised. */
    #denoising() {
        const session = this.#session;
        const row = new CheckRow({
            id: "denoise",
            name: "Denoise until done",
            hint: "What is shown while samples are added, by the denoiser or, where there is none, by a filter. The finished picture, comparisons and all files are as they were rendered.",
            change: (on) => session.command({ type: "denoise", on }),
        });
        const { text, hint } = session.hello.denoiser;
        const found = make("div", { className: "row" },
            make("div", { className: "name" }, "Denoiser"),
            make("div", { className: "controls" }, make("span", { id: "denoiser", title: hint }, text)));
        byId("integrator-rows").append(row.element, found);
        return () => row.show(session.state.denoise);
    }

    /** Not a key of the scene: every device finds the same light. */
    #device() {
        const session = this.#session;
        const row = new ChoiceRow({
            id: "device",
            name: "Device",
            options: session.hello.devices.map((value) => ({ value, name: value === "cpu" ? "Processor" : value })),
            hint: "Who traces the paths. Where a device lacks what the scene needs, the processor does, and a note says so.",
            change: (name) => session.command({ type: "device", name }),
        });
        byId("integrator-rows").append(row.element);
        return () => row.show(session.state.device);
    }

    #film() {
        const session = this.#session;
        const rows = byId("film-rows");
        const size = new NumbersRow({
            id: "film-size",
            name: "Size",
            letters: ["W", "H"],
            parts: ["width", "height"],
            unit: "px",
            scale: { step: (value, steps) => Math.round(value + steps * 2), least: 1, most: 16384 },
            hint: "size",
            change: session.editing((size, how) => session.setFilm({ size: size.map(Math.round) }, how)),
        });
        const options = SIZES.map(([w, h]) => ({ value: `${w}x${h}`, name: `${w} \u00d7 ${h}` }));
        const menu = new ChoiceRow({
            id: "film-presets",
            name: "Sizes",
            options: [{ value: "", name: "Choose \u2026" }, ...options],
            change: session.editing((value, how) => value && session.setFilm({ size: value.split("x").map(Number) }, how)),
        });
        const match = make("button", { id: "film-match", type: "button", className: "plain" }, "As large as the window shows it");
        match.addEventListener("click", () => {
            const { width, height } = byId("viewport").getBoundingClientRect();
            const [w, h] = [width, height].map((n) => Math.max(16, Math.floor((n - 32) * devicePixelRatio)));
            session.setFilm({ size: [w, h] }, { gesture: nextGesture() });
            session.settle();
        });
        rows.append(size.element, menu.element, make("div", { className: "buttons" }, match));
        return [
            () => size.show([session.state.film.width, session.state.film.height]),
            () => {
                const now = `${session.state.film.width}x${session.state.film.height}`;
                menu.select.value = options.some(({ value }) => value === now) ? now : "";
            },
        ];
    }

    #camera() {
        const session = this.#session;
        const { unit } = session.hello;
        const { bounds } = session.state;
        const row = (Kind, key, name, get, set, options) => {
            const change = session.editing((value, how) => session.setCamera(set(session.state.camera, value), { ...how, moving: true }));
            const made = new Kind({ id: `camera-${key}`, name, change, ...options });
            byId("camera-rows").append(made.element);
            return () => made.show(get(session.state.camera));
        };
        const plain = (key, name, options) => row(NumberRow, key, name, (c) => c[key], (c, value) => ({ ...c, [key]: value }), { hint: key, ...options });
        const step = (value, size) => value + size * bounds.radius * 0.02;
        const place = (key, name) => row(NumbersRow, key, name, (c) => c[key], (c, value) => ({ ...c, [key]: value }),
            { letters: ["X", "Y", "Z"], parts: ["x", "y", "z"], unit, scale: { step }, hint: key });
        return [
            isOrthographic(session.state.camera)
                ? plain("width", "Width", { scale: logarithmic(bounds.radius * 1e-2, bounds.radius * 100), unit, limits: { least: 0 }, hint: "width of the view" })
                : plain("fov", "Field of view", { scale: linear(5, 120), unit: "\u00b0", hint: "fov: the full horizontal angle" }),
            plain("lens_radius", "Lens radius", { scale: logarithmicFromZero(bounds.radius * 1e-4, bounds.radius * 0.5), unit, limits: { least: 0 } }),
            plain("focus_distance", "Focus", { scale: logarithmic(bounds.radius * 1e-2, bounds.radius * 100), unit, limits: { least: 0 }, hint: "focus_distance" }),
            row(NumberRow, "distance", "Distance", (c) => distance(c.position, c.target),
                (c, value) => {
                    const offset = subtract(c.position, c.target);
                    return { ...c, position: add(c.target, stretch(offset, value / length(offset))) };
                },
                { scale: logarithmic(bounds.radius * 1e-2, bounds.radius * 100), unit, limits: { least: 0 }, hint: "From position to target" }),
            place("position", "Position"),
            place("target", "Target"),
        ];
    }
}
