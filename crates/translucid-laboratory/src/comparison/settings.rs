//! Wishes for a comparison.

use translucid_profile::{Configuration, Model, Parameterization};

use super::{Contender, ScalingCase, talk_albedos};

/// Everything that a [`Comparison`](super::Comparison) is asked for.
pub struct Settings {
    /// The contenders.
    pub contenders: Vec<Contender>,
    /// Surface albedos that get figures, each in (0, 1\].
    pub surface_albedos: Vec<f64>,
    /// Surface albedos that mean errors are over.
    pub averaged: Vec<f64>,
    /// Ways in which light enters.
    pub configurations: Vec<Configuration>,
    /// Greatest radius of the figures in mean free paths, at least 0.2.
    pub max_radius: f64,
    /// Photons of a walk in each configuration; 0 for no walk.
    pub photons: u64,
    /// Seed of the photons and of drawn radii.
    pub seed: u64,
    /// Radii that are drawn from each model.
    pub samples: u64,
    /// Rounds in which calls are timed, some 80 for figures that hold; 0 for no times.
    pub timing_rounds: usize,
}

impl Default for Settings {
    /// Everything, at the albedos of the talk.
    fn default() -> Self {
        Self {
            contenders: Contender::all(),
            surface_albedos: vec![0.2, 0.5, 0.8],
            averaged: talk_albedos(),
            configurations: vec![Configuration::Searchlight, Configuration::Diffuse],
            max_radius: 16.0,
            photons: 4_000_000,
            seed: 0,
            samples: 200_000,
            timing_rounds: 80,
        }
    }
}

impl Settings {
    /// The cases of s(A): none without the model that it is for.
    pub(super) fn scaling_cases(&self) -> &'static [(Parameterization, Configuration, f64)] {
        let normalized = Model::NormalizedDiffusion.name();
        if self.contenders.iter().any(|one| one.name == normalized) { &ScalingCase::TALK } else { &[] }
    }
}
