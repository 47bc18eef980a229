//! Distances of contenders from the exact solution.

use rayon::prelude::*;
use translucid_fit::ErrorSummary;
use translucid_profile::{Configuration, ParameterError};

use super::watch::{Progress, Stopped};
use super::{Contender, Inversion, R_MAX, Reference, Settings};

/// The errors of one contender at one surface albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorRow {
    /// [`Contender::name`].
    pub contender: &'static str,
    /// Way in which light enters.
    pub configuration: Configuration,
    /// Way in which the model found its medium; `Own` for one that has none.
    pub inversion: Inversion,
    /// Surface albedo A.
    pub surface_albedo: f64,
    /// Area-weighted L1 errors up to each of [`R_MAX`], relative to the energy of the exact profile there.
    pub errors: [f64; 3],
}

/// Errors of many contenders at many surface albedos.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorTable {
    /// Rows sorted by configuration, contender, inversion and albedo, each in the order that was asked for. A contender that does
    /// not reach an albedo or does not know a configuration has no row.
    pub rows: Vec<ErrorRow>,
    /// The surface albedos that means are over.
    pub averaged: Vec<f64>,
}

/// Errors of one contender over the albedos that means are over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Mean and worst up to each of [`R_MAX`].
    pub errors: [ErrorSummary; 3],
    /// Number of the albedos that the contender reaches.
    pub reached: usize,
}

impl ErrorTable {
    /// Milliseconds that all contenders take at one albedo.
    const COST: u64 = 56;

    /// Judges the contenders at the surface albedos that means are over and at those that get figures, on all threads
    /// of the current rayon pool.
    ///
    /// # Errors
    /// The work was stopped. An albedo that is not in (0, 1\] has no rows.
    pub(super) fn new(settings: &Settings, progress: &Progress<'_>) -> Result<Self, Stopped> {
        let Settings { contenders, configurations, averaged, .. } = settings;
        let half_spaces = half_spaces(settings);
        let judged = half_spaces.par_iter().map(|(configuration, albedo)| {
            progress.check()?;
            let rows = Reference::new(*albedo, *configuration).map(|one| rows(contenders, &one));
            progress.add(Self::COST);
            Ok(rows.unwrap_or_default())
        });
        let mut rows = judged.collect::<Result<Vec<_>, Stopped>>()?.concat();
        // Stable: albedos stay as they are
        let place = |row: &ErrorRow| {
            let configuration = configurations.iter().position(|one| *one == row.configuration);
            let contender = contenders.iter().position(|one| one.name == row.contender);
            (configuration, row.inversion == Inversion::Exact, contender)
        };
        rows.sort_by_key(place);
        Ok(Self { rows, averaged: averaged.clone() })
    }

    /// Cost of judging, in the units of progress.
    pub(super) fn work(settings: &Settings) -> u64 {
        Self::COST * half_spaces(settings).len() as u64
    }

    /// The rows of one contender.
    pub fn of(
        &self,
        contender: &str,
        configuration: Configuration,
        inversion: Inversion,
    ) -> impl Iterator<Item = &ErrorRow> {
        self.rows.iter().filter(move |row| {
            row.contender == contender && row.configuration == configuration && row.inversion == inversion
        })
    }

    /// Means over [`averaged`](Self::averaged); `None` for a contender that reaches none of them.
    pub fn summary(
        &self,
        contender: &str,
        configuration: Configuration,
        inversion: Inversion,
    ) -> Option<Summary> {
        let rows: Vec<&ErrorRow> = self
            .of(contender, configuration, inversion)
            .filter(|row| self.averaged.contains(&row.surface_albedo))
            .collect();
        if rows.is_empty() {
            return None;
        }
        let errors = [0, 1, 2].map(|r_max| {
            let errors: Vec<_> = rows.iter().map(|row| (row.surface_albedo, row.errors[r_max])).collect();
            ErrorSummary::new(&errors)
        });
        Some(Summary { errors, reached: rows.len() })
    }

    /// The error over all radii at one surface albedo.
    pub fn at(
        &self,
        contender: &str,
        configuration: Configuration,
        inversion: Inversion,
        surface_albedo: f64,
    ) -> Option<f64> {
        let row = |row: &&ErrorRow| row.surface_albedo == surface_albedo;
        Some(self.of(contender, configuration, inversion).find(row)?.errors[2])
    }
}

/// Configurations and albedos, sorted and each once; none for a configuration that no contender knows.
fn half_spaces(settings: &Settings) -> Vec<(Configuration, f64)> {
    let mut albedos = [&settings.averaged[..], &settings.surface_albedos].concat();
    albedos.sort_by(f64::total_cmp);
    albedos.dedup();
    let known = |c: &&Configuration| settings.contenders.iter().any(|contender| contender.knows(**c));
    let configurations = settings.configurations.iter().filter(known);
    configurations.flat_map(|c| albedos.iter().map(|a| (*c, *a))).collect()
}

/// Judges all contenders at one surface albedo.
fn rows(contenders: &[Contender], reference: &Reference) -> Vec<ErrorRow> {
    let ways = contenders
        .iter()
        .filter(|contender| contender.knows(reference.configuration))
        .flat_map(|contender| [Inversion::Own, Inversion::Exact].map(|inversion| (contender, inversion)));
    let row = |(contender, inversion): (&Contender, Inversion)| -> Option<ErrorRow> {
        let profile: Result<_, ParameterError> = contender.profile_by(reference, inversion)?;
        Some(ErrorRow {
            contender: contender.name,
            configuration: reference.configuration,
            inversion,
            surface_albedo: reference.surface_albedo,
            errors: reference.judge.l1_errors(&*profile.ok()?, R_MAX),
        })
    };
    ways.filter_map(row).collect()
}
