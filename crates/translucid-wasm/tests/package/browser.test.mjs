// The package in a browser: exports in shaders of three.js and in bare WebGPU and WebGL, and examples/three, on a device
// without hardware.
//
// CHROMIUM is a browser (/usr/bin/chromium where it is not said).

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { after, test } from "node:test";

import { chromium } from "playwright-core";

import { forThree } from "./guide.mjs";

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm" };
const ROOT = join(import.meta.dirname, "../../../..");
const EXAMPLE = "/examples/three/";
const PAGE = `<!doctype html><title>translucid</title><script type="importmap">{ "imports": {
    "translucid": "/translucid/translucid.js",
    "three/webgpu": "/three/build/three.webgpu.js",
    "three/tsl": "/three/build/three.tsl.js"
} }</script>`;

const server = createServer(async (request, response) => {
    try {
        const path = normalize(new URL(request.url, "http://localhost").pathname);
        if (path === "/") return response.setHeader("content-type", "text/html").end(PAGE);
        if (path === "/favicon.ico") return response.writeHead(204).end();
        if (path === "/example.js") {
            return response.setHeader("content-type", TYPES[".js"]).end(`${forThree}\nexport { material };`);
        }
        // The example has the packages of these tests
        const isOfRoot = /^\/(examples|scenes)\//.test(path) && !path.startsWith(`${EXAMPLE}node_modules/`);
        const packages = join(import.meta.dirname, "node_modules", path.replace(`${EXAMPLE}node_modules`, ""));
        const bytes = await readFile(isOfRoot ? join(ROOT, path) : packages);
        response.setHeader("content-type", TYPES[extname(path)] ?? "text/plain").end(bytes);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: [
        "--no-sandbox",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        // WebGPU and WebGL by SwiftShader
        "--enable-unsafe-webgpu",
        "--use-webgpu-adapter=swiftshader",
        "--enable-features=Vulkan",
        "--enable-unsafe-swiftshader",
    ],
});
after(async () => {
    await browser.close();
    server.close();
});
const complaints = [];

/** Opens a page whose complaints are kept. */
async function open(path, options) {
    const page = await browser.newPage(options);
    page.setDefaultTimeout(60_000);
    page.on("pageerror", (error) => complaints.push(error.message));
    page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
    await page.goto(`http://127.0.0.1:${server.address().port}${path}`);
    return page;
}
const page = await open("/");
await page.evaluate(async () => (await import("translucid")).default());

/** Greatest relative difference. */
const difference = (found, wanted) => Math.max(...found.map((x, i) => Math.abs(x / wanted[i] - 1)));

test("wgslFn of three.js takes an export, whose functions give the profile's values", async () => {
    const found = await page.evaluate(async () => {
        const { Profile, exportText } = await import("translucid");
        const { WebGPURenderer } = await import("three/webgpu");
        const { Fn, float, instanceIndex, instancedArray, wgsl, wgslFn } = await import("three/tsl");
        const renderer = new WebGPURenderer();
        await renderer.init();
        if (!renderer.backend.isWebGPUBackend) throw new Error("there is no WebGPU");

        const burley = wgsl(exportText({ to: "wgsl", what: ["profile", "sampler"] }));
        const radius = wgslFn("fn radius(u: f32, d: f32) -> f32 { return burley_sample(u, d); }", [burley]);
        const light = wgslFn("fn light(a: f32, r: f32, d: f32) -> f32 { return burley_eval(a, r, d); }", [burley]);
        const width = wgslFn(
            "fn width(l: f32, a: f32) -> f32 { return burley_width(l, burley_scale_mfp_diffuse(a)); }",
            [burley],
        );

        const count = 4096;
        const u = Float32Array.from({ length: count }, (_, i) => (i + 0.5) / count);
        const [numbers, radii, lights] = [u, count, count].map((content) => instancedArray(content, "float"));
        const [albedo, mfp] = [float(0.6), float(1.5)];
        const kernel = Fn(() => {
            const d = width({ l: mfp, a: albedo }).toVar();
            const r = radius({ u: numbers.element(instanceIndex), d }).toVar();
            radii.element(instanceIndex).assign(r);
            lights.element(instanceIndex).assign(light({ a: albedo, r, d }));
        })().compute(count);
        await renderer.computeAsync(kernel);
        const read = async (buffer) => [...new Float32Array(await renderer.getArrayBufferAsync(buffer.value))];
        const given = { radii: await read(radii), lights: await read(lights) };
        const jade = new Profile({ model: "normalized-diffusion", surfaceAlbedo: 0.6, mfp: 1.5 });
        return { given, radii: [...jade.sample(u)], lights: [...jade.eval(given.radii)] };
    });
    assert.equal(found.given.radii.length, 4096);
    const errors = [difference(found.given.radii, found.radii), difference(found.given.lights, found.lights)];
    console.log(`of radii ${errors[0].toExponential(1)}, of R ${errors[1].toExponential(1)}`);
    assert.ok(errors[0] < 1e-5 && errors[1] < 1e-5, `${errors}`);
});

test("the guide's material has the profile's values in every pixel", async () => {
    const error = await page.evaluate(async () => {
        const { Profile } = await import("translucid");
        const three = await import("three/webgpu");
        const { material } = await import("/example.js");
        const renderer = new three.WebGPURenderer();
        await renderer.init();
        const size = 32; // Rows of 256 bytes or a multiple come without padding.
        const target = new three.RenderTarget(size, size, { type: three.FloatType });
        renderer.setRenderTarget(target);
        const scene = new three.Scene();
        scene.add(new three.Mesh(new three.PlaneGeometry(2, 2), material));
        await renderer.renderAsync(scene, new three.OrthographicCamera(-1, 1, 1, -1, -1, 1));
        const pixels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, size, size);
        const jade = new Profile({ model: "normalized-diffusion", surfaceAlbedo: 0.6, mfp: 1.5 });
        let error = 0;
        for (let y = 0; y < size; y++) {
            for (let x = 0; x < size; x++) {
                const r = (10 * Math.hypot(x - (size - 1) / 2, y - (size - 1) / 2)) / size;
                error = Math.max(error, Math.abs(pixels[4 * (y * size + x)] / jade.eval(r) - 1));
            }
        }
        return error;
    });
    console.log(`of pixels ${error.toExponential(1)}`);
    assert.ok(error < 1e-4, `${error}`);
});

