// The hand on the picture: orbit, pan, dolly, look there, frame, select; by mouse, touch and keys.

import assert from "node:assert/strict";
import { test } from "node:test";

import { serve, start } from "./view.mjs";

const { open } = await start();
const view = await open({ hasTouch: true });
await view.done();
const { page } = view;

const camera = async () => (await view.state()).camera;
const distance = ({ position, target }) => Math.hypot(...position.map((x, i) => x - target[i]));
const near = (actual, wanted, error = 1e-4) =>
    [actual].flat().forEach((number, i) => assert.ok(Math.abs(number - [wanted].flat()[i]) <= error * (1 + Math.abs(number)), `${actual} is not ${wanted}`));

/** A place in the picture, as shares of its size. */
async function place(x, y) {
    const box = await page.locator("#stage").boundingBox();
    return [box.x + x * box.width, box.y + y * box.height];
}

async function drag(from, to, { button = "left", modifier } = {}) {
    if (modifier) await page.keyboard.down(modifier);
    await page.mouse.move(...(await place(...from)));
    await page.mouse.down({ button });
    await page.mouse.move(...(await place(...to)), { steps: 8 });
    await page.mouse.up({ button });
    if (modifier) await page.keyboard.up(modifier);
    await view.done();
}

test("a drag orbits: the distance and the target stay", async () => {
    const before = await camera();
    await drag([0.5, 0.5], [0.7, 0.6]);
    const after = await camera();
    near(after.target, before.target);
    near(distance(after), distance(before));
    assert.ok(after.position[0] < before.position[0], "what is dragged to the right is seen from the left");
    assert.ok(after.position[1] > before.position[1], "what is dragged down is seen from above");
    await view.agrees("orbit");
});

test("a drag over the pole stops there", async () => {
    await drag([0.5, 0.05], [0.5, 0.95]);
    await drag([0.5, 0.05], [0.5, 0.95]);
    const { position, target } = await camera();
    assert.ok(position[1] - target[1] > 0.999 * distance(await camera()));
    await view.agrees("from above");
    await view.reset();
});

for (const [name, how] of [["middle", { button: "middle" }], ["shift", { modifier: "Shift" }]]) {
    test(`a drag with ${name} pans: what is under the pointer stays there`, async () => {
        await view.reset();
        const before = await camera();
        await drag([0.4, 0.5], [0.6, 0.5], how);
        const after = await camera();
        near(distance(after), distance(before));
        near(after.position.map((x, i) => x - before.position[i]), after.target.map((x, i) => x - before.target[i]), 1e-3);
        // A fifth of what the camera sees at the target
        const width = 2 * distance(before) * Math.tan((before.fov * Math.PI) / 360);
        near(Math.hypot(...after.target.map((x, i) => x - before.target[i])), 0.2 * width, 0.02);
        await view.agrees("pan");
    });
}

test("the wheel goes closer and farther", async () => {
    await view.reset();
    const before = distance(await camera());
    await page.mouse.move(...(await place(0.5, 0.5)));
    for (let i = 0; i < 3; i++) await page.mouse.wheel(0, -100);
    await page.waitForTimeout(500);
    await view.done();
    near(distance(await camera()), before * Math.exp(-0.45), 1e-3);
    await view.agrees("closer");
});

test("keys orbit, pan and dolly", async () => {
    await view.reset();
    await page.locator("#viewport").focus();
    const press = async (key) => {
        const before = await camera();
        await page.keyboard.press(key);
        await page.waitForTimeout(400);
        await view.done();
        return [before, await camera()];
    };
    let [before, after] = await press("ArrowRight");
    near(distance(after), distance(before));
    assert.notDeepEqual(after.position, before.position);
    [before, after] = await press("Shift+ArrowUp");
    assert.ok(after.target[1] > before.target[1]);
    [before, after] = await press("+");
    near(distance(after), distance(before) / 1.1);
    [before, after] = await press("-");
    near(distance(after), distance(before) * 1.1);
    await view.agrees("keys");
});

test("a double click looks there", async () => {
    await view.reset();
    const before = await camera();
    await page.mouse.dblclick(...(await place(0.35, 0.5)));
    await page.waitForTimeout(600);
    await view.done();
    const after = await camera();
    near(after.position, before.position);
    near(after.focus_distance, distance(after));
    // The ball: 2 around (-2.2, 2, 0)
    near(Math.hypot(after.target[0] + 2.2, after.target[1] - 2, after.target[2]), 2, 0.02);
    await view.agrees("looks there");
});

