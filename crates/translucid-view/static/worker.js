// A session in WebAssembly: hears what the page says between pieces of rendering, and lets other workers trace.

import { findAdapter, Graphics } from "./graphics.js";

/** Length of a step, in milliseconds. */
const STEP = 40;
/** Kinds of files as the module counts them. */
const KINDS = ["scene", "exr", "png"];

const [encoder, decoder] = [new TextEncoder(), new TextDecoder()];
let module = null;
/** Why the module has ended. */
let failure = "";
/** Whether this worker has the page's session, or traces for the one that has. */
let isMember = false;
/** Edits that were heard: workers that have heard as many have the same scene. */
let heard = 0;
/** Whether a step is due, and the wait before the next one. */
let [isDue, timer] = [false, 0];
const { port1, port2 } = new MessageChannel();
/** Ports of workers that have nothing to trace. */
const idle = new Set();
/** What a member is to trace once it has heard enough. */
let held = null;
/** The graphics processor that was found, the kernels on it once they are made, and whether it is at work. */
let [found, graphics, isTracing] = [null, null, false];

const page = {
    now: () => performance.now(),
    fail(text, length) {
        failure = decoder.decode(new Uint8Array(module.memory.buffer, text, length));
    },
};

/** Puts bytes where the module reads them. */
function put(...parts) {
    const views = parts.map((part) => (part instanceof Uint8Array ? part : new Uint8Array(part)));
    let at = module.input(views.reduce((sum, { length }) => sum + length, 0));
    for (const view of views) {
        new Uint8Array(module.memory.buffer, at, view.length).set(view);
        at += view.length;
    }
}

/** A copy of what the module has put out. */
const output = () => new Uint8Array(module.memory.buffer, module.output(), module.output_length()).slice();

const text = () => decoder.decode(output());

/** A call with a file as its input. */
function named({ name, bytes }, call) {
    const begin = encoder.encode(name);
    put(begin, bytes);
    return call(begin.length);
}

/** The error that a status stands for. */
const errorOf = (status) => (status === 0 ? null : JSON.parse(text()));

const ACTIONS = {
    async open({ module: compiled, name, files, isMember: traces }) {
        isMember = traces;
        module = (await WebAssembly.instantiate(compiled, { page })).exports;
        for (const file of files) named(file, module.give);
        found = isMember ? null : await findAdapter();
        if (found) {
            put(encoder.encode(found.name));
            module.offer(found.adapter.limits.maxStorageBufferBindingSize, Number(!found.isSlow));
        }
        put(encoder.encode(name));
        const error = errorOf(module.open());
        postMessage(error ? { type: "refused", error } : { type: "opened" });
        if (!error) go();
    },
    tell({ text, isEdit }) {
        put(encoder.encode(text));
        module.tell();
        heard += isEdit;
        go();
    },
    environment({ id, name, bytes }) {
        const error = errorOf(named({ name, bytes }, module.environment));
        heard++;
        if (!isMember) postMessage({ type: "answer", id, error });
        go();
    },
    save({ id, kind, side }) {
        const error = errorOf(module.save(KINDS.indexOf(kind), Number(side === "b")));
        if (error) return postMessage({ type: "answer", id, error });
        const bytes = output();
        const end = bytes.indexOf(10);
        const name = decoder.decode(bytes.subarray(0, end));
        postMessage({ type: "answer", id, error: null, name, content: bytes.subarray(end + 1) });
    },
    /** Another worker, which traces what comes through a port. */
    enlist({ port }) {
        port.onmessage = guarded(({ data }) => {
            if (data) {
                put(data);
                module.receive();
            }
            idle.add(port);
            deal();
            go();
        });
        idle.add(port);
        deal();
    },
    /** The port through which pieces to trace come. */
    join({ port }) {
        port.onmessage = guarded(({ data }) => {
            held = { ...data, port };
            go();
        });
    },
};

/** Passes what the module has for the page. */
function pass() {
    for (let kind = module.take(); kind !== 0; kind = module.take()) {
        if (isMember) continue;
        const data = kind === 1 ? text() : output().buffer;
        postMessage({ type: "packet", data }, kind === 1 ? [] : [data]);
    }
}

/** Gives idle workers pieces, if there are any. */
function deal() {
    for (const port of idle) {
        if (!module.deal()) return;
        idle.delete(port);
        port.postMessage({ heard, piece: output() });
    }
}

/** Traces the piece that is held, if this worker has heard as much as the one that wants it; an older one is given up. */
function trace() {
    if (!held || heard < held.heard) return;
    const { piece, port } = held;
    const isOld = heard > held.heard;
    held = null;
    if (isOld) return port.postMessage(null);
    put(piece);
    module.trace();
    const traced = output();
    port.postMessage(traced, [traced.buffer]);
}

/** Has the graphics processor do what is next, if it does nothing. */
async function accelerate() {
    const next = isTracing || !found ? 0 : module.job();
    if (next === 0) return;
    isTracing = true;
    try {
        if (next === 2) {
            module.program();
            graphics = await Graphics.open(found, JSON.parse(text()));
            module.begin();
        } else {
            const job = output();
            const number = new Uint32Array(job.buffer, 0, 1)[0];
            put((await graphics.trace(job, () => module.wants(number))) ?? []);
            module.finish(number);
        }
    } catch (error) {
        // The processor goes on alone
        found = null;
        put(encoder.encode(error.message));
        module.lose();
    }
    isTracing = false;
    go();
}

/** Goes on after whatever the page has said by then. */
function go() {
    clearTimeout(timer);
    pass();
    if (isMember) return trace();
    if (isDue) return;
    isDue = true;
    port2.postMessage(null);
}

port1.onmessage = guarded(() => {
    isDue = false;
    const wait = module.step(STEP);
    deal();
    accelerate();
    if (wait === 0) return go();
    pass();
    if (wait < 1e6) timer = setTimeout(go, wait);
});

/** An action whose failure the page hears of; nothing is done after it. */
function guarded(action) {
    return async (event) => {
        if (failure) return;
        try {
            await action(event);
        } catch (error) {
            failure ||= `${error.message}, as where memory runs out`;
            postMessage({ type: "failed", message: failure });
        }
    };
}

let before = Promise.resolve();
onmessage = (event) => {
    before = before.then(() => guarded(({ data }) => ACTIONS[data.type](data))(event));
};
