//! The models that are compared, made from one set of parameters: a surface albedo and a mean free path of 1.

use translucid_profile::{
    Appearance, BeamMultipleScattering, BeamSingleScattering, BetterDipole, Configuration,
    DirectionalDipoleAverage, Medium, NormalizedDiffusion, ParameterError, Parameterization,
    PhotonBeamDiffusion, Profile, QuantizedDiffusion, RefinedDiffusion, StandardDipole, SumOfGaussians,
};

pub(crate) type Made = Result<Box<dyn Profile>, ParameterError>;

/// A model in the searchlight configuration.
pub(crate) struct Contender {
    pub(crate) name: String,
    /// The profile whose total is the surface albedo, by the model's own inversion where it has one.
    pub(crate) from_albedo: Box<dyn Fn(f64) -> Made>,
    /// The profile of a medium, whose total is what the model makes of it; `None` where albedos are all it takes.
    pub(crate) from_medium: Option<fn(&Medium) -> Made>,
}

/// A model with a medium behind it, by its two constructors.
macro_rules! physical {
    ($name:expr, $model:ident) => {
        Contender {
            name: $name.to_owned(),
            from_albedo: Box::new(|a| Ok(Box::new($model::new(&appearance(a), 1.0)?))),
            from_medium: Some(|medium| Ok(Box::new($model::from_medium(medium, 1.0)?))),
        }
    };
}

/// A model of media whose inversion is made here, because it is a part or a sum of others.
fn composed(name: &str, from_medium: fn(&Medium) -> Made) -> Contender {
    let from_albedo = move |a: f64| {
        let total = |absorbed: f64| {
            let medium = Medium::from_reduced(absorbed, 1.0 - absorbed, 0.0).expect("a reduced albedo");
            from_medium(&medium).map_or(0.0, |profile| profile.total())
        };
        from_medium(&appearance(a).medium(total)?.medium)
    };
    Contender { name: name.to_owned(), from_albedo: Box::new(from_albedo), from_medium: Some(from_medium) }
}

/// A model of multiple scattering, and exact single scattering.
struct WithSingleScattering<P>(P, BeamSingleScattering);

impl<P: Profile> Profile for WithSingleScattering<P> {
    fn eval_times_r(&self, r: f64) -> f64 {
        self.0.eval_times_r(r) + self.1.eval_times_r(r)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.0.enclosed(r) + self.1.enclosed(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        self.0.beyond(r) + self.1.beyond(r)
    }

    fn total(&self) -> f64 {
        self.0.total() + self.1.total()
    }

    fn scale(&self) -> f64 {
        self.0.scale()
    }

    fn evaluations_to_build(&self) -> u32 {
        self.0.evaluations_to_build() + self.1.evaluations_to_build()
    }
}

/// A model of multiple scattering with single scattering added.
macro_rules! with_single_scattering {
    ($name:expr, $model:ident) => {
        composed($name, |medium| {
            let single = BeamSingleScattering::from_medium(medium, 1.0)?;
            Ok(Box::new(WithSingleScattering($model::from_medium(medium, 1.0)?, single)))
        })
    };
}

/// Every model, the talk's first.
pub(crate) fn contenders() -> Vec<Contender> {
    let mut contenders = vec![
        Contender {
            name: "normalized-diffusion".to_owned(),
            from_albedo: Box::new(|a| Ok(Box::new(normalized_diffusion(a, Configuration::Searchlight)?))),
            from_medium: None,
        },
        Contender {
            name: "normalized-diffusion-refined".to_owned(),
            from_albedo: Box::new(|a| Ok(Box::new(refined(a, Configuration::Searchlight)?))),
            from_medium: None,
        },
        physical!("dipole", StandardDipole),
        physical!("better-dipole", BetterDipole),
        with_single_scattering!("better-dipole + single scattering", BetterDipole),
        physical!("directional-dipole, average", DirectionalDipoleAverage),
        physical!("quantized-diffusion", QuantizedDiffusion),
        with_single_scattering!("quantized-diffusion + single scattering", QuantizedDiffusion),
        composed("photon-beam-diffusion, multiple only", |medium| {
            Ok(Box::new(BeamMultipleScattering::from_medium(medium, 1.0)?))
        }),
        physical!("photon-beam-diffusion", PhotonBeamDiffusion),
    ];
    contenders.extend((1..=SumOfGaussians::MAX_TERMS).map(|terms| Contender {
        name: format!("gaussians, {terms} {}", if terms == 1 { "term" } else { "terms" }),
        from_albedo: Box::new(move |a| {
            let (mfp, searchlight) = (Parameterization::Mfp, Configuration::Searchlight);
            Ok(Box::new(SumOfGaussians::new(a, 1.0, mfp, searchlight, terms)?))
        }),
        from_medium: None,
    }));
    contenders
}

/// Normalized diffusion from the mean free path 1.
pub(crate) fn normalized_diffusion(
    surface_albedo: f64,
    configuration: Configuration,
) -> Result<NormalizedDiffusion, ParameterError> {
    NormalizedDiffusion::new(surface_albedo, 1.0, Parameterization::Mfp, configuration)
}

/// Refined normalized diffusion from the mean free path 1.
pub(crate) fn refined(
    surface_albedo: f64,
    configuration: Configuration,
) -> Result<RefinedDiffusion, ParameterError> {
    RefinedDiffusion::new(surface_albedo, 1.0, Parameterization::Mfp, configuration)
}

fn appearance(surface_albedo: f64) -> Appearance {
    Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 }
}
