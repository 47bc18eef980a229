// Rendering, film, camera's numbers, layers.

import assert from "node:assert/strict";
import { test } from "node:test";

import { decode } from "./png.mjs";
import { SCENE, difference, serve, start } from "./view.mjs";

const { open } = await start();
const view = await open();
await view.done();
let before = await view.pixels();

async function changes(what, act) {
    await act();
    await view.agrees(what);
    const after = await view.pixels();
    const isOther = before.codes.length !== after.codes.length || difference(before.codes, after.codes) > 0;
    assert.ok(isOther, `${what}: the picture is another one`);
    before = after;
}

const integrator = async () => (await view.state()).sides.a.integrator;

test("exposure: slider and field", async () => {
    await changes("field", () => view.type("exposure", 1.5));
    assert.equal((await view.state()).film.exposure, 1.5);
    await changes("slider", () => view.page.locator("#exposure-slider").fill("520"));
    await changes("back", () => view.type("exposure", 0));
});

test("tone mapping", async () => {
    for (const tone of ["srgb", "agx"]) await changes(tone, () => view.choose("tone", tone));
    assert.equal((await view.state()).film.tone_mapping, "agx");
});

test("samples, more and fewer", async () => {
    await changes("more", () => view.type("integrator-samples_per_pixel", 5));
    assert.equal((await view.page.evaluate(() => window.translucidView.lastFrame)).samples, 5);
    await changes("fewer", () => view.type("integrator-samples_per_pixel", 2));
});

test("method, sharing, depths, caustics, seed", async () => {
    // The number of points goes with the square of the size over the mean free path: with the scene's there are 100,000
    for (const [material, path] of [[0, 3], [1, 2]]) {
        await view.choose("material", material);
        await changes("longer path", () => view.type("material-subsurface_radius", path));
    }
    await changes("point-based", () => view.choose("integrator-subsurface_method", "point-based"));
    await changes("ray-traced", () => view.choose("integrator-subsurface_method", "ray-traced"));
    await changes("sharing", () => view.check("integrator-subsurface_sharing", false));
    assert.equal((await integrator()).subsurface_sharing, false);
    await changes("depth", () => view.type("integrator-max_depth", 2));
    await changes("diffuse depth", () => view.type("integrator-max_diffuse_depth", 1));
    await view.check("integrator-caustics");
    await view.agrees("caustics");
    assert.equal((await integrator()).caustics, true);
    await changes("seed", () => view.type("integrator-seed", 7));
    assert.equal((await integrator()).seed, 7);
});

test("size of the film", async () => {
    await view.reset();
    before = await view.pixels();
    await changes("width", () => view.type("film-size-width", 64));
    assert.equal((await view.pixels()).width, 64);
    await changes("height", () => view.type("film-size-height", 64));
    await changes("menu", () => view.choose("film-presets", "480x270"));
    assert.deepEqual([before.width, before.height], [480, 270]);
    await view.reset();
    before = await view.pixels();
});

test("camera: field of view, lens, focus, distance, places", async () => {
    await changes("fov", () => view.type("camera-fov", 50));
    await changes("lens", () => view.type("camera-lens_radius", 0.4));
    await changes("focus", () => view.type("camera-focus_distance", 9));
    await changes("distance", () => view.type("camera-distance", 20));
    await changes("position", () => view.type("camera-position-y", 8));
    await changes("target", () => view.type("camera-target-x", 1));
    const { camera } = await view.state();
    assert.ok(Math.abs(camera.fov - 50) < 1e-4 && Math.abs(camera.position[1] - 8) < 1e-4 && camera.target[0] === 1);
});

test("every layer is another picture, and the saved one is that on the screen", async () => {
    await view.reset();
    const seen = new Set();
    const layers = await view.page.locator("#view option").evaluateAll((options) => options.map(({ value }) => value));
    assert.ok(["radiance", "diffuse", "specular", "subsurface", "albedo", "normal", "depth"].every((name) => layers.includes(name)));
    assert.ok(!layers.includes("difference"), "there is nothing to compare");
    for (const layer of layers) {
        await view.choose("view", layer);
        await view.page.waitForFunction((layer) => window.translucidView.state.view === layer, layer);
        await view.done();
        const { codes } = await view.pixels();
        if (layer !== "emission") assert.ok(!seen.has(codes.toString("base64")), layer);
        seen.add(codes.toString("base64"));
    }
    await view.choose("view", "radiance");
    await view.agrees("radiance again");
});

test("pause stops, and going on finishes the same picture", async () => {
    await view.type("integrator-samples_per_pixel", 400);
    await view.click("pause");
    await view.page.waitForFunction(() => window.translucidView.state.paused);
    await view.page.waitForTimeout(300);
    const { number } = await view.page.evaluate(() => window.translucidView.lastFrame);
    await view.page.waitForTimeout(500);
    assert.equal((await view.page.evaluate(() => window.translucidView.lastFrame)).number, number);
    await view.click("pause");
    await view.type("integrator-samples_per_pixel", 4);
    await view.agrees("gone on");
});

test("noise is taken out of what is shown alone, not in comparisons, and not where that is switched off", async () => {
    // So large that a picture stays far below the samples that need no smoothing
    await view.choose("film-presets", "960x540");
    await view.type("integrator-samples_per_pixel", 4096);
    await view.page.waitForFunction(() => window.translucidView.lastFrame.samples >= 1 && window.translucidView.lastFrame.edge === 1);
    await view.page.waitForFunction(() => /^shown (denoised|smoothed)$/.test(document.getElementById("detail").textContent));
    await view.click("pause");
    /** Pixels that differ between the left picture at rest on the screen and in the file. */
    const differing = async (act) => {
        await view.answered(act);
        await view.page.waitForFunction(() => {
            const { painted, state } = window.translucidView;
            return painted.findLast(({ side }) => side === "a")?.version >= state.version;
        });
        const { samples } = await view.page.evaluate(() => window.translucidView.painted.findLast(({ side }) => side === "a"));
        assert.ok(samples < 32, `${samples} samples`);
        return difference((await view.pixels()).codes, decode(await view.save("png")).codes);
    };
    assert.equal(await differing(() => view.check("denoise", false)), 0, "switched off");
    assert.ok((await differing(() => view.check("denoise"))) > 10_000, "switched on");
    assert.equal(await differing(() => view.click("compare")), 0, "a comparison");
    await view.click("compare");
    await view.click("pause");
    await view.reset();
});

test("the panel says which denoiser there is", async () => {
    await view.click("tab-render");
    const text = () => view.page.locator("#denoiser").textContent();
    assert.match(await text(), /^(Open Image Denoise [\d.]+ \(.+\)|none: pip install pyoidn)$/);
    process.env.TRANSLUCID_OIDN = "nowhere/libOpenImageDenoise.so";
    const server = await serve(SCENE);
    delete process.env.TRANSLUCID_OIDN;
    await view.page.goto(server.address);
    await view.page.click("#tab-render");
    await view.page.locator("#denoiser").waitFor();
    assert.match(await text(), /^none: nowhere.libOpenImageDenoise.so: there is no such library/);
    await view.load();
    await server.stop();
});

test("the command is the one that makes the picture", async () => {
    await view.click("tab-render");
    assert.match(await view.page.locator("#command").textContent(), /^translucid render /);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
