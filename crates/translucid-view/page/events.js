// Listeners by name.

export class Events {
    #listeners = new Map();

    on(name, listener) {
        if (!this.#listeners.has(name)) this.#listeners.set(name, new Set());
        this.#listeners.get(name).add(listener);
    }

    emit(name, ...values) {
        for (const listener of this.#listeners.get(name) ?? []) listener(...values);
    }
}
