//! `translucid render`: a scene or mesh becomes a picture, or one of each of several models.

mod look;
mod outputs;
mod picture;
mod points;
mod presets;
mod preview;
mod showing;
mod side_by_side;
mod statistics;
mod tev;
mod tone;
mod turntable;
mod watch;

use std::ffi::OsStr;
use std::ops::{ControlFlow, Range};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use clap::Args;
use translucid_image::{Denoiser, PixelRect};
use translucid_load::{LoadOptions, LoadProgress, LoadWatch, Orientation, load_oriented, still_life};
use translucid_render::Session;
use translucid_scene::{Light, Scene, SubsurfaceMethod, SubsurfaceModel, Unit, Warning};

use crate::failure::Failure;
use crate::interrupt::STOP;
use crate::model::{ModelName, UnitName};
use crate::progress::{Meter, Unit as CountedIn};
use crate::{machine, messages};
pub(crate) use look::Look;
pub(crate) use outputs::Outputs;
use picture::Task;
pub(crate) use picture::no_device;
use presets::print_presets;
use tev::Tev;
pub(crate) use tone::{Exposure, Tone};
use watch::WatchArguments;

/// Most samples per pixel, as the scene's settings have it.
pub(crate) const MAX_SAMPLES: u32 = 1 << 24;

/// Time between two checkpoints where none is asked for.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(30);

/// Time after which it is shown how far loading is.
const SOON: Duration = Duration::from_secs(1);

