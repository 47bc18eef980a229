// What tests and benches may look at: `window.translucidView`.

/** Entries that are kept of each kind. */
const MOST = 512;

export function startProbe(connection, session, picture) {
    const painted = [];
    const sent = [];
    const keep = (list, entry) => {
        list.push(entry);
        if (list.length > MOST) list.shift();
        return entry;
    };
    picture.onPainted(({ pixels, ...frame }) => {
        const entry = keep(painted, { ...frame, time: performance.now() });
        // After the frame of the animation went to the compositor.
        const { port1, port2 } = new MessageChannel();
        port1.onmessage = () => (entry.time = performance.now());
        port2.postMessage(null);
    });
    connection.on("sent", (message) => keep(sent, { ...message, time: performance.now(), isAnswered: false, version: null }));
    connection.on("answered", ({ id, version = null }) => {
        const message = sent.find((message) => message.id === id);
        if (message) Object.assign(message, { isAnswered: true, version });
    });
    // What was under way then is never answered.
    connection.on("forgotten", () => (sent.length = 0));
    const last = () => painted[painted.length - 1] ?? null;
    const copy = (list) => list.map((entry) => ({ ...entry }));
    Object.defineProperty(window, "translucidView", {
        value: Object.freeze({
            get lastFrame() {
                return last() && { ...last() };
            },
            get samples() {
                return last()?.samples ?? 0;
            },
            get version() {
                return last()?.version ?? 0;
            },
            get painted() {
                return copy(painted);
            },
            get sent() {
                return copy(sent);
            },
            get state() {
                return structuredClone(session.state);
            },
            get hello() {
                return structuredClone(session.hello);
            },
            get status() {
                return structuredClone(session.status);
            },
            get connected() {
                return session.isOpen;
            },
        }),
    });
}
