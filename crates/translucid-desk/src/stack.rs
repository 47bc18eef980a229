//! *stack*: the color of plane layers over grounds, as an instrument sees them.

use std::fmt::Write as _;
use std::sync::atomic::Ordering;

use translucid_laboratory::colorimetry::{
    Colorimeter, Illuminant, Observer, WAVELENGTHS, delta_e_2000, delta_e_ab, wavelength,
};
use translucid_laboratory::stack::{Color, Field, MEANINGS, Measurement, Specular, Swatch};
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_words::{
    Cell, Column, Context, DataTable, Error, Fallback, Thing, Varied, document, field, flag, word,
};

use crate::answer::{About, Answer, Control, Form, NamedFile, Question, Unanswered};
use crate::layers::{Builder, LAYERS_FILE, LayersKeys, right_layers};

use Fallback::{Plain, Required};

/// Layers, and how they are seen.
#[derive(Clone, Debug)]
pub struct AskedStack {
    layers: Option<LayersKeys>,
    illuminant: Illuminant,
    observer: Observer,
    specular: Specular,
    channels: bool,
}

const ILLUMINANTS: &[(&str, Illuminant)] =
    &[("d65", Illuminant::D65), ("d50", Illuminant::D50), ("a", Illuminant::A)];
const OBSERVERS: &[(&str, Observer)] = &[("2", Observer::TwoDegrees), ("10", Observer::TenDegrees)];
const SPECULARS: &[(&str, Specular)] = &[("included", Specular::Included), ("excluded", Specular::Excluded)];

/// *stack*.
#[rustfmt::skip]
pub static STACK: Question<AskedStack> = Question {
    thing: Thing {
        name: "stack",
        doc: "Prints the color of plane layers over black, white and their own ground, and draws a swatch",
        plain: || AskedStack {
            layers: None, illuminant: Illuminant::D65, observer: Observer::TwoDegrees, specular: Specular::Included, channels: false,
        },
        fields: &[
            field!(AskedStack { layers } => document(layers, &LAYERS_FILE), "TOML file of the layers", Required),
            field!(AskedStack { illuminant } => word(illuminant, ILLUMINANTS),
                "Light: daylight of 6504 K, that of printing of 5003 K, or incandescent light", Plain),
            field!(AskedStack { observer } => word(observer, OBSERVERS),
                "Field of view of the observer in degrees: CIE 1931 or CIE 1964", Plain),
            field!(AskedStack { specular } => word(specular, SPECULARS),
                "Light that returns without having been scattered: included is what recipes and quality control use", Plain),
            field!(AskedStack { channels } => flag(channels),
                "Print reflectances and transmittances by wavelength or channel instead of colors", Plain),
        ],
        rules: &[],
    },
    about: About {
        more: "The file is that of reference --layers, in which a number may also be three, for red, green and blue (linear Rec. 709), or a table over wavelengths in nm, and a layer may be a filament by its color and transmission distance. [grounds] has the reflectances of black and white.\n\nEverything is what an instrument of the geometry d:8 measures: light from everywhere, viewed at 8 degrees.",
        source: "Layers as in layers; colors by CIE 15:2018; G. Sharma, W. Wu and E. N. Dalal 2005, The CIEDE2000 color-difference formula; P. Kubelka and F. Munk 1931; J. L. Saunderson 1942.",
        is_by_element: false,
        right: right_layers,
        examples: &[
            "examples/stack/enamel.toml",
            "examples/stack/enamel.toml --format text --specular excluded",
            "examples/stack/enamel.toml --channels -o spectra.csv",
            "examples/stack/enamel.toml -o enamel.svg",
        ],
        columns: &COLORS,
        formats: &["csv", "json", "text"],
    },
    form: |_| Form::Table,
    answer,
};

