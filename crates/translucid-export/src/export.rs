//! Exports: which subjects have which targets, and how a text is put together.

use std::ops::RangeInclusive;

use translucid_profile::{
    Appearance, Configuration, Model, NormalizedDiffusion, Parameterization, Profile, SumOfGaussians,
    TabulatedProfile, require,
};

use crate::curvature_table::CurvatureTable;
use crate::disk::Disk;
use crate::error::ExportError;
use crate::formula::formulas;
use crate::function::{Function, functions};
use crate::header;
#[cfg(not(target_family = "wasm"))]
use crate::image;
use crate::inversion::Inversion;
use crate::kernel::Kernel;
use crate::language::Language;
use crate::material::Material;
use crate::materialx;
use crate::number::literal;
use crate::subject::Subject;
use crate::sum::{Sum, Terms};
use crate::target::Target;
#[cfg(not(target_family = "wasm"))]
use crate::transmittance::TransmittanceTable;

/// Sizes of tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Taps of a disk, or of a kernel along a line, which has an odd number: one more where this is even.
    pub taps: usize,
    /// Columns and rows of a pre-integrated table.
    pub lut: [usize; 2],
    /// Greatest curvature of a pre-integrated table \[L⁻¹\]; without one, 1 over the longest length.
    pub most_curvature: Option<f64>,
    /// Greatest thickness of transmittances \[L\], which have as many columns as a pre-integrated table; without one, where
    /// less than 1/256 is left of the brightest channel.
    pub most_thickness: Option<f64>,
}

impl Sizes {
    /// Numbers of taps that there can be.
    pub const TAPS: RangeInclusive<usize> = 3..=1024;
    /// Columns or rows that there can be.
    pub const LUT: RangeInclusive<usize> = 2..=1024;
}

impl Default for Sizes {
    fn default() -> Self {
        Self { taps: 25, lut: [128, 32], most_curvature: None, most_thickness: None }
    }
}

/// What is to be exported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Export<'a> {
    /// Target of the text.
    pub target: Target,
    /// Subjects, all in one text.
    pub subjects: &'a [Subject],
    /// Models of the profile.
    pub models: &'a [Model],
    /// A material whose numbers become constants.
    pub material: Option<Material>,
    /// How light enters.
    pub configuration: Configuration,
    /// Mean cosine of the phase function, for an inversion and a transmittance; 0 otherwise.
    pub g: f64,
    /// Relative index of refraction, for an inversion, a transmittance and moments of the Fresnel reflectance; 1 otherwise.
    pub eta: f64,
    /// Sizes of tables.
    pub sizes: Sizes,
    /// The command that a text names as its maker.
    pub command: &'a str,
}

/// Relative indices that the Fresnel reflectance is written for.
const ETA: RangeInclusive<f64> = 0.05..=20.0;

/// Models that are closed forms of their parameters; of the others those of a material are sums.
const MODELS: [Model; 3] =
    [Model::NormalizedDiffusion, Model::NormalizedDiffusionRefined, Model::NormalizedDiffusionOblique];

