// The page as files: its session runs in WebAssembly, and a server only hands the files out.
//
// `files.mjs` says where it lies.

import assert from "node:assert/strict";
import { copyFile, mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";

import { drop, serveFiles } from "./files.mjs";
import { difference, launch, SCENE, View } from "./view.mjs";

const server = await serveFiles();
const { address, asked } = server;
const browser = await launch();
const folder = await mkdtemp(join(tmpdir(), "translucid-page-"));
after(async () => {
    await browser.close();
    server.close();
    await rm(folder, { recursive: true });
});

async function open() {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, permissions: ["clipboard-read", "clipboard-write"] });
    return new View(await context.newPage(), { address }, folder);
}

/** Drops a scene and waits until the page shows it. */
async function shows(view, files, name) {
    await drop(view.page, files);
    await view.page.waitForFunction((name) => window.translucidView.hello?.name === name, name);
    await view.page.waitForFunction(() => window.translucidView.lastFrame?.number <= window.translucidView.painted.at(-1).number);
}

const small = { "small.toml": await readFile(SCENE) };
await copyFile(SCENE, join(folder, "small.toml"));

const TETRAHEDRON = `mtllib colors.mtl
v 0 0 0\nv 10 0 0\nv 5 0 9\nv 5 9 4
usemtl green\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n`;