const EXAMPLES: &str = "\
Output: -o FILE.exr writes that file and FILE.png, -o FILE.png only the PNG, -o FILE.shard the samples, from which
`translucid merge` makes the picture. Several processes or machines share a picture by --samples A..B: see
`translucid plan`.
Ctrl-C writes the picture as far as it is and keeps a checkpoint beside it, and so do SIGTERM, SIGUSR1, SIGUSR2 and
SIGXCPU (queues, containers) and SIGHUP (a terminal that closes, but not under nohup). A checkpoint is also saved
every 30 s.
--resume continues from there; the result is the same as that of an uninterrupted run.
--tev[=HOST:PORT] shows the picture under the name of its file in tev (https://github.com/Tom94/tev), twice a second,
or less often if that would take more than 1 % of the time. If tev quits or is too slow, the rendering goes on.
--denoise loads the system's Open Image Denoise or that of `pip install pyoidn`, or the one that the variable
TRANSLUCID_OIDN names. FILE.exr keeps all its layers and gets the layer denoised; FILE.png shows that.

Several models after --subsurface render the scene with each and write to a directory, -o DIR:
  MODEL.exr, MODEL.png   the picture with each MODEL; same seed and samples, --time is for each
  MODEL-flip.png         visible difference from the judge (ꟻLIP), from black to nearly white
  MODEL-difference.png   darker (blue) or brighter (orange) than the judge, white for no difference
  sheet.svg, index.html  all of them side by side with times and errors, self-contained
  errors.csv             model, against, samples, seconds, cpu_seconds, relative_mse, noise, mean_flip, max_flip
                         relative_mse: mean of (x - ref)^2 / (ref^2 + 0.01) over channels and pixels without the
                         background; noise: the part of it that is noise, estimated from halves of the samples,
                         rather too high; empty if unknown.

Examples:
  translucid render
  translucid render scenes/bust.ply --preset marble --unit cm -o bust.exr
  translucid render scene.toml --mesh head=head.ply --size 512x512 --spp 256
  translucid render scenes/fruits.toml --time 60
  translucid render scenes/fruits.toml --tev
  translucid render scenes/marble.toml --preview so-far.png --stats statistics.json
  translucid render scenes/plastic.toml --subsurface normalized-diffusion,exact -o models
  translucid render --preset list";

/// Renders a scene file or a mesh; without one the built-in still life
#[derive(Args, Debug, Default)]
#[command(after_long_help = format!("{EXAMPLES}\n\n{}", watch::HELP), after_help = "More, and examples: --help")]
pub(crate) struct Arguments {
    /// Scene file (.toml) or mesh (.glb, .gltf, .obj, .ply, .stl)
    #[arg(value_name = "SCENE|MESH")]
    pub(crate) scene: Option<PathBuf>,
    /// Picture to write, .exr or .png; .shard; with several models a directory
    ///
    /// By default .exr and .png in the current directory, with the scene's name; for several models a directory with that
    /// name and -side-by-side.
    #[arg(short, long, value_name = "FILE|DIR")]
    output: Option<PathBuf>,
    /// Width and height in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Render these pixels only, from (X0, Y0) to just before (X1, Y1)
    ///
    /// (0, 0) is at the top left. They are the same as in the whole picture, bit for bit; the file has their size.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_region)]
    pub(crate) region: Option<[u32; 4]>,
    /// Samples per pixel [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(crate) spp: Option<u32>,
    /// Render samples A to just before B only, into -o FILE.shard
    ///
    /// The whole picture has the scene's samples or --spp.
    #[arg(long, value_name = "A..B", value_parser = parse_range)]
    samples: Option<Range<u32>>,
    /// Render for this long, or until --spp is reached
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    time: Option<Duration>,
    /// Seed of the random numbers [default: the scene's]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Who traces the paths: cpu, gpu, auto, or a part of a device's name [default: cpu]
    ///
    /// `translucid devices` lists them. A device finds the same light by other paths. What a scene needs and devices lack is
    /// refused by name; with auto the processor then traces.
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// Continue from the checkpoint of an unfinished rendering
    #[arg(long)]
    resume: bool,
    /// Interval of checkpoints for --resume [default: 30]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    checkpoint: Option<Duration>,
    /// Model under surfaces (see `translucid models`), or several
    ///
    /// By default the scene's. A material that names none uses random-walk, random-walk-rough if η is above 1, or a
    /// profile if it asks for something that walks cannot do.
    #[arg(long, value_name = "MODEL,...", value_delimiter = ',', hide_possible_values = true)]
    subsurface: Vec<ModelName>,
    /// Model that the others are compared with
    ///
    /// By default random-walk if it is among them, else exact, else the first.
    #[arg(long, value_name = "MODEL", hide_possible_values = true)]
    against: Option<ModelName>,
    /// Find entry points: ray-traced, point-based or cycles-disk
    #[arg(long, value_name = "METHOD", value_parser = parse_method)]
    subsurface_method: Option<SubsurfaceMethod>,
    /// Whether pixels share light below the surface: true or false
    #[arg(long, value_name = "BOOL", hide_possible_values = true)]
    subsurface_sharing: Option<bool>,
    /// Material of a bare mesh; `list` shows all
    #[arg(long, value_name = "NAME", help_heading = MESH_AND_VIEW)]
    pub(crate) preset: Option<String>,
    /// Unit of a bare mesh: mm, cm or m [default: mm, glTF m]
    #[arg(long, hide_possible_values = true, help_heading = MESH_AND_VIEW)]
    pub(crate) unit: Option<UnitName>,
    /// Mesh file for object NAME, or for the only one
    #[arg(long, value_name = "[NAME=]PATH", value_parser = parse_mesh, help_heading = MESH_AND_VIEW)]
    pub(crate) mesh: Vec<(Option<String>, PathBuf)>,
    /// Show the picture as it grows in a running tev
    ///
    /// The image viewer of https://github.com/Tom94/tev, by default at 127.0.0.1:14158.
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true,
        default_missing_value = tev::DEFAULT_ADDRESS, value_parser = parse_address)]
    tev: Option<String>,
    #[command(flatten)]
    watch: WatchArguments,
    /// Denoise the picture with Open Image Denoise (pip install pyoidn)
    #[arg(long)]
    denoise: bool,
    /// Write N pictures, NAME-001 and so on, of one turn
    ///
    /// A bare mesh turns; in a scene the camera turns about its target.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=MOST_PICTURES),
        help_heading = MESH_AND_VIEW)]
    turntable: Option<u32>,
    // The headings hold for all that comes after them
    #[command(flatten, next_help_heading = MESH_AND_VIEW)]
    pub(crate) look: Look,
    #[command(flatten, next_help_heading = PICTURE)]
    pub(crate) tone: Tone,
}

/// Heading of the options for a mesh and for what is seen of a scene.
pub(crate) const MESH_AND_VIEW: &str = "Bare mesh and view";

/// Heading of the options for how a picture is shown.
pub(crate) const PICTURE: &str = "Picture";

