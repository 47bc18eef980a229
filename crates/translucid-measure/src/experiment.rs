//! A photograph of light on a flat piece, on its way to the piece's material.
//!
//! ```text
//! exposures  merged into one photograph
//! region     cut out, its clipping checked, a spot found
//! dark       subtracted
//! white      divided by
//! edge       found
//! light      sampled across the edge, or around the spot
//! fit        of isotropic scatterers, and of models that are none
//! medium     the similar one with the mean cosine that was asked for
//! ```

use crate::alternative_model::AlternativeModel;
use crate::calibration::Calibration;
use crate::clipping::{check_clipping, check_core, warn_of_cut_noise};
use crate::edge_fit::{fit_edge, fit_edge_of};
use crate::error::MeasureError;
use crate::fit::{Card, Fit, Outline, Scale};
use crate::limitations::{MISFIT, limitations, unlike};
use crate::linear_photo::{NamedPhoto, Photo};
use crate::measurement::Measurement;
use crate::options::{Options, Setup, refuse_together};
use crate::remark::{Remark, three_digits};
use crate::resolution::fit_finely;
use crate::samples::Samples;
use crate::similar_medium::SimilarMedium;
use crate::spot_fit::fit_spot;
use crate::spot_place::SpotPlace;
use crate::trace::{Trace, edge_line, spot_place};

/// Photographs of one view.
#[derive(Clone, Debug, PartialEq)]
pub struct Photographs {
    /// The piece.
    pub photo: NamedPhoto,
    /// Other exposures of the same view, merged with the first.
    pub exposures: Vec<NamedPhoto>,
    /// The same exposure with the light off, which is subtracted.
    pub dark: Option<NamedPhoto>,
    /// The same exposure and light with white paper in place of the piece.
    pub white: Option<NamedPhoto>,
}

/// Measures photographs of an edge of light or of a spot, given how they were taken.
///
/// ```
/// use translucid_measure::{Experiment, NamedPhoto, Options, Photo, Photographs};
///
/// # fn main() -> Result<(), translucid_measure::MeasureError> {
/// // Light that falls off over a millimeter to either side of a line, in pixels of 0.1 mm with some grain
/// let light = |x: usize, y: usize| {
///     let grain = 1e-3 * ((x * 7 + y * 13) % 11) as f32;
///     0.3 + 0.25 * ((x as f32 - 60.0) / 10.0).tanh() + grain
/// };
/// let photo = Photo::from_fn(120, 60, |x, y| [light(x, y); 3]);
/// let photographs = Photographs {
///     photo: NamedPhoto { name: String::from("soap"), photo },
///     exposures: Vec::new(),
///     dark: None,
///     white: None,
/// };
/// let options = Options { mm_per_pixel: Some(0.1), surface_albedo: vec![0.8], ..Options::default() };
/// let measurement = Experiment::new(options)?.measure(photographs, &mut |_| ())?;
/// assert!((0.1..10.0).contains(&measurement.fit.channels[0].mfp.value));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Experiment {
    options: Options,
    mm_per_pixel: f64,
    medium: SimilarMedium,
}

/// A photograph in the numbers that are fitted.
struct Calibrated {
    photo: NamedPhoto,
    region: [usize; 4],
    /// A spot in the region, and the radius of its core that is left out.
    spot: Option<(SpotPlace, f64)>,
    calibration: Calibration,
}

impl Experiment {
    /// The experiment of some options.
    ///
    /// # Errors
    /// A number is out of its range, options contradict each other, or the scale is missing.
    pub fn new(options: Options) -> Result<Self, MeasureError> {
        options.check()?;
        options.scale(false)?;
        options.white_reflectances()?;
        let medium = SimilarMedium::new(&options)?;
        let mm_per_pixel = options.pixel_width()?;
        Ok(Self { options, mm_per_pixel, medium })
    }

