// The bar above the picture: camera, layer, exposure, tone mapping.

import { byId, make, setText } from "./dom.js";
import { NumberField } from "./field.js";
import { linear } from "./scale.js";
import { Slider } from "./slider.js";
import { inWords } from "./words.js";

/** Layers that exist only while two settings are compared. */
const OF_COMPARISON = ["difference", "flip"];
const NAMES = { flip: "\ua7fbLIP" };

export class ViewBar {
    #session;
    #navigation;
    #views = "";
    #cameras = null;

    constructor(session, navigation) {
        this.#session = session;
        this.#navigation = navigation;
        const cameras = byId("camera");
        cameras.addEventListener("change", () => {
            const { camera } = session.state.cameras[Number(cameras.value)] ?? {};
            if (camera) navigation.goTo(camera);
        });
        cameras.addEventListener("blur", () => (cameras.value = ""));
        byId("frame-all").addEventListener("click", () => this.frameAll());
        byId("view").addEventListener("change", () => session.command({ type: "show", view: byId("view").value }));
        byId("tone").addEventListener("change", () => {
            session.setFilm({ tone_mapping: byId("tone").value }, {});
            session.settle();
        });
        this.#exposure();
        session.on("hello", (hello) => this.#fill(hello));
        session.on("state", (state) => this.#show(state));
    }

    /** Turns the camera so that everything is in the picture. */
    frameAll() {
        if (this.#session.state) this.#session.command({ type: "frame" });
    }

    /** The next layer of the menu, or the one before. */
    nextView(step) {
        const options = [...byId("view").options].map(({ value }) => value);
        const at = options.indexOf(this.#session.state.view);
        this.#session.command({ type: "show", view: options[(at + step + options.length) % options.length] });
    }

    #exposure() {
        const scale = linear(-8, 8);
        const change = this.#session.editing((exposure, how) => this.#session.setFilm({ exposure }, how));
        const error = byId("exposure-error");
        const control = {
            refuse: ({ message }) => {
                setText(error, inWords(message, { exposure: "Exposure" }));
                error.hidden = false;
                this.field.input.setAttribute("aria-invalid", "true");
            },
            accept: () => {
                error.hidden = true;
                this.field.input.removeAttribute("aria-invalid");
            },
        };
        const tell = (...how) => change(...how, control);
        const labelledby = "exposure-label";
        this.slider = new Slider({ id: "exposure-slider", labelledby, scale, text: (v) => `${v} stops`, change: (value, ...rest) => {
            this.field.show(value, true);
            tell(value, ...rest);
        } });
        const step = (value, size) => value + size * 0.25;
        this.field = new NumberField({ id: "exposure", labelledby, scale: { step }, change: tell, handle: byId("exposure-label") });
        this.field.refused = control.refuse;
        this.field.accepted = control.accept;
        byId("exposure-controls").append(this.slider.input, this.field.input);
    }

    #fill({ words }) {
        byId("tone").replaceChildren(...words.tone_mapping.map((value) => make("option", { value }, value)));
    }

    #show({ view, compare, film, cameras }) {
        const names = cameras.map(({ name }) => name);
        if (names.join() !== this.#cameras) {
            this.#cameras = names.join();
            const options = names.map((name, value) => make("option", { value }, name));
            byId("camera").replaceChildren(make("option", { value: "" }, "Camera \u2026"), ...options);
        }
        const views = this.#session.hello.views.filter((name) => compare || !OF_COMPARISON.includes(name));
        if (views.join() !== this.#views) {
            this.#views = views.join();
            byId("view").replaceChildren(...views.map((value) => make("option", { value }, NAMES[value] ?? capital(value))));
        }
        byId("view").value = view;
        byId("tone").value = film.tone_mapping;
        this.slider.show(film.exposure);
        if (!this.slider.isHeld) this.field.show(film.exposure);
    }
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
