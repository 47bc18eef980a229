// The package in Node.js: its values are those of the command, bit for bit, and its messages name what is wrong.
//
// TRANSLUCID is the built command.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { gzipSync } from "node:zlib";

import init, * as translucid from "translucid";

import { forNode } from "./guide.mjs";

const { HalfSpace, Profile, TranslucidError, convert, cyclesMaterial, exportText, slab } = translucid;
const COMMAND = process.env.TRANSLUCID ?? "translucid";
const PLACE = new URL(import.meta.resolve("translucid/translucid.wasm"));
/** Most bytes of the module that travel. */
const MOST_BYTES = 800_000;

const run = (...words) => execFileSync(COMMAND, words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });

/** Lines of a table, as lists of cells. */
const rows = (text) => text.trimEnd().split("\n").map((line) => line.split(","));

/** A column of a table by its name, as numbers. */
function column(text, name) {
    const [head, ...lines] = rows(text.replace(/^#.*\n/gm, ""));
    const place = head.indexOf(name);
    assert.notEqual(place, -1, `${name} is none of ${head}`);
    return lines.map((cells) => Number(cells[place]));
}

const refused = (f, message) =>
    assert.throws(f, (error) => {
        assert.ok(error instanceof TranslucidError, error);
        if (message instanceof RegExp) assert.match(error.message, message);
        else assert.equal(error.message, message);
        return true;
    });

test("nothing works before the module is loaded, which may be tried again", async () => {
    refused(() => translucid.models(), "the module is not loaded: await init() first");
    await assert.rejects(init(Promise.reject(new Error("no network"))), /no network/);
    await assert.rejects(init(new Response("", { status: 404 })), /status 404/);
    // A server that has its page for everything
    const page = new Response("<!doctype html>", { headers: { "content-type": "text/html" } });
    await assert.rejects(init(page), /no WebAssembly module: status 200, text\/html.*optimizeDeps/);
    await assert.rejects(init(new Response("")), /no WebAssembly module/);
    await Promise.all([init(), init()]);
    assert.equal(translucid.version(), JSON.parse(await readFile(new URL("package.json", PLACE))).version);
});

test("the module imports nothing and is small", async () => {
    const bytes = await readFile(PLACE);
    assert.deepEqual(WebAssembly.Module.imports(await WebAssembly.compile(bytes)), []);
    const size = gzipSync(bytes, { level: 9 }).length;
    console.log(`translucid.wasm: ${bytes.length} bytes, ${size} with gzip`);
    // What is built fast for tests is larger than what is published
    const most = process.env.WASM_PROFILE === "wasm-quick" ? 2 * MOST_BYTES : MOST_BYTES;
    assert.ok(size < most, `${size} bytes`);
});

test("models are those of the types and of the command", async () => {
    const types = await readFile(new URL("translucid.d.ts", PLACE), "utf8");
    const named = /export type Model =([^;]*);/.exec(types)[1].match(/[\w-]+/g);
    assert.deepEqual(translucid.models(), named);
    const printed = run("models");
    for (const model of named) assert.match(printed, new RegExp(`^${model} `, "m"));
});

test("profiles of every model have the command's bits", () => {
    const radii = [1e-3, 0.05, 0.3, 1, 4, 20];
    for (const model of translucid.models()) {
        for (const [length, configuration] of [["mfp", "diffuse"], ["dmfp", "searchlight"]]) {
            const profile = new Profile({ model, surfaceAlbedo: 0.7, [length]: 1.3, configuration });
            const words = ["--model", model, "--surface-albedo", "0.7", `--${length}`, "1.3"];
            const table = run("profile", ...words, "--configuration", configuration, "--at", radii.join());
            assert.deepEqual([...profile.eval(radii)], column(table, "reflectance"), `${model} ${configuration}`);
            assert.deepEqual([...profile.enclosed(radii)], column(table, "enclosed"), `${model} ${configuration}`);
            profile.free();
        }
    }
});

test("media and samples have the command's bits", () => {
    const medium = Profile.fromMedium({ sigmaA: 0.0021, sigmaS: 2.19, model: "better-dipole", eta: 1.5 });
    const words = ["--sigma-a", "0.0021", "--sigma-s", "2.19", "--model", "better-dipole", "--eta", "1.5"];
    assert.deepEqual([...medium.eval([0.5, 2])], column(run("profile", ...words, "--at", "0.5,2"), "reflectance"));
    const r = Array.from({ length: 200 }, (_, i) => 0.01 * 1.04 ** i);
    const truth = new Profile({ surfaceAlbedo: 0.8, mfp: 1 });
    const sampled = Profile.fromTable({ r, reflectance: truth.eval(r), enclosed: truth.enclosed(r) });
    assert.ok(Math.abs(sampled.total - 0.8) < 1e-3);
    assert.ok(Math.abs(truth.tabulated().cdf(2) - truth.cdf(2)) < 1e-5);
});

test("samples are those of the density, and numbers go in and come out as they are", () => {
    const jade = new Profile({ surfaceAlbedo: 0.6, mfp: 1.5 });
    assert.ok(Math.abs(jade.cdf(jade.quantile(0.5)) - 0.5) < 1e-12);
    const u = Float32Array.from({ length: 1000 }, (_, i) => (i + 0.5) / 1000);
    const radii = jade.sample(u);
    assert.ok(radii instanceof Float64Array && radii.length === 1000);
    const weights = jade.eval(radii).map((value, i) => value / jade.pdfArea(radii)[i]);
    assert.ok(weights.every((weight) => Math.abs(weight - 0.6) < 1e-12));
    const below = radii.filter((r) => r < 1).length / 1000;
    assert.ok(Math.abs(below - jade.cdf(1)) < 3e-3, `${below} ${jade.cdf(1)}`);
    assert.equal(jade.eval([]).length, 0);
    assert.equal(jade.eval(Infinity), 0);
    assert.ok(jade.eval(0) > 1e300 && jade.eval(0) <= Number.MAX_VALUE);
    // 2 pi r R(r) / A
    assert.ok(Math.abs(jade.pdf(2) / ((4 * Math.PI * jade.eval(2)) / 0.6) - 1) < 1e-14);
});

test("the exact half space has the command's bits, and its errors", () => {
    for (const [options, ...words] of [
        [{ singleScatteringAlbedo: 0.9, configuration: "searchlight" }, "--single-scattering-albedo", "0.9", "--configuration", "searchlight"],
        [{ surfaceAlbedo: 0.5 }, "--surface-albedo", "0.5"],
        [{ surfaceAlbedo: 0.8, eta: 1.4, mfp: 2 }, "--surface-albedo", "0.8", "--eta", "1.4", "--mfp", "2"],
    ]) {
        const exact = new HalfSpace(options);
        const table = run("reference", ...words, "--at", "0.1,1,5");
        const found = exact.eval([0.1, 1, 5]);
        assert.deepEqual([...found.value], column(table, "reflectance"));
        assert.deepEqual([...found.error], column(table, "standard_error"));
        const { value, error } = exact.enclosed(1);
        assert.ok(Math.abs(value + exact.beyond(1).value - exact.total.value) < 1e-9 && error < 1e-6);
        if (options.surfaceAlbedo) assert.ok(Math.abs(exact.total.value - options.surfaceAlbedo) < 1e-7);
    }
});

test("conversions are the command's", () => {
    const { values, numbers, notes } = convert("translucid", { mfp: [20, 10, 5] }, { surfaceAlbedo: 0.8, unit: "mm" });
    const table = run("convert", "--from", "translucid:mfp=20,10,5", "--surface-albedo", "0.8");
    assert.deepEqual(numbers.map((number) => number.value), column(table, "value"));
    assert.ok(notes.every((note) => typeof note === "string"));
    for (const of of Object.values(values)) {
        for (const value of Object.values(of)) assert.ok(typeof value === "number" || value.length === 3);
    }
    const cycles = convert("renderman", { dmfp: 20 }, { surfaceAlbedo: 0.8, to: "cycles-burley", settings: {} });
    assert.equal(cycles.values["cycles-burley"].subsurface_scale, 2.999247970026346);
    assert.ok(translucid.systems().some((system) => system.name === "pbrt" && system.unit));
    refused(() => convert("rendermann", { dmfp: 20 }), /rendermann.*did you mean/);
    refused(() => convert("renderman", { dmfp: "a" }), /^source renderman:dmfp is "a", but must be a number/);
});

test("materials of Cycles are what the conversion says", () => {
    const burley = cyclesMaterial("BURLEY", { baseColor: [0.8, 0.5, 0.2], radius: [12, 6, 3] });
    const of = { surfaceAlbedo: [0.8, 0.5, 0.2], to: "translucid" };
    const { mfp } = convert("cycles-burley", { subsurface_radius: [4, 2, 1], subsurface_scale: 3 }, of).values.translucid;
    burley.subsurface_radius_scale.forEach((share, i) => assert.ok(Math.abs((share * burley.subsurface_radius) / mfp[i] - 1) < 1e-14));
    assert.deepEqual(burley.subsurface_color, [0.8, 0.5, 0.2]);
    const walk = cyclesMaterial("RANDOM_WALK", { baseColor: 0.8, radius: 1, version: [5, 1] });
    assert.deepEqual(walk, cyclesMaterial("RANDOM_WALK_LEGACY", { baseColor: 0.8, radius: 1 }));
    assert.deepEqual([walk.subsurface_model, walk.subsurface_flights], ["random-walk-rough", 256]);
    refused(() => cyclesMaterial("CUBIC", { baseColor: 1, radius: 1 }), /^method is 'CUBIC', but must be one of BURLEY, /);
    refused(() => cyclesMaterial("BURLEY", { baseColor: 1, radius: [1, -2, 1] }), "radius[1] is -2, but must be finite and at least 0");
});

test("color spaces and thin walls are the command's, and a wall leads back to its slab", () => {
    const material = [{ mfp: [0.3, 0.2, 0.1] }, { surfaceAlbedo: [0.8, 0.6, 0.3] }];
    const words = ["convert", "--from", "translucid:mfp=0.3,0.2,0.1", "--surface-albedo", "0.8,0.6,0.3"];
    for (const [options, ...more] of [
        [{ colorSpace: "acescg" }, "--color-space", "acescg"],
        [{ thin: 0.2, g: 0.5, eta: 1.4 }, "--thin", "0.2", "--g", "0.5", "--eta", "1.4"],
        [{ thin: 0.2, colorSpace: "lin_rec2020" }, "--thin", "0.2", "--color-space", "lin_rec2020"],
    ]) {
        const { numbers } = convert("translucid", material[0], { ...material[1], ...options });
        const found = numbers.map(({ value }) => value);
        const expected = column(run(...words, ...more), "value");
        assert.equal(found.length, expected.length);
        found.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) <= 1e-9 * Math.max(1, Math.abs(expected[i])), `${JSON.stringify(options)} ${i}`));
    }
    const { values } = slab({ color: 0.7, balance: [0.3, 0.5, 0.6], thin: 2 });
    const back = convert("translucid", { mfp: values.slab.mfp }, { surfaceAlbedo: values.slab.surface_albedo, thin: 2 }).values.slab;
    back.transmittance.forEach((value, i) => assert.ok(Math.abs(value - 0.7 * [0.3, 0.5, 0.6][i]) < 1e-4, `${value}`));
});