/// Columns of colors.
#[rustfmt::skip]
static COLORS: [Column; 17] = [
    Column::new("ground", "", "black, white, or below: that of the layers themselves"),
    Column::new("reflectance", "1", "reflectance of luminance"),
    Column::new("transmittance", "1", "transmittance of luminance; none over a ground"),
    Column::new("X", "1", "CIE X, where Y is 100 for the perfect diffuser"),
    Column::new("Y", "1", "CIE Y"),
    Column::new("Z", "1", "CIE Z"),
    Column::new("L", "1", "CIELAB L*"),
    Column::new("a", "1", "CIELAB a*"),
    Column::new("b", "1", "CIELAB b*"),
    Column::new("srgb", "", "the color of a display"),
    Column::new("in_srgb", "", "no where srgb is only the nearest color of a display"),
    Column::new("error", "1", "numerical error, at most, in Delta E*ab"),
    Column::new("kubelka_munk_reflectance", "1", "reflectance by Kubelka and Munk with Saunderson's correction"),
    Column::new("kubelka_munk_delta_e", "1", "distance of its color in Delta E*ab"),
    Column::new("tp_ab", "1", "Delta E*ab between the layers over white and over black, the same in each row"),
    Column::new("tp_2000", "1", "CIEDE2000 between them"),
    Column::new("contrast_ratio", "1", "Y over black / Y over white"),
];

/// Layers over a ground, channel by channel: one, red, green and blue, or those of a spectrum.
struct Over {
    /// `black`, `white` or, of the layers' own, `below`.
    ground: &'static str,
    /// Reflectances of the ground without layers.
    bare: Vec<f64>,
    layers: Vec<Layers>,
}

/// Over black, over white and over the layers' own ground; over that alone if the last layer is endless.
fn over_grounds(keys: &LayersKeys, count: usize, builder: &Builder) -> Result<Vec<Over>, Error> {
    let mut all =
        ["black", "white", "below"].map(|ground| Over { ground, bare: Vec::new(), layers: Vec::new() });
    for channel in 0..count {
        let layers = keys.build(channel, builder)?;
        let at = |varied: Option<&Varied>, default| varied.map_or(default, |varied| varied.at(channel));
        let stated = keys.grounds.as_ref();
        let reflectances = [
            at(stated.and_then(|grounds| grounds.black.as_ref()), 0.0),
            at(stated.and_then(|grounds| grounds.white.as_ref()), 1.0),
        ];
        let has_air = stated.is_some_and(|grounds| grounds.contact);
        if layers.ground() == Ground::None && stated.is_some() {
            let message = "grounds lie below a layer with a thickness, but the last layer is endless";
            return Err(Error::new(message));
        }
        for (over, reflectance) in all.iter_mut().zip(reflectances) {
            if layers.ground() != Ground::None {
                over.layers.push(put_on(&layers, reflectance, has_air)?);
            }
            over.bare.push(reflectance);
        }
        let own = if let Ground::Lambertian { reflectance } = layers.ground() { reflectance } else { 0.0 };
        all[2].bare.push(own);
        all[2].layers.push(layers);
    }
    Ok(all.into_iter().filter(|over| !over.layers.is_empty()).collect())
}

/// The layers on another ground, with air between them or not.
fn put_on(layers: &Layers, reflectance: f64, has_air: bool) -> Result<Layers, Error> {
    let air = has_air.then(|| Layer::new(0.0, 0.0, 1.0));
    let all = layers.layers().iter().cloned().chain(air).collect();
    Layers::new(layers.eta_above(), all, Ground::Lambertian { reflectance })
        .map_err(|error| Error::new(error.to_string()))
}

/// Layers over one ground with their color.
struct Row {
    ground: &'static str,
    /// Color of the ground without layers.
    bare: Color,
    measured: Measurement,
    color: Color,
    /// Y of the transmitted light, over 100; not a number over a ground.
    transmittance: f64,
    /// Greatest ΔE*ab that numerical errors can make.
    error: f64,
    kubelka_munk: Color,
}

impl Row {
    fn new(stack: &Over, specular: Specular, eye: &Colorimeter) -> Result<Self, Unanswered> {
        let measured =
            Measurement::new(&stack.layers, specular).map_err(|error| Error::new(error.to_string()))?;
        if measured.errors.iter().any(|error| *error > 1e-2) {
            let message = "these layers have no exact solution: their coefficients are too far apart";
            return Err(Unanswered::Work(Error::new(message)));
        }
        let color = Color::new(eye, &measured.reflectance);
        let is_open = stack.layers.iter().all(|layers| matches!(layers.ground(), Ground::Medium { .. }));
        let transmittance = Color::new(eye, &measured.transmittance).xyz[1] / 100.0;
        Ok(Self {
            ground: stack.ground,
            bare: Color::new(eye, &stack.bare),
            color,
            transmittance: if is_open { transmittance } else { f64::NAN },
            error: color.error(eye, &measured.errors),
            kubelka_munk: Color::new(eye, &measured.kubelka_munk),
            measured,
        })
    }

