// What the page knows of the server's session, and every way to change it.
//
// The server's state is the truth. While edits are under way the page shows its own guess of what they do, so that
// controls follow the hand; once all are answered it takes the server's state again.

import { Events } from "./events.js";
import { Pacer } from "./pacing.js";

/** Emits `hello`, `state`, `status`, `frame`, `error` (of no control), `open` and `lost`. */
export class Session extends Events {
    hello = null;
    state = null;
    status = null;

    #connection;
    #pacer;
    #served = null;
    #answered = 0;
    #controls = new Map();
    #renders = false;

    constructor(connection) {
        super();
        this.#connection = connection;
        this.#pacer = new Pacer((edit) => this.#deliver(edit));
        connection.on("open", () => this.emit("open"));
        connection.on("forgotten", () => this.#forget());
        connection.on("lost", (lost) => this.emit("lost", lost));
        connection.on("frame", (bytes) => this.emit("frame", bytes));
        connection.on("hello", (hello) => {
            this.hello = hello;
            this.emit("hello", hello);
        });
        connection.on("state", (state) => this.#serve(state));
        connection.on("status", (status) => {
            this.status = status;
            this.emit("status", status);
        });
        connection.on("applied", ({ id, version }) => this.#settle(id, version, null));
        connection.on("error", (error) => this.#settle(error.id, null, error));
    }

    get isOpen() {
        return this.#connection.isOpen;
    }

    /** The side whose settings the panels show. */
    get side() {
        return this.state.active === "b" ? "b" : "a";
    }

    get look() {
        return this.state.sides[this.side];
    }

    // Ways to change it

    /** Sets parameters of a material of the active side, by the keys of scene files. */
    setMaterial(index, set, { gesture, control, key = Object.keys(set).join() } = {}) {
        this.#edit(`material ${index} ${key}`, { type: "material", index, set, gesture }, control, () => {
            for (const look of this.#edited()) patchMaterial(look.materials[index], set);
        });
    }

    setLight(index, light, { gesture, control } = {}) {
        this.#edit(`light ${index}`, { type: "light", index, light, gesture }, control, () => {
            for (const look of this.#edited()) look.lights[index] = light;
        });
    }

    addLight(light) {
        return this.command({ type: "add_light", light });
    }

    removeLight(index) {
        return this.command({ type: "remove_light", index });
    }

    setEnvironment(environment, { gesture, control } = {}) {
        this.#edit("environment", { type: "environment", environment, gesture }, control, () => {
            for (const look of this.#edited()) look.environment = environment;
        });
    }

    setIntegrator(set, { gesture, control } = {}) {
        this.#edit(`integrator ${Object.keys(set).join()}`, { type: "integrator", set, gesture }, control, () => {
            for (const look of this.#edited()) Object.assign(look.integrator, set);
        });
    }

    setFilm(set, { gesture, control } = {}) {
        this.#edit(`film ${Object.keys(set).join()}`, { type: "film", set, gesture }, control, () => {
            const { size, ...rest } = set;
            Object.assign(this.state.film, rest, size && { width: size[0], height: size[1] });
        });
    }

    setCamera(camera, { moving = false, gesture, control } = {}) {
        this.#edit("camera", { type: "camera", camera, moving, gesture }, control, () => {
            this.state.camera = camera;
        });
    }

    /** Turns the bare mesh: the axis that is up, and angles about x, y and z. */
    setOrientation(orientation, { gesture, control } = {}) {
        this.#edit("orientation", { type: "orient", ...orientation, gesture }, control, () => {
            this.state.orientation = orientation;
        });
    }

    /** A row's `change`: edits with each value, and settles at the end of a gesture. */
    editing(edit) {
        return (value, gesture, isFinal, control) => {
            if (gesture !== null) edit(value, { gesture, control });
            if (isFinal) this.settle();
        };
    }

    /** Nothing moves any more. */
    settle() {
        this.#pacer.flush();
        this.#connection.tell({ type: "settled" });
    }

    /** Something that is no edit of a value, such as undo, after all edits before it. */
    command(message) {
        this.#pacer.flush();
        return this.#connection.ask(message).then(
            (answer) => answer,
            (error) => {
                if (error.answered) this.emit("error", error);
                return null;
            },
        );
    }

    /** A question; rejects where there is no answer. */
    ask(message) {
        return this.#connection.ask(message);
    }

    /** A frame of this number and version is on the screen. */
    painted(frame, version) {
        this.#connection.tell({ type: "painted", frame });
        this.#pacer.painted(version);
    }

    connect() {
        this.#connection.open();
    }

    // What becomes of edits

    #edited() {
        const { active, sides } = this.state;
        return active === "both" ? [sides.a, sides.b] : [sides[active]];
    }

    #edit(key, message, control, patch) {
        if (!this.state || !this.isOpen) return;
        if (this.state === this.#served) this.state = structuredClone(this.state);
        patch();
        this.#pacer.push(key, { message, control });
        this.#show();
    }

    #deliver({ message, control }) {
        const id = this.#connection.send(message);
        if (id !== null) this.#controls.set(id, control);
        return id;
    }

    #settle(id, version, error) {
        if (version !== null) this.#answered = Math.max(this.#answered, version);
        this.#pacer.answered(id, version);
        const control = this.#controls.get(id);
        this.#controls.delete(id);
        if (!error) control?.accept();
        else if (control) control.refuse(error);
        else this.emit("error", error);
        if (this.#pacer.isBusy || !this.#served) return;
        // After an error the page's guess was wrong, whatever the version.
        if (error || this.#served.version >= this.#answered) this.#take();
    }

    /** Takes what has changed; the first state of a connection has all of it. */
    #serve({ type, sides, ...parts }) {
        this.#served = { ...this.#served, ...parts, sides: { ...this.#served?.sides, ...sides } };
        if (!this.#pacer.isBusy) this.#take();
    }

    #take() {
        this.state = this.#served;
        this.#show();
    }

    /** Tells the panels, once an animation frame. */
    #show() {
        if (this.#renders) return;
        this.#renders = true;
        requestAnimationFrame(() => {
            this.#renders = false;
            if (this.hello && this.state) this.emit("state", this.state);
        });
    }

    #forget() {
        this.#pacer.clear();
        this.#controls.clear();
        this.#answered = 0;
    }
}

function patchMaterial(material, set) {
    for (const [key, value] of Object.entries(set)) {
        if (key in material.parameters) material.parameters[key].value = value;
        else if (key in material) material[key] = value;
    }
    // Which model a default is, the server says
    if (material.subsurface_model !== "default") material.model = material.subsurface_model;
    const { subsurface_radius: radius, subsurface_radius_scale: scale } = material.parameters;
    material.mfp = scale.value.map((factor) => factor * radius.value);
}
