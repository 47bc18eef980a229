// Where the session is: in a Web Worker of this page. No server is asked, and nothing leaves the computer.

import { byId } from "./dom.js";
import { WorkerSocket } from "./worker-socket.js";

/** What the page says where the session answers no more. */
export const LOST = "The renderer has stopped.";

/** Files that may be a scene, those that name others first. */
const SCENES = [".toml", ".gltf", ".glb", ".obj", ".ply", ".stl"];

/** The scene of the next worker: its file's name, empty for the still life, and its files. */
let scene = { name: "", files: [] };
/** The worker at work, and one whose scene is there already. */
let [current, ready] = [null, null];

/** Starts a worker, or takes the one that is ready. */
export function openSocket() {
    current = ready ?? new WorkerSocket(scene);
    ready = null;
    // A scene that fails is not tried again
    scene = { name: "", files: [] };
    return current;
}

/** Makes an image the environment: nothing, or `{ message, help }` of what is wrong with it. */
export async function sendEnvironment(file) {
    const { error } = await current.ask("environment", { name: file.name, bytes: await file.arrayBuffer() });
    return error;
}

/** Lets the links of the menu save files of the session. */
export function startSaving(session, notices) {
    for (const kind of ["scene", "exr", "png"]) {
        const link = byId(`save-${kind}`);
        link.removeAttribute("href");
        link.tabIndex = 0;
        link.addEventListener("keydown", (event) => event.key === "Enter" && link.click());
        link.addEventListener("click", async (event) => {
            if (link.href) return;
            event.preventDefault();
            const { error, name, content } = await current.ask("save", { kind, side: session.side });
            if (error) return notices.error(error);
            const url = URL.createObjectURL(new Blob([content]));
            Object.assign(link, { href: url, download: name });
            link.click();
            link.removeAttribute("href");
            setTimeout(() => URL.revokeObjectURL(url), 60_000);
        });
    }
}

/** Lets the page open scenes: by its button, and by files that are dropped. */
export function startScenes(connection, notices) {
    const input = byId("scene-file");
    byId("open-scene").hidden = false;
    byId("open-scene").addEventListener("click", () => input.click());
    input.addEventListener("change", () => {
        if (input.files.length > 0) open([...input.files]);
        input.value = "";
    });
    connection.on("warnings", ({ messages }) => messages.forEach((message) => notices.say(message)));
    let failure = "";
    connection.on("hello", () => (failure = ""));
    connection.on("failed", ({ message }) => {
        // Of a failure that comes again at each attempt the page tells once
        if (message !== failure) notices.error({ message: `The renderer has stopped: ${message}` });
        failure = message;
    });
    byId("drop").firstElementChild.textContent = "Drop a mesh, a scene, or an image for the environment";
    byId("place").hidden = false;
    byId("phase").textContent = "Loading";

    async function open(files) {
        const name = sceneOf(files).name;
        const progress = notices.say(`Opening ${name} \u2026`);
        const contents = await Promise.all(files.map(async (file) => ({ name: file.name, bytes: await file.arrayBuffer() })));
        const next = new WorkerSocket({ name, files: contents });
        const error = await next.opened;
        progress.close();
        if (error) return notices.error(error);
        ready = next;
        connection.reopen();
    }
    openFiles = open;
}

let openFiles = null;

/** Whether files are those of a scene; opens it then. */
export function areScene(files) {
    if (!sceneOf(files)) return false;
    openFiles(files);
    return true;
}

/** The file of a scene or mesh among others. */
function sceneOf(files) {
    const found = (ending) => files.find(({ name }) => name.toLowerCase().endsWith(ending));
    return SCENES.map(found).find(Boolean);
}
