//! Plane layers in a TOML file.

use std::cell::RefCell;
use std::path::Path;

use translucid_load::load_toml;
use translucid_profile::{AlbedoInversion, Configuration, Parameterization};
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_reference::walk::PhaseFunction;
use translucid_scene::description::{Content, Item, Table};
use translucid_scene::{Interval, SceneError};

use super::phase_file::{is_phase_file, read_phase_file};

const COEFFICIENT: Interval = Interval::closed(0.0, 1e30);
const COSINE: Interval = Interval::open(-1.0, 1.0);
const ANY: Interval = Interval::closed(-f64::MAX, f64::MAX);
/// Most moments of a phase function.
const MOST_MOMENTS: usize = 10_000;

/// Reads layers from a file.
///
/// # Errors
/// The file cannot be read, or a key or value is wrong, at which the error points.
pub(super) fn read_layers(path: &Path) -> Result<Layers, SceneError> {
    let (source, entries) = load_toml(path)?;
    let source = source.of("a file of layers");
    let number = |item: &Item<'_>, range: Interval| {
        item.double(range).map_err(|error| match item.content() {
            Content::Integer(_) | Content::Float(_) => error,
            _ => error.with_help("translucid stack reads layers with values over wavelengths or channels"),
        })
    };
    LayersReader::new(&number).read(&Table::root(&source, &entries).allow(&LayersReader::KEYS)?)
}

/// Reads one number of a layer or a ground.
type ReadNumber<'a> = dyn Fn(&Item<'_>, Interval) -> Result<f64, SceneError> + 'a;

/// A reader of layers, whose numbers the caller reads.
pub(crate) struct LayersReader<'a> {
    number: &'a ReadNumber<'a>,
    /// Inversions that were made, which takes some 0.1 s each.
    inversions: RefCell<Vec<AlbedoInversion>>,
}

