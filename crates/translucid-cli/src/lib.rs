//! The `translucid` command: renders, profiles and samples translucent materials, and knows their ground truth.
//!
//! Thin verbs over the crates: data goes to files and stdout, messages and progress to stderr.
//! Exit codes: 0 done, 2 the input is wrong (the message says what and where), 75 another process is writing the output,
//! 128 + N stopped by signal N (130 Ctrl-C, 143 SIGTERM), 1 anything else.

mod ask;
mod command_line;
mod compare;
mod completions;
mod devices;
mod export;
mod failure;
mod files;
mod fit;
mod interrupt;
mod machine;
#[cfg(test)]
#[path = "../tests/it/markdown.rs"]
#[allow(dead_code, reason = "unit tests read no links")]
mod markdown;
mod measure;
mod merge;
mod messages;
mod model;
mod models;
mod output_lock;
mod plan;
mod profile;
mod progress;
mod radii;
mod reference;
mod render;
mod sample;
mod table;
mod textures;
mod view;

use std::ffi::OsString;
use std::panic::AssertUnwindSafe;
use std::path::Path;
use std::time::Duration;

use clap::builder::UnknownArgumentValueParser;
use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Command, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::failure::Failure;
use crate::messages::Verbosity;

/// Subsurface scattering you can trust: renders translucent materials and evaluates their profiles.
///
/// Without a verb it renders a small picture of the built-in still life to still-life.exr and still-life.png, in about a
/// minute on two cores; after Ctrl-C, --resume continues it.
#[derive(Parser)]
#[command(name = "translucid", version, after_help = EXAMPLES, override_usage = "translucid [OPTIONS] [COMMAND]")]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Print errors, warnings and notes only
    #[arg(short, long, global = true, display_order = 100, conflicts_with = "verbose")]
    quiet: bool,
    /// Print more: the time of each step, the model of each material
    #[arg(short, long, global = true, display_order = 101)]
    verbose: bool,
    /// Wait up to this long for an output that another process is writing
    #[arg(long, value_name = "SECONDS", global = true, display_order = 102, hide_short_help = true,
        value_parser = render::parse_seconds, allow_negative_numbers = true)]
    wait: Option<Duration>,
}

#[derive(Subcommand)]
enum Verb {
    Render(render::Arguments),
    Merge(merge::MergeArguments),
    Plan(plan::PlanArguments),
    Profile(profile::ProfileArguments),
    Sample(sample::SampleArguments),
    Reference(reference::ReferenceArguments),
    #[command(flatten)]
    Asked(ask::Asked),
    Fit(fit::FitArguments),
    Compare(compare::CompareArguments),
    Export(export::ExportArguments),
    Measure(measure::MeasureArguments),
    View(view::ViewArguments),
    /// Lists the models of subsurface scattering
    Models,
    /// Lists who can trace paths for `render` and walk photons for `reference`, by `--device`
    Devices,
    Completions(completions::CompletionsArguments),
}

/// Words that the command without any is short for.
const FIRST_PICTURE: [&str; 5] = ["render", "--size", "640x360", "--spp", "20"];

const EXAMPLES: &str = "\
Examples:
  translucid
  translucid render scenes/bust.ply --preset marble --unit cm --size 800x800 --spp 128
  translucid view scenes/bust.ply --preset marble --unit cm
  translucid profile --surface-albedo 0.8 --mfp 1 --points 100 --max 10
  translucid reference --method exact --surface-albedo 0.8 --points 100 --max 10
  translucid stack examples/stack/enamel.toml -o enamel.svg
  translucid fit --configuration searchlight --parameter mfp --family burley
  translucid compare -o comparison --surface-albedo 0.2,0.5,0.8
  translucid convert --from renderman:dmfp=2 --surface-albedo 0.8 --format text
  translucid export --to glsl --what sampler
  translucid measure examples/photographs/soap.png --mm-per-pixel 0.125 --white 210,18,222,30
  translucid oracle -o oracle
  translucid judge examples/judge/right.exr --setup disk --size 2 --pixel 0.1 --surface-albedo 0.9,0.6,0.4 --mfp 0.5,0.35,0.25 --white 1
  translucid skin --tone III
  translucid help render

