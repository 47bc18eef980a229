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

/** The sockets of a Subsurface Scattering node or a Principled BSDF of Blender. */
export interface CyclesOptions {
    /** Linear color, clamped to [0, 1]. */
    baseColor: Channels;
    /** Radius times Scale, at least 0; a channel of 0 is Lambertian. */
    radius: Channels;
    /** Index that the view is refracted by, by default 1.4. */
    ior?: number;
    /** Mean cosine of the phase function, by default 0, clamped as Cycles does. */
    anisotropy?: number;
    /** Width of the facets that refract the view, by default 1: the square of the Principled BSDF's Roughness. */
    alpha?: number;
    /** Version of Blender that the node is of, by default [5, 2]; it names the methods. */
    version?: readonly number[];
}

/**
 * Makes the keys of a material, in the words of scene files, whose subsurface looks like that of Blender Cycles by a method:
 * "BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN" or "RANDOM_WALK_LEGACY", as the version names it.
 */
export function cyclesMaterial(method: string, options: CyclesOptions): Record<string, string | number | number[]>;

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
    /** Weight of a clear coat, in [0, 1]. */
    coat: number;
    coatRoughness: number;
    /** Kind of substance, such as stone or food. */
    group: string;
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
/** Options of {@link layers}. */
export interface LayersOptions {
    /** How light arrives. Default: searchlight along the normal. */
    configuration?: "searchlight" | "diffuse";
    /** Angle of a beam above, in degrees from the normal, in [0, 90). */
    incidenceAngle?: number;
    /** Error at which no finer rule is needed, in [1e-12, 0.1]. Profiles take no less than 1e-4; from 5e-3 on they are two to six times faster. Default: 1e-6 of the light in totals, 1e-4 of the value in profiles. */
    tolerance?: number;
    /** Distances from the beam [L], at least 0; without them totals are computed. */
    r?: number | ArrayLike<number>;
}
/**
 * Light that plane layers reflect, transmit and absorb, or its profile around a beam.
 *
 * Totals are parts of the light that arrives from above, what the faces reflect included; profiles are scattered
 * light only, around a beam along the normal.
 *
 * - `specular_reflectance`: part of the light that returns without having been scattered
 * - `diffuse_reflectance`: part of the light that returns scattered
 * - `collimated_transmittance`: part of the light that leaves below without having been scattered
 * - `diffuse_transmittance`: part of the light that leaves below scattered
 * - `absorbed_by_layer_1`: part of the light that a layer absorbs, a column for each
 * - `absorbed_by_ground`: part of the light that a ground absorbs
 * - `error`: estimated numerical error of each part, and what every second row of a phase function's table changes
 */
