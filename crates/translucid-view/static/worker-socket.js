// A worker with a session, as a WebSocket to a server would be.

/** Most workers that render: each has a copy of the scene. */
const MOST = 8;
/** Messages that ask something or tell of a picture, and edit nothing. */
const QUESTIONS = ["painted", "pick", "profile", "numbers"];

/** The module, compiled once for all workers. */
let compiled = null;

function compile() {
    const url = new URL("translucid.wasm", import.meta.url);
    // Servers that do not know the type of the file
    const slowly = async () => WebAssembly.compile(await (await fetch(url)).arrayBuffer());
    compiled ??= WebAssembly.compileStreaming(fetch(url)).catch(slowly);
    compiled.catch(() => (compiled = null));
    return compiled;
}

const startWorker = () => new Worker(new URL("worker.js", import.meta.url), { type: "module" });

export class WorkerSocket {
    readyState = WebSocket.CONNECTING;
    onopen = null;
    onclose = null;
    /** Nothing, or `{ message, help }` of what is wrong with the scene. */
    opened;

    #scene;
    #worker = startWorker();
    /** Workers that trace for it. */
    #members = new Set();
    /** Edits since the beginning, until all members have come. */
    #edits = [];
    #onmessage = null;
    /** What came before anybody listened. */
    #early = [];
    #asked = new Map();
    #id = 0;

    /** Opens a scene: the name of its file, empty for the still life, and `{ name, bytes }` of its files. */
    constructor(scene) {
        this.#scene = scene;
        this.opened = new Promise((resolve) => {
            this.#worker.onmessage = ({ data }) => this.#hear(data, resolve);
            this.#worker.onerror = ({ message }) => this.#hear({ type: "failed", message }, resolve);
        });
        compile().then(
            (module) => this.#worker.postMessage({ type: "open", module, ...scene, isMember: false }),
            ({ message }) => this.#worker.onerror({ message: `translucid.wasm cannot be loaded: ${message}` }),
        );
    }

    get onmessage() {
        return this.#onmessage;
    }

    set onmessage(listener) {
        this.#onmessage = listener;
        if (this.readyState === WebSocket.OPEN) queueMicrotask(() => this.#begin());
    }

    send(text) {
        const isEdit = !QUESTIONS.includes(JSON.parse(text).type);
        const message = { type: "tell", text, isEdit };
        this.#worker.postMessage(message);
        if (isEdit) this.#spread(message);
    }

    /** Asks for something that is no message of the session: "environment" or "save". */
    ask(type, parts) {
        const id = ++this.#id;
        const message = { type, id, ...parts };
        this.#worker.postMessage(message);
        if (type === "environment") this.#spread(message);
        return new Promise((resolve) => this.#asked.set(id, resolve));
    }

    close() {
        this.readyState = WebSocket.CLOSED;
        for (const worker of [this.#worker, ...this.#members]) worker.terminate();
        this.#members.clear();
        for (const answer of this.#asked.values()) answer({ error: { message: "the renderer has stopped" } });
        this.#asked.clear();
    }

    /** Tells all members of an edit. */
    #spread(message) {
        this.#edits?.push(message);
        for (const worker of this.#members) worker.postMessage(message);
    }

    /** Starts workers that trace, as many as there are processors besides. */
    async #enlist() {
        const module = await compile();
        const count = Math.min(MOST, navigator.hardwareConcurrency ?? 1) - 1;
        for (let i = 0; i < count && this.readyState === WebSocket.OPEN; i++) {
            const worker = startWorker();
            worker.onmessage = ({ data: { type } }) => {
                if (type === "opened") {
                    const { port1, port2 } = new MessageChannel();
                    worker.postMessage({ type: "join", port: port2 }, [port2]);
                    this.#worker.postMessage({ type: "enlist", port: port1 }, [port1]);
                } else {
                    // Where memory is short there are fewer
                    this.#members.delete(worker);
                    worker.terminate();
                }
            };
            this.#members.add(worker);
            worker.postMessage({ type: "open", module, ...this.#scene, isMember: true });
            for (const edit of this.#edits) worker.postMessage(edit);
        }
        this.#edits = null;
    }

    #begin() {
        this.onopen?.();
        for (const data of this.#early.splice(0)) this.#onmessage({ data });
    }

    #hear(message, resolve) {
        if (this.readyState >= WebSocket.CLOSING) return;
        if (message.type === "packet") {
            if (this.#onmessage && this.#early.length === 0) this.#onmessage({ data: message.data });
            else this.#early.push(message.data);
        } else if (message.type === "opened") {
            this.readyState = WebSocket.OPEN;
            resolve(null);
            if (this.#onmessage) this.#begin();
            this.#enlist();
        } else if (message.type === "refused") {
            resolve(message.error);
            this.close();
        } else if (message.type === "answer") {
            this.#asked.get(message.id)(message);
            this.#asked.delete(message.id);
        } else {
            resolve({ message: message.message });
            this.#onmessage?.({ data: JSON.stringify({ type: "failed", message: message.message }) });
            this.close();
            this.onclose?.();
        }
    }
}