/// Most pictures of a turntable.
const MOST_PICTURES: i64 = 3600;

impl Arguments {
    /// Time between two checkpoints: what a power cut may cost.
    fn checkpoint_interval(&self) -> Duration {
        self.checkpoint.unwrap_or(CHECKPOINT_INTERVAL)
    }

    /// The model in place of the scene's, for one picture.
    pub(crate) fn model(&self) -> Result<Option<SubsurfaceModel>, Failure> {
        match self.subsurface[..] {
            [] => Ok(None),
            [name] => Ok(Some(name.model())),
            _ => Err(Failure::input("--subsurface has several models, but this is for one picture")),
        }
    }

    /// Refuses what each shard of a plan has of its own.
    pub(crate) fn refuse_for_plan(&self) -> Result<(), Failure> {
        for (given, option) in [
            (self.samples.is_some(), "--samples"),
            (self.output.is_some(), "--output"),
            (self.time.is_some(), "--time"),
            (self.resume, "--resume"),
            (self.denoise, "--denoise"),
            (self.tev.is_some(), "--tev"),
            (self.turntable.is_some(), "--turntable"),
            (self.watch.stats.is_some(), "--stats"),
            (self.watch.preview.is_some(), "--preview"),
        ] {
            if given {
                let message = format!("after --: {option} cannot be the same for all shards");
                return Err(Failure::input(message).with_help("leave it out, and add it to single commands"));
            }
        }
        Ok(())
    }

    /// The tev that is to show the picture, if one is.
    fn connect_to_tev(&self) -> Result<Option<Tev>, Failure> {
        self.tev.as_deref().map(Tev::connect).transpose()
    }
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    messages::speak_json(arguments.watch.json_progress);
    // What is loaded in parallel is loaded by these threads, too: others could not be refused without a panic
    machine::threads(arguments.threads)?.install(|| run_here(arguments))
}

/// Runs the verb on the current pool.
fn run_here(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.preset.as_deref() == Some("list") {
        return print_presets();
    }
    let models: Vec<SubsurfaceModel> = arguments.subsurface.iter().map(|name| name.model()).collect();
    if models.len() > 1 {
        for (given, option) in [
            (arguments.region.is_some(), "--region"),
            (arguments.samples.is_some(), "--samples"),
            (arguments.denoise, "--denoise"),
            (arguments.watch.stats.is_some(), "--stats"),
            (arguments.turntable.is_some(), "--turntable"),
        ] {
            if given {
                let message = format!("{option} is for one model, but --subsurface has several");
                return Err(
                    Failure::input(message).with_help(format!("leave {option} out, or name one model"))
                );
            }
        }
        return side_by_side::run(arguments, &models);
    }
    if arguments.against.is_some() {
        let help = "name several: --subsurface MODEL,MODEL,...";
        return Err(
            Failure::input("--against compares models, but --subsurface has fewer than two").with_help(help)
        );
    }
    let outputs = outputs(arguments)?;
    check_shard(arguments, &outputs)?;
    outputs.check()?;
    arguments.watch.check(outputs.files())?;
    let _lock = outputs.lock()?;
    if arguments.output.is_none() {
        outputs.spare_others()?;
    }
    if let Some(count) = arguments.turntable {
        return turntable::run(arguments, models.first().copied(), &outputs, count);
    }
    let denoiser = arguments.denoise.then(Denoiser::load).transpose()?.map(Arc::new);
    let tev = arguments.connect_to_tev()?;
    let start = Instant::now();
    let (scene, warnings) = scene(arguments, models.first().copied())?;
    messages::print_warnings(&warnings);
    check_samples(arguments, &scene)?;
    outputs.spare(inputs(arguments, &scene))?;
    arguments.watch.spare(inputs(arguments, &scene))?;
    if messages::is_verbose() {
        let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        let seconds = start.elapsed().as_secs_f64();
        messages::line(&format!(
            "loaded {} objects, {triangles} triangles, {} images in {seconds:.2} s",
            scene.objects.len(),
            scene.images.len()
        ));
    }
    require_memory(&scene)?;
    let loading = start.elapsed();
    note_lamps(arguments, &scene);
    let exposure = &exposure(arguments);
    let task = Task { arguments, outputs, denoiser, tev: tev.as_ref(), part: None, exposure, loading };
    picture::render(scene, &task).map(drop)
}

