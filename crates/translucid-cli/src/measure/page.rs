//! The page of a measurement: the fit, what it leaves over, where in the photograph it was made.

use std::path::Path;

use translucid_image::{CodedPicture, ToneMapping, display_from_linear};
use translucid_laboratory::{Axis, Block, Chart, DataTable, Ink, Mark, Page, Plate, Section, Series};
use translucid_measure::Outline;

use super::report::{CHANNELS, outline_name, three_digits};
use super::setup::{SCENE, Setup};
use super::shown::Shown;
use crate::failure::Failure;
use crate::files::{Directory, NamedFile, is_own_page, refusal};

/// The file that shows the others.
const PAGE: &str = "index.html";
/// Title of a measurement's page.
const TITLE: &str = "Measured from a photograph";
/// The picture of the photograph.
const PICTURE: &str = "photograph.png";
/// Inks of the channels: those of [`Ink::Numbered`] that look red, green and blue.
const INKS: [Ink; 3] = [Ink::Numbered(0), Ink::Numbered(2), Ink::Numbered(1)];
/// Widest picture of a photograph.
const WIDEST: usize = 900;

/// Writes the page and its files into a directory.
pub(super) fn write(
    directory: &Path,
    photo: &Path,
    shown: &Shown<'_>,
    setup: Option<&Setup>,
    table: DataTable,
) -> Result<(), Failure> {
    Directory::fill(directory, |directory| {
        let page = directory.file(PAGE);
        if page.exists() && !is_own_page(&page, TITLE) {
            return Err(refusal(&page, "is there already, and translucid has not made it"));
        }
        directory.write(&files(photo, shown, setup, table)?)
    })
}

fn files(
    photo: &Path,
    shown: &Shown<'_>,
    setup: Option<&Setup>,
    table: DataTable,
) -> Result<Vec<NamedFile>, Failure> {
    let drawing = |error: std::io::Error| Failure::work(format!("cannot draw a picture: {error}"));
    let plate = plate(shown).map_err(drawing)?;
    let mut files = vec![(String::from(PICTURE), plate.png.clone())];
    let mut beside = Vec::new();
    if let Some((setup, scene)) = setup.and_then(|setup| Some((setup, setup.scene(shown)?))) {
        if let Some(plates) = setup.plates(&scene, shown)? {
            files.extend(plates.each_ref().map(|plate| (plate.file.clone(), plate.png.clone())));
            beside.push(Block::Plates(plates.into()));
        }
        files.push((String::from(SCENE), scene.into_bytes()));
    }
    let mut limits = Section::new("What limits the accuracy");
    limits.blocks.extend(shown.limits.iter().map(|limit| Block::Text(sentence(limit))));
    let noise = format!(
        "What the fit leaves over is {:.2} times the noise, which the differences of {} tell. \
         The camera's blur is {} mm.",
        shown.fit.misfit.sqrt(),
        match shown.fit.outline {
            Outline::Edge { .. } => "24 blocks along the edge",
            Outline::Spot { .. } => "12 sectors around the spot",
        },
        three_digits(shown.fit.blur)
    );
    limits.blocks.push(Block::Text(noise));
    let section = |title: &str, blocks: Vec<Block>| Section { title: title.to_owned(), blocks };
    let page = Page {
        title: format!("{TITLE}: {}", photo.file_name().unwrap_or_default().to_string_lossy()),
        introduction: vec![String::from(
            "Light of the photograph, the piece that explains it, and what remains between the two.",
        )],
        sections: vec![
            section("Material", vec![Block::Table(table)]),
            section("Fit", vec![Block::Chart(light(shown)), Block::Chart(residuals(shown))]),
            section("Photograph", std::iter::once(Block::Plates(vec![plate])).chain(beside).collect()),
            limits,
        ],
    };
    for chart in page.charts() {
        files.push((format!("{}.svg", chart.name), chart.svg().into_bytes()));
        files.push((format!("{}.csv", chart.name), chart.table().csv().into_bytes()));
    }
    files.extend(page.tables().map(|table| (format!("{}.csv", table.name), table.csv().into_bytes())));
    // First the page: it says whose the others are
    files.insert(0, (String::from(PAGE), page.html().into_bytes()));
    Ok(files)
}

