// The picture: frames of the server on canvases, as large as they fit.

/** Frames that no page drew yet; the newest of each side is enough. */
const HEADER = 24;
const MAGIC = 84;
/** Sides of a frame's header. */
const SIDES = ["a", "b", "map"];

/** A frame's header and pixels, or null if it is none. */
export function readFrame(buffer) {
    const view = new DataView(buffer);
    if (buffer.byteLength < HEADER || view.getUint8(0) !== MAGIC) return null;
    const [width, height] = [view.getUint16(12, true), view.getUint16(14, true)];
    const side = SIDES[view.getUint8(1)];
    if (!side || buffer.byteLength !== HEADER + width * height * 4) return null;
    return {
        side,
        edge: view.getUint8(2),
        isLast: (view.getUint8(3) & 1) === 1,
        number: view.getUint32(4, true),
        version: view.getUint32(8, true),
        width,
        height,
        samples: view.getUint32(16, true),
        seconds: view.getFloat32(20, true),
        pixels: new Uint8ClampedArray(buffer, HEADER),
    };
}

/** Paints frames in animation frames, tells the server, and calls `painted` with each. */
export class Picture {
    /** The frame on the screen, of each side. */
    shown = { a: null, b: null, map: null };
    /** Zoom: the whole picture in the window, or a pixel of the film for a pixel of the screen. */
    fits = true;

    #session;
    #stage = document.getElementById("stage");
    #viewport = document.getElementById("viewport");
    #canvases = {};
    #contexts = {};
    #waiting = new Map();
    #scratch = document.createElement("canvas");
    #scheduled = false;
    #listeners = new Set();
    #resized = new Set();

    constructor(session) {
        this.#session = session;
        for (const side of SIDES) {
            this.#canvases[side] = document.getElementById(`picture-${side}`);
            this.#contexts[side] = this.#canvases[side].getContext("2d");
        }
        session.on("frame", (bytes) => this.#receive(bytes));
        // Numbers of frames begin again with a connection.
        session.on("hello", () => {
            this.#waiting.clear();
            for (const side of SIDES) this.shown[side] = null;
        });
        session.on("state", () => this.layout());
        new ResizeObserver(() => this.layout()).observe(this.#viewport);
        const zoom = document.getElementById("zoom");
        zoom.addEventListener("click", () => this.zoom(!this.fits));
    }

    onPainted(listener) {
        this.#listeners.add(listener);
    }

    /** Calls a listener whenever the picture has another size on the screen. */
    onResize(listener) {
        this.#resized.add(listener);
    }

    /** Where the picture is on the screen. */
    get rect() {
        return this.#stage.getBoundingClientRect();
    }

    /** The film's pixel, with fractions, at a place in the window. */
    filmPoint(clientX, clientY) {
        const { left, top, width, height } = this.rect;
        const { film } = this.#session.state;
        const [x, y] = [((clientX - left) / width) * film.width, ((clientY - top) / height) * film.height];
        return x >= 0 && y >= 0 && x < film.width && y < film.height ? { x, y } : null;
    }

    /** The codes [r, g, b, alpha] on the screen at a pixel of the film. */
    codesAt(side, { x, y }) {
        const frame = this.shown[side];
        if (!frame) return null;
        const [column, row] = [Math.floor(x / frame.edge), Math.floor(y / frame.edge)];
        if (column >= frame.width || row >= frame.height) return null;
        const at = 4 * (row * frame.width + column);
        return frame.pixels.subarray(at, at + 4);
    }

    zoom(fits) {
        this.fits = fits;
        this.layout();
    }

    /** Makes the picture as large as the window and the zoom say. */
    layout() {
        const { film, compare, view } = this.#session.state ?? {};
        if (!film) return;
        const isMap = compare && this.isMap(view);
        this.#canvases.a.hidden = isMap;
        this.#canvases.b.hidden = !compare || isMap;
        this.#canvases.map.hidden = !isMap;
        const style = getComputedStyle(this.#viewport);
        const room = (size, ...sides) => size - sides.reduce((sum, name) => sum + parseFloat(style[name]), 0);
        const [wide, high] = [
            room(this.#viewport.clientWidth, "paddingLeft", "paddingRight"),
            room(this.#viewport.clientHeight, "paddingTop", "paddingBottom"),
        ];
        const factor = this.fits ? crisp(Math.min(wide / film.width, high / film.height)) : 1 / devicePixelRatio;
        const [width, height] = [film.width, film.height].map((n) => `${Math.max(1, Math.floor(n * factor))}px`);
        if (this.#stage.style.width !== width || this.#stage.style.height !== height) {
            this.#stage.style.width = width;
            this.#stage.style.height = height;
        }
        this.#viewport.classList.toggle("magnified", !this.fits);
        const zoom = document.getElementById("zoom");
        const percent = Math.round(100 * factor * devicePixelRatio);
        zoom.textContent = this.fits ? `Fit ${percent}\u2009%` : "100\u2009%";
        zoom.setAttribute("aria-pressed", String(!this.fits));
        for (const listener of this.#resized) listener();
    }

    isMap(view) {
        return view === "difference" || view === "flip";
    }

    #receive(bytes) {
        const frame = readFrame(bytes);
        if (!frame) return;
        const before = this.#waiting.get(frame.side) ?? this.shown[frame.side];
        if (before && frame.number < before.number) return;
        this.#waiting.set(frame.side, frame);
        if (this.#scheduled) return;
        this.#scheduled = true;
        requestAnimationFrame(() => this.#paint());
    }

    #paint() {
        this.#scheduled = false;
        const frames = [...this.#waiting.values()].sort((a, b) => a.number - b.number);
        this.#waiting.clear();
        for (const frame of frames) {
            this.#draw(frame);
            this.shown[frame.side] = frame;
            this.#session.painted(frame.number, frame.version);
            for (const listener of this.#listeners) listener(frame);
        }
    }

    #draw(frame) {
        const [canvas, context] = [this.#canvases[frame.side], this.#contexts[frame.side]];
        const { width, height } = this.#filmOf(frame);
        if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
        const image = new ImageData(frame.pixels, frame.width, frame.height);
        if (frame.edge === 1) return context.putImageData(image, 0, 0);
        // Coarse pixels of the last column and row reach beyond the film.
        const scratch = this.#scratch;
        if (scratch.width !== frame.width || scratch.height !== frame.height) {
            Object.assign(scratch, { width: frame.width, height: frame.height });
        }
        scratch.getContext("2d").putImageData(image, 0, 0);
        context.imageSmoothingEnabled = true;
        context.globalCompositeOperation = "copy";
        context.drawImage(scratch, 0, 0, frame.width * frame.edge, frame.height * frame.edge);
    }

    /** Size of the film that a frame shows; a film of another size may be on its way. */
    #filmOf({ width, height, edge }) {
        const film = this.#session.state?.film;
        const is = (n, whole) => Math.ceil(whole / edge) === n;
        if (film && is(width, film.width) && is(height, film.height)) return film;
        return { width: width * edge, height: height * edge };
    }
}

/** A factor that is little more than a whole one on the screen becomes that: pixels stay sharp. */
function crisp(factor) {
    const whole = Math.floor(factor * devicePixelRatio) / devicePixelRatio;
    return whole > 0 && factor < 1.12 * whole ? whole : factor;
}
