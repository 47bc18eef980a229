//! *layers*: the light that plane layers reflect, transmit and absorb, and the file in which layers are stated.

use std::cell::RefCell;
use std::collections::HashMap;
#[cfg(not(target_family = "wasm"))]
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use translucid_laboratory::stack::Filament;
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, Parameterization};
#[cfg(not(target_family = "wasm"))]
use translucid_reference::Estimate;
use translucid_reference::Incidence;
#[cfg(not(target_family = "wasm"))]
use translucid_reference::layers::LayersProfile;
use translucid_reference::layers::{Ground, Layer, Layers, Totals};
#[cfg(not(target_family = "wasm"))]
use translucid_reference::walk::Control as WalkControl;
use translucid_words::{
    Cell, Column, Context, DataTable, Entry, Error, Fallback, Interval, Item, Parse, Placed, Provenance,
    Questions, Rule, Table, Thing, Value, Varied, document, exact, field, number, numbers, optional,
    optional_word, parsed, table, things, varied, word,
};

use crate::answer::{About, Answer, Control, Form, Question, Unanswered, context};
use crate::phase_function::GivenPhaseFunction;

use Fallback::{Plain, Required, Words};

const COEFFICIENT: Interval = Interval::closed(0.0, 1e30);
const LENGTH: Interval = Interval::closed(1e-30, 1e30);
const ETA: Interval = Interval::closed(0.1, 10.0);

/// A layer as it is stated.
#[derive(Clone, Debug, Default)]
pub(crate) struct LayerKeys {
    thickness: Option<Varied>,
    scattering: Option<Varied>,
    absorption: Option<Varied>,
    surface_albedo: Option<Varied>,
    mfp: Option<Varied>,
    filament: Option<FilamentKeys>,
    g: Option<Varied>,
    moments: Vec<f64>,
    phase_function: Option<GivenPhaseFunction>,
    eta: Option<Varied>,
}

const OF_HENYEY_AND_GREENSTEIN: &str = "surface_albedo is known for Henyey and Greenstein's phase function alone: give scattering and absorption";

#[rustfmt::skip]
const LAYER: Thing<LayerKeys, Questions> = Thing {
    name: "a layer",
    doc: "A plane layer of one medium",
    plain: LayerKeys::default,
    fields: &[
        field!(LayerKeys { thickness } => varied(thickness, Interval::closed(1e-30, f64::INFINITY)),
            "thickness [L], {range}; the last layer may go without it, and is endless then", Words("inf")),
        field!(LayerKeys { scattering } => varied(scattering, COEFFICIENT),
            "scattering coefficient [1/L], {range}, with `absorption`", Words("none")),
        field!(LayerKeys { absorption } => varied(absorption, COEFFICIENT),
            "absorption coefficient [1/L], {range}, with `scattering`", Words("none")),
        field!(LayerKeys { surface_albedo } => varied(surface_albedo, Interval::above(0.0, 1.0)),
            "share of diffuse light that an endless layer of this medium would return without a boundary, {range}, with `mfp`", Words("none")),
        field!(LayerKeys { mfp } => varied(mfp, LENGTH),
            "mean free path [L], {range}, with `surface_albedo`", Words("none")),
        field!(LayerKeys { filament } => table(filament, &FILAMENT),
            "a printer's filament, in place of coefficients", Words("none")),
        field!(LayerKeys { g } => varied(g, Interval::open(-1.0, 1.0)),
            "mean cosine of Henyey and Greenstein's phase function, {range}", Words("0")),
        field!(LayerKeys { moments } => numbers(moments, Interval::closed(-f64::MAX, f64::MAX), [1, 10_000]),
            "Legendre moments 1, 2, ... of another phase function", Words("none")),
        field!(LayerKeys { phase_function } => parsed(phase_function),
            "another phase function: henyey-greenstein, rayleigh, two-term:W,G1,G2, moments:X1,X2,..., or a FILE.csv", Words("none")),
        field!(LayerKeys { eta } => varied(eta, ETA),
            "index of refraction, {range}", Words("1")),
    ],
    rules: &[
        Rule::OneOf(&[&["scattering", "absorption"], &["surface_albedo", "mfp"], &["filament"]]),
        Rule::NotWith(&["g", "moments", "phase_function", "filament"], "each states a phase function"),
        Rule::NotWith(&["surface_albedo", "moments"], OF_HENYEY_AND_GREENSTEIN),
        Rule::NotWith(&["surface_albedo", "phase_function"], OF_HENYEY_AND_GREENSTEIN),
    ],
};

