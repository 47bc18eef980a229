//! The kinds of values that questions have: what a user asks, with all that he may say about it.

use std::path::{Path, PathBuf};

use crate::interval::Written;
use crate::table::{Item, Provenance, Table};
use crate::thing::{Fallback, Key, Kinds, Slot, Thing};
use crate::value::{Content, Entry, Value};
use crate::{Error, Interval, Place, WholeInterval};

/// The family of questions.
#[derive(Clone, Copy, Debug)]
pub struct Questions;

impl Kinds for Questions {
    type Slot<'a> = Box<dyn QuestionSlot + 'a>;
    type Context = Context;
    type Lists = ();
}

/// Reads the values and the text of a file.
pub type Load = fn(&Path) -> Result<(Provenance, Vec<Entry>), Error>;
/// Reads a number for each of several channels, in whatever way it may be given.
pub type Vary = fn(&Item<'_>, Interval, &mut Context) -> Result<Varied, Error>;

/// What reading a question needs and finds beside its values.
#[derive(Clone, Debug, Default)]
pub struct Context {
    /// Reads a file of keys and values; without it there are no files.
    pub load: Option<Load>,
    /// Reads numbers that vary; without it they are single numbers or [`Content::Numbers`].
    pub vary: Option<Vary>,
    /// Files that were read.
    pub files: Vec<PathBuf>,
    /// Remarks on values, which the answer has, too.
    pub notes: Vec<String>,
    /// Path of the first value over wavelengths, and of the first for red, green and blue: not both may be given.
    pub first_varied: [Option<String>; 2],
    /// Number of channels or elements of the values that vary, if any does.
    count: Option<usize>,
}

impl Context {
    /// A context that loads files, and reads numbers that vary, in these ways.
    pub fn new(load: Load, vary: Vary) -> Self {
        Self { load: Some(load), vary: Some(vary), ..Self::default() }
    }

    /// Number of channels or elements: one if no value varies.
    pub fn count(&self) -> usize {
        self.count.unwrap_or(1)
    }

    /// Admits a value for so many channels or elements.
    ///
    /// # Errors
    /// Other values have another number of them.
    pub fn admit(&mut self, item: &Item<'_>, count: usize) -> Result<(), Error> {
        match self.count {
            _ if count == 1 => Ok(()),
            Some(other) if other != count => {
                let path = item.path();
                Err(item.error(format!("{path} has {count} values, but others have {other}")))
            }
            _ => {
                self.count = Some(count);
                Ok(())
            }
        }
    }
}

/// The value of a question's field, by its kind.
pub trait QuestionSlot {
    /// Replaces the value.
    ///
    /// # Errors
    /// The new value is not allowed.
    fn read(&mut self, item: &Item<'_>, context: &mut Context) -> Result<(), Error>;

    /// The values that are allowed.
    fn kind(&self) -> Kind;

    /// The value; `None` where there is none.
    fn value(&self) -> Option<Value>;
}

/// The values that a key may have.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// True or false.
    Flag,
    /// A whole number.
    Whole(WholeInterval),
    /// A number.
    Number(Interval),
    /// Numbers, at least and at most so many; one may stand alone.
    Numbers(Interval, [usize; 2]),
    /// A number, or one for each of several channels or elements.
    Varied(Interval),
    /// One of a few words.
    Word(Vec<&'static str>),
    /// Some of a few words.
    Words(Vec<&'static str>),
    /// A text of a form that this phrase describes.
    Text(&'static str),
    /// Texts of such a form.
    Texts(&'static str),
    /// The path of a file that is read.
    Path,
    /// A table, or a file of its keys.
    Document(Vec<Described>),
    /// A table.
    Table(Vec<Described>),
    /// Tables, at most so many.
    Tables(Vec<Described>, usize),
}

/// A key as doors show it.
#[derive(Clone, Debug, PartialEq)]
pub struct Described {
    /// The key.
    pub name: &'static str,
    /// Its meaning in a short sentence.
    pub doc: String,
    /// More about it; empty where the short text says all.
    pub more: String,
    /// Its values.
    pub kind: Kind,
    /// Whether it must be given.
    pub is_required: bool,
    /// What counts where it is missing, in words; empty where nothing does.
    pub default: String,
}

/// The keys of a thing as doors show them.
pub fn describe<T: Clone>(thing: &Thing<T, Questions>) -> Vec<Described> {
    let mut plain = (thing.plain)();
    let row = |field: &crate::Field<T, Questions>| {
        let key = field.keys[0];
        let slot = (field.slot)(&mut plain);
        let kind = slot.kind();
        let default = match key.fallback {
            Fallback::Required => String::new(),
            Fallback::Number(number) => number.to_string(),
            Fallback::Words(words) => words.to_owned(),
            Fallback::Plain => match slot.value() {
                Some(Value { content: Content::Text(word), .. }) => word,
                Some(value) => format!("{value:#}"),
                None => String::new(),
            },
        };
        let filled =
            |text: &str| text.replace("{range}", &kind.range()).replace("{words}", &kind.words().join(", "));
        Described {
            name: key.name,
            doc: filled(key.doc),
            more: filled(key.more),
            is_required: key.fallback == Fallback::Required,
            default,
            kind,
        }
    };
    thing.fields.iter().map(row).collect()
}

impl Kind {
    /// The range of its numbers, in words; empty where there are none.
    pub fn range(&self) -> String {
        match self {
            Self::Number(range) | Self::Numbers(range, _) | Self::Varied(range) => match range.high {
                f64::MAX if range.low == f64::MIN_POSITIVE => String::from("greater than 0"),
                f64::MAX if range.low == -f64::MAX => String::from("finite"),
                f64::MAX => format!("at least {}", Written(range.low)),
                f64::INFINITY => format!("at least {}, or inf", Written(range.low)),
                _ => format!("in {range}"),
            },
            Self::Whole(range) if range.high == u64::MAX => format!("at least {}", range.low),
            Self::Whole(range) => format!("in [{}, {}]", range.low, range.high),
            _ => String::new(),
        }
    }

    /// Its words; none where there are other values.
    pub fn words(&self) -> &[&'static str] {
        match self {
            Self::Word(words) | Self::Words(words) => words,
            _ => &[],
        }
    }
}

impl Slot for Box<dyn QuestionSlot + '_> {
    type Context = Context;
    type Lists = ();

    fn absent() -> Self {
        Box::new(Absent)
    }

    fn read(mut self, table: &Table<'_>, keys: &[Key], context: &mut Context) -> Result<(), Error> {
        match table.get(keys[0].name) {
            Some(item) => self.as_mut().read(&item, context),
            None => Ok(()),
        }
    }

    fn fall_back(self, _: f64) {}

    fn write(self, keys: &[Key], _: [f64; 3]) -> Vec<Entry> {
        self.value().into_iter().map(|value| Entry::new(keys[0].name, value)).collect()
    }

    /// A question is checked when it is read, and made in no other way.
    fn check(self, _: &str, (): &()) -> Result<(), Error> {
        Ok(())
    }
}

struct Absent;

impl QuestionSlot for Absent {
    fn read(&mut self, _: &Item<'_>, _: &mut Context) -> Result<(), Error> {
        Ok(())
    }

    fn kind(&self) -> Kind {
        Kind::Flag
    }

    fn value(&self) -> Option<Value> {
        None
    }
}

/// A slot from how it is read, its kind and its value.
struct Simple<'a, T: ?Sized> {
    place: &'a mut T,
    kind: Kind,
    read: fn(&mut T, &Item<'_>, &Kind) -> Result<(), Error>,
    value: fn(&T) -> Option<Value>,
}

impl<T: ?Sized> QuestionSlot for Simple<'_, T> {
    fn read(&mut self, item: &Item<'_>, _: &mut Context) -> Result<(), Error> {
        (self.read)(self.place, item, &self.kind)
    }

    fn kind(&self) -> Kind {
        self.kind.clone()
    }

    fn value(&self) -> Option<Value> {
        (self.value)(self.place)
    }
}

/// True or false.
pub fn flag(place: &mut bool) -> Box<dyn QuestionSlot + '_> {
    Box::new(Simple {
        place,
        kind: Kind::Flag,
        read: |place, item, _| item.flag().map(|flag| *place = flag),
        value: |flag| Some((*flag).into()),
    })
}

/// A whole number; 1e6 is one, too.
pub fn whole(place: &mut u64, range: WholeInterval) -> Box<dyn QuestionSlot + '_> {
    Box::new(Simple {
        place,
        kind: Kind::Whole(range),
        read: |place, item, kind| match kind {
            Kind::Whole(range) => read_whole(item, *range).map(|n| *place = n),
            _ => Ok(()),
        },
        value: |n| Some((*n).into()),
    })
}

fn read_whole(item: &Item<'_>, range: WholeInterval) -> Result<u64, Error> {
    match item.content() {
        Content::Float(x) if *x >= 0.0 && x.fract() == 0.0 && *x < 1.8e19 && range.contains(*x as u64) => {
            Ok(*x as u64)
        }
        _ => item.integer(range),
    }
}

/// A number.
pub fn number(place: &mut f64, range: Interval) -> Box<dyn QuestionSlot + '_> {
    Box::new(Simple {
        place,
        kind: Kind::Number(range),
        read: |place, item, kind| double(item, kind).map(|number| *place = number),
        value: |number| Some((*number).into()),
    })
}

