//! The file of a stack: that of layers, with values over wavelengths or channels, and the grounds below.

use std::path::{Path, PathBuf};

use translucid_load::load_toml;
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_scene::description::{Item, Table};
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
}

/// Reads a file, and all that it names.
///
/// # Errors
/// A file cannot be read, or a key or value is wrong, at which the error points.
pub(super) fn read(path: &Path) -> Result<StackFile, SceneError> {
    let (source, entries) = load_toml(path)?;
    let source = source.of("a file of layers");
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
    Ok(StackFile { stacks, notes: spectra.notes.take(), files: spectra.files.take() })
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
