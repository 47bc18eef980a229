//! A measurement as it is printed: a table, sentences, a material for scene files.

use std::fmt::Write as _;

use translucid_laboratory::{Cell, DataTable};
use translucid_measure::{ChannelFit, Fit, Interval, Outline, Scale};

use super::arguments::MeasureArguments;
use super::rival::Rival;
use crate::table::exact;

/// Names of the channels.
pub(super) const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Columns of the table.
pub(super) const COLUMNS: [&str; 8] =
    ["channel", "quantity", "value", "from_68", "to_68", "from_95", "to_95", "unit"];

/// The table, without rows.
pub(super) fn table() -> DataTable {
    DataTable::new("measured", "What is measured, with intervals of 68 and of 95 % confidence.", &COLUMNS)
}

/// A quantity of a channel, or of no one.
pub(super) fn row(channel: &str, quantity: &str, interval: Interval, unit: &str) -> Vec<Cell> {
    let Interval { value, likely, sure } = interval;
    let numbers = [value, likely[0], likely[1], sure[0], sure[1]].map(Cell::from);
    let words = [Cell::from(channel), Cell::from(quantity)];
    words.into_iter().chain(numbers).chain([Cell::from(unit)]).collect()
}

/// Rows of the table: the mean free path where it is seen, the surface albedo where it is measured.
pub(super) fn rows(fit: &Fit) -> Vec<Vec<Cell>> {
    let of_channel = |(name, channel): (&&str, &ChannelFit)| {
        let albedo = channel.surface_albedo.map(|albedo| row(name, "surface_albedo", albedo, ""));
        let mfp = channel.is_seen.then(|| row(name, "mfp", channel.mfp, "mm"));
        [mfp, albedo].into_iter().flatten().collect::<Vec<_>>()
    };
    CHANNELS.iter().zip(&fit.channels).flat_map(of_channel).collect()
}

/// A line for each channel, and how well the fit explains the light.
pub(super) fn paragraphs(fit: &Fit, rival: &Rival) -> String {
    let mut text = String::new();
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        let shown = |interval: Interval| {
            let [low, high] = interval.sure.map(three_digits);
            format!("{} ({low} to {high})", three_digits(interval.value))
        };
        if channel.is_seen {
            let _ = write!(text, "{name:<6} mean free path {} mm", shown(channel.mfp));
        } else {
            let _ = write!(text, "{name:<6} mean free path not seen");
        }
        if let Some(albedo) = channel.surface_albedo {
            let _ = write!(text, ", surface albedo {}", shown(albedo));
            let _ = write!(text, ", correlation {:+.2}", channel.correlation);
        }
        let _ = writeln!(text, ", stray light {:.1} %", 100.0 * channel.stray);
    }
    let _ = writeln!(
        text,
        "\nIn parentheses the 95 % confidence interval. Blur {} mm; residuals {:.2} times the noise, of {} {:.2}.",
        three_digits(fit.blur),
        fit.misfit.sqrt(),
        rival.name,
        rival.misfit.sqrt()
    );
    text
}

/// The command that says the same in other renderers' numbers.
pub(super) fn conversion(fit: &Fit, scale: Scale) -> String {
    let list = |values: [f64; 3]| values.map(three_digits).join(",");
    let mfps = list(fit.channels.map(|channel| if channel.is_seen { channel.mfp.value } else { 0.0 }));
    let albedos = list(surface_albedos(fit, scale));
    format!(
        "In other renderers: translucid convert --from translucid:mfp={mfps} --surface-albedo {albedos} --format text\n"
    )
}

/// Surface albedos that a material has, measured or given.
pub(super) fn surface_albedos(fit: &Fit, scale: Scale) -> [f64; 3] {
    match scale {
        Scale::Relative(albedos) => albedos,
        Scale::Reflectance => {
            fit.channels.map(|channel| channel.surface_albedo.map_or(0.0, |a| a.value.clamp(0.0, 1.0)))
        }
    }
}

/// The material for scene files.
pub(super) fn material(fit: &Fit, scale: Scale, arguments: &MeasureArguments) -> String {
    let MeasureArguments { photo, eta, g, .. } = arguments;
    let list = |values: [f64; 3]| values.map(three_digits).join(", ");
    let albedos = surface_albedos(fit, scale);
    let mut rest = String::new();
    if *g != 0.0 {
        let _ = writeln!(rest, "subsurface_scatter_anisotropy = {g}");
    }
    if *eta != 1.0 {
        let _ = writeln!(rest, "specular_ior = {eta}");
    }
    let name = photo.file_stem().unwrap_or_default().to_string_lossy().replace(['"', '\\'], "_");
    format!(
        "unit = \"mm\"\n\n[[material]]\nname = \"{name}\"\nsubsurface_weight = 1\nsubsurface_color = [{}]\n\
         subsurface_radius = 1\nsubsurface_radius_scale = [{}]\n{rest}",
        list(albedos),
        // A surface whose scattering is not seen is Lambertian
        list(fit.channels.map(|channel| if channel.is_seen { channel.mfp.value } else { 0.0 }))
    )
}

/// A word for the light's shape.
pub(super) fn outline_name(fit: &Fit) -> &'static str {
    match fit.outline {
        Outline::Edge { .. } => "edge",
        Outline::Spot { .. } => "spot",
    }
}

/// A number with three significant digits.
pub(super) fn three_digits(value: f64) -> String {
    format!("{value:.2e}").parse::<f64>().map_or_else(|_| value.to_string(), exact)
}
