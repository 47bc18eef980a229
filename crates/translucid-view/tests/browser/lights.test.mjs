// Lights and the environment.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";

import { difference, start } from "./view.mjs";

const { open } = await start();
const view = await open();
await view.done();
let before = await view.pixels();

const light = async (index) => (await view.state()).sides.a.lights[index];
const environment = async () => (await view.state()).sides.a.environment;
const near = (actual, wanted, error = 1e-4) =>
    [actual].flat().forEach((number, i) => assert.ok(Math.abs(number - [wanted].flat()[i]) <= error * (1 + Math.abs(number)), `${actual} is not ${wanted}`));
const length = (a) => Math.hypot(...a);

async function changes(what, act) {
    await act();
    await view.agrees(what);
    const after = await view.pixels();
    assert.ok(difference(before.codes, after.codes) > 0, `${what}: the picture is another one`);
    before = after;
}

test("strength keeps the color, in numbers and in stops", async () => {
    const { radiance } = await light(0);
    await changes("half", () => view.type("light-0-strength", "/2"));
    near((await light(0)).radiance, radiance.map((x) => x / 2));
    await changes("stops", () => view.type("light-0-strength", "+1ev"));
    near((await light(0)).radiance, radiance);
    await changes("a button", () => view.click("light-0-brighter"));
    near((await light(0)).radiance, radiance.map((x) => x * Math.SQRT2));
});

test("color keeps the strength", async () => {
    const strongest = Math.max(...(await light(0)).radiance);
    await changes("swatch", () => view.page.locator("#light-0-color-swatch").fill("#0080ff"));
    near(Math.max(...(await light(0)).radiance), strongest);
    near((await light(0)).radiance[0], 0);
    await changes("a channel", () => view.type("light-0-color-r", 3));
    near((await light(0)).radiance[0], 3);
});

test("a light is carried around the scene as one piece", async () => {
    const old = await light(0);
    const { center } = await view.page.evaluate(() => window.translucidView.state.bounds);
    const far = ({ center: place }) => length(place.map((x, i) => x - center[i]));
    await changes("azimuth", () => view.type("light-0-azimuth", 100));
    await changes("elevation", () => view.type("light-0-elevation", 30));
    const turned = await light(0);
    near(far(turned), far(old));
    near([length(turned.edge_x), length(turned.edge_y)], [length(old.edge_x), length(old.edge_y)]);
    near((turned.center[1] - center[1]) / far(turned), 0.5, 1e-3);
    await changes("distance", () => view.type("light-0-distance", 12));
    near(far(await light(0)), 12);
    await changes("place", () => view.type("light-0-place-x", -4));
    near((await light(0)).center[0], -4);
    await changes("face", () => view.click("light-0-face"));
});

test("size of the rectangle", async () => {
    await changes("width", () => view.type("light-0-size-width", 5));
    await changes("height", () => view.type("light-0-size-height", 1.5));
    near([length((await light(0)).edge_x), length((await light(0)).edge_y)], [5, 1.5]);
});

test("direction and size of the sun", async () => {
    await changes("azimuth", () => view.type("light-1-azimuth", -60));
    await changes("elevation", () => view.type("light-1-elevation", 20));
    const { direction } = await light(1);
    near([length(direction), direction[1]], [1, Math.sin(Math.PI / 9)]);
    await changes("angle", () => view.type("light-1-angular_radius", 5));
    near((await light(1)).angular_radius, 5);
    await changes("strength", () => view.type("light-1-strength", 3));
});

test("sphere and spot", async () => {
    await changes("radius", () => view.type("light-2-radius", 1.5));
    await changes("inner angle", () => view.type("light-3-inner_angle", 5));
    await changes("outer angle", () => view.type("light-3-outer_angle", 20));
    await changes("strength", () => view.type("light-3-strength", 90));
    near((await light(3)).intensity, [90, 90, 90]);
});

test("whether the camera sees a light", async () => {
    await view.choose("camera", 0);
    await view.type("camera-target-x", -6);
    await view.type("camera-target-y", 7);
    await view.done();
    before = await view.pixels();
    const { visible } = await light(2);
    await view.check("light-2-visible", !visible);
    await view.agrees("visible");
    assert.equal((await light(2)).visible, !visible);
    await view.reset();
    before = await view.pixels();
});

