/**
 * Subsurface scattering: reflectance profiles, the exact half space, materials in the numbers of other systems, and
 * profiles as shader code. Await {@link init} before all else.
 *
 * Lengths are in any one unit that you keep to. Every function throws a {@link TranslucidError} whose message has the
 * value found and the values allowed.
 */

/** Loads the WebAssembly module: by default `translucid.wasm` beside this file. Loads once, however often it is called. */
export default function init(source?: Source | Promise<Source>): Promise<void>;

/** Where the module comes from: an address, a response, its bytes, or itself. */
export type Source = string | URL | Request | Response | BufferSource | WebAssembly.Module;

/** An argument that cannot be used. */
export class TranslucidError extends Error {}

/** Models of profiles. */
export type Model =
    | "normalized-diffusion"
    | "normalized-diffusion-refined"
    | "normalized-diffusion-oblique"
    | "dipole"
    | "better-dipole"
    | "directional-dipole"
    | "quantized-diffusion"
    | "photon-beam-diffusion"
    | "gaussians"
    | "exact";

/** How light enters: a pencil beam along the normal, or at a point from all directions. */
export type Configuration = "searchlight" | "diffuse";

/** One length of a material: its mean free path in the volume, or the diffuse one on the surface. */
export type Length<T = number> = { mfp: T; dmfp?: undefined } | { dmfp: T; mfp?: undefined };

/** Looks of a translucent material. */
export type Appearance = Length & {
    /** By default "normalized-diffusion-refined". */
    model?: Model;
    /** Surface albedo A, the share of the light that leaves again, in [0, 1]. */
    surfaceAlbedo: number;
    /** Mean cosine of the phase function, in (-1, 1), by default 0; models without one take 0 only. */
    g?: number;
    /** Relative index of refraction, inside over outside, by default 1; models without a boundary take 1 only. */
    eta?: number;
    /** By default "diffuse" with an mfp and "searchlight" with a dmfp, the fits that renderers use. */
    configuration?: Configuration;
};

/** A medium by its coefficients, in the inverse of the unit of radii. */
export interface Medium {
    /** By default "normalized-diffusion-refined". */
    model?: Model;
    /** Absorption coefficient, at least 0. */
    sigmaA: number;
    /** Scattering coefficient, at least 0. */
    sigmaS: number;
    /** Mean cosine of the phase function, in (-1, 1), by default 0. */
    g?: number;
    /** Relative index of refraction, inside over outside, by default 1. */
    eta?: number;
    /** By default "diffuse". */
    configuration?: Configuration;
}

/** Samples that somebody measured or simulated. */
export interface Samples {
    /** At least four radii, greater than 0, rising. */
    r: ArrayLike<number>;
    /** R(r), at least 0, falling towards the end. */
    reflectance: ArrayLike<number>;
    /** Energy within the radii, if it is known; it is then kept. */
    enclosed?: ArrayLike<number>;
}

/**
 * A reflectance profile R(r): the light that leaves a flat surface at the distance r from the point where one unit of
 * flux entered, per area.
 *
 * Methods take a number and return a number, or take numbers and return an array.
 */
export class Profile {
    constructor(appearance: Appearance);
    /** The profile of a medium. */
    static fromMedium(medium: Medium): Profile;
    /** The profile through samples. */
    static fromTable(samples: Samples): Profile;
    /** The profile as a table, for many samples of models without a closed form: off by some 1e-5 of the cdf at most. */
    tabulated(): Profile;
    /** All the energy that leaves: the surface albedo. */
    readonly total: number;
    /** R(r) for radii, at least 0, in the inverse square of their unit; finite at r = 0, too. */
    eval(r: number): number;
    eval(r: ArrayLike<number>): Float64Array;
    /** Density of radii per length: 2πr R(r) / A. */
    pdf(r: number): number;
    pdf(r: ArrayLike<number>): Float64Array;
    /** Density of points per area: R(r) / A. */
    pdfArea(r: number): number;
    pdfArea(r: ArrayLike<number>): Float64Array;
    /** Share of the light that leaves within r, in [0, 1]. */
    cdf(r: number): number;
    cdf(r: ArrayLike<number>): Float64Array;
    /** Energy that leaves within r. */
    enclosed(r: number): number;
    enclosed(r: ArrayLike<number>): Float64Array;
    /** Energy that leaves beyond r, with the digits of a large r. */
    beyond(r: number): number;
    beyond(r: ArrayLike<number>): Float64Array;
    /** Radius within which the share u of the light leaves, u in [0, 1]. */
    quantile(u: number): number;
    quantile(u: ArrayLike<number>): Float64Array;
    /** Radius of the density `pdf` for a random number u in [0, 1). It need not rise with u. */
    sample(u: number): number;
    sample(u: ArrayLike<number>): Float64Array;
    /** Frees its memory at once; without it that happens when the object is collected. */
    free(): void;
}

