// How the page feels: times from the hand to the screen, in headless Chromium.
//
//     npm ci --prefix crates/translucid-view/tests/browser
//     TRANSLUCID=target/release/translucid node crates/translucid-view/benches/feel.mjs path/to/head_70k.ply
//
// Prints a table of medians and 95th percentiles. A time ends when the page has handed its animation frame to the
// browser's compositor.

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { COMMAND, launch, serve } from "../tests/browser/view.mjs";

const [mesh, moves = "100"] = process.argv.slice(2);
if (!mesh) {
    console.error("usage: node feel.mjs PATH/head_70k.ply [MOVES]");
    process.exit(2);
}
const MOVES = Number(moves);
const EDITS = 2000;
const SCENE = [join(import.meta.dirname, "../../../scenes/head.toml"), "--mesh", mesh, "--size", "960x540"];
const REPEATS = 5;

const rows = [];
const row = (what, value, wanted = "") => {
    rows.push(`| ${what} | ${value} | ${wanted} |`);
    console.error(`${what}: ${value}`);
};
const quantile = (values, share) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))];
const median = (values) => quantile(values, 0.5);
const ms = (values) => `${median(values).toFixed(0)} ms, ${quantile(values, 0.95).toFixed(0)} ms`;

/** Seconds that the command's rendering takes, as its OpenEXR file states them. */
function byCommand(samples) {
    const folder = mkdtempSync(join(tmpdir(), "feel-"));
    const picture = join(folder, "x.exr");
    execFileSync(COMMAND, ["render", ...SCENE, "--spp", String(samples), "-o", picture], { stdio: "ignore" });
    const file = readFileSync(picture);
    rmSync(folder, { recursive: true });
    const name = "translucidSeconds\0double\0";
    return file.readDoubleLE(file.indexOf(name) + name.length + 4);
}

/** Resident memory of a process, MiB. */
function memory(pid) {
    const text = readFileSync(`/proc/${pid}/status`, "utf8");
    return Number(text.match(/VmRSS:\s+(\d+)/)[1]) / 1024;
}

async function done(page) {
    await page.waitForFunction(() => {
        const { sent, lastFrame } = window.translucidView;
        const asked = Math.max(0, ...sent.map(({ version }) => version ?? 0));
        return sent.every(({ isAnswered }) => isAnswered) && lastFrame?.isLast && lastFrame.version >= asked;
    }, undefined, { timeout: 600_000, polling: 50 });
}

/** Notes the times of events. */
async function watch(page, selector, event) {
    await page.evaluate(([selector, event]) => {
        window.feel = { times: [] };
        document.querySelector(selector).addEventListener(event, ({ timeStamp }) => window.feel.times.push(timeStamp));
    }, [selector, event]);
}

/** Time from the last event to the first picture of what it asked for. */
async function answered(page) {
    const handle = await page.waitForFunction(() => {
        const time = window.feel.times.at(-1);
        const { sent, painted } = window.translucidView;
        const version = sent.find((message) => message.time >= time - 1 && message.version !== null && ["material", "camera"].includes(message.type))?.version;
        const frame = version === undefined ? undefined : painted.find((frame) => frame.version >= version);
        return frame ? { milliseconds: frame.time - time } : null;
    }, undefined, { polling: 10, timeout: 20_000 });
    return (await handle.jsonValue()).milliseconds;
}

const browser = await launch();

// From the command to the first pixels
const [loads, firsts] = [[], []];
for (let i = 0; i < REPEATS; i++) {
    const begin = Date.now();
    const server = await serve(...SCENE);
    const page = await browser.newPage({ viewport: { width: 1440, height: 900 } });
    await page.goto(server.address);
    const loaded = await page.evaluate(() => performance.timeOrigin + performance.getEntriesByType("navigation")[0].loadEventEnd);
    await page.waitForFunction(() => window.translucidView?.lastFrame, undefined, { polling: 10 });
    const painted = await page.evaluate(() => performance.timeOrigin + window.translucidView.painted[0].time);
    loads.push(loaded - begin);
    firsts.push(painted - begin);
    await page.close();
    await server.stop();
}
row("page loaded after the command was typed: median, slowest", `${median(loads).toFixed(0)} ms, ${Math.max(...loads).toFixed(0)} ms`);
row("first pixels after the command was typed: median, slowest", `${median(firsts).toFixed(0)} ms, ${Math.max(...firsts).toFixed(0)} ms`, "≤ 1500 ms");

const server = await serve(...SCENE, "--spp", "16");
const page = await browser.newPage({ viewport: { width: 1440, height: 900 } });
page.setDefaultTimeout(120_000);
await page.goto(server.address);
await page.waitForFunction(() => window.translucidView?.lastFrame);
await done(page);

