// Tabs of the side panel.

import { keep, recall } from "./storage.js";

export function startTabs(list) {
    const tabs = [...list.querySelectorAll("[role=tab]")];
    const show = (tab, focus) => {
        for (const other of tabs) {
            const isShown = other === tab;
            other.setAttribute("aria-selected", String(isShown));
            other.tabIndex = isShown ? 0 : -1;
            document.getElementById(other.getAttribute("aria-controls")).hidden = !isShown;
        }
        if (focus) tab.focus();
        keep("tab", tab.id);
    };
    for (const tab of tabs) tab.addEventListener("click", () => show(tab, false));
    list.addEventListener("keydown", (event) => {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        const at = tabs.indexOf(document.activeElement);
        show(tabs[(at + step + tabs.length) % tabs.length], true);
    });
    show(tabs.find(({ id }) => id === recall("tab")) ?? tabs[0], false);
    return { show: (id) => show(tabs.find((tab) => tab.id === id), false) };
}