/// A filament by its color and transmission distance.
#[derive(Clone, Debug, Default)]
struct FilamentKeys {
    color: Option<Color>,
    transmission_distance: f64,
    transmitted: f64,
}

/// A color in linear Rec. 709.
#[derive(Clone, Debug)]
struct Color([f64; 3]);

impl Parse for Color {
    const FORM: &'static str = "three numbers or \"#rrggbb\"";

    fn parse(item: &Item<'_>, context: &mut Context) -> Result<Self, Error> {
        context.admit(item, 3)?;
        item.rgb(Interval::UNIT).map(|rgb| Self(rgb.map(f64::from)))
    }
}

#[rustfmt::skip]
const FILAMENT: Thing<FilamentKeys, Questions> = Thing {
    name: "a filament",
    doc: "A printer's filament by the two numbers that its maker states",
    plain: FilamentKeys::default,
    fields: &[
        field!(FilamentKeys { color } => parsed(color),
            "color of a thick piece without its gloss, linear Rec. 709 or \"#rrggbb\"", Required),
        field!(FilamentKeys { transmission_distance } => number(transmission_distance, LENGTH),
            "thickness of a sheet that lets the part `transmitted` of the light through [L], {range}", Required),
        field!(FilamentKeys { transmitted } => number(transmitted, Interval::open(0.0, 1.0)),
            "part of the light that passes a sheet of the transmission distance, {range}; sources disagree on it: 0.37 (1/e), 0.1, 0.05, or next to nothing, 0.01", Required),
    ],
    rules: &[],
};

/// A medium above or below layers, or a ground.
#[derive(Clone, Debug, Default)]
struct End {
    eta: Option<Varied>,
    reflectance: Option<Varied>,
}

#[rustfmt::skip]
const ABOVE: Thing<End, Questions> = Thing {
    name: "above",
    doc: "The medium above the layers",
    plain: End::default,
    fields: &[field!(End { eta } => varied(eta, ETA), "its index of refraction, {range}", Words("1"))],
    rules: &[],
};

#[rustfmt::skip]
const BELOW: Thing<End, Questions> = Thing {
    name: "below",
    doc: "The medium below the layers, or the ground",
    plain: End::default,
    fields: &[
        field!(End { eta } => varied(eta, ETA), "index of refraction of a clear medium, {range}", Words("none")),
        field!(End { reflectance } => varied(reflectance, Interval::UNIT),
            "part of the light that a ground in contact with the last layer returns, {range}", Words("none")),
    ],
    rules: &[Rule::OneOf(&[&["eta"], &["reflectance"]])],
};

/// Grounds that layers are put on.
#[derive(Clone, Debug)]
pub(crate) struct Grounds {
    pub(crate) black: Option<Varied>,
    pub(crate) white: Option<Varied>,
    /// Whether a layer of air lies between the layers and the ground.
    pub(crate) contact: bool,
}

#[rustfmt::skip]
const GROUNDS: Thing<Grounds, Questions> = Thing {
    name: "grounds",
    doc: "The black and the white ground",
    plain: || Grounds { black: None, white: None, contact: false },
    fields: &[
        field!(Grounds { black } => varied(black, Interval::UNIT), "reflectance of the black ground, {range}", Words("0")),
        field!(Grounds { white } => varied(white, Interval::UNIT), "reflectance of the white ground, {range}", Words("1")),
        field!(Grounds { contact } => word(contact, &[("optical", false), ("air", true)]),
            "contact of the layers with the grounds", Plain),
    ],
    rules: &[],
};

