// Starts the command and a browser, and looks at the page as a person would.
//
// TRANSLUCID is the built command, CHROMIUM a browser (/usr/bin/chromium where it is not said).

import assert from "node:assert/strict";
import { execFile, spawn } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after } from "node:test";
import { promisify } from "node:util";

import { chromium } from "playwright-core";

import { decode } from "./png.mjs";

export const COMMAND = process.env.TRANSLUCID ?? "translucid";
export const SCENE = join(import.meta.dirname, "scene.toml");
const ARGUMENTS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];
/** Graphics: none, or Chromium's own in software. */
const GRAPHICS = { false: ["--disable-gpu"], true: ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan"] };
/** Longest wait for anything, in milliseconds. */
const PATIENCE = 60_000;

const run = promisify(execFile);

/** Starts `translucid view` and reads the address that it prints. */
export async function serve(...args) {
    const server = spawn(COMMAND, ["view", "--no-open", ...args], { stdio: ["ignore", "pipe", "pipe"] });
    let complaint = "";
    server.stderr.on("data", (text) => (complaint += text));
    const ended = new Promise((resolve) => server.once("exit", resolve));
    const address = await new Promise((resolve, reject) => {
        createInterface({ input: server.stdout }).once("line", resolve);
        server.once("exit", (code) => reject(new Error(`translucid view ended with ${code}: ${complaint}`)));
        server.once("error", reject);
    });
    const stop = async () => {
        server.kill("SIGINT");
        await ended;
    };
    return { address, process: server, stop };
}

export const launch = ({ gpu = false, more = [] } = {}) =>
    chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...ARGUMENTS, ...GRAPHICS[gpu], ...more] });

/** A server and a browser for the tests of a file. */
export async function start(...args) {
    const server = await serve(...(args.length > 0 ? args : [SCENE]));
    const browser = await launch();
    const folder = await mkdtemp(join(tmpdir(), "translucid-view-"));
    after(async () => {
        await browser.close();
        await server.stop();
        await rm(folder, { recursive: true });
    });
    const open = async (options) => {
        const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
        const page = await context.newPage();
        const view = new View(page, server, folder);
        await view.load();
        return view;
    };
    return { server, browser, folder, open };
}

/** A page that is open. */
export class View {
    /** What the page's scripts threw or the browser refused. */
    complaints = [];

    constructor(page, server, folder) {
        this.page = page;
        this.server = server;
        this.folder = folder;
        page.setDefaultTimeout(PATIENCE);
        page.on("pageerror", (error) => this.complaints.push(error.stack));
        page.on("console", (message) => message.type() === "error" && this.complaints.push(message.text()));
    }

    async load() {
        await this.page.goto(this.server.address);
        await this.page.waitForFunction(() => window.translucidView?.lastFrame);
    }

    state() {
        return this.page.evaluate(() => window.translucidView.state);
    }

    /** Version of the state after everything that this page has asked for. */
    version() {
        return this.page.evaluate(() => Math.max(0, ...window.translucidView.sent.map(({ version }) => version ?? 0)));
    }

    /** Waits until all that was asked for, by this page or up to a version, is on the screen and finished. */
    async done(version = 0) {
        await this.page.waitForFunction((version) => {
            const { sent, painted, state, connected } = window.translucidView;
            if (!connected || !state || sent.some(({ isAnswered }) => !isAnswered)) return false;
            const asked = Math.max(version, ...sent.map(({ version }) => version ?? 0));
            if (state.version < asked) return false;
            const sides = !state.compare ? ["a"] : ["difference", "flip"].includes(state.view) ? ["map"] : ["a", "b"];
            return sides.every((side) => {
                const frame = painted.findLast((frame) => frame.side === side);
                return frame?.isLast && frame.edge === 1 && frame.version >= asked;
            });
        }, version);
    }

    /** The codes on a canvas. */
    async pixels(side = "a") {
        const { width, height, text } = await this.page.evaluate((side) => {
            const canvas = document.getElementById(`picture-${side}`);
            const { width, height } = canvas;
            const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
            let text = "";
            for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
            return { width, height, text: btoa(text) };
        }, side);
        return { width, height, codes: Buffer.from(text, "base64") };
    }

    /** What the browser saves at a link of the menu. */
    async save(kind) {
        const download = this.page.waitForEvent("download");
        await this.page.evaluate((id) => document.getElementById(id).click(), `save-${kind}`);
        return readFile(await (await download).path());
    }

    /** The picture that the command makes of the saved scene. */
    async byCommand() {
        const [scene, picture] = ["scene.toml", "picture.png"].map((name) => join(this.folder, name));
        await writeFile(scene, await this.save("scene"));
        await run(COMMAND, ["render", scene, "-o", picture]);
        return decode(await readFile(picture));
    }

    /** The page shows what the command makes of the saved scene, to the last bit. */
    async agrees(what) {
        await this.done();
        const [shown, made] = [await this.pixels((await this.state()).active === "b" ? "b" : "a"), await this.byCommand()];
        assert.deepEqual([shown.width, shown.height], [made.width, made.height], what);
        assert.equal(difference(shown.codes, made.codes), 0, `${what}: pixels that differ`);
    }

    /** Types a number and commits it. */
    async type(id, text) {
        const field = this.page.locator(`#${id}`);
        await reveal(field);
        await field.fill(String(text));
        await field.press("Enter");
    }

    async choose(id, value) {
        const menu = this.page.locator(`#${id}`);
        await reveal(menu);
        await menu.selectOption(String(value));
    }

    async check(id, on = true) {
        const box = this.page.locator(`#${id}`);
        await reveal(box);
        await box.setChecked(on, { force: true });
    }

    /** Chooses in a menu of commands, and waits for the answer. */
    async adds(kind) {
        await reveal(this.page.locator("#light-add"));
        await this.answered(() => this.page.locator("#light-add").selectOption(kind));
    }

    async click(id) {
        await this.page.locator(`#${id}`).click();
    }

    /** Clicks a button that sends a message, and waits until the page shows the state of its answer. */
    history(step) {
        return this.answered(() => this.click(step));
    }

    /** Does something that sends a message, and waits until the page shows the state of its answer. */
    async answered(act) {
        const before = await this.page.evaluate(() => window.translucidView.sent.at(-1)?.id ?? 0);
        await act();
        await this.page.waitForFunction((before) => {
            const { sent, state } = window.translucidView;
            return sent.at(-1)?.id > before && sent.every(({ isAnswered, version }) => isAnswered && state.version >= (version ?? 0));
        }, before);
    }

    /** Everything as the scene was loaded. */
    async reset() {
        await this.history("reset");
        await this.done();
    }
}

/** Opens the sections around a control. */
async function reveal(locator) {
    await locator.evaluate((element) => {
        const panel = element.closest("[role=tabpanel]");
        if (panel?.hidden) document.getElementById(panel.getAttribute("aria-labelledby")).click();
        for (let fold = element.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
    });
}

/**
 * Number of pixels that differ. A canvas keeps colors times alpha, so where something shows through they are compared
 * as such, to one code.
 */
export function difference(a, b) {
    let count = 0;
    for (let i = 0; i < a.length; i += 4) {
        const alpha = a[i + 3];
        const most = alpha === 255 ? 0 : 255;
        const isSame = (c) => Math.abs(a[i + c] - b[i + c]) * alpha <= most;
        if (alpha !== b[i + 3] || !(isSame(0) && isSame(1) && isSame(2))) count++;
    }
    return count;
}
