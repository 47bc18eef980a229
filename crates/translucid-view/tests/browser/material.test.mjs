// Every control of the material's panel changes the picture as the scene's key does.

import assert from "node:assert/strict";
import { test } from "node:test";

import { difference, start } from "./view.mjs";

const { open } = await start();
const view = await open();
await view.done();
let before = await view.pixels();

/** The ball's material. */
const material = async () => (await view.state()).sides.a.materials[0];
const value = async (key) => (await material()).parameters[key].value;
const near = (actual, wanted) =>
    [actual].flat().forEach((number, i) => assert.ok(Math.abs(number - [wanted].flat()[i]) <= 2e-6 * (1 + Math.abs(number)), `${actual} is not ${wanted}`));

/** Does something, and expects another picture, which the command makes from the saved scene, too. */
async function changes(what, act) {
    await act();
    await view.agrees(what);
    const after = await view.pixels();
    assert.ok(difference(before.codes, after.codes) > 0, `${what}: the picture is another one`);
    before = after;
}

const NUMBERS = [
    ["subsurface_weight", 0.7],
    ["subsurface_scatter_anisotropy", 0.4],
    ["subsurface_eta", 1.3],
    ["subsurface_radius", 0.5],
    ["base_weight", 0.6],
    ["base_metalness", 0.2],
    ["specular_weight", 0.8],
    ["specular_roughness", 0.15],
    ["specular_ior", 1.7],
    ["coat_weight", 0.5],
    ["coat_roughness", 0.3],
    ["coat_ior", 1.8],
    ["transmission_weight", 0.3],
    ["emission_luminance", 0.25],
    ["geometry_opacity", 0.9],
];
for (const [key, number] of NUMBERS) {
    test(`${key}: its field`, () => changes(key, async () => {
        await view.type(`material-${key}`, number);
        await view.done();
        near(await value(key), number);
    }));
}

for (const key of ["base_color", "specular_color", "coat_color", "transmission_color", "emission_color"]) {
    test(`${key}: a channel and the swatch`, async () => {
        await changes(key, async () => {
            await view.type(`material-${key}-g`, 0.31);
            await view.done();
            near((await value(key))[1], 0.31);
        });
        await changes(`${key}'s swatch`, async () => {
            await view.page.locator(`#material-${key}-swatch`).fill("#ff8040");
            await view.done();
            near(await value(key), [1, 0.21586, 0.05127]);
        });
    });
}

test("transmission_depth counts with a color", () => changes("transmission_depth", async () => {
    await view.type("material-transmission_depth", 2);
    await view.done();
    near(await value("transmission_depth"), 2);
}));

test("surface albedo: fields, sliders and the swatch", async () => {
    await changes("a field", () => view.type("material-subsurface_color-red", 0.9));
    near((await value("subsurface_color"))[0], 0.9);
    await changes("a slider", () => view.page.locator("#material-subsurface_color-green-slider").fill("250"));
    near((await value("subsurface_color"))[1], 0.25);
    await changes("the swatch", () => view.page.locator("#material-subsurface_color-swatch").fill("#804020"));
    near(await value("subsurface_color"), [0.21586, 0.05127, 0.01444]);
});

test("mean free path: a channel keeps the others, the radius scales all", async () => {
    await changes("emission off", () => view.type("material-emission_luminance", 0));
    const { mfp } = await material();
    await changes("green", () => view.type("material-mfp-green", "6 mm"));
    near((await material()).mfp, mfp.with(1, 0.6));
    const [radius, old] = [await value("subsurface_radius"), (await material()).mfp];
    await changes("all", () => view.type("material-subsurface_radius", "*2"));
    near(await value("subsurface_radius"), 2 * radius);
    near((await material()).mfp, old.map((length) => 2 * length));
    await changes("scale", () => view.type("material-subsurface_radius_scale-b", 0.7));
    near((await value("subsurface_radius_scale"))[2], 0.7);
    await changes("a slider", () => view.page.locator("#material-mfp-red-slider").fill("600"));
    // Short lengths are shown in a unit that leaves them four digits
    await changes("short", () => view.type("material-subsurface_radius", "0.45678 mm"));
    near(await value("subsurface_radius"), 0.045678);
    const row = view.page.locator(".row", { has: view.page.locator("#material-subsurface_radius") });
    await view.page.locator("#material-subsurface_radius").blur();
    assert.equal(await view.page.locator("#material-subsurface_radius").inputValue(), "0.4568");
    assert.match(await row.textContent(), /mm/);
    await changes("long", () => view.type("material-subsurface_radius", "1 cm"));
});

