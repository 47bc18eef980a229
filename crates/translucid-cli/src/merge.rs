//! `translucid merge`: parts of a picture, or of a table of photons, become the whole.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::Args;
use translucid_files::check_writable;
use translucid_image::{Denoiser, Picture, ToneMapping};
use translucid_render::{Gap, ImageInfo, ShardMerge, ShardNotes, available_memory};
use translucid_scene::Film;

use crate::failure::Failure;
use crate::files::input_among;
use crate::output_lock::OutputLock;
use crate::progress::{Meter, Unit, duration};
use crate::render::{Exposure, Outputs, Tone};
use crate::{command_line, interrupt, messages, reference};

/// Most gaps that are listed.
const MOST_GAPS: usize = 8;

const HELP: &str = "\
`translucid render … --samples A..B -o FILE.shard` writes shards, complete or not; checkpoints beside pictures are
shards, too. `translucid reference … --photons A..B --table FILE.npz` writes tables. The result has the bits of one
run, whatever the parts, their order, threads and machines. Merged parts may be merged again.

Examples:
  translucid render scenes/marble.toml --samples 0..32 -o marble-000000-000032.shard
  translucid render scenes/marble.toml --samples 32..64 -o marble-000032-000064.shard
  translucid merge marble.exr marble-000000-000032.shard marble-000032-000064.shard
  translucid merge rack-3.shard node-*.shard
  translucid merge --allow-gaps so-far.exr marble-*.shard
  translucid merge all.npz part-*.npz";

/// Joins shards of a picture, or parts of a photon table
#[derive(Args, Debug)]
#[command(after_help = HELP)]
pub(crate) struct MergeArguments {
    /// Picture (.exr, .png), shard or table (.npz) to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Shards, or tables
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,
    /// Merge although samples or photons are missing
    ///
    /// Every pixel is then the mean of the samples that it has.
    #[arg(long)]
    allow_gaps: bool,
    /// Denoise the picture with Open Image Denoise (pip install pyoidn)
    #[arg(long)]
    denoise: bool,
    #[command(flatten, next_help_heading = "Picture")]
    tone: Tone,
}

/// Runs the verb.
pub(crate) fn run(arguments: &MergeArguments) -> Result<(), Failure> {
    let extension = arguments.output.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("npz") {
        return reference::merge_tables(&arguments.output, &arguments.parts, arguments.allow_gaps);
    }
    let outputs = match Outputs::from_option(&arguments.output) {
        Ok(outputs) => outputs,
        Err(_) => {
            let message =
                format!("OUT is {}, but must end in .exr, .png, .shard or .npz", arguments.output.display());
            return Err(
                Failure::input(message).with_help("the first path is the result, those after it the parts")
            );
        }
    };
    // A shard that is the result is no checkpoint besides it
    let written = || outputs.images().chain(outputs.is_shard().then(|| outputs.main()));
    if let Some(path) = input_among(written(), arguments.parts.iter().map(PathBuf::as_path)) {
        let message = format!("{} is both a part and written by the merge", path.display());
        return Err(
            Failure::input(message).with_help("the first path is the result: name another file there")
        );
    }
    written().try_for_each(check_writable)?;
    let denoiser = arguments.denoise.then(Denoiser::load).transpose()?;
    let _lock = OutputLock::take(outputs.main())?;
    interrupt::catch("\nstopping; nothing is written")?;

    let memory = available_memory().unwrap_or(u64::MAX);
    let merge = joined(&arguments.parts, memory)?;
    let film = merge.film();
    if film.paths() == 0 {
        return Err(Failure::input("none of the parts has a sample, so nothing was written"));
    }
    let planned = planned_samples(&merge);
    let gaps = merge.gaps(planned);
    if !gaps.is_empty() {
        report_gaps(&merge, &gaps, planned, arguments.allow_gaps)?;
    }
    if outputs.is_shard() {
        merge.save(outputs.main()).map_err(Failure::late)?;
    } else {
        let notes = merge.notes();
        let (film_settings, exposure) = display_of(notes, &arguments.tone);
        let denoised =
            denoiser.map(|denoiser| film.denoise(&denoiser, rayon::current_num_threads())).transpose()?;
        let info = ImageInfo {
            scene: notes.scene.clone(),
            seed: notes.seed,
            samples: film.samples(),
            seconds: notes.seconds(),
            command: command_line::shown(),
            place: merge.place(),
            denoised,
        };
        let display = |picture: &Picture<'_>| exposure.display(&film_settings, picture);
        outputs.write(film, display, &info)?;
    }
    print_summary(&merge, arguments.parts.len(), written());
    Ok(())
}

