// For everybody: axe-core, keyboard alone, light and dark, from 1,000 pixels to 4K.

import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { test } from "node:test";

import { start } from "./view.mjs";

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const { open } = await start();
const view = await open();
await view.done();
const { page } = view;

/** What axe-core finds. */
async function violations(target = page) {
    if (!(await target.evaluate(() => "axe" in window))) {
        // The page forbids scripts of others; the debugger may add one.
        const { readFile } = await import("node:fs/promises");
        await target.evaluate(await readFile(AXE, "utf8"));
    }
    const { violations } = await target.evaluate(() => window.axe.run());
    return violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${id}: ${target} ${failureSummary}`));
}

for (const colorScheme of ["light", "dark"]) {
    test(`axe-core finds nothing: ${colorScheme}`, async () => {
        await page.emulateMedia({ colorScheme });
        await page.waitForTimeout(300);
        for (const tab of ["material", "lights", "render"]) {
            await view.click(`tab-${tab}`);
            assert.deepEqual(await violations(), [], tab);
        }
        if (!(await page.locator("#numbers-panel").isVisible())) await view.click("toggle-numbers");
        await page.locator(".system").first().waitFor();
        assert.deepEqual(await violations(), [], "numbers");
        await view.click("tab-material");
        await view.type("material-specular_roughness", 9);
        await page.locator("#material-specular_roughness-error").waitFor({ state: "visible" });
        assert.deepEqual(await violations(), [], "an error");
        await page.locator("#material-specular_roughness").press("Escape");
        await view.click("show-help");
        assert.deepEqual(await violations(), [], "help");
        await page.keyboard.press("Escape");
        await view.click("save");
        assert.deepEqual(await violations(), [], "menu");
        await page.keyboard.press("Escape");
        await view.click("compare");
        await page.waitForFunction(() => window.translucidView.state.compare);
        await page.waitForTimeout(200);
        assert.deepEqual(await violations(), [], "comparison");
        await view.click("compare");
        await page.waitForFunction(() => !window.translucidView.state.compare);
    });
}

test("Tab reaches every control in the order of the page, and each shows its focus", async () => {
    // From the top: the browser goes on where the last click was
    await view.load();
    const seen = [];
    for (let i = 0; i < 200; i++) {
        await page.keyboard.press("Tab");
        const id = await page.evaluate(() => {
            const element = document.activeElement;
            if (element === document.body) return null;
            const shown = element.type === "radio" ? element.nextElementSibling : element;
            const { outlineStyle } = getComputedStyle(shown);
            return { id: element.id || element.textContent.trim(), outline: outlineStyle };
        });
        if (id === null || seen.some((other) => other.id === id.id)) break;
        seen.push(id);
    }
    const ids = seen.map(({ id }) => id);
    for (const id of ["compare", "save", "camera", "exposure-slider", "viewport", "material", "preset", "material-subsurface_model", "material-mfp-red-slider", "material-mfp-red"]) {
        assert.ok(ids.includes(id), `${id} is among ${ids}`);
    }
    const hidden = seen.filter(({ outline }) => outline === "none").map(({ id }) => id);
    assert.deepEqual(hidden, []);
    assert.ok(ids.indexOf("viewport") < ids.indexOf("material"));
});

test("sliders say their values with their units", async () => {
    await view.reset();
    const slider = page.locator("#material-mfp-red-slider");
    await slider.focus();
    const before = Number(await page.locator("#material-mfp-red").inputValue());
    await page.keyboard.press("ArrowRight");
    await view.done();
    const after = Number(await page.locator("#material-mfp-red").inputValue());
    assert.ok(after > before);
    assert.match(await page.locator("#material-subsurface_radius-slider").getAttribute("aria-valuetext"), /^[\d.]+ cm$/);
});

test("fields step by arrow keys", async () => {
    await view.reset();
    const field = page.locator("#material-specular_roughness");
    const before = Number(await field.inputValue());
    await field.focus();
    await page.keyboard.press("ArrowUp");
    await page.keyboard.press("Shift+ArrowUp");
    await view.done();
    assert.ok(Math.abs(Number(await field.inputValue()) - before - 0.11) < 1e-6);
});

test("keys of the page", async () => {
    await view.reset();
    await page.locator("#viewport").focus();
    await page.keyboard.press("c");
    await page.waitForFunction(() => window.translucidView.state.compare);
    await page.keyboard.press("c");
    await page.waitForFunction(() => !window.translucidView.state.compare);
    await page.keyboard.press("v");
    await page.waitForFunction(() => window.translucidView.state.view !== "radiance");
    await page.keyboard.press("V");
    await page.waitForFunction(() => window.translucidView.state.view === "radiance");
    const isOpen = () => page.locator("#profile-panel").isVisible();
    const before = await isOpen();
    await page.keyboard.press("p");
    assert.notEqual(await isOpen(), before);
    await page.keyboard.press("p");
    await page.keyboard.press(" ");
    await page.waitForFunction(() => window.translucidView.state.paused);
    await page.keyboard.press(" ");
    await page.waitForFunction(() => !window.translucidView.state.paused);
    await page.keyboard.press("?");
    assert.equal(await page.locator("#help").isVisible(), true);
    await page.keyboard.press("Escape");
    assert.equal(await page.locator("#help").isVisible(), false);
});

test("keys that are typed into a field are no commands", async () => {
    await page.locator("#material-specular_roughness").focus();
    await page.keyboard.type("cxf");
    await page.waitForTimeout(200);
    assert.equal((await view.state()).compare, false);
    await page.keyboard.press("Escape");
});

test("the switch of colors is kept", async () => {
    await page.emulateMedia({ colorScheme: "dark" });
    const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const dark = await background();
    await view.click("theme");
    assert.equal(await page.locator("html").getAttribute("data-theme"), "light");
    assert.notEqual(await background(), dark);
    await view.load();
    assert.equal(await page.locator("html").getAttribute("data-theme"), "light");
    await view.click("theme");
    await view.click("theme");
    assert.equal(await background(), dark);
});

test("the first switch of colors shows in the dark and in the light", async () => {
    for (const colorScheme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme });
        await page.evaluate(() => localStorage.clear());
        await view.load();
        const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
        const before = await background();
        await view.click("theme");
        assert.notEqual(await background(), before, colorScheme);
    }
    await page.evaluate(() => localStorage.clear());
    await view.load();
});

for (const [width, height] of [[1000, 700], [1440, 900], [2560, 1440], [3840, 2160]]) {
    test(`nothing is cut off or overlaps at ${width} pixels`, async () => {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(200);
        const cut = await page.evaluate(() => {
            const bad = [];
            if (document.documentElement.scrollWidth > innerWidth) bad.push("the page scrolls sideways");
            for (const element of document.querySelectorAll("button, select, input:not(.off-screen), .segments, h2")) {
                if (!element.checkVisibility({ visibilityProperty: true })) continue;
                const { left, right, width } = element.getBoundingClientRect();
                if (width > 0 && (left < -1 || right > innerWidth + 1)) bad.push(`${element.id} leaves the window`);
                if (element.matches("button, h2") && element.scrollWidth > element.clientWidth + 1) bad.push(`${element.id || element.textContent} is cut`);
            }
            for (const id of ["top", "view-bar", "compare-bar", "tabs"]) {
                const boxes = [...document.getElementById(id).children].filter((child) => child.checkVisibility() && !child.matches(".off-screen")).map((child) => child.getBoundingClientRect());
                for (let i = 1; i < boxes.length; i++) if (boxes[i].left < boxes[i - 1].right - 1) bad.push(`${id}: ${i} overlaps`);
            }
            return bad;
        });
        assert.deepEqual(cut, []);
    });
}

test("nothing was thrown and nothing refused", () => assert.deepEqual(view.complaints, []));
