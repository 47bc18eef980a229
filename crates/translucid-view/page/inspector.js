// What is under the pointer: linear values, place, object, material.

import { byId, make, setText } from "./dom.js";
import { format } from "./numbers.js";
import { MILLIMETERS } from "./units.js";

/** Shortest time between two questions, in milliseconds. */
const PAUSE = 125;

export class Inspector {
    #session;
    #picture;
    #compare;
    #at = null;
    #asks = false;
    #last = 0;
    #timer = 0;

    constructor(session, picture, compare) {
        this.#session = session;
        this.#picture = picture;
        this.#compare = compare;
        const view = byId("viewport");
        view.addEventListener("pointermove", (event) => {
            if (event.buttons !== 0 || event.pointerType === "touch") return;
            this.#at = { x: event.clientX, y: event.clientY };
            this.#ask();
        });
        view.addEventListener("pointerleave", () => {
            this.#at = null;
            this.#clear();
        });
        // What is under a pointer that rests changes with the picture.
        picture.onPainted(() => this.#at && this.#ask());
    }

    async #ask() {
        if (this.#asks || this.#timer || !this.#session.state) return;
        const wait = this.#last + PAUSE - performance.now();
        if (wait > 0) {
            this.#timer = setTimeout(() => {
                this.#timer = 0;
                if (this.#at) this.#ask();
            }, wait);
            return;
        }
        const at = this.#at;
        const point = this.#picture.filmPoint(at.x, at.y);
        if (!point) return this.#clear();
        this.#asks = true;
        this.#last = performance.now();
        const picked = await this.#session.ask({ type: "pick", ...point }).catch(() => null);
        this.#asks = false;
        if (this.#at === null) return;
        if (picked) this.#show(picked, point, this.#compare.sideAt(at.x));
        if (this.#at !== at) this.#ask();
    }

    #clear() {
        byId("inspector").classList.add("empty");
    }

    #show(picked, point, side) {
        const { state, hello } = this.#session;
        byId("inspector").classList.remove("empty");
        setText(byId("inspect-pixel"), `${Math.floor(point.x)}, ${Math.floor(point.y)}`);
        const values = picked.sides[side] ?? picked.sides.a;
        const layer = values?.[state.view] ?? values?.radiance;
        const numbers = layer === undefined ? [] : [layer].flat();
        byId("inspect-values").replaceChildren(...numbers.map((value, i) =>
            make("span", { className: numbers.length === 3 ? `letter ${"rgb"[i]}` : "" }, format(value, 4))));
        const material = state.sides[side]?.materials[picked.material]?.name;
        setText(byId("inspect-object"), [picked.object, material].filter(Boolean).join(" \u00b7 ") || "nothing");
        const unit = MILLIMETERS[hello.unit] ?? 1;
        const place = picked.position?.map((x) => format(x * unit, 4)).join(", ");
        setText(byId("inspect-position"), place ? `${place} mm` : "");
        const codes = this.#picture.codesAt(this.#picture.isMap(state.view) ? "map" : side, point);
        const hex = codes ? "#" + [...codes.subarray(0, 3)].map((x) => x.toString(16).padStart(2, "0")).join("") : "";
        byId("inspect-swatch").style.backgroundColor = hex;
        setText(byId("inspect-code"), hex);
    }
}