Exit codes: 0 done, 2 the input is wrong, 75 another process is writing the output (see --wait),
128 + N stopped by signal N (130 Ctrl-C, 143 SIGTERM, 129 SIGHUP), 1 anything else.";

/// Runs the command of these words, the program's own first, and returns its exit code.
///
/// It writes to stdout, stderr and files as the program does. The process goes on after it, unless Ctrl-C is pressed
/// twice while something is rendered or computed.
pub fn run(words: impl IntoIterator<Item = impl Into<OsString>>) -> u8 {
    let mut words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    let is_bare = words
        .iter()
        .skip(1)
        .all(|word| ["-q", "--quiet", "-v", "--verbose", "--resume"].map(OsString::from).contains(word));
    if is_bare {
        let options = words.split_off(words.len().min(1));
        words.extend(FIRST_PICTURE.map(OsString::from));
        words.extend(options);
    }
    let cli = match parse(&words) {
        Ok(cli) => cli,
        Err(mut answer) => {
            suggest_render(&mut answer);
            // Help and versions are such an answer, too
            if let Err(error) = answer.print()
                && error.kind() != std::io::ErrorKind::BrokenPipe
            {
                return 1;
            }
            return u8::try_from(answer.exit_code()).unwrap_or(1);
        }
    };
    command_line::set(words);
    interrupt::forget();
    output_lock::set_patience(cli.wait.unwrap_or_default());
    messages::set_verbosity(match (cli.quiet, cli.verbose) {
        (true, _) => Verbosity::Quiet,
        (_, true) => Verbosity::Verbose,
        _ => Verbosity::Usual,
    });
    messages::speak_json(false);
    let is_bare = is_bare && !cli.quiet;
    if is_bare {
        messages::line(&format!("short for: {}", command_line::shown()));
    }
    // A defect must not look like an answer: its exit code is 1, as for anything that is not the input's
    // fault. The message has then been printed by the panic itself.
    match std::panic::catch_unwind(AssertUnwindSafe(|| run_verb(cli))) {
        Ok(Ok(())) => {
            if is_bare {
                messages::line("for all pixels and samples run: translucid render");
            }
            0
        }
        Ok(Err(failure)) => {
            messages::print_failure(&failure);
            failure.exit_code().unwrap_or_else(interrupt::exit_code)
        }
        Err(_) => {
            messages::print_note("this is a defect of translucid: please report it with the message above");
            1
        }
    }
}

/// Options of `render` by their names in other renderers, and what they are called here.
const FOREIGN_OPTIONS: [(&str, &str); 6] = [
    ("crop", "--region"),
    ("height", "--size"),
    ("material", "--preset"),
    ("model", "--subsurface"),
    ("resolution", "--size"),
    ("width", "--size"),
];

/// Suggests `render` where a file stands in the place of a verb.
fn suggest_render(error: &mut clap::Error) {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return };
    if Path::new(word).extension().is_some() {
        let tip = format!("to render it: translucid render {word}");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
}

/// The command as users see it: the paragraphs at the end of its help are as wide as the terminal.
fn with_foreign_options(command: Command) -> Command {
    with_paragraphs(with_hints(command))
}

/// Joins the lines of paragraphs, which are as long as those of this program's text; clap breaks them.
fn with_paragraphs(command: Command) -> Command {
    let joined = |text: &clap::builder::StyledStr| {
        let text = text.to_string();
        let mut whole = String::new();
        let mut is_open = false;
        for line in text.lines() {
            let is_prose = !line.is_empty() && !line.starts_with(' ');
            whole += if whole.is_empty() {
                ""
            } else if is_open && is_prose {
                " "
            } else {
                "\n"
            };
            whole += line;
            is_open = is_prose && line.chars().count() > FULL_LINE;
        }
        whole
    };
    command.mut_subcommands(|verb| {
        let [short, long] = [verb.get_after_help(), verb.get_after_long_help()].map(|text| text.map(joined));
        let verb = if let Some(text) = short { verb.after_help(text) } else { verb };
        if let Some(text) = long { verb.after_long_help(text) } else { verb }
    })
}

