// Asks the server about the material that is selected whenever it has changed.

/** Rest after a change before the question, in milliseconds: a slider in motion asks nothing. */
const REST = 150;

export class Watch {
    #session;
    #materials;
    #type;
    #isOpen;
    #show;
    #more;
    #shown = "";
    #asks = false;
    #timer = 0;

    /**
     * `show` gets the answer to messages of `type`, to which `more()` adds fields; nothing is asked while `isOpen()` is
     * false.
     */
    constructor(session, materials, type, isOpen, show, more = () => ({})) {
        this.#session = session;
        this.#materials = materials;
        this.#type = type;
        this.#isOpen = isOpen;
        this.#show = show;
        this.#more = more;
        session.on("state", () => this.look());
        session.on("hello", () => (this.#shown = ""));
        materials.onSelect(() => this.look());
    }

    /** Looks whether there is something to ask. */
    look() {
        if (!this.#session.state || !this.#isOpen() || this.#key() === this.#shown) return;
        clearTimeout(this.#timer);
        this.#timer = setTimeout(() => this.#ask(), REST);
    }

    #key() {
        const { index, material } = this.#materials;
        return JSON.stringify([index, this.#session.state.active, material, this.#more()]);
    }

    async #ask() {
        if (this.#asks || !this.#isOpen()) return;
        const key = this.#key();
        this.#asks = true;
        const message = { type: this.#type, index: this.#materials.index, ...this.#more() };
        const answer = await this.#session.ask(message).catch((error) => ({ error }));
        this.#asks = false;
        this.#shown = key;
        this.#show(answer.error ? null : answer, answer.error);
        if (this.#session.isOpen) this.look();
    }
}