/// A number that may be missing.
pub fn optional(place: &mut Option<f64>, range: Interval) -> Box<dyn QuestionSlot + '_> {
    Box::new(Simple {
        place,
        kind: Kind::Number(range),
        read: |place, item, kind| double(item, kind).map(|number| *place = Some(number)),
        value: |number| number.map(Value::from),
    })
}

/// The number of an item, whose range is worded as its kind words it.
fn double(item: &Item<'_>, kind: &Kind) -> Result<f64, Error> {
    let (Kind::Number(range) | Kind::Numbers(range, _) | Kind::Varied(range)) = kind else {
        return Err(item.mismatch("a number"));
    };
    match item.content() {
        Content::Integer(_) | Content::Float(_) => {
            item.double(*range).map_err(|_| item.refuse(&kind.range()))
        }
        _ => Err(item.mismatch(&format!("a number {}", kind.range()))),
    }
}

/// Numbers, at least and at most so many; one may stand alone.
pub fn numbers(place: &mut Vec<f64>, range: Interval, count: [usize; 2]) -> Box<dyn QuestionSlot + '_> {
    Box::new(Simple {
        place,
        kind: Kind::Numbers(range, count),
        read: |place, item, kind| {
            let Kind::Numbers(range, [least, most]) = kind else { return Ok(()) };
            *place = match item.content() {
                Content::List(_) => {
                    let items = item.list("numbers", *most)?;
                    items.iter().map(|item| double(item, kind)).collect::<Result<_, _>>()?
                }
                Content::Numbers(numbers) => match numbers.iter().position(|x| !range.contains(*x)) {
                    Some(i) => return Err(refused(item, i, numbers[i], kind)),
                    None => numbers.to_vec(),
                },
                _ => vec![double(item, kind)?],
            };
            if (*least..=*most).contains(&place.len()) {
                return Ok(());
            }
            let count = if least == most { least.to_string() } else { format!("{least} to {most}") };
            Err(item.error(format!("{} has {} values, but must have {count}", item.path(), place.len())))
        },
        value: |numbers| (!numbers.is_empty()).then(|| Value::list(numbers)),
    })
}

