//! Contenders of a comparison, by name.

use translucid_profile::{
    Appearance, BeamMultipleScattering, BeamSingleScattering, Configuration, Medium, Model, ParameterError,
    Parameterization, Profile, SumOfGaussians, TabulatedProfile,
};

use super::Reference;

/// A profile, or why there is none.
pub type Made = Result<Box<dyn Profile>, ParameterError>;

/// Makes a profile from a reference or a medium.
type Make<T> = Box<dyn Fn(&T) -> Made + Send + Sync>;

/// Kind of a contender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// A model of [`Model::ALL`].
    Model,
    /// A part of a model, a model with something added, or the same with other parameters.
    Variant,
    /// A least-squares fit to the reference at each albedo.
    Fit,
}

/// Way of a model that knows media to the one of a surface albedo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inversion {
    /// The medium whose total, by the model's own formulas, is A.
    Own,
    /// The medium whose total is A exactly; the model's then is another.
    Exact,
}

impl Inversion {
    /// One word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::Exact => "exact",
        }
    }
}

/// A profile that is compared, made for a surface albedo and a mean free path of 1.
pub struct Contender {
    /// Name in files and on the command line: lower case, digits and hyphens.
    pub name: &'static str,
    /// Name in tables and figures.
    pub title: &'static str,
    /// The model that it is, or is akin to.
    pub model: Option<Model>,
    /// Kind of profile.
    pub group: Group,
    /// Number of terms of a sum.
    pub terms: Option<usize>,
    make: Make<Reference>,
    /// The profile of a medium, whose total is what the model makes of it.
    from_medium: Option<Make<Medium>>,
    /// Whether the model describes diffuse light, not a perpendicular pencil only.
    knows_diffuse: bool,
}

impl Contender {
    /// Every contender: models and their variants, then sums of Gaussians, then fits.
    ///
    /// [`Model::NormalizedDiffusionOblique`] alone is missing: perpendicular light makes it
    /// [`Model::NormalizedDiffusionRefined`], and light at an angle makes it no function of the radius alone.
    pub fn all() -> Vec<Self> {
        let mut all = models();
        all.extend(GAUSSIANS.iter().zip(1..).map(|(names, terms)| gaussians(*names, terms)));
        all.push(of_model(Model::Exact));
        all.extend(fits());
        all
    }

    /// Names of all contenders.
    pub fn names() -> Vec<&'static str> {
        Self::all().iter().map(|contender| contender.name).collect()
    }

    /// Returns whether the model describes light that enters so.
    pub fn knows(&self, configuration: Configuration) -> bool {
        self.knows_diffuse || configuration == Configuration::Searchlight
    }

    /// Returns whether the model describes media, and has more than one way to the one of a surface albedo.
    pub fn knows_media(&self) -> bool {
        self.from_medium.is_some()
    }

    /// Returns whether it is one of [`Model::ALL`].
    pub fn is_model(&self) -> bool {
        self.group == Group::Model
    }

    /// The profile whose total is the surface albedo of the reference.
    ///
    /// # Errors
    /// The model does not reach the surface albedo.
    pub fn profile(&self, reference: &Reference) -> Made {
        (self.make)(reference)
    }

    /// The profile by either way to a medium; `None` where the model knows none.
    pub fn profile_by(&self, reference: &Reference, inversion: Inversion) -> Option<Made> {
        match inversion {
            Inversion::Own => Some(self.profile(reference)),
            Inversion::Exact => Some(self.from_medium.as_ref()?(&reference.medium)),
        }
    }

    /// The profile in a form that is sampled in constant time: itself where it is, else its table.
    ///
    /// # Errors
    /// As [`profile`](Self::profile).
    pub fn profile_to_sample(&self, reference: &Reference) -> Made {
        let profile = self.profile(reference)?;
        Ok(if profile.samples_directly() { profile } else { Box::new(TabulatedProfile::new(&*profile)) })
    }
}