/// A file of layers.
#[derive(Clone, Debug, Default)]
pub(crate) struct LayersKeys {
    above: Option<End>,
    layer: Vec<Placed<LayerKeys>>,
    below: Option<End>,
    pub(crate) grounds: Option<Grounds>,
}

#[rustfmt::skip]
pub(crate) const LAYERS_FILE: Thing<LayersKeys, Questions> = Thing {
    name: "a file of layers",
    doc: "Plane layers, from top to bottom",
    plain: LayersKeys::default,
    fields: &[
        field!(LayersKeys { above } => table(above, &ABOVE), "medium above the layers", Words("air")),
        field!(LayersKeys { layer } => things(layer, &LAYER, Layers::MOST), "layers from top to bottom", Required),
        field!(LayersKeys { below } => table(below, &BELOW),
            "medium or ground below the layers", Words("nothing below an endless layer, else air")),
        field!(LayersKeys { grounds } => table(grounds, &GROUNDS),
            "black and white grounds, for colors", Words("black and white")),
    ],
    rules: &[],
};

impl LayersKeys {
    /// Reads layers.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value not allowed.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn read(table: Table<'_>) -> Result<(Self, Context), Error> {
        let mut context = context();
        let keys = LAYERS_FILE.read(&table.allow(&LAYERS_FILE.keys())?, &mut context)?;
        Ok((keys, context))
    }

    /// The bits of all numbers of a channel or element: stacks of the same bits are the same.
    fn bits(&self, element: usize) -> Vec<u64> {
        let ends = self.above.iter().chain(&self.below).flat_map(|end| [&end.eta, &end.reflectance]);
        let layers = self.layer.iter().flat_map(|layer| {
            let LayerKeys { thickness, scattering, absorption, surface_albedo, mfp, g, eta, .. } =
                &layer.thing;
            [thickness, scattering, absorption, surface_albedo, mfp, g, eta]
        });
        let given = ends.chain(layers).flatten();
        // Filaments differ between channels
        let channel = if self.has_filaments() { element as u64 } else { 0 };
        given.map(|varied| varied.at(element).to_bits()).chain([channel]).collect()
    }

    /// Whether a layer is a filament.
    pub(crate) fn has_filaments(&self) -> bool {
        self.layer.iter().any(|layer| layer.thing.filament.is_some())
    }

    /// The layers of a channel or element.
    ///
    /// # Errors
    /// They cannot be.
    pub(crate) fn build(&self, element: usize, builder: &Builder) -> Result<Layers, Error> {
        let at = |varied: &Option<Varied>, default: f64| varied.as_ref().map_or(default, |v| v.at(element));
        let above = self.above.as_ref().map_or(1.0, |end| at(&end.eta, 1.0));
        let layers = self.layer.iter().map(|layer| builder.layer(layer, element));
        let layers = layers.collect::<Result<Vec<Layer>, Error>>()?;
        let is_endless = layers.last().is_some_and(|layer| layer.thickness == f64::INFINITY);
        let ground = match &self.below {
            Some(End { reflectance: Some(reflectance), .. }) => {
                Ground::Lambertian { reflectance: reflectance.at(element) }
            }
            Some(End { eta, .. }) => Ground::Medium { eta: at(eta, 1.0) },
            None if is_endless => Ground::None,
            None => Ground::AIR,
        };
        Layers::new(above, layers, ground).map_err(|error| match error.layer {
            Some(layer) => self.layer[layer].error(error.error),
            None => Error::new(error.error.to_string()),
        })
    }
}