test("wrong conversions are refused in one line, by name", () => {
    const plain = (options, parameters = { mfp: 1 }) => () => convert("translucid", parameters, { surfaceAlbedo: 0.5, ...options });
    for (const [f, message] of [
        [plain({ colorSpace: "srgb" }), /^colorSpace is "srgb", but must be one of lin_rec709, .*did you mean lin_rec709\?/],
        [plain({ fromColorSpace: "acescg" }), /^fromColorSpace is given without colorSpace$/],
        [plain({ g: 0.5 }), /^g is given without thin/],
        [plain({ thin: 1, to: "hdrp" }), /^thin and to are given, but only one/],
        [plain({ surfaceAlbedo: 1.2 }), "surfaceAlbedo is 1.2, but must be in [0, 1]"],
        [plain({}, { mfp: -1 }), /^source translucid:mfp is -1, but must be/],
        [() => convert("gltf", { attenuationDistance: 1 }, { surfaceAlbedo: 0.5 }), /^source gltf:attenuationColor is missing/],
        [() => slab({ color: 1.2, balance: 0.5 }), "color is 1.2, but must be in (0, 1]"],
        [() => slab({ color: 0.9, balance: 1, eta: 1.5 }), /^balance is 1, but must be less: no slab/],
        [() => slab({ color: 0.5 }), "color needs balance beside it"],
    ]) {
        refused(f, message);
    }
});

