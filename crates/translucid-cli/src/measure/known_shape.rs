//! `translucid measure PHOTO --scene SCENE`: parameters of a scene whose picture is the photograph.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use bytemuck::cast_slice;
use glam::Vec3;
use translucid_files::check_writable;
use translucid_image::{KeptData, KeptFile, OutputError, damaged};
use translucid_laboratory::Cell;
use translucid_measure::{Estimate, Guess, KnownShape, Photo, Progress, SEEDS, Unknown};
use translucid_render::{Edit, Event, FilmLayer, Outcome, Plan, PreparedScene, Session, View, content_hash};
use translucid_scene::{ColorInput, Material, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceParameter};

use super::arguments::{MeasureArguments, MeasureFormat};
use super::photograph::{load, part, refusal};
use super::remarks::MISFIT;
use super::report::{CHANNELS, COLUMNS, row, three_digits};
use super::scene_arguments::SceneArguments;
use crate::failure::Failure;
use crate::files::{input_among, write_file};
use crate::model::ModelName;
use crate::output_lock::OutputLock;
use crate::progress::{Meter, Unit};
use crate::render;
use crate::table::{TableFormat, print};
use crate::{interrupt, machine, messages};

/// A fit that is not finished: its numbers and the pictures of its step.
const UNFINISHED: KeptFile =
    KeptFile { magic: *b"trnslFIT", version: 1, name: "unfinished fit", anew: "start the fit anew" };

/// Time between two savings: what a power cut may cost.
const SAVE_INTERVAL: Duration = Duration::from_secs(30);

/// Most pixels: a step keeps twenty pictures of them.
const MOST_PIXELS: usize = 1 << 22;

/// Steps that a fit usually takes, for the time that is left.
const USUAL_STEPS: u64 = 6;

/// Runs the verb with a scene.
pub(super) fn run(arguments: &MeasureArguments, scene: &Path) -> Result<(), Failure> {
    machine::threads(arguments.shape.threads)?.install(|| run_here(arguments, scene))
}

fn run_here(arguments: &MeasureArguments, scene_path: &Path) -> Result<(), Failure> {
    let shape = &arguments.shape;
    let unknowns = unknowns(&shape.fit)?;
    let photo = load(&arguments.photo, arguments)?;
    let (scene, warnings) = scene(shape, scene_path)?;
    messages::print_warnings(&warnings);
    let material = material(&scene, shape.material.as_deref())?;
    let start = start(&scene.materials[material], &unknowns)?;
    let size = [photo.width, photo.height];
    if size != [scene.film.width, scene.film.height].map(|edge| edge as usize) {
        let message = format!(
            "is {}×{} pixels, but the scene's film has {}×{}",
            size[0], size[1], scene.film.width, scene.film.height
        );
        return Err(refusal(&arguments.photo, message).with_help("state the photograph's size in [film]"));
    }
    let region = arguments.region.unwrap_or([0, 0, photo.width, photo.height]);
    let photo = part(&photo, &arguments.photo, "--region", region)?;
    if photo.pixels.len() > MOST_PIXELS {
        let message = format!("has {} pixels to fit, but at most {MOST_PIXELS} are", photo.pixels.len());
        return Err(
            refusal(&arguments.photo, message).with_help("scale it and [film] down, or choose a --region")
        );
    }
    if photo.mean().iter().any(|mean| mean.is_nan() || *mean <= 0.0) {
        return Err(refusal(&arguments.photo, "a channel is black"));
    }

    let checkpoint = shape.checkpoint.clone().unwrap_or_else(|| default_checkpoint(&arguments.photo));
    let inputs = [arguments.photo.as_path(), scene_path].into_iter();
    let outputs = [checkpoint.as_path()].into_iter().chain(arguments.output.as_deref());
    if let Some(path) = input_among(outputs, inputs) {
        return Err(refusal(path, "is a file that is read, and would be written over"));
    }
    check_writable(&checkpoint)?;
    let _lock = OutputLock::take(&checkpoint)?;
    render::require_memory(&scene)?;
    let prepared = PreparedScene::new(scene)?;
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;
    prepared.notes().iter().for_each(|note| messages::print_note(&note.to_string()));

    let mut work = Work::new(prepared, material, region, shape)?;
    let fingerprint = work.fingerprint(&photo, &unknowns);
    let mut fit = KnownShape::new(photo, &unknowns, start);
    go_on(&mut fit, &checkpoint, fingerprint, shape.resume)?;
    let is_stopped = !work.fit(&mut fit, &checkpoint, fingerprint)?;
    if is_stopped {
        interrupt::settle();
        save(&checkpoint, fingerprint, fit.progress()).map_err(Failure::late)?;
        let help = format!("repeat the command with --resume to go on from {}", checkpoint.display());
        return Err(Failure::interrupted(help));
    }
    let _ = fs::remove_file(&checkpoint);
    remarks(&fit);
    let text = match arguments.format {
        MeasureFormat::Text => paragraphs(&fit),
        MeasureFormat::Csv => TableFormat::Csv.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Json => TableFormat::Json.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Toml => toml(&fit, &work.materials()[material], &work.session),
    };
    match &arguments.output {
        Some(path) => write_file(path, text.as_bytes()),
        None => print(&text),
    }
}

