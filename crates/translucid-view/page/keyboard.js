// Keys of the whole page; those of the picture alone are in navigation.js.

import { byId, make } from "./dom.js";

/** What the help shows: keys and what they do. */
const HELP = [
    ["The picture", [
        ["Drag", "orbit"],
        ["Shift or middle drag", "pan"],
        ["Wheel, pinch", "closer and farther"],
        ["Click", "select the material"],
        ["Double click", "look there"],
        ["Arrow keys", "orbit; with Shift pan"],
        ["+ \u2212", "closer and farther"],
        ["Enter", "select what is in the middle"],
        ["F", "frame all"],
        ["0 1", "fit the window; one to one"],
        ["V", "next layer; with Shift the one before"],
    ]],
    ["Work", [
        ["Ctrl Z", "undo"],
        ["Ctrl Shift Z", "redo"],
        ["Ctrl S", "save the scene"],
        ["Space", "pause and go on"],
        ["C", "compare A and B"],
        ["T", "compare with the random walk"],
        ["X", "swap A and B"],
        ["P", "profile"],
        ["N", "numbers"],
        ["?", "this help"],
    ]],
    ["Fields and sliders", [
        ["\u2191 \u2193", "a step; with Shift ten, with Alt a tenth"],
        ["*2 /2", "typed into a field: times, by"],
        ["+1ev", "typed into a field: a stop more"],
        ["Esc", "what was there before"],
        ["Drag a label", "change its field"],
        ["\u2190 \u2192", "a slider by 1 %; with Shift by 0.1 %"],
    ]],
];

export function startKeyboard({ session, history, viewBar, compare, dock, picture, status }) {
    const help = byId("help");
    byId("help-content").append(...HELP.map(([title, keys]) => make("section", {},
        make("h3", {}, title),
        make("dl", {}, ...keys.flatMap(([key, text]) => [make("dt", {}, key), make("dd", {}, text)])))));
    byId("show-help").addEventListener("click", () => help.showModal());
    help.addEventListener("click", (event) => event.target === help && help.close());

    const keys = {
        f: () => viewBar.frameAll(),
        c: () => compare.toggle(),
        t: () => compare.withRandomWalk(),
        x: () => session.state.compare && session.command({ type: "swap" }),
        v: () => viewBar.nextView(1),
        V: () => viewBar.nextView(-1),
        p: () => dock.toggle("profile"),
        n: () => dock.toggle("numbers"),
        0: () => picture.zoom(true),
        1: () => picture.zoom(false),
        "?": () => help.showModal(),
        " ": () => status.pause(),
    };

    addEventListener("keydown", (event) => {
        if (help.open || !session.state) return;
        const isMeta = event.ctrlKey || event.metaKey;
        const isTyping = event.target.matches("input.number, textarea");
        if (isMeta && event.key.toLowerCase() === "z" && !event.altKey) {
            event.preventDefault();
            return history.go(event.shiftKey ? "redo" : "undo");
        }
        if (isMeta && event.key.toLowerCase() === "y") {
            event.preventDefault();
            return history.go("redo");
        }
        if (isMeta && event.key.toLowerCase() === "s") {
            event.preventDefault();
            return byId("save-scene").click();
        }
        if (isMeta || event.altKey || isTyping || event.target.matches("select")) return;
        if (event.key === " " && event.target.closest("button, summary, a, input")) return;
        const action = keys[event.key];
        if (!action) return;
        event.preventDefault();
        action();
    });
}
