// Buttons that copy.

import { icon, make } from "./dom.js";

/** Copies a text; the browser may refuse. */
export async function copy(text) {
    try {
        await navigator.clipboard.writeText(text);
        return true;
    } catch {
        const area = make("textarea", { value: text, className: "off-screen", "aria-hidden": "true" });
        document.body.append(area);
        area.select();
        const done = document.execCommand("copy");
        area.remove();
        return done;
    }
}

/** A button that copies what `text()` says, and tells that it did. */
export function copyButton({ id, label, text }) {
    const button = make("button", { id, type: "button", className: "icon-button copy", title: label, "aria-label": label }, icon("copy"));
    button.addEventListener("click", async () => {
        const done = await copy(text());
        button.replaceChildren(icon(done ? "check" : "close"));
        button.setAttribute("aria-label", done ? "Copied" : "The browser did not let me copy");
        setTimeout(() => {
            button.replaceChildren(icon("copy"));
            button.setAttribute("aria-label", label);
        }, 1500);
    });
    return button;
}