fn unknowns(names: &[String]) -> Result<Vec<Unknown>, Failure> {
    let mut found = Vec::new();
    for name in names {
        let unknown = Unknown::ALL.into_iter().find(|unknown| self::name(*unknown) == name.trim());
        let Some(unknown) = unknown else {
            let message = format!(
                "--fit is {name:?}, but the parameters are {}",
                Unknown::ALL.map(self::name).join(", ")
            );
            return Err(Failure::input(message));
        };
        if found.contains(&unknown) {
            return Err(Failure::input(format!("--fit names {} twice", name.trim())));
        }
        found.push(unknown);
    }
    Ok(found)
}

/// Name of a parameter on the command line.
fn name(unknown: Unknown) -> &'static str {
    match unknown {
        Unknown::SurfaceAlbedo => "material.surface_albedo",
        Unknown::Mfp => "material.mfp",
        Unknown::G => "material.g",
        Unknown::Radiance => "light.radiance",
    }
}

fn scene(shape: &SceneArguments, path: &Path) -> Result<(Scene, Vec<translucid_scene::Warning>), Failure> {
    let mut arguments = render::Arguments::default();
    arguments.scene = Some(path.to_owned());
    arguments.mesh.clone_from(&shape.mesh);
    arguments.spp = shape.spp;
    let (scene, warnings) = render::scene(&arguments, shape.subsurface.map(ModelName::model))?;
    if scene.integrator.subsurface_method == SubsurfaceMethod::PointBased {
        let message = "the scene's subsurface_method is point-based, which measuring does not do";
        return Err(refusal(path, message).with_help("use ray-traced"));
    }
    Ok((scene, warnings))
}

/// The material of a name, or the only one that light goes under.
fn material(scene: &Scene, name: Option<&str>) -> Result<usize, Failure> {
    let is_translucent = |material: &Material| material.subsurface_weight.factor > 0.0;
    let is_wanted = |material: &Material| match name {
        Some(name) => material.name == name,
        None => is_translucent(material),
    };
    let found: Vec<usize> = (0..scene.materials.len()).filter(|&i| is_wanted(&scene.materials[i])).collect();
    let names = || {
        let names: Vec<&str> =
            scene.materials.iter().filter(|m| is_translucent(m)).map(|m| m.name.as_str()).collect();
        if names.is_empty() { String::from("none") } else { names.join(", ") }
    };
    match (name, &found[..]) {
        (_, &[one]) if is_translucent(&scene.materials[one]) => Ok(one),
        (Some(name), &[_]) => {
            Err(Failure::input(format!("--material is {name}, but its subsurface_weight is 0"))
                .with_help(format!("translucent materials: {}", names())))
        }
        (Some(name), _) => {
            let message = format!("--material is {name}, but the scene has {} of that name", found.len());
            Err(Failure::input(message).with_help(format!("translucent materials: {}", names())))
        }
        (None, &[]) => Err(Failure::input("no material of the scene has a subsurface_weight above 0")),
        (None, _) => Err(Failure::input(format!("the scene has {} translucent materials", found.len()))
            .with_help(format!("say which one by --material: {}", names()))),
    }
}

