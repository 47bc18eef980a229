// Two settings beside each other.

import assert from "node:assert/strict";
import { test } from "node:test";

import { difference, start } from "./view.mjs";

const { open } = await start();
const view = await open();
await view.done();
const { page } = view;

const sideIs = (side) => page.waitForFunction((side) => window.translucidView.state.active === side, side);
const roughness = (state, side) => state.sides[side].materials[0].parameters.specular_roughness.value;

test("a comparison begins with two that are the same", async () => {
    const alone = await view.pixels();
    await view.click("compare");
    await page.waitForFunction(() => window.translucidView.state.compare);
    await view.done();
    assert.equal(difference((await view.pixels("a")).codes, alone.codes), 0);
    assert.equal(difference((await view.pixels("b")).codes, alone.codes), 0);
});

test("edits concern the side that was chosen, and both pictures are the command's", async () => {
    await view.check("side-b");
    await sideIs("b");
    const { sides } = await view.state();
    await view.type("material-specular_roughness", 0.9);
    await view.type("material-subsurface_color-red", 0.05);
    await view.choose("material-subsurface_model", "dipole");
    await view.agrees("B");
    const state = await view.state();
    assert.equal(roughness(state, "a"), roughness({ sides }, "a"));
    assert.ok(Math.abs(roughness(state, "b") - 0.9) < 1e-6);
    assert.ok(difference((await view.pixels("a")).codes, (await view.pixels("b")).codes) > 0);
    assert.match(await page.locator("#label-b").textContent(), /dipole/);
    await view.check("side-a");
    await sideIs("a");
    await view.agrees("A");
});

test("the line is dragged across the picture, and moved by keys", async () => {
    const clip = () => page.locator("#picture-b").evaluate((canvas) => getComputedStyle(canvas).clipPath);
    const stage = await page.locator("#stage").boundingBox();
    const box = await page.locator("#wipe").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 3);
    await page.mouse.down();
    await page.mouse.move(stage.x + stage.width * 0.25, box.y + box.height / 3, { steps: 4 });
    await page.mouse.up();
    assert.match(await clip(), /^inset\(0(px|%)? 0(px|%)? 0(px|%)? 2[45](\.\d+)?%\)$/);
    assert.equal(await page.locator("#wipe").getAttribute("aria-valuenow"), "25");
    await page.locator("#wipe").focus();
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.locator("#wipe").getAttribute("aria-valuenow"), "27");
    await page.keyboard.press("End");
    assert.equal(await page.locator("#wipe").getAttribute("aria-valuenow"), "100");
    await page.keyboard.press("Home");
    await page.locator("#wipe").dblclick();
    assert.equal(await page.locator("#wipe").getAttribute("aria-valuenow"), "50");
});

test("the two halves on the screen are those of A and B", async () => {
    await view.done();
    const stage = await page.locator("#stage").boundingBox();
    const shot = await page.screenshot({ clip: { x: stage.x, y: stage.y, width: stage.width, height: stage.height } });
    const { decode } = await import("./png.mjs");
    const screen = decode(shot);
    const [a, b] = [await view.pixels("a"), await view.pixels("b")];
    // Means of a piece of each half: pixels of the film are stretched over those of the screen.
    const mean = (picture, left) => {
        let sum = 0;
        let count = 0;
        for (let y = 0.3; y < 0.7; y += 0.0025) {
            for (let x = left; x < left + 0.2; x += 0.0025) {
                const at = 4 * (Math.floor(y * picture.height) * picture.width + Math.floor(x * picture.width));
                sum += picture.codes[at];
                count++;
            }
        }
        return sum / count;
    };
    for (const [left, own, other] of [[0.2, a, b], [0.7, b, a]]) {
        assert.ok(Math.abs(mean(screen, left) - mean(own, left)) < 2);
        assert.ok(left > 0.5 || Math.abs(mean(own, left) - mean(other, left)) > 0.5, "the halves can be told apart");
    }
});