/// The layers of a file whose values are one number each.
///
/// # Errors
/// The file cannot be read, a key or value is wrong, or values differ between channels.
#[cfg(not(target_family = "wasm"))]
pub fn load_layers(path: &Path) -> Result<Layers, Error> {
    let (source, entries) = translucid_load::load_toml(path)?;
    let source = source.of(LAYERS_FILE.name);
    let (keys, context) = LayersKeys::read(Table::root(&source, &entries))?;
    if context.count() > 1 {
        let error = Error::at(
            translucid_words::Place::file(path),
            "values differ between wavelengths or channels, but this takes one number each",
        );
        return Err(error.with_help("translucid stack and translucid layers read them"));
    }
    keys.build(0, &Builder::default())
}

/// The layers of the question *layers*, whose values are one number each.
///
/// # Errors
/// A key or value is wrong.
pub fn stated_layers(source: &Provenance, entries: &[Entry]) -> Result<Layers, Error> {
    let asked =
        LAYERS.thing.read(&Table::root(source, entries).allow(&LAYERS.thing.keys())?, &mut context())?;
    asked.layers.unwrap_or_default().build(0, &Builder::default())
}

/// Makes layers from what is stated.
#[derive(Default)]
pub(crate) struct Builder {
    /// Inversions that were made, which takes some 0.1 s each.
    pub(crate) inversions: RefCell<Vec<AlbedoInversion>>,
    /// Part of the light that passes a filament's sheet, in place of what is stated.
    pub(crate) transmitted: Option<f64>,
}

impl Builder {
    fn layer(&self, stated: &Placed<LayerKeys>, element: usize) -> Result<Layer, Error> {
        let refused = |error: ParameterError| stated.error(error);
        let keys = &stated.thing;
        let at = |varied: &Option<Varied>| varied.as_ref().map(|varied| varied.at(element));
        let thickness = at(&keys.thickness).unwrap_or(f64::INFINITY);
        let (g, eta) = (at(&keys.g).unwrap_or(0.0), at(&keys.eta).unwrap_or(1.0));
        let layer =
            match (at(&keys.scattering), at(&keys.absorption), at(&keys.surface_albedo), at(&keys.mfp)) {
                (Some(scattering), Some(absorption), ..) => {
                    Layer::new(scattering, absorption, thickness).with_g(g)
                }
                (.., Some(albedo), Some(mfp)) => {
                    self.of_albedo(albedo, mfp, g, thickness).map_err(refused)?
                }
                _ => {
                    let [scattering, absorption] =
                        self.filament(keys, eta).map_err(|error| stated.error(error))?;
                    Layer::new(scattering[element], absorption[element], thickness)
                }
            };
        let layer = layer.with_eta(eta);
        Ok(match &keys.phase_function {
            Some(given) => given.of(layer),
            None if keys.moments.is_empty() => layer,
            None => layer.with_moments(keys.moments.clone()),
        })
    }

    /// The medium whose half space without a boundary has the surface albedo under diffuse light.
    fn of_albedo(&self, albedo: f64, mfp: f64, g: f64, thickness: f64) -> Result<Layer, ParameterError> {
        let mut inversions = self.inversions.borrow_mut();
        let known = inversions.iter().position(|inversion| inversion.g() == g);
        let index = match known {
            Some(index) => index,
            None => {
                inversions.push(AlbedoInversion::new(g, 1.0, Configuration::Diffuse)?);
                inversions.len() - 1
            }
        };
        Layer::from_surface_albedo(&inversions[index], albedo, mfp, Parameterization::Mfp, thickness)
    }

    /// Scattering and absorption coefficients of a filament for red, green and blue.
    fn filament(&self, keys: &LayerKeys, eta: f64) -> Result<[[f64; 3]; 2], String> {
        let (Some(stated), None | Some(1)) = (&keys.filament, keys.eta.as_ref().map(Varied::count)) else {
            return Err(String::from("eta of a filament must be one number"));
        };
        let filament = Filament {
            color: stated.color.as_ref().map_or([0.0; 3], |color| color.0),
            transmission_distance: stated.transmission_distance,
            transmitted: self.transmitted.unwrap_or(stated.transmitted),
            eta,
        };
        filament.coefficients()
    }
}