/** A number with an estimate of its greatest numerical error. */
export interface Estimate {
    value: number;
    error: number;
}

/** Numbers with estimates of their greatest numerical errors. */
export interface Estimates {
    value: Float64Array;
    error: Float64Array;
}

/** A half space of isotropic scatterers. */
export type HalfSpaceOptions = (
    | { surfaceAlbedo: number; singleScatteringAlbedo?: undefined }
    | { singleScatteringAlbedo: number; surfaceAlbedo?: undefined }
) & {
    /** Mean free path, in [1e-100, 1e100], by default 1. */
    mfp?: number;
    /** Relative index of refraction, inside over outside, in [0.5, 3], by default 1. */
    eta?: number;
    /** By default "diffuse". */
    configuration?: Configuration;
};

/** The exact solution of a half space of isotropic scatterers. One with a boundary takes a second or more to make. */
export class HalfSpace {
    constructor(options: HalfSpaceOptions);
    /** The surface albedo. */
    readonly total: Estimate;
    /** R(r) per unit of flux that has entered. */
    eval(r: number): Estimate;
    eval(r: ArrayLike<number>): Estimates;
    /** Energy that leaves within r. */
    enclosed(r: number): Estimate;
    enclosed(r: ArrayLike<number>): Estimates;
    /** Energy that leaves beyond r, with the digits of a large r. */
    beyond(r: number): Estimate;
    beyond(r: ArrayLike<number>): Estimates;
    /** Frees its memory at once; without it that happens when the object is collected. */
    free(): void;
}

/** A number, or three for red, green and blue. */
export type Channels = number | ArrayLike<number>;

export type Unit = "mm" | "cm" | "m";

/** Linear color spaces by the names of MaterialX. */
export type LinearSpace = "lin_rec709" | "acescg" | "lin_displayp3" | "lin_rec2020" | "lin_adobergb";

/** A slab between air, beside its thickness. */
export interface SlabOptions {
    /** Thickness of the slab. */
    thin?: number;
    /** Mean cosine of its phase function, in [-0.95, 0.95], by default 0. */
    g?: number;
    /** Its index of refraction, in [1, 3], by default 1. */
    eta?: number;
}

/**
 * With `thin` the conversion has, in place of the systems' numbers, the light of the "slab" of that thickness, in `unit`, and
 * the thin-walled surfaces that stand for it, with their errors.
 */
export interface ConvertOptions extends SlabOptions {
    /** Surface albedo as the source system is told it; not for a system whose coefficients determine it. */
    surfaceAlbedo?: Channels;
    /** Unit of lengths in the scene that the material comes from, by default "mm", for systems without one of their own. */
    unit?: Unit;
    /** Unit of lengths in the scene that it goes to, by default the same. */
    toUnit?: Unit;
    /** Systems to convert to, by default all. */
    to?: string | readonly string[];
    /** Factors and distances of those systems that are to have a value: `{ renderman: { unitLength: 1 } }`. */
    settings?: Record<string, Record<string, Channels>>;
    /** How light enters in the fit between the width of a profile and a mean free path, by default "diffuse". */
    configuration?: Configuration;
    /**
     * Linear color space of the numbers, by default that of the material. Each new channel is the medium nearest to the mixture
     * of old channels that it is; "color space" has the shares of the light that leaves at another radius.
     */
    colorSpace?: LinearSpace;
    /** Linear color space of the material's numbers, by default "lin_rec709". */
    fromColorSpace?: LinearSpace;
}

/** A number of a material in a system. */
export interface ConvertedNumber {
    system: string;
    parameter: string;
    channel: "all" | "r" | "g" | "b";
    value: number;
    /** Empty for numbers without one. */
    unit: string;
    /** What is the same on both sides: "surface_albedo", "d", the profile's width, or "mfp"; empty where nothing is. */
    equal: string;
    /** The code or the document that the rule was read in. */
    source: string;
}