test("F frames all, from the same direction", async () => {
    await view.reset();
    await page.mouse.move(...(await place(0.5, 0.5)));
    for (let i = 0; i < 5; i++) await page.mouse.wheel(0, -200);
    await page.waitForTimeout(500);
    const before = await camera();
    await page.keyboard.press("f");
    await page.waitForFunction((far) => {
        const { position, target } = window.translucidView.state.camera;
        return Math.hypot(...position.map((x, i) => x - target[i])) > 1.5 * far;
    }, distance(before));
    const after = await camera();
    const direction = ({ position, target }) => position.map((x, i) => (x - target[i]) / distance({ position, target }));
    near(direction(after), direction(before), 1e-3);
    await view.agrees("framed");
});

test("the scene's own camera comes back by the menu", async () => {
    const own = (await page.evaluate(() => window.translucidView.state.cameras))[0].camera;
    await view.choose("camera", 0);
    await view.done();
    near((await camera()).position, own.position);
});

test("a click selects the material of a thing, and does not move the camera", async () => {
    await view.reset();
    const before = await camera();
    await view.click("tab-lights");
    for (const [at, name] of [[[0.35, 0.5], "skin"], [[0.5, 0.95], "floor"]]) {
        await page.mouse.click(...(await place(...at)));
        await page.waitForFunction((name) => document.getElementById("material").selectedOptions[0].text === name, name);
    }
    assert.equal(await page.locator("#material-panel").isVisible(), true);
    assert.deepEqual(await camera(), before);
});

test("Enter selects what is in the middle", async () => {
    await view.choose("material", 1);
    await drag([0.35, 0.5], [0.5, 0.5], { modifier: "Shift" });
    await page.locator("#viewport").focus();
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.getElementById("material").selectedOptions[0].text === "skin");
});

test("one finger orbits, two pan and pinch", async () => {
    await view.reset();
    const touch = await page.context().newCDPSession(page);
    const send = (type, points) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    const before = await camera();
    await send("touchStart", [await place(0.5, 0.5)]);
    for (let i = 1; i <= 5; i++) await send("touchMove", [await place(0.5 + 0.04 * i, 0.5)]);
    await send("touchEnd", []);
    await view.done();
    const orbited = await camera();
    near(distance(orbited), distance(before));
    assert.notDeepEqual(orbited.position, before.position);

    await send("touchStart", [await place(0.45, 0.5), await place(0.55, 0.5)]);
    for (let i = 1; i <= 5; i++) await send("touchMove", [await place(0.45 - 0.02 * i, 0.5), await place(0.55 + 0.02 * i, 0.5)]);
    await send("touchEnd", []);
    await view.done();
    near(distance(await camera()), distance(orbited) / 3, 0.05);
    await view.agrees("pinched");
});

test("while the camera moves messages never outrun the pictures", async () => {
    await view.reset();
    const [x, y] = await place(0.5, 0.5);
    await page.mouse.move(x, y);
    await page.mouse.down();
    const begin = await page.evaluate(() => performance.now());
    for (let i = 0; i < 60; i++) await page.mouse.move(x + 3 * i, y);
    await page.mouse.up();
    await view.done();
    const times = await page.evaluate((begin) => window.translucidView.sent.filter(({ type, time }) => type === "camera" && time >= begin).map(({ time }) => time), begin);
    assert.ok(times.length >= 2);
    // The last one goes at once, when the button is let go.
    for (let i = 1; i < times.length - 1; i++) assert.ok(times[i] - times[i - 1] > 3, `${times[i] - times[i - 1]} ms`);
    await view.agrees("after the drag");
});

test("what moves all the time is seen, though a look takes longer than it is from one move to the next", async () => {
    const server = await serve("--size", "640x360");
    const large = await page.context().newPage();
    await large.goto(server.address);
    await large.waitForFunction(() => window.translucidView?.samples >= 1);
    const { x, y, width, height } = await large.locator("#stage").boundingBox();
    await large.mouse.move(x + 0.5 * width, y + 0.5 * height);
    await large.mouse.down();
    const first = await large.evaluate(() => window.translucidView.version);
    const versions = () => large.evaluate((first) => new Set(window.translucidView.painted.map(({ version }) => version).filter((version) => version > first)).size, first);
    let [step, seen] = [0, 0];
    while (seen < 5 && step < 300) {
        await large.mouse.move(x + (0.5 + 0.1 * Math.sin(step / 20)) * width, y + 0.5 * height);
        seen = await versions();
        step += 1;
    }
    await large.mouse.up();
    await large.close();
    await server.stop();
    assert.ok(seen >= 5, `${seen} pictures of ${step} moves`);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
