//! The file of a stack: that of layers, with values over wavelengths or channels, and the grounds below.

use std::path::{Path, PathBuf};

use translucid_laboratory::stack::Filament;
use translucid_load::load_toml;
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_scene::description::{Content, Entry, Item, Provenance, Table, Value};
use translucid_scene::{Interval, SceneError};

use super::spectra::Spectra;
use crate::reference::LayersReader;

/// Layers over a ground, channel by channel: one, red, green and blue, or those of a spectrum.
pub(super) struct Stack {
    /// `black`, `white` or, of the file's own, `below`.
    pub(super) ground: &'static str,
    /// Reflectances of the ground without layers.
    pub(super) bare: Vec<f64>,
    pub(super) layers: Vec<Layers>,
}

/// A file that has been read.
pub(super) struct StackFile {
    /// Over black, over white and over the file's own ground; over that alone if the last layer is endless.
    pub(super) stacks: Vec<Stack>,
    /// Values that hold beyond their tables, in words.
    pub(super) notes: Vec<String>,
    /// Files of tables.
    pub(super) files: Vec<PathBuf>,
    /// Whether a layer is a filament.
    pub(super) has_filaments: bool,
}

/// Reads a file, and all that it names; transmission distances mean what it says, or the part of the light that is given.
///
/// # Errors
/// A file cannot be read, or a key or value is wrong, at which the error points.
pub(super) fn read(path: &Path, transmitted: Option<f64>) -> Result<StackFile, SceneError> {
    let (source, mut entries) = load_toml(path)?;
    let source = source.of("a file of layers");
    let has_filaments = replace_filaments(&source, &mut entries, transmitted)?;
    let [above, layer, below] = LayersReader::KEYS;
    let root = Table::root(&source, &entries).allow(&[above, layer, below, "grounds"])?;
    let spectra = Spectra::default();
    let number = |item: &Item<'_>, range: Interval| spectra.number(item, range);
    let reader = LayersReader::new(&number);
    let read = |channel: usize| {
        spectra.channel.set(channel);
        Ok::<_, SceneError>((reader.read(&root)?, read_grounds(&root, &number)?))
    };
    // The first channel's values tell how many there are
    read(0)?;
    let mut stacks =
        ["black", "white", "below"].map(|ground| Stack { ground, bare: Vec::new(), layers: Vec::new() });
    for channel in 0..spectra.count() {
        let (layers, (reflectances, has_air)) = read(channel)?;
        if let (Ground::None, Some(item)) = (layers.ground(), root.get("grounds")) {
            return Err(
                item.error("grounds lie below a layer with a thickness, but the last layer is endless")
            );
        }
        for (stack, reflectance) in stacks.iter_mut().zip(reflectances) {
            if layers.ground() != Ground::None {
                let over = put_on(&layers, reflectance, has_air).map_err(|error| root.error(error))?;
                stack.layers.push(over);
            }
            stack.bare.push(reflectance);
        }
        let own = if let Ground::Lambertian { reflectance } = layers.ground() { reflectance } else { 0.0 };
        stacks[2].bare.push(own);
        stacks[2].layers.push(layers);
    }
    let stacks = stacks.into_iter().filter(|stack| !stack.layers.is_empty()).collect();
    Ok(StackFile { stacks, notes: spectra.notes.take(), files: spectra.files.take(), has_filaments })
}

/// Puts coefficients in the place of each layer's key `filament`, and says whether there was one.
fn replace_filaments(
    source: &Provenance,
    entries: &mut [Entry],
    transmitted: Option<f64>,
) -> Result<bool, SceneError> {
    let mut coefficients = Vec::new();
    let root = Table::root(source, entries);
    for (i, layer) in root.tables("layer", Layers::MOST).unwrap_or_default().into_iter().enumerate() {
        let Some(item) = layer.get("filament") else { continue };
        for key in ["scattering", "absorption", "surface_albedo", "mfp", "g", "moments", "phase_function"] {
            if let Some(other) = layer.get(key) {
                let message = format!("{} is given beside {}, which states it", other.path(), item.path());
                return Err(other.error(message));
            }
        }
        let eta = layer.read("eta", 1.0, |eta| eta.double(LayersReader::ETA))?;
        coefficients.push((i, read_filament(&item, eta, transmitted)?));
    }
    let has_filaments = !coefficients.is_empty();
    let list = entries.iter_mut().find(|entry| entry.key == "layer").map(|entry| &mut entry.value.content);
    let Some(Content::List(layers)) = list else { return Ok(false) };
    for (i, values) in coefficients {
        let Content::Table(keys) = &mut layers[i].content else { continue };
        let Some(place) = keys.iter().position(|entry| entry.key == "filament") else { continue };
        let span = keys.remove(place).span;
        for (key, values) in ["scattering", "absorption"].into_iter().zip(values) {
            let value = Value { span: span.clone(), ..Value::list(&values) };
            keys.push(Entry { key: key.to_owned(), span: span.clone(), value });
        }
    }
    Ok(has_filaments)
}

/// Scattering and absorption coefficients of a filament.
fn read_filament(item: &Item<'_>, eta: f64, transmitted: Option<f64>) -> Result<[[f64; 3]; 2], SceneError> {
    let table = item.table()?.allow(&["color", "transmission_distance", "transmitted"])?;
    let own = table
        .require("transmitted")
        .map_err(|error| {
            error.with_help(
                "it is the part of the light that passes a sheet of the transmission distance, on which sources disagree: 0.37 \
                 (1/e), 0.1, 0.05, or next to nothing, 0.01",
            )
        })?
        .double(Interval::open(0.0, 1.0))?;
    let filament = Filament {
        color: table.require("color")?.rgb(Interval::UNIT)?.map(f64::from),
        transmission_distance: table.require("transmission_distance")?.double(LayersReader::LENGTH)?,
        transmitted: transmitted.unwrap_or(own),
        eta,
    };
    filament.coefficients().map_err(|error| item.error(format!("{}: {error}", item.path())))
}

/// The table `grounds`: reflectances of black and white, and whether they lie below a layer of air.
fn read_grounds(
    root: &Table<'_>,
    number: &dyn Fn(&Item<'_>, Interval) -> Result<f64, SceneError>,
) -> Result<([f64; 2], bool), SceneError> {
    let Some(item) = root.get("grounds") else {
        return Ok(([0.0, 1.0], false));
    };
    let table = item.table()?.allow(&["black", "white", "contact"])?;
    let reflectance = |key, default| table.read(key, default, |item| number(item, Interval::UNIT));
    let has_air = table.read("contact", false, |item| item.word_of(&[("optical", false), ("air", true)]))?;
    Ok(([reflectance("black", 0.0)?, reflectance("white", 1.0)?], has_air))
}

/// The layers on another ground, with air between them or not.
fn put_on(layers: &Layers, reflectance: f64, has_air: bool) -> Result<Layers, String> {
    let air = has_air.then(|| Layer::new(0.0, 0.0, 1.0));
    let all = layers.layers().iter().cloned().chain(air).collect();
    Layers::new(layers.eta_above(), all, Ground::Lambertian { reflectance })
        .map_err(|error| error.to_string())
}
