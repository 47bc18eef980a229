// How the page feels, in headless Chromium: medians and 95th percentiles.
//
//     TRANSLUCID=target/release/translucid node crates/translucid-view/benches/feel.mjs SCENE|MESH [options of view]
//
// Every figure is printed with what it is measured from and to. `npm ci` in tests/browser comes first.

import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";

import { COMMAND, launch, serve } from "../tests/browser/view.mjs";

const run = promisify(execFile);
const words = process.argv.slice(2);
const REPEATS = 100;
const EDITS = 2000;
const SAMPLES = 16;

const quantile = (values, q) => values.toSorted((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];
const summary = (values) => `median ${quantile(values, 0.5).toFixed(0)} ms, 95 % ${quantile(values, 0.95).toFixed(0)} ms (${values.length})`;
const say = (what, value) => console.log(`${what}: ${value}`);

const browser = await launch();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });

// From the command to the first pixels
const started = performance.now();
const server = await serve(...words, "--size", "960x540", "--spp", String(SAMPLES));
const page = await context.newPage();
await page.goto(server.address);
await page.waitForFunction(() => window.translucidView?.lastFrame, null, { polling: 5 });
say("from the command to the first pixels painted (browser running)", `${(performance.now() - started).toFixed(0)} ms`);
await page.waitForFunction(() => window.translucidView.samples >= 1);

/** Time from an input in the page to the first paint of what it asked for. */
const latency = async (input) => {
    const before = await page.evaluate(() => window.translucidView.sent.length && window.translucidView.sent.at(-1).id);
    const start = await input();
    const handle = await page.waitForFunction(
        (before) => {
            const { sent, painted } = window.translucidView;
            const message = sent.findLast(({ id, version }) => id > before && version !== null);
            if (!message) return null;
            return painted.find(({ version }) => version >= message.version)?.time ?? null;
        },
        before || 0,
        { polling: 5 },
    );
    return (await handle.jsonValue()) - start;
};

const id = "material-subsurface_radius-slider";
const slide = (step) =>
    page.evaluate(
        ([id, step]) => {
            const input = document.getElementById(id);
            const [min, max] = [Number(input.min), Number(input.max)];
            input.value = String(min + (max - min) * (0.3 + 0.4 * ((step * 0.618) % 1)));
            const now = performance.now();
            input.dispatchEvent(new Event("input", { bubbles: true }));
            return now;
        },
        [id, step],
    );
const moves = [];
for (let step = 0; step < REPEATS; step++) {
    moves.push(await latency(() => slide(step)));
    await page.waitForTimeout(30);
}
say(`slider ${id} to new pixels painted`, summary(moves));
await page.evaluate((id) => document.getElementById(id).dispatchEvent(new Event("change", { bubbles: true })), id);

// Orbit by key presses, one at a time
await page.locator("#viewport").focus();
const turns = [];
const orbit = () =>
    page.evaluate(() => {
        const now = performance.now();
        const key = { key: "ArrowLeft", code: "ArrowLeft", bubbles: true, cancelable: true };
        document.getElementById("viewport").dispatchEvent(new KeyboardEvent("keydown", key));
        document.getElementById("viewport").dispatchEvent(new KeyboardEvent("keyup", key));
        return now;
    });
for (let step = 0; step < REPEATS; step++) {
    turns.push(await latency(orbit));
    await page.waitForTimeout(30);
}
say("orbit by a key to new pixels painted", summary(turns));

// A drag of five seconds
const box = await page.locator("#viewport").boundingBox();
const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
await page.mouse.move(x, y);
await page.mouse.down();
const from = await page.evaluate(() => performance.now());
for (let step = 0; step < 250; step++) {
    await page.mouse.move(x + 150 * Math.sin(step / 20), y + 40 * Math.sin(step / 33));
    await page.waitForTimeout(20);
}
const dragged = await page.evaluate((from) => {
    const now = performance.now();
    return [window.translucidView.painted.filter(({ time }) => time > from).length, now - from];
}, from);
say("pictures a second while dragging", (1000 * dragged[0] / dragged[1]).toFixed(1));

