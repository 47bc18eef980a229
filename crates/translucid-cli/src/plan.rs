//! `translucid plan`: a picture as shards for many processes or machines.

use std::ffi::OsString;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::Args;
use serde_json::{Value, json};
use translucid_image::PixelRect;
use translucid_render::{FilmSums, Fraction, Goal, LiveFilm, PreparedScene};

use crate::failure::Failure;
use crate::progress::duration;
use crate::table::print;
use crate::{interrupt, machine, messages, render};

/// Most shards of a plan.
const MOST_SHARDS: u32 = 1 << 20;
/// Time spent to find out how long a sample takes.
const TRIAL: Duration = Duration::from_secs(3);

const HELP: &str = "\
Prints one JSON object:
  scene, size, samples_per_pixel
  seconds_to_prepare, seconds_per_sample   with --minutes: as measured on this machine
  shards: [{samples: [A, B], region: [X0, Y0, X1, Y1] or null, output, command}, …]
  merge: the command that joins them
Commands are lists of words. They may run anywhere, in any order and repeatedly; the picture is that of one run.
Samples are divided first. With more shards than samples the picture is divided, too; small parts cost more, because
light is shared across their edges.

Examples:
  translucid plan scenes/marble.toml --shards 16
  translucid plan scenes/fruits.toml --minutes 30 -o frames/fruits.exr -- --size 3840x2160 --spp 1024";

/// Divides a picture into shards, as JSON for any queue
#[derive(Args, Debug)]
#[command(after_help = HELP)]
#[command(group(clap::ArgGroup::new("division").required(true)))]
pub(crate) struct PlanArguments {
    /// Scene file (.toml) or mesh, as for `translucid render`
    #[arg(value_name = "SCENE|MESH")]
    scene: PathBuf,
    /// Number of shards
    #[arg(long, value_name = "N", group = "division", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SHARDS)))]
    shards: Option<u32>,
    /// Minutes that a shard takes on this machine, loading included
    #[arg(long, value_name = "M", group = "division", value_parser = parse_minutes)]
    minutes: Option<f64>,
    /// Picture that the shards become [default: the scene's name, .exr]
    #[arg(short, long, value_name = "FILE.exr")]
    output: Option<PathBuf>,
    /// Options of `translucid render`, after --
    #[arg(last = true, value_name = "OPTION")]
    options: Vec<OsString>,
}

/// Samples and pixels of a shard.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    samples: Range<u32>,
    /// From (x0, y0) to just before (x1, y1); none for all of the picture.
    region: Option<[u32; 4]>,
}

impl Part {
    /// Names the shard after its samples and region, so that shards of another plan for the same picture stay apart.
    fn file_name(&self, stem: &str) -> String {
        let Range { start, end } = self.samples;
        let region =
            self.region.map(|edges| edges.map(|edge| format!("-{edge}")).concat()).unwrap_or_default();
        format!("{stem}-{start:06}-{end:06}{region}.shard")
    }
}

/// Reads the words after `translucid render`.
type ParseRender = dyn Fn(&mut dyn Iterator<Item = OsString>) -> clap::error::Result<render::Arguments>;

/// Runs the verb.
pub(crate) fn run(arguments: &PlanArguments, parse: &ParseRender) -> Result<(), Failure> {
    let options = render_arguments(arguments, parse)?;
    let start = Instant::now();
    let (scene, warnings) = render::scene(&options, options.model()?)?;
    messages::print_warnings(&warnings);
    let film = scene.film;
    let region = match options.region {
        Some([x0, y0, x1, y1]) => PixelRect { left: x0, top: y0, width: x1 - x0, height: y1 - y0 },
        None => PixelRect::whole([film.width, film.height]),
    };
    let samples = scene.integrator.samples_per_pixel;
    let (count, times) = match (arguments.shards, arguments.minutes) {
        (Some(count), _) => (count, None),
        (None, minutes) => {
            let times = machine::threads(options.threads)?.install(|| trial(scene, region, start))?;
            let [preparing, per_sample] = times;
            let seconds = 60.0 * minutes.unwrap_or_default() - preparing;
            if seconds <= 0.0 {
                let message =
                    format!("--minutes is too little: preparing the scene takes {}", duration(preparing));
                return Err(Failure::input(message));
            }
            let count = (per_sample * f64::from(samples) / seconds).ceil().max(1.0);
            if count > f64::from(MOST_SHARDS) {
                return Err(Failure::input(format!(
                    "that would be {count:.0} shards, more than {MOST_SHARDS}"
                ))
                .with_help("give each more --minutes"));
            }
            (count as u32, Some(times))
        }
    };
    let parts = divide(samples, region, options.region.is_some(), count);
    print(&format!("{:#}\n", plan(arguments, [film.width, film.height], samples, &parts, times)))
}

