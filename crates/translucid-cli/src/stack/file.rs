//! The file of a stack: that of layers, with values over wavelengths or channels, and the grounds below.

use std::path::Path;

use translucid_laboratory::colorimetry::{WAVELENGTHS, wavelength};
use translucid_load::load_toml;
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_scene::description::{Item, Table};
use translucid_scene::{Interval, SceneError};

use super::spectra::Spectra;
use crate::reference::LayersReader;

/// Layers over grounds, channel by channel: one, red, green and blue, or [`WAVELENGTHS`].
pub(super) struct Stack {
    /// Over the ground that the file states, air if it states none.
    pub(super) below: Vec<Layers>,
    /// Over black and over white, with the reflectances of these grounds; none below an endless layer.
    pub(super) grounds: Option<[(Vec<f64>, Vec<Layers>); 2]>,
    /// Values that hold beyond their tables, in words.
    pub(super) notes: Vec<String>,
}

/// Name of one of several channels.
pub(super) fn channel_name(channel: usize, count: usize) -> String {
    match count {
        1 => String::from("all"),
        3 => String::from(["red", "green", "blue"][channel]),
        _ => wavelength(channel).to_string(),
    }
}

/// Reads a file, and all that it names.
///
/// # Errors
/// A file cannot be read, or a key or value is wrong, at which the error points.
pub(super) fn read(path: &Path) -> Result<Stack, SceneError> {
    let (source, entries) = load_toml(path)?;
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
    let count = spectra.count();
    let mut stack = Stack { below: Vec::new(), grounds: Some(Default::default()), notes: Vec::new() };
    for channel in 0..count {
        let (layers, grounds) = read(channel).map_err(|error| named(error, channel, count))?;
        if layers.ground() == Ground::None {
            stack.grounds = None;
        }
        for ((reflectances, over), reflectance) in
            stack.grounds.iter_mut().flatten().zip(grounds.reflectances)
        {
            reflectances.push(reflectance);
            over.push(put_on(&layers, reflectance, grounds.has_air).map_err(|error| root.error(error))?);
        }
        stack.below.push(layers);
    }
    stack.notes = spectra.notes.into_inner();
    Ok(stack)
}

/// An error of one of several channels.
fn named(error: SceneError, channel: usize, count: usize) -> SceneError {
    let unit = if count == WAVELENGTHS { " nm" } else { "" };
    match count {
        1 => error,
        _ => SceneError {
            message: format!("{}{unit}: {}", channel_name(channel, count), error.message),
            ..error
        },
    }
}

/// The table `grounds`.
struct Grounds {
    /// Of black and white.
    reflectances: [f64; 2],
    /// Whether they lie below a layer of air.
    has_air: bool,
}

fn read_grounds(
    root: &Table<'_>,
    number: &dyn Fn(&Item<'_>, Interval) -> Result<f64, SceneError>,
) -> Result<Grounds, SceneError> {
    let Some(item) = root.get("grounds") else {
        return Ok(Grounds { reflectances: [0.0, 1.0], has_air: false });
    };
    let table = item.table()?.allow(&["black", "white", "contact"])?;
    let reflectance = |key, default| table.read(key, default, |item| number(item, Interval::UNIT));
    Ok(Grounds {
        reflectances: [reflectance("black", 0.0)?, reflectance("white", 1.0)?],
        has_air: table.read("contact", false, |item| item.word_of(&[("optical", false), ("air", true)]))?,
    })
}

/// The layers on another ground, with air between them or not.
fn put_on(layers: &Layers, reflectance: f64, has_air: bool) -> Result<Layers, String> {
    let air = has_air.then(|| Layer::new(0.0, 0.0, 1.0));
    let all = layers.layers().iter().cloned().chain(air).collect();
    Layers::new(layers.eta_above(), all, Ground::Lambertian { reflectance })
        .map_err(|error| error.to_string())
}

/// What the ground of layers reflects without them.
pub(super) fn bare_reflectance(layers: &Layers) -> f64 {
    if let Ground::Lambertian { reflectance } = layers.ground() { reflectance } else { 0.0 }
}

/// Whether light leaves below.
pub(super) fn lets_through(channels: &[Layers]) -> bool {
    channels.iter().all(|layers| matches!(layers.ground(), Ground::Medium { .. }))
}