// Letting go: to one sample of every pixel
const wholes = [];
for (let repeat = 0; repeat < 5; repeat++) {
    if (repeat > 0) {
        await page.mouse.down();
        for (let step = 0; step < 20; step++) {
            await page.mouse.move(x + 10 * step, y + 3 * repeat);
            await page.waitForTimeout(20);
        }
    }
    const released = await page.evaluate(() => performance.now());
    await page.mouse.up();
    const whole = await page.waitForFunction(
        (released) => window.translucidView.painted.find(({ time, edge, samples }) => time > released && edge === 1 && samples >= 1)?.time,
        released,
        { polling: 5 },
    );
    wholes.push((await whole.jsonValue()) - released);
}
say("from letting go to one sample of every pixel painted", summary(wholes));

const folder = await mkdtemp(join(tmpdir(), "translucid-feel-"));
const scene = join(folder, "scene.toml");
const text = await (await context.request.get(`${server.address}scene.toml`)).text();
await writeFile(scene, text);
const timed = async (spp) => {
    const { stderr } = await run(COMMAND, ["render", scene, ...words.slice(1), "--size", "960x540", "--spp", String(spp), "-o", join(folder, "x.png")]);
    const [, minutes, rest, cpu] = stderr.match(/samples per pixel at \S+ in (?:(\d+) min )?([\d.]+) s \(([\d.]+) s of CPU\)/) ?? [];
    return { wall: 60 * Number(minutes ?? 0) + Number(rest), cpu: Number(cpu) };
};
const singles = [];
for (let repeat = 0; repeat < 5; repeat++) singles.push(1000 * (await timed(1)).wall);
say("one sample of every pixel by the command (its own figure)", summary(singles));

/** Time of processors that the server has had, in seconds: user's and system's, in hundredths. */
const computed = async () => {
    const stat = await readFile(`/proc/${server.process.pid}/stat`, "utf8");
    const fields = stat.slice(stat.lastIndexOf(")") + 2).split(" ");
    return (Number(fields[11]) + Number(fields[12])) / 100;
};
// Another seed is another picture, and no motion
const seed = (value) =>
    page.evaluate((value) => {
        const input = document.getElementById("integrator-seed");
        input.value = String(value);
        const now = performance.now();
        input.dispatchEvent(new Event("change", { bubbles: true }));
        return now;
    }, value);

// All samples in the page and by the command, in turns
const inPage = [];
const byCommand = [];
for (let repeat = 0; repeat < 5; repeat++) {
    const before = await computed();
    const start = await seed(100 + repeat);
    const last = await page.waitForFunction(
        (start) => window.translucidView.painted.find(({ time, isLast, edge }) => time > start && isLast && edge === 1)?.time,
        start,
        { polling: 20, timeout: 600_000 },
    );
    inPage.push({ wall: ((await last.jsonValue()) - start) / 1000, cpu: (await computed()) - before });
    byCommand.push(await timed(SAMPLES));
}
const list = (values) => values.map((value) => value.toFixed(2)).join(", ");
for (const [kind, name] of [["wall", "time"], ["cpu", "time of processors"]]) {
    const [page, command] = [inPage, byCommand].map((times) => times.map((time) => time[kind]));
    say(`${name} of ${SAMPLES} samples in the page, from another seed to the last picture painted [s]`, list(page));
    say(`${name} of ${SAMPLES} samples by the command, its own figure [s]`, list(command));
    say(`${name}, page over command`, (quantile(page, 0.5) / quantile(command, 0.5)).toFixed(3));
}

// Memory after many edits
const resident = async () => Number((await readFile(`/proc/${server.process.pid}/status`, "utf8")).match(/VmRSS:\s+(\d+)/)[1]) / 1024;
const before = await resident();
for (let step = 0; step < EDITS; step++) {
    await slide(step);
    if (step % 20 === 0) await page.waitForTimeout(50);
}
await page.waitForTimeout(1000);
say(`server's memory before and after ${EDITS} edits [MiB]`, `${before.toFixed(0)}, ${(await resident()).toFixed(0)}`);

await browser.close();
await server.stop();
await rm(folder, { recursive: true });