/// The models, but for those that the others bring, and their variants.
fn models() -> Vec<Contender> {
    vec![
        of_model(Model::NormalizedDiffusion),
        of_model(Model::NormalizedDiffusionRefined),
        of_model(Model::Dipole),
        of_model(Model::BetterDipole),
        with_single_scattering(
            "better-dipole-with-single-scattering",
            "better-dipole + single scattering",
            Model::BetterDipole,
        ),
        Contender { title: "directional-dipole, average", ..of_model(Model::DirectionalDipole) },
        of_model(Model::QuantizedDiffusion),
        with_single_scattering(
            "quantized-diffusion-with-single-scattering",
            "quantized-diffusion + single scattering",
            Model::QuantizedDiffusion,
        ),
        composed(
            "photon-beam-diffusion-multiple-only",
            "photon-beam-diffusion, multiple only",
            Model::PhotonBeamDiffusion,
            |medium| Ok(Box::new(BeamMultipleScattering::from_medium(medium, 1.0)?)),
        ),
        of_model(Model::PhotonBeamDiffusion),
    ]
}

/// A model by its name; those that are derived for a perpendicular pencil know media.
fn of_model(model: Model) -> Contender {
    let profile = move |reference: &Reference| {
        model.profile(&appearance(reference.surface_albedo), reference.configuration, 1.0)
    };
    let from_medium = move |medium: &Medium| model.profile_of_medium(medium, Configuration::Searchlight, 1.0);
    Contender {
        name: model.name(),
        title: model.name(),
        model: Some(model),
        group: Group::Model,
        terms: None,
        make: Box::new(profile),
        from_medium: (!model.knows_configuration()).then(|| Box::new(from_medium) as _),
        knows_diffuse: model.knows_configuration(),
    }
}

/// A model of media whose inversion is made here, because it is a part or a sum of others.
fn composed(
    name: &'static str,
    title: &'static str,
    model: Model,
    from_medium: impl Fn(&Medium) -> Made + Copy + Send + Sync + 'static,
) -> Contender {
    let make = move |reference: &Reference| {
        let total = |absorbed: f64| {
            // The trials are of reduced albedos in [0, 1], which are media
            let medium = Medium::from_reduced(absorbed, 1.0 - absorbed, 0.0);
            medium.and_then(|medium| from_medium(&medium)).map_or(0.0, |profile| profile.surface_albedo())
        };
        from_medium(&appearance(reference.surface_albedo).medium(total)?)
    };
    let (make, from_medium) = (Box::new(make), Some(Box::new(from_medium) as _));
    Contender { name, title, group: Group::Variant, make, from_medium, ..of_model(model) }
}

/// A model of multiple scattering with single scattering added.
fn with_single_scattering(name: &'static str, title: &'static str, model: Model) -> Contender {
    composed(name, title, model, move |medium| {
        let multiple = model.profile_of_medium(medium, Configuration::Searchlight, 1.0)?;
        Ok(Box::new(WithSingleScattering(multiple, BeamSingleScattering::from_medium(medium, 1.0)?)))
    })
}

/// Names and titles of the sums of Gaussians; that of the most terms is the model.
const GAUSSIANS: [[&str; 2]; SumOfGaussians::MAX_TERMS] = [
    ["gaussians-1", "gaussians, 1 term"],
    ["gaussians-2", "gaussians, 2 terms"],
    ["gaussians-3", "gaussians, 3 terms"],
    ["gaussians-4", "gaussians, 4 terms"],
    ["gaussians-5", "gaussians, 5 terms"],
    [Model::Gaussians.name(), "gaussians, 6 terms"],
];

