// The page as files on a graphics processor: Chromium's own in software, which does all that WebGPU asks for, but takes minutes
// to make the kernels and to trace; so all but the first test wait for TRANSLUCID_WEBGPU=1.

import assert from "node:assert/strict";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";

import { drop, serveFiles } from "./files.mjs";
import { launch, SCENE, View } from "./view.mjs";

const isSlow = process.env.TRANSLUCID_WEBGPU === "1" ? {} : { skip: "takes minutes: TRANSLUCID_WEBGPU=1 runs it" };
/** Longest wait: the kernels are made on the way. */
const PATIENCE = 600_000;

const server = await serveFiles();
const browser = await launch({ gpu: true });
const folder = await mkdtemp(join(tmpdir(), "translucid-webgpu-"));
after(async () => {
    await browser.close();
    server.close();
    await rm(folder, { recursive: true });
});

const view = new View(await (await browser.newContext()).newPage(), server, folder);
view.page.setDefaultTimeout(PATIENCE);
await view.load();

/** Mean code of each color over the picture. */
async function means() {
    await view.done();
    const { codes } = await view.pixels();
    return [0, 1, 2].map((color) => codes.filter((_, i) => i % 4 === color).reduce((sum, code) => sum + code, 0) / (codes.length / 4));
}

const notes = async () => (await view.state()).notes.join("; ");

test("a graphics processor is offered; one in software does not begin by itself", async () => {
    const names = await view.page.evaluate(() => window.translucidView.hello.devices);
    assert.equal(names.length, 2, names.join(", "));
    assert.match(names[1], /^WebGPU/);
    assert.equal((await view.state()).device, "cpu");
});

test("it finds the light that the processor finds", isSlow, async () => {
    const scene = (await readFile(SCENE, "utf8")).replace("size = [96, 54]", "size = [32, 18]").replace("samples_per_pixel = 3", "samples_per_pixel = 32");
    await drop(view.page, { "little.toml": scene });
    await view.page.waitForFunction(() => window.translucidView.hello?.name === "little.toml");
    const byProcessor = await means();
    const [, name] = await view.page.evaluate(() => window.translucidView.hello.devices);
    await view.choose("device", name);
    // The processor goes ahead while the kernels are made; the next film is the graphics processor's
    await view.page.waitForFunction(() => window.translucidView.state.notes.some((note) => note.includes("being made")));
    await view.page.waitForFunction(() => window.translucidView.state.notes.length === 0);
    await view.type("integrator-seed", 1);
    const byGraphics = await means();
    assert.equal(await notes(), "");
    for (const color of [0, 1, 2]) {
        assert.ok(Math.abs(byGraphics[color] - byProcessor[color]) < 1, `${byGraphics} by WebGPU, ${byProcessor} by the processor`);
    }
});

test("what it lacks the processor renders, and the page says so", isSlow, async () => {
    // Light without size finds nothing below a refracting boundary
    await view.adds("beam");
    await view.choose("material-subsurface_model", "random-walk");
    await view.type("material-subsurface_eta", 1.4);
    await view.done();
    assert.match(await notes(), /the processor traces: /);
    await view.reset();
});

test("the camera moves, and nothing was thrown", isSlow, async () => {
    await view.page.locator("#viewport").focus();
    await view.page.keyboard.press("ArrowLeft");
    await view.done();
    assert.deepEqual(view.complaints, []);
});
