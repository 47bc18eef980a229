//! Verbs that ask a question of the desk: their options, help and output follow from its description.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, Subcommand, ValueEnum, value_parser};
use translucid_desk::{Answer, Ask, CONVERT, Control, Form, Prepared, QUESTIONS, Unanswered};
use translucid_words::{Content, Described, Entry, Error, Kind, Provenance, Spelling, Value};

use crate::failure::Failure;
use crate::files::{Directory, input_among, is_own, refusal, write_file};
use crate::progress::{Meter, Unit};
use crate::table::{ReadableFormat, TableFormat, print, refuse_npz};
use crate::{command_line, interrupt, machine, messages, textures};

/// A question with what the user says.
pub(crate) struct Asked {
    question: &'static dyn Ask,
    matches: ArgMatches,
}

impl FromArgMatches for Asked {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let asked = matches.subcommand().and_then(|(name, matches)| {
            let question = QUESTIONS.into_iter().find(|question| question.name() == name)?;
            Some(Self { question, matches: matches.clone() })
        });
        asked.ok_or_else(|| clap::Error::new(ErrorKind::MissingSubcommand))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        Self::from_arg_matches(matches).map(|asked| *self = asked)
    }
}

impl Subcommand for Asked {
    fn augment_subcommands(command: Command) -> Command {
        QUESTIONS.into_iter().fold(command, |command, question| command.subcommand(verb(question)))
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        QUESTIONS.iter().any(|question| question.name() == name)
    }
}

/// The verb of a question.
fn verb(question: &'static dyn Ask) -> Command {
    let output = Arg::new("output").short('o').long("output").value_parser(value_parser!(PathBuf));
    let command = Command::new(question.name())
        .about(question.doc())
        .args(question.keys().iter().enumerate().map(|(i, key)| option(key, i == 0)))
        .after_help(after_help(question));
    let command = match question.about().formats.first() {
        None => command.arg(
            output.value_name("DIR").default_value(question.name()).help("Directory to write to"),
        ),
        Some(default) => command.arg(output.value_name("FILE").help(
            "File to write instead of stdout; a picture of the answer where its name ends so, beside the table on stdout; or \
             a directory where the answer is several files",
        ))
        .arg(
            Arg::new("format")
                .long("format")
                .value_name("FORMAT")
                .default_value(default)
                .help("How to print")
                .value_parser(PossibleValuesParser::new(formats(question))),
        ),
    };
    let command = command.arg(
        Arg::new("threads")
            .long("threads")
            .value_name("N")
            .help("Number of threads [default: one per processor]; the result does not depend on it")
            .value_parser(value_parser!(u16).range(1..=1024)),
    );
    if question.name() == CONVERT.name() {
        return textures::TextureArguments::augment_args(command).about(question.doc());
    }
    command
}

/// The formats in which answers to a question are printed.
fn formats(question: &dyn Ask) -> Vec<PossibleValue> {
    let all = ReadableFormat::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    all.filter(|format| question.about().formats.contains(&format.get_name())).collect()
}

/// Paragraphs, the columns and examples.
fn after_help(question: &dyn Ask) -> String {
    let columns: Vec<String> = question
        .about()
        .columns
        .iter()
        .map(|column| match column.unit {
            "" | "1" => format!("  {}: {}", column.name, column.meaning),
            unit => format!("  {} [{unit}]: {}", column.name, column.meaning),
        })
        .collect();
    let examples: Vec<String> = question
        .about()
        .examples
        .iter()
        .map(|words| format!("  translucid {} {words}", question.name()))
        .collect();
    let columns = match &columns[..] {
        [] => String::new(),
        columns => format!("Columns:\n{}\n\n", columns.join("\n")),
    };
    format!("{}\n\n{columns}Examples:\n{}", question.about().more, examples.join("\n"))
}

/// The option of a key, or the file that the question is about.
fn option(key: &Described, is_first: bool) -> Arg {
    let more = if key.more.is_empty() { String::new() } else { format!(". {}", key.more) };
    let default = match &key.default {
        default if default.is_empty() || key.kind == Kind::Flag || default == "none" => String::new(),
        default => format!(" [default: {default}]"),
    };
    let words = match &key.kind {
        Kind::Words(words) => format!(" [possible values: {}]", words.join(", ")),
        _ => String::new(),
    };
    let help = format!("{}{more}{default}{words}", sentence(&key.doc.replace('`', "")));
    let name = key.name.to_uppercase();
    let argument = Arg::new(key.name).help(help).required(key.is_required).value_name(name);
    let argument = match &key.kind {
        Kind::Document(_) | Kind::Path if is_first && key.is_required => return argument.value_name("FILE"),
        Kind::Tables(..) | Kind::Table(_) => return argument.hide(true),
        _ => argument.long(key.name.replace('_', "-")),
    };
    let argument = match &key.kind {
        Kind::Flag => return argument.action(ArgAction::SetTrue),
        Kind::Word(words) => argument.value_parser(PossibleValuesParser::new(words.clone())),
        Kind::Path | Kind::Document(_) => argument.value_name("FILE"),
        Kind::Texts(form) => argument.value_name(*form).action(ArgAction::Append),
        Kind::Numbers(..) | Kind::Varied(_) | Kind::Words(_) => {
            argument.value_name(format!("{},...", key.name.to_uppercase()))
        }
        _ => argument,
    };
    argument.allow_hyphen_values(true)
}

