// Two settings, A and B: the line between them, and which one the panels edit.

import { byId, setText } from "./dom.js";
import { nextGesture } from "./gesture.js";
import { format } from "./numbers.js";

const SIDES = ["a", "b", "both"];

export class Compare {
    #session;
    #picture;
    #wipe = byId("wipe");
    #at = 0.5;

    constructor(session, picture) {
        this.#session = session;
        this.#picture = picture;
        byId("compare").addEventListener("click", () => this.toggle());
        byId("truth").addEventListener("click", () => this.withRandomWalk());
        byId("swap").addEventListener("click", () => session.command({ type: "swap" }));
        for (const side of SIDES) {
            byId(`side-${side}`).addEventListener("change", () => session.command({ type: "side", side }));
        }
        for (const view of ["difference", "flip"]) {
            byId(`show-${view}`).addEventListener("click", () => {
                const other = session.state.view === view ? "radiance" : view;
                session.command({ type: "show", view: other });
            });
        }
        session.on("hello", ({ sides }) => {
            byId("side-both").parentElement.hidden = !sides?.includes("both");
        });
        session.on("state", (state) => this.#show(state));
        session.on("status", () => this.#measure());
        picture.onPainted(() => this.#measure());
        this.#listen();
        this.#place(this.#at);
    }

    toggle() {
        if (this.#session.state) this.#session.command({ type: "compare", on: !this.#session.state.compare });
    }

    /** B becomes a random walk through the same materials, and A, where it has walks, normalized diffusion. */
    async withRandomWalk() {
        const session = this.#session;
        if (!session.state) return;
        if (!session.state.compare && !(await session.command({ type: "compare", on: true }))) return;
        const gesture = nextGesture();
        for (const [side, walks, model] of [["a", true, "normalized-diffusion"], ["b", false, "random-walk"]]) {
            if (!(await session.command({ type: "side", side }))) return;
            const set = { subsurface_model: model };
            const { materials } = session.state.sides[side] ?? session.state.sides.a;
            const edits = materials.flatMap(({ parameters, model }, index) =>
                scatters(parameters) && isWalk(model) === walks ? [session.command({ type: "material", index, set, gesture })] : []);
            await Promise.all(edits);
        }
        const hasBoth = session.hello.sides?.includes("both");
        await session.command({ type: "side", side: hasBoth ? "both" : "a" });
        session.settle();
    }

    #show({ compare, active, view, sides }) {
        document.documentElement.dataset.side = compare ? active : "";
        byId("compare").setAttribute("aria-pressed", String(compare));
        byId("compare-bar").hidden = !compare;
        const isMap = this.#picture.isMap(view);
        this.#wipe.hidden = !compare || isMap;
        byId("label-a").hidden = byId("label-b").hidden = !compare || isMap;
        for (const side of SIDES) byId(`side-${side}`).checked = active === side;
        for (const name of ["difference", "flip"]) {
            byId(`show-${name}`).setAttribute("aria-pressed", String(view === name));
        }
        const chip = byId("panel-side");
        this.#measure();
        chip.hidden = !compare;
        setText(chip, active === "both" ? "A + B" : active.toUpperCase());
        if (compare) {
            setText(byId("label-a"), `A  ${modelsOf(sides.a)}`);
            setText(byId("label-b"), `B  ${modelsOf(sides.b)}`);
        }
    }

    #measure() {
        const { status, state } = this.#session;
        const { difference } = status ?? {};
        const texts = difference && [
            `relMSE ${format(difference.relative_mse, 3)}`,
            difference.noise !== null && `noise ${format(difference.noise, 2)}`,
            difference.mean_flip !== null && `mean \ua7fbLIP ${format(difference.mean_flip, 3)}`,
        ];
        // It takes seconds, while the map shows what was before, or nothing.
        const isDue = state?.view === "flip" && !(this.#picture.shown.map?.version >= state.version);
        setText(byId("difference"), isDue ? "Computing \ua7fbLIP \u2026" : (texts ?? []).filter(Boolean).join(", "));
    }

    // The line

    #place(at) {
        this.#at = Math.min(1, Math.max(0, at));
        const percent = `${(this.#at * 100).toFixed(2)}%`;
        this.#wipe.style.left = percent;
        byId("picture-b").style.clipPath = `inset(0 0 0 ${percent})`;
        const whole = Math.round(this.#at * 100);
        this.#wipe.setAttribute("aria-valuenow", String(whole));
        this.#wipe.setAttribute("aria-valuetext", `A ${whole}\u2009%, B ${100 - whole}\u2009%`);
    }

    #listen() {
        const wipe = this.#wipe;
        wipe.addEventListener("pointerdown", (event) => {
            if (event.button !== 0) return;
            event.stopPropagation();
            wipe.setPointerCapture(event.pointerId);
        });
        wipe.addEventListener("pointermove", (event) => {
            if (!wipe.hasPointerCapture(event.pointerId)) return;
            const { left, width } = this.#picture.rect;
            this.#place((event.clientX - left) / width);
        });
        wipe.addEventListener("dblclick", (event) => {
            event.stopPropagation();
            this.#place(0.5);
        });
        wipe.addEventListener("keydown", (event) => {
            const step = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02, Home: -1, End: 1 }[event.key];
            if (!step) return;
            event.preventDefault();
            event.stopPropagation();
            this.#place(this.#at + step);
        });
    }

    /** The side under a place in the window. */
    sideAt(clientX) {
        const { left, width } = this.#picture.rect;
        return this.#session.state.compare && (clientX - left) / width >= this.#at ? "b" : "a";
    }
}

/** Whether a material of these parameters is translucent. */
const scatters = ({ subsurface_weight: { value, image, vertex } }) => value > 0 || image || vertex;

const isWalk = (model) => model.startsWith("random-walk");

/** The models of a side's translucent materials, each once. */
function modelsOf({ materials }) {
    const models = [...new Set(materials.filter(({ parameters }) => scatters(parameters)).map(({ model }) => model))];
    return models.length > 2 ? `${models.length} models` : models.join(", ");
}