/// A remark of the command as a sentence.
fn sentence(remark: &str) -> String {
    let mut letters = remark.chars();
    let first = letters.next().map_or_else(String::new, |letter| letter.to_uppercase().collect());
    let end = if remark.ends_with(['.', '?', '!']) { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}

fn points(shown: &Shown<'_>, value: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
    let origin = match shown.fit.outline {
        Outline::Edge { position, .. } => position,
        Outline::Spot { .. } => 0.0,
    };
    let place = |(i, x): (usize, &f64)| [x - origin, value(i)];
    shown.samples.places.iter().enumerate().map(place).collect()
}

fn distance(shown: &Shown<'_>) -> Axis {
    match shown.fit.outline {
        Outline::Edge { .. } => Axis::linear("distance from the edge", "mm"),
        Outline::Spot { .. } => Axis::linear("distance from the middle", "mm"),
    }
}

fn light(shown: &Shown<'_>) -> Chart {
    let means = shown.samples.means();
    let lines = "Points: the photograph. Lines: the half space that explains it best.";
    let (title, y, caption) = match shown.fit.outline {
        Outline::Edge { .. } => ("Light across the edge", Axis::linear("light", ""), String::from(lines)),
        // How far it glows is told by what is far darker than the spot
        Outline::Spot { .. } => {
            let lights =
                || means.iter().chain(&shown.fit.light).flatten().copied().filter(|light| *light > 0.0);
            let most = lights().fold(f64::MIN_POSITIVE, f64::max);
            let least = lights().fold(most, f64::min).max(1e-5 * most);
            // A share of the power, where paper tells that
            let unit = if shown.fit.channels[0].surface_albedo.is_some() { "mm⁻²" } else { "" };
            let axis = Axis::logarithmic("light", unit).between(0.5 * least, 2.0 * most);
            ("Light around the spot", axis, format!("{lines} What is at or below 0 is left out."))
        }
    };
    let mut chart = Chart::new("fit", title, distance(shown), y).with_caption(&caption);
    for (c, name) in CHANNELS.iter().enumerate() {
        let seen = points(shown, |i| means[i][c]);
        let model = points(shown, |i| shown.fit.light[i][c]);
        chart.series.push(Series::new(name, INKS[c], Mark::Points, seen));
        chart.series.push(Series::new(&format!("{name}, fit"), INKS[c], Mark::Line, model));
    }
    chart
}

fn residuals(shown: &Shown<'_>) -> Chart {
    let means = shown.samples.means();
    let (unit, caption) = match shown.fit.outline {
        Outline::Edge { .. } => (
            "%",
            "In percent of the brightest light of the fit. Where the model is right there is noise only.",
        ),
        // Of the brightest light, that of the glow which tells the mean free path is hardly any
        Outline::Spot { .. } => (
            "standard errors",
            "In standard errors of the photograph's light, by its noise. Where the model is right there is noise only.",
        ),
    };
    let y = Axis::linear("photograph less fit", unit);
    let mut chart =
        Chart::new("residuals", "What the fit leaves over", distance(shown), y).with_caption(caption);
    for (c, name) in CHANNELS.iter().enumerate() {
        let most = shown.fit.light.iter().map(|light| light[c]).fold(f64::MIN_POSITIVE, f64::max);
        let scale = |i: usize| match shown.fit.outline {
            Outline::Edge { .. } => 0.01 * most,
            Outline::Spot { .. } => shown.fit.errors[i][c],
        };
        let left = points(shown, |i| (means[i][c] - shown.fit.light[i][c]) / scale(i));
        chart.series.push(Series::new(name, INKS[c], Mark::Line, left));
    }
    chart
}

/// The photograph, dark but for the region, with the edge as a line.
fn plate(shown: &Shown<'_>) -> std::io::Result<Plate> {
    let Shown { photo, region: [x0, y0, x1, y1], trace, .. } = shown;
    let step = photo.width.max(photo.height).div_ceil(WIDEST).max(1);
    let size = [photo.width.div_ceil(step), photo.height.div_ceil(step)];
    let lit = shown.fit.light.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max) as f32;
    let mut codes = Vec::with_capacity(3 * size[0] * size[1]);
    for i in 0..size[0] * size[1] {
        let (x, y) = (step * (i % size[0]), step * (i / size[0]));
        let is_inside = (*x0..*x1).contains(&x) && (*y0..*y1).contains(&y);
        if is_inside && trace.distance(x - x0, y - y0) <= 0.75 * step as f64 {
            codes.extend([255, 60, 40]);
            continue;
        }
        let part = if is_inside { 0.9 } else { 0.3 };
        let display = display_from_linear(ToneMapping::Srgb, photo.at(x, y).map(|v| part * v / lit));
        codes.extend(display.map(|v| (255.0 * v).round() as u8));
    }
    Ok(Plate {
        file: String::from(PICTURE),
        alternative: format!(
            "The photograph with the region that was measured and the {} in it",
            outline_name(shown.fit)
        ),
        caption: format!(
            "The region that was measured, the rest darkened, and the {} in red.",
            outline_name(shown.fit)
        ),
        size,
        png: CodedPicture::rgb(size, &codes).encode()?,
    })
}
