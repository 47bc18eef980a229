// What the server is doing.

import { byId, setText } from "./dom.js";
import { count, duration, format, si } from "./numbers.js";

const PHASES = {
    preparing: "Preparing",
    preview: "Preview",
    rendering: "Rendering",
    points: "Points",
    done: "Done",
    paused: "Paused",
};

export class Status {
    #session;

    constructor(session) {
        this.#session = session;
        byId("pause").addEventListener("click", () => this.pause());
        session.on("status", (status) => this.#show(status));
        session.on("state", ({ paused }) => {
            const button = byId("pause");
            button.setAttribute("aria-pressed", String(paused));
            button.title = paused ? "Go on rendering (Space)" : "Pause (Space)";
        });
        session.on("lost", () => {
            byId("phase").textContent = "Not connected";
            document.body.dataset.phase = "lost";
        });
    }

    pause() {
        const { state } = this.#session;
        if (state) this.#session.command({ type: "pause", on: !state.paused });
    }

    #show({ phase, detail, sides }) {
        document.body.dataset.phase = phase;
        setText(byId("phase"), PHASES[phase] ?? phase);
        setText(byId("detail"), detail ?? "");
        // Both sides are refined in turns; the one that lags says how far the picture is.
        const shown = [sides.a, sides.b].filter(Boolean);
        // Nothing is rendered before everything is prepared.
        if (shown.length === 0) return;
        const side = shown.reduce((least, other) => (other.samples < least.samples ? other : least));
        setText(byId("samples"), `${count(side.samples)} of ${count(side.goal)} samples`);
        setText(byId("seconds"), duration(side.seconds));
        setText(byId("speed"), side.samples_per_second > 0 ? `${si(side.samples_per_second)}paths/s` : "");
        const noise = side.noise === null || side.noise === undefined ? "" : `noise ${format(100 * Math.sqrt(side.noise), 2)}\u2009%`;
        setText(byId("noise"), noise);
        const share = side.goal > 0 ? side.samples / side.goal : 0;
        byId("progress").style.transform = `scaleX(${share})`;
        byId("progress").classList.toggle("done", share >= 1);
    }
}