impl<'a> LayersReader<'a> {
    /// Keys of a file that [`read`](Self::read) reads.
    pub(crate) const KEYS: [&'static str; 3] = ["above", "layer", "below"];
    pub(crate) const ETA: Interval = Interval::closed(0.1, 10.0);
    pub(crate) const LENGTH: Interval = Interval::closed(1e-30, 1e30);

    pub(crate) fn new(number: &'a ReadNumber<'a>) -> Self {
        Self { number, inversions: RefCell::default() }
    }

    /// Reads layers from a file's table.
    ///
    /// # Errors
    /// A key or value is wrong.
    pub(crate) fn read(&self, root: &Table<'_>) -> Result<Layers, SceneError> {
        let above = match root.get("above") {
            Some(item) => {
                item.table()?.allow(&["eta"])?.read("eta", 1.0, |eta| (self.number)(eta, Self::ETA))?
            }
            None => 1.0,
        };
        let tables = root.tables("layer", Layers::MOST)?;
        let layers =
            tables.into_iter().map(|table| self.layer(table)).collect::<Result<Vec<Layer>, SceneError>>()?;
        let is_endless = layers.last().is_some_and(|layer| layer.thickness.is_infinite());
        let ground = match root.get("below") {
            Some(item) => self.ground(&item)?,
            None if is_endless => Ground::None,
            None => Ground::AIR,
        };
        Layers::new(above, layers, ground).map_err(|error| {
            let message = error.error.to_string();
            match error
                .layer
                .and_then(|layer| root.tables("layer", Layers::MOST).ok()?.into_iter().nth(layer))
            {
                Some(table) => table.error(format!("{}: {message}", table.path())),
                None => root.error(message),
            }
        })
    }

    fn layer(&self, table: Table<'_>) -> Result<Layer, SceneError> {
        let table = table.allow(&[
            "thickness",
            "scattering",
            "absorption",
            "surface_albedo",
            "mfp",
            "g",
            "moments",
            "phase_function",
            "eta",
        ])?;
        let thickness = table.read("thickness", f64::INFINITY, |item| match item.content() {
            Content::Float(f64::INFINITY) => Ok(f64::INFINITY),
            _ => item.double(Self::LENGTH),
        })?;
        let g = table.read("g", 0.0, |item| (self.number)(item, COSINE))?;
        let layer = match (table.get("surface_albedo"), table.get("scattering")) {
            (Some(albedo), None) => self.of_albedo(&table, &albedo, g, thickness)?,
            (None, Some(scattering)) => {
                if let Some(mfp) = table.get("mfp") {
                    return Err(
                        mfp.error(format!("{} belongs to surface_albedo, not to scattering", mfp.path()))
                    );
                }
                let absorption = (self.number)(&table.require("absorption")?, COEFFICIENT)?;
                Layer::new((self.number)(&scattering, COEFFICIENT)?, absorption, thickness).with_g(g)
            }
            (Some(albedo), Some(_)) => {
                let path = albedo.path();
                return Err(
                    albedo.error(format!("{path} is given beside scattering, but one of them is enough"))
                );
            }
            (None, None) => {
                let path = table.path();
                return Err(
                    table.error(format!("{path} needs scattering and absorption, or surface_albedo and mfp"))
                );
            }
        };
        let layer = layer.with_eta(table.read("eta", 1.0, |item| (self.number)(item, Self::ETA))?);
        let (moments, named) = (table.get("moments"), table.get("phase_function"));
        let Some(item) = moments.as_ref().or(named.as_ref()) else { return Ok(layer) };
        let path = item.path();
        let both = moments.is_some() && named.is_some();
        if both || table.get("g").is_some() {
            let other = if both { "phase_function" } else { "g" };
            return Err(item.error(format!("{path} is given beside {other}, but one of them is enough")));
        }
        if table.get("surface_albedo").is_some() {
            let message = format!(
                "{path} is given beside surface_albedo, which is known for Henyey and Greenstein's alone"
            );
            return Err(item.error(message).with_help("give scattering and absorption"));
        }
        Ok(layer.with_phase_function(match &named {
            Some(named) => read_phase_function(named)?,
            None => PhaseFunction::Moments(read_moments(item)?.into()),
        }))
    }

    /// The medium whose half space without a boundary has the surface albedo under diffuse light.
    fn of_albedo(
        &self,
        table: &Table<'_>,
        albedo: &Item<'_>,
        g: f64,
        thickness: f64,
    ) -> Result<Layer, SceneError> {
        if let Some(absorption) = table.get("absorption") {
            let path = absorption.path();
            return Err(absorption.error(format!("{path} belongs to scattering, not to surface_albedo")));
        }
        let refused = |error: translucid_profile::ParameterError| table.error(error.to_string());
        let albedo = (self.number)(albedo, Interval::above(0.0, 1.0))?;
        let mfp = (self.number)(&table.require("mfp")?, Self::LENGTH)?;
        let mut inversions = self.inversions.borrow_mut();
        let known = inversions.iter().position(|inversion| inversion.g() == g);
        let index = match known {
            Some(index) => index,
            None => {
                inversions.push(AlbedoInversion::new(g, 1.0, Configuration::Diffuse).map_err(refused)?);
                inversions.len() - 1
            }
        };
        Layer::from_surface_albedo(&inversions[index], albedo, mfp, Parameterization::Mfp, thickness)
            .map_err(refused)
    }

    fn ground(&self, item: &Item<'_>) -> Result<Ground, SceneError> {
        let table = item.table()?.allow(&["eta", "reflectance"])?;
        match (table.get("eta"), table.get("reflectance")) {
            (Some(eta), None) => Ok(Ground::Medium { eta: (self.number)(&eta, Self::ETA)? }),
            (None, Some(reflectance)) => {
                Ok(Ground::Lambertian { reflectance: (self.number)(&reflectance, Interval::UNIT)? })
            }
            _ => Err(table
                .error("below needs one of the keys eta, of a clear medium, and reflectance, of a ground")),
        }
    }
}

/// A phase function by its words, or a table in a file.
fn read_phase_function(item: &Item<'_>) -> Result<PhaseFunction, SceneError> {
    let text = item.text()?;
    if is_phase_file(text) {
        return read_phase_file(&item.file()?);
    }
    let found = PhaseFunction::parse(text, 0.0)
        .map_err(|problem| item.error(format!("{}: {problem}", item.path())))?;
    found.ok_or_else(|| item.refuse(&format!("one of {}, or a FILE.csv", PhaseFunction::WORDS.join(", "))))
}

fn read_moments(item: &Item<'_>) -> Result<Vec<f64>, SceneError> {
    item.list("numbers", MOST_MOMENTS)?.iter().map(|moment| moment.double(ANY)).collect()
}