test("presets are the command's", () => {
    const all = translucid.presets();
    const listed = run("render", "--preset", "list");
    for (const { name } of all) assert.ok(listed.includes(name), name);
    const skin = translucid.preset("Skin 1");
    assert.deepEqual([skin.eta, skin.mfp.map((x) => x.toFixed(4))], [1.3, ["1.2953", "0.9524", "0.6711"]]);
    refused(() => translucid.preset("skinn1"), /did you mean "skin1"/);
});

test("exports are the command's texts, letter by letter", () => {
    for (const [options, ...words] of [
        [{ to: "wgsl", what: ["profile", "sampler"] }, "--to", "wgsl", "--what", "profile,sampler"],
        [{ to: "glsl", what: "sampler", model: "normalized-diffusion-refined" }, "--to", "glsl", "--what", "sampler", "--model", "normalized-diffusion-refined"],
        [{ to: "hlsl", what: "disk", preset: "skin1", unit: "cm", taps: 9 }, "--to", "hlsl", "--what", "disk", "--preset", "skin1", "--unit", "cm", "--taps", "9"],
        [{ to: "msl", what: "profile", model: "exact", surfaceAlbedo: 0.8, dmfp: [1.3, 0.9, 0.7] }, "--to", "msl", "--what", "profile", "--model", "exact", "--surface-albedo", "0.8", "--dmfp", "1.3,0.9,0.7"],
        [{ to: "osl", what: "inversion", configuration: "searchlight", g: 0.8, eta: 1.4 }, "--to", "osl", "--what", "inversion", "--configuration", "searchlight", "--g", "0.8", "--eta", "1.4"],
        [{ to: "c", what: "lut", preset: "skin1", size: [8, 4], mostCurvature: 0.5 }, "--to", "c", "--what", "lut", "--preset", "skin1", "--size", "8x4", "--most-curvature", "0.5"],
        [{ to: "cpp", what: ["probe", "fresnel"] }, "--to", "cpp", "--what", "probe,fresnel"],
        [{ to: "materialx", what: "material", preset: "marble" }, "--to", "materialx", "--what", "material", "--preset", "marble"],
    ]) {
        assert.equal(exportText(options), run("export", ...words));
    }
    refused(() => exportText({ to: "exr", what: "lut", preset: "skin1" }), "to is exr, but must be a text: WebAssembly makes no images");
    refused(() => exportText({ to: "glsl", what: "disk" }), /^what is disk, but must be/);
    refused(() => exportText({ to: "hlsl", what: "disk", preset: "skin1", taps: 2.5 }), "taps is 2.5, but must be a whole number");
    refused(() => exportText({ to: "glsl", what: "profile", surfaceAlbedo: 0.5 }), /^a material has/);
    refused(() => exportText({ to: "glsl", what: "profile", preset: "skin1", mfp: 1 }), /^a preset has its own/);
    refused(() => exportText({ to: "glsl", what: "profile", surfaceAlbedo: [0.5, 2, 0.5], mfp: 1 }), /^surfaceAlbedo is 2/);
});