/// All parts together.
fn joined(parts: &[PathBuf], memory: u64) -> Result<ShardMerge, Failure> {
    let mut merge = ShardMerge::new(parts, memory)?;
    let meter = Meter::new(Unit::Parts).named("merging");
    for (number, part) in parts.iter().enumerate() {
        if interrupt::STOP.load(Ordering::Relaxed) {
            return Err(Failure::interrupted("nothing was written: repeat the command"));
        }
        meter.update(number as u64, parts.len() as u64);
        merge.add(part)?;
    }
    meter.finish();
    Ok(merge)
}

/// Samples that the picture is to have; where that was not known, the last that any pixel has.
fn planned_samples(merge: &ShardMerge) -> u32 {
    let ends = merge.film().tiles.iter().flat_map(|tile| tile.taken.as_slice().last());
    ends.map(|range| range.end).chain([merge.notes().samples_per_pixel]).max().unwrap_or(0)
}

/// Reports what is missing; refuses to go on, unless that is allowed.
fn report_gaps(merge: &ShardMerge, gaps: &[Gap], planned: u32, is_allowed: bool) -> Result<(), Failure> {
    let whole = merge.film();
    let size = [0, 0, whole.width, whole.height];
    let words = |Gap { region, samples }: &Gap| {
        let [x0, y0, x1, y1] = region;
        let region = if merge.place().is_none() && *region == size {
            String::new()
        } else {
            format!(" --region {x0},{y0},{x1},{y1}")
        };
        format!("--samples {}..{}{region}", samples.start, samples.end)
    };
    let mut list: Vec<String> = gaps.iter().take(MOST_GAPS).map(words).collect();
    if gaps.len() > MOST_GAPS {
        list.push(format!("{} more", gaps.len() - MOST_GAPS));
    }
    let message = format!("the parts lack {} of {planned} samples per pixel", list.join(", "));
    if is_allowed {
        let fewest = whole.samples();
        messages::print_warning(&format!("{message}; pixels have {fewest} samples or more"));
        return Ok(());
    }
    let help = "render these with the same options, or merge without them with --allow-gaps";
    Err(Failure::work(message).with_help(help))
}

/// How a picture is to be shown: as its scene states, but for the options.
fn display_of(notes: &ShardNotes, tone: &Tone) -> (Film, Exposure) {
    let film = Film::default();
    let tone_mapping = ToneMapping::from_name(&notes.tone_mapping).unwrap_or(film.tone_mapping);
    let film = Film { exposure: notes.exposure.unwrap_or(film.exposure), tone_mapping, ..film };
    (tone.of(film), tone.exposure(notes.exposure.is_none()))
}

fn print_summary<'a>(merge: &ShardMerge, parts: usize, written: impl Iterator<Item = &'a Path>) {
    let (film, notes) = (merge.film(), merge.notes());
    let mut hosts: Vec<&str> = notes.runs.iter().map(|run| run.host.as_str()).collect();
    hosts.sort_unstable();
    hosts.dedup();
    messages::line(&format!(
        "merged {parts} {}: {} samples per pixel at {}x{}, rendered in {} (runs: {}, machines: {})",
        if parts == 1 { "part" } else { "parts" },
        film.samples(),
        film.width,
        film.height,
        duration(notes.seconds()),
        notes.runs.len(),
        hosts.len(),
    ));
    let files: Vec<String> = written.map(|path| path.display().to_string()).collect();
    messages::line(&format!("wrote {}", files.join(" and ")));
}