export function layers(layers: {
    /** Medium above the layers. Default: air. */
    above?: {
        /** Its index of refraction, in [0.1, 10]. Default: 1. */
        eta?: number | ArrayLike<number>;
    };
    /** Layers from top to bottom. */
    layer: {
        /** Thickness [L], at least 1e-30, or inf; the last layer may go without it, and is endless then. Default: inf. */
        thickness?: number | ArrayLike<number>;
        /** Scattering coefficient [1/L], in [0, 1e30], with `absorption`. */
        scattering?: number | ArrayLike<number>;
        /** Absorption coefficient [1/L], in [0, 1e30], with `scattering`. */
        absorption?: number | ArrayLike<number>;
        /** Share of diffuse light that an endless layer of this medium would return without a boundary, in (0, 1], with `mfp`. */
        surfaceAlbedo?: number | ArrayLike<number>;
        /** Mean free path [L], in [1e-30, 1e30], with `surface_albedo`. */
        mfp?: number | ArrayLike<number>;
        /** A printer's filament, in place of coefficients. */
        filament?: {
            /** Color of a thick piece without its gloss, linear Rec. 709 or "#rrggbb". */
            color: string;
            /** Thickness of a sheet that lets the part `transmitted` of the light through [L], in [1e-30, 1e30]. */
            transmissionDistance: number;
            /** Part of the light that passes a sheet of the transmission distance, in (0, 1); sources disagree on it: 0.37 (1/e), 0.1, 0.05, or next to nothing, 0.01. */
            transmitted: number;
        };
        /** Mean cosine of Henyey and Greenstein's phase function, in (-1, 1). Default: 0. */
        g?: number | ArrayLike<number>;
        /** Legendre moments 1, 2, ... of another phase function. */
        moments?: number | ArrayLike<number>;
        /** Another phase function: henyey-greenstein, rayleigh, two-term:W,G1,G2, moments:X1,X2,..., or a FILE.csv. */
        phaseFunction?: string;
        /** Index of refraction, in [0.1, 10]. Default: 1. */
        eta?: number | ArrayLike<number>;
    }[];
    /** Medium or ground below the layers. Default: nothing below an endless layer, else air. */
    below?: {
        /** Index of refraction of a clear medium, in [0.1, 10]. */
        eta?: number | ArrayLike<number>;
        /** Part of the light that a ground in contact with the last layer returns, in [0, 1]. */
        reflectance?: number | ArrayLike<number>;
    };
    /** Black and white grounds, for colors. Default: black and white. */
    grounds?: {
        /** Reflectance of the black ground, in [0, 1]. Default: 0. */
        black?: number | ArrayLike<number>;
        /** Reflectance of the white ground, in [0, 1]. Default: 1. */
        white?: number | ArrayLike<number>;
        /** Contact of the layers with the grounds. Default: optical. */
        contact?: "optical" | "air";
    };
} | {
    /** Thickness [L], at least 1e-30, or inf; the last layer may go without it, and is endless then. Default: inf. */
    thickness?: number | ArrayLike<number>;
    /** Scattering coefficient [1/L], in [0, 1e30], with `absorption`. */
    scattering?: number | ArrayLike<number>;
    /** Absorption coefficient [1/L], in [0, 1e30], with `scattering`. */
    absorption?: number | ArrayLike<number>;
    /** Share of diffuse light that an endless layer of this medium would return without a boundary, in (0, 1], with `mfp`. */
    surfaceAlbedo?: number | ArrayLike<number>;
    /** Mean free path [L], in [1e-30, 1e30], with `surface_albedo`. */
    mfp?: number | ArrayLike<number>;
    /** A printer's filament, in place of coefficients. */
    filament?: {
        /** Color of a thick piece without its gloss, linear Rec. 709 or "#rrggbb". */
        color: string;
        /** Thickness of a sheet that lets the part `transmitted` of the light through [L], in [1e-30, 1e30]. */
        transmissionDistance: number;
        /** Part of the light that passes a sheet of the transmission distance, in (0, 1); sources disagree on it: 0.37 (1/e), 0.1, 0.05, or next to nothing, 0.01. */
        transmitted: number;
    };
    /** Mean cosine of Henyey and Greenstein's phase function, in (-1, 1). Default: 0. */
    g?: number | ArrayLike<number>;
    /** Legendre moments 1, 2, ... of another phase function. */
    moments?: number | ArrayLike<number>;
    /** Another phase function: henyey-greenstein, rayleigh, two-term:W,G1,G2, moments:X1,X2,..., or a FILE.csv. */
    phaseFunction?: string;
    /** Index of refraction, in [0.1, 10]. Default: 1. */
    eta?: number | ArrayLike<number>;
}[], options?: LayersOptions): Answer;

/** Options of {@link stack}. */
export interface StackOptions {
    /** Light: daylight of 6504 K, that of printing of 5003 K, or incandescent light. Default: d65. */
    illuminant?: "d65" | "d50" | "a";
    /** Field of view of the observer in degrees: CIE 1931 or CIE 1964. Default: 2. */
    observer?: "2" | "10";
    /** Light that returns without having been scattered: included is what recipes and quality control use. Default: included. */
    specular?: "included" | "excluded";
    /** Print reflectances and transmittances by wavelength or channel instead of colors. Default: false. */
    channels?: boolean;
}
/**
 * Prints the color of plane layers over black, white and their own ground, and draws a swatch.
 *
 * The file is that of reference --layers, in which a number may also be three, for red, green and blue (linear Rec.
 * 709), or a table over wavelengths in nm, and a layer may be a filament by its color and transmission distance.
 * [grounds] has the reflectances of black and white. Everything is what an instrument of the geometry d:8 measures:
 * light from everywhere, viewed at 8 degrees.
 *
 * - `ground`: black, white, or below: that of the layers themselves
 * - `reflectance`: reflectance of luminance
 * - `transmittance`: transmittance of luminance; none over a ground
 * - `X`: CIE X, where Y is 100 for the perfect diffuser
 * - `Y`: CIE Y
 * - `Z`: CIE Z
 * - `L`: CIELAB L*
 * - `a`: CIELAB a*
 * - `b`: CIELAB b*
 * - `srgb`: the color of a display
 * - `in_srgb`: no where srgb is only the nearest color of a display
 * - `error`: numerical error, at most, in Delta E*ab
 * - `kubelka_munk_reflectance`: reflectance by Kubelka and Munk with Saunderson's correction
 * - `kubelka_munk_delta_e`: distance of its color in Delta E*ab
 * - `tp_ab`: Delta E*ab between the layers over white and over black, the same in each row
 * - `tp_2000`: CIEDE2000 between them
 * - `contrast_ratio`: Y over black / Y over white
 */