impl Export<'_> {
    /// The bytes of the file.
    ///
    /// # Errors
    /// There is no such combination, or the material is out of its range.
    pub fn bytes(&self) -> Result<Vec<u8>, ExportError> {
        self.check()?;
        let functions = self.functions()?;
        let roots: Vec<&str> = functions.iter().flat_map(Function::called).collect();
        let mut made = self.sums()?;
        if self.subjects.contains(&Subject::Inversion) {
            made += &Inversion::new(self.g, self.eta, self.configuration)?.wgsl();
        }
        let formulas = formulas(&roots, self.configuration, &made) + &self.constants()?;
        match self.target {
            Target::Text(language) => {
                let tables = self.tables(language)?;
                let subjects = self.subjects.iter().map(|subject| subject.name());
                let models = if self.has_model() { self.models } else { &[] };
                let content: Vec<&str> = subjects.chain(models.iter().map(|model| model.name())).collect();
                let definitions = language.translate(&formulas) + &tables;
                let head = self.head(&functions, language, language)?;
                Ok(language.file(&head, &definitions, &content.join("_")).into_bytes())
            }
            Target::MaterialX => {
                let mut definitions = materialx::definitions(&formulas, &functions)?;
                if let Some(material) = self.material.filter(|_| self.subjects.contains(&Subject::Material)) {
                    definitions += &materialx::material(&material, self.configuration)?;
                }
                // Nodes are called as functions in C
                let head = self.head(&functions, Language::Osl, Language::C)?;
                Ok(materialx::document(&head, self.command, &definitions).into_bytes())
            }
            #[cfg(not(target_family = "wasm"))]
            Target::Image(format) if self.subjects == [Subject::Transmittance] => {
                image::encode(&image::Table::of_transmittances(&self.transmittances()?), format)
            }
            #[cfg(not(target_family = "wasm"))]
            Target::Image(format) => {
                image::encode(&image::Table::of_curvatures(&self.curvature_table()?), format)
            }
            #[cfg(target_family = "wasm")]
            target @ Target::Image(_) => {
                Err(ExportError::new("to", target.name(), "a text: WebAssembly makes no images"))
            }
        }
    }

    /// Whether a subject depends on the phase function and the boundary.
    fn has_medium(&self) -> bool {
        self.subjects.iter().any(|subject| matches!(subject, Subject::Inversion | Subject::Transmittance))
    }

    /// Whether a subject depends on the models.
    fn has_model(&self) -> bool {
        self.subjects.iter().any(|subject| subject.has_model())
    }

    /// Refuses what does not go together.
    fn check(&self) -> Result<(), ExportError> {
        for &subject in self.subjects {
            if !subject.goes_to(self.target) {
                let targets = Target::ALL.into_iter().filter(|target| subject.goes_to(*target));
                let allowed: Vec<&str> = targets.map(Target::name).collect();
                let allowed = format!("one of {} for {}", allowed.join(", "), subject.name());
                return Err(ExportError::new("to", self.target.name(), allowed));
            }
            if (subject.is_table() || subject == Subject::Material) && self.material.is_none() {
                let allowed = "a profile, sampler or other function, as there is no material: name one by a preset, or \
                               by its surface albedo and a mean free path";
                return Err(ExportError::new("what", subject.name(), allowed));
            }
            if subject.is_table() && subject != Subject::Transmittance && self.models.len() != 1 {
                let models: Vec<&str> = self.models.iter().map(|model| model.name()).collect();
                let allowed = format!("one, as {} is of one", subject.name());
                return Err(ExportError::new("model", models.join(","), allowed));
            }
        }
        if matches!(self.target, Target::Image(_)) && self.subjects.len() != 1 {
            return Err(ExportError::new("what", "several", "lut or transmittance alone for an image"));
        }
        if let (Some(model), None) = (self.summed().next(), self.material) {
            let allowed = MODELS.map(Model::name).join(", ");
            let allowed = format!("a closed form: {allowed}; with a material any, as a sum");
            return Err(ExportError::new("model", model.name(), allowed));
        }
        for terms in [Terms::Exponentials, Terms::Gaussians] {
            if let Some(model) = self.summed().filter(|model| Terms::of(*model) == terms).nth(1) {
                let allowed = format!("in a text of its own: the sum of another is of {terms:?}, too");
                return Err(ExportError::new("model", model.name(), allowed));
            }
        }
        let has = |subject| self.subjects.contains(&subject);
        let is_needed = has(Subject::Material) || self.summed().next().is_some();
        if self.target == Target::MaterialX && self.material.is_some() && !is_needed {
            return Err(ExportError::new(
                "what",
                "functions",
                "material too, to say a material in MaterialX",
            ));
        }
        let has_medium = self.has_medium();
        if self.g != 0.0 && !has_medium {
            return Err(ExportError::new("g", self.g.to_string(), "0 without inversion or transmittance"));
        }
        // Moments are constants, which MaterialX has none of
        let has_moments = has(Subject::Fresnel) && self.target != Target::MaterialX;
        if self.eta != 1.0 && !has_medium && !has_moments {
            return Err(ExportError::new(
                "eta",
                self.eta.to_string(),
                "1 without inversion, transmittance or moments of fresnel",
            ));
        }
        require(ETA.contains(&self.eta), "eta", self.eta, "in [0.05, 20]")?;
        let Sizes { taps, lut, most_curvature, most_thickness } = self.sizes;
        require(Sizes::TAPS.contains(&taps), "taps", taps as f64, "in [3, 1024]")?;
        for side in lut {
            require(Sizes::LUT.contains(&side), "size", side as f64, "in [2, 1024] each")?;
        }
        if let Some(curvature) = most_curvature {
            require(curvature > 0.0 && curvature <= 1e18, "most_curvature", curvature, "in (0, 1e18]")?;
        }
        if let Some(thickness) = most_thickness {
            require(thickness > 0.0 && thickness <= 1e18, "most_thickness", thickness, "in (0, 1e18]")?;
        }
        Ok(())
    }

    /// The functions that the export has, once each.
    ///
    /// # Errors
    /// A subject does not go with a model.
    pub fn functions(&self) -> Result<Vec<Function>, ExportError> {
        let mut all: Vec<Function> = Vec::new();
        let subjects = self.subjects.iter().copied().filter(|subject| !subject.is_table());
        let subjects: Vec<Subject> = subjects.collect();
        for &model in self.models {
            for &subject in &subjects {
                for function in functions(subject, model) {
                    if !all.contains(&function) {
                        all.push(function);
                    }
                }
            }
        }
        Ok(all)
    }

    /// Models whose profiles are written as sums for a material.
    fn summed(&self) -> impl Iterator<Item = Model> + '_ {
        let is_closed =
            self.subjects.iter().any(|subject| matches!(subject, Subject::Profile | Subject::Sampler));
        self.models.iter().copied().filter(move |model| is_closed && !MODELS.contains(model))
    }

    /// Functions that return the terms of sums, in WGSL.
    fn sums(&self) -> Result<String, ExportError> {
        let mut text = String::new();
        for model in self.summed() {
            let sum = match (model, self.material) {
                (Model::Gaussians, Some(Material { surface_albedo, length, parameterization, .. })) => {
                    let terms = SumOfGaussians::DEFAULT_TERMS;
                    let sum = |c: usize| {
                        let (albedo, length) = (surface_albedo[c], length[c]);
                        SumOfGaussians::new(albedo, length, parameterization, self.configuration, terms)
                    };
                    Sum::of_gaussians([sum(0)?, sum(1)?, sum(2)?])
                }
                _ => Sum::of_fits(model, &self.profiles(model)?)?,
            };
            text += &sum.wgsl();
        }
        Ok(text)
    }

    /// Constants of the material.
    fn constants(&self) -> Result<String, ExportError> {
        let mut text = String::new();
        if self.subjects.contains(&Subject::Fresnel) && self.eta != 1.0 {
            text += &header::moments(self.eta);
        }
        let Some(Material { surface_albedo, length, parameterization, .. }) = self.material else {
            return Ok(text);
        };
        for (channel, (a, l)) in
            ["RED", "GREEN", "BLUE"].into_iter().zip(surface_albedo.into_iter().zip(length))
        {
            require((1e-18..=1e18).contains(&l), "length", l, "in [1e-18, 1e18]")?;
            let d = NormalizedDiffusion::new(a, l, parameterization, self.configuration)?.d();
            let length_name = match parameterization {
                Parameterization::Mfp => "MEAN_FREE_PATH",
                Parameterization::Dmfp => "DIFFUSE_MEAN_FREE_PATH",
            };
            text += &format!("\nconst SURFACE_ALBEDO_{channel}: f32 = {};\n", literal(a));
            text += &format!("const {length_name}_{channel}: f32 = {};\n", literal(l));
            if self.has_model() && self.models.contains(&Model::NormalizedDiffusion) {
                text += &format!("// d = length / s(A)\nconst WIDTH_{channel}: f32 = {};\n", literal(d));
            }
        }
        Ok(text)
    }

    /// Tables of the material.
    fn tables(&self, language: Language) -> Result<String, ExportError> {
        let Sizes { taps, .. } = self.sizes;
        let table = |subject: &Subject| match subject {
            Subject::Disk => Ok(Disk::new(&self.profiles(self.models[0])?, taps).text(language)),
            Subject::Kernel => Ok(Kernel::new(&self.profiles(self.models[0])?, taps | 1).text(language)),
            Subject::Lut => Ok(self.curvature_table()?.text(language)),
            #[cfg(not(target_family = "wasm"))]
            Subject::Transmittance => Ok(self.transmittances()?.text(language)),
            #[cfg(target_family = "wasm")]
            Subject::Transmittance => Err(ExportError::new(
                "what",
                subject.name(),
                "made by the command: WebAssembly solves no slabs",
            )),
            _ => Ok(String::new()),
        };
        self.subjects.iter().map(table).collect::<Result<Vec<_>, ExportError>>().map(|tables| tables.concat())
    }

    fn curvature_table(&self) -> Result<CurvatureTable, ExportError> {
        let Sizes { lut, most_curvature, .. } = self.sizes;
        let longest = self.material.map_or(1.0, |material| material.length.into_iter().fold(0.0, f64::max));
        Ok(CurvatureTable::new(&self.profiles(self.models[0])?, lut, most_curvature.unwrap_or(1.0 / longest)))
    }

    #[cfg(not(target_family = "wasm"))]
    fn transmittances(&self) -> Result<TransmittanceTable, ExportError> {
        let Some(material) = &self.material else {
            return Err(ExportError::new("what", "a table", "of a material"));
        };
        let Sizes { lut: [columns, _], most_thickness, .. } = self.sizes;
        TransmittanceTable::new(material, self.configuration, [self.g, self.eta], columns, most_thickness)
    }

    /// Profiles of red, green, blue.
    fn profiles(&self, model: Model) -> Result<[Box<dyn Profile>; 3], ExportError> {
        let Some(Material { surface_albedo, length, parameterization, .. }) = self.material else {
            return Err(ExportError::new("what", "a table", "of a material"));
        };
        let profile = |c: usize| {
            let appearance =
                Appearance { surface_albedo: surface_albedo[c], length: length[c], parameterization, g: 0.0 };
            let profile = model.profile(&appearance, self.configuration, 1.0)?;
            // Many models take microseconds a quantile
            let is_fast = profile.samples_directly();
            let profile: Box<dyn Profile> =
                if is_fast { profile } else { Box::new(TabulatedProfile::new(&*profile)) };
            Ok::<_, ExportError>(profile)
        };
        Ok([profile(0)?, profile(1)?, profile(2)?])
    }

    /// The comment that a text begins with, with errors of one language and names of another.
    fn head(&self, functions: &[Function], errors: Language, names: Language) -> Result<String, ExportError> {
        let mut paragraphs: Vec<String> = self
            .subjects
            .iter()
            .filter_map(|subject| header::of_subject(*subject))
            .map(String::from)
            .collect();
        if self.has_model() {
            paragraphs.extend(self.models.iter().map(|model| {
                header::of_model(*model, self.configuration, self.summed().any(|summed| summed == *model))
            }));
            paragraphs.push(String::from(header::UNITS));
        }
        if !functions.is_empty() {
            paragraphs.push(header::errors(functions, errors, names));
        }
        if let Some(material) = self.material.filter(|own| own.parameterization == Parameterization::Dmfp) {
            let medium = if self.has_medium() { [self.g, self.eta] } else { [0.0, 1.0] };
            paragraphs.push(header::of_diffuse_lengths(&material, self.configuration, medium)?);
        }
        paragraphs.push(header::origin(self.command));
        Ok(header::comment(&paragraphs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads every formula, which the texts of other languages have too.
    #[test]
    fn every_function_is_a_graph_of_nodes() {
        let material = Material {
            surface_albedo: [0.9, 0.5, 0.1],
            length: [2.0, 0.3, 1e-3],
            parameterization: Parameterization::Mfp,
            surface: None,
        };
        let subjects: Vec<Subject> =
            Subject::ALL.into_iter().filter(|s| s.goes_to(Target::MaterialX)).collect();
        let models = [&MODELS[..], &[Model::Gaussians, Model::Exact]].concat();
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            let export = Export {
                target: Target::MaterialX,
                subjects: &subjects,
                models: &models,
                material: Some(material),
                configuration,
                g: 0.5,
                eta: 1.3,
                sizes: Sizes::default(),
                command: "a test",
            };
            let document = String::from_utf8(export.bytes().unwrap()).unwrap();
            let functions = export.functions().unwrap();
            assert!(functions.len() > 30, "{}", functions.len());
            for function in functions {
                let graph = format!("<nodegraph name=\"NG_translucid_{}\"", function.name);
                assert!(document.contains(&graph), "{}", function.name);
            }
            assert_eq!(document, String::from_utf8(export.bytes().unwrap()).unwrap());
        }
    }
}
