//! What can be exported to where, and how a text is put together.

use translucid_profile::{Configuration, Model, NormalizedDiffusion, Parameterization, require};

use crate::error::ExportError;
use crate::formula::formulas;
use crate::function::{Function, functions};
use crate::header;
use crate::language::Language;
use crate::number::literal;
use crate::spirv;

/// Where a text goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A text in a language.
    Text(Language),
    /// A compiled module for Vulkan.
    Spirv,
}

impl Target {
    /// Every target.
    pub const ALL: [Self; 8] = [
        Self::Text(Language::Wgsl),
        Self::Text(Language::Glsl),
        Self::Text(Language::Hlsl),
        Self::Text(Language::Msl),
        Self::Spirv,
        Self::Text(Language::Osl),
        Self::Text(Language::C),
        Self::Text(Language::Cpp),
    ];

    /// Name as the command line writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text(Language::Wgsl) => "wgsl",
            Self::Text(Language::Glsl) => "glsl",
            Self::Text(Language::Hlsl) => "hlsl",
            Self::Text(Language::Msl) => "msl",
            Self::Text(Language::Osl) => "osl",
            Self::Text(Language::C) => "c",
            Self::Text(Language::Cpp) => "cpp",
            Self::Spirv => "spirv",
        }
    }

    /// One line about it.
    pub fn description(self) -> &'static str {
        match self {
            Self::Text(Language::Wgsl) => "WebGPU's shading language",
            Self::Text(Language::Glsl) => "OpenGL's and Vulkan's, from 3.30 or ES 3.00 on",
            Self::Text(Language::Hlsl) => "DirectX's",
            Self::Text(Language::Msl) => "Metal's",
            Self::Text(Language::Osl) => "Open Shading Language",
            Self::Text(Language::C) => "A header for C99",
            Self::Text(Language::Cpp) => "A header for C++17",
            Self::Spirv => "A module that computes functions for buffers of arguments",
        }
    }
}

/// What a text is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Evaluation, densities, distribution and quantile of a profile.
    Profile,
    /// Random radii and their densities.
    Sampler,
}

impl Subject {
    /// Every subject.
    pub const ALL: [Self; 2] = [Self::Profile, Self::Sampler];

    /// Name as the command line writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Profile => "profile",
            Self::Sampler => "sampler",
        }
    }

    /// One line about it.
    pub fn description(self) -> &'static str {
        match self {
            Self::Profile => "Evaluation, densities, distribution and quantile of a profile",
            Self::Sampler => "Random radii and their densities",
        }
    }
}

/// Parameters of a material for red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Surface albedos A, in [0, 1].
    pub surface_albedo: [f64; 3],
    /// Mean free paths or diffuse ones [L].
    pub length: [f64; 3],
    /// Which of the two they are.
    pub parameterization: Parameterization,
}

/// What is to be exported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Export<'a> {
    /// Where it goes.
    pub target: Target,
    /// What it is about: one text has it all.
    pub subjects: &'a [Subject],
    /// Models of the profile.
    pub models: &'a [Model],
    /// A material whose numbers become constants.
    pub material: Option<Material>,
    /// How light enters.
    pub configuration: Configuration,
    /// The command that a text says it was made by.
    pub command: &'a str,
}

/// Models that are closed forms.
const MODELS: [Model; 3] =
    [Model::NormalizedDiffusion, Model::NormalizedDiffusionRefined, Model::NormalizedDiffusionOblique];

impl Export<'_> {
    /// The bytes of the file.
    ///
    /// # Errors
    /// There is no such combination, or the material is out of its range.
    pub fn bytes(&self) -> Result<Vec<u8>, ExportError> {
        let functions = self.functions()?;
        let roots: Vec<&str> = functions.iter().flat_map(Function::called).collect();
        let formulas = formulas(&roots, self.configuration) + &self.constants()?;
        match self.target {
            Target::Spirv => spirv::compile(&(formulas + &spirv::entry_points(&functions))),
            Target::Text(language) => Ok(self.text(language, &functions, &formulas).into_bytes()),
        }
    }

    /// The functions that the export has, once each.
    ///
    /// # Errors
    /// A subject does not go with a model.
    pub fn functions(&self) -> Result<Vec<Function>, ExportError> {
        let mut all: Vec<Function> = Vec::new();
        for &model in self.models {
            if !MODELS.contains(&model) {
                let allowed = MODELS.map(Model::name).join(", ");
                let allowed = format!("a closed form: {allowed}");
                return Err(ExportError::new("model", model.name(), allowed));
            }
            for &subject in self.subjects {
                for function in functions(subject, model) {
                    if !all.contains(&function) {
                        all.push(function);
                    }
                }
            }
        }
        Ok(all)
    }

    /// Constants of the material.
    fn constants(&self) -> Result<String, ExportError> {
        let Some(Material { surface_albedo, length, parameterization }) = self.material else {
            return Ok(String::new());
        };
        let mut text = String::new();
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
            if self.models.contains(&Model::NormalizedDiffusion) {
                text += &format!("// d = length / s(A)\nconst WIDTH_{channel}: f32 = {};\n", literal(d));
            }
        }
        Ok(text)
    }

    fn text(&self, language: Language, functions: &[Function], formulas: &str) -> String {
        let mut paragraphs: Vec<String> =
            self.models.iter().map(|model| header::of_model(*model, self.configuration)).collect();
        paragraphs.push(String::from(header::UNITS));
        paragraphs.push(header::errors(functions, |name| language.function_name(name)));
        paragraphs.push(header::origin(self.command));
        let subjects = self.subjects.iter().map(|subject| subject.name());
        let content: Vec<&str> = subjects.chain(self.models.iter().map(|model| model.name())).collect();
        language.file(&header::comment(&paragraphs), &language.translate(formulas), &content.join("_"))
    }
}