/// Layers, and the light that arrives.
#[derive(Clone, Debug, Default)]
pub struct AskedLayers {
    layers: Option<LayersKeys>,
    configuration: Option<Configuration>,
    incidence_angle: Option<f64>,
    tolerance: Option<f64>,
    r: Option<Varied>,
}

/// *layers*.
#[rustfmt::skip]
pub static LAYERS: Question<AskedLayers> = Question {
    thing: Thing {
        name: "layers",
        doc: "Light that plane layers reflect, transmit and absorb, or its profile around a beam",
        plain: AskedLayers::default,
        fields: &[
            field!(AskedLayers { layers } => document(layers, &LAYERS_FILE), "layers, or the TOML file of them", Required),
            field!(AskedLayers { configuration } => optional_word(configuration, &Configuration::WORDS),
                "how light arrives", Words("searchlight along the normal")),
            field!(AskedLayers { incidence_angle } => optional(incidence_angle, Interval::below(0.0, 90.0)),
                "angle of a beam above, in degrees from the normal, {range}", Words("none")),
            field!(AskedLayers { tolerance } => optional(tolerance, Interval::closed(1e-12, 0.1)),
                "error at which no finer rule is needed, {range}", "Profiles take no less than 1e-4; from 5e-3 on they are two to six times faster.",
                Words("1e-6 of the light in totals, 1e-4 of the value in profiles")),
            field!(AskedLayers { r } => varied(r, Interval::closed(0.0, f64::MAX)),
                "distances from the beam [L], {range}; without them totals are computed", Words("none")),
        ],
        rules: &[Rule::NotWith(&["r", "incidence_angle"], "profiles of layers are those of a searchlight along the normal")],
    },
    about: About {
        more: "Totals are parts of the light that arrives from above, what the faces reflect included; profiles are scattered light only, around a beam along the normal.",
        source: "Discrete directions in each layer (S. Chandrasekhar 1950, Radiative Transfer), joined by adding (H. C. van de Hulst 1963, A new look at multiple scattering); profiles by wave number.",
        is_by_element: true,
        right: right_layers,
        examples: &[
                "examples/layers/paint.toml",
                "examples/layers/skin.toml --incidence-angle 45",
                "examples/layers/paint.toml --r 0.1,1,10",
            ],
        columns: &TOTALS,
        formats: &["csv", "json"],
    },
    form: |_| Form::Table,
    answer,
};

/// A layer by its coefficients on a ground, one by what it looks like on a medium, and a filament over grounds.
pub(crate) fn right_layers() -> Vec<Vec<Entry>> {
    let table = |keys: &[(&str, f64)]| -> Value {
        keys.iter().map(|(key, number)| Entry::new(key, *number)).collect::<Vec<Entry>>().into()
    };
    let said = |layer: Value, key: &str, below: Value| {
        let above = Entry::new("above", table(&[("eta", 1.0)]));
        vec![Entry::new("layers", vec![above, Entry::new("layer", vec![layer]), Entry::new(key, below)])]
    };
    let color = Entry::new("color", Value::list(&[0.9, 0.5, 0.1]));
    let filament = vec![color, Entry::new("transmission_distance", 5.0), Entry::new("transmitted", 0.1)];
    let printed = vec![Entry::new("thickness", 1.0), Entry::new("filament", filament)];
    vec![
        said(
            table(&[("thickness", 1.0), ("scattering", 2.0), ("absorption", 0.5)]),
            "below",
            table(&[("reflectance", 0.5)]),
        ),
        said(
            table(&[("thickness", 1.0), ("surface_albedo", 0.8), ("mfp", 0.5)]),
            "below",
            table(&[("eta", 1.4)]),
        ),
        said(printed.into(), "grounds", table(&[("black", 0.0), ("white", 1.0)])),
    ]
}