/// Notes how the lamps of a bare glTF file, which are then the only lights, are taken.
fn note_lamps(arguments: &Arguments, scene: &Scene) {
    let is_gltf = has_extension(arguments, &["gltf", "glb"]);
    let are_lamps = |light: &Light| matches!(light, Light::Spot { .. } | Light::Distant { .. });
    if is_gltf && !messages::is_quiet() && scene.lights.iter().any(are_lamps) {
        messages::print_note("the file's lamps are photometric: 683 cd or lx become 1 W/sr or W/m²");
    }
}

/// How the pictures of the command are exposed: a mesh says nothing of that.
pub(crate) fn exposure(arguments: &Arguments) -> Exposure {
    let is_mesh = arguments.scene.is_some() && !has_extension(arguments, &["toml"]);
    arguments.tone.exposure(is_mesh)
}

fn has_extension(arguments: &Arguments, extensions: &[&str]) -> bool {
    let extension = arguments.scene.as_deref().and_then(Path::extension).unwrap_or_default();
    extensions.iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// The scene with the options' changes and a model in place of its own, if one is given, and what the loader warns of.
pub(crate) fn scene(
    arguments: &Arguments,
    model: Option<SubsurfaceModel>,
) -> Result<(Scene, Vec<Warning>), Failure> {
    scene_turned(arguments, model, arguments.turntable.map(|_| 0.0))
        .map(|(scene, warnings, _)| (scene, warnings))
}

/// As [`scene`], with the orientation of a bare mesh.
pub(crate) fn oriented_scene(
    arguments: &Arguments,
    model: Option<SubsurfaceModel>,
) -> Result<(Scene, Vec<Warning>, Option<Orientation>), Failure> {
    scene_turned(arguments, model, None)
}

/// As [`scene`], with what is seen turned by an angle \[degrees\].
fn scene_turned(
    arguments: &Arguments,
    model: Option<SubsurfaceModel>,
    turn: Option<f64>,
) -> Result<(Scene, Vec<Warning>, Option<Orientation>), Failure> {
    let meter = Arc::new(OnceLock::new());
    let watch = watch(Arc::clone(&meter));
    let options = LoadOptions { turn, watch, ..load_options(arguments, model) };
    let mut warnings = Vec::new();
    let loaded = match &arguments.scene {
        Some(path) => load_oriented(path, &options, &mut warnings).map_err(Failure::from),
        None => built_in(arguments, &options).map(|scene| (scene, None)),
    };
    meter.get().into_iter().for_each(Meter::finish);
    if loaded.is_err() {
        if STOP.load(Ordering::Relaxed) {
            return Err(Failure::interrupted("nothing was rendered yet"));
        }
        messages::print_warnings(&warnings);
    }
    let (mut scene, orientation) = loaded?;
    scene.film = arguments.tone.of(scene.film);
    if let Some(seed) = arguments.seed {
        scene.integrator.seed = seed;
    }
    if let Some(method) = arguments.subsurface_method {
        scene.integrator.subsurface_method = method;
    }
    if let Some(is_shared) = arguments.subsurface_sharing {
        scene.integrator.subsurface_sharing = is_shared;
    }
    scene.integrator.samples_per_pixel = match (arguments.spp, arguments.time) {
        (Some(spp), _) => spp,
        // A part of the samples is one of those that the scene states
        (None, Some(_)) if arguments.samples.is_none() => MAX_SAMPLES,
        (None, _) => scene.integrator.samples_per_pixel,
    };
    Ok((scene, warnings, orientation))
}

/// Refuses what does not go with a shard, and parts of the samples without one.
fn check_shard(arguments: &Arguments, outputs: &Outputs) -> Result<(), Failure> {
    if !outputs.is_shard() {
        return match &arguments.samples {
            Some(Range { start, end }) => {
                let message =
                    format!("--samples is {start}..{end}, but only a shard is of a part of the samples");
                Err(Failure::input(message).with_help("write one with -o FILE.shard"))
            }
            None => Ok(()),
        };
    }
    for (given, option) in [(arguments.denoise, "--denoise"), (arguments.turntable.is_some(), "--turntable")]
    {
        if given {
            let message = format!("{option} is for pictures, but -o names a shard");
            return Err(
                Failure::input(message).with_help("leave it out, or write a picture with -o FILE.exr")
            );
        }
    }
    Ok(())
}

/// Refuses samples beyond those of the picture.
fn check_samples(arguments: &Arguments, scene: &Scene) -> Result<(), Failure> {
    let all = scene.integrator.samples_per_pixel;
    match &arguments.samples {
        Some(Range { start, end }) if *end > all => {
            let message = format!("--samples is {start}..{end}, but the picture has {all} samples per pixel");
            Err(Failure::input(message)
                .with_help(format!("increase them with --spp {end}, for every shard the same")))
        }
        _ => Ok(()),
    }
}

/// Refuses a scene that this process has no memory for.
pub(crate) fn require_memory(scene: &Scene) -> Result<(), Failure> {
    let pixels = PixelRect::whole([scene.film.width, scene.film.height]);
    Session::require_memory(scene, pixels, Session::BYTES_PER_PIXEL).map_err(Failure::of_machine)
}

/// The still life, with what of the options applies to it.
fn built_in(arguments: &Arguments, options: &LoadOptions) -> Result<Scene, Failure> {
    for (given, option) in [
        (arguments.preset.is_some(), "--preset"),
        (arguments.unit.is_some(), "--unit"),
        (!arguments.mesh.is_empty(), "--mesh"),
    ] {
        if given {
            return Err(Failure::input(format!("{option} needs a scene or a mesh")));
        }
    }
    if let Some(option) = arguments.look.of_mesh() {
        return Err(Failure::input(format!("{option} needs a mesh")));
    }
    Ok(still_life(options)?)
}

pub(crate) fn load_options(arguments: &Arguments, model: Option<SubsurfaceModel>) -> LoadOptions {
    arguments.look.of(LoadOptions {
        preset: arguments.preset.clone(),
        unit: arguments.unit.map(Unit::from),
        mesh_overrides: arguments.mesh.clone(),
        size: arguments.size,
        subsurface_model: model,
        ..LoadOptions::default()
    })
}

/// Shows on a meter how far loading is where it takes long, and ends it where Ctrl-C was pressed.
fn watch(meter: Arc<OnceLock<Meter>>) -> LoadWatch {
    let start = Instant::now();
    LoadWatch::new(move |LoadProgress { done, total }| {
        if STOP.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        if start.elapsed() > SOON {
            let new = || Meter::new(CountedIn::Parts).named("loading");
            meter.get_or_init(new).update(done as u64, total as u64);
        }
        ControlFlow::Continue(())
    })
}

/// The files that a picture of the scene must not replace.
fn inputs<'a>(arguments: &'a Arguments, scene: &'a Scene) -> impl Iterator<Item = &'a Path> {
    let images = scene.images.iter().filter_map(|image| image.path.as_deref());
    let meshes = arguments.mesh.iter().map(|(_, path)| path.as_path());
    let tables = scene.profile_tables.iter().map(|table| table.path.as_path());
    arguments.scene.as_deref().into_iter().chain(meshes).chain(images).chain(tables)
}

fn scene_name(arguments: &Arguments) -> String {
    arguments
        .scene
        .as_ref()
        .map_or_else(|| String::from("built-in still life"), |path| path.display().to_string())
}

fn outputs(arguments: &Arguments) -> Result<Outputs, Failure> {
    match &arguments.output {
        Some(path) => Outputs::from_option(path),
        None => Ok(Outputs::in_directory(Path::new(""), stem(arguments))),
    }
}

/// Name of the files where none is given.
fn stem(arguments: &Arguments) -> &OsStr {
    arguments.scene.as_deref().map_or(Path::new("still-life"), Path::new).file_stem().unwrap_or_default()
}

pub(crate) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || String::from("a size is WIDTHxHEIGHT, each in [1, 16384], like 960x540");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let edge =
        |text: &str| text.parse::<u32>().ok().filter(|edge| (1..=16_384).contains(edge)).ok_or_else(wrong);
    Ok([edge(width)?, edge(height)?])
}