/// The material's own values, where the fit starts.
fn start(material: &Material, unknowns: &[Unknown]) -> Result<Guess, Failure> {
    let Material { subsurface_color: albedo, subsurface_radius: radius, .. } = material;
    let scale = &material.subsurface_radius_scale;
    let refuse = |message: String| Err(Failure::input(format!("material {}: {message}", material.name)));
    let is_textured = albedo.texture.is_some() || albedo.vertex_color;
    if unknowns.contains(&Unknown::SurfaceAlbedo) && is_textured {
        return refuse(String::from("subsurface_color is an image, of which no single number can be found"));
    }
    let is_textured = radius.texture.is_some() || scale.texture.is_some() || scale.vertex_color;
    if unknowns.contains(&Unknown::Mfp) {
        if is_textured {
            return refuse(String::from(
                "subsurface_radius is an image, of which no single number can be found",
            ));
        }
        if material.subsurface_parameter != SubsurfaceParameter::Mfp {
            return refuse(String::from("subsurface_parameter is dmfp, but material.mfp needs mfp"));
        }
    }
    let clamped = |color: Vec3, low: f64, high: f64| color.to_array().map(|v| f64::from(v).clamp(low, high));
    let mfp = scale.factor * radius.factor;
    if unknowns.contains(&Unknown::Mfp) && mfp.min_element() <= 0.0 {
        return refuse(String::from("the fit starts at its mean free path, which must be above 0"));
    }
    Ok(Guess {
        surface_albedo: clamped(albedo.factor, 1e-3, 0.999),
        mfp: clamped(mfp, 1e-12, 1e12),
        g: f64::from(material.subsurface_scatter_anisotropy).clamp(-0.95, 0.95),
        radiance: [1.0; 3],
    })
}

fn default_checkpoint(photo: &Path) -> PathBuf {
    let mut name = photo.file_name().unwrap_or_default().to_owned();
    name.push(".fit");
    PathBuf::from(name)
}

/// Takes up an unfinished fit, if that is wanted and there is one.
fn go_on(fit: &mut KnownShape, path: &Path, fingerprint: u64, resume: bool) -> Result<(), Failure> {
    if !path.exists() {
        if resume {
            messages::line(&format!("there is no {} yet: starting anew", path.display()));
        }
        return Ok(());
    }
    if !UNFINISHED.is_at(path) {
        let message = "is no unfinished fit, and would be replaced by one";
        return Err(refusal(path, message).with_help("name another file with --checkpoint"));
    }
    if resume {
        let progress = UNFINISHED.load(path, fingerprint, read)?;
        let [width, height] = fit.size();
        if progress.pictures.iter().any(|picture| [picture.width, picture.height] != [width, height]) {
            return Err(refusal(path, "its pictures have another size than the photograph"));
        }
        fit.resume(progress);
    } else {
        let message =
            format!("the unfinished fit {} will be replaced; --resume goes on from it", path.display());
        messages::print_note(&message);
    }
    Ok(())
}

fn save(path: &Path, fingerprint: u64, progress: &Progress) -> Result<(), OutputError> {
    UNFINISHED.save(path, fingerprint, |out| {
        let Progress { guess, best, pictures, steps, retreats, .. } = progress;
        let [width, height] = pictures.first().map_or([0, 0], |picture| [picture.width, picture.height]);
        let counts = [pictures.len(), width, height, *steps as usize, *retreats as usize];
        out.write_all(cast_slice(&counts.map(|count| count as u64)))?;
        let (least_guess, least) = best.unwrap_or((*guess, f64::NAN));
        out.write_all(cast_slice(&numbers(guess)))?;
        out.write_all(cast_slice(&numbers(&least_guess)))?;
        out.write_all(&least.to_ne_bytes())?;
        pictures.iter().try_for_each(|picture| out.write_all(cast_slice(&picture.pixels)))
    })
}

/// Most pictures of a step.
const MOST_PICTURES: u64 = (SEEDS * (1 + 2 * Unknown::ALL.len())) as u64;

fn read(data: &mut KeptData<'_>) -> std::io::Result<Progress> {
    let [count, width, height, steps, retreats]: [u64; 5] = {
        let mut counts = [0; 5];
        data.fill(&mut counts)?;
        counts
    };
    let pixels = width.checked_mul(height).filter(|pixels| *pixels <= 1 << 32);
    let Some(pixels) = pixels.filter(|_| count < MOST_PICTURES && steps < 1000 && retreats < 1000) else {
        return Err(damaged("its counts are out of range"));
    };
    data.require_length(8 * (5 + 2 * NUMBERS as u64 + 1) + 12 * pixels * count)?;
    let mut read_guess = || -> std::io::Result<Guess> {
        let mut values = [0.0_f64; NUMBERS];
        data.fill(&mut values)?;
        let [r, g, b, mfp_r, mfp_g, mfp_b, mean_cosine, light_r, light_g, light_b] = values;
        if values.iter().any(|value| !value.is_finite()) {
            return Err(damaged("a parameter is no number"));
        }
        Ok(Guess {
            surface_albedo: [r, g, b],
            mfp: [mfp_r, mfp_g, mfp_b],
            g: mean_cosine,
            radiance: [light_r, light_g, light_b],
        })
    };
    let (guess, best) = (read_guess()?, read_guess()?);
    let least: f64 = data.read()?;
    let mut pictures = Vec::new();
    for _ in 0..count {
        let mut values = vec![[0.0_f32; 3]; pixels as usize];
        data.fill(&mut values)?;
        pictures.push(Photo { width: width as usize, height: height as usize, pixels: values });
    }
    let best = (!least.is_nan()).then_some((best, least));
    Ok(Progress { guess, best, pictures, steps: steps as u32, retreats: retreats as u32, is_done: false })
}