/// The options of a rendering, which the plan's commands repeat.
fn render_arguments(arguments: &PlanArguments, parse: &ParseRender) -> Result<render::Arguments, Failure> {
    let scene = std::iter::once(arguments.scene.clone().into());
    let options = parse(&mut scene.chain(arguments.options.iter().cloned())).map_err(|error| {
        let text = error.to_string();
        let message = text.lines().next().unwrap_or_default().trim_start_matches("error: ");
        Failure::input(format!("after --: {message}"))
            .with_help("what follows -- are options of `translucid render`")
    })?;
    options.refuse_for_plan()?;
    Ok(options)
}

/// Time to load and prepare a scene, and time of a sample of all pixels \[s\], on the current pool.
fn trial(scene: translucid_scene::Scene, region: PixelRect, start: Instant) -> Result<[f64; 2], Failure> {
    let prepared = PreparedScene::new(scene)?;
    let preparing = start.elapsed().as_secs_f64();
    interrupt::catch("\nstopping")?;
    let [x1, y1] = [region.left + region.width, region.top + region.height];
    let view = prepared.view()?.with_region([region.left, region.top, x1, y1])?.at(Fraction::Eighth);
    let film = LiveFilm::new(FilmSums::new(view.region().width, view.region().height));
    let begin = Instant::now();
    let goal = Goal { samples: 0..1 << 16, deadline: Some(begin + TRIAL) };
    prepared.render(&view, &film, &goal, &|_| {}, &interrupt::STOP);
    if interrupt::STOP.load(Ordering::Relaxed) {
        return Err(Failure::interrupted("nothing was planned"));
    }
    let paths = film.sums().paths().max(1) as f64;
    let per_sample = begin.elapsed().as_secs_f64() * region.area() as f64 / paths;
    let (threads, shown) = (rayon::current_num_threads(), duration(per_sample));
    messages::line(&format!(
        "a sample takes about {shown} on {threads} threads, loading and preparing {}",
        duration(preparing)
    ));
    Ok([preparing, per_sample])
}

/// So many parts, or a few more where the picture is divided, into cells that are about square: light is shared across their
/// edges, so that each renders some pixels around it.
fn divide(samples: u32, region: PixelRect, is_part: bool, count: u32) -> Vec<Part> {
    let cells = count.div_ceil(samples);
    let square = (f64::from(cells) * f64::from(region.width) / f64::from(region.height)).sqrt();
    let columns = (square.round() as u32).clamp(1, region.width.min(cells));
    let rows = cells.div_ceil(columns).min(region.height);
    let ranges = count.div_ceil(columns * rows).min(samples);
    let at = |number: u32, of: u32, size: u32| (u64::from(number) * u64::from(size) / u64::from(of)) as u32;
    let span = |number: u32, of: u32, start: u32, size: u32| {
        [number, number + 1].map(|number| start + at(number, of, size))
    };
    let cell = |number: u32| {
        let [left, right] = span(number % columns, columns, region.left, region.width);
        let [top, bottom] = span(number / columns, rows, region.top, region.height);
        (is_part || columns * rows > 1).then_some([left, top, right, bottom])
    };
    let parts = (0..ranges).flat_map(|range| {
        let samples = at(range, ranges, samples)..at(range + 1, ranges, samples);
        (0..columns * rows).map(move |number| Part { samples: samples.clone(), region: cell(number) })
    });
    parts.collect()
}