test("difference and FLIP are maps with numbers", async () => {
    // All that the page says beside its buttons
    await page.evaluate(() => {
        window.said = [];
        const element = document.querySelector("#difference");
        new MutationObserver(() => window.said.push(element.textContent)).observe(element, { childList: true, characterData: true, subtree: true });
    });
    for (const name of ["difference", "flip"]) {
        await view.click(`show-${name}`);
        await page.waitForFunction((name) => window.translucidView.state.view === name, name);
        await view.done();
        assert.equal(await page.locator("#picture-map").isVisible(), true);
        const { codes } = await view.pixels("map");
        assert.ok(new Set(codes.toString("latin1")).size > 3, "not of one color");
    }
    // The mean comes with its map, which takes longer than the picture
    const numbers = () => /^relMSE [\d.e-]+, noise [\d.e-]+, mean .LIP [\d.e-]+$/.test(document.querySelector("#difference").textContent);
    await page.waitForFunction(numbers);
    assert.ok((await page.evaluate(() => window.said)).includes("Computing \ua7fbLIP \u2026"), "the map is on its way");
    await view.click("show-flip");
    await page.waitForFunction(() => window.translucidView.state.view === "radiance");
});

test("swap makes A of B and B of A", async () => {
    await view.done();
    const [a, b] = [await view.pixels("a"), await view.pixels("b")];
    await view.click("swap");
    await page.waitForFunction(() => window.translucidView.state.sides.a.materials[0].subsurface_model === "dipole");
    await view.done();
    assert.equal(difference((await view.pixels("a")).codes, b.codes), 0);
    assert.equal(difference((await view.pixels("b")).codes, a.codes), 0);
});

test("edits of both sides reach both", async () => {
    await view.check("side-both");
    await sideIs("both");
    await view.type("material-specular_roughness", 0.35);
    await view.done();
    const state = await view.state();
    for (const side of ["a", "b"]) assert.ok(Math.abs(roughness(state, side) - 0.35) < 1e-6);
    await view.check("side-a");
    await sideIs("a");
});

test("the end of a comparison leaves A", async () => {
    await view.done();
    const a = await view.pixels("a");
    await view.click("compare");
    await page.waitForFunction(() => !window.translucidView.state.compare);
    await view.done();
    assert.equal(difference((await view.pixels("a")).codes, a.codes), 0);
    assert.equal(await page.locator("#picture-b").isVisible(), false);
    await view.agrees("A alone");
});

/** Compares with the random walk: the models of the two translucent materials on either side. */
async function againstRandomWalk() {
    await view.click("truth");
    await page.waitForFunction(() => {
        const { compare, active, sides } = window.translucidView.state;
        return compare && active === "both" && sides.b.materials.slice(0, 2).every(({ model }) => model === "random-walk");
    });
    await view.done();
    const { sides } = await view.state();
    assert.equal(sides.b.materials[2].subsurface_model, "default", "the floor is opaque");
    return ["a", "b"].map((side) => sides[side].materials.slice(0, 2).map(({ model }) => model));
}

test("against the random walk: A, which is one by default, becomes normalized diffusion", async () => {
    await view.reset();
    const { sides: { a } } = await view.state();
    assert.deepEqual(a.materials.slice(0, 2).map(({ model }) => model), ["random-walk", "random-walk"]);
    const both = await againstRandomWalk();
    assert.deepEqual(both, [["normalized-diffusion", "normalized-diffusion"], ["random-walk", "random-walk"]]);
    assert.ok(difference((await view.pixels("a")).codes, (await view.pixels("b")).codes) > 1000);
    assert.match(await page.locator("#label-a").textContent(), /normalized-diffusion/);
    for (const side of ["a", "b"]) {
        await view.check(`side-${side}`);
        await sideIs(side);
        await view.agrees(side);
    }
});

test("against the random walk: a model that was chosen stays", async () => {
    await view.reset();
    await view.choose("material-subsurface_model", "dipole");
    await view.done();
    const both = await againstRandomWalk();
    assert.deepEqual(both, [["dipole", "normalized-diffusion"], ["random-walk", "random-walk"]]);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
