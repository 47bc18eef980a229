// Edits on their way to the server: the newest of each kind, never a queue.

/** Longest wait for the picture of the edit before, in milliseconds. */
const PATIENCE = 50;

/**
 * Lets an edit through at once if the picture of the one before was painted; else keeps the newest of each key until
 * it was, or for 50 ms. Never more than once an animation frame.
 */
export class Pacer {
    #send;
    #pending = new Map();
    #unanswered = new Set();
    #version = 0;
    #awaitsPicture = false;
    #sentThisFrame = false;
    #timer = 0;

    /** `send` gets a message and what came with it, and returns the message's number. */
    constructor(send) {
        this.#send = send;
    }

    /** Whether something is here that the server has not answered yet. */
    get isBusy() {
        return this.#pending.size > 0 || this.#unanswered.size > 0;
    }

    push(key, edit) {
        this.#pending.set(key, edit);
        this.#try();
    }

    /** Sends what waits, in its order. */
    flush() {
        if (this.#pending.size === 0) return;
        const edits = [...this.#pending.values()];
        this.#pending.clear();
        this.#awaitsPicture = true;
        this.#sentThisFrame = true;
        requestAnimationFrame(() => {
            this.#sentThisFrame = false;
            this.#try();
        });
        clearTimeout(this.#timer);
        this.#timer = setTimeout(() => {
            this.#awaitsPicture = false;
            // A page that is not seen has no animation frames.
            if (document.hidden) this.#sentThisFrame = false;
            this.#try();
        }, PATIENCE);
        for (const edit of edits) {
            const id = this.#send(edit);
            if (id !== null) this.#unanswered.add(id);
        }
    }

    /** The server has answered a message; `version` is null after an error. */
    answered(id, version) {
        if (!this.#unanswered.delete(id)) return;
        if (version !== null) this.#version = Math.max(this.#version, version);
    }

    /** A picture of a version is on the screen. */
    painted(version) {
        if (this.#unanswered.size > 0 || version < this.#version) return;
        this.#awaitsPicture = false;
        this.#try();
    }

    /** Forgets everything: the connection was lost. */
    clear() {
        this.#pending.clear();
        this.#unanswered.clear();
        this.#version = 0;
        this.#awaitsPicture = false;
    }

    #try() {
        if (!this.#awaitsPicture && !this.#sentThisFrame) this.flush();
    }
}