/// Numbers of a guess.
const NUMBERS: usize = 10;

fn numbers(guess: &Guess) -> [f64; NUMBERS] {
    let [r, g, b] = guess.surface_albedo;
    let [mfp_r, mfp_g, mfp_b] = guess.mfp;
    let [light_r, light_g, light_b] = guess.radiance;
    [r, g, b, mfp_r, mfp_g, mfp_b, guess.g, light_r, light_g, light_b]
}

/// The renderer of a fit.
struct Work {
    session: Session,
    views: [View; SEEDS],
    material: usize,
    samples: u32,
}

impl Work {
    fn new(
        prepared: PreparedScene,
        material: usize,
        region: [usize; 4],
        shape: &SceneArguments,
    ) -> Result<Self, Failure> {
        let scene = prepared.scene();
        let samples = scene.integrator.samples_per_pixel;
        // Others than those that a photograph of `render` has
        let seed = |number: u64| {
            let mixed = (shape.seed.unwrap_or(0) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            mixed.wrapping_add(number)
        };
        let view = |number: u64| -> Result<View, Failure> {
            let view = View::new(scene.camera, scene.film, seed(number))?;
            Ok(view.with_region(region.map(|edge| edge as u32))?)
        };
        let views = [view(0)?, view(1)?];
        let first = views[0].clone();
        Ok(Self { session: Session::new(prepared, first), views, material, samples })
    }

    fn materials(&self) -> &[Material] {
        &self.session.prepared().scene().materials
    }

    /// A number that differs where pictures, photograph or parameters do.
    fn fingerprint(&self, photo: &Photo, unknowns: &[Unknown]) -> u64 {
        let scene = self.session.prepared().fingerprint(&self.views[0]);
        let region = self.views[0].region();
        let mut text =
            format!("{scene:?} {region:?} {unknowns:?} {} {}", self.samples, self.material).into_bytes();
        text.extend_from_slice(cast_slice(&photo.pixels));
        u64::from_str_radix(&content_hash(&text).replace('#', ""), 16).unwrap_or(0)
    }

    /// Renders until the parameters are found; false where it was stopped.
    fn fit(&mut self, fit: &mut KnownShape, path: &Path, fingerprint: u64) -> Result<bool, Failure> {
        let of_step = fit.pictures_of_a_step() as u64;
        let done = |fit: &KnownShape| {
            let Progress { steps, pictures, .. } = fit.progress();
            u64::from(*steps) * of_step + pictures.len() as u64
        };
        let samples = u64::from(self.samples) * self.views[0].region().area();
        let meter = Meter::new(Unit::Samples).between(done(fit) * samples, None);
        let mut saved = Instant::now();
        while let Some(request) = fit.next() {
            let before = done(fit);
            let total = (USUAL_STEPS * of_step).max(before.next_multiple_of(of_step)).max(of_step);
            let Some(picture) = self.picture(&request, &|count| {
                meter.update(before * samples + count, total * samples);
            })?
            else {
                meter.finish();
                return Ok(false);
            };
            let steps = fit.progress().steps;
            fit.take(picture);
            if fit.progress().steps > steps && messages::is_verbose() {
                let shown: Vec<String> =
                    fit.estimates().iter().map(|e| format!("{} {}", label(e), shown(e))).collect();
                meter.suspend(|| messages::line(&format!("step {}: {}", steps + 1, shown.join(", "))));
            }
            if saved.elapsed() > SAVE_INTERVAL && fit.next().is_some() {
                save(path, fingerprint, fit.progress()).map_err(Failure::late)?;
                saved = Instant::now();
            }
        }
        meter.finish();
        Ok(true)
    }

    /// Renders a picture; none where it was stopped.
    fn picture(
        &mut self,
        request: &translucid_measure::Request,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Option<Photo>, Failure> {
        let material = self.materials()[self.material].clone();
        let guess = &request.guess;
        let vector = |values: [f64; 3]| ColorInput::constant(Vec3::from_array(values.map(|v| v as f32)));
        let mut new = Material { subsurface_scatter_anisotropy: guess.g as f32, ..material };
        // What is textured is not to be found
        if new.subsurface_color.texture.is_none() && !new.subsurface_color.vertex_color {
            new.subsurface_color = vector(guess.surface_albedo);
        }
        let scale = &new.subsurface_radius_scale;
        let is_textured =
            new.subsurface_radius.texture.is_some() || scale.texture.is_some() || scale.vertex_color;
        if !is_textured {
            new.subsurface_radius = ScalarInput::constant(1.0);
            new.subsurface_radius_scale = vector(guess.mfp);
        }
        self.session.edit(Edit::Material(self.material, Box::new(new)))?;
        self.session.set_view(self.views[request.seed].clone());
        let observer = |event: &Event<'_>| {
            if let Event::Samples(progress) = event {
                done(progress.samples_done);
            }
        };
        let outcome = self.session.run(&Plan::samples(self.samples), &observer, &interrupt::STOP)?;
        if outcome != Outcome::Finished {
            return Ok(None);
        }
        let region = self.session.view().region();
        let values = self.session.film().layer(FilmLayer::Radiance);
        let pixels = values.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Ok(Some(Photo { width: region.width as usize, height: region.height as usize, pixels }))
    }
}

fn quantity(unknown: Unknown) -> [&'static str; 2] {
    match unknown {
        Unknown::SurfaceAlbedo => ["surface_albedo", ""],
        Unknown::Mfp => ["mfp", "scene unit"],
        Unknown::G => ["g", ""],
        Unknown::Radiance => ["radiance_scale", ""],
    }
}

fn channel(estimate: &Estimate) -> &'static str {
    estimate.channel.map_or("all", |channel| CHANNELS[channel])
}

