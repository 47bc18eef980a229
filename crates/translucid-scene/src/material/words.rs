//! The parameters of a material that are words: the one list for loaders, writers and those who show them.

use translucid_profile::{Configuration, Parameterization};

use super::{CameraVisibility, Material, SubsurfaceModel, SubsurfaceNormalization, SubsurfaceTextureAt};

const PARAMETERIZATIONS: [(&str, Parameterization); 2] =
    [("mfp", Parameterization::Mfp), ("dmfp", Parameterization::Dmfp)];
const CONFIGURATIONS: [(&str, Configuration); 2] =
    [("searchlight", Configuration::Searchlight), ("diffuse", Configuration::Diffuse)];
const TEXTURE_AT: [(&str, SubsurfaceTextureAt); 3] = [
    ("exit", SubsurfaceTextureAt::Exit),
    ("entry", SubsurfaceTextureAt::Entry),
    ("both", SubsurfaceTextureAt::Both),
];
const NORMALIZATIONS: [(&str, SubsurfaceNormalization); 2] =
    [("none", SubsurfaceNormalization::None), ("energy", SubsurfaceNormalization::Energy)];
const CAMERA_VISIBILITIES: [(&str, CameraVisibility); 3] = [
    ("surface", CameraVisibility::Surface),
    ("shadow", CameraVisibility::Shadow),
    ("none", CameraVisibility::None),
];

/// A parameter of a material whose value is a word.
pub struct WordParameter {
    /// The field's name, which is the key in scene files, too.
    pub name: &'static str,
    words: fn() -> Vec<&'static str>,
    word: fn(&Material) -> &'static str,
    set: fn(&mut Material, &str) -> bool,
}

impl WordParameter {
    /// Every value that it may have.
    pub fn words(&self) -> Vec<&'static str> {
        (self.words)()
    }

    /// Its value in a material.
    pub fn word(&self, material: &Material) -> &'static str {
        (self.word)(material)
    }

    /// Gives it a value; false if that is none of its [`words`](Self::words).
    pub fn set(&self, material: &mut Material, word: &str) -> bool {
        (self.set)(material, word)
    }
}

macro_rules! word {
    ($name:ident of $words:ident) => {
        WordParameter {
            name: stringify!($name),
            words: || $words.iter().map(|(word, _)| *word).collect(),
            word: |material| {
                let found = $words.iter().find(|(_, meaning)| *meaning == material.$name);
                found.map_or("", |(word, _)| word)
            },
            set: |material, word| {
                let found = $words.iter().find(|(known, _)| *known == word);
                found.map(|(_, meaning)| material.$name = *meaning).is_some()
            },
        }
    };
}

/// Every parameter whose value is a word, but for the model, which may be a table.
pub const WORD_PARAMETERS: &[WordParameter] = &[
    word!(subsurface_parameter of PARAMETERIZATIONS),
    word!(subsurface_configuration of CONFIGURATIONS),
    word!(subsurface_texture_at of TEXTURE_AT),
    word!(subsurface_normalization of NORMALIZATIONS),
    word!(camera_visibility of CAMERA_VISIBILITIES),
];

/// A parameter of a material with its value, for those who show or list them all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WordValue {
    /// Its name, which is the key in scene files, too.
    pub name: &'static str,
    /// Its value.
    pub word: &'static str,
    /// Every value that it may have.
    pub words: Vec<&'static str>,
}

impl Material {
    /// Every parameter whose value is a word, in the order of the fields.
    pub fn words(&self) -> Vec<WordValue> {
        let mut values = vec![WordValue {
            name: "subsurface_model",
            word: self.subsurface_model.name(),
            words: SubsurfaceModel::ALL.iter().map(|model| model.name()).collect(),
        }];
        values.extend(WORD_PARAMETERS.iter().map(|parameter| WordValue {
            name: parameter.name,
            word: parameter.word(self),
            words: parameter.words(),
        }));
        values
    }
}
