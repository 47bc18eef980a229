// Profile, numbers, inspector, scale bar, status.

import assert from "node:assert/strict";
import { test } from "node:test";

import { start } from "./view.mjs";

const { open } = await start();
const view = await open({ permissions: ["clipboard-read", "clipboard-write"] });
await view.done();
const { page } = view;
const text = (id) => page.locator(`#${id}`).textContent();

async function shown(name, on = true) {
    if ((await page.locator(`#${name}-panel`).isVisible()) !== on) await view.click(`toggle-${name}`);
}

/** Colored pixels on the plot's canvas. */
const ink = () => page.locator("#profile-plot canvas").evaluate((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) count += Math.abs(data[i] - data[i + 2]) > 60 && data[i + 3] > 100;
    return count;
});

test("a default model says which it is, and a walk that its profile is exact", async () => {
    await shown("profile");
    const described = async (start) => page.waitForFunction(
        (start) => document.querySelector("#material-rows .description").textContent.startsWith(start), start);
    await described("random-walk. ");
    await page.locator("#profile-errors li").nth(2).waitFor();
    assert.match(await text("profile-truth"), /a random walk returns the exact profile/);
    assert.ok((await ink()) > 200);
    await view.check("material-subsurface_normalization-energy");
    await described("normalized-diffusion-oblique. ");
    assert.equal(await page.locator("#material-subsurface_model").inputValue(), "default");
    await view.reset();
});

test("the profile is drawn with its error for each channel", async () => {
    await view.choose("material-subsurface_model", "normalized-diffusion-oblique");
    await page.locator("#profile-errors li", { hasText: "%" }).nth(2).waitFor();
    assert.match(await text("profile-errors"), /Red.*%Green.*%Blue.*%/);
    assert.match(await text("profile-model"), /normalized-diffusion/);
    assert.ok((await ink()) > 200);
});

test("quantities and axes", async () => {
    for (const id of ["profile-ring", "profile-error", "profile-linear", "profile-profile", "profile-logarithmic"]) {
        await view.check(id);
        await page.waitForTimeout(100);
        assert.ok((await ink()) > 50, id);
    }
});

test("another model is another curve with another error", async () => {
    const before = await text("profile-errors");
    await view.choose("material-subsurface_model", "dipole");
    await page.waitForFunction((before) => document.getElementById("profile-errors").textContent !== before, before);
    assert.match(await text("profile-model"), /dipole/);
    const errors = await page.locator("#profile-errors strong").allTextContents();
    assert.ok(errors.every((error) => parseFloat(error) > 5), `${errors}`);
});

test("the pointer reads the curves", async () => {
    const box = await page.locator("#profile-plot").boundingBox();
    await page.mouse.move(box.x + box.width * 0.5, box.y + box.height * 0.4);
    await page.waitForFunction(() => document.getElementById("profile-cursor").textContent.includes("mm"));
});

test("an opaque material has no profile, and says so", async () => {
    await view.choose("material", 2);
    await page.locator("#profile-plot.empty").waitFor();
    assert.match(await text("profile-plot"), /subsurface_weight is 0/);
    await view.choose("material", 0);
    await page.locator("#profile-plot canvas").waitFor();
});

test("numbers of every system, those of one, and a copy", async () => {
    await view.reset();
    await shown("numbers");
    await page.locator(".system").nth(5).waitFor();
    const systems = await page.locator("#numbers-system option").allTextContents();
    assert.ok(systems.some((name) => name.includes("cycles")) && systems.some((name) => name.includes("renderman")));
    await view.choose("numbers-system", systems.find((name) => name.startsWith("translucid")));
    assert.equal(await page.locator(".system").count(), 1);
    await view.click("copy-numbers-0");
    assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^surface_albedo = [\d.]+, [\d.]+, [\d.]+\n/);
    await view.click("copy-numbers-command");
    assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^translucid convert /);
    await view.choose("numbers-system", "");
});

