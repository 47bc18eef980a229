// A mesh of one's own: it is stood up, exposed and named as by the command, and saved so.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { promisify } from "node:util";

import { decode } from "./png.mjs";
import { COMMAND, difference, start } from "./view.mjs";

const run = promisify(execFile);

/** A vase with a lid that stands along z, in the middle of nowhere: its foot is flat or comes to a point, as its lid does. */
function vase({ hasFoot }) {
    const [lines, faces, sides] = [[], [], 16];
    const profile = [[5, 0], [9, 6], [10, 12], [6, 20], [4, 26], [6, 30]];
    profile.forEach(([radius, height], ring) => {
        for (let side = 0; side < sides; side++) {
            const angle = (2 * Math.PI * side) / sides;
            lines.push(`v ${40 + radius * Math.cos(angle)} ${radius * Math.sin(angle)} ${7 + height}`);
            const [a, b] = [ring * sides + side + 1, ring * sides + ((side + 1) % sides) + 1];
            if (ring + 1 < profile.length) faces.push(`f ${a} ${b} ${b + sides} ${a + sides}`);
            else faces.push(`f ${a} ${b} ${sides * profile.length + 2}`);
            if (ring === 0) faces.push(`f ${b} ${a} ${sides * profile.length + 1}`);
        }
    });
    lines.push(`v 40 0 ${hasFoot ? 7 : 3}`, "v 40 0 39");
    return `${[...lines, ...faces].join("\n")}\n`;
}

const folder = await mkdtemp(join(tmpdir(), "translucid-mesh-"));
after(() => rm(folder, { recursive: true }));
const [standing, plain] = ["standing.obj", "plain.obj"].map((name) => join(folder, name));
await writeFile(standing, vase({ hasFoot: true }));
await writeFile(plain, vase({ hasFoot: false }));
const SMALL = ["--size", "96x64", "--spp", "12"];

/** The picture that the command makes of a mesh. */
async function rendered(mesh, ...options) {
    const picture = join(folder, "picture.png");
    await run(COMMAND, ["render", mesh, ...SMALL, ...options, "-o", picture]);
    return decode(await readFile(picture));
}

/** The page shows the picture, saves it, and saves a scene of which the command makes it. */
async function shows(view, made, what) {
    await view.agrees(what);
    const [shown, saved] = [await view.pixels(), decode(await view.save("png"))];
    assert.equal(difference(shown.codes, made.codes), 0, `${what}: pixels that differ from the mesh's picture`);
    assert.equal(difference(saved.codes, made.codes), 0, `${what}: pixels of the file that differ`);
}

const { open } = await start(plain, ...SMALL);
const view = await open();
const scene = async () => String(await view.save("scene"));

test("the page begins with the exposure and the pixels of the command", async () => {
    await view.done();
    const { film } = await view.state();
    assert.ok(film.exposure !== 0, "it is metered");
    await shows(view, await rendered(plain), "a mesh");
    assert.match(await scene(), new RegExp(`exposure = ${film.exposure}`));
});

test("a mesh is stood up by the menu, in one step of undo", async () => {
    const before = await view.pixels();
    await view.choose("mesh-up", "z");
    await view.done();
    assert.equal((await view.state()).orientation.up, "z");
    await shows(view, await rendered(plain, "--up", "z"), "z is up");
    assert.match(await scene(), /^up = "z"$/m);
    await view.history("undo");
    await view.done();
    assert.equal((await view.state()).orientation.up, "y");
    assert.equal(difference(before.codes, (await view.pixels()).codes), 0, "undone");
    await view.history("redo");
    await view.agrees("redone");
});

test("a mesh is turned by angles, and a camera of one's own stays", async () => {
    await view.type("mesh-turn-y", 30);
    await view.type("mesh-turn-x", -20.5);
    await view.done();
    assert.deepEqual((await view.state()).orientation, { up: "z", rotate: [-20.5, 30, 0] });
    await shows(view, await rendered(plain, "--up", "z", "--rotate", "-20.5,30,0"), "turned");
    await view.type("camera-position-x", 20);
    const { camera } = await view.state();
    await view.type("mesh-turn-z", 10);
    await view.agrees("with its own camera");
    assert.deepEqual((await view.state()).camera, camera);
    await view.type("mesh-turn-z", 1e9);
    const error = view.page.locator("#mesh-turn-error");
    await error.waitFor();
    assert.match(await error.textContent(), /^Turn z is 1e9, but must be in \[-36000, 36000\]/);
    await view.page.locator("#mesh-turn-z").press("Escape");
    await view.reset();
    assert.deepEqual((await view.state()).orientation, { up: "y", rotate: [0, 0, 0] });
});

test("a material from a preset has the name of the preset, and is saved by it alone", async () => {
    await view.choose("preset", "skin1");
    await view.agrees("skin1");
    assert.equal(await view.page.locator("#material option:checked").textContent(), "skin1");
    assert.match(await scene(), /\[\[material\]\]\nname = "marble"\npreset = "skin1"\n(?!\w)/);
    await view.reset();
});

test("options of the command are those of the page, and of what it saves", async () => {
    const options = ["--up", "z", "--rotate", "15", "--view", "-40,20", "--zoom", "1.2", "--floor", "#806040", "--preset", "jade"];
    const { open } = await start(standing, ...SMALL, ...options);
    const other = await open();
    await other.done();
    await shows(other, await rendered(standing, ...options), "with options");
    await other.choose("mesh-up", "-y");
    await other.agrees("turned");
    assert.deepEqual(other.complaints, []);
});

test("an environment by option is saved with its path", async () => {
    const sky = join(folder, "sky.png");
    await run(COMMAND, ["render", standing, "--size", "32x16", "--spp", "1", "-o", sky]);
    const options = ["--environment", sky, "--environment-rotation", "70"];
    const { open } = await start(standing, ...SMALL, ...options);
    const other = await open();
    await other.done();
    await shows(other, await rendered(standing, ...options), "in an environment");
    await other.type("environment-rotation", 20);
    await other.agrees("turned environment");
});

test("nothing complains", () => assert.deepEqual(view.complaints, []));