    /// ΔE*ab between Kubelka and Munk's color and the exact one.
    fn kubelka_munk_delta_e(&self) -> f64 {
        delta_e_ab(self.color.lab, self.kubelka_munk.lab)
    }

    /// The ground in words.
    fn place(&self) -> &'static str {
        if self.ground == "below" { "the file's ground" } else { self.ground }
    }
}

/// Error of colors, in ΔE*ab, above which there is a warning.
const ERROR: f64 = 0.01;
/// Distance of Kubelka and Munk's color, in ΔE*ab, above which it is noted.
const OFF: f64 = 1.0;

fn answer(asked: &AskedStack, context: &Context, control: &Control<'_>) -> Result<Answer, Unanswered> {
    let Some(keys) = &asked.layers else { return Ok(Answer::default()) };
    let channels = context.count();
    let eye = asked.eye(channels)?;
    let solve = |transmitted| {
        let builder = Builder { transmitted, ..Builder::default() };
        let over = over_grounds(keys, channels, &builder)?;
        over.iter().map(|over| Row::new(over, asked.specular, &eye)).collect::<Result<Vec<Row>, Unanswered>>()
    };
    let rows = solve(None)?;
    let meanings = if keys.has_filaments() { &MEANINGS[..] } else { &[] };
    let mut spread = vec![0.0; if meanings.is_empty() { 0 } else { rows.len() }];
    for (i, meaning) in meanings.iter().enumerate() {
        (control.progress)((i + 1) as f64 / (meanings.len() + 1) as f64);
        if control.stop.load(Ordering::Relaxed) {
            return Err(Unanswered::Stopped);
        }
        for ((most, row), other) in spread.iter_mut().zip(&rows).zip(solve(Some(*meaning))?) {
            *most = f64::max(*most, delta_e_ab(row.color.lab, other.color.lab));
        }
    }
    let spread = spread_words(&rows, &spread);
    let conditions = asked.conditions(channels);
    let (text, title) = (paragraph(&rows, spread.as_deref(), &conditions), title(context));
    let swatch = swatch(title, &rows, spread.as_deref(), conditions);
    let undrawn = |error| Unanswered::Work(Error::new(format!("cannot draw the swatch: {error}")));
    let files = vec![
        NamedFile { name: "swatch.svg".into(), bytes: swatch.svg().map_err(undrawn)?.into_bytes() },
        NamedFile { name: "swatch.png".into(), bytes: swatch.png().map_err(undrawn)? },
    ];
    Ok(Answer {
        tables: vec![if asked.channels { by_channel(&rows) } else { colors(&rows) }],
        text: (!asked.channels).then_some(text),
        files,
        notes: Vec::new(),
        remarks: kubelka_munk_words(&rows, OFF).into_iter().chain(spread).collect(),
        warnings: [keys.build(0, &Builder::default())?.warnings(), warnings(&rows)].concat(),
    })
}

/// Reasons to doubt colors.
fn warnings(rows: &[Row]) -> Vec<String> {
    let error = rows.iter().map(|row| row.error).fold(0.0, f64::max);
    let is_far = format!("numerical errors may change colors by up to {error:.2} ΔE*ab");
    let is_lighter = matches!(rows, [black, white, _] if black.bare.xyz[1] > white.bare.xyz[1]);
    (error > ERROR)
        .then_some(is_far)
        .into_iter()
        .chain(is_lighter.then(|| String::from("grounds.black is lighter than grounds.white")))
        .collect()
}

