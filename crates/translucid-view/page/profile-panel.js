// R(r) of the material that is selected beside the exact one.

import uPlot from "./vendor/uplot/uPlot.esm.js";
import { byId, make, setText } from "./dom.js";
import { format } from "./numbers.js";
import { keep, recall } from "./storage.js";
import { onTheme } from "./theme.js";
import { Watch } from "./watch.js";

const QUANTITIES = ["profile", "ring", "error"];
const SCALES = ["logarithmic", "linear"];

export class ProfilePanel {
    #answer = null;
    #plot = null;
    #quantity = chosen("quantity", QUANTITIES);
    #scale = chosen("axes", SCALES);
    #room = byId("profile-plot");
    #names = "";
    #letters = 0;

    constructor(session, materials, dock) {
        const watch = new Watch(session, materials, "profile", () => dock.isOpen("profile"), (answer, error) => {
            const isNew = !this.#answer;
            this.#answer = answer;
            if (!answer || answer.r.length === 0) return this.#nothing(error?.message ?? answer.note);
            if (isNew) this.#make();
            else this.#update();
        });
        dock.onChange(() => watch.look());
        this.#choose("quantity", QUANTITIES, this.#quantity, (value) => (this.#quantity = value));
        this.#choose("axes", SCALES, this.#scale, (value) => (this.#scale = value));
        onTheme(() => this.#make());
        new ResizeObserver(() => this.#resize()).observe(this.#room);
        watch.look();
    }

    #choose(name, values, now, set) {
        for (const value of values) {
            const radio = byId(`profile-${value}`);
            radio.checked = value === now;
            radio.addEventListener("change", () => {
                set(value);
                keep(name, value);
                this.#make();
            });
        }
    }

    /** There is no profile: says why. */
    #nothing(reason) {
        this.#answer = null;
        this.#plot?.destroy();
        this.#plot = null;
        this.#room.classList.add("empty");
        for (const id of ["profile-model", "profile-truth", "profile-note", "profile-cursor"]) setText(byId(id), "");
        byId("profile-errors").replaceChildren();
        this.#room.replaceChildren(make("p", { className: "description" }, reason ?? ""));
    }

    /** Curves of what is asked for: of each channel the model's and the exact one. */
    #data() {
        const { r, channels } = this.#answer;
        const isLog = this.#scale === "logarithmic";
        const of = {
            profile: (values) => values,
            ring: (values) => values.map((value, i) => 2 * Math.PI * r[i] * value),
        }[this.#quantity];
        // A logarithm has no place for 0, nor for a model that is negative somewhere.
        const shown = (values) => (isLog ? values.map((value) => (value > 0 ? value : null)) : values);
        const none = r.map(() => null);
        const curves = channels.flatMap(({ model, exact }) => {
            if (this.#quantity === "error") {
                return [exact ? model.map((value, i) => (exact[i] > 0 ? 100 * (value / exact[i] - 1) : null)) : none, none];
            }
            return [shown(of(model)), exact ? shown(of(exact)) : none];
        });
        return [r, ...curves];
    }

