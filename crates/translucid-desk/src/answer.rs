//! A question of any kind, and its answer.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use translucid_words::{
    Column, Context, DataTable, Described, Entry, Error, Provenance, Questions, Table, Thing, describe,
};

use crate::spectra::vary;

/// The answer to a question.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// Tables, the first of which is the answer in numbers.
    pub tables: Vec<DataTable>,
    /// The answer for people, numbers rounded.
    pub text: Option<String>,
    /// Files: pictures, for example.
    pub files: Vec<NamedFile>,
    /// Remarks on the values of the question.
    pub notes: Vec<String>,
    /// Remarks on the answer, which the text for people has, too.
    pub remarks: Vec<String>,
    /// Reasons to doubt it.
    pub warnings: Vec<String>,
}

/// A file's name and content.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedFile {
    /// Its name.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// The form of an answer, which is known before the work.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Tables, perhaps with a text and pictures beside them.
    Table,
    /// A text alone.
    Text,
    /// Files of these names alone, for one directory.
    Files(Vec<String>),
}

/// How somebody asks, watches long work, and ends it.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// The command or the call, which files name as their origin.
    pub call: &'a str,
    /// Ends the work soon after it is true.
    pub stop: &'a AtomicBool,
    /// Is told now and then how much of the work is done, from 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

/// The reason why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Unanswered {
    /// The question is wrong.
    Input(Error),
    /// The question was right, but the work could not be done.
    Work(Error),
    /// The work was stopped.
    Stopped,
}

impl From<Error> for Unanswered {
    fn from(error: Error) -> Self {
        Self::Input(error)
    }
}

/// A question whose values are of the type `T`.
pub struct Question<T: 'static> {
    /// All that a user may say.
    pub thing: Thing<T, Questions>,
    /// Texts, columns and formats that doors show.
    pub about: About,
    /// The form of the answer.
    pub form: fn(&T) -> Form,
    /// The answer; errors have keys in backquotes, which doors see as they spell them.
    pub answer: fn(&T, &Context, &Control<'_>) -> Result<Answer, Unanswered>,
}

/// Texts, columns and formats of a question, which doors show beside all that a user may say.
pub struct About {
    /// More about it in paragraphs, for help and guides.
    pub more: &'static str,
    /// Sources of its methods: author, year, title.
    pub source: &'static str,
    /// Whether the answer has a row for each channel or element of values that vary.
    pub is_by_element: bool,
    /// Questions that are right, in few words: keys that exclude each other are in different ones.
    pub right: fn() -> Vec<Vec<Entry>>,
    /// Examples as words of the command.
    pub examples: &'static [&'static str],
    /// Columns of the first table of its answer.
    pub columns: &'static [Column],
    /// Formats in which it is printed, the default first: csv, json, and text for people. One that is always files has none.
    pub formats: &'static [&'static str],
}

/// A question, whatever its values.
pub trait Ask: Sync {
    /// Its name: that of a verb or a function.
    fn name(&self) -> &'static str;
    /// Its description, in a line.
    fn doc(&self) -> &'static str;
    /// All that a user may say.
    fn keys(&self) -> Vec<Described>;
    /// Texts, columns and formats that doors show.
    fn about(&self) -> &About;
    /// Reads what a user says.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value not allowed.
    fn read(&self, source: &Provenance, entries: &[Entry]) -> Result<Box<dyn Prepared>, Error>;
}

/// A question that has been read.
pub trait Prepared: Send + Sync {
    /// Files that were read.
    fn files(&self) -> &[PathBuf];
    /// The form of its answer.
    fn form(&self) -> Form;
    /// Answers it.
    ///
    /// # Errors
    /// The question is wrong as a whole, or the work could not be done or was stopped.
    fn answer(&self, control: &Control<'_>) -> Result<Answer, Unanswered>;
}

impl<T: Clone + Send + Sync> Ask for Question<T> {
    fn name(&self) -> &'static str {
        self.thing.name
    }

    fn doc(&self) -> &'static str {
        self.thing.doc
    }

    fn keys(&self) -> Vec<Described> {
        describe(&self.thing)
    }

    fn about(&self) -> &About {
        &self.about
    }

    fn read(&self, source: &Provenance, entries: &[Entry]) -> Result<Box<dyn Prepared>, Error> {
        struct Read<T: 'static> {
            asked: T,
            context: Context,
            form: fn(&T) -> Form,
            answer: fn(&T, &Context, &Control<'_>) -> Result<Answer, Unanswered>,
            /// Keys in backquotes, and how the door spells them.
            names: Vec<[String; 2]>,
        }
        impl<T: Send + Sync> Prepared for Read<T> {
            fn files(&self) -> &[PathBuf] {
                &self.context.files
            }

            fn form(&self) -> Form {
                (self.form)(&self.asked)
            }

            fn answer(&self, control: &Control<'_>) -> Result<Answer, Unanswered> {
                let spell =
                    |text: String| self.names.iter().fold(text, |text, [key, name]| text.replace(key, name));
                let answer = (self.answer)(&self.asked, &self.context, control);
                let mut answer = answer.map_err(|reason| match reason {
                    Unanswered::Input(Error { message, place, help }) => {
                        Unanswered::Input(Error { message: spell(message), place, help: help.map(spell) })
                    }
                    other => other,
                })?;
                answer.notes.splice(0..0, self.context.notes.iter().cloned());
                Ok(answer)
            }
        }
        let mut context = context();
        let table = Table::root(source, entries).allow(&self.thing.keys())?;
        let asked = self.thing.read(&table, &mut context)?;
        let names = self.thing.keys().into_iter().map(|key| [format!("`{key}`"), table.name_of(key)]);
        let names = names.collect();
        Ok(Box::new(Read { asked, context, form: self.form, answer: self.answer, names }))
    }
}

/// Context that reading a question begins with; in WebAssembly there are no files.
#[cfg(target_family = "wasm")]
pub(crate) fn context() -> Context {
    let mut context = Context::default();
    context.vary = Some(vary);
    context
}

/// Context that reading a question begins with.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn context() -> Context {
    Context::new(translucid_load::load_toml, vary)
}
