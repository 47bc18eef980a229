//! A thing by its fields: for each its keys, their meaning, range and default, and its place in the thing.
//!
//! From this one list follow reading, writing and checking a thing, the flags of a command, the arguments of a function,
//! the rows of a page, and the tables of the guide.

use crate::Error;
use crate::interval::refusal;
use crate::table::{Item, Table};
use crate::value::Entry;

/// A thing by its fields.
pub struct Thing<T: 'static, K: Kinds> {
    /// Its name: of a light the `type`, else the table's.
    pub name: &'static str,
    /// Its description, in a line.
    pub doc: &'static str,
    /// A valid one, with the default of every field that has one of its own.
    pub plain: fn() -> T,
    /// Its fields, in the order in which they are written.
    pub fields: &'static [Field<T, K>],
    /// Requirements on several fields at once.
    pub rules: &'static [Rule<T>],
}

/// A family of things, whose fields have values of the same kinds.
pub trait Kinds: Sized + 'static {
    /// The value of a field, by its kind.
    type Slot<'a>: Slot<Context = Self::Context, Lists = Self::Lists>;
    /// What reading fills or asks beside the thing: the files that it names, for example.
    type Context: Default;
    /// Lengths of the lists that a thing may refer to.
    type Lists;
}

/// The value of a field: how it is read, written and checked.
pub trait Slot: Sized {
    /// That of its [`Kinds`].
    type Context;
    /// That of its [`Kinds`].
    type Lists;

    /// The value of a field that a variant does not have.
    fn absent() -> Self;