impl AskedStack {
    fn eye(&self, channels: usize) -> Result<Colorimeter, Error> {
        if ![1, 3, WAVELENGTHS].contains(&channels) {
            return Err(Error::new(format!(
                "the layers have {channels} channels, but a color takes 1, 3 (red, green and blue), or {WAVELENGTHS} (380 to 780 nm)"
            )));
        }
        if channels == 3 && (self.observer, self.illuminant) != (Observer::TwoDegrees, Illuminant::D65) {
            let message = "the layers have values for red, green and blue, which are colors for the illuminant d65 and the \
                           observer 2 only";
            return Err(Error::new(message).with_help("give values over wavelengths"));
        }
        Ok(Colorimeter::new(self.observer, self.illuminant))
    }

    /// The conditions under which colors are seen, in words.
    fn conditions(&self, channels: usize) -> String {
        let rgb = if channels == 3 { ", from red, green and blue" } else { "" };
        let light = name(ILLUMINANTS, self.illuminant).to_uppercase();
        let (observer, specular) = (name(OBSERVERS, self.observer), name(SPECULARS, self.specular));
        format!("{light}, {observer}° observer, d:8° with specular {specular}{rgb}")
    }
}

fn name<T: Copy + PartialEq>(words: &[(&'static str, T)], value: T) -> &'static str {
    words.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

/// The name of the file that the layers are in.
fn title(context: &Context) -> String {
    let name = context.files.first().and_then(|path| path.file_name());
    name.map_or_else(|| String::from("layers"), |name| name.to_string_lossy().into_owned())
}

fn colors(rows: &[Row]) -> DataTable {
    let cells = |row: &Row| {
        let color = row.color;
        let numbers = [color.xyz[1] / 100.0, row.transmittance].into_iter().chain(color.xyz).chain(color.lab);
        let words = [color.hex(), String::from(if color.is_in_srgb() { "yes" } else { "no" })];
        let rest = [row.error, row.kubelka_munk.xyz[1] / 100.0, row.kubelka_munk_delta_e()];
        let head = std::iter::once(Cell::from(row.ground)).chain(numbers.map(Cell::Number));
        let tail = rest.into_iter().chain(contrast(rows)).map(Cell::Number);
        head.chain(words.map(Cell::Word)).chain(tail).collect()
    };
    DataTable { rows: rows.iter().map(cells).collect(), ..DataTable::of(&COLORS) }
}

/// Reflectances by channel, a column for each ground, then the transmittance and the greatest error.
fn by_channel(rows: &[Row]) -> DataTable {
    let count = rows[0].measured.reflectance.len();
    let mut columns = vec![if count > 3 {
        Column::new("wavelength", "nm", "wavelength")
    } else {
        Column::new("channel", "", "red, green, blue, or all")
    }];
    let reflectance = Column::new("", "1", "part of the light that returns over the ground of this name");
    columns.extend(rows.iter().map(|row| reflectance.named(format!("reflectance_{}", row.ground))));
    columns.push(Column::new(
        "transmittance",
        "1",
        "part of the light that leaves below; none over a ground",
    ));
    columns.push(Column::new("error", "1", "estimated numerical error"));
    let own = &rows[rows.len() - 1];
    let cells = |i: usize| {
        let name = if count == 3 { ["red", "green", "blue"][i] } else { "all" };
        let mut cells = vec![if count > 3 { Cell::Number(wavelength(i)) } else { Cell::from(name) }];
        cells.extend(rows.iter().map(|row| Cell::Number(row.measured.reflectance[i])));
        // As in the table of colors, no number over a ground
        cells.push(Cell::Number(own.measured.transmittance[i] + 0.0 * own.transmittance));
        cells.push(Cell::Number(rows.iter().map(|row| row.measured.errors[i]).fold(0.0, f64::max)));
        cells
    };
    DataTable { rows: (0..count).map(cells).collect(), ..DataTable::of(&columns) }
}

/// Lines for people.
fn paragraph(rows: &[Row], spread: Option<&str>, conditions: &str) -> String {
    let mut text = format!(
        "{:<7}{:>12}{:>15}  L*, a*, b*                 sRGB\n",
        "over", "reflectance", "transmittance"
    );
    for row in rows {
        let transmittance =
            if row.transmittance.is_nan() { String::from("-") } else { format!("{:.4}", row.transmittance) };
        // Writing to a string cannot fail
        let _ = writeln!(
            text,
            "{:<7}{:>12.4}{transmittance:>15}  {:<25}  {}{}",
            row.ground,
            row.color.xyz[1] / 100.0,
            lab(row),
            row.color.hex(),
            if row.color.is_in_srgb() { "" } else { " (nearest)" }
        );
    }
    for line in contrast_words(rows).into_iter().chain(kubelka_munk_words(rows, 0.0)) {
        let _ = writeln!(text, "{line}");
    }
    if let Some(line) = spread {
        let _ = writeln!(text, "{}", sentence(line));
    }
    let error = rows.iter().map(|row| row.error).fold(0.0, f64::max);
    let error = if error < ERROR { format!("{error:.0e}") } else { format!("{error:.2}") };
    let _ = writeln!(text, "{conditions}; numerical errors up to {error} ΔE*ab");
    text
}

/// TP and contrast ratio in words, if there are any.
fn contrast_words(rows: &[Row]) -> Option<String> {
    let [tp_ab, tp_2000, ratio] = contrast(rows);
    let ratio = if ratio.is_nan() { String::new() } else { format!(", contrast ratio {ratio:.3}") };
    (!tp_ab.is_nan()).then(|| format!("TP {tp_ab:.2} ΔE*ab, {tp_2000:.2} CIEDE2000{ratio}"))
}

/// Words with a capital letter.
fn sentence(words: &str) -> String {
    words[..1].to_uppercase() + &words[1..]
}

fn lab(row: &Row) -> String {
    // No negative zero
    let [l, a, b] = row.color.lab.map(|value| (100.0 * value).round() / 100.0 + 0.0);
    format!("{l:.2}, {a:.2}, {b:.2}")
}

fn swatch(title: String, rows: &[Row], spread: Option<&str>, conditions: String) -> Swatch {
    let field = |row: &Row| {
        let nearest = if row.color.is_in_srgb() { "" } else { ", the nearest color of sRGB" };
        let mut lines = vec![
            format!("L*, a*, b*: {}", lab(row)),
            format!("{}{nearest}", row.color.hex()),
            format!("reflectance {:.4}", row.color.xyz[1] / 100.0),
        ];
        if !row.transmittance.is_nan() {
            lines.push(format!("transmittance {:.4}", row.transmittance));
        }
        Field { name: format!("over {}", row.place()), ground: row.bare, layers: row.color, lines }
    };
    let lines = contrast_words(rows).into_iter().chain(spread.map(sentence)).chain([conditions]);
    Swatch { title, lines: lines.collect(), fields: rows.iter().map(field).collect() }
}

/// How far Kubelka and Munk are off, where it is more than a limit.
fn kubelka_munk_words(rows: &[Row], limit: f64) -> Option<String> {
    let off = rows.iter().filter(|row| row.kubelka_munk_delta_e() > limit);
    let off: Vec<String> =
        off.map(|row| format!("{:.2} over {}", row.kubelka_munk_delta_e(), row.place())).collect();
    let name = "Kubelka-Munk with Saunderson's correction is off by ΔE*ab";
    (!off.is_empty()).then(|| format!("{name} {}", off.join(", ")))
}

/// How far colors are off if transmission distances mean what other sources say, if there are any.
fn spread_words(rows: &[Row], spread: &[f64]) -> Option<String> {
    let off: Vec<String> =
        rows.iter().zip(spread).map(|(row, off)| format!("{off:.2} over {}", row.place())).collect();
    let parts = MEANINGS.map(|part| format!("{part:.2}")).join(", ");
    let name = "transmission distances of other meanings, transmitted";
    (!off.is_empty()).then(|| format!("{name} {parts}, change colors by up to ΔE*ab {}", off.join(", ")))
}

/// ΔE*ab and CIEDE2000 between the layers over white and over black, and Y over black divided by Y over white; not numbers
/// below an endless layer.
fn contrast(rows: &[Row]) -> [f64; 3] {
    let [black, white, _] = rows else { return [f64::NAN; 3] };
    let (black, white) = (black.color, white.color);
    [delta_e_ab(black.lab, white.lab), delta_e_2000(black.lab, white.lab), black.xyz[1] / white.xyz[1]]
}