/// Columns of totals: before and after those of each layer.
static TOTALS: [Column; 7] = [
    Column::new("specular_reflectance", "1", "part of the light that returns without having been scattered"),
    Column::new("diffuse_reflectance", "1", "part of the light that returns scattered"),
    Column::new(
        "collimated_transmittance",
        "1",
        "part of the light that leaves below without having been scattered",
    ),
    Column::new("diffuse_transmittance", "1", "part of the light that leaves below scattered"),
    Column::new("absorbed_by_layer_1", "1", "part of the light that a layer absorbs, a column for each"),
    Column::new("absorbed_by_ground", "1", "part of the light that a ground absorbs"),
    Column::new(
        "error",
        "1",
        "estimated numerical error of each part, and what every second row of a phase function's table changes",
    ),
];

/// Columns of profiles.
#[cfg(not(target_family = "wasm"))]
static PROFILE: [Column; 5] = [
    Column::new("r", "L", "distance from the beam"),
    Column::new("reflectance", "L^-2", "scattered light that returns, per area"),
    Column::new("reflectance_error", "L^-2", "its estimated numerical error"),
    Column::new("transmittance", "L^-2", "scattered light that leaves below, per area"),
    Column::new("transmittance_error", "L^-2", "its estimated numerical error"),
];

/// Error of totals beyond which they are none.
const HOPELESS: f64 = 1e-2;
/// Parts that the work on a stack counts as.
const PARTS: u64 = 1000;

impl AskedLayers {
    fn incidence(&self) -> Result<Incidence, Error> {
        match (self.incidence_angle, self.configuration) {
            (Some(_), Some(Configuration::Diffuse)) => {
                Err(Error::new("`incidence_angle` belongs to a beam, not to diffuse light"))
            }
            (Some(degrees), _) => Ok(Incidence::Pencil { cos_theta: degrees.to_radians().cos() }),
            (None, configuration) => Ok(configuration.map_or(Incidence::NORMAL, Incidence::from)),
        }
    }
}

/// The stacks of all elements, each once, and which of them each element has.
fn stacks(keys: &LayersKeys, count: usize) -> Result<(Vec<Layers>, Vec<usize>), Error> {
    let (builder, mut stacks, mut places) = (Builder::default(), Vec::<Layers>::new(), Vec::new());
    let mut known = HashMap::new();
    for element in 0..count {
        let place = *known.entry(keys.bits(element)).or_insert(stacks.len());
        if place == stacks.len() {
            let stack = keys.build(element, &builder);
            stacks.push(stack.map_err(|error| at_element(error, element, count))?);
        }
        places.push(place);
    }
    Ok((stacks, places))
}

/// An error of one of several elements.
fn at_element(error: Error, element: usize, count: usize) -> Error {
    if count == 1 {
        return error;
    }
    Error { message: format!("{} (at index [{element}])", error.message), ..error }
}

/// The control of a solution, which counts what is done.
#[cfg(not(target_family = "wasm"))]
fn watched<'a>(control: &Control<'a>, count: &'a (dyn Fn(u64) + Sync)) -> WalkControl<'a> {
    WalkControl { stop: control.stop, progress: count, ..WalkControl::default() }
}

/// Totals to a tolerance; none if the work was stopped.
#[cfg(not(target_family = "wasm"))]
fn totals_within(
    layers: &Layers,
    tolerance: f64,
    incidence: Incidence,
    watch: &WalkControl<'_>,
) -> Result<Option<Totals>, ParameterError> {
    layers.totals_within(tolerance, incidence, watch)
}

/// WebAssembly has no walks, from which others have their control.
#[cfg(target_family = "wasm")]
struct WalkControl;

#[cfg(target_family = "wasm")]
fn watched(_: &Control<'_>, _: &(dyn Fn(u64) + Sync)) -> WalkControl {
    WalkControl
}

/// Totals to the one tolerance that WebAssembly has.
#[cfg(target_family = "wasm")]
fn totals_within(
    layers: &Layers,
    _: f64,
    incidence: Incidence,
    _: &WalkControl,
) -> Result<Option<Totals>, ParameterError> {
    layers.totals(incidence).map(Some)
}

