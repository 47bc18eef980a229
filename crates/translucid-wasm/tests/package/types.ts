// What the types allow and what they refuse: read by tsc, never run.

import init, { HalfSpace, Profile, TranslucidError, convert, cyclesMaterial, exportText, models, preset, slab, systems } from "translucid";

await init();
await init(new URL("https://example.org/translucid.wasm"));
await init(fetch("translucid.wasm"));

const jade = new Profile({ surfaceAlbedo: 0.6, mfp: 1.5 });
const one: number = jade.eval(1);
const many: Float64Array = jade.sample(new Float32Array(8));
const more: Float64Array = jade.tabulated().quantile([0.1, 0.5]);
const total: number = Profile.fromMedium({ sigmaA: 0.002, sigmaS: 2.19, model: "dipole" }).total;
Profile.fromTable({ r: [1, 2, 3, 4], reflectance: [4, 3, 2, 1] }).free();

const exact = new HalfSpace({ singleScatteringAlbedo: 0.9, configuration: "searchlight" });
const value: number = exact.total.value + exact.eval(1).error;
const errors: Float64Array = exact.enclosed([1, 2]).error;

const radius: number | number[] | undefined = convert("renderman", { dmfp: [20, 10, 5] }, {
    surfaceAlbedo: 0.8,
    to: ["cycles-burley", "arnold"],
    settings: { arnold: { scale: 1 } },
}).values["arnold"]?.["radius"];
const wall: number | number[] | undefined = convert("translucid", { mfp: 1 }, { surfaceAlbedo: 0.8, thin: 2, eta: 1.4, colorSpace: "acescg" })
    .values["openpbr"]?.["subsurface_color"];
const depth: number | number[] | undefined = slab({ color: [0.8, 0.5, 0.3], balance: 0.5, g: 0.2 }).values["slab"]?.["mfp in thicknesses"];
const keys: Record<string, unknown> = cyclesMaterial("RANDOM_WALK", { baseColor: [0.8, 0.5, 0.2], radius: 1, version: [5, 1] });
const text: string = exportText({ to: "wgsl", what: ["profile", "sampler"], model: "gaussians", preset: "skin1" });
const albedo: [number, number, number] = preset("skin1").surfaceAlbedo;
const names: string[] = [...models(), ...systems().map((system) => system.name)];
const error: Error = new TranslucidError("x");

// @ts-expect-error: two lengths
new Profile({ surfaceAlbedo: 0.6, mfp: 1, dmfp: 1 });
// @ts-expect-error: no length
new Profile({ surfaceAlbedo: 0.6 });
// @ts-expect-error: a name of Python's
new Profile({ surface_albedo: 0.6, mfp: 1 });
// @ts-expect-error: no model
new Profile({ model: "burley", surfaceAlbedo: 0.6, mfp: 1 });
// @ts-expect-error: two albedos
new HalfSpace({ surfaceAlbedo: 0.5, singleScatteringAlbedo: 0.5 });
// @ts-expect-error: images are made by the command
exportText({ to: "exr", what: "lut" });
// @ts-expect-error: no linear space
convert("translucid", { mfp: 1 }, { colorSpace: "srgb" });
// @ts-expect-error: no balance
slab({ color: 0.5 });
// @ts-expect-error: no radius
cyclesMaterial("BURLEY", { baseColor: 0.5 });
// @ts-expect-error: it cannot be set
jade.total = 1;

export { albedo, depth, error, errors, keys, many, more, names, one, radius, text, total, value, wall };
