// The picture: the same as the command's, progressive, and at rest when it is finished.

import assert from "node:assert/strict";
import { test } from "node:test";

import { decode } from "./png.mjs";
import { difference, start } from "./view.mjs";

const { open } = await start();
const view = await open();

test("the page shows what the command renders, to the last bit", async () => {
    await view.agrees("the scene as it is");
});

test("frames rise in number, end with the last one, and then no more come", async () => {
    await view.type("material-specular_roughness", 0.5);
    await view.done();
    const painted = await view.page.evaluate(() => window.translucidView.painted);
    for (let i = 1; i < painted.length; i++) assert.ok(painted[i].number > painted[i - 1].number);
    assert.equal(painted.at(-1).samples, 3);
    await view.page.waitForTimeout(700);
    const later = await view.page.evaluate(() => window.translucidView.lastFrame);
    assert.equal(later.number, painted.at(-1).number);
});

test("saved pictures are the one on the screen", async () => {
    await view.done();
    const shown = await view.pixels();
    const png = decode(await view.save("png"));
    assert.equal(difference(shown.codes, png.codes), 0);
    assert.equal((await view.save("exr")).readUInt32LE(0), 20000630, "the magic number of OpenEXR");
});

test("the canvas has the film's size and fits the window when that changes", async () => {
    for (const size of [{ width: 1000, height: 700 }, { width: 1900, height: 900 }, { width: 1440, height: 900 }]) {
        await view.page.setViewportSize(size);
        await view.page.waitForTimeout(100);
        const [stage, viewport] = await Promise.all(["#stage", "#viewport"].map((id) => view.page.locator(id).boundingBox()));
        assert.ok(stage.x >= viewport.x && stage.x + stage.width <= viewport.x + viewport.width);
        assert.ok(stage.y >= viewport.y && stage.y + stage.height <= viewport.y + viewport.height);
        assert.ok(Math.abs(stage.width / stage.height - 96 / 54) < 0.02);
        assert.ok(stage.width > 0.9 * viewport.width || stage.height > 0.9 * viewport.height - 30);
    }
    const { width, height } = await view.pixels();
    assert.deepEqual([width, height], [96, 54]);
});

test("one to one shows a pixel of the film on a pixel of the screen", async () => {
    await view.page.locator("#viewport").focus();
    await view.page.keyboard.press("1");
    assert.equal((await view.page.locator("#stage").boundingBox()).width, 96);
    await view.page.keyboard.press("0");
    assert.ok((await view.page.locator("#stage").boundingBox()).width > 500);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
