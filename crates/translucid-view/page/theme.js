// Light, dark, or as the system says.

import { byId } from "./dom.js";
import { keep, recall } from "./storage.js";

const THEMES = ["system", "light", "dark"];
/** The other colors first, so that the first click shows. */
const next = () => {
    const order = dark.matches ? ["system", "light", "dark"] : ["system", "dark", "light"];
    return order[(order.indexOf(theme) + 1) % order.length];
};
const listeners = new Set();
let theme = THEMES.includes(recall("theme")) ? recall("theme") : "system";

const dark = matchMedia("(prefers-color-scheme: dark)");
dark.addEventListener("change", () => listeners.forEach((listener) => listener()));

/** Calls a listener when the colors change. */
export const onTheme = (listener) => listeners.add(listener);

export function startTheme() {
    const button = byId("theme");
    const show = () => {
        if (theme === "system") delete document.documentElement.dataset.theme;
        else document.documentElement.dataset.theme = theme;
        button.dataset.theme = theme;
        button.title = `Colors: ${theme}`;
        button.setAttribute("aria-label", `Colors: ${theme}`);
        for (const listener of listeners) listener();
    };
    button.addEventListener("click", () => {
        theme = next();
        keep("theme", theme);
        show();
    });
    show();
}