/// Words with a capital letter.
fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    first + letters.as_str()
}

impl Asked {
    /// Runs the verb.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if let Some(done) = textures::run(&self.matches) {
            return done;
        }
        let prepared = read(self.question, &self.entries())?;
        let output = self.matches.get_one::<PathBuf>("output").map(PathBuf::as_path);
        if let Form::Files(names) = prepared.form() {
            return self.fill(&*prepared, &names, output);
        }
        if prepared.form() == Form::Text && self.format() == "json" {
            return Err(Failure::input("this answer is a text, and has no --format json"));
        }
        refuse_npz(output)?;
        if let Some(path) = among_inputs(output, &*prepared) {
            let message =
                format!("--output is {}, a file that is read, and would be overwritten", path.display());
            return Err(Failure::input(message).with_help("choose another file"));
        }
        output.map_or(Ok(()), |path| Ok::<_, Failure>(translucid_files::check_writable(path)?))?;
        self.write(&self.answer(&*prepared)?, output)
    }

    /// Writes an answer that is files of these names to a directory.
    fn fill(&self, prepared: &dyn Prepared, names: &[String], output: Option<&Path>) -> Result<(), Failure> {
        let Some(path) = output else {
            let message = format!("the files {} need a directory", names.join(", "));
            return Err(Failure::input(message).with_help("name it with -o DIR"));
        };
        let has_format = !self.question.about().formats.is_empty();
        if has_format && self.matches.value_source("format") == Some(ValueSource::CommandLine) {
            return Err(Failure::input("this answer is files, and has no --format"));
        }
        let answer = Directory::fill(path, |directory| {
            let files: Vec<PathBuf> = names.iter().map(|name| directory.file(name)).collect();
            if let Some(path) = among_inputs(files.iter().map(PathBuf::as_path), prepared) {
                let message = format!("{} is read, and would be overwritten", path.display());
                return Err(Failure::input(message).with_help("name another directory with -o DIR"));
            }
            let are_own = files.iter().any(|path| is_own(path));
            for path in &files {
                translucid_files::check_writable(path)?;
                if path.exists() && !are_own {
                    let name = self.question.name();
                    return Err(refusal(
                        path,
                        format!("exists already, and was not made by translucid {name}"),
                    ));
                }
            }
            let answer = self.answer(prepared)?;
            if interrupt::STOP.load(Ordering::Relaxed) {
                return Err(unanswered(Unanswered::Stopped));
            }
            // Files of two versions beside each other would be worse than the moment that the rest takes
            interrupt::catch("\nall files are being written; press Ctrl-C again to end at once")?;
            answer.files.iter().try_for_each(|file| write_file(&directory.file(&file.name), &file.bytes))?;
            Ok(answer)
        })?;
        remark(&answer);
        let files = format!("{} files in {}", answer.files.len(), path.display());
        messages::line(&[&[files], &answer.remarks[..]].concat().join("; "));
        Ok(())
    }

    /// The answer, by as many threads as the user says.
    fn answer(&self, prepared: &dyn Prepared) -> Result<Answer, Failure> {
        let pool = machine::threads(self.matches.get_one("threads").copied())?;
        pool.install(|| answer(prepared))
    }

    fn format(&self) -> &str {
        self.matches.get_one::<String>("format").map_or("csv", String::as_str)
    }

    /// Options as values.
    fn entries(&self) -> Vec<Entry> {
        let entry = |key: &Described| {
            if key.kind == Kind::Flag {
                return self.matches.get_flag(key.name).then(|| Entry::new(key.name, true));
            }
            if let Kind::Texts(_) = key.kind {
                let texts = self.matches.get_many::<String>(key.name)?;
                return Some(Entry::new(
                    key.name,
                    texts.map(|text| text.as_str().into()).collect::<Vec<Value>>(),
                ));
            }
            let text = self.matches.get_one::<String>(key.name)?;
            Some(Entry::new(key.name, value(&key.kind, text)))
        };
        self.question.keys().iter().filter_map(entry).collect()
    }

    fn write(&self, answer: &Answer, output: Option<&Path>) -> Result<(), Failure> {
        let format = self.format();
        let text = match (format, &answer.text, answer.tables.first()) {
            ("text", Some(text), _) | (_, Some(text), None) => text.clone(),
            ("text", None, _) => {
                return Err(Failure::input("this answer is a table, which --format text does not print")
                    .with_help("use --format csv or json"));
            }
            (format, _, Some(table)) => {
                let format = if format == "json" { TableFormat::Json } else { TableFormat::Csv };
                format.text(&table.columns, &table.rows)
            }
            (_, text, None) => text.clone().unwrap_or_default(),
        };
        remark(answer);
        if format != "text" {
            answer.remarks.iter().for_each(|remark| messages::print_note(remark));
        }
        let Some(path) = output else { return print(&text) };
        let ending = |name: &str| PathBuf::from(name).extension().map(OsStr::to_ascii_lowercase);
        let wanted = path.extension().map(OsStr::to_ascii_lowercase);
        match answer.files.iter().find(|file| wanted.is_some() && ending(&file.name) == wanted) {
            Some(file) => {
                write_file(path, &file.bytes)?;
                print(&text)
            }
            None => write_file(path, text.as_bytes()),
        }
    }
}

