//! What a series stands for.

use translucid_profile::Model;

/// What a series stands for.
///
/// It has the same color, dash pattern and marker in every chart, so that a reader who has learned it once knows it
/// everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ink {
    /// A model.
    Model(Model),
    /// The truth that others are measured against: the exact solution, or a walk of photons.
    Reference,
    /// What the seed talk published \[Christensen & Burley 2015\].
    Talk,
    /// What was fitted here.
    Fit,
    /// The n-th of series that need nothing but to be told apart; they repeat after [`Ink::NUMBERED`].
    Numbered(usize),
    /// A line that helps to read, as that of zero.
    Guide,
}

impl Ink {
    /// Number of [`Ink::Numbered`] inks.
    pub const NUMBERED: usize = 12;
}
