//! The keys of a scene file that extends a mesh: what is made of the mesh before the file changes anything.

use translucid_profile::convention::preset;
use translucid_scene::description::{Entry, Item, Table, Value};
use translucid_scene::{Interval, SceneError, Unit};

use crate::result::Result;
use crate::{Floor, LoadOptions, UpAxis, Viewpoint};

/// Wishes for a mesh that becomes a scene, as options and as keys of a scene file that extends it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshBase {
    /// Preset in place of the file's own materials.
    pub preset: Option<String>,
    /// Unit of the coordinates.
    pub unit: Option<Unit>,
    /// The axis that points up.
    pub up: Option<UpAxis>,
    /// Angles about x, then y, then z by which the objects are turned once y is up \[degrees\].
    pub rotate: [f32; 3],
    /// Floor below.
    pub floor: Option<Floor>,
    /// Direction that camera, lights and floor are made for.
    pub viewpoint: Option<Viewpoint>,
}

/// Keys that a base other than a mesh does not have, and where the things have them.
const OF_MESHES: [(&str, &str); 5] = [
    ("preset", "use the key preset in a [[material]]"),
    ("up", "use the key rotate of an [[object]] there"),
    ("rotate", "use the key rotate of an [[object]] there"),
    ("floor", "use an [[object]] with shape = \"plane\""),
    ("view", "use the table [camera]"),
];

impl MeshBase {
    /// Range of the angles by which a mesh is turned \[degrees\].
    pub const ANGLES: Interval = Interval::closed(-36_000.0, 36_000.0);

    /// Reads the keys; all but `unit` are for a mesh.
    pub(super) fn read(root: &Table<'_>, is_mesh: bool) -> Result<Self> {
        if !is_mesh
            && let Some((item, help)) = OF_MESHES.iter().find_map(|&(key, help)| Some((root.get(key)?, help)))
        {
            let message = format!("{} is for a mesh, but extends names a scene", item.path());
            return Err(item.error(message).with_help(help));
        }
        Ok(Self {
            preset: root.get("preset").map(|item| read_preset_name(&item)).transpose()?,
            unit: root.get("unit").map(|item| item.word()).transpose()?,
            up: root.get("up").map(|item| item.word_of(&UpAxis::WORDS)).transpose()?,
            rotate: root
                .get("rotate")
                .map(|item| item.numbers(Self::ANGLES))
                .transpose()?
                .unwrap_or_default(),
            floor: root.get("floor").map(|item| read_floor(&item)).transpose()?,
            viewpoint: root.get("view").map(|item| read_viewpoint(&item)).transpose()?,
        })
    }

    /// The keys that are not as they are by default.
    pub(super) fn write(&self) -> Vec<Entry> {
        let mut entries = Vec::new();
        let mut add =
            |key: &str, value: Option<Value>| entries.extend(value.map(|value| Entry::new(key, value)));
        add("preset", self.preset.as_deref().map(Value::from));
        add("unit", self.unit.map(|unit| unit.name().into()));
        add("up", self.up.map(|axis| axis.name().into()));
        add("rotate", (self.rotate != [0.0; 3]).then(|| self.rotate.into()));
        add(
            "floor",
            self.floor.map(|floor| match floor {
                Floor::None => "none".into(),
                Floor::Backdrop => "backdrop".into(),
                Floor::Shadow => "shadow".into(),
                Floor::Color(color) => Value::color(color),
            }),
        );
        add("view", self.viewpoint.map(|viewpoint| viewpoint.to_string().into()));
        entries
    }

    /// The loader's options with these in place of its own.
    pub fn apply(&self, options: LoadOptions) -> LoadOptions {
        let Self { preset, unit, up, rotate, floor, viewpoint } = self.clone();
        LoadOptions { preset, unit, up, rotate, floor, viewpoint, ..options }
    }
}

fn read_preset_name(item: &Item<'_>) -> Result<String> {
    let name = item.text()?;
    preset(name).map_err(|error| SceneError { place: Some(item.place()), ..error.into() })?;
    Ok(name.to_owned())
}

fn read_floor(item: &Item<'_>) -> Result<Floor> {
    match item.as_text().map(Floor::from_text) {
        Some(floor) => floor.ok_or_else(|| {
            item.refuse("\"none\", \"backdrop\", \"shadow\", \"#rrggbb\", or one or three numbers in [0, 1]")
        }),
        None => Ok(Floor::Color(item.rgb(Interval::closed(0.0, 1.0))?)),
    }
}

fn read_viewpoint(item: &Item<'_>) -> Result<Viewpoint> {
    let names = || Viewpoint::WORDS.map(|(name, _)| format!("\"{name}\"")).join(", ");
    Viewpoint::from_text(item.text()?).ok_or_else(|| {
        item.refuse(&format!(
            "one of {}, or \"AZIMUTH,ELEVATION\" in degrees, the latter in [-90, 90]",
            names()
        ))
    })
}
