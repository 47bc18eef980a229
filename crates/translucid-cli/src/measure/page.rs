//! The page of a measurement: the fit, what it leaves over, where in the photograph it was made.

use std::path::Path;

use translucid_image::{CodedPicture, ToneMapping, display_from_linear};
use translucid_laboratory::{Axis, Block, Chart, DataTable, Ink, Mark, Page, Plate, Section, Series};
use translucid_measure::{CHANNELS, Measurement, Outline, Resynthesis, three_digits};

use super::report::{COLUMNS, rows};
use super::setup_plates::{SCENE, plates};
use super::words;
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
pub(super) fn write(directory: &Path, photo: &Path, measurement: &Measurement) -> Result<(), Failure> {
    Directory::fill(directory, |directory| {
        let page = directory.file(PAGE);
        if page.exists() && !is_own_page(&page, TITLE) {
            return Err(refusal(&page, "is there already, and translucid has not made it"));
        }
        directory.write(&files(photo, measurement)?)
    })
}

fn files(photo: &Path, measurement: &Measurement) -> Result<Vec<NamedFile>, Failure> {
    let drawing = |error: std::io::Error| Failure::work(format!("cannot draw a picture: {error}"));
    let plate = plate(measurement).map_err(drawing)?;
    let mut files = vec![(String::from(PICTURE), plate.png.clone())];
    let mut photograph = vec![Block::Plates(vec![plate])];
    if let Some(resynthesis) = Resynthesis::new(measurement) {
        if let Some(plates) = plates(&resynthesis)? {
            files.extend(plates.each_ref().map(|plate| (plate.file.clone(), plate.png.clone())));
            photograph.push(Block::Plates(plates.into()));
        }
        files.push((String::from(SCENE), resynthesis.scene().into_bytes()));
    }
    let section = |title: &str, blocks: Vec<Block>| Section { title: title.to_owned(), blocks };
    let page = Page {
        title: format!("{TITLE}: {}", photo.file_name().unwrap_or_default().to_string_lossy()),
        introduction: vec![String::from(
            "Light of the photograph, the piece that explains it, and what remains between the two.",
        )],
        sections: vec![
            section("Material", vec![Block::Table(table(measurement))]),
            section("Fit", vec![Block::Chart(light(measurement)), Block::Chart(residuals(measurement))]),
            section("Photograph", photograph),
            limits(measurement),
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

fn table(measurement: &Measurement) -> DataTable {
    let caption = "What is measured, with intervals of 68 and of 95 % confidence.";
    DataTable { rows: rows(&measurement.quantities()), ..DataTable::new("measured", caption, &COLUMNS) }
}

/// The section on what limits the accuracy.
fn limits(measurement: &Measurement) -> Section {
    let mut section = Section::new("What limits the accuracy");
    let remarks = measurement.limits.iter().map(|limit| sentence(&words(limit.text())));
    section.blocks.extend(remarks.map(Block::Text));
    let noise = format!(
        "What the fit leaves over is {:.2} times the noise, which the differences of {} tell. \
         The camera's blur is {} mm.",
        measurement.fit.misfit.sqrt(),
        match measurement.fit.outline {
            Outline::Edge { .. } => "24 blocks along the edge",
            Outline::Spot { .. } => "12 sectors around the spot",
        },
        three_digits(measurement.fit.blur)
    );
    section.blocks.push(Block::Text(noise));
    section
}

/// A remark of the command as a sentence.
fn sentence(remark: &str) -> String {
    let mut letters = remark.chars();
    let first = letters.next().map_or_else(String::new, |letter| letter.to_uppercase().collect());
    let end = if remark.ends_with(['.', '?', '!']) { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}

fn points(measurement: &Measurement, value: impl Fn(usize) -> f64) -> Vec<[f64; 2]> {
    let origin = match measurement.fit.outline {
        Outline::Edge { position, .. } => position,
        Outline::Spot { .. } => 0.0,
    };
    let place = |(i, x): (usize, &f64)| [x - origin, value(i)];
    measurement.samples.places.iter().enumerate().map(place).collect()
}

fn distance(measurement: &Measurement) -> Axis {
    match measurement.fit.outline {
        Outline::Edge { .. } => Axis::linear("distance from the edge", "mm"),
        Outline::Spot { .. } => Axis::linear("distance from the middle", "mm"),
    }
}

fn light(measurement: &Measurement) -> Chart {
    let means = measurement.samples.means();
    let lines = "Points: the photograph. Lines: the half space that explains it best.";
    let (title, y, caption) = match measurement.fit.outline {
        Outline::Edge { .. } => ("Light across the edge", Axis::linear("light", ""), String::from(lines)),
        // How far it glows is told by what is far darker than the spot
        Outline::Spot { .. } => {
            let lights =
                || means.iter().chain(&measurement.fit.light).flatten().copied().filter(|light| *light > 0.0);
            let most = lights().fold(f64::MIN_POSITIVE, f64::max);
            let least = lights().fold(most, f64::min).max(1e-5 * most);
            // A share of the power, where paper tells that
            let unit = if measurement.fit.channels[0].surface_albedo.is_some() { "mm⁻²" } else { "" };
            let axis = Axis::logarithmic("light", unit).between(0.5 * least, 2.0 * most);
            ("Light around the spot", axis, format!("{lines} What is at or below 0 is left out."))
        }
    };
    let mut chart = Chart::new("fit", title, distance(measurement), y).with_caption(&caption);
    for (c, name) in CHANNELS.iter().enumerate() {
        let seen = points(measurement, |i| means[i][c]);
        let model = points(measurement, |i| measurement.fit.light[i][c]);
        chart.series.push(Series::new(name, INKS[c], Mark::Points, seen));
        chart.series.push(Series::new(&format!("{name}, fit"), INKS[c], Mark::Line, model));
    }
    chart
}

fn residuals(measurement: &Measurement) -> Chart {
    let means = measurement.samples.means();
    let (unit, caption) = match measurement.fit.outline {
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
        Chart::new("residuals", "What the fit leaves over", distance(measurement), y).with_caption(caption);
    for (c, name) in CHANNELS.iter().enumerate() {
        let most = measurement.fit.light.iter().map(|light| light[c]).fold(f64::MIN_POSITIVE, f64::max);
        let scale = |i: usize| match measurement.fit.outline {
            Outline::Edge { .. } => 0.01 * most,
            Outline::Spot { .. } => measurement.fit.errors[i][c],
        };
        let left = points(measurement, |i| (means[i][c] - measurement.fit.light[i][c]) / scale(i));
        chart.series.push(Series::new(name, INKS[c], Mark::Line, left));
    }
    chart
}

/// The photograph, dark but for the region, with the edge as a line.
fn plate(measurement: &Measurement) -> std::io::Result<Plate> {
    let Measurement { photo, region: [x0, y0, x1, y1], trace, .. } = measurement;
    let step = photo.width.max(photo.height).div_ceil(WIDEST).max(1);
    let size = [photo.width.div_ceil(step), photo.height.div_ceil(step)];
    let lit = measurement.fit.light.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max) as f32;
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
            measurement.fit.outline.name()
        ),
        caption: format!(
            "The region that was measured, the rest darkened, and the {} in red.",
            measurement.fit.outline.name()
        ),
        size,
        png: CodedPicture::rgb(size, &codes).encode()?,
    })
}
