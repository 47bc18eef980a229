// Undo, redo, reset; saving and loading again.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";

import { difference, serve, start, View } from "./view.mjs";

const { open, folder } = await start();
const view = await open();
await view.done();
const roughness = async () => (await view.state()).sides.a.materials[0].parameters.specular_roughness.value;

test("undo and redo go through all steps, by buttons and keys", async () => {
    const first = await view.pixels();
    const start = await roughness();
    assert.equal(await view.page.locator("#undo").isDisabled(), true);
    for (const value of [0.2, 0.4, 0.6]) await view.type("material-specular_roughness", value);
    await view.done();
    const last = await view.pixels();
    await view.page.keyboard.press("Control+z");
    await view.page.waitForFunction(() => window.translucidView.state.redo);
    assert.ok(Math.abs((await roughness()) - 0.4) < 1e-6);
    await view.history("undo");
    await view.history("undo");
    await view.done();
    assert.equal(await roughness(), start);
    assert.equal(difference((await view.pixels()).codes, first.codes), 0, "the first picture is back");
    assert.equal(await view.page.locator("#undo").isDisabled(), true);
    await view.history("redo");
    await view.history("redo");
    await view.page.keyboard.press("Control+Shift+z");
    await view.page.waitForFunction(() => !window.translucidView.state.redo);
    await view.done();
    assert.equal(difference((await view.pixels()).codes, last.codes), 0, "the last picture is back");
    assert.equal(await view.page.locator("#redo").isDisabled(), true);
});

test("reset is a step, too", async () => {
    const before = await roughness();
    await view.type("light-0-strength", 50);
    await view.done();
    await view.history("reset");
    await view.done();
    assert.notEqual(await roughness(), before);
    await view.history("undo");
    assert.equal(await roughness(), before);
    assert.equal(Math.max(...(await view.state()).sides.a.lights[0].radiance), 50);
    await view.agrees("after undoing a reset");
});

test("a drag of the camera is a step, and reset brings the camera back", async () => {
    await view.history("reset");
    const camera = async () => (await view.state()).camera;
    const first = await camera();
    const { x, y, width, height } = await view.page.locator("#stage").boundingBox();
    const [left, top] = [x + width / 2, y + height / 2];
    for (const shift of [40, -60]) {
        await view.page.mouse.move(left, top);
        await view.page.mouse.down();
        await view.page.mouse.move(left + shift, top + 20, { steps: 10 });
        await view.page.mouse.up();
    }
    await view.done();
    const last = await camera();
    await view.history("undo");
    assert.notDeepEqual(await camera(), first);
    await view.history("undo");
    assert.deepEqual(await camera(), first);
    await view.agrees("undone");
    await view.history("redo");
    await view.history("redo");
    assert.deepEqual(await camera(), last);
    await view.history("reset");
    assert.deepEqual(await camera(), first);
    await view.history("undo");
    assert.deepEqual(await camera(), last);
    await view.history("undo");
    await view.history("undo");
    await view.history("undo");
});

test("a new edit after undo leaves nothing to redo", async () => {
    await view.history("undo");
    await view.type("material-coat_weight", 0.5);
    await view.done();
    assert.equal((await view.state()).redo, false);
});

test("a scene that was saved is loaded to the same picture and the same settings", async () => {
    await view.type("material-mfp-red", 0.8);
    await view.type("light-0-azimuth", 60);
    await view.type("environment-strength", 0.6);
    await view.page.locator("#viewport").focus();
    for (let i = 0; i < 3; i++) await view.page.keyboard.press("ArrowRight");
    await view.page.waitForTimeout(400);
    await view.agrees("before");
    const path = join(folder, "look.toml");
    await writeFile(path, await view.save("scene"));

    const server = await serve(path);
    const again = new View(await view.page.context().newPage(), server, folder);
    try {
        await again.load();
        await again.done();
        assert.equal(difference((await view.pixels()).codes, (await again.pixels()).codes), 0);
        const [a, b] = [await view.state(), await again.state()];
        for (const key of ["materials", "lights", "environment", "integrator"]) assert.deepEqual(b.sides.a[key], a.sides.a[key], key);
        assert.deepEqual(b.camera, a.camera);
    } finally {
        await again.page.close();
        await server.stop();
    }
});

test("Ctrl-S saves the scene", async () => {
    const download = view.page.waitForEvent("download");
    await view.page.locator("#viewport").focus();
    await view.page.keyboard.press("Control+s");
    assert.match((await download).suggestedFilename(), /\.toml$/);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