export function stack(layers: {
    /** Medium above the layers. Default: air. */
    above?: {
        /** Its index of refraction, in [0.1, 10]. Default: 1. */
        eta?: number | ArrayLike<number>;
    };
    /** Layers from top to bottom. */
    layer: {
        /** Thickness [L], at least 1e-30, or inf; the last layer may go without it, and is endless then. Default: inf. */
        thickness?: number | ArrayLike<number>;
        /** Scattering coefficient [1/L], in [0, 1e30], with `absorption`. */
        scattering?: number | ArrayLike<number>;
        /** Absorption coefficient [1/L], in [0, 1e30], with `scattering`. */
        absorption?: number | ArrayLike<number>;
        /** Share of diffuse light that an endless layer of this medium would return without a boundary, in (0, 1], with `mfp`. */
        surfaceAlbedo?: number | ArrayLike<number>;
        /** Mean free path [L], in [1e-30, 1e30], with `surface_albedo`. */
        mfp?: number | ArrayLike<number>;
        /** A printer's filament, in place of coefficients. */
        filament?: {
            /** Color of a thick piece without its gloss, linear Rec. 709 or "#rrggbb". */
            color: string;
            /** Thickness of a sheet that lets the part `transmitted` of the light through [L], in [1e-30, 1e30]. */
            transmissionDistance: number;
            /** Part of the light that passes a sheet of the transmission distance, in (0, 1); sources disagree on it: 0.37 (1/e), 0.1, 0.05, or next to nothing, 0.01. */
            transmitted: number;
        };
        /** Mean cosine of Henyey and Greenstein's phase function, in (-1, 1). Default: 0. */
        g?: number | ArrayLike<number>;
        /** Legendre moments 1, 2, ... of another phase function. */
        moments?: number | ArrayLike<number>;
        /** Another phase function: henyey-greenstein, rayleigh, two-term:W,G1,G2, moments:X1,X2,..., or a FILE.csv. */
        phaseFunction?: string;
        /** Index of refraction, in [0.1, 10]. Default: 1. */
        eta?: number | ArrayLike<number>;
    }[];
    /** Medium or ground below the layers. Default: nothing below an endless layer, else air. */
    below?: {
        /** Index of refraction of a clear medium, in [0.1, 10]. */
        eta?: number | ArrayLike<number>;
        /** Part of the light that a ground in contact with the last layer returns, in [0, 1]. */
        reflectance?: number | ArrayLike<number>;
    };
    /** Black and white grounds, for colors. Default: black and white. */
    grounds?: {
        /** Reflectance of the black ground, in [0, 1]. Default: 0. */
        black?: number | ArrayLike<number>;
        /** Reflectance of the white ground, in [0, 1]. Default: 1. */
        white?: number | ArrayLike<number>;
        /** Contact of the layers with the grounds. Default: optical. */
        contact?: "optical" | "air";
    };
} | {
    /** Thickness [L], at least 1e-30, or inf; the last layer may go without it, and is endless then. Default: inf. */
    thickness?: number | ArrayLike<number>;
    /** Scattering coefficient [1/L], in [0, 1e30], with `absorption`. */
    scattering?: number | ArrayLike<number>;
    /** Absorption coefficient [1/L], in [0, 1e30], with `scattering`. */
    absorption?: number | ArrayLike<number>;
    /** Share of diffuse light that an endless layer of this medium would return without a boundary, in (0, 1], with `mfp`. */
    surfaceAlbedo?: number | ArrayLike<number>;
    /** Mean free path [L], in [1e-30, 1e30], with `surface_albedo`. */
    mfp?: number | ArrayLike<number>;
    /** A printer's filament, in place of coefficients. */
    filament?: {
        /** Color of a thick piece without its gloss, linear Rec. 709 or "#rrggbb". */
        color: string;
        /** Thickness of a sheet that lets the part `transmitted` of the light through [L], in [1e-30, 1e30]. */
        transmissionDistance: number;
        /** Part of the light that passes a sheet of the transmission distance, in (0, 1); sources disagree on it: 0.37 (1/e), 0.1, 0.05, or next to nothing, 0.01. */
        transmitted: number;
    };
    /** Mean cosine of Henyey and Greenstein's phase function, in (-1, 1). Default: 0. */
    g?: number | ArrayLike<number>;
    /** Legendre moments 1, 2, ... of another phase function. */
    moments?: number | ArrayLike<number>;
    /** Another phase function: henyey-greenstein, rayleigh, two-term:W,G1,G2, moments:X1,X2,..., or a FILE.csv. */
    phaseFunction?: string;
    /** Index of refraction, in [0.1, 10]. Default: 1. */
    eta?: number | ArrayLike<number>;
}[], options?: StackOptions): Answer;

// end of questions