/// Solves every stack.
fn solve<T: Send>(
    stacks: &[Layers],
    control: &Control<'_>,
    one: impl Fn(&Layers, &WalkControl) -> Result<Option<T>, Unanswered> + Sync,
) -> Result<Vec<T>, Unanswered> {
    let done = AtomicU64::new(0);
    let total = (PARTS * stacks.len() as u64) as f64;
    let solve = |layers: &Layers| {
        let counted = AtomicU64::new(0);
        // Threads may come in another order than their counts
        let count = |part: u64| {
            let before = counted.fetch_max(part, Ordering::Relaxed);
            let more = part.saturating_sub(before);
            (control.progress)((done.fetch_add(more, Ordering::Relaxed) + more) as f64 / total);
        };
        let watch = watched(control, &count);
        let solved = one(layers, &watch)?.ok_or(Unanswered::Stopped)?;
        count(PARTS);
        Ok(solved)
    };
    stacks.par_iter().map(solve).collect()
}

/// Solutions for the stacks, and for what becomes of each without every second row of its phase functions' tables, if it has
/// some: what that changes is not known.
fn solve_with_doubts<T: Send>(
    stacks: &[Layers],
    control: &Control<'_>,
    one: impl Fn(&Layers, &WalkControl) -> Result<Option<T>, Unanswered> + Sync,
) -> Result<Vec<(T, Option<T>)>, Unanswered> {
    let thinned: Vec<Option<Layers>> = stacks.iter().map(Layers::thinned).collect();
    let both: Vec<Layers> = stacks.iter().chain(thinned.iter().flatten()).cloned().collect();
    let mut solved = solve(&both, control, one)?;
    let mut doubts = solved.split_off(stacks.len()).into_iter();
    let doubt = |thinned: &Option<Layers>| thinned.as_ref().and_then(|_| doubts.next());
    Ok(solved.into_iter().zip(thinned.iter().map(doubt).collect::<Vec<_>>()).collect())
}

fn answer(asked: &AskedLayers, context: &Context, control: &Control<'_>) -> Result<Answer, Unanswered> {
    let Some(keys) = &asked.layers else { return Ok(Answer::default()) };
    if keys.grounds.is_some() {
        return Err(Error::new("grounds are those of a stack, which has colors").into());
    }
    if cfg!(target_family = "wasm") && asked.tolerance.is_some() {
        return Err(Error::new("`tolerance` is not in this module: leave it out").into());
    }
    let incidence = asked.incidence()?;
    let (stacks, places) = stacks(keys, context.count())?;
    let mut warnings: Vec<String> = stacks.iter().flat_map(Layers::warnings).collect();
    warnings.dedup();
    let answer = match &asked.r {
        None => totals(asked, &stacks, &places, incidence, control),
        Some(_) if incidence != Incidence::NORMAL => {
            let error = Error::new("profiles of layers are those of a searchlight along the normal");
            return Err(error.with_help("leave the radii out for totals under any light").into());
        }
        Some(r) => profiles(asked, r, &stacks, &places, control),
    }?;
    Ok(Answer { warnings: [warnings, answer.warnings].concat(), ..answer })
}

fn totals(
    asked: &AskedLayers,
    stacks: &[Layers],
    places: &[usize],
    incidence: Incidence,
    control: &Control<'_>,
) -> Result<Answer, Unanswered> {
    let tolerance = asked.tolerance.unwrap_or(1e-6);
    let solved = solve_with_doubts(stacks, control, |layers, watch| {
        let totals = totals_within(layers, tolerance, incidence, watch).map_err(refused)?;
        match totals {
            Some(totals) if totals.error > HOPELESS.max(tolerance) => {
                let error =
                    Error::new("these layers have no exact solution: their coefficients are too far apart");
                Err(Unanswered::Work(error.with_help("walk photons through them")))
            }
            totals => Ok(totals),
        }
    })?;
    let layers = solved.first().map_or(0, |(totals, _)| totals.absorbed.len());
    let mut table = DataTable::of(&TOTALS[..4]);
    let absorbed = (1..=layers).map(|layer| TOTALS[4].named(format!("absorbed_by_layer_{layer}")));
    table.columns.extend(absorbed.chain(TOTALS[5..].iter().cloned()));
    table.rows = places
        .iter()
        .map(|place| {
            let (totals, doubt) = &solved[*place];
            let found = parts(totals);
            let doubt = doubt.as_ref().map_or(0.0, |doubt| {
                found.iter().zip(parts(doubt)).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
            });
            found.into_iter().chain([totals.error + doubt]).map(Cell::Number).collect()
        })
        .collect();
    Ok(Answer { tables: vec![table], ..Answer::default() })
}