test("every WGSL text compiles", async () => {
    const faults = await page.evaluate(async () => {
        const { exportText, models } = await import("translucid");
        const device = await (await navigator.gpu.requestAdapter()).requestDevice();
        const faults = [];
        const check = async (options) => {
            const code = exportText({ to: "wgsl", ...options });
            const { messages } = await device.createShaderModule({ code }).getCompilationInfo();
            faults.push(...messages.map(({ message, lineNum }) => `${JSON.stringify(options)} ${lineNum}: ${message}`));
        };
        const preset = "skin1";
        for (const model of models()) await check({ what: ["profile", "sampler"], model, preset });
        await check({ what: ["disk", "kernel"], model: "exact", preset });
        await check({ what: ["probe", "fresnel", "inversion"], eta: 1.4, g: 0.8 });
        return faults;
    });
    assert.deepEqual(faults, []);
});

test("GLSL texts compile in WebGL 2", async () => {
    const faults = await page.evaluate(async () => {
        const { exportText, models } = await import("translucid");
        const gl = document.createElement("canvas").getContext("webgl2");
        const check = (options) => {
            const text = exportText({ to: "glsl", ...options });
            const shader = gl.createShader(gl.FRAGMENT_SHADER);
            gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}\nvoid main() {}`);
            gl.compileShader(shader);
            const is = gl.getShaderParameter(shader, gl.COMPILE_STATUS);
            return is ? [] : [`${JSON.stringify(options)}: ${gl.getShaderInfoLog(shader)}`];
        };
        const all = models().map((model) => ({ what: ["profile", "sampler"], model, preset: "skin1" }));
        return [...all, { what: ["probe", "fresnel"], eta: 1.4 }].flatMap(check);
    });
    assert.deepEqual(faults, []);
});

test("in examples/three light goes beyond the edges of shadows, the farther the longer the mean free path", async () => {
    const example = await open(`${EXAMPLE}index.html?ratio=1`, { viewport: { width: 500, height: 260 } });
    /** Linear values of red, pixel by pixel, once the page has drawn what `act` asks for. */
    const drawn = async (act) => {
        await act();
        await example.waitForFunction(() => document.body.dataset.drawn);
        const png = (await example.locator("#view").screenshot()).toString("base64");
        return example.evaluate(async (png) => {
            delete document.body.dataset.drawn;
            const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
            const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
            context.drawImage(image, 0, 0);
            const { data } = context.getImageData(0, 0, image.width, image.height);
            return Array.from({ length: data.length / 4 }, (_, i) => (data[4 * i] / 255) ** 2.2);
        }, png);
    };
    const slide = (mfp) => () =>
        example.locator("#mfp input").evaluateAll((inputs, mfp) => {
            for (const input of inputs) {
                input.value = Math.log10(mfp);
                input.dispatchEvent(new Event("input"));
            }
        }, mfp);
    await drawn(() => example.selectOption("#preset", "marble"));
    const [short, long] = [await drawn(slide(0.3)), await drawn(slide(3))];
    const none = await drawn(() => example.uncheck("#scattering"));
    assert.equal(await example.textContent("#message"), "");

    // Pixels of the bust, since the background is the same in all pictures, that are dark without scattering
    const isOfBust = (i) => none[i] !== short[i] || none[i] !== long[i];
    const dark = none.flatMap((light, i) => (light < 0.03 && isOfBust(i) ? [i] : []));
    const mean = (picture) => dark.reduce((sum, i) => sum + picture[i], 0) / dark.length;
    const found = [none, short, long].map(mean);
    console.log(`in ${dark.length} dark pixels: ${found.map((light) => light.toFixed(4)).join(", ")}`);
    assert.ok(dark.length > 100 && found[1] > 1.2 * found[0] && found[2] > 1.5 * found[1], `${found}`);
    await example.close();
});

test("the pages complain of nothing", () => assert.deepEqual(complaints, []));