test("numbers are those of another color space, and of thin walls", async () => {
    await view.choose("numbers-space", "ACEScg");
    await page.locator("#numbers-tables", { hasText: "misplaced if lengths were kept" }).waitFor();
    await page.locator("#numbers-thin").fill("0.5");
    await page.locator("#numbers-thin").press("Enter");
    await page.locator("#numbers-tables", { hasText: "geometry_thin_walled" }).waitFor();
    assert.match(await text("numbers-command"), /--color-space acescg --thin 0.5 --eta [\d.]+$/);
    await page.locator("#numbers-thin").fill("-1");
    await page.locator("#numbers-thin").press("Enter");
    await page.locator("#numbers-notes", { hasText: "thickness is -1, but must be finite and above 0" }).waitFor();
    await page.locator("#numbers-thin").fill("5 inch");
    await page.locator("#numbers-thin").press("Enter");
    await page.locator("#numbers-thin-error", { hasText: "\u00b5m, mm, cm or m" }).waitFor();
    await page.locator("#numbers-thin").fill("");
    await page.locator("#numbers-thin").press("Enter");
    await view.choose("numbers-space", "Rec. 709");
    await page.locator("#numbers-tables", { hasText: "renderman" }).waitFor();
});

test("numbers follow the material", async () => {
    const before = await text("numbers-tables");
    await view.type("material-mfp-red", 1.5);
    await page.waitForFunction((before) => document.getElementById("numbers-tables").textContent !== before, before);
    assert.match(await text("numbers-tables"), /1\.5/);
});

test("panels are closed, and stay closed after a reload", async () => {
    await shown("numbers", false);
    await shown("profile", false);
    await view.load();
    assert.equal(await page.locator("#dock").isVisible(), false);
    await shown("profile");
});

test("the inspector tells linear values, place, object and material", async () => {
    await view.done();
    const stage = await page.locator("#stage").boundingBox();
    await page.mouse.move(stage.x + stage.width * 0.35, stage.y + stage.height * 0.5);
    await page.waitForFunction(() => document.getElementById("inspect-object").textContent.includes("ball"));
    assert.match(await text("inspect-object"), /ball.*skin/);
    const [x, y, z] = (await text("inspect-position")).match(/-?[\d.]+/g).map(Number);
    // The ball: 20 mm around (-22, 20, 0)
    assert.ok(Math.abs(Math.hypot(x + 22, y - 20, z) - 20) < 0.3);
    const values = (await page.locator("#inspect-values span").allTextContents()).map(Number);
    assert.equal(values.length, 3);
    const [column, row] = (await text("inspect-pixel")).split(",").map(Number);
    const { codes, width } = await view.pixels();
    const hex = [...codes.subarray(4 * (row * width + column)).subarray(0, 3)].map((code) => code.toString(16).padStart(2, "0")).join("");
    assert.equal(await text("inspect-code"), `#${hex}`);
});

test("values under the pointer are asked for eight times a second at most", async () => {
    const asked = [];
    page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => String(payload).includes('"pick"') && asked.push(performance.now())));
    await view.load();
    await view.done();
    const stage = await page.locator("#stage").boundingBox();
    for (let i = 0; i < 60; i++) {
        await page.mouse.move(stage.x + stage.width * (0.2 + 0.01 * i), stage.y + stage.height * 0.5);
        await page.waitForTimeout(10);
    }
    assert.ok(asked.length >= 2);
    // All together: of each alone a busy machine tells late
    const seconds = (asked.at(-1) - asked[0]) / 1000;
    assert.ok(asked.length - 2 <= 8 * seconds, `${asked.length} in ${seconds} s`);
});

test("the scale bar is as long as it says", async () => {
    await view.reset();
    const millimeters = parseFloat(await text("bar-text"));
    const [bar, stage] = await Promise.all(["#bar", "#stage"].map((id) => page.locator(id).boundingBox()));
    const { camera } = await view.state();
    const far = Math.hypot(...camera.position.map((x, i) => x - camera.target[i]));
    const seen = 10 * 2 * far * Math.tan((camera.fov * Math.PI) / 360);
    assert.ok(Math.abs(millimeters / seen - bar.width / stage.width) < 0.01);
});

test("status: phase, samples, noise", async () => {
    await view.done();
    await page.waitForFunction(() => document.getElementById("phase").textContent === "Done");
    assert.match(await text("samples"), /^3 of 3 samples$/);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