/// Prints notes and warnings.
fn remark(answer: &Answer) {
    answer.notes.iter().for_each(|note| messages::print_note(note));
    answer.warnings.iter().for_each(|warning| messages::print_warning(warning));
}

/// The first of some files to write that the question reads.
fn among_inputs<'a>(files: impl IntoIterator<Item = &'a Path>, prepared: &dyn Prepared) -> Option<&'a Path> {
    input_among(files.into_iter(), prepared.files().iter().map(PathBuf::as_path))
}

/// Asks a question in the words of options, on the threads of this pool.
pub(crate) fn ask(question: &dyn Ask, entries: &[Entry]) -> Result<Answer, Failure> {
    answer(&*read(question, entries)?)
}

fn read(question: &dyn Ask, entries: &[Entry]) -> Result<Box<dyn Prepared>, Failure> {
    let source = Provenance::part("").of(question.name()).spelled(Spelling::Flags);
    question.read(&source, entries).map_err(wrong)
}

/// The answer, with progress, unless Ctrl-C ends the work.
fn answer(prepared: &dyn Prepared) -> Result<Answer, Failure> {
    interrupt::catch("\nstopping")?;
    let meter = Meter::new(Unit::Parts);
    let progress = |part: f64| meter.update((1e3 * part) as u64, 1000);
    let call = command_line::shown();
    let answer = prepared.answer(&Control { call: &call, stop: &interrupt::STOP, progress: &progress });
    meter.finish();
    answer.map_err(unanswered)
}

/// The value of an option's text.
pub(crate) fn value(kind: &Kind, text: &str) -> Value {
    let parts = || text.split(',').map(str::trim);
    match kind {
        Kind::Numbers(..) if text.contains(',') => parts().map(number).collect::<Vec<Value>>().into(),
        Kind::Number(_) | Kind::Whole(_) | Kind::Numbers(..) => number(text),
        Kind::Varied(_) => match parts().map(str::parse).collect::<Result<Vec<f64>, _>>() {
            Ok(numbers) if numbers.len() == 1 => number(text),
            Ok(numbers) => Content::Numbers(numbers.into()).into(),
            Err(_) => Content::Other("no list of numbers").into(),
        },
        Kind::Words(_) => parts().map(Value::from).collect::<Vec<Value>>().into(),
        _ => text.into(),
    }
}

fn number(text: &str) -> Value {
    match (text.parse::<i128>(), text.parse::<f64>()) {
        (Ok(n), _) => Content::Integer(n).into(),
        (_, Ok(x)) => x.into(),
        _ => text.into(),
    }
}

/// The failure of an option or of a file that it names.
pub(crate) fn wrong(error: Error) -> Failure {
    let place = error.place.clone().filter(|place| !place.path.as_os_str().is_empty());
    Failure { place, ..Failure::from(error) }
}

/// The failure of a question without an answer.
pub(crate) fn unanswered(reason: Unanswered) -> Failure {
    match reason {
        Unanswered::Input(error) => wrong(error),
        Unanswered::Work(error) => Failure::of_machine(error),
        Unanswered::Stopped => Failure::interrupted("nothing was written"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_become_values_of_their_kinds() {
        let shown = |kind: Kind, text: &str| value(&kind, text).to_string();
        assert_eq!(shown(Kind::Word(Vec::new()), "2"), "\"2\"");
        assert_eq!(shown(Kind::Words(Vec::new()), "a, b"), "[\"a\", \"b\"]");
        assert_eq!(shown(Kind::Text(""), "1,2"), "\"1,2\"");
    }

    #[test]
    fn every_question_is_a_verb() {
        Asked::augment_subcommands(Command::new("translucid")).debug_assert();
    }
}
