// The panels below the picture: which are open, and how high they are.

import { byId } from "./dom.js";
import { keep, recall } from "./storage.js";

const PANELS = ["profile", "numbers"];
const LEAST = 110;

export class Dock {
    #open = new Set(recall("dock", innerHeight >= 760 ? ["profile"] : []));
    #height = recall("dock-height", null);
    #listeners = new Set();
    #handle = byId("dock-handle");

    constructor() {
        for (const name of PANELS) byId(`toggle-${name}`).addEventListener("click", () => this.toggle(name));
        this.#listen();
        this.#show();
    }

    onChange(listener) {
        this.#listeners.add(listener);
    }

    isOpen(name) {
        return this.#open.has(name);
    }

    toggle(name) {
        if (!this.#open.delete(name)) this.#open.add(name);
        keep("dock", [...this.#open]);
        this.#show();
        for (const listener of this.#listeners) listener();
    }

    #show() {
        for (const name of PANELS) {
            byId(`${name}-panel`).hidden = !this.isOpen(name);
            byId(`toggle-${name}`).setAttribute("aria-expanded", String(this.isOpen(name)));
        }
        byId("dock").hidden = this.#open.size === 0;
        if (this.#height) this.#setHeight(this.#height);
    }

    #setHeight(height) {
        const most = innerHeight * 0.7;
        this.#height = Math.round(Math.min(most, Math.max(LEAST, height)));
        byId("dock").style.height = `${this.#height}px`;
        this.#handle.setAttribute("aria-valuenow", String(Math.round((100 * this.#height) / innerHeight)));
    }

    #listen() {
        const handle = this.#handle;
        const bottom = () => byId("dock").getBoundingClientRect().bottom;
        handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
        handle.addEventListener("pointermove", (event) => {
            if (handle.hasPointerCapture(event.pointerId)) this.#setHeight(bottom() - event.clientY);
        });
        handle.addEventListener("lostpointercapture", () => keep("dock-height", this.#height));
        handle.addEventListener("keydown", (event) => {
            const step = { ArrowUp: 20, ArrowDown: -20 }[event.key];
            if (!step) return;
            event.preventDefault();
            this.#setHeight(byId("dock").getBoundingClientRect().height + step);
            keep("dock-height", this.#height);
        });
    }
}
