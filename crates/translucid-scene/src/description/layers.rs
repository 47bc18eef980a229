//! The layers below a surface: `[[material.layer]]`.

use std::mem::discriminant;

use glam::Vec3;
use translucid_words::{Content, Error, Fallback, Interval, Item, Key, Table, Value, field, one_of};

use super::files::FileList;
use super::parts::Part;
use super::slot::{Field, SceneSlot, Thing};
use super::visit::Visit;
use crate::{LayerMedium, SubsurfaceLayer};

use Fallback::{Number, Required, Words};

const MFP: Interval = Interval::closed(1e-9, 1e9);
const COEFFICIENT: Interval = Interval::closed(0.0, 1e9);

const THICKNESS: Field<SubsurfaceLayer> = field!(
    SubsurfaceLayer { thickness } => SceneSlot::Length(thickness, Interval::above(0.0, 1e9)),
    "length {range}: how far from the last layer, or the surface, the layer reaches", Required);

/// A field of the medium of some layers.
const fn placed(
    keys: &'static [Key],
    slot: fn(&mut SubsurfaceLayer) -> SceneSlot<'_>,
) -> Field<SubsurfaceLayer> {
    Field { keys, slot, when_given: None, when_missing: None }
}

/// Keys of a medium, by kind of layer.
const GROUPS: [&[&str]; 2] = [&["surface_albedo", "mfp"], &["scattering", "absorption"]];

/// Layers by what an endless one looks like, and by their coefficients.
const KINDS: [&Thing<SubsurfaceLayer>; 2] = [&APPEARANCE, &COEFFICIENTS];

#[rustfmt::skip]
const APPEARANCE: Thing<SubsurfaceLayer> = Thing {
    name: "layer",
    doc: "a layer by what an endless one looks like",
    plain: || SubsurfaceLayer {
        thickness: 1.0,
        medium: LayerMedium::Appearance { surface_albedo: Vec3::splat(0.5), mfp: Vec3::ONE },
        g: 0.0,
    },
    fields: &[
        THICKNESS,
        placed(&[Key::new("surface_albedo", "color {range}, with `mfp`: the share of diffuse light that an endless layer of this medium would return without a boundary", Words("must be given, or `scattering`"))],
            |layer| match &mut layer.medium {
                LayerMedium::Appearance { surface_albedo, .. } => SceneSlot::Rgb(surface_albedo, Interval::UNIT),
                LayerMedium::Coefficients { .. } => SceneSlot::Absent,
            }),
        placed(&[Key::new("mfp", "color, a length {range}: mean free path of each channel", Words("–"))],
            |layer| match &mut layer.medium {
                LayerMedium::Appearance { mfp, .. } => SceneSlot::Triple(mfp, MFP),
                LayerMedium::Coefficients { .. } => SceneSlot::Absent,
            }),
        // Those for which a surface albedo is known
        field!(SubsurfaceLayer { g } => SceneSlot::Number(g, Interval::closed(-0.95, 0.95)),
            "number in (-1, 1), beside `surface_albedo` {range}: mean cosine of the phase function", Number(0.0)),
    ],
    rules: &[],
};

#[rustfmt::skip]
const COEFFICIENTS: Thing<SubsurfaceLayer> = Thing {
    name: "layer",
    doc: "a layer by its coefficients",
    plain: || SubsurfaceLayer {
        thickness: 1.0,
        medium: LayerMedium::Coefficients { scattering: Vec3::ONE, absorption: Vec3::ZERO },
        g: 0.0,
    },
    fields: &[
        THICKNESS,
        placed(&[Key::new("scattering", "color {range}, with `absorption`: coefficient σ_s of each channel, per unit of length", Words("–"))],
            |layer| match &mut layer.medium {
                LayerMedium::Coefficients { scattering, .. } => SceneSlot::Triple(scattering, COEFFICIENT),
                LayerMedium::Appearance { .. } => SceneSlot::Absent,
            }),
        placed(&[Key::new("absorption", "color {range}: coefficient σ_a of each channel, per unit of length", Words("–"))],
            |layer| match &mut layer.medium {
                LayerMedium::Coefficients { absorption, .. } => SceneSlot::Triple(absorption, COEFFICIENT),
                LayerMedium::Appearance { .. } => SceneSlot::Absent,
            }),
        field!(SubsurfaceLayer { g } => SceneSlot::Number(g, Interval::open(-1.0, 1.0)), "number {range}", Number(0.0)),
    ],
    rules: &[],
};

impl SubsurfaceLayer {
    /// The fields of layers, those of a medium of each kind among them.
    pub fn fields() -> [&'static Field<Self>; 6] {
        let [[thickness, albedo, mfp, g], [_, scattering, absorption, _]] = KINDS.map(|kind| {
            let [a, b, c, d] = kind.fields else { unreachable!("each kind has four fields") };
            [a, b, c, d]
        });
        [thickness, albedo, mfp, scattering, absorption, g]
    }

    /// A layer with the fields of a key's kind.
    pub fn plain_of(key: &str) -> Self {
        (KINDS[usize::from(GROUPS[1].contains(&key))].plain)()
    }

    fn kind(&self) -> &'static Thing<Self> {
        let is_own =
            |kind: &&&Thing<Self>| discriminant(&(kind.plain)().medium) == discriminant(&self.medium);
        KINDS.iter().find(is_own).expect("every medium has a kind")
    }

    fn read(table: Table<'_>) -> Result<Self, Error> {
        let keys = Self::fields().map(|field| field.key());
        let table = table.allow(&keys)?;
        KINDS[one_of(&table, &GROUPS)?].read(&table, &mut FileList::default())
    }
}

/// Layers from the surface inwards; the word "none" takes away those of a base.
pub(super) fn read_layers(item: &Item<'_>) -> Result<Vec<SubsurfaceLayer>, Error> {
    match item.content() {
        Content::Text(_) if item.is_none() => Ok(Vec::new()),
        Content::List(list) if list.is_empty() => Err(item.refuse("one layer or more, or \"none\"")),
        Content::List(_) => {
            item.tables(SubsurfaceLayer::MOST)?.into_iter().map(SubsurfaceLayer::read).collect()
        }
        _ => Err(item.mismatch("an array of tables, each with the header [[material.layer]]")),
    }
}

/// The value that [`read_layers`] reads.
pub(super) fn write_layers(layers: &[SubsurfaceLayer]) -> Value {
    if layers.is_empty() {
        return "none".into();
    }
    layers.iter().map(|layer| layer.kind().write(layer).into()).collect::<Vec<Value>>().into()
}

/// Visits every number of layers.
pub(super) fn visit_layers(key: &str, layers: &mut [SubsurfaceLayer], visit: &mut dyn FnMut(&str, Part<'_>)) {
    for (number, layer) in layers.iter_mut().enumerate() {
        layer.kind().visit(layer, &mut |name, part| visit(&format!("{key}[{number}].{name}"), part));
    }
}