/// Characters beyond which the next line of a text goes on with the same paragraph.
const FULL_LINE: usize = 90;

/// The command, which refuses other renderers' options with a hint.
fn with_hints(command: Command) -> Command {
    let option = |(name, own): (&'static str, &'static str)| {
        Arg::new(name).long(name).hide(true).value_parser(UnknownArgumentValueParser::suggest_arg(own))
    };
    // Layers have totals, for which no radii are needed
    let command = command.mut_subcommand("reference", |reference| {
        reference.mut_arg("at", |radii| radii.required_unless_present("layers"))
    });
    command.mut_subcommand("render", |render| render.args(FOREIGN_OPTIONS.map(option)))
}

/// The command line of these words, the program's own first.
fn parse(words: &[OsString]) -> clap::error::Result<Cli> {
    let matches = with_foreign_options(Cli::command()).try_get_matches_from(words)?;
    Cli::from_arg_matches(&matches)
}

/// The arguments of `translucid render` with these words after it.
fn parse_render(words: &mut dyn Iterator<Item = OsString>) -> clap::error::Result<render::Arguments> {
    let words = ["translucid", "render"].map(OsString::from).into_iter().chain(words);
    match Cli::try_parse_from(words)?.verb {
        Verb::Render(arguments) => Ok(arguments),
        _ => unreachable!("the verb is render"),
    }
}

fn run_verb(cli: Cli) -> Result<(), Failure> {
    match cli.verb {
        Verb::Render(arguments) => render::run(&arguments),
        Verb::Merge(arguments) => merge::run(&arguments),
        Verb::Plan(arguments) => plan::run(&arguments, &parse_render),
        Verb::Profile(arguments) => profile::run(&arguments),
        Verb::Sample(arguments) => sample::run(&arguments),
        Verb::Reference(arguments) => reference::run(&arguments),
        Verb::Fit(arguments) => fit::run(&arguments),
        Verb::Compare(arguments) => compare::run(&arguments),
        Verb::Export(arguments) => export::run(&arguments),
        Verb::Measure(arguments) => measure::run(&arguments),
        Verb::View(arguments) => view::run(&arguments),
        Verb::Models => models::run(),
        Verb::Devices => devices::run(),
        Verb::Asked(asked) => asked.run(),
        Verb::Completions(arguments) => completions::run(&arguments, Cli::command()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::markdown::{Page, pages_below, root};

    /// Commands in the blocks of shell lines of a page.
    fn commands(page: &Page) -> Vec<String> {
        let shell = page.code().into_iter().filter(|block| block.language == "sh");
        let lines = shell.flat_map(|block| {
            let text = block.lines.join("\n").replace("\\\n", " ");
            text.lines().map(str::to_owned).collect::<Vec<_>>()
        });
        let command = |line: String| line.split(" # ").next().unwrap_or_default().to_owned();
        lines.filter(|line| line.starts_with("translucid ")).map(command).collect()
    }

    #[test]
    fn commands_of_all_pages_and_helps_have_these_options() {
        let mut all = commands(&Page::read(&root().join("README.md")));
        all.extend(pages_below(&root().join("docs")).iter().flat_map(commands));
        for verb in Cli::command().get_subcommands() {
            let help = verb.get_after_help().map(ToString::to_string).unwrap_or_default();
            all.extend(
                help.lines().map(str::trim).filter(|line| line.starts_with("translucid ")).map(str::to_owned),
            );
        }
        assert!(all.len() > 200, "{}", all.len());
        let is_wrong = |line: &String| {
            let command = line.split([';', '|', '>']).next().unwrap_or_default();
            let words: Vec<OsString> =
                command.split_whitespace().map(|word| word.replace('\'', "").into()).collect();
            let error = parse(&words).err()?;
            let is_answer = matches!(
                error.kind(),
                clap::error::ErrorKind::DisplayHelp | clap::error::ErrorKind::DisplayVersion
            );
            (!is_answer).then(|| format!("{line}: {error}"))
        };
        // A guide adds a model of this name
        let wrong: Vec<String> =
            all.iter().filter(|line| !line.contains("my-model")).filter_map(is_wrong).collect();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
