//! Scene files, key by key.

use std::fmt::{Display, Write};

use glam::Vec3;

/// The text of a scene file that is being written.
#[derive(Default)]
pub(crate) struct Text(String);

impl Text {
    /// Opens a table: `[film]`, `[[light]]`.
    pub(crate) fn open(&mut self, header: &str) {
        self.line(format_args!("\n{header}"));
    }

    /// A key and a value as TOML writes it.
    pub(crate) fn set(&mut self, key: &str, value: impl Display) {
        self.line(format_args!("{key} = {value}"));
    }

    pub(crate) fn set_text(&mut self, key: &str, value: &str) {
        self.line(format_args!("{key} = \"{value}\""));
    }

    pub(crate) fn set_number(&mut self, key: &str, value: f64) {
        self.set(key, number(value));
    }

    pub(crate) fn set_color(&mut self, key: &str, color: [f64; 3]) {
        self.set(key, triple(color));
    }

    pub(crate) fn set_vector(&mut self, key: &str, vector: Vec3) {
        self.set(key, triple(vector.to_array().map(f64::from)));
    }

    fn line(&mut self, line: impl Display) {
        writeln!(self.0, "{line}").expect("a string takes every line");
    }

    pub(crate) fn finish(self) -> String {
        self.0
    }
}

/// With an exponent: the digits of 1e-50 would be many.
pub(crate) fn number(value: f64) -> String {
    format!("{value:e}")
}

pub(crate) fn triple(values: [f64; 3]) -> String {
    let [x, y, z] = values.map(number);
    format!("[{x}, {y}, {z}]")
}