fn refused(item: &Item<'_>, index: usize, found: f64, kind: &Kind) -> Error {
    let must_be = kind.range();
    item.error(format!("{}[{index}] is {}, but must be {must_be}", item.path(), Written(found)))
}

/// A number, or one for each of several channels or elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied(Vec<f64>);

impl Varied {
    /// The same number for all.
    pub fn one(number: f64) -> Self {
        Self(vec![number])
    }

    /// A number for each; there must be one.
    pub fn many(numbers: Vec<f64>) -> Self {
        debug_assert!(!numbers.is_empty(), "no numbers");
        Self(numbers)
    }

    /// The number of a channel or element.
    pub fn at(&self, index: usize) -> f64 {
        self.0[if self.0.len() == 1 { 0 } else { index }]
    }

    /// How many there are: one if it is the same for all.
    pub fn count(&self) -> usize {
        self.0.len()
    }
}

struct VariedSlot<'a>(&'a mut Option<Varied>, Interval);

/// A number that varies between channels or elements, if it is given.
pub fn varied(place: &mut Option<Varied>, range: Interval) -> Box<dyn QuestionSlot + '_> {
    Box::new(VariedSlot(place, range))
}

impl QuestionSlot for VariedSlot<'_> {
    fn read(&mut self, item: &Item<'_>, context: &mut Context) -> Result<(), Error> {
        let (range, kind) = (self.1, self.kind());
        let varied = match (item.content(), context.vary) {
            (Content::Numbers(numbers), _) => match numbers.iter().position(|x| !range.contains(*x)) {
                Some(i) if numbers.len() > 1 => return Err(refused(item, i, numbers[i], &kind)),
                Some(_) => return Err(item.refuse(&kind.range())),
                None => Varied::many(numbers.to_vec()),
            },
            (Content::List(_) | Content::Table(_) | Content::Text(_), Some(vary)) => {
                vary(item, range, context)?
            }
            _ => Varied::one(double(item, &kind)?),
        };
        context.admit(item, varied.count())?;
        *self.0 = Some(varied);
        Ok(())
    }

    fn kind(&self) -> Kind {
        Kind::Varied(self.1)
    }

    fn value(&self) -> Option<Value> {
        self.0.as_ref().map(|varied| match &varied.0[..] {
            [one] => (*one).into(),
            many => Value::list(many),
        })
    }
}

