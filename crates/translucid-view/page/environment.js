// The light from all around: an even one, or an image of the scene or from the computer.

import { split } from "./color.js";
import { byId } from "./dom.js";
import { areScene, sendEnvironment } from "./host.js";
import { CheckRow, ChoiceRow, ColorRow, NumberRow } from "./row.js";
import { linear, logarithmic, logarithmicFromZero } from "./scale.js";
import { scale } from "./vector.js";

/** What an environment is that was switched on. */
const EVEN = { radiance: [0.5, 0.5, 0.5], image: null, rotation: 0, visible: true };
/** Most bytes of an upload. */
const MOST = 128 * 2 ** 20;

export class EnvironmentPanel {
    #session;
    #notices;
    #rows = null;
    #images = null;
    #file = byId("environment-file");
    #load = byId("environment-load");

    constructor(session, notices) {
        this.#session = session;
        this.#notices = notices;
        session.on("state", () => {
            this.#rows ??= this.#build();
            this.#show();
        });
        this.#load.addEventListener("click", () => this.#file.click());
        this.#file.addEventListener("change", () => {
            if (this.#file.files[0]) this.upload(this.#file.files[0]);
            this.#file.value = "";
        });
        this.#drops();
    }

    /** Sends an image from the computer, which becomes the environment. */
    async upload(file) {
        if (file.size > MOST) {
            return this.#notices.error({ message: `${file.name} has ${Math.ceil(file.size / 2 ** 20)} MiB`, help: "at most 128" });
        }
        this.#load.disabled = true;
        const progress = this.#notices.say(`Loading ${file.name} \u2026`);
        try {
            const error = await sendEnvironment(file);
            if (error) this.#notices.error({ ...error, message: `${file.name}: ${error.message}` });
        } catch {
            this.#notices.error({ message: `${file.name} was not sent: the connection was lost` });
        }
        progress.close();
        this.#load.disabled = false;
    }

    #build() {
        const session = this.#session;
        const row = (Kind, key, name, set, options = {}) => {
            const change = session.editing((value, how) => {
                session.setEnvironment(set(session.look.environment ?? EVEN, value), how);
            });
            const made = new Kind({ id: `environment-${key}`, name, change, ...options });
            byId("environment-rows").append(made.element);
            return made;
        };
        return {
            on: row(CheckRow, "on", "On", (_, on) => (on ? EVEN : null)),
            image: row(ChoiceRow, "image", "Image", (e, value) => ({ ...e, image: value === "" ? null : Number(value) }), { options: [] }),
            strength: row(NumberRow, "strength", "Strength", (e, value) => ({ ...e, radiance: scale(split(e.radiance).hue, value) }),
                { scale: logarithmicFromZero(1e-3, 1e3), limits: { least: 0 }, hint: "radiance; the color is kept" }),
            color: row(ColorRow, "color", "Color", (e, radiance) => ({ ...e, radiance }),
                { hasStrength: true, hint: "radiance", scale: { ...logarithmic(1e-3, 1e3), least: 0 } }),
            rotation: row(NumberRow, "rotation", "Rotation", (e, rotation) => ({ ...e, rotation }),
                { scale: linear(-180, 180), unit: "\u00b0", hint: "Counter-clockwise from above" }),
            visible: row(CheckRow, "visible", "Visible", (e, visible) => ({ ...e, visible }), { hint: "Whether the camera sees it" }),
        };
    }

    #show() {
        const { images } = this.#session.state;
        const { environment } = this.#session.look;
        const { on, image, ...rest } = this.#rows;
        on.show(environment !== null);
        const names = JSON.stringify(images);
        if (names !== this.#images) {
            this.#images = names;
            const list = images.map(({ name, width, height }, value) => ({ value, name: `${name}, ${width} \u00d7 ${height}` }));
            image.setOptions([{ value: "", name: "None: even light" }, ...list]);
        }
        for (const row of [image, ...Object.values(rest)]) row.disabled = environment === null;
        const shown = environment ?? EVEN;
        image.show(shown.image ?? "");
        rest.strength.show(split(shown.radiance).strength);
        rest.color.show(shown.radiance);
        rest.rotation.show(((((shown.rotation + 180) % 360) + 360) % 360) - 180);
        rest.visible.show(shown.visible);
    }

    /** A file may be dropped anywhere on the page. */
    #drops() {
        const target = byId("drop");
        const hasFile = (event) => [...event.dataTransfer.types].includes("Files");
        addEventListener("dragenter", (event) => hasFile(event) && (target.hidden = false));
        addEventListener("dragover", (event) => hasFile(event) && event.preventDefault());
        addEventListener("dragleave", (event) => event.relatedTarget === null && (target.hidden = true));
        addEventListener("drop", (event) => {
            target.hidden = true;
            if (!hasFile(event)) return;
            event.preventDefault();
            const files = [...event.dataTransfer.files];
            if (files.length > 0 && !areScene(files)) this.upload(files[0]);
        });
    }
}