/// A half-open range of the numbers of samples.
fn parse_range(text: &str) -> Result<Range<u32>, String> {
    let wrong = || {
        format!(
            "a range is A..B with 0 ≤ A < B ≤ {MAX_SAMPLES}, the samples from A to just before B, like 0..64"
        )
    };
    let (start, end) = text.split_once("..").ok_or_else(wrong)?;
    let number = |text: &str| text.parse::<u32>().map_err(|_| wrong());
    let range = number(start)?..number(end)?;
    if range.is_empty() || range.end > MAX_SAMPLES { Err(wrong()) } else { Ok(range) }
}

fn parse_region(text: &str) -> Result<[u32; 4], String> {
    let wrong =
        || String::from("a region is X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, like 100,50,300,200");
    let numbers: Vec<u32> =
        text.split(',').map(|text| text.trim().parse().ok()).collect::<Option<_>>().ok_or_else(wrong)?;
    match numbers[..] {
        [x0, y0, x1, y1] if x0 < x1 && y0 < y1 => Ok([x0, y0, x1, y1]),
        _ => Err(wrong()),
    }
}

fn parse_method(text: &str) -> Result<SubsurfaceMethod, String> {
    SubsurfaceMethod::from_name(text)
        .ok_or_else(|| String::from("the methods are ray-traced, point-based and cycles-disk"))
}