test("arguments that cannot be used are refused by name", () => {
    const jade = new Profile({ surfaceAlbedo: 0.6, mfp: 1.5 });
    for (const [f, message] of [
        [() => new Profile({ surfaceAlbedo: 1.2, mfp: 1 }), "surfaceAlbedo is 1.2, but must be in [0, 1]"],
        [() => new Profile({ surfaceAlbedo: 0.5, mfp: -1 }), /^mfp is -1, but must be/],
        [() => new Profile({ surfaceAlbedo: NaN, mfp: 1 }), "surfaceAlbedo is NaN, but must be in [0, 1]"],
        [() => new Profile({ surfaceAlbedo: "half", mfp: 1 }), 'surfaceAlbedo is "half", but must be a number'],
        [() => new Profile({ surfaceAlbedo: 0.5 }), "give one of mfp and dmfp"],
        [() => new Profile({ mfp: 1 }), "surfaceAlbedo is missing"],
        [() => new Profile({ surface_albedo: 0.5, surfaceAlbedo: 0.5, mfp: 1 }), /no option "surface_albedo" \(did you mean "surfaceAlbedo"/],
        [() => new Profile({ model: "burley", surfaceAlbedo: 0.5, mfp: 1 }), /^model is "burley", but must be one of/],
        [() => new Profile({ model: "gaussians", surfaceAlbedo: 0.5, mfp: 1, eta: 1.4 }), /^eta is 1.4, but must be/],
        [() => Profile.fromMedium({ sigmaA: -1, sigmaS: 1 }), /^sigmaA is -1, but must be/],
        [() => Profile.fromTable({ r: [1, 2, 3, 4], reflectance: [4, 3, 2] }), "reflectance has 3 numbers, but must have 4, as r has"],
        [() => Profile.fromTable({ r: [1, 2, 3, 4], reflectance: [4, -3, 2, 1] }), /^reflectance is -3/],
        [() => jade.eval(-1), "r is -1, but must be at least 0"],
        [() => jade.eval([0, NaN]), "r[1] is NaN, but must be at least 0"],
        [() => jade.sample([0.5, 2]), "u[1] is 2, but must be in [0, 1]"],
        [() => Profile.fromTable({ r: [1, 1, 3, 4], reflectance: [4, 3, 2, 1] }), /^r is 1, but must be .*greater than the one/],
        [() => new Profile(), "surfaceAlbedo is missing"],
        [() => new Profile(null), "options is null, but must be an object"],
        [() => new HalfSpace({ surfaceAlbedo: 0.5, eta: 5 }), "eta is 5, but must be in [0.5, 3]"],
        [() => new HalfSpace({ surfaceAlbedo: 0.5, incidenceAngle: 45 }), /^there is no option "incidenceAngle"/],
        [() => new HalfSpace({ singleScatteringAlbedo: 0 }), /^singleScatteringAlbedo is 0, but must be/],
        [() => new HalfSpace({}), "give one of surfaceAlbedo and singleScatteringAlbedo"],
    ]) {
        refused(f, message);
    }
    // Nor do they harm what follows
    refused(() => jade.eval({ length: 5e8 }), "eval is given 500000000 numbers, but takes at most 50000000 at a time");
    refused(() => jade.eval({ length: -1 }), "eval is given -1 numbers, but takes at most 50000000 at a time");
    assert.ok(jade.eval(1) > 0);
    assert.throws(() => jade.eval("1"), TypeError);
    assert.throws(() => jade.eval(), TypeError);
    jade.free();
    jade.free();
    refused(() => jade.eval(1), "this Profile was freed");
});

test("a place that was freed is used again, and thousands fit", () => {
    const profiles = Array.from({ length: 3000 }, (_, i) => new Profile({ surfaceAlbedo: i / 3000, mfp: 1 }));
    profiles.filter((_, i) => i % 2).forEach((profile) => profile.free());
    const more = Array.from({ length: 1500 }, () => new Profile({ surfaceAlbedo: 0.25, mfp: 1 }));
    assert.ok(more.every((profile) => profile.total === 0.25));
    assert.ok(profiles.every((profile, i) => i % 2 || profile.total === i / 3000));
    // More numbers than the module's first memory holds
    assert.equal(more[0].eval(new Float64Array(3_000_000).fill(1)).length, 3_000_000);
});

test("the guide's example runs, and its comments hold", async () => {
    const place = new URL("node_modules/.example.mjs", import.meta.url);
    await writeFile(place, `${forNode}\nexport { error, radius, value, weights };\n`);
    const { error, radius, value, weights } = await import(place);
    assert.ok(weights.every((weight) => Math.abs(weight - 0.6) < 1e-12));
    assert.ok(Math.abs(value / new Profile({ surfaceAlbedo: 0.6, mfp: 1.5 }).eval(1) - 1) < 0.01 && error < 1e-9);
    assert.deepEqual(radius.map((x) => x.toFixed(2)), ["1.00", "0.48", "0.26"]);
});