// Single moves of a slider that is held
const slider = page.locator("#material-mfp-red-slider");
await slider.scrollIntoViewIfNeeded();
const box = await slider.boundingBox();
await watch(page, "#material-mfp-red-slider", "input");
const y = box.y + box.height / 2;
await page.mouse.move(box.x + box.width * 0.4, y);
await page.mouse.down();
const ofSlider = [];
for (let i = 0; i < MOVES; i++) {
    await page.waitForTimeout(120 + (i * 37) % 100);
    await page.mouse.move(box.x + box.width * (0.3 + 0.4 * ((i * 7) % 11) / 11), y);
    ofSlider.push(await answered(page));
}
await page.mouse.up();
row(`slider moved to new pixels (${MOVES} moves): median, 95 %`, ms(ofSlider), "≤ 100 ms, ≤ 200 ms");
await done(page);

// Single moves of the camera
const stage = await page.locator("#stage").boundingBox();
const [cx, cy] = [stage.x + stage.width / 2, stage.y + stage.height / 2];
await watch(page, "#viewport", "pointermove");
await page.mouse.move(cx, cy);
await page.mouse.down();
await page.mouse.move(cx + 6, cy);
const ofCamera = [];
for (let i = 0; i < MOVES; i++) {
    await page.waitForTimeout(120 + (i * 37) % 100);
    await page.mouse.move(cx + 60 * Math.sin(i), cy + 20 * Math.cos(i));
    ofCamera.push(await answered(page));
}
row(`camera moved to new pixels (${MOVES} moves): median, 95 %`, ms(ofCamera), "≤ 100 ms, ≤ 200 ms");

// A drag of five seconds, and letting go
const count = () => page.evaluate(() => window.translucidView.lastFrame.number);
const begin = Date.now();
const first = await count();
let steps = 0;
while (Date.now() - begin < 5000) {
    await page.mouse.move(cx + 100 * Math.sin(steps / 20), cy);
    steps++;
    await page.waitForTimeout(8);
}
const pictures = ((await count()) - first) / ((Date.now() - begin) / 1000);
row("pictures a second while dragging", pictures.toFixed(1), "≥ 10");
await page.mouse.up();
await done(page);

// Letting go to one sample a pixel at full resolution
const wholes = [];
for (let i = 0; i < REPEATS; i++) {
    await page.mouse.move(cx, cy);
    await page.mouse.down();
    for (let j = 0; j < 10; j++) {
        await page.mouse.move(cx + 10 * (j + 1) * (i % 2 ? -1 : 1), cy);
        await page.waitForTimeout(30);
    }
    await page.evaluate(() => document.getElementById("viewport").addEventListener("pointerup", ({ timeStamp }) => (window.feel.up = timeStamp), { once: true }));
    await page.mouse.up();
    const handle = await page.waitForFunction(() => {
        const frame = window.translucidView.painted.find(({ time, edge, samples }) => time > window.feel.up && edge === 1 && samples >= 1);
        return frame ? { seconds: (frame.time - window.feel.up) / 1000 } : null;
    }, undefined, { polling: 10 });
    wholes.push((await handle.jsonValue()).seconds);
    await done(page);
}
const one = median(Array.from({ length: REPEATS }, () => byCommand(1)));
row("let go to one sample a pixel: page, command", `${median(wholes).toFixed(3)} s, ${one.toFixed(3)} s (${((100 * median(wholes)) / one - 100).toFixed(0)} %)`, "≤ +10 %");

// To 16 samples
const sixteens = [];
for (let i = 0; i < REPEATS; i++) {
    const field = page.locator("#material-mfp-red");
    await field.fill(String(2 + 0.1 * i));
    await page.evaluate(() => (window.feel.enter = performance.now()));
    await field.press("Enter");
    await done(page);
    sixteens.push(await page.evaluate(() => (window.translucidView.lastFrame.time - window.feel.enter) / 1000));
}
const sixteen = median(Array.from({ length: REPEATS }, () => byCommand(16)));
row("to 16 samples: page, command", `${median(sixteens).toFixed(2)} s, ${sixteen.toFixed(2)} s (${((100 * median(sixteens)) / sixteen - 100).toFixed(1)} %)`, "≤ +5 %");

// Memory over many edits
const edit = (edits) => page.evaluate(async (edits) => {
    const slider = document.getElementById("material-mfp-red-slider");
    for (let i = 0; i < edits; i++) {
        slider.value = String(300 + ((i * 13) % 400));
        slider.dispatchEvent(new Event("input"));
        if (i % 5 === 4) slider.dispatchEvent(new Event("change"));
        await new Promise(requestAnimationFrame);
    }
    slider.dispatchEvent(new Event("change"));
}, edits);
const pages = async () => (await page.evaluate(() => performance.memory.usedJSHeapSize)) / 2 ** 20;
await edit(300);
await done(page);
const before = [memory(server.process.pid), await pages()];
await edit(EDITS);
await done(page);
const after = [memory(server.process.pid), await pages()];
row(`memory over ${EDITS} edits: server, page's heap`, `${before[0].toFixed(0)} → ${after[0].toFixed(0)} MiB, ${before[1].toFixed(1)} → ${after[1].toFixed(1)} MiB`, "does not grow");

await browser.close();
await server.stop();
console.log(`| | measured | wanted |\n|---|---|---|\n${rows.join("\n")}`);
