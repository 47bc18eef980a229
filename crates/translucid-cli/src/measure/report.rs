//! A measurement as it is printed: a table, sentences, a material for scene files.

use std::fmt::Write as _;
use std::path::Path;

use translucid_measure::{CHANNELS, Interval, Measurement, Quantity, Scale, three_digits};
use translucid_profile::Configuration;
use translucid_words::Cell;

use crate::failure::Failure;

/// Columns of the table.
pub(super) const COLUMNS: [&str; 8] =
    ["channel", "quantity", "value", "from_68", "to_68", "from_95", "to_95", "unit"];

/// A word for the channel of a quantity.
pub(super) fn channel(quantity: &Quantity) -> &'static str {
    quantity.channel.map_or("all", |channel| CHANNELS[channel])
}

/// Rows of the table.
pub(super) fn rows(quantities: &[Quantity]) -> Vec<Vec<Cell>> {
    let row = |quantity: &Quantity| {
        let Interval { value, likely, sure } = quantity.interval;
        let numbers = [value, likely[0], likely[1], sure[0], sure[1]].map(Cell::from);
        let words = [Cell::from(channel(quantity)), Cell::from(quantity.name)];
        words.into_iter().chain(numbers).chain([Cell::from(quantity.unit)]).collect()
    };
    quantities.iter().map(row).collect()
}

/// A value with its interval of 95 %.
pub(super) fn with_interval(interval: Interval) -> String {
    let [low, high] = interval.sure.map(three_digits);
    format!("{} ({low} to {high})", three_digits(interval.value))
}

/// A line for each channel, and how well the fit explains the light.
pub(super) fn paragraphs(measurement: &Measurement) -> String {
    let Measurement { fit, alternative, .. } = measurement;
    let mut text = String::new();
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        if channel.is_seen {
            let _ = write!(text, "{name:<6} mean free path {} mm", with_interval(channel.mfp));
        } else {
            let _ = write!(text, "{name:<6} mean free path not seen");
        }
        if let Some(albedo) = channel.surface_albedo {
            let _ = write!(text, ", surface albedo {}", with_interval(albedo));
            let _ = write!(text, ", correlation {:+.2}", channel.correlation);
        }
        let _ = writeln!(text, ", stray light {:.1} %", 100.0 * channel.stray);
    }
    let _ = writeln!(
        text,
        "\nIn parentheses the 95 % confidence interval. Blur {} mm; residuals {:.2} times the noise, of {} {:.2}.",
        three_digits(fit.blur),
        fit.misfit.sqrt(),
        alternative.name,
        alternative.misfit.sqrt()
    );
    text
}

/// The command that prints the same in other renderers' numbers.
pub(super) fn conversion(measurement: &Measurement) -> String {
    let list = |values: [f64; 3]| values.map(three_digits).join(",");
    format!(
        "In other renderers: translucid convert --from translucid:mfp={} --surface-albedo {} --format text\n",
        list(measurement.mfps()),
        list(measurement.surface_albedos())
    )
}

/// The material for scene files.
pub(super) fn material(measurement: &Measurement, photo: &Path) -> String {
    let options = &measurement.options;
    let mut rest = String::new();
    if options.g != 0.0 {
        let _ = writeln!(rest, "subsurface_scatter_anisotropy = {}", options.g);
    }
    if options.eta != 1.0 {
        let _ = writeln!(rest, "specular_ior = {}", options.eta);
    }
    let name = photo.file_stem().unwrap_or_default().to_string_lossy();
    keys("mm", &name, measurement.surface_albedos(), measurement.mfps()) + &rest
}

/// The piece as a file of layers.
///
/// # Errors
/// The words tell what layers have that was not measured, or is measured as something else.
pub(super) fn layer(measurement: &Measurement, photo: &Path) -> Result<String, Failure> {
    let options = &measurement.options;
    let is_matt = options.configuration.is_none_or(|configuration| configuration == Configuration::Diffuse);
    if options.eta != 1.0 || options.incidence.is_some() || !is_matt {
        return Err(Failure::input(
            "--format layers is for matt pieces: --eta 1 and --configuration diffuse",
        ));
    }
    let (albedos, mfps) = (measurement.surface_albedos(), measurement.mfps());
    for (i, name) in CHANNELS.iter().enumerate() {
        let is_known = !matches!(measurement.scale, Scale::Unknown);
        if !(is_known && albedos[i] > 0.0 && albedos[i] < 1.0) {
            let what = if is_known { "comes out as 0, or as 1 or more" } else { "is not known" };
            return Err(Failure::input(format!("the surface albedo of {name} {what}, so there is no layer"))
                .with_help("measure it at an edge of a thick piece, and give --surface-albedo"));
        }
        if !measurement.fit.channels[i].is_seen {
            return Err(Failure::input(format!("the mean free path of {name} is not seen")));
        }
    }
    let list = |values: [f64; 3]| values.map(three_digits).join(", ");
    let thickness = options.thickness.map_or_else(String::new, |length| format!("thickness = {length}\n"));
    let g = if options.g == 0.0 { String::new() } else { format!("g = {}\n", options.g) };
    let name = photo.file_name().unwrap_or_default().to_string_lossy();
    Ok(format!(
        "# {}; lengths in mm\n[[layer]]\n{thickness}surface_albedo = [{}]\nmfp = [{}]\n{g}",
        name.replace(['\n', '\r'], "_"),
        list(albedos),
        list(mfps)
    ))
}

/// A material's unit, name, surface albedo and mean free path, as keys of a scene file.
pub(super) fn keys(unit: &str, name: &str, surface_albedo: [f64; 3], mfp: [f64; 3]) -> String {
    let list = |values: [f64; 3]| values.map(three_digits).join(", ");
    format!(
        "unit = \"{unit}\"\n\n[[material]]\nname = \"{}\"\nsubsurface_weight = 1\nsubsurface_color = [{}]\n\
         subsurface_radius = 1\nsubsurface_radius_scale = [{}]\n",
        name.replace(['"', '\\'], "_"),
        list(surface_albedo),
        list(mfp)
    )
}
