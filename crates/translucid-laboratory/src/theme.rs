//! Light and dark.

/// The background that a chart is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Theme {
    /// Dark on white, as for print.
    Light,
    /// Light on near black, as for a dark page.
    Dark,
}
