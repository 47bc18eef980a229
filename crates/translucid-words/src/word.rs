//! Values that have names.

use translucid_display::ToneMapping;
use translucid_profile::convention::Unit;
use translucid_profile::{Configuration, Parameterization};

/// A type whose values have names.
pub trait Word: Copy + PartialEq + 'static {
    /// Every value by its name.
    const WORDS: &'static [(&'static str, Self)];
}

impl Word for Configuration {
    const WORDS: &'static [(&'static str, Self)] = &Self::WORDS;
}

impl Word for Parameterization {
    const WORDS: &'static [(&'static str, Self)] = &Self::WORDS;
}

impl Word for Unit {
    const WORDS: &'static [(&'static str, Self)] = &Self::WORDS;
}

impl Word for ToneMapping {
    const WORDS: &'static [(&'static str, Self)] = &Self::WORDS;
}

/// A value out of a few with names, whatever its type.
pub trait Choice {
    /// All names.
    fn names(&self) -> Vec<&'static str>;
    /// The name of the value; empty where there is none.
    fn name(&self) -> &'static str;
    /// Sets the value by the number of its name.
    fn choose(&mut self, number: usize);
}

impl<T: Word> Choice for T {
    fn names(&self) -> Vec<&'static str> {
        T::WORDS.iter().map(|(name, _)| *name).collect()
    }

    fn name(&self) -> &'static str {
        T::WORDS.iter().find(|(_, value)| value == self).map_or("", |(name, _)| name)
    }

    fn choose(&mut self, number: usize) {
        *self = T::WORDS[number].1;
    }
}