fn gaussians([name, title]: [&'static str; 2], terms: usize) -> Contender {
    let make = move |reference: &Reference| -> Made {
        let (mfp, configuration) = (Parameterization::Mfp, reference.configuration);
        Ok(Box::new(SumOfGaussians::new(reference.surface_albedo, 1.0, mfp, configuration, terms)?))
    };
    let group = if terms == SumOfGaussians::DEFAULT_TERMS { Group::Model } else { Group::Variant };
    Contender { name, title, group, terms: Some(terms), make: Box::new(make), ..of_model(Model::Gaussians) }
}

/// A model by way of the diffuse mean free path of the exact medium.
fn from_dmfp(name: &'static str, title: &'static str, model: Model) -> Contender {
    let make = move |reference: &Reference| {
        let (length, parameterization) = (reference.medium.dmfp(), Parameterization::Dmfp);
        let appearance = Appearance { length, parameterization, ..appearance(reference.surface_albedo) };
        model.profile(&appearance, reference.configuration, 1.0)
    };
    Contender { name, title, group: Group::Variant, make: Box::new(make), ..of_model(model) }
}

/// Normalized diffusion from another length, and the best that a family can do at each albedo.
fn fits() -> Vec<Contender> {
    const EXPONENTIALS: [[&str; 2]; Reference::MAX_EXPONENTIALS] = [
        ["exponentials-1", "best 1 exponential"],
        ["exponentials-2", "best 2 exponentials"],
        ["exponentials-3", "best 3 exponentials"],
        ["exponentials-4", "best 4 exponentials"],
    ];
    let normalized = Model::NormalizedDiffusion;
    let mut fits = vec![
        Contender {
            // The talk has a fit in this length for the pencil only
            knows_diffuse: false,
            ..from_dmfp("normalized-diffusion-from-dmfp", "normalized diffusion from the dmfp", normalized)
        },
        from_dmfp(
            "normalized-diffusion-refined-from-dmfp",
            "normalized diffusion refined, from the dmfp",
            Model::NormalizedDiffusionRefined,
        ),
        Contender {
            name: "best-normalized-diffusion",
            title: "best normalized diffusion",
            group: Group::Fit,
            make: Box::new(|reference| Ok(Box::new(reference.best_normalized_diffusion()?.mixture))),
            ..of_model(normalized)
        },
    ];
    fits.extend(EXPONENTIALS.iter().zip(1..).map(|([name, title], terms)| {
        let make = move |reference: &Reference| -> Made {
            let fit = reference.exponentials().get(terms - 1);
            let fit = fit.ok_or(ParameterError::new("terms", terms as f64, "among the fits"))?;
            Ok(Box::new(fit.mixture.clone()))
        };
        let (group, terms, make) = (Group::Fit, Some(terms), Box::new(make));
        Contender { name, title, model: None, group, terms, make, ..of_model(normalized) }
    }));
    fits
}

/// A model of multiple scattering, and exact single scattering.
struct WithSingleScattering(Box<dyn Profile>, BeamSingleScattering);

impl Profile for WithSingleScattering {
    fn eval_times_r(&self, r: f64) -> f64 {
        self.0.eval_times_r(r) + self.1.eval_times_r(r)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.0.enclosed(r) + self.1.enclosed(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        self.0.beyond(r) + self.1.beyond(r)
    }

    fn surface_albedo(&self) -> f64 {
        self.0.surface_albedo() + self.1.surface_albedo()
    }

    fn scale(&self) -> f64 {
        self.0.scale()
    }
}

fn appearance(surface_albedo: f64) -> Appearance {
    Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_is_a_contender() {
        let all = Contender::all();
        for model in Model::ALL {
            let found = all.iter().filter(|contender| contender.name == model.name()).count();
            let is_missing = model == Model::NormalizedDiffusionOblique;
            assert_eq!(found, usize::from(!is_missing), "{model}");
        }
        // What is missing has the profile of another
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            let [refined, oblique] = [Model::NormalizedDiffusionRefined, Model::NormalizedDiffusionOblique]
                .map(|model| model.profile(&appearance(0.6), configuration, 1.0).unwrap());
            assert_eq!(refined.eval(0.7), oblique.eval(0.7));
        }
        for (i, contender) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|other| other.name != contender.name), "{}", contender.name);
            assert!(all[..i].iter().all(|other| other.title != contender.title), "{}", contender.title);
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(contender.name.chars().all(plain), "{}", contender.name);
        }
    }

    #[test]
    fn contenders_have_the_albedo() {
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            for surface_albedo in [0.2, 0.8] {
                let reference = Reference::new(surface_albedo, configuration).unwrap();
                for contender in Contender::all().iter().filter(|one| one.knows(configuration)) {
                    let profile = contender.profile(&reference).unwrap();
                    let name = contender.name;
                    assert!(
                        (profile.surface_albedo() - surface_albedo).abs() < 1e-8,
                        "{name}: {}",
                        profile.surface_albedo()
                    );
                    let r = contender.profile_to_sample(&reference).unwrap().sample(0.6);
                    assert!(r > 0.0 && r < 40.0, "{name}: {r}");
                    assert_eq!(
                        contender.knows_media(),
                        contender.profile_by(&reference, Inversion::Exact).is_some()
                    );
                }
            }
        }
    }
}