    #make() {
        if (!this.#answer) return;
        this.#plot?.destroy();
        this.#room.replaceChildren();
        this.#room.classList.remove("empty");
        const style = getComputedStyle(document.documentElement);
        const color = (name) => style.getPropertyValue(name).trim() && resolve(`var(${name})`);
        const size = parseFloat(style.fontSize);
        this.#letters = size;
        const font = `${Math.round(size * 0.85)}px ${getComputedStyle(document.body).fontFamily}`;
        const isLog = this.#scale === "logarithmic";
        const series = this.#answer.channels.flatMap(({ name }) => {
            const stroke = color(`--plot-${name}`);
            return [
                { label: name, stroke, width: 1.75, points: { show: false } },
                { label: `${name}, exact`, stroke, width: 1.25, dash: [4, 4], points: { show: false } },
            ];
        });
        const axis = {
            stroke: color("--muted"),
            font,
            labelFont: font,
            labelSize: size * 1.35,
            grid: { stroke: color("--grid"), width: 1 },
            ticks: { stroke: color("--grid"), width: 1, size: 4 },
            gap: 4,
        };
        const logarithmic = { values: powers, splits: powersOfTen, filter: (_, splits) => splits };
        const label = { profile: "R(r)  [1/mm\u00b2]", ring: "2\u03c0r R(r)  [1/mm]", error: "error  [%]" }[this.#quantity];
        const isRatio = this.#quantity === "error";
        const options = {
            ...this.#size(),
            legend: { show: false },
            cursor: { drag: { x: false, y: false }, points: { size: 5 } },
            padding: [size * 0.6, size * 0.8, 0, 0],
            scales: {
                x: { time: false, distr: isLog ? 3 : 1, range: isRatio ? undefined : (_, least) => [least, this.#reach()] },
                y: { distr: isLog && !isRatio ? 3 : 1, range: isRatio ? ratioRange : isLog ? decades : undefined },
            },
            axes: [
                { ...axis, label: "r  [mm]", size: size * 1.9, ...(isLog ? logarithmic : { values: plain, space: size * 3.5 }) },
                { ...axis, label, size: size * 4, ...(isLog && !isRatio ? logarithmic : { values: plain, space: size * 2 }) },
            ],
            series: [{}, ...series],
            hooks: { setCursor: [(plot) => this.#read(plot)] },
        };
        this.#plot = new uPlot(options, this.#data(), this.#room);
        this.#tell();
    }

    /** The largest radius at which there is light that the plot shows. */
    #reach() {
        const { r, channels } = this.#answer;
        const values = channels.flatMap(({ model, exact }) => [model, exact ?? []]);
        const floor = Math.max(...values.flat()) * (this.#scale === "logarithmic" ? LEAST_SHARE : 1e-3);
        const last = Math.max(...values.map((curve) => curve.findLastIndex((value) => value > floor)));
        return r[Math.min(r.length - 1, Math.max(1, last + 1))];
    }

    #update() {
        const names = this.#answer.channels.map(({ name }) => name).join();
        if (!this.#plot || names !== this.#names) return this.#make();
        this.#plot.setData(this.#data());
        this.#tell();
    }

    /** Says in words what the plot shows. */
    #tell() {
        const { model, truth, channels, note } = this.#answer;
        this.#names = channels.map(({ name }) => name).join();
        setText(byId("profile-model"), model);
        setText(byId("profile-truth"), truth);
        setText(byId("profile-note"), note ?? "");
        byId("profile-errors").replaceChildren(...channels.map(({ name, error_percent: error }) =>
            make("li", { className: name[0] },
                make("span", {}, name.charAt(0).toUpperCase() + name.slice(1)),
                make("strong", {}, error === null ? "\u2013" : `${format(error, 3)}\u2009%`))));
        this.#room.setAttribute("aria-label", `Profile of ${model}: error ${channels.map(({ name, error_percent: e }) => `${name} ${e === null ? "unknown" : `${format(e, 3)} percent`}`).join(", ")}`);
        this.#read(this.#plot);
    }

    /** The numbers under the pointer. */
    #read(plot) {
        const i = plot?.cursor.idx;
        const { r, channels } = this.#answer;
        if (i === null || i === undefined) return setText(byId("profile-cursor"), "");
        const values = channels.map(({ model, exact }) =>
            `${format(model[i], 3)}${exact ? `  exact ${format(exact[i], 3)}` : ""}`);
        setText(byId("profile-cursor"), [`r = ${format(r[i], 3)} mm`, ...values].join("\n"));
    }

    #size() {
        return { width: Math.max(100, this.#room.clientWidth), height: Math.max(80, this.#room.clientHeight) };
    }

    #resize() {
        // Letters of the page grow with the window.
        if (this.#plot && parseFloat(getComputedStyle(document.documentElement).fontSize) !== this.#letters) this.#make();
        const { width, height } = this.#size();
        if (this.#plot && this.#room.clientWidth > 0 && (this.#plot.width !== width || this.#plot.height !== height)) {
            this.#plot.setSize({ width, height });
        }
    }
}

function chosen(key, values) {
    const value = recall(key);
    return values.includes(value) ? value : values[0];
}

/** A color of the style sheet as a canvas takes it. */
function resolve(value) {
    const probe = make("span", { hidden: true });
    probe.style.color = value;
    document.body.append(probe);
    const { color } = getComputedStyle(probe);
    probe.remove();
    return color;
}

/** Eight decades at most: further down there is no light that anybody sees. */
const LEAST_SHARE = 1e-8;

function decades(_, least, most) {
    if (!(most > 0)) return [1e-8, 1];
    const top = 10 ** Math.ceil(Math.log10(most));
    return [Math.max(10 ** Math.floor(Math.log10(least)), top * LEAST_SHARE), top];
}

/** An error beyond 100 percent is as bad as 100. */
function ratioRange(_, least, most) {
    const reach = Math.min(100, Math.max(1, Math.abs(least ?? 1), Math.abs(most ?? 1)) * 1.1);
    return [-reach, reach];
}

const SUPERSCRIPT = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";

/** Whole powers of ten, as far apart as letters need. */
function powersOfTen(plot, axis, least, most) {
    const [first, last] = [Math.ceil(Math.log10(least) - 1e-6), Math.floor(Math.log10(most) + 1e-6)];
    const room = axis === 0 ? plot.bbox.width : plot.bbox.height;
    const fits = Math.max(1, Math.floor(room / devicePixelRatio / (axis === 0 ? 50 : 24)));
    const step = Math.max(1, Math.ceil((last - first + 1) / fits));
    return Array.from({ length: Math.floor((last - first) / step) + 1 }, (_, i) => 10 ** (first + i * step));
}

const powers = (_, splits) => splits.map((value) => {
    const power = Math.round(Math.log10(value));
    if (Math.abs(power) <= 2) return format(value);
    const digits = [...String(Math.abs(power))].map((digit) => SUPERSCRIPT[digit]).join("");
    return `10${power < 0 ? "\u207b" : ""}${digits}`;
});

const plain = (_, splits) => splits.map((value) => (value === null ? "" : format(value, 4)));
