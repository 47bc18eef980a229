// Undo, redo, reset.

import { byId } from "./dom.js";

export class History {
    #session;

    constructor(session) {
        this.#session = session;
        for (const step of ["undo", "redo", "reset"]) byId(step).addEventListener("click", () => this.go(step));
        session.on("state", ({ undo, redo }) => {
            byId("undo").disabled = !undo;
            byId("redo").disabled = !redo;
        });
    }

    /** Goes a step: "undo", "redo" or "reset". */
    go(step) {
        this.#session.command({ type: step });
    }
}
