// Where the session is: at the server that serves the page. On pages without a server another file stands in its place.

import { byId } from "./dom.js";

/** What the page says where the session answers no more. */
export const LOST = "translucid does not answer. Is the command still running? A new one prints a new address.";

/** Opens a WebSocket. */
export function openSocket() {
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    return socket;
}

/** Makes an image the environment: nothing, or `{ message, help }` of what is wrong with it. */
export async function sendEnvironment(file) {
    const url = `environment?name=${encodeURIComponent(file.name)}`;
    const answer = await fetch(url, { method: "POST", body: file });
    const result = await answer.json().catch(() => ({ message: `the server answered ${answer.status}` }));
    return answer.ok ? null : result;
}

/** Lets the links of the menu save files of the session. */
export function startSaving(session) {
    session.on("state", () => {
        for (const kind of ["exr", "png"]) byId(`save-${kind}`).href = `picture.${kind}?side=${session.side}`;
    });
}

/** Scenes are chosen by the command. */
export function startScenes() {}

/** Whether files are those of a scene, which the page opens itself. */
export function areScene() {
    return false;
}
