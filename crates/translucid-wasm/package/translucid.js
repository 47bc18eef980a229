// Subsurface scattering profiles, the exact half space, conversion of materials and exports: what `translucid.d.ts`
// documents. This file passes calls on to the WebAssembly module beside it.

/** The module's functions and memory, once `init` has loaded it. */
let module;
let loading;

/** The first four bytes of a module, `\0asm`. */
const MAGIC = 0x0061736d;

/** An argument that cannot be used; its message has the value found and the values allowed. */
export class TranslucidError extends Error {
    name = "TranslucidError";
}

/** Loads the WebAssembly module. */
export default function init(source = new URL("./translucid.wasm", import.meta.url)) {
    loading ??= load(source).then(
        (loaded) => (module = loaded),
        (error) => {
            loading = undefined; // Another try may succeed
            throw error;
        },
    );
    return loading.then(() => undefined);
}

async function load(source) {
    const found = await source;
    let wasm = found;
    if (typeof found === "string" || found instanceof URL || found instanceof Request) {
        const address = String(found.url ?? found);
        // Node.js fetches no files.
        const files = address.startsWith("file:") && globalThis.process?.getBuiltinModule?.("node:fs/promises");
        wasm = files ? await files.readFile(new URL(address)) : await fetch(found);
    }
    if (wasm instanceof Response) {
        const { url, ok, status, headers } = wasm;
        if (!ok) throw new TranslucidError(`cannot load ${url}: status ${status}`);
        wasm = await wasm.arrayBuffer();
        // A server that does not know the file may answer with its page, and no error
        if (new DataView(wasm).byteLength < 4 || new DataView(wasm).getUint32(0) !== MAGIC) {
            const type = headers.get("content-type") ?? "of no type";
            throw new TranslucidError(
                `${url} is no WebAssembly module: status ${status}, ${type}. Pass the module's address to init(); ` +
                    'with the development server of Vite 5 to 7 set optimizeDeps: { exclude: ["translucid"] }',
            );
        }
    }
    const made = await WebAssembly.instantiate(wasm, {});
    return (made.instance ?? made).exports;
}

/** Text for what JSON has no words for: a number is `#` and its digits, a text `'` and itself. */
function written(_key, value) {
    if (typeof value === "number") return `#${value}`;
    if (typeof value === "string") return `'${value}`;
    return ArrayBuffer.isView(value) ? Array.from(value) : value;
}

/** Calls the module: a request and numbers go in, a value comes out, and `taken` reads its numbers. */
function call(name, { handle, options, numbers } = {}, taken) {
    if (!module) throw new TranslucidError("the module is not loaded: await init() first");
    const request = new TextEncoder().encode(JSON.stringify({ call: name, handle, options }, written));
    const place = module.text(request.length);
    const room = module.numbers(numbers?.length ?? 0);
    // Either may have moved the memory.
    new Uint8Array(module.memory.buffer, place, request.length).set(request);
    if (numbers) new Float64Array(module.memory.buffer, room, numbers.length).set(numbers);
    const status = module.call();
    const length = module.text_length();
    const text = new TextDecoder().decode(new Uint8Array(module.memory.buffer, module.text(length), length));
    if (status !== 0) throw new TranslucidError(text);
    if (!taken) return JSON.parse(text);
    const count = module.numbers_count();
    return taken(new Float64Array(module.memory.buffer, module.numbers(count), count));
}

/** Applies a quantity of a thing to a number, or to each of several. */
function apply(handle, quantity, x, taken) {
    const isOne = typeof x === "number";
    if (!isOne && (typeof x !== "object" || typeof x?.length !== "number")) throw new TypeError(`${quantity} takes a number or numbers`);
    const numbers = isOne ? [x] : x;
    if (!(numbers.length >= 0 && numbers.length <= MOST)) throw new TranslucidError(`${quantity} is given ${numbers.length} numbers, but takes at most ${MOST} at a time`);
    return call("apply", { handle, options: { quantity, isOne }, numbers }, (found) => taken(found, isOne));
}

/// Most numbers of a call: with copies, values and errors they fit in the memory of a module, 4 GiB.
const MOST = 5e7;

const values = (found, isOne) => (isOne ? found[0] : found.slice());

