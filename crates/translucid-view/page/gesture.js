// Numbers of gestures: the edits of one are one step of undo.

// Two pages may share a session, so the numbers of this one start where no other's do.
let last = Date.now() * 1000 + Math.floor(Math.random() * 1000);

/** A number that no gesture had. */
export const nextGesture = () => ++last;

/** One number for all that happens without a pause, such as turns of a wheel. */
export class Burst {
    #gesture = 0;
    #timer = 0;
    #pause;

    /** `pause` is in milliseconds; `ended` is called after it. */
    constructor(pause, ended = () => {}) {
        this.#pause = pause;
        this.ended = ended;
    }

    next() {
        clearTimeout(this.#timer);
        this.#gesture ||= nextGesture();
        this.#timer = setTimeout(() => this.end(), this.#pause);
        return this.#gesture;
    }

    end() {
        clearTimeout(this.#timer);
        if (this.#gesture === 0) return;
        this.#gesture = 0;
        this.ended();
    }
}
