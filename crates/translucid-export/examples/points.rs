//! Writes what a program needs that runs the exported texts: the texts, 100,000 points for each function, and what
//! double precision says there.
//!
//! `cargo run -p translucid-export --example points -- DIRECTORY` makes in it a directory for each configuration, with
//! - `export.LANGUAGE`: every function in every language, in WGSL with an entry point for each;
//! - `functions.json`: for each function its name, the number of its arguments and results, its call in each language,
//!   and its largest relative error;
//! - `NAME.arguments`: rows of f32; `NAME.least`, `NAME.greatest`: rows of f64 that results lie between, but for the
//!   relative error and what is in `NAME.floor`.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use translucid_export::{Export, Function, Language, Material, Sizes, Subject, Target, exponentials};
use translucid_fit::{Exponential, Mixture};
use translucid_profile::{
    AlbedoInversion, Appearance, Configuration, Model, NormalizedDiffusion, ObliqueDiffusion,
    Parameterization, Profile, RefinedDiffusion, SumOfGaussians, fresnel_from_inside, fresnel_from_outside,
    scaling_from_dmfp_searchlight, scaling_from_mfp_diffuse, scaling_from_mfp_searchlight,
    schlick_from_outside,
};

/// Points for each function.
const COUNT: usize = 100_000;
/// Least normal number of single precision.
const LEAST: f64 = f32::MIN_POSITIVE as f64;
/// Where texts cut off what grows beyond all numbers.
const MOST: f64 = 1e38;
/// Error that the last bits of a random number and of the weights of a mixture make.
const BIT: f64 = 1e-6;
/// Phase function and boundary of the inversion.
const G: f64 = 0.5;
const ETA: f64 = 1.3;
/// Material of the sums.
const MATERIAL: Material = Material {
    surface_albedo: [0.95, 0.6, 0.05],
    length: [2.0, 0.3, 1e-3],
    parameterization: Parameterization::Mfp,
    surface: None,
};
/// Largest error of the inversion's polynomial, of the surface albedo.
const INVERSION: f64 = 4e-4;
/// Greatest random number below 1.
const LAST: f64 = 1.0 - 1.0 / 16_777_216.0;

fn main() -> Result<(), Box<dyn Error>> {
    let directory = PathBuf::from(std::env::args_os().nth(1).ok_or("name a directory")?);
    for (name, configuration) in
        [("diffuse", Configuration::Diffuse), ("searchlight", Configuration::Searchlight)]
    {
        let directory = directory.join(name);
        fs::create_dir_all(&directory)?;
        write(&directory, configuration)?;
    }
    Ok(())
}

/// Writes the files of a configuration.
fn write(directory: &Path, configuration: Configuration) -> Result<(), Box<dyn Error>> {
    let export = |target| Export {
        target,
        subjects: &[Subject::Profile, Subject::Sampler, Subject::Probe, Subject::Fresnel, Subject::Inversion],
        models: &[
            Model::NormalizedDiffusion,
            Model::NormalizedDiffusionRefined,
            Model::NormalizedDiffusionOblique,
            Model::Gaussians,
            Model::Exact,
        ],
        material: Some(MATERIAL),
        configuration,
        g: G,
        eta: ETA,
        sizes: Sizes::default(),
        command: "the tests of its exports",
    };
    let texts = Target::ALL.into_iter().filter(|target| !matches!(target, Target::Image(_)));
    for target in texts {
        let mut bytes = export(target).bytes()?;
        if target == Target::Text(Language::Wgsl) {
            bytes.extend(entry_points(&export(target).functions()?).into_bytes());
        }
        fs::write(directory.join(format!("export.{}", target.name())), bytes)?;
    }
    let functions = export(Target::Text(Language::Wgsl)).functions()?;
    let entries: Vec<String> = functions.iter().map(json).collect();
    fs::write(directory.join("functions.json"), format!("[{}]\n", entries.join(",\n")))?;
    let doubles = Doubles::new(configuration)?;
    functions.iter().try_for_each(|function| write_points(directory, function, &doubles))
}

