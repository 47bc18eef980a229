// The page as files that a server hands out, and files that are dropped on it.
//
// TRANSLUCID_PAGE is the folder that `.ci/page` has laid out (target/page where it is not said).

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";

const FOLDER = process.env.TRANSLUCID_PAGE ?? join(import.meta.dirname, "../../../../target/page");
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".wasm": "application/wasm" };

/** Serves the page: its address, what was asked of the server, and its end. */
export async function serveFiles() {
    const asked = [];
    const server = createServer(async (request, response) => {
        asked.push(`${request.method} ${request.url}`);
        const path = normalize(request.url === "/" ? "/index.html" : request.url);
        const content = await readFile(join(FOLDER, path)).catch(() => null);
        response.writeHead(content ? 200 : 404, { "content-type": TYPES[extname(path)] ?? "application/octet-stream" });
        response.end(content);
    });
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    return { address: `http://127.0.0.1:${server.address().port}/`, asked, close: () => server.close() };
}

/** Drops files on a page: `{ name: content }`. */
export async function drop(page, files) {
    const contents = Object.entries(files).map(([name, content]) => [name, Buffer.from(content).toString("base64")]);
    await page.evaluate((contents) => {
        const dropped = new DataTransfer();
        for (const [name, text] of contents) {
            dropped.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
        }
        for (const type of ["dragenter", "dragover", "drop"]) {
            document.body.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, dataTransfer: dropped }));
        }
    }, contents);
}