    /// Measures the material in photographs; what there is to remark goes to `say`.
    ///
    /// # Errors
    /// A photograph does not show what the options say, is clipped, or shows no scattering.
    pub fn measure(
        &self,
        photographs: Photographs,
        say: &mut dyn FnMut(Remark),
    ) -> Result<Measurement, MeasureError> {
        self.check(&photographs)?;
        let scale = self.options.scale(photographs.white.is_some())?;
        let calibrated = self.calibrate(photographs, say)?;
        let (trace, samples, mut fit) = self.fit(&calibrated, scale, say)?;
        calibrated.calibration.widen(&mut fit);
        let Calibrated { photo: NamedPhoto { name, photo }, region, .. } = calibrated;
        refuse_unseen(&fit, &samples, &name)?;
        say(describe_outline(&fit));
        let alternative = AlternativeModel::best(&fit, &samples, scale);
        let mut limits = limitations(&fit, &samples, scale);
        limits.extend(alternative.warning(&fit, &samples));
        limits.iter().for_each(|limit| say(limit.clone()));
        self.medium.scale(&mut fit, scale)?;
        Ok(Measurement {
            options: self.options.clone(),
            mm_per_pixel: self.mm_per_pixel,
            photo,
            region,
            trace,
            samples,
            fit,
            scale,
            alternative,
            limits,
        })
    }

    /// Refuses photographs that do not go together, or with the options.
    fn check(&self, photographs: &Photographs) -> Result<(), MeasureError> {
        let Photographs { exposures, dark, white, .. } = photographs;
        let [has_exposures, has_dark, has_white] = [!exposures.is_empty(), dark.is_some(), white.is_some()];
        refuse_together(&[
            (has_exposures && has_dark, ["exposure", "dark"]),
            (has_white && has_exposures, ["white_photo", "exposure"]),
            (has_white && self.options.white.is_some(), ["white_photo", "white"]),
            (has_white && !self.options.surface_albedo.is_empty(), ["surface_albedo", "white_photo"]),
        ])
    }

    /// Merges exposures, finds the spot, checks what is clipped, subtracts the dark, divides by white.
    fn calibrate(
        &self,
        photographs: Photographs,
        say: &mut dyn FnMut(Remark),
    ) -> Result<Calibrated, MeasureError> {
        let options = &self.options;
        let Photographs { photo, exposures, dark, white } = photographs;
        let mut photo = merged(photo, exposures)?;
        let region = options.region.unwrap_or([0, 0, photo.photo.width, photo.photo.height]);
        let piece = photo.part("region", region)?;
        // A spot may be anywhere before it is known how much of its light is lost
        let spot = match options.setup {
            Setup::Spot => {
                let place = spot_place(&piece, corner(region), &photo.name, options, say)?;
                Some((place, check_core(&piece, &place, &photo.name, say)?))
            }
            Setup::Edge | Setup::Slab => {
                check_clipping(&piece, &photo.name, say)?;
                None
            }
        };
        if let Some(white) = options.white {
            check_clipping(&photo.part("white", white)?, &photo.name, say)?;
        }
        if let Some(dark) = &dark {
            dark.require_size_of(&photo.photo)?;
            photo.photo.subtract(&dark.photo);
            warn_of_cut_noise(&dark.photo, &dark.name, &photo.photo, say);
        }
        let calibration = match &white {
            None => Calibration::by_card(&photo, options)?,
            Some(white) => {
                white.require_size_of(&photo.photo)?;
                let place = spot.map(|(place, _)| place.moved(corner(region)));
                let dark = dark.as_ref().map(|dark| &dark.photo);
                Calibration::by_photo(white, dark, place, options, say)?
            }
        };
        calibration.apply(&mut photo.photo);
        Ok(Calibrated { photo, region, spot, calibration })
    }

