// The material that is selected, in the numbers of other renderers.

import { copyButton } from "./copy.js";
import { byId, make, setText } from "./dom.js";
import { parse } from "./numbers.js";
import { MILLIMETERS, notLength, splitUnit } from "./units.js";
import { Watch } from "./watch.js";
import { keep, recall } from "./storage.js";

const CHANNELS = ["r", "g", "b"];

export class NumbersPanel {
    #answer = null;
    #choice = byId("numbers-system");
    #space = byId("numbers-space");
    #thin = byId("numbers-thin");
    #system = recall("system", "");
    #session;

    constructor(session, materials, dock) {
        this.#session = session;
        const watch = new Watch(session, materials, "numbers", () => dock.isOpen("numbers"), (answer) => {
            // Where the connection was lost, the next one is asked
            if (!answer) return;
            this.#answer = answer;
            this.#show();
        }, () => this.#wish());
        for (const input of [this.#space, this.#thin]) input.addEventListener("change", () => watch.look());
        this.#thin.addEventListener("change", () => this.#check());
        dock.onChange(() => watch.look());
        this.#choice.addEventListener("change", () => {
            this.#system = this.#choice.value;
            keep("system", this.#system);
            this.#show();
        });
        byId("numbers-command").after(copyButton({
            id: "copy-numbers-command",
            label: "Copy the command",
            text: () => this.#answer?.command ?? "",
        }));
    }

    /** The color space and the thickness that are asked for, if they are. */
    #wish() {
        const wish = {};
        if (this.#space.value) wish.color_space = this.#space.value;
        const thin = this.#thickness();
        if (thin !== null) wish.thin = thin;
        return wish;
    }

    #thickness() {
        const [number, unit] = splitUnit(this.#thin.value);
        const thickness = parse(number);
        return unit ? thickness && thickness * MILLIMETERS[unit] / MILLIMETERS[this.#session.hello.unit] : thickness;
    }

    /** Says what is no thickness. */
    #check() {
        const text = this.#thin.value.trim();
        const isRefused = text !== "" && this.#thickness() === null;
        this.#thin.setAttribute("aria-invalid", String(isRefused));
        const { message, help } = notLength(text);
        setText(byId("numbers-thin-error"), `${message} \u2013 ${help}`);
        byId("numbers-thin-error").hidden = !isRefused;
    }

    #show() {
        const { rows, notes, command } = this.#answer;
        const systems = group(rows, ({ system }) => system);
        this.#list([...systems.keys()]);
        const wanted = systems.has(this.#system) ? [[this.#system, systems.get(this.#system)]] : [...systems];
        byId("numbers-tables").replaceChildren(...wanted.map(([system, rows], i) => table(system, rows, i)));
        byId("numbers-notes").replaceChildren(...notes.map((note) => make("li", {}, note)));
        setText(byId("numbers-command"), command);
    }

    #list(systems) {
        const known = [...this.#choice.options].map(({ value }) => value).slice(1);
        if (known.join("\n") === systems.join("\n")) return;
        const options = systems.map((value) => make("option", { value }, value));
        this.#choice.replaceChildren(make("option", { value: "" }, "All renderers"), ...options);
        this.#choice.value = systems.includes(this.#system) ? this.#system : "";
    }
}

/** A system's numbers under its name: a line for each parameter, a column for each channel. */
function table(system, rows, i) {
    const parameters = [...group(rows, ({ parameter }) => parameter)];
    const lines = parameters.map(([parameter, cells]) => {
        const unit = make("td", { className: "unit" }, cells[0].unit);
        const values = cells.length === 1
            ? [make("td", { colSpan: 3 }, cells[0].value)]
            : CHANNELS.map((channel) => make("td", {}, cells.find((cell) => cell.channel === channel)?.value ?? ""));
        return make("tr", {}, make("th", { scope: "row" }, parameter), ...values, unit);
    });
    const text = parameters.map(([parameter, cells]) => {
        const values = cells.map(({ value }) => value).join(", ");
        return `${parameter} = ${values}${cells[0].unit ? ` ${cells[0].unit}` : ""}`;
    });
    const button = copyButton({ id: `copy-numbers-${i}`, label: `Copy the numbers of ${system}`, text: () => text.join("\n") });
    const title = make("h3", { id: `numbers-${i}` }, system);
    const head = make("div", { className: "system-head" }, title, button);
    return make("div", { className: "system" }, head, make("table", { "aria-labelledby": title.id }, make("tbody", {}, ...lines)));
}

function group(items, key) {
    const groups = new Map();
    for (const item of items) {
        if (!groups.has(key(item))) groups.set(key(item), []);
        groups.get(key(item)).push(item);
    }
    return groups;
}