/// The parts of totals in the order of columns.
fn parts(totals: &Totals) -> Vec<f64> {
    let first = [
        totals.specular_reflectance,
        totals.diffuse_reflectance,
        totals.collimated_transmittance,
        totals.diffuse_transmittance,
    ];
    first.into_iter().chain(totals.absorbed.iter().copied()).chain([totals.absorbed_by_ground]).collect()
}

/// Profiles take too much code for WebAssembly.
#[cfg(target_family = "wasm")]
fn profiles(
    _: &AskedLayers,
    _: &Varied,
    _: &[Layers],
    _: &[usize],
    _: &Control<'_>,
) -> Result<Answer, Unanswered> {
    Err(Error::new("profiles of layers are not in this module").with_help("leave r out for totals").into())
}

#[cfg(not(target_family = "wasm"))]
fn profiles(
    asked: &AskedLayers,
    r: &Varied,
    stacks: &[Layers],
    places: &[usize],
    control: &Control<'_>,
) -> Result<Answer, Unanswered> {
    let tolerance = asked.tolerance.unwrap_or(1e-4);
    let solved = solve_with_doubts(stacks, control, |layers, watch| {
        layers.profile_within(tolerance, watch).map_err(|error| {
            if error.error.parameter == "tolerance" {
                return refused(error.error);
            }
            let error = Error::new(format!("these layers have no exact profile: {error}"));
            let help = "leave the radii out for totals, or walk photons through an .mci file of these layers";
            Unanswered::Input(error.with_help(help))
        })
    })?;
    let mut table = DataTable::of(&PROFILE);
    let mut unknown = 0;
    for (element, place) in places.iter().enumerate() {
        let (r, (profile, doubt)) = (r.at(element), &solved[*place]);
        let [reflected, transmitted] =
            [LayersProfile::reflectance, LayersProfile::transmittance].map(|light| {
                let found = light(profile, r);
                let doubt = doubt.as_ref().map_or(0.0, |doubt| (light(doubt, r).value - found.value).abs());
                Estimate { error: found.error + doubt, ..found }
            });
        let is_unknown = |value: f64, error: f64| error > 0.0 && error >= value;
        unknown += usize::from(
            is_unknown(reflected.value, reflected.error) || is_unknown(transmitted.value, transmitted.error),
        );
        let row = [r, reflected.value, reflected.error, transmitted.value, transmitted.error];
        table.rows.push(row.map(Cell::Number).to_vec());
    }
    let warnings = (unknown > 0).then(|| {
        let all = places.len();
        format!(
            "at {unknown} of {all} radii an error is as large as its value: hardly any light is left there, or too little is known"
        )
    });
    Ok(Answer { tables: vec![table], warnings: warnings.into_iter().collect(), ..Answer::default() })
}

/// The error of a parameter of layers or of light on them.
fn refused(error: ParameterError) -> Unanswered {
    let (parameter, value) = (error.parameter, exact(error.value));
    let refusal = Error::new(format!("{parameter} is {value}, but must be {}", error.requirement()));
    Unanswered::Input(match parameter {
        "cos_theta" => {
            refusal.with_help("cos_theta is the cosine of `incidence_angle`: choose a smaller angle")
        }
        _ => refusal,
    })
}
