//! `translucid measure`: a material's numbers from a photograph.

mod arguments;
mod gains;
mod known_shape;
mod medium_of;
mod page;
mod photograph;
mod remarks;
mod report;
mod resolution;
mod rival;
mod scene_arguments;
mod setup;
mod shown;
mod trace;

use std::path::Path;

use translucid_files::check_writable;
use translucid_laboratory::DataTable;
use translucid_measure::{
    Card, Fit, Outline, Photo, Response, Samples, Scale, fit_edge, fit_edge_of, fit_spot,
};

pub(crate) use self::arguments::MeasureArguments;
use self::arguments::{MeasureFormat, SetupName};
use self::gains::gains;
use self::medium_of::MediumOf;
use self::photograph::{check_clipping, load, part, refusal, subtract, warn_of_cut_noise};
use self::remarks::{MISFIT, remarks, unlike};
use self::report::{
    COLUMNS, conversion, material, outline_name, paragraphs, rows, surface_albedos, table, three_digits,
};
use self::rival::Rival;
use self::shown::Shown;
use self::trace::{Trace, check_core, edge_line, spot_place};
use crate::failure::Failure;
use crate::files::write_file;
use crate::messages;
use crate::table::{TableFormat, print};

/// Runs the verb.
pub(crate) fn run(arguments: &MeasureArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        check_writable(path)?;
    }
    if let Some(scene) = &arguments.shape.scene {
        return known_shape::run(arguments, scene);
    }
    arguments.check_setup()?;
    let scale = arguments.scale()?;
    let medium_of = MediumOf::new(arguments)?;
    let mm_per_pixel = arguments.mm_per_pixel()?;
    let path = &arguments.photo;
    let mut photo = exposed(arguments)?;
    let region = arguments.region.unwrap_or([0, 0, photo.width, photo.height]);
    let piece = part(&photo, path, "--region", region)?;
    let [left, top] = [region[0] as f64, region[1] as f64];
    // What is found may be anywhere before light is lost there
    let place = match arguments.setup {
        SetupName::Spot => Some(spot_place(&piece, arguments, [left, top])?),
        SetupName::Edge | SetupName::Slab => None,
    };
    let core = match place {
        Some(place) => check_core(&piece, &place, path)?,
        None => {
            check_clipping(&piece, path)?;
            0.0
        }
    };
    if let Some(white) = arguments.white {
        check_clipping(&part(&photo, path, "--white", white)?, path)?;
    }
    let dark =
        arguments.dark.as_ref().map(|dark| load(dark, arguments).map(|photo| (dark, photo))).transpose()?;
    if let Some((path, dark)) = &dark {
        subtract(&mut photo, dark).map_err(|message| refusal(path, message))?;
        warn_of_cut_noise(dark, path, &photo);
    }
    let gains = gains(
        &photo,
        place.map(|place| place.moved([left, top])),
        dark.map(|(_, dark)| dark).as_ref(),
        arguments,
    )?;
    gains.apply(&mut photo);
    let piece = part(&photo, path, "--region", region)?;
    let (trace, samples, mut fit) = match place {
        None => {
            let line = edge_line(&piece, arguments, region)?;
            let samples = line.samples(&piece, mm_per_pixel);
            let (samples, fit) = edge_fit(samples, arguments, &medium_of.response, scale)?;
            (Trace::Line(line), samples, fit)
        }
        Some(place) => {
            let samples = place.samples(&piece, mm_per_pixel, core);
            let fit = spot_fit(&samples, path, &medium_of.response, scale)?;
            (Trace::Spot(place), samples, fit)
        }
    };
    gains.widen(&mut fit);
    refuse_unseen(&fit, &samples, path)?;
    say_outline(&fit);
    let rival = Rival::best(&fit, &samples, scale);
    let mut limits = remarks(&fit, &samples, scale);
    if let Some(warning) = rival.warning(&fit, &samples) {
        messages::print_warning(&warning);
        limits.push(warning);
    }
    medium_of.scale(&mut fit, scale)?;
    if let Some(directory) = &arguments.page {
        let shown =
            Shown { photo: &photo, region, trace: &trace, samples: &samples, fit: &fit, limits: &limits };
        let setup = match (fit.outline, trace) {
            (Outline::Edge { card, position }, Trace::Line(line))
                if arguments.setup == SetupName::Edge && arguments.incidence.is_none() =>
            {
                Some(setup::Setup {
                    line,
                    card,
                    position,
                    mm_per_pixel,
                    surface_albedos: surface_albedos(&fit, scale),
                    configuration: arguments.configuration.into(),
                    eta: arguments.eta,
                    g: arguments.g,
                })
            }
            _ => None,
        };
        page::write(directory, path, &shown, setup.as_ref(), DataTable { rows: rows(&fit), ..table() })?;
    }
    let text = match arguments.format {
        MeasureFormat::Text => paragraphs(&fit, &rival) + &conversion(&fit, scale),
        MeasureFormat::Csv => TableFormat::Csv.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Json => TableFormat::Json.text(&COLUMNS, &rows(&fit)),
        MeasureFormat::Toml => material(&fit, scale, arguments),
    };
    match &arguments.output {
        Some(path) => write_file(path, text.as_bytes()),
        None => print(&text),
    }
}