const WORDS = [
    ["subsurface_parameter", "dmfp"],
    ["subsurface_configuration", "searchlight"],
    ["subsurface_normalization", "energy"],
];
for (const [key, word] of WORDS) {
    test(`${key}: ${word}`, () => changes(key, async () => {
        await view.check(`material-${key}-${word}`);
        await view.done();
        assert.equal((await material())[key], word);
    }));
}

test("subsurface_texture_at counts where there are vertex colors", async () => {
    await view.choose("material", 1);
    await changes("both", () => view.check("material-subsurface_texture_at-both"));
    assert.equal((await view.state()).sides.a.materials[1].subsurface_texture_at, "both");
    const badge = view.page.locator(".joined .badge").first();
    assert.equal(await badge.textContent(), "\u00d7 vertex");
    await view.choose("material", 0);
});

test("every model", async () => {
    // Of the scene's own material: some models take long to prepare one with all that was set above
    await view.reset();
    const models = await view.page.locator("#material-subsurface_model option").evaluateAll((options) => options.map(({ value }) => value));
    assert.ok(models.includes("random-walk") && models.includes("exact"));
    for (const model of models) {
        if (model === (await material()).subsurface_model) continue;
        await view.choose("material-subsurface_model", model);
        await view.agrees(model);
        assert.equal((await material()).subsurface_model, model);
    }
});

test("a preset", async () => {
    await view.reset();
    before = await view.pixels();
    await changes("jade", () => view.choose("preset", "jade"));
    assert.equal((await material()).name, "skin", "the material keeps its name");
});

test("a slider's drag is one step of undo", async () => {
    await view.reset();
    const start = await value("specular_roughness");
    const box = await view.page.locator("#material-specular_roughness-slider").boundingBox();
    await view.page.mouse.move(box.x + box.width * 0.3, box.y + box.height / 2);
    await view.page.mouse.down();
    for (let i = 0; i <= 20; i++) await view.page.mouse.move(box.x + box.width * (0.3 + 0.02 * i), box.y + box.height / 2);
    await view.page.mouse.up();
    await view.done();
    near(await value("specular_roughness"), Number(await view.page.locator("#material-specular_roughness").inputValue()));
    assert.ok((await value("specular_roughness")) > 0.6);
    await view.agrees("after the drag");
    await view.history("undo");
    near(await value("specular_roughness"), start);
});

test("a label is dragged to change its field", async () => {
    await view.reset();
    const start = await value("specular_roughness");
    const box = await view.page.locator("#material-specular_roughness-label").boundingBox();
    await view.page.mouse.move(box.x + 5, box.y + 5);
    await view.page.mouse.down();
    await view.page.mouse.move(box.x + 45, box.y + 5, { steps: 5 });
    await view.page.mouse.up();
    await view.done();
    near(await value("specular_roughness"), start + 0.1);
});

test("what the server refuses is said at its field, and changes nothing", async () => {
    const start = await value("specular_roughness");
    await view.type("material-specular_roughness", 7);
    const error = view.page.locator("#material-specular_roughness-error");
    await error.waitFor({ state: "visible" });
    assert.match(await error.textContent(), /^Roughness is 7, but must be in \[0, 1\]/);
    const field = view.page.locator("#material-specular_roughness");
    assert.equal(await field.getAttribute("aria-invalid"), "true");
    assert.equal(await field.inputValue(), "7");
    near(await value("specular_roughness"), start);
    await field.press("Escape");
    assert.equal(await error.isVisible(), false);
    near(Number(await field.inputValue()), start);
    await view.type("material-specular_roughness", "rough");
    assert.match(await error.textContent(), /\u201crough\u201d is not a number/);
    await view.type("material-specular_roughness", 0.5);
    await view.done();
    assert.equal(await error.isVisible(), false);
    near(await value("specular_roughness"), 0.5);
});

test("refusals speak of labels, and of the units that there are", async () => {
    const refuses = async (id, text, words) => {
        await view.type(id, text);
        const error = view.page.locator(".error:visible").first();
        await error.waitFor();
        assert.match(await error.textContent(), words);
        await view.page.locator(`#${id}`).press("Escape");
    };
    await refuses("material-base_color-r", 2, /^Color red is 2, but must be in \[0, 1\]/);
    await refuses("material-subsurface_color-green", 2, /^Surface albedo A green is 2, but must be in \[0, 1\]/);
    await refuses("material-subsurface_radius", -1, /^Mean free path is -1, but must be/);
    await refuses("material-subsurface_radius", "5 inch", /^\u201c5 inch\u201d is not a number .* \u00b5m, mm, cm or m$/);
    await refuses("material-specular_ior", "5 mm", /^\u201c5 mm\u201d is not a number$/);
});

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
