//! Gaussians against exponentials.

use translucid_profile::{Configuration, SumOfGaussians};

use super::{ErrorTable, Inversion, R_MAX, Reference};

/// Family of the terms of a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MixtureFamily {
    /// e^{−r²/2s²}
    Gaussians,
    /// e^{−r/s}/r
    Exponentials,
}

/// Mean errors of the best sums of K terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixtureErrors {
    /// Family of the terms.
    pub family: MixtureFamily,
    /// K.
    pub terms: usize,
    /// Way in which light enters.
    pub configuration: Configuration,
    /// Mean errors over the albedos that means are over, up to each of [`R_MAX`].
    pub errors: [f64; 3],
}

impl MixtureFamily {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Gaussians, Self::Exponentials];

    /// One word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gaussians => "gaussians",
            Self::Exponentials => "exponentials",
        }
    }

    /// One word as it stands in a sentence.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Gaussians => "Gaussians",
            Self::Exponentials => "exponentials",
        }
    }

    /// The [`Contender`](super::Contender) of so many terms.
    pub fn contender(self, terms: usize) -> String {
        match self {
            Self::Gaussians if terms == SumOfGaussians::MAX_TERMS => String::from(self.name()),
            _ => format!("{}-{terms}", self.name()),
        }
    }

    /// Most terms that are compared.
    pub const fn most_terms(self) -> usize {
        match self {
            Self::Gaussians => SumOfGaussians::MAX_TERMS,
            Self::Exponentials => Reference::MAX_EXPONENTIALS,
        }
    }
}

impl MixtureErrors {
    /// The sums that a table of errors has.
    pub fn of(table: &ErrorTable, configurations: &[Configuration]) -> Vec<Self> {
        let mut found = Vec::new();
        for &configuration in configurations {
            for family in MixtureFamily::ALL {
                for terms in 1..=family.most_terms() {
                    let contender = family.contender(terms);
                    if let Some(summary) = table.summary(&contender, configuration, Inversion::Own) {
                        let errors = [0, 1, 2].map(|i: usize| summary.errors[i].mean);
                        found.push(Self { family, terms, configuration, errors });
                    }
                }
            }
        }
        debug_assert_eq!(R_MAX.len(), 3);
        found
    }
}