    /// Fits the light across the edge, or around the spot.
    fn fit(
        &self,
        calibrated: &Calibrated,
        scale: Scale,
        say: &mut dyn FnMut(Remark),
    ) -> Result<(Trace, Samples, Fit), MeasureError> {
        let Calibrated { photo, region, spot, .. } = calibrated;
        let piece = photo.part("region", *region)?;
        if let Some((place, core)) = *spot {
            let samples = place.samples(&piece, self.mm_per_pixel, core);
            let fit = fit_spot(&samples, &self.medium.response, scale).ok_or_else(|| {
                let message = "nothing gets brighter toward the center of the spot, or there are fewer than 16 rings around it";
                MeasureError::of_photo(&photo.name, message)
                    .with_help("show more of the piece around the spot, or set `center`")
            })?;
            return Ok((Trace::Spot(place), samples, fit));
        }
        let line = edge_line(&piece, corner(*region), &photo.name, &self.options, say)?;
        let samples = line.samples(&piece, self.mm_per_pixel);
        let (samples, fit) =
            fit_finely(samples, |samples| self.edge_fit(samples, scale), say).ok_or_else(|| {
                let message =
                    "nothing gets brighter across the edge, or it has fewer than 16 pixels on a side";
                MeasureError::of_photo(&photo.name, message)
            })?;
        Ok((Trace::Line(line), samples, fit))
    }

    fn edge_fit(&self, samples: &Samples, scale: Scale) -> Option<Fit> {
        let response = &self.medium.response;
        match self.options.card {
            // The camera sees the slab on both sides
            None if self.options.setup == Setup::Slab => fit_edge_of(Card::Hidden, samples, response, scale),
            None => fit_edge(samples, response, scale),
            Some(card) => fit_edge_of(card, samples, response, scale),
        }
    }
}

/// The photograph, merged with its other exposures.
fn merged(photo: NamedPhoto, exposures: Vec<NamedPhoto>) -> Result<NamedPhoto, MeasureError> {
    if exposures.is_empty() {
        return Ok(photo);
    }
    let NamedPhoto { name, photo } = photo;
    let all: Vec<Photo> =
        std::iter::once(photo).chain(exposures.into_iter().map(|other| other.photo)).collect();
    let photo = Photo::merged(&all).ok_or_else(|| {
        MeasureError::new(
            "`exposure`: the photographs have other sizes or nothing in common that none of them clips",
        )
    })?;
    Ok(NamedPhoto { name, photo })
}

/// Upper left corner of a region.
fn corner([left, top, ..]: [usize; 4]) -> [f64; 2] {
    [left as f64, top as f64]
}

/// Refuses a photograph in which no channel scatters.
fn refuse_unseen(fit: &Fit, samples: &Samples, name: &str) -> Result<(), MeasureError> {
    if fit.channels.iter().any(|channel| channel.is_seen) {
        return Ok(());
    }
    // A camera in focus does not blur so much either
    if fit.misfit > MISFIT && fit.blur > 3.0 * samples.pixel_width {
        return Err(MeasureError::of_photo(name, unlike(fit)));
    }
    let message = format!(
        "no scattering is seen: the {} is as sharp as a blur of {} mm makes it",
        fit.outline.name(),
        three_digits(fit.blur)
    );
    Err(MeasureError::of_photo(name, message)
        .with_help("come closer, so that light creeps over several pixels"))
}

/// The shape that the light was taken for.
fn describe_outline(fit: &Fit) -> Remark {
    Remark::Finding(match fit.outline {
        Outline::Edge { card: Card::Hidden, .. } => {
            String::from("the dark side shows light that creeps into a shadow (`card` hidden)")
        }
        Outline::Edge { card: Card::Visible, .. } => {
            String::from("the dark side shows the card: the lit side is measured (`card` visible)")
        }
        Outline::Spot { radius } => format!(
            "a spot of {} mm radius, its edge as soft as {} mm",
            three_digits(radius),
            three_digits(fit.blur)
        ),
    })
}