/// Words with the values that they stand for.
type Words<T> = &'static [(&'static str, T)];

struct WordSlot<'a, T: 'static> {
    words: Words<T>,
    name: Option<&'static str>,
    set: Box<dyn FnMut(Vec<T>) + 'a>,
    is_list: bool,
}

impl<T: Copy> QuestionSlot for WordSlot<'_, T> {
    fn read(&mut self, item: &Item<'_>, _: &mut Context) -> Result<(), Error> {
        let values = match item.content() {
            Content::List(list) if self.is_list => {
                let items = item.list("words", list.len())?;
                items.iter().map(|item| item.word_of(self.words)).collect::<Result<_, _>>()?
            }
            _ => vec![item.word_of(self.words)?],
        };
        (self.set)(values);
        Ok(())
    }

    fn kind(&self) -> Kind {
        let names = self.words.iter().map(|(name, _)| *name).collect();
        if self.is_list { Kind::Words(names) } else { Kind::Word(names) }
    }

    fn value(&self) -> Option<Value> {
        self.name.map(Value::from)
    }
}

fn name_of<T: Copy + PartialEq>(words: Words<T>, value: T) -> Option<&'static str> {
    words.iter().find(|(_, known)| *known == value).map(|(name, _)| *name)
}

/// One of a few words.
pub fn word<T: Copy + PartialEq>(place: &mut T, words: Words<T>) -> Box<dyn QuestionSlot + '_> {
    let name = name_of(words, *place);
    let set = Box::new(move |values: Vec<T>| values.into_iter().for_each(|value| *place = value));
    Box::new(WordSlot { words, name, set, is_list: false })
}

/// One of a few words, if it is given.
pub fn optional_word<T: Copy + PartialEq>(
    place: &mut Option<T>,
    words: Words<T>,
) -> Box<dyn QuestionSlot + '_> {
    let name = place.and_then(|value| name_of(words, value));
    let set = Box::new(move |values: Vec<T>| *place = values.into_iter().next());
    Box::new(WordSlot { words, name, set, is_list: false })
}

/// Some of a few words; one may stand alone.
pub fn words<T: Copy + PartialEq>(place: &mut Vec<T>, words: Words<T>) -> Box<dyn QuestionSlot + '_> {
    Box::new(WordSlot { words, name: None, set: Box::new(move |values| *place = values), is_list: true })
}

/// A text of a form that a phrase describes, if it is given.
pub fn text<'a>(place: &'a mut Option<String>, form: &'static str) -> Box<dyn QuestionSlot + 'a> {
    Box::new(Simple {
        place,
        kind: Kind::Text(form),
        read: |place, item, _| item.text().map(|text| *place = Some(text.to_owned())),
        value: |text| text.as_deref().map(Value::from),
    })
}

/// Texts of a form that a phrase describes; one may stand alone.
pub fn texts<'a>(place: &'a mut Vec<String>, form: &'static str) -> Box<dyn QuestionSlot + 'a> {
    Box::new(Simple {
        place,
        kind: Kind::Texts(form),
        read: |place, item, _| {
            *place = match item.content() {
                Content::List(list) => {
                    let items = item.list("texts", list.len())?;
                    items.iter().map(|item| item.text().map(str::to_owned)).collect::<Result<_, _>>()?
                }
                _ => vec![item.text()?.to_owned()],
            };
            Ok(())
        },
        value: |_| None,
    })
}

/// The path of a file that is read, if it is given.
pub fn path(place: &mut Option<PathBuf>) -> Box<dyn QuestionSlot + '_> {
    struct PathSlot<'a>(&'a mut Option<PathBuf>);
    impl QuestionSlot for PathSlot<'_> {
        fn read(&mut self, item: &Item<'_>, context: &mut Context) -> Result<(), Error> {
            let path = item.file()?;
            context.files.push(path.clone());
            *self.0 = Some(path);
            Ok(())
        }

        fn kind(&self) -> Kind {
            Kind::Path
        }

        fn value(&self) -> Option<Value> {
            None
        }
    }
    Box::new(PathSlot(place))
}

/// A value that its own type reads.
pub trait Parse: Sized {
    /// The form of its values: "a phase function".
    const FORM: &'static str;