    /// Replaces the value by that of its keys, if they are there.
    ///
    /// # Errors
    /// A value is not allowed.
    fn read(self, table: &Table<'_>, keys: &[Key], context: &mut Self::Context) -> Result<(), Error>;

    /// Takes the number of a key that is missing.
    fn fall_back(self, number: f64);

    /// The keys with their values, points counted from the origin.
    fn write(self, keys: &[Key], origin: [f64; 3]) -> Vec<Entry>;

    /// The keys by which the value of a field differs from another, with its values.
    fn changes(old: Self, new: Self, keys: &[Key]) -> Vec<Entry> {
        let [old, new] = [old, new].map(|slot| slot.write(keys, [0.0; 3]));
        if is_same(&old, &new) { Vec::new() } else { new }
    }

    /// Checks everything that reading would.
    ///
    /// # Errors
    /// Something is not allowed.
    fn check(self, key: &str, lists: &Self::Lists) -> Result<(), Error>;
}

/// Whether entries are written alike: 0 and -0 are not.
pub fn is_same(old: &[Entry], new: &[Entry]) -> bool {
    old.len() == new.len() && old.iter().zip(new).all(|(old, new)| old.to_string() == new.to_string())
}

/// A field of a thing.
pub struct Field<T, K: Kinds> {
    /// Its keys: one, or several that place it together.
    pub keys: &'static [Key],
    /// Its value, or [`Slot::absent`] where `T` is now a variant without it.
    pub slot: fn(&mut T) -> K::Slot<'_>,
    /// The effect on other fields of a value that is given.
    pub when_given: Option<fn(&mut T)>,
    /// The default that follows from other fields, where there is no value of its own.
    pub when_missing: Option<fn(&mut T)>,
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// Its meaning in a short sentence, in Markdown, with its unit; `{range}` and `{words}` stand for those of the slot.
    pub doc: &'static str,
    /// More about it, for the guide; empty where the short text says all.
    pub more: &'static str,
    /// What counts where it is missing.
    pub fallback: Fallback,
}

impl Key {
    /// A key whose short text says all.
    pub const fn new(name: &'static str, doc: &'static str, fallback: Fallback) -> Self {
        Self { name, doc, more: "", fallback }
    }
}

/// The value of a key that is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fallback {
    /// There is none: it is an error.
    Required,
    /// That of the plain thing.
    Plain,
    /// A number other than that of the plain thing.
    Number(f64),
    /// Something else, in words.
    Words(&'static str),
}

/// A requirement on several fields at once.
pub enum Rule<T> {
    /// A relation between values, which is an error of one of them.
    Holds {
        /// The key that the error is about.
        key: &'static str,
        /// The requirement on its value, if it is broken: "must be …".
        broken: fn(&T) -> Option<String>,
        /// Advice where the key was not given.
        help: &'static str,
    },
    /// Exactly one of several groups of keys is given, and that whole.
    OneOf(&'static [&'static [&'static str]]),
    /// At most one of several keys is given, for the reason in the advice.
    NotWith(&'static [&'static str], &'static str),
    /// A key is given only beside one of others.
    OnlyWith(&'static str, &'static [&'static str]),
}

impl<T, K: Kinds> Field<T, K> {
    /// The field with an effect of its value on others.
    pub const fn when_given(self, effect: fn(&mut T)) -> Self {
        Self { when_given: Some(effect), ..self }
    }

    /// The field with a default that follows from others.
    pub const fn when_missing(self, default: fn(&mut T)) -> Self {
        Self { when_missing: Some(default), ..self }
    }

    /// The key that names the field.
    pub fn key(&self) -> &'static str {
        self.keys[0].name
    }
}

impl<T: Clone, K: Kinds> Thing<T, K> {
    /// Every key, in the order of the fields.
    pub fn keys(&self) -> Vec<&'static str> {
        self.fields.iter().flat_map(|field| field.keys).map(|key| key.name).collect()
    }

    /// The thing of a table, whose keys are already known to be allowed.
    ///
    /// # Errors
    /// A key is missing, or a value not allowed.
    pub fn read(&self, table: &Table<'_>, context: &mut K::Context) -> Result<T, Error> {
        self.keep_company(table)?;
        let mut thing = (self.plain)();
        let mut missing = Vec::new();
        for field in self.fields {
            if field.keys[0].fallback == Fallback::Required {
                table.require(field.key())?;
            }
            if !self.fill(field, &mut thing, table, context)? {
                if let Fallback::Number(number) = field.keys[0].fallback {
                    (field.slot)(&mut thing).fall_back(number);
                }
                missing.extend(field.when_missing);
            }
        }
        missing.into_iter().for_each(|default| default(&mut thing));
        self.keep_relations(table, &thing)?;
        Ok(thing)
    }

    /// The thing with the changes of a table, whose keys are already known to be allowed.
    ///
    /// # Errors
    /// A value is not allowed.
    pub fn change(&self, mut thing: T, table: &Table<'_>, context: &mut K::Context) -> Result<T, Error> {
        for field in self.fields {
            self.fill(field, &mut thing, table, context)?;
        }
        self.keep_relations(table, &thing)?;
        Ok(thing)
    }

    /// Reads a field, and returns whether it was given.
    fn fill(
        &self,
        field: &Field<T, K>,
        thing: &mut T,
        table: &Table<'_>,
        context: &mut K::Context,
    ) -> Result<bool, Error> {
        (field.slot)(thing).read(table, field.keys, context)?;
        let is_given = field.keys.iter().any(|key| table.get(key.name).is_some());
        let effect = if is_given { field.when_given } else { None };
        effect.into_iter().for_each(|effect| effect(thing));
        Ok(is_given)
    }

    /// The thing of a whole table.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value not allowed.
    pub fn of_table(&self, table: Table<'_>) -> Result<T, Error> {
        self.read(&table.allow(&self.keys())?, &mut K::Context::default())
    }

    /// The thing with the changes of a whole table.
    ///
    /// # Errors
    /// A key is unknown, or a value not allowed.
    pub fn changed_by(&self, thing: T, table: Table<'_>) -> Result<T, Error> {
        self.change(thing, &table.allow(&self.keys())?, &mut K::Context::default())
    }

    /// Refuses keys that do not go together.
    fn keep_company(&self, table: &Table<'_>) -> Result<(), Error> {
        self.rules.iter().try_for_each(|rule| match rule {
            Rule::Holds { .. } => Ok(()),
            Rule::OneOf(groups) => one_of(table, groups).map(drop),
            Rule::NotWith(keys, help) => {
                let mut given = keys.iter().filter_map(|key| table.get(key));
                match (given.next(), given.next()) {
                    (Some(one), Some(other)) if help.is_empty() => Err(beside(&one, &other)),
                    (Some(one), Some(other)) => Err(beside(&one, &other).with_help(*help)),
                    _ => Ok(()),
                }
            }
            Rule::OnlyWith(key, others) => match table.get(key) {
                Some(item) if others.iter().all(|other| table.get(other).is_none()) => {
                    let others: Vec<String> = others.iter().map(|other| table.name_of(other)).collect();
                    Err(item.error(format!("{} is given without {}", item.path(), others.join(" or "))))
                }
                _ => Ok(()),
            },
        })
    }

    /// Refuses a thing whose values do not go together.
    fn keep_relations(&self, table: &Table<'_>, thing: &T) -> Result<(), Error> {
        for rule in self.rules {
            let Rule::Holds { key, broken, help } = rule else { continue };
            let Some(must_be) = broken(thing) else { continue };
            let Some(item) = table.get(key) else {
                let (path, default) = (table.path_of(key), self.shown(thing, key));
                let message = format!("{path} is {default} by default, but must be {must_be}");
                return Err(table.error(message).with_help(*help));
            };
            return Err(item.refuse(&must_be));
        }
        Ok(())
    }

    /// Checks every field of a thing, beside lists of these lengths.
    ///
    /// # Errors
    /// A number is out of its range, or something breaks a rule: the message names the key and its value.
    pub fn check(&self, thing: &T, lists: &K::Lists) -> Result<(), Error> {
        let mut copy = thing.clone();
        for field in self.fields {
            (field.slot)(&mut copy).check(field.key(), lists)?;
        }
        for rule in self.rules {
            let Rule::Holds { key, broken, .. } = rule else { continue };
            let Some(must_be) = broken(thing) else { continue };
            return Err(refusal(key, self.shown(thing, key), must_be));
        }
        Ok(())
    }

    /// Every key with its value, from which the thing is read again, but for what is at hand.
    pub fn write(&self, thing: &T) -> Vec<Entry> {
        self.write_at(thing, [0.0; 3])
    }

    /// As [`write`](Self::write), with points counted from this origin.
    pub fn write_at(&self, thing: &T, origin: [f64; 3]) -> Vec<Entry> {
        let mut copy = thing.clone();
        let entries = |field: &Field<T, K>| (field.slot)(&mut copy).write(field.keys, origin);
        self.fields.iter().flat_map(entries).collect()
    }

    /// The value of a key, as messages have it.
    fn shown(&self, thing: &T, key: &str) -> String {
        let entry = self.write(thing).into_iter().find(|entry| entry.key == key);
        entry.map_or(String::new(), |entry| format!("{:#}", entry.value))
    }

    /// The keys by which a thing differs from another, with their values.
    pub fn write_changes(&self, from: &T, to: &T) -> Vec<Entry> {
        let (mut from, mut to) = (from.clone(), to.clone());
        let changes = |field: &Field<T, K>| {
            K::Slot::changes((field.slot)(&mut from), (field.slot)(&mut to), field.keys)
        };
        self.fields.iter().flat_map(changes).collect()
    }
}

/// The number of the group of keys that is given, alone and whole.
///
/// # Errors
/// There is none, there are two, or a key of it is missing.
pub fn one_of(table: &Table<'_>, groups: &[&[&'static str]]) -> Result<usize, Error> {
    let first = |group: &&[&'static str]| group.iter().find_map(|key| table.get(key));
    let mut given = groups.iter().enumerate().filter_map(|(i, group)| Some((i, first(group)?)));
    let list =
        |keys: &&[&'static str]| keys.iter().map(|key| table.name_of(key)).collect::<Vec<_>>().join(" and ");
    match (given.next(), given.next()) {
        (Some((_, one)), Some((_, other))) => Err(beside(&one, &other)),
        (Some((i, one)), None) => match groups[i].iter().find(|key| table.get(key).is_none()) {
            Some(key) => Err(one.error(format!("{} needs {} beside it", one.path(), table.name_of(key)))),
            None => Ok(i),
        },
        (None, _) => {
            let all: Vec<String> = groups.iter().map(list).collect();
            Err(table.error(format!("{} needs {}", table.path(), all.join(", or "))))
        }
    }
}

fn beside(one: &Item<'_>, other: &Item<'_>) -> Error {
    other.error(format!("{} and {} are given, but only one of them must be", one.path(), other.path()))
}

/// A [`Field`] of a type or of a variant: `field!(Light::Sphere { radius } => slot, meaning, fallback)`, whose key is the
/// name of the field; or `field!(Light::Beam { direction, origin } => slot; KEYS)`, for which several belong together.
#[macro_export]
macro_rules! field {
    ($owner:path { $first:ident } => $slot:expr, $doc:expr, $fallback:expr) => {
        $crate::field!($owner { $first } => $slot; &[$crate::Key::new(stringify!($first), $doc, $fallback)])
    };
    ($owner:path { $first:ident } => $slot:expr, $doc:expr, $more:expr, $fallback:expr) => {
        $crate::field!($owner { $first } => $slot; &[$crate::Key {
            name: stringify!($first),
            doc: $doc,
            more: $more,
            fallback: $fallback,
        }])
    };
    ($owner:path { $($part:ident),+ } => $slot:expr; $keys:expr) => {
        $crate::Field {
            keys: $keys,
            slot: |thing| match thing {
                $owner { $($part,)+ .. } => $slot,
                #[allow(unreachable_patterns, reason = "a type of one variant has no others")]
                _ => $crate::Slot::absent(),
            },
            when_given: None,
            when_missing: None,
        }
    };
}