fn label(estimate: &Estimate) -> String {
    format!("{} {}", channel(estimate), quantity(estimate.unknown)[0])
}

fn shown(estimate: &Estimate) -> String {
    let [low, high] = estimate.interval.sure.map(three_digits);
    format!("{} ({low} to {high})", three_digits(estimate.interval.value))
}

fn rows(fit: &KnownShape) -> Vec<Vec<Cell>> {
    let row = |estimate: &Estimate| {
        let [quantity, unit] = quantity(estimate.unknown);
        row(channel(estimate), quantity, estimate.interval, unit)
    };
    fit.estimates().iter().map(row).collect()
}

fn paragraphs(fit: &KnownShape) -> String {
    let lines = fit.estimates().into_iter().map(|estimate| {
        let [quantity, _] = quantity(estimate.unknown);
        format!("{:<6} {quantity:<14} {}\n", channel(&estimate), shown(&estimate))
    });
    let lines: String = lines.collect();
    format!(
        "{lines}\nIn parentheses the 95 % confidence interval; lengths in the scene's unit. {} steps.\n",
        fit.progress().steps
    )
}

fn toml(fit: &KnownShape, material: &Material, session: &Session) -> String {
    let guess = &fit.progress().guess;
    let list = |values: [f64; 3]| values.map(three_digits).join(", ");
    format!(
        "unit = \"{}\"\n\n[[material]]\nname = \"{}\"\nsubsurface_weight = 1\nsubsurface_color = [{}]\n\
         subsurface_radius = 1\nsubsurface_radius_scale = [{}]\nsubsurface_scatter_anisotropy = {}\n",
        session.prepared().scene().unit.name(),
        material.name.replace(['"', '\\'], "_"),
        list(guess.surface_albedo),
        list(guess.mfp),
        three_digits(guess.g)
    )
}

/// Standard error of ln ℓ, ln A/(1 − A) or artanh g from which on the picture does not tell a parameter.
const UNTOLD: f64 = 0.5;

/// What limits the measurement, in plain sentences.
fn remarks(fit: &KnownShape) {
    for estimate in fit.estimates() {
        if estimate.standard_error.is_nan() || estimate.standard_error > UNTOLD {
            let [low, high] = estimate.interval.sure.map(three_digits);
            messages::print_note(&format!(
                "the picture does not tell {}: it may be {low} to {high}",
                label(&estimate)
            ));
        }
    }
    if !fit.has_converged() {
        messages::print_warning(&format!(
            "the fit did not settle in {} steps: the intervals do not hold; more --spp, or fewer parameters, may help",
            fit.progress().steps
        ));
    }
    if fit.misfit() > MISFIT {
        messages::print_warning(&format!(
            "the picture is not that of the scene: neighboring pixels are off together, by {:.1} times what noise \
             would (another shape, camera or light, a surface that is not smooth, a camera's curve?)",
            fit.misfit().sqrt()
        ));
    }
}
