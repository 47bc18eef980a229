// The hand on the picture: orbit, pan, dolly, pick.

import { depthOf, dolly, lengthPerPixel, lookAt, orbit, pan } from "./camera.js";
import { Burst, nextGesture } from "./gesture.js";
import { add, scale, subtract } from "./vector.js";

/** Angle of a drag over the whole width of the picture, in radians. */
const TURN = Math.PI;
/** Angle and share of the picture of an arrow key. */
const STEP = Math.PI / 36;
const SHIFT = 0.05;
const ZOOM = 1.1;
/** A press that moves less, in pixels of CSS, is a click. */
const CLICK = 4;

export class Navigation {
    /** The point that was clicked last, and its material. */
    picked = null;

    #session;
    #picture;
    #viewport = document.getElementById("viewport");
    #pointers = new Map();
    #gesture = 0;
    #moved = false;
    #mode = "orbit";
    #burst = new Burst(250, () => this.#session.settle());
    #onPick = new Set();

    constructor(session, picture) {
        this.#session = session;
        this.#picture = picture;
        const view = this.#viewport;
        view.addEventListener("pointerdown", (event) => this.#down(event));
        view.addEventListener("pointermove", (event) => this.#move(event));
        view.addEventListener("pointerup", (event) => this.#up(event));
        view.addEventListener("pointercancel", (event) => this.#up(event));
        view.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
        view.addEventListener("dblclick", (event) => this.#lookThere(event));
        view.addEventListener("contextmenu", (event) => event.preventDefault());
        view.addEventListener("keydown", (event) => this.#key(event));
    }

    onPick(listener) {
        this.#onPick.add(listener);
    }

    /** Depth of what the scale bar measures: the point that was clicked last, or the target. */
    get depth() {
        const { camera } = this.#session.state;
        const depth = this.picked?.position ? depthOf(camera, this.picked.position) : 0;
        return depth > 0 ? depth : depthOf(camera, camera.target);
    }

    /** Asks what is at a place in the window. */
    async pick(clientX, clientY) {
        const point = this.#picture.filmPoint(clientX, clientY);
        if (!point) return null;
        const picked = await this.#session.ask({ type: "pick", ...point }).catch(() => null);
        if (picked) this.picked = picked;
        return picked;
    }

    /** Turns the whole view to another camera. */
    goTo(camera) {
        this.#session.setCamera(camera, { gesture: nextGesture() });
        this.#session.settle();
    }

    #down(event) {
        if (!this.#session.state || event.target.closest("button, input, [role=slider]")) return;
        // The left button gives the focus by itself, without the ring that keys have.
        if (event.button !== 0) this.#viewport.focus({ preventScroll: true });
        if (event.button === 1) event.preventDefault();
        this.#viewport.setPointerCapture(event.pointerId);
        this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (this.#pointers.size > 1) return;
        this.#gesture = nextGesture();
        this.#moved = false;
        this.#mode = event.button === 1 || event.button === 2 || event.shiftKey ? "pan" : "orbit";
        this.#start = { x: event.clientX, y: event.clientY };
    }

    #start = null;

    #move(event) {
        const before = this.#pointers.get(event.pointerId);
        if (!before) return;
        const after = { x: event.clientX, y: event.clientY };
        const far = Math.hypot(after.x - this.#start.x, after.y - this.#start.y);
        if (!this.#moved && this.#pointers.size === 1 && far < CLICK) return;
        this.#moved = true;
        this.#viewport.classList.add("moving");
        const old = [...this.#pointers.values()];
        this.#pointers.set(event.pointerId, after);
        const now = [...this.#pointers.values()];
        const { camera } = this.#session.state;
        this.#show(now.length > 1 ? this.#pinch(camera, old, now) : this.#drag(camera, before, after));
    }

    #drag(camera, before, after) {
        const { width } = this.#picture.rect;
        const [across, down] = [(after.x - before.x) / width, (after.y - before.y) / width];
        if (this.#mode === "pan") return pan(camera, -across, down);
        return orbit(camera, -across * TURN, down * TURN);
    }

    #pinch(camera, old, now) {
        const middle = ([a, b]) => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
        const spread = ([a, b]) => Math.max(1, Math.hypot(a.x - b.x, a.y - b.y));
        const { width } = this.#picture.rect;
        const [from, to] = [middle(old), middle(now)];
        const panned = pan(camera, (from.x - to.x) / width, (to.y - from.y) / width);
        return this.#dolly(panned, spread(old) / spread(now));
    }

    #dolly(camera, factor) {
        return dolly(camera, factor, 1e-3 * this.#session.state.bounds.radius);
    }

    #show(camera, gesture = this.#gesture) {
        this.#session.setCamera(camera, { moving: true, gesture });
    }

    #up(event) {
        if (!this.#pointers.delete(event.pointerId) || this.#pointers.size > 0) return;
        this.#viewport.classList.remove("moving");
        if (this.#moved) this.#session.settle();
        else if (event.type === "pointerup" && event.button === 0) this.#click(event);
    }

    async #click(event) {
        const picked = await this.pick(event.clientX, event.clientY);
        if (picked) for (const listener of this.#onPick) listener(picked);
    }

    #wheel(event) {
        if (!this.#session.state) return;
        event.preventDefault();
        // A line is 16 pixels in the browsers that count lines; a pinch on a touch pad turns less.
        const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
        const rate = event.ctrlKey ? 0.01 : 0.0015;
        this.#show(this.#dolly(this.#session.state.camera, Math.exp(pixels * rate)), this.#burst.next());
    }

    async #lookThere(event) {
        if (!this.#session.state || event.target.closest("button, input, [role=slider]")) return;
        const picked = await this.pick(event.clientX, event.clientY);
        if (!picked?.position) return;
        const gesture = nextGesture();
        const { target } = this.#session.state.camera;
        const way = subtract(picked.position, target);
        const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
        const [begin, time] = [performance.now(), still ? 0 : 250];
        const turn = () => {
            const t = Math.min(1, time > 0 ? (performance.now() - begin) / time : 1);
            const point = t < 1 ? add(target, scale(way, t * t * (3 - 2 * t))) : picked.position;
            this.#show(lookAt(this.#session.state.camera, point), gesture);
            if (t < 1) requestAnimationFrame(turn);
            else this.#session.settle();
        };
        turn();
    }

    #key(event) {
        if (!this.#session.state || event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.target !== this.#viewport) return;
        const { camera } = this.#session.state;
        const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
        const arrow = arrows[event.key];
        let next = null;
        if (arrow && event.shiftKey) next = pan(camera, arrow[0] * SHIFT, arrow[1] * SHIFT);
        else if (arrow) next = orbit(camera, arrow[0] * STEP, arrow[1] * STEP);
        else if (event.key === "+" || event.key === "=") next = this.#dolly(camera, 1 / ZOOM);
        else if (event.key === "-") next = this.#dolly(camera, ZOOM);
        else if (event.key === "Enter") this.#pickCenter();
        else return;
        event.preventDefault();
        if (next) this.#show(next, this.#burst.next());
    }

    #pickCenter() {
        const { left, top, width, height } = this.#picture.rect;
        this.#click({ clientX: left + width / 2, clientY: top + height / 2 });
    }

    /** Length of a pixel of the film where the scale bar measures. */
    get lengthPerPixel() {
        const { camera, film } = this.#session.state;
        return lengthPerPixel(camera, film.width, this.depth);
    }
}