/// The photograph, merged with its other exposures.
fn exposed(arguments: &MeasureArguments) -> Result<Photo, Failure> {
    let photo = load(&arguments.photo, arguments)?;
    if arguments.exposure.is_empty() {
        return Ok(photo);
    }
    let mut exposures = vec![photo];
    for path in &arguments.exposure {
        exposures.push(load(path, arguments)?);
    }
    Photo::merged(&exposures).ok_or_else(|| {
        Failure::input(
            "--exposure: the photographs have other sizes or nothing in common that none of them clips",
        )
    })
}

/// Fits an edge, in steps as fine as its light needs, and returns the samples that were fitted.
fn edge_fit(
    samples: Samples,
    arguments: &MeasureArguments,
    response: &Response,
    scale: Scale,
) -> Result<(Samples, Fit), Failure> {
    let fit = |samples: &Samples| match arguments.card {
        // The camera sees the slab on both sides
        None if arguments.setup == SetupName::Slab => fit_edge_of(Card::Hidden, samples, response, scale),
        None => fit_edge(samples, response, scale),
        Some(card) => fit_edge_of(card.into(), samples, response, scale),
    };
    resolution::fit(samples, fit).ok_or_else(|| {
        let message = "nothing gets brighter across the edge, or it has fewer than 16 pixels on a side";
        refusal(&arguments.photo, message)
    })
}

/// Fits a spot.
fn spot_fit(samples: &Samples, path: &Path, response: &Response, scale: Scale) -> Result<Fit, Failure> {
    fit_spot(samples, response, scale).ok_or_else(|| {
        let message =
            "nothing gets brighter toward the middle of the spot, or there are fewer than 16 rings around it";
        refusal(path, message).with_help("show more of the piece around the spot, or set --center")
    })
}

/// Refuses a photograph in which no channel scatters.
fn refuse_unseen(fit: &Fit, samples: &Samples, path: &Path) -> Result<(), Failure> {
    if fit.channels.iter().any(|channel| channel.is_seen) {
        return Ok(());
    }
    // What a camera in focus does not blur either
    if fit.misfit > MISFIT && fit.blur > 3.0 * samples.pixel_width {
        return Err(refusal(path, unlike(fit)));
    }
    let message = format!(
        "no scattering is seen: the {} is as sharp as a blur of {} mm makes it",
        outline_name(fit),
        three_digits(fit.blur)
    );
    Err(refusal(path, message).with_help("come closer, so that light creeps over several pixels"))
}

/// Says what the light's shape was taken for.
fn say_outline(fit: &Fit) {
    match fit.outline {
        Outline::Edge { card: Card::Hidden, .. } => {
            messages::line("the dark side shows light that creeps into a shadow (--card hidden)");
        }
        Outline::Edge { card: Card::Visible, .. } => {
            messages::line("the dark side shows the card: the lit side is measured (--card visible)");
        }
        Outline::Spot { radius } => messages::line(&format!(
            "a spot of {} mm radius, its edge as soft as {} mm",
            three_digits(radius),
            three_digits(fit.blur)
        )),
    }
}
