// Menus that open below their button.

import { byId } from "./dom.js";

/** Opens `#<id>-menu`, a popover, at the button `#<id>`. */
export function startMenu(id) {
    const [button, menu] = [byId(id), byId(`${id}-menu`)];
    menu.addEventListener("beforetoggle", ({ newState }) => {
        if (newState !== "open") return;
        const { right, bottom } = button.getBoundingClientRect();
        menu.style.top = `${bottom + 4}px`;
        menu.style.right = `${document.documentElement.clientWidth - right}px`;
    });
    menu.addEventListener("toggle", ({ newState }) => {
        button.setAttribute("aria-expanded", String(newState === "open"));
        if (newState === "open") menu.querySelector("a, button")?.focus();
    });
    menu.addEventListener("click", (event) => event.target.closest("a, button") && menu.hidePopover());
    menu.addEventListener("keydown", (event) => {
        const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        const items = [...menu.querySelectorAll("a, button")];
        const at = items.indexOf(document.activeElement);
        items[(at + step + items.length) % items.length].focus();
    });
}