pub(crate) fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| *seconds > 0.0 && *seconds <= 1e9);
    seconds
        .map(Duration::from_secs_f64)
        .ok_or_else(|| String::from("a time is a number of seconds in (0, 1e9]"))
}

fn parse_address(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').filter(|(host, _)| !host.is_empty()).map(|(_, port)| port.parse());
    match port {
        Some(Ok(1..=u16::MAX)) => Ok(text.to_owned()),
        _ => Err(String::from("an address is HOST:PORT, like 127.0.0.1:14158")),
    }
}

pub(crate) fn parse_mesh(text: &str) -> Result<(Option<String>, PathBuf), String> {
    match text.split_once('=') {
        // A path may itself contain the sign.
        Some((name, path)) if !Path::new(text).exists() => {
            if name.is_empty() || path.is_empty() {
                return Err(String::from("a mesh is NAME=PATH or PATH"));
            }
            Ok((Some(name.to_owned()), path.into()))
        }
        _ if text.is_empty() => Err(String::from("the path is empty")),
        _ => Ok((None, text.into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_is_two_edges_in_range() {
        assert_eq!(parse_size("960x540"), Ok([960, 540]));
        assert_eq!(parse_size("1X16384"), Ok([1, 16384]));
        for wrong in ["", "960", "x", "0x1", "16385x1", "-1x1", "1x1x1", "1.5x2", "99999999999x1"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn region_is_half_open_and_not_empty() {
        assert_eq!(parse_region("1, 2,3,4"), Ok([1, 2, 3, 4]));
        for wrong in ["", "1,2,3", "1,2,3,4,5", "3,2,3,4", "1,4,3,4", "-1,0,1,1", "a,b,c,d", "1.5,0,2,2"] {
            assert!(parse_region(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn range_is_half_open_and_not_empty() {
        assert_eq!(parse_range("3..16777216"), Ok(3..16_777_216));
        for wrong in ["", "3", "3..", "..3", "3..3", "4..3", "-1..3", "0..16777217", "0...3", "0..=3"] {
            assert!(parse_range(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn seconds_are_positive_and_finite() {
        assert_eq!(parse_seconds("1.5"), Ok(Duration::from_millis(1500)));
        for wrong in ["", "0", "-1", "nan", "inf", "1e10", "1s"] {
            assert!(parse_seconds(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn address_has_a_host_and_a_port() {
        for right in ["127.0.0.1:14158", "localhost:1", "[::1]:65535"] {
            assert_eq!(parse_address(right).as_deref(), Ok(right));
        }
        for wrong in ["", "localhost", ":14158", "localhost:", "localhost:0", "localhost:65536", "a:b"] {
            assert!(parse_address(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn mesh_may_have_a_name() {
        assert_eq!(parse_mesh("head=a.obj"), Ok((Some(String::from("head")), "a.obj".into())));
        assert_eq!(parse_mesh("a.obj"), Ok((None, "a.obj".into())));
        for wrong in ["", "=a.obj", "head="] {
            assert!(parse_mesh(wrong).is_err(), "{wrong}");
        }
    }
}