/** A triangle as binary glTF. */
function triangle() {
    const positions = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
    const document = JSON.stringify({
        asset: { version: "2.0" },
        scenes: [{ nodes: [0] }],
        nodes: [{ mesh: 0, name: "triangle" }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
        bufferViews: [{ buffer: 0, byteLength: 36 }],
        buffers: [{ byteLength: 36 }],
    });
    const json = Buffer.from(document.padEnd(4 * Math.ceil(document.length / 4)));
    const chunk = (type, data) => {
        const head = Buffer.alloc(8);
        head.writeUInt32LE(data.length, 0);
        head.write(type, 4, "latin1");
        return Buffer.concat([head, data]);
    };
    const chunks = Buffer.concat([chunk("JSON", json), chunk("BIN\0", positions)]);
    const head = Buffer.alloc(12);
    head.write("glTF", 0);
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(12 + chunks.length, 8);
    return Buffer.concat([head, chunks]);
}

const view = await open();

test("the still life appears, coarse and then finer, with the materials of its panel", async () => {
    await view.load();
    assert.equal(await view.page.locator("#scene-name").textContent(), "still life");
    assert.ok(await view.page.locator("#place").isVisible());
    const { codes } = await view.pixels();
    assert.ok(new Set(codes.filter((_, i) => i % 4 === 1)).size > 50, "a picture, not a surface of one color");
    await view.page.waitForFunction(() => window.translucidView.lastFrame.edge <= 4);
    assert.ok((await view.page.locator("#material option").count()) > 5);
});

test("a scene that is dropped shows what the command renders, to the last bit", async () => {
    await shows(view, small, "small.toml");
    await view.agrees("the scene as it is");
});

test("edits change the picture, and undo brings it back", async () => {
    const before = await view.pixels();
    await view.type("material-subsurface_radius", 1.7);
    await view.agrees("a longer path");
    assert.ok(difference(before.codes, (await view.pixels()).codes) > 0);
    await view.choose("material-subsurface_model", "dipole");
    await view.agrees("another model");
    await view.history("undo");
    await view.history("undo");
    await view.done();
    assert.equal(difference(before.codes, (await view.pixels()).codes), 0);
});

test("the camera orbits; points are refused in words", async () => {
    await view.page.locator("#viewport").focus();
    await view.page.keyboard.press("ArrowLeft");
    await view.agrees("orbit");
    await view.choose("integrator-subsurface_method", "point-based");
    await view.page.locator("#render-panel .error", { hasText: "too slow" }).waitFor();
    await view.agrees("as before");
    await view.reset();
});

test("it is compared with the random walk", async () => {
    await view.choose("material-subsurface_model", "normalized-diffusion");
    await view.done();
    await view.click("truth");
    await view.done();
    assert.ok(difference((await view.pixels("a")).codes, (await view.pixels("b")).codes) > 0);
    await view.click("show-flip");
    await view.done();
    assert.match(await view.page.locator("#difference").textContent(), /\d/);
    await view.click("compare");
    await view.reset();
});

test("profile and numbers are computed here, too", async () => {
    await view.choose("material-subsurface_model", "dipole");
    for (const name of ["profile", "numbers"]) {
        if (!(await view.page.locator(`#${name}-panel`).isVisible())) await view.click(`toggle-${name}`);
    }
    await view.page.locator("#profile-errors li", { hasText: "%" }).nth(2).waitFor();
    await view.page.locator("#numbers-tables table").first().waitFor();
    await view.page.locator(".system .copy").first().click();
    await view.page.waitForFunction(async () => (await navigator.clipboard.readText()).length > 0);
    await view.reset();
});

test("pictures are saved", async () => {
    assert.equal((await view.save("exr")).readUInt32LE(0), 20000630, "the magic number of OpenEXR");
    assert.equal((await view.save("png")).toString("latin1", 1, 4), "PNG");
});

test("a picture that is dropped becomes the environment, and one that is none is named", async () => {
    await drop(view.page, { "sky.hdr": Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x40\x40\x40\x81", "latin1") });
    await view.page.waitForFunction(() => window.translucidView.state.images.some(({ name }) => name === "sky.hdr"));
    await view.done();
    // Four pixels in a row are no panorama
    await drop(view.page, { "row.hdr": Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 4\n" + "\x80\x80\x80\x81".repeat(4), "latin1") });
    await view.page.waitForFunction(() => window.translucidView.state.notes.some((note) => note.startsWith("row.hdr: the environment has 4 x 1 pixels")));
    await view.done();
    await drop(view.page, { "broken.hdr": "#?RADIANCE\nnonsense" });
    await view.page.locator(".notice.error", { hasText: "broken.hdr" }).waitFor();
    await view.reset();
});

test("meshes that are dropped show, with the files that they name", async () => {
    await shows(view, { "tetrahedron.obj": TETRAHEDRON, "colors.mtl": "newmtl green\nKd 0.1 0.7 0.2\n" }, "tetrahedron.obj");
    assert.equal(await view.page.locator("#material option").first().textContent(), "green");
    await view.answered(() => view.choose("mesh-up", "-x"));
    assert.equal((await view.state()).orientation.up, "-x");
    await view.page.waitForFunction(() => window.translucidView.lastFrame.version >= window.translucidView.state.version);
    assert.match(String(await view.save("scene")), /^up = "-x"$/m);
    await shows(view, { "triangle.glb": triangle() }, "triangle.glb");
    assert.equal((await view.page.evaluate(() => window.translucidView.hello.objects[0].name)), "triangle");
    const { codes } = await view.pixels();
    assert.ok(new Set(codes.filter((_, i) => i % 4 === 1)).size > 20);
    // Compressed by Draco
    const ball = await readFile(join(import.meta.dirname, "../../../translucid-load/tests/data/draco_edgebreaker.glb"));
    await shows(view, { "ball.glb": ball }, "ball.glb");
    assert.ok(new Set((await view.pixels()).codes.filter((_, i) => i % 4 === 1)).size > 20);
});

test("a broken file is named, and the scene before it stays", async () => {
    await shows(view, small, "small.toml");
    for (const [files, words] of [
        [{ "broken.obj": "v 0 0 0\nf 1 2 9\n" }, /broken\.obj.*line 2|broken\.obj:2/],
        [{ "broken.glb": "glTF nonsense" }, /broken\.glb/],
        [{ "broken.toml": 'unit = "cm"\n[film]\nexposure = 99\n' }, /broken\.toml.*exposure is 99/],
        [{ "lonely.toml": 'unit = "cm"\n[[object]]\nname = "a"\nfile = "missing.obj"\n' }, /missing\.obj does not exist/],
    ]) {
        await drop(view.page, files);
        const notice = view.page.locator(".notice.error").last();
        await view.page.waitForFunction(({ source }) => new RegExp(source).test(document.querySelector(".notice.error:last-child")?.textContent), { source: words.source });
        assert.match(await notice.textContent(), words);
        await view.page.locator(".notice .icon-button").evaluateAll((buttons) => buttons.forEach((button) => button.click()));
    }
    assert.equal((await view.page.evaluate(() => window.translucidView.hello.name)), "small.toml");
    await view.agrees("the scene before");
});

test("nothing was thrown, nothing refused, and nothing sent", () => {
    assert.deepEqual(view.complaints, []);
    assert.deepEqual(asked.filter((request) => !request.startsWith("GET /") || request.includes("?")), []);
});

test("a defect is told, and the page begins anew", async () => {
    const worker = view.page.workers()[0];
    await worker.evaluate(() => self.onmessage({ data: { type: "nonsense" } }));
    await view.page.locator(".notice.error", { hasText: "The renderer has stopped" }).waitFor();
    await view.page.waitForFunction(() => window.translucidView.hello.name === "still life" && window.translucidView.connected);
});

test("a module that does not load is named", async () => {
    const other = await open();
    await other.page.route("**/translucid.wasm", (route) => route.fulfill({ status: 200, contentType: "application/wasm", body: "no module" }));
    await other.page.goto(address);
    await other.page.locator(".notice.error", { hasText: "translucid.wasm cannot be loaded" }).waitFor();
    await other.page.close();
});