/** Values and, behind them, as many errors. */
function estimates(found, isOne) {
    const half = found.length / 2;
    return isOne ? { value: found[0], error: found[1] } : { value: found.slice(0, half), error: found.slice(half) };
}

/** Frees what nobody holds any more. */
const forgotten = new FinalizationRegistry((handle) => call("free", { handle }));
const HANDLE = Symbol("handle");

/** A thing that lives in the module's memory. */
class Owner {
    #handle;

    constructor(maker, request) {
        this.#handle = call(maker, request);
        forgotten.register(this, this.#handle, this);
    }

    get [HANDLE]() {
        if (this.#handle === undefined) throw new TranslucidError(`this ${this.constructor.name} was freed`);
        return this.#handle;
    }

    free() {
        if (this.#handle === undefined) return;
        forgotten.unregister(this);
        call("free", { handle: this.#handle });
        this.#handle = undefined;
    }
}

export class Profile extends Owner {
    constructor(options, maker = "profile", handle = undefined) {
        super(maker, { options, handle });
    }

    static fromMedium = (options) => new Profile(options, "fromMedium");
    static fromTable = (options) => new Profile(options, "fromTable");
    tabulated = () => new Profile({}, "tabulated", this[HANDLE]);

    get total() {
        return call("total", { handle: this[HANDLE] });
    }

    eval = (r) => apply(this[HANDLE], "eval", r, values);
    pdf = (r) => apply(this[HANDLE], "pdf", r, values);
    pdfArea = (r) => apply(this[HANDLE], "pdfArea", r, values);
    cdf = (r) => apply(this[HANDLE], "cdf", r, values);
    enclosed = (r) => apply(this[HANDLE], "enclosed", r, values);
    beyond = (r) => apply(this[HANDLE], "beyond", r, values);
    quantile = (u) => apply(this[HANDLE], "quantile", u, values);
    sample = (u) => apply(this[HANDLE], "sample", u, values);
}

export class HalfSpace extends Owner {
    constructor(options) {
        super("halfSpace", { options });
    }

    get total() {
        return apply(this[HANDLE], "total", 0, estimates);
    }

    eval = (r) => apply(this[HANDLE], "eval", r, estimates);
    enclosed = (r) => apply(this[HANDLE], "enclosed", r, estimates);
    beyond = (r) => apply(this[HANDLE], "beyond", r, estimates);
}

export function convert(source, parameters, { settings, ...options } = {}) {
    const set = Object.entries(settings ?? {}).flatMap(([system, values]) => told(system, values));
    const said = { ...options, from: told(source, parameters), set: set.length > 0 ? set : undefined };
    return conversion(said, (message) => message.replace(/^from\b/, "source").replace(/^set\b/, "settings"));
}

export const cyclesMaterial = (method, options) => call("cyclesMaterial", { options: { ...options, method } });

export const slab = ({ color, balance, ...options }) =>
    conversion({ ...options, wallColor: color, wallBalance: balance }, (message) =>
        message.replaceAll("wallColor", "color").replaceAll("wallBalance", "balance"),
    );

/** Parameters of a system, as the question takes them. */
const told = (system, parameters) => Object.entries(parameters ?? {}).map(([name, value]) => `${system}:${name}=${value}`);

function conversion(said, renamed) {
    let answer;
    try {
        answer = ask("convert", said);
    } catch (error) {
        error.message = renamed(error.message);
        throw error;
    }
    const { columns, notes } = answer;
    const names = Object.keys(columns);
    const numbers = columns.value.map((_, i) => Object.fromEntries(names.map((name) => [name, columns[name][i]])));
    const values = {};
    for (const { system, parameter, channel, value } of numbers) {
        const of = (values[system] ??= {});
        if (channel === "all") of[parameter] = value;
        else if (channel === "r") of[parameter] = [value];
        else of[parameter].push(value);
    }
    return { values, numbers, notes };
}

export const exportText = (options) => call("export", { options });
export const preset = (name) => call("preset", { options: { name } });
export const presets = () => call("presets");
export const systems = () => call("systems");
export const models = () => call("models");
export const version = () => call("version");

/** Asks a question: options that are undefined are not said. */
const ask = (question, said) => call("ask", { options: { question, said } });

// questions
export const layers = (layers, options = {}) => ask("layers", { layers, ...options });
export const stack = (layers, options = {}) => ask("stack", { layers, ...options });
// end of questions