    /// Reads a value.
    ///
    /// # Errors
    /// It is not allowed.
    fn parse(item: &Item<'_>, context: &mut Context) -> Result<Self, Error>;
}

/// A value that its own type reads, if it is given.
pub fn parsed<T: Parse>(place: &mut Option<T>) -> Box<dyn QuestionSlot + '_> {
    struct ParsedSlot<'a, T>(&'a mut Option<T>);
    impl<T: Parse> QuestionSlot for ParsedSlot<'_, T> {
        fn read(&mut self, item: &Item<'_>, context: &mut Context) -> Result<(), Error> {
            *self.0 = Some(T::parse(item, context)?);
            Ok(())
        }

        fn kind(&self) -> Kind {
            Kind::Text(T::FORM)
        }

        fn value(&self) -> Option<Value> {
            None
        }
    }
    Box::new(ParsedSlot(place))
}

struct Nested<'a, T: 'static> {
    place: &'a mut Option<T>,
    thing: &'static Thing<T, Questions>,
    /// Whether a file may stand for it.
    is_document: bool,
}

impl<T: Clone> QuestionSlot for Nested<'_, T> {
    fn read(&mut self, item: &Item<'_>, context: &mut Context) -> Result<(), Error> {
        let keys = self.thing.keys();
        *self.place = Some(match (item.content(), context.load) {
            (Content::Text(_), Some(load)) if self.is_document => {
                let path = item.file()?;
                let (source, entries) = load(&path)?;
                context.files.push(path);
                let source = source.of(self.thing.name);
                self.thing.read(&Table::root(&source, &entries).allow(&keys)?, context)?
            }
            // The tables of its first key
            (Content::List(_), _) if self.is_document => {
                let first =
                    self.thing.fields.iter().find(|field| {
                        matches!((field.slot)(&mut (self.thing.plain)()).kind(), Kind::Tables(..))
                    });
                let Some(field) = first else { return Err(item.mismatch("a table")) };
                let mut thing = (self.thing.plain)();
                (field.slot)(&mut thing).as_mut().read(item, context)?;
                thing
            }
            (Content::Table(_), _) => self.thing.read(&item.table()?.allow(&keys)?, context)?,
            _ if self.is_document && context.load.is_some() => {
                return Err(item.mismatch("the path of a file, or its content"));
            }
            _ => return Err(item.mismatch("a table")),
        });
        Ok(())
    }

    fn kind(&self) -> Kind {
        let keys = describe(self.thing);
        if self.is_document { Kind::Document(keys) } else { Kind::Table(keys) }
    }

    fn value(&self) -> Option<Value> {
        None
    }
}

/// A table of a thing's keys, if it is given.
pub fn table<'a, T: Clone>(
    place: &'a mut Option<T>,
    thing: &'static Thing<T, Questions>,
) -> Box<dyn QuestionSlot + 'a> {
    Box::new(Nested { place, thing, is_document: false })
}

/// A table of a thing's keys or a file of them, if it is given.
pub fn document<'a, T: Clone>(
    place: &'a mut Option<T>,
    thing: &'static Thing<T, Questions>,
) -> Box<dyn QuestionSlot + 'a> {
    Box::new(Nested { place, thing, is_document: true })
}

/// A thing with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed<T> {
    /// The thing.
    pub thing: T,
    /// Its path: `layer[2]`.
    pub path: String,
    /// Its place.
    pub place: Place,
}

impl<T> Placed<T> {
    /// An error of the thing as a whole.
    pub fn error(&self, message: impl std::fmt::Display) -> Error {
        Error::at(self.place.clone(), format!("{}: {message}", self.path))
    }
}

/// Things of one kind in a row, at most so many.
pub fn things<'a, T: Clone>(
    place: &'a mut Vec<Placed<T>>,
    thing: &'static Thing<T, Questions>,
    most: usize,
) -> Box<dyn QuestionSlot + 'a> {
    struct Things<'a, T: 'static> {
        place: &'a mut Vec<Placed<T>>,
        thing: &'static Thing<T, Questions>,
        most: usize,
    }
    impl<T: Clone> QuestionSlot for Things<'_, T> {
        fn read(&mut self, item: &Item<'_>, context: &mut Context) -> Result<(), Error> {
            let (thing, keys) = (self.thing, self.thing.keys());
            let read = |table: Table<'_>| {
                let (path, place) = (table.path().to_owned(), table.place());
                Ok::<_, Error>(Placed { thing: thing.read(&table.allow(&keys)?, context)?, path, place })
            };
            *self.place = item.tables(self.most)?.into_iter().map(read).collect::<Result<_, _>>()?;
            Ok(())
        }

        fn kind(&self) -> Kind {
            Kind::Tables(describe(self.thing), self.most)
        }

        fn value(&self) -> Option<Value> {
            None
        }
    }
    Box::new(Things { place, thing, most })
}
