// The connection: messages with numbers, their answers, and coming back when it is lost.

import { Events } from "./events.js";

/** Waits between attempts to come back, in milliseconds; the last one repeats. */
const WAITS = [200, 400, 800, 1600, 3000, 5000];

/**
 * Emits `open`, `lost` with the number of attempts, `frame` with its bytes, every message by its type, and of what is
 * sent with a number `sent` and `answered`.
 */
export class Connection extends Events {
    #openSocket;
    #socket = null;
    #attempts = 0;
    #timer = 0;
    #id = 0;
    #waiting = new Map();

    /** `openSocket()` gives a WebSocket, or what behaves as one. */
    constructor(openSocket) {
        super();
        this.#openSocket = openSocket;
        document.addEventListener("visibilitychange", () => {
            if (!document.hidden && !this.isOpen) this.open();
        });
        addEventListener("online", () => this.isOpen || this.open());
    }

    get isOpen() {
        return this.#socket?.readyState === WebSocket.OPEN;
    }

    /** Connects now, whatever wait was left. */
    open() {
        clearTimeout(this.#timer);
        if (this.#socket && this.#socket.readyState < WebSocket.CLOSING) return;
        const socket = this.#openSocket();
        this.#socket = socket;
        socket.onopen = () => {
            this.#attempts = 0;
            this.emit("open");
        };
        socket.onmessage = ({ data }) => this.#receive(data);
        socket.onclose = () => this.#lost(socket);
    }

    /** Leaves the session for another one. */
    reopen() {
        const before = this.#socket;
        this.#socket = null;
        before?.close();
        this.#forget("the session was left");
        this.open();
    }

    /** Sends a message; its number, or null where there is no connection. */
    send(message) {
        if (!this.isOpen) return null;
        const id = ++this.#id;
        this.#socket.send(JSON.stringify({ ...message, id }));
        this.emit("sent", { id, type: message.type });
        return id;
    }

    /** Sends a message whose answer nobody waits for. */
    tell(message) {
        if (this.isOpen) this.#socket.send(JSON.stringify(message));
    }

    /** Sends a message and waits for its answer; an error of the server, or a lost connection, rejects. */
    ask(message) {
        const id = this.send(message);
        if (id === null) return Promise.reject(new Error("not connected"));
        return new Promise((resolve, reject) => this.#waiting.set(id, { resolve, reject }));
    }

    #receive(data) {
        if (typeof data !== "string") return this.emit("frame", data);
        const message = JSON.parse(data);
        if (message.id) this.emit("answered", message);
        const waiting = this.#waiting.get(message.id);
        if (waiting) {
            this.#waiting.delete(message.id);
            if (message.type !== "error") waiting.resolve(message);
            else waiting.reject(Object.assign(new Error(message.message), { help: message.help, answered: true }));
            if (message.type !== "applied") return;
        }
        this.emit(message.type, message);
    }

    #lost(socket) {
        if (socket !== this.#socket) return;
        this.#forget("the connection was lost");
        const wait = WAITS[Math.min(this.#attempts++, WAITS.length - 1)];
        this.#timer = setTimeout(() => this.open(), wait);
        this.emit("lost", { attempts: this.#attempts });
    }

    /** Nobody answers what was asked. */
    #forget(why) {
        for (const { reject } of this.#waiting.values()) reject(new Error(why));
        this.#waiting.clear();
        this.emit("forgotten");
    }
}