test("strength, color and sight of the environment", async () => {
    await changes("strength", () => view.type("environment-strength", 1));
    near(Math.max(...(await environment()).radiance), 1);
    await changes("color", () => view.type("environment-color-b", 0.1));
    await changes("seen", () => view.check("environment-visible", false));
    assert.equal((await environment()).visible, false);
    await changes("off", () => view.check("environment-on", false));
    assert.equal(await environment(), null);
    await changes("on", () => view.check("environment-on", true));
});

test("lights of every kind are added, turned, removed, and come back by undo", async () => {
    await view.reset();
    before = await view.pixels();
    const count = async () => (await view.state()).sides.a.lights.length;
    const first = await count();
    const kinds = ["rectangle", "ellipse", "sphere", "distant", "spot", "point", "beam"];
    for (const [i, kind] of kinds.entries()) {
        await changes(`${kind} added`, () => view.adds(kind));
        assert.equal((await light(first + i)).type, kind === "point" ? "spot" : kind);
        await view.page.locator(`#section-light-${first + i}[open]`).waitFor();
    }
    assert.match(await view.page.locator(`#section-light-${first + 5} summary`).textContent(), /^Point/);
    await changes("turned", () => view.type(`light-${first}-azimuth`, -120));
    const [, second] = (await view.state()).sides.a.lights.slice(first);
    await changes("removed", () => view.history(`light-${first}-remove`));
    assert.equal(await count(), first + kinds.length - 1);
    near((await light(first)).center, second.center);
    await view.history("undo");
    await view.history("undo");
    assert.equal(await count(), first + kinds.length);
    for (const _ of kinds) await view.history("undo");
    assert.equal(await count(), first);
    await view.agrees("all undone");
});

/** A Radiance picture: bright above, colored below. */
function radiancePicture() {
    const [width, height] = [16, 8];
    const head = `#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`;
    const pixels = Buffer.alloc(width * height * 4);
    for (let i = 0; i < width * height; i++) {
        const isLeft = i % width < width / 2;
        pixels.set(isLeft ? [200, 80, 40, 129] : [30, 60, 200, 128], 4 * i);
    }
    return Buffer.concat([Buffer.from(head), pixels]);
}

test("an image from the computer becomes the environment, and is turned", async () => {
    await view.reset();
    before = await view.pixels();
    await changes("image", async () => {
        // A saved scene names the file, which its owner has beside it.
        await writeFile(join(view.folder, "studio.hdr"), radiancePicture());
        await view.page.setInputFiles("#environment-file", { name: "studio.hdr", mimeType: "image/vnd.radiance", buffer: radiancePicture() });
        await view.page.waitForFunction(() => window.translucidView.state.sides.a.environment?.image !== null);
        await view.done((await view.state()).version);
    });
    const { images } = await view.state();
    assert.equal(images[(await environment()).image].width, 16);
    await changes("rotation", () => view.type("environment-rotation", 90));
    near((await environment()).rotation, 90);
    await changes("none", () => view.choose("environment-image", ""));
    await view.history("undo");
    await view.agrees("undone");
});

test("a file that is no image is refused in words, and changes nothing", async () => {
    const old = await environment();
    await view.page.setInputFiles("#environment-file", { name: "broken.hdr", mimeType: "", buffer: Buffer.from("#?RADIANCE\nnonsense") });
    const notice = view.page.locator(".notice.error");
    await notice.waitFor();
    assert.match(await notice.textContent(), /broken\.hdr/);
    assert.deepEqual(await environment(), old);
    await notice.getByRole("button").click();
});

test("a file is dropped on the page", async () => {
    await view.reset();
    await writeFile(join(view.folder, "dropped.hdr"), radiancePicture());
    const bytes = [...radiancePicture()];
    await view.page.evaluate((bytes) => {
        const files = new DataTransfer();
        files.items.add(new File([new Uint8Array(bytes)], "dropped.hdr"));
        for (const type of ["dragenter", "dragover", "drop"]) {
            document.body.dispatchEvent(new DragEvent(type, { dataTransfer: files, bubbles: true, cancelable: true }));
        }
    }, bytes);
    await view.page.waitForFunction(() => window.translucidView.state.images.some(({ name }) => name.includes("dropped")));
    await view.done((await view.state()).version);
    await view.agrees("dropped");
});

test("nothing was thrown", () => {
    const refused = view.complaints.filter((text) => !text.includes("400") && !text.includes("422"));
    assert.deepEqual(refused, []);
});