fn plan(
    arguments: &PlanArguments,
    size: [u32; 2],
    samples: u32,
    parts: &[Part],
    times: Option<[f64; 2]>,
) -> Value {
    let text = |word: &std::ffi::OsStr| word.to_string_lossy().into_owned();
    let output = arguments.output.clone().unwrap_or_else(|| {
        let stem = arguments.scene.file_stem().unwrap_or_default();
        PathBuf::from(stem).with_extension("exr")
    });
    let options: Vec<String> = without_region(arguments.options.iter().map(|word| text(word)));
    let mut merge = vec![String::from("translucid"), String::from("merge"), text(output.as_os_str())];
    let shards = parts.iter().map(|part| {
        let name = part.file_name(&text(output.file_stem().unwrap_or_default()));
        let name = text(output.with_file_name(name).as_os_str());
        merge.push(name.clone());
        let Range { start, end } = part.samples;
        let mut command = ["translucid", "render"].map(String::from).to_vec();
        command.push(text(arguments.scene.as_os_str()));
        command.extend(options.iter().cloned());
        command.extend([String::from("--samples"), format!("{start}..{end}")]);
        if let Some(region) = part.region {
            command.extend([String::from("--region"), region.map(|edge| edge.to_string()).join(",")]);
        }
        command.extend([String::from("-o"), name.clone()]);
        json!({ "samples": [start, end], "region": part.region, "output": name, "command": command })
    });
    let shards: Vec<Value> = shards.collect();
    json!({
        "scene": text(arguments.scene.as_os_str()),
        "size": size,
        "samples_per_pixel": samples,
        "seconds_to_prepare": times.map(|[preparing, _]| preparing),
        "seconds_per_sample": times.map(|[_, per_sample]| per_sample),
        "shards": shards,
        "merge": merge,
    })
}

/// The options but for a region: every shard has its own.
fn without_region(options: impl Iterator<Item = String>) -> Vec<String> {
    let mut kept = Vec::new();
    let mut is_value = false;
    for option in options {
        if is_value {
            is_value = false;
        } else if option == "--region" {
            is_value = true;
        } else if !option.starts_with("--region=") {
            kept.push(option);
        }
    }
    kept
}

fn parse_minutes(text: &str) -> Result<f64, String> {
    let minutes = text.parse().ok().filter(|minutes| *minutes > 0.0 && *minutes <= 1e6);
    minutes.ok_or_else(|| String::from("a time is a number of minutes in (0, 1e6]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_all_of_the_picture_once() {
        let region = PixelRect { left: 3, top: 5, width: 40, height: 30 };
        for (samples, count) in [(64, 1), (64, 7), (64, 64), (64, 65), (4, 200), (1, 1 << 20), (1, 1)] {
            let parts = divide(samples, region, false, count);
            let area = |part: &Part| {
                let rect = part
                    .region
                    .map_or(u64::from(40_u32 * 30), |[x0, y0, x1, y1]| u64::from((x1 - x0) * (y1 - y0)));
                rect * part.samples.len() as u64
            };
            assert_eq!(parts.iter().map(area).sum::<u64>(), 1200 * u64::from(samples), "{samples} {count}");
            assert!(parts.iter().all(|part| area(part) > 0));
            let most = samples * region.width * region.height;
            assert!(parts.len() as u32 >= count.min(most) && parts.len() as u32 <= (2 * count).min(most));
        }
    }

    #[test]
    fn shards_of_different_parts_have_different_names() {
        let region = PixelRect { left: 0, top: 0, width: 40, height: 30 };
        let parts: Vec<Part> = [(10, 3), (12, 3), (12, 4), (2, 8)]
            .into_iter()
            .flat_map(|(samples, count)| divide(samples, region, false, count))
            .collect();
        for (i, a) in parts.iter().enumerate() {
            assert!(
                parts[..i].iter().all(|b| (a == b) == (a.file_name("head") == b.file_name("head"))),
                "{a:?}"
            );
        }
        assert_eq!(parts[1].file_name("head"), "head-000003-000006.shard");
        assert_eq!(parts.last().unwrap().file_name("head"), "head-000001-000002-20-15-40-30.shard");
    }

    #[test]
    fn region_of_the_options_gives_way() {
        let words = ["--spp", "4", "--region", "0,0,9,9", "--region=1,1,2,2", "-q"].map(String::from);
        assert_eq!(without_region(words.into_iter()), ["--spp", "4", "-q"]);
    }
}