export interface Conversion {
    /** `values[system][parameter]`: one number, or red, green and blue. */
    values: Record<string, Record<string, number | number[]>>;
    numbers: ConvertedNumber[];
    /** Systems that have no numbers, or will not use them as they are. */
    notes: string[];
}

/**
 * Says a material in the numbers of other renderers and engines.
 *
 * `parameters` are those of the source system by its own names; {@link systems} lists them.
 */
export function convert(source: string, parameters: Record<string, Channels>, options?: ConvertOptions): Conversion;

/** The light of a thin-walled surface, and the slab that is to have it. */
export interface WallOptions extends SlabOptions {
    /** Share of the light below the interface that the surface scatters, in (0, 1]: OpenPBR's subsurface_color. */
    color: Channels;
    /** Share of that which goes to the other side, in (0, 1]: (1 + a)/2 of OpenPBR's subsurface_scatter_anisotropy a. */
    balance: Channels;
}

/**
 * Finds the slab that has the light of a thin-walled surface: `values.slab` has its albedos, its thickness in mean free paths, and
 * its transport mean free path in the unit of `thin` as `mfp`, or else as `mfp in thicknesses`.
 */
export function slab(options: WallOptions): Conversion;

/** A system whose numbers are known. */
export interface System {
    name: string;
    title: string;
    version: string;
    /** Unit of its lengths. */
    unit: "scene" | "mm" | "cm" | "m";
    /** Its parameters with their defaults; null for a length or color, which has none. */
    parameters: Record<string, number | null>;
    rule: string;
}

/** Every system, in each of the ways that it is told a material. */
export function systems(): System[];

/** A named material; its numbers are for red, green and blue. */
export interface Preset {
    name: string;
    source: string;
    surfaceAlbedo: [number, number, number];
    /** Mean free path in millimeters. */
    mfp: [number, number, number];
    eta: number;
    roughness: number;
}

/** Every preset. */
export function presets(): Preset[];
/** The preset of a name; case, spaces and hyphens do not matter. */
export function preset(name: string): Preset;

/** Languages of exports. */
export type Language = "wgsl" | "glsl" | "hlsl" | "msl" | "osl" | "c" | "cpp" | "materialx";
/** Subjects of exports. */
export type Subject =
    | "profile"
    | "sampler"
    | "disk"
    | "lut"
    | "kernel"
    | "probe"
    | "fresnel"
    | "inversion"
    | "material";

/** The options of the command `translucid export`. */
export interface ExportOptions {
    to: Language;
    what: Subject | readonly Subject[];
    /** By default "normalized-diffusion". */
    model?: Model | readonly Model[];
    /** A material whose numbers become constants: a preset, or a surface albedo with a length. */
    preset?: string;
    /** Unit of the lengths of a preset, by default "mm". */
    unit?: Unit;
    surfaceAlbedo?: Channels;
    mfp?: Channels;
    dmfp?: Channels;
    /** By default "diffuse", with a dmfp "searchlight". */
    configuration?: Configuration;
    /** For an inversion, in [-0.95, 0.95]. */
    g?: number;
    /** For an inversion and for moments of the Fresnel reflectance. */
    eta?: number;
    /** Taps of a disk or a kernel, 3 to 1024, by default 25. */
    taps?: number;
    /** Columns and rows of a lut, by default [128, 32]. */
    size?: readonly [number, number];
    /** Greatest curvature of a lut. */
    mostCurvature?: number;
}

/** Code of profiles for a shader or renderer: the text that `translucid export` writes. */
export function exportText(options: ExportOptions): string;

/** Every model. */
export function models(): Model[];
/** Version of the module. */
export function version(): string;

/** An answer in columns. */
export interface Answer {
    /** Numbers or words by the names of their columns, null where there is none. */
    columns: { [name: string]: (number | string | null)[] };
    /** The answer for people, numbers rounded, if there is one. */
    text: string | null;
    /** Its picture, if there is one. */
    svg: string | null;
    /** Remarks on the answer. */
    notes: string[];
    /** Reasons to doubt it. */
    warnings: string[];
}

// questions
// end of questions