/// Threads of a workgroup.
const WORKGROUP: usize = 64;

/// Entry points in WGSL that compute each function for every row of a buffer: `each_NAME`.
///
/// Binding 0 of group 0 has the arguments of all calls one after the other, binding 1 takes the results.
fn entry_points(functions: &[Function]) -> String {
    let mut text = String::from(
        "
@group(0) @binding(0) var<storage, read> arguments_of_all: array<f32>;
@group(0) @binding(1) var<storage, read_write> results_of_all: array<f32>;
",
    );
    for Function { name, arguments, call, outputs, .. } in functions {
        let (inputs, results) = (arguments.len(), outputs.len());
        // Writing to a string cannot fail
        let _ = writeln!(
            text,
            "
@compute @workgroup_size({WORKGROUP})
fn each_{name}(@builtin(global_invocation_id) id: vec3<u32>) {{
    let i: u32 = id.x;
    if (i * {results}u >= arrayLength(&results_of_all)) {{
        return;
    }}"
        );
        for (j, argument) in arguments.iter().enumerate() {
            let _ = writeln!(text, "    let {argument}: f32 = arguments_of_all[{inputs}u * i + {j}u];");
        }
        let _ = writeln!(text, "    let result = {call};");
        for (j, output) in outputs.iter().enumerate() {
            let field = if output.is_empty() { String::new() } else { format!(".{output}") };
            let _ = writeln!(text, "    results_of_all[{results}u * i + {j}u] = result{field};");
        }
        text += "}\n";
    }
    text
}

/// What the functions of a configuration are in double precision, where it is not made of arguments alone.
struct Doubles {
    configuration: Configuration,
    inversion: AlbedoInversion,
    exponentials: [Mixture<Exponential>; 3],
    gaussians: [SumOfGaussians; 3],
}

impl Doubles {
    fn new(configuration: Configuration) -> Result<Self, Box<dyn Error>> {
        let Material { surface_albedo, length, parameterization, .. } = MATERIAL;
        let fitted = |c: usize| {
            let (surface_albedo, length) = (surface_albedo[c], length[c]);
            let appearance = Appearance { surface_albedo, length, parameterization, g: 0.0 };
            exponentials(&*Model::Exact.profile(&appearance, configuration, 1.0)?)
        };
        let gaussians =
            |c: usize| SumOfGaussians::new(surface_albedo[c], length[c], parameterization, configuration, 6);
        Ok(Self {
            configuration,
            inversion: AlbedoInversion::new(G, ETA, configuration)?,
            exponentials: [fitted(0)?, fitted(1)?, fitted(2)?],
            gaussians: [gaussians(0)?, gaussians(1)?, gaussians(2)?],
        })
    }
}

/// An entry of `functions.json`.
fn json(function: &Function) -> String {
    let Function { name, arguments, outputs, .. } = function;
    let of_each = |value: &dyn Fn(Language) -> String| {
        let entries = Language::ALL.into_iter().map(|language| {
            let name = Target::Text(language).name();
            format!("\"{name}\":{}", value(language))
        });
        entries.collect::<Vec<_>>().join(",")
    };
    let calls = of_each(&|language| format!("\"{}\"", function.call_in(language)));
    let errors = of_each(&|language| format!("{:e}", function.error_in(language)));
    let list = |words: &[&str]| words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(",");
    format!(
        "{{\"name\":\"{name}\",\"arguments\":[{}],\"outputs\":[{}],\"errors\":{{{errors}}},\"calls\":{{{calls}}}}}",
        list(arguments),
        list(outputs),
    )
}

fn write_points(directory: &Path, function: &Function, doubles: &Doubles) -> Result<(), Box<dyn Error>> {
    let (mut arguments, mut least, mut greatest, mut floor) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for i in 0..COUNT {
        let point = Point::number(i);
        let row: Vec<f32> = function.arguments.iter().map(|name| point.argument(name) as f32).collect();
        let wide: Vec<f64> = row.iter().map(|x| f64::from(*x)).collect();
        for truth in truths(function, &wide, doubles)? {
            least.extend(truth.least.min(MOST).to_le_bytes());
            greatest.extend(truth.greatest.min(MOST).to_le_bytes());
            floor.extend(truth.floor.min(MOST).to_le_bytes());
        }
        arguments.extend(row.into_iter().flat_map(f32::to_le_bytes));
    }
    let name = function.name;
    for (kind, bytes) in
        [("arguments", arguments), ("least", least), ("greatest", greatest), ("floor", floor)]
    {
        fs::write(directory.join(format!("{name}.{kind}")), bytes)?;
    }
    Ok(())
}

/// Arguments of all names, spread evenly over their ranges, each with its ends.
struct Point {
    i: usize,
    spread: [f64; 6],
}

impl Point {
    fn number(i: usize) -> Self {
        // Numbers that no whole combination of makes 0: roots of the first primes
        let spread =
            [2.0, 3.0, 5.0, 7.0, 11.0, 13.0].map(|prime: f64| (prime.sqrt() * (i + 1) as f64).fract());
        Self { i, spread }
    }

    fn argument(&self, name: &str) -> f64 {
        let r = || self.radius() * self.length();
        let offset = || self.radius() * self.probed();
        match name {
            "surface_albedo" => self.albedo(),
            "channel" => (self.i % 3) as f64,
            "length" | "d" => self.length(),
            "d_red" => self.probed(),
            "d_green" => self.probed() * (0.2 + self.spread[4]),
            "d_blue" => self.probed() * (0.2 + self.spread[5]),
            "most_radius" => self.probed() * 20.0,
            "chance_red" => 0.5 * self.spread[0],
            "chance_green" => 0.5 * self.spread[3],
            "density" => 10f64.powf(12.0 * self.spread[4] - 6.0),
            "distance" => offset(),
            "offset_x" => offset() * (TAU * self.turn()).cos(),
            "offset_y" => offset() * (TAU * self.turn()).sin(),
            "offset_z" => offset() * (2.0 * self.spread[5] - 1.0),
            "n_x" => (TAU * self.spread[3]).cos() * 0.6,
            "n_y" => (TAU * self.spread[3]).sin() * 0.6,
            "n_z" => 0.8,
            "u_axis" => unit(self.i, self.spread[1]),
            "u_channel" => unit(self.i / 16, self.spread[2]),
            "u_radius" => unit(self.i / 5, self.spread[4]),
            "u_turn" => unit(self.i / 7, self.spread[5]),
            "eta" => match self.i % 8 {
                0 => 1.0,
                1 => 1.0 + 1e-4 * self.spread[1],
                2 => 0.05,
                3 => 20.0,
                _ => (20f64.ln() * (2.0 * self.spread[1] - 1.0)).exp(),
            },
            "scale" => 0.9 + 24.0 * self.spread[2],
            "r" => match self.i % 64 {
                5 => 0.0,
                6 => 1e-45,
                7 => 1e-38,
                8 => f64::from(f32::MAX),
                9 => -1.0,
                _ => r(),
            },
            "x" => r() * (TAU * self.turn()).cos(),
            "y" => r() * (TAU * self.turn()).sin(),
            "u" => unit(self.i, self.spread[2]),
            "turn" => unit(self.i / 3, self.spread[4]),
            "cos_theta" => match self.i % 16 {
                10 => 0.0,
                11 => 1.0,
                12 => 1e-4,
                _ => self.spread[3],
            },
            other => unreachable!("{other}"),
        }
    }

    fn albedo(&self) -> f64 {
        let a = self.spread[0];
        match self.i % 16 {
            0 => 0.0,
            1 => 1.0,
            2 => 1e-6 * a,
            3 => 1.0 - 1e-6 * a,
            _ => a,
        }
    }

    fn length(&self) -> f64 {
        let length = match self.i % 32 {
            13 => 1e-18,
            14 => 1e18,
            _ => 10f64.powf(12.0 * self.spread[1] - 6.0),
        };
        f64::from(length as f32)
    }

    /// Lengths of probes, which are squared.
    fn probed(&self) -> f64 {
        self.length().clamp(1e-6, 1e6)
    }

    /// In lengths.
    fn radius(&self) -> f64 {
        10f64.powf(10.6 * self.spread[2] - 8.0)
    }

    fn turn(&self) -> f64 {
        match self.i % 8 {
            0 => 0.0,
            1 => 0.5,
            2 => 1e-4 * self.spread[4],
            _ => self.spread[4],
        }
    }
}

/// A random number, or one near an end.
fn unit(i: usize, spread: f64) -> f64 {
    match i % 16 {
        4 => 0.0,
        5 => LAST,
        6 => 1e-6 * spread,
        7 => 10f64.powf(-30.0 * spread),
        8 => (1.0 - 1e-5 * spread).min(LAST),
        _ => spread.min(LAST),
    }
}

/// Double precision's result: between two numbers, where a last bit of an argument counts.
struct Truth {
    least: f64,
    greatest: f64,
    /// What counts as 0.
    floor: f64,
}

/// A result that is one number; `scale` is what it would be without the decay of an exponential.
fn exactly(value: f64, scale: f64) -> Truth {
    Truth { least: value, greatest: value, floor: 2.0 * LEAST * scale.abs().max(1.0) }
}

/// A result that the last bits of an argument move between others.
fn among(values: impl IntoIterator<Item = f64>, floor: f64) -> Truth {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let (least, greatest) = values.into_iter().fold(start, |(least, most), x| (least.min(x), most.max(x)));
    Truth { least, greatest, floor }
}

fn near(u: f64) -> [f64; 3] {
    [u, u - BIT, u + BIT].map(|u| u.clamp(0.0, LAST))
}

/// The farthest that a sum of exponentials is sampled where a random number is next to the end of a term.
///
/// There the radius leaps from the term's farthest to the next one's nearest, and the term's end has an error, too.
fn farthest_at_end(weights: [f64; 4], rates: [f64; 4], u: f64) -> Option<f64> {
    let mut end = 0.0;
    let ends = weights.map(|weight| {
        end += weight;
        end
    });
    let slowest = rates.into_iter().fold(f64::INFINITY, f64::min);
    ends.iter().any(|end| (u - end).abs() <= BIT).then(|| -(1.0 - LAST).ln() / slowest)
}

fn truths(function: &Function, x: &[f64], doubles: &Doubles) -> Result<Vec<Truth>, Box<dyn Error>> {
    let (configuration, inversion) = (doubles.configuration, &doubles.inversion);
    let one = |truth: Truth| Ok(vec![truth]);
    let burley = |a, d| NormalizedDiffusion::from_d(a, d);
    let refined = || RefinedDiffusion::new(x[0], x[1], Parameterization::Mfp, configuration);
    let oblique = || ObliqueDiffusion::new(x[0], x[1], Parameterization::Mfp, configuration, x[2]);
    // A radius below the least normal number counts as that where R is divided by it
    match function.name {
        "burley_scale_mfp_searchlight" => one(exactly(scaling_from_mfp_searchlight(x[0]), 1.0)),
        "burley_scale_mfp_diffuse" => one(exactly(scaling_from_mfp_diffuse(x[0]), 1.0)),
        "burley_scale_dmfp_searchlight" => one(exactly(scaling_from_dmfp_searchlight(x[0]), 1.0)),
        "burley_width" => one(exactly((x[0] / x[1]).clamp(1e-18, 1e18), 1.0)),
        "burley_pdf" => one(exactly(burley(1.0, x[1])?.pdf(x[0]), burley(1.0, x[1])?.pdf(0.0))),
        "burley_pdf_area" => {
            let (p, r) = (burley(1.0, x[1])?, x[0].max(LEAST));
            one(exactly(p.pdf_area(r), p.pdf(0.0) / (TAU * r)))
        }
        "burley_eval" => {
            let (p, r) = (burley(x[0], x[2])?, x[1].max(LEAST));
            one(exactly(p.eval(r), p.pdf(0.0) / (TAU * r)))
        }
        "burley_eval_times_r" => {
            let p = burley(x[0], x[2])?;
            one(exactly(p.eval_times_r(x[1]), p.pdf(0.0)))
        }
        "burley_cdf" => one(exactly(burley(1.0, x[1])?.cdf(x[0]), 1.0)),
        "burley_complementary_cdf" => one(exactly(burley(1.0, x[1])?.complementary_cdf(x[0]), 1.0)),
        "burley_quantile" => one(exactly(burley(1.0, x[1])?.quantile(x[0]), x[1])),
        "burley_sample" => one(exactly(burley(1.0, x[1])?.sample(x[0]), x[1])),
        "refined_pdf" => one(exactly(refined()?.pdf(x[2]), refined()?.pdf(0.0))),
        "refined_pdf_area" => {
            let (p, r) = (refined()?, x[2].max(LEAST));
            one(exactly(p.pdf_area(r), p.pdf(0.0) / (TAU * r)))
        }
        "refined_eval" => {
            let (p, r) = (refined()?, x[2].max(LEAST));
            one(exactly(p.eval(r), p.pdf(0.0) / (TAU * r)))
        }
        "refined_mfp_from_dmfp" => {
            let dmfp = Parameterization::Dmfp;
            let mfp = RefinedDiffusion::new(x[0], x[1], dmfp, configuration).map_or(0.0, |p| p.mfp());
            one(exactly(mfp, 1.0))
        }
        "refined_cdf" => one(exactly(refined()?.cdf(x[2]), 1.0)),
        "refined_complementary_cdf" => one(exactly(refined()?.complementary_cdf(x[2]), 1.0)),
        "refined_sample" => {
            let p = refined()?;
            let farthest = farthest_at_end(p.weights(), p.rates(), x[2]).into_iter().flat_map(|r| [0.0, r]);
            one(among(near(x[2]).map(|u| p.sample(u)).into_iter().chain(farthest), LEAST * x[1]))
        }
        name if name.starts_with("exponentials_") => {
            let sum = &doubles.exponentials[x[0] as usize];
            let rates: Vec<f64> = sum.scales().iter().map(|scale| 1.0 / scale).collect();
            one(of_sum(name, x[1], sum, sum.weights(), |k, [above, below]| neg_log(above, below) / rates[k]))
        }
        name if name.starts_with("gaussians_") => {
            let sum = &doubles.gaussians[x[0] as usize];
            let deviations = sum.standard_deviations();
            let radius =
                |k: usize, [above, below]: [f64; 2]| deviations[k] * (2.0 * neg_log(above, below)).sqrt();
            one(of_sum(name, x[1], sum, sum.weights(), radius))
        }
        "oblique_pdf_area" | "oblique_eval" => {
            let p = oblique()?;
            let (r, phi) = (x[3].hypot(x[4]).max(LEAST), x[4].atan2(x[3]));
            let (value, scale) = (p.pdf_area(r, phi), p.pdf_area(1e-9 * x[1], phi) * 1e-9 * x[1] / r);
            let factor = if function.name == "oblique_eval" { p.total() } else { 1.0 };
            one(exactly(value.min(MOST) * factor, scale))
        }
        "oblique_sample" => {
            let p = oblique()?;
            let points = near(x[3]).into_iter().flat_map(|u| near(x[4]).map(|turn| p.sample([u, turn])));
            let points = points.map(|(r, phi)| (r * phi.cos(), r * phi.sin()));
            let farthest = farthest_at_end(p.weights(), p.rates(), x[3]).into_iter();
            let points: Vec<(f64, f64)> = points.chain(farthest.flat_map(|r| [(-r, -r), (r, r)])).collect();
            // Of a coordinate near 0 the error is one of the radius
            let floor = function.error * points.iter().map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max);
            Ok(vec![
                among(points.iter().map(|point| point.0), floor),
                among(points.iter().map(|point| point.1), floor),
            ])
        }
        "fresnel_from_outside" => one(fresnel(fresnel_from_outside, x)),
        "fresnel_from_inside" => one(fresnel(fresnel_from_inside, x)),
        "fresnel_schlick" => one(among([schlick_from_outside(x[0], x[1])], 1e-12)),
        "probe_segment" => probe_segment(x),
        "probe_density" => probe_density(x).map(|truth| vec![truth]),
        "probe_weight" => {
            let (p, r) = (burley(x[0], x[1])?, x[3].max(LEAST));
            let scale = x[0] / p.cdf(x[2]) / x[4];
            one(exactly(p.eval(r).min(MOST) * scale / x[0].max(LEAST), p.pdf(0.0) / (TAU * r) / x[4]))
        }
        "inversion_absorbed" | "inversion_single_scattering_albedo" | "inversion_absorption" => {
            let inverse = |a: f64| {
                let alpha = inversion.single_scattering_albedo(a.clamp(0.0, 1.0));
                match function.name {
                    "inversion_absorbed" => (1.0 - alpha) / (1.0 - G * alpha),
                    "inversion_absorption" => 1.0 - alpha,
                    _ => alpha,
                }
            };
            one(among([x[0], x[0] - INVERSION, x[0] + INVERSION].map(inverse), LEAST))
        }
        other => Err(format!("no truth for {other}").into()),
    }
}

/// −ln(x) for x given beside 1 − x, with the digits of both.
fn neg_log(x: f64, complement: f64) -> f64 {
    if complement < 0.5 { -(-complement).ln_1p() } else { -x.ln() }
}

/// A function of a sum of weighted terms at a radius or random number; `radius` is that of a term for a random number,
/// which comes as its complement and itself.
fn of_sum(
    name: &str,
    x: f64,
    sum: &dyn Profile,
    weights: &[f64],
    radius: impl Fn(usize, [f64; 2]) -> f64,
) -> Truth {
    let (r, scale) = (x.max(LEAST), sum.scale());
    let total = sum.surface_albedo();
    let least = 1e-9 * scale;
    let without_decay = match name {
        // Where the decay of a Gaussian ends, at fifteen deviations
        "gaussians_pdf" => {
            let spread = |k: usize| radius(k, [(-0.5_f64).exp(), -(-0.5_f64).exp_m1()]);
            weights.iter().enumerate().map(|(k, weight)| 15.0 * weight / spread(k)).sum()
        }
        "exponentials_pdf" => sum.pdf(least),
        _ if name.starts_with("exponentials") => sum.pdf_area(least) * (least / r),
        _ => sum.pdf_area(least),
    };
    match name.split_once('_').map_or("", |parts| parts.1) {
        "pdf" => exactly(sum.pdf(x), without_decay),
        "pdf_area" => exactly(sum.pdf_area(r), without_decay),
        "eval" => exactly((total * sum.pdf_area(r)).min(MOST), without_decay),
        "cdf" => exactly(sum.enclosed(x) / total, 1.0),
        "complementary_cdf" => exactly(sum.beyond(x) / total, 1.0),
        _ => {
            let farthest = |k: usize| radius(k, [1.0 - LAST, LAST]);
            let mut radii = Vec::new();
            for u in near(x) {
                let mut start = 0.0;
                for (k, weight) in weights.iter().enumerate() {
                    let end = start + weight;
                    if (start..end).contains(&u) {
                        let share = ((u - start) / weight).clamp(0.0, 1.0);
                        radii.push(radius(k, [((end - u) / weight).max(1.0 - LAST), share.min(LAST)]));
                    }
                    // At the end of a term the radius leaps from its farthest to the next one's nearest
                    if (u - end).abs() <= BIT {
                        radii.extend([0.0, farthest(k)]);
                    }
                    start = end;
                }
            }
            among(radii, LEAST * scale)
        }
    }
}

/// A reflectance, with what the last bits of its arguments move.
fn fresnel(f: fn(f64, f64) -> f64, x: &[f64]) -> Truth {
    let near = |value: f64| [1.0, 1.0 - 2e-7, 1.0 + 2e-7].map(|factor| value * factor);
    let around = |eta: f64| near(x[0]).map(|cosine| f(cosine, eta));
    // Without a boundary there is nothing to move
    let etas = if x[1] == 1.0 { [1.0; 3] } else { near(x[1]) };
    among(etas.into_iter().flat_map(around), 1e-12)
}

/// The segments of all radii that the last bits of the random numbers can mean.
fn probe_segment(x: &[f64]) -> Result<Vec<Truth>, Box<dyn Error>> {
    let [widths, most] = [&x[..3], &x[5..6]];
    let (most, ends) = (most[0], [x[3], x[3] + x[4]]);
    let mut segments: Vec<[f64; 6]> = Vec::new();
    for u_channel in near(x[7]) {
        let channel = ends.iter().filter(|end| u_channel >= **end).count();
        let p = NormalizedDiffusion::from_d(1.0, widths[channel])?;
        for u in near(x[8] * p.cdf(most)) {
            let r = p.quantile(u).min(most);
            for r in [r, r * (1.0 - BIT), r * (1.0 + BIT)].map(|r| r.min(most)) {
                let (sin, cos) = (TAU * x[9]).sin_cos();
                let (p, q, h) = (r * cos, r * sin, ((most - r) * (most + r)).sqrt());
                segments.push(if x[6] < 0.5 {
                    [p, q, h, p, q, -h]
                } else if x[6] < 0.75 {
                    [h, p, q, -h, p, q]
                } else {
                    [q, h, p, q, -h, p]
                });
            }
        }
    }
    // Of a coordinate near 0 the error is one of the radius
    Ok((0..6).map(|i| among(segments.iter().map(|segment| segment[i]), 2e-6 * most)).collect())
}

/// The density of an entry point, by the formula of three axes and three channels.
fn probe_density(x: &[f64]) -> Result<Truth, Box<dyn Error>> {
    let (widths, chances) = (&x[..3], [x[3], x[4], 1.0 - x[3] - x[4]]);
    let (most, offset, normal) = (x[5], &x[6..9], &x[9..12]);
    let mut density = 0.0;
    let mut scale = 0.0;
    for axis in 0..3 {
        let across = [offset[(axis + 1) % 3], offset[(axis + 2) % 3]];
        let r = across[0].hypot(across[1]).max(LEAST);
        let share = if axis == 2 { 0.5 } else { 0.25 } * normal[axis].abs();
        for (d, chance) in widths.iter().zip(chances) {
            let p = NormalizedDiffusion::from_d(1.0, *d)?;
            density += share * chance * p.pdf_area(r).min(MOST) / p.cdf(most);
            scale += share * chance * p.pdf(0.0) / (TAU * r);
        }
    }
    let distance = offset.iter().map(|x| x * x).sum::<f64>().sqrt() / most;
    let truth = exactly(density.min(MOST), scale);
    Ok(if distance < 1.0 - 1e-6 {
        truth
    } else if distance > 1.0 + 1e-6 {
        exactly(0.0, scale)
    } else {
        Truth { least: 0.0, ..truth }
    })
}
