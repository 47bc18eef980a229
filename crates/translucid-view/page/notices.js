// What the page has to say: errors of no control, and that the connection is lost.

import { byId, icon, make, setText } from "./dom.js";
import { LOST } from "./host.js";

/** How long a message stays, in milliseconds; errors stay longer. */
const STAYS = 4000;
const ERRORS_STAY = 12000;
/** Messages at a time. */
const MOST = 4;

export class Notices {
    #list = byId("notices");
    #banner = byId("lost");

    constructor(session) {
        session.on("error", (error) => this.error(error));
        session.on("hello", () => {
            this.#banner.hidden = true;
            document.body.classList.remove("lost");
        });
        session.on("lost", ({ attempts }) => {
            document.body.classList.add("lost");
            this.#banner.hidden = false;
            const isBrief = attempts < 3;
            setText(byId("lost-text"), isBrief ? "The connection was lost. Coming back \u2026" : LOST);
            byId("lost-now").hidden = isBrief;
        });
        byId("lost-now").addEventListener("click", () => session.connect());
    }

    /** Shows an error of the server. */
    error({ message, help }) {
        return this.#add(help ? `${message} \u2013 ${help}` : message, "error", ERRORS_STAY);
    }

    say(text) {
        return this.#add(text, "", STAYS);
    }

    #add(text, kind, stays) {
        const close = make("button", { type: "button", className: "icon-button", "aria-label": "Close" }, icon("close"));
        const item = make("div", { className: `notice ${kind}` }, make("span", {}, text), close);
        const remove = () => item.remove();
        close.addEventListener("click", remove);
        setTimeout(remove, stays);
        this.#list.append(item);
        while (this.#list.children.length > MOST) this.#list.firstChild.remove();
        return { close: remove };
    }
}
